//! Plants as beams that move by their slowest vibrations (thesis chapter 6) as a honami plugin; the mechanics are
//! `honami_mechanics`.

mod settings;
#[cfg(test)]
mod tests;

use honami_mechanics::{
    Beams, Detail, Drag, Forest, Integrator, Leaves, Modes, Pace, Pose, Stand, Stirring, Threads, Vector,
    WindBasis,
};
use honami_model::plant;
use honami_plugin::{Cx, Error, Info, Instance, Mode, Plant, Result, Simulator, Steps, export};
use settings::Settings;

/// Degrees of freedom of a node.
const FREEDOMS: usize = 6;

/// A plant with its modes, and its copies.
struct Modal {
    forest: Forest,
    /// As it was chosen; how long a step is, each call says.
    pace: Pace,
    modes: Vec<Mode>,
    pulled: Vec<f32>,
    threads: Threads,
    details: Vec<Detail>,
}

impl Simulator for Modal {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.modal",
        name: "Vibration modes",
        doc: "Beams of wood, moved by their slowest vibrations, none of which is missed. Air at a copy's crown presses on \
              all of it; it does not slow down between branches.",
        cite: &["Diener 2009, chapter 6", "Diener, Rodriguez, Baboud and Reveret 2009"],
        ..Info::NEW
    };
    const STATE_VERSION: Option<u32> = Some(1);

    fn prepare(settings: &Settings, plant: &Plant<'_>, cx: &Cx<'_>) -> Result<Self> {
        let measured = measured(plant)?;
        let mut beams = Beams::new(&measured, &settings.options()).map_err(unusable)?;
        cx.progress(0.1, "modes")?;
        let leaves = Leaves { mass: settings.leaf_mass, drag: settings.leaf_drag };
        let (branches, density) = (settings.drag, settings.air_density);
        let drag = Drag { branches, density, ..leaves.hang(&mut beams).map_err(unusable)? };
        let n_modes = (settings.modes as usize).min(FREEDOMS * (beams.len() - 1));
        let modes = Modes::new(&beams, n_modes, plant.seed).map_err(unusable)?;
        cx.progress(0.8, "curves")?;
        let basis = WindBasis::new(&beams, &modes, &drag);
        let stirring = Stirring::new(&beams, &modes, basis, settings.form());
        let pulled = stirring.pulled(settings.pull).map_err(unusable)?;
        let stands: Vec<Stand> = plant.instances.iter().map(stand).collect();
        let pace = settings.pace();
        // Whatever a method bears: there is no step yet.
        let any = Pace { integrator: Integrator::Exact, ..pace };
        let forest = Forest::new(&stirring, beams.of_plant(), &stands, &any).map_err(unusable)?;
        // A search that is not certain is an error. What modes look like in double precision is left behind here.
        let mode =
            |mode: usize| Mode { hz: modes.hz(mode), residual: modes.residuals[mode], certified: true };
        let modes = (0..modes.len()).map(mode).collect();
        let threads = Threads::new(plant.max_threads as usize)?;
        let mut made = Self { forest, pace, modes, pulled, threads, details: Vec::new() };
        made.reset();
        Ok(made)
    }

    fn modes(&self) -> Vec<Mode> {
        self.modes.clone()
    }

    fn retune(&mut self, settings: &Settings) -> Result<()> {
        self.pace = settings.pace();
        Ok(())
    }

    fn reset(&mut self) {
        self.forest.reset();
        self.forest.pull_all(&self.pulled);
    }

    fn step(&mut self, steps: &Steps<'_>, out: &mut [[f32; 3]], cx: &Cx<'_>) -> Result<()> {
        let pace = Pace { step: steps.dt, ..self.pace };
        if *self.forest.pace() != pace {
            self.forest.retune(&pace).map_err(unusable)?;
        }
        self.details.clear();
        let details = steps.detail.map(|details| {
            let of = |detail: &honami_plugin::Detail| Detail { n_nodes: detail.nodes, n_modes: detail.modes };
            self.details.extend(details.iter().map(of));
            self.details.as_slice()
        });
        let mut pose = Some(Pose { details, motion: out });
        for left in (0..steps.n).rev() {
            cx.progress(-1.0, "")?;
            let wind = steps.wind.blowing(self.forest.time());
            let blowing = |copy: usize| Vector::from(wind.at(copy).map(f64::from));
            let last = if left == 0 { pose.take() } else { None };
            self.forest.step(&blowing, last, &self.threads).map_err(unusable)?;
        }
        if let Some(pose) = pose {
            self.forest.pose(pose, &self.threads);
        }
        Ok(())
    }

    fn save(&self) -> Result<Vec<u8>> {
        Ok(self.forest.save())
    }

    fn load(&mut self, bytes: &[u8]) -> Result<()> {
        self.forest.load(bytes).map_err(unusable)
    }
}

/// The plant as it was handed over.
fn measured(plant: &Plant<'_>) -> Result<plant::Plant> {
    let node = |node: &honami_plugin::Node| plant::Node {
        parent: node.parent,
        position: node.position.map(f64::from),
        radius: f64::from(node.radius),
    };
    plant::Plant::new(plant.nodes.iter().map(node).collect()).map_err(unusable)
}

fn stand(copy: &Instance) -> Stand {
    Stand { turn: copy.yaw, scale: copy.scale, mass: copy.mass }
}

fn unusable(error: impl std::error::Error) -> Error {
    Error::data(error.to_string())
}

export! {
    library: { id: "org.honami.modal", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [simulator Modal]
}
