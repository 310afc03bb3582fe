//! What a user may choose: of wood and leaves, of modes, and how they go on.

use honami_mechanics::{Damping, Form, Integrator, Material, Options, Pace};
use honami_model::plant::RadiusRule;
use honami_plugin::{choice, params};

choice! {
    /// How thick a segment is between two nodes.
    pub(crate) enum Radius {
        /// The mean of both ends, the base at most 1.5 times the tip.
        Mean = "mean" => "Mean of both ends",
        /// That of its tip.
        Tip = "tip" => "Tip",
    }
}

choice! {
    /// How nodes follow their modes.
    pub(crate) enum Bend {
        /// Segments turn by all modes together: branches keep their length.
        Turn = "turn" => "Segments turn",
        /// By straight lines: branches grow longer.
        Linear = "linear" => "Straight",
        /// By one arc tangent a mode and its square, each mode by itself.
        S2 = "s2" => "s, s²",
        /// And its cube.
        S3 = "s3" => "s, s², s³",
    }
}

choice! {
    /// How modes go on in time.
    pub(crate) enum Method {
        /// Exact for a force that stays, stable in steps of any length.
        Exact = "exact" => "Exact",
        /// Symplectic Euler, as in the thesis, up to its limit.
        Symplectic = "symplectic" => "Symplectic Euler",
        /// Newmark's.
        Newmark = "newmark" => "Newmark",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Young's modulus of the wood.
        young: f64 = 1e10 => { label: "Young's modulus", group: "Wood", unit: "Pa", min: 1e3, max: 1e13, scale: "log" },
        /// Poisson's ratio of the wood.
        poisson: f64 = 0.3 => { label: "Poisson's ratio", group: "Wood", unit: "1", min: -0.99, max: 0.5 },
        /// Density of the wood.
        density: f64 = 1000.0 => { label: "Density", group: "Wood", unit: "kg/m³", min: 1, max: 1e5, scale: "log" },
        /// How thick a segment is between two nodes.
        radius: Radius = "mean" => { label: "Radius of a segment", group: "Wood" },
        /// Longer segments are divided; 0: none.
        longest: f64 = 0.0 => { label: "Longest segment", group: "Wood", unit: "m", min: 0, max: 1e6, soft_max: 1 },
        /// What all leaves weigh, shared by the ends of branches.
        leaf_mass: f64 = 0.0 => { label: "Mass", group: "Leaves", unit: "kg", min: 0, max: 1e6, soft_max: 100 },
        /// Area of all leaves times their drag coefficient, shared alike.
        leaf_drag: f64 = 0.0 => { label: "Drag area", group: "Leaves", unit: "m²", min: 0, max: 1e6, soft_max: 100 },
        /// Drag coefficient of branches.
        drag: f64 = 1.0 => { label: "Drag of branches", group: "Air", unit: "1", min: 0, max: 1e4, soft_max: 2 },
        /// Density of the air.
        air_density: f64 = 1.2 => { label: "Density of the air", group: "Air", unit: "kg/m³", min: 0, max: 1e4, soft_max: 2 },
        /// How many modes, the slowest first; a small plant may have fewer.
        modes: i64 = 25 => { label: "Modes", group: "Motion", min: 1, max: 5000, soft_max: 100 },
        /// How nodes follow their modes.
        bend: Bend = "turn" => { label: "Nodes", group: "Motion" },
        /// How modes go on in time.
        method: Method = "exact" => { label: "Method", group: "Motion", affects: "step" },
        /// Damping by mass.
        alpha: f64 = 0.3 => { label: "Damping by mass", group: "Motion", unit: "1/s", min: 0, max: 1000, soft_max: 5, affects: "step" },
        /// Damping by stiffness.
        beta: f64 = 0.008 => { label: "Damping by stiffness", group: "Motion", unit: "s", min: 0, max: 100, soft_max: 0.1, affects: "step" },
        /// Damping by the air, which grows with the wind: so many times what the drag of branches and leaves gives; 0: none.
        air_damping: f64 = 1.0 => { label: "Damping by the air", group: "Motion", unit: "1", min: 0, max: 1000, soft_max: 5, affects: "step" },
        /// So many times as heavy as its wood, all over: rain, snow, fruit.
        heavier: f64 = 1.0 => { label: "Heavier", group: "Motion", unit: "1", min: 0.01, max: 100, scale: "log", affects: "step" },
        /// In the beginning the slowest mode of every copy is pulled out, so that the node that it moves most would be so far from rest in a straight line.
        pull: f64 = 0.0 => { label: "Pull", group: "Motion", unit: "m", min: -1000, max: 1000, soft_min: -2, soft_max: 2 },
    }
}

impl Settings {
    /// How a plant becomes beams.
    pub(crate) fn options(&self) -> Options {
        let rule = match self.radius {
            Radius::Mean => RadiusRule::Mean,
            Radius::Tip => RadiusRule::Tip,
        };
        let material = Material { young: self.young, poisson: self.poisson, density: self.density };
        Options { rule, material, longest: (self.longest > 0.0).then_some(self.longest) }
    }

    /// How nodes follow their modes.
    pub(crate) fn form(&self) -> Form {
        match self.bend {
            Bend::Turn => Form::Turn,
            Bend::Linear => Form::Linear,
            Bend::S2 => Form::Mode(2),
            Bend::S3 => Form::Mode(3),
        }
    }

    /// How a forest goes on, by steps of a second.
    pub(crate) fn pace(&self) -> Pace {
        let integrator = match self.method {
            Method::Exact => Integrator::Exact,
            Method::Symplectic => Integrator::Symplectic,
            Method::Newmark => Integrator::Newmark,
        };
        let damping =
            Damping { alpha: self.alpha, beta: self.beta, mass: self.heavier, air: self.air_damping };
        Pace { step: 1.0, integrator, damping }
    }
}
