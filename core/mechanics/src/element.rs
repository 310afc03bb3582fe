//! One branch segment: the Euler–Bernoulli beam of circular section (thesis 6.2.1).
//!
//! Each end has six degrees of freedom: displacement u_x, u_y, u_z and rotation psi_x, psi_y, psi_z, where
//! psi_y = -du_z/dx and psi_z = du_y/dx in the segment's own frame, whose x-axis leads from base to tip. The inertia of
//! sections that turn about a diameter is left out, which holds for segments much longer than thick (length over
//! radius above 20).

#[cfg(test)]
pub(crate) mod tests;

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};
use std::f64::consts::PI;

/// Stiffness or mass between the ends of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    /// Base with base.
    pub base: Matrix6<f64>,
    /// Tip with tip.
    pub tip: Matrix6<f64>,
    /// Rows of the tip, columns of the base.
    pub across: Matrix6<f64>,
}

/// What a segment is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Section {
    /// Length, metres.
    pub length: f64,
    /// Radius, metres.
    pub radius: f64,
    /// Young's modulus E, pascals.
    pub young: f64,
    /// Shear modulus G, pascals.
    pub shear: f64,
    /// Kilograms per cubic metre.
    pub density: f64,
}

type Local = SMatrix<f64, 12, 12>;

/// Places of u_y, psi_z and of u_z, psi_y of both ends: the two planes in which it bends.
const PLANES: [([usize; 4], f64); 2] = [([1, 5, 7, 11], 1.0), ([2, 4, 8, 10], -1.0)];

impl Section {
    /// Area of the section, A = pi r^2.
    pub(crate) fn area(&self) -> f64 {
        PI * self.radius.powi(2)
    }

    /// Second moment of area about a diameter, I = pi r^4 / 4 (errata E39: the text has 16).
    fn inertia(&self) -> f64 {
        PI * self.radius.powi(4) / 4.0
    }

    /// Polar moment, J = 2 I (errata E39: the text has the root of 2).
    fn polar(&self) -> f64 {
        2.0 * self.inertia()
    }

    /// Stiffness of a segment in a direction, in the frame of the plant (6.5, with the shape functions of errata E37, E38).
    pub(crate) fn stiffness(&self, direction: &Vector3<f64>) -> Ends {
        let (l, bending) = (self.length, self.young * self.inertia() / self.length.powi(3));
        let mut local = Local::zeros();
        line(&mut local, 0, self.young * self.area() / l, [1.0, -1.0]);
        line(&mut local, 3, self.shear * self.polar() / l, [1.0, -1.0]);
        let (a, b, c) = (6.0 * l, 4.0 * l * l, 2.0 * l * l);
        let hermite = [[12.0, a, -12.0, a], [a, b, -a, c], [-12.0, -a, 12.0, -a], [a, c, -a, b]];
        plane(&mut local, bending, &hermite);
        turned(&local, direction)
    }

    /// A square root G of what the tip gives way by forces and moments there, F = G G^T, with the base clamped and in the
    /// frame of the plant: displacement by force L^3 / 3EI, rotation by moment L / EI, and so on.
    pub(crate) fn flexibility_root(&self, direction: &Vector3<f64>) -> Matrix6<f64> {
        let (l, bending) = (self.length, (self.length / (self.young * self.inertia())).sqrt());
        let mut local = Matrix6::zeros();
        local[(0, 0)] = (l / (self.young * self.area())).sqrt();
        local[(3, 3)] = (l / (self.shear * self.polar())).sqrt();
        // Of [L^2 / 3, L / 2; L / 2, 1]: a turn of 1 at the tip carries it by L / 2.
        for (displacement, rotation, sign) in [(1, 5, 1.0), (2, 4, -1.0)] {
            local[(displacement, displacement)] = bending * l / 12.0_f64.sqrt();
            local[(displacement, rotation)] = bending * sign * l / 2.0;
            local[(rotation, rotation)] = bending;
        }
        let (frame, mut turned) = (frame(direction), Matrix6::zeros());
        for (i, j) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
            let part = local.fixed_view::<3, 3>(i, j);
            turned.fixed_view_mut::<3, 3>(i, j).copy_from(&(frame * part));
        }
        turned
    }

    /// Consistent mass of a segment in a direction, in the frame of the plant (6.8).
    pub(crate) fn mass(&self, direction: &Vector3<f64>) -> Ends {
        let (l, mass) = (self.length, self.density * self.area() * self.length);
        let mut local = Local::zeros();
        line(&mut local, 0, mass / 6.0, [2.0, 1.0]);
        line(&mut local, 3, self.density * self.polar() * l / 6.0, [2.0, 1.0]);
        let (a, b, c, d) = (22.0 * l, 13.0 * l, 4.0 * l * l, -3.0 * l * l);
        let hermite = [[156.0, a, 54.0, -b], [a, c, b, d], [54.0, b, 156.0, -a], [-b, d, -a, c]];
        plane(&mut local, mass / 420.0, &hermite);
        turned(&local, direction)
    }
}

/// A degree of freedom that runs linearly from base to tip.
fn line(local: &mut Local, place: usize, scale: f64, [same, other]: [f64; 2]) {
    for (row, column, share) in [(0, 0, same), (6, 6, same), (0, 6, other), (6, 0, other)] {
        local[(place + row, place + column)] = scale * share;
    }
}

/// Both planes in which a segment bends; in that of u_z rotations count backward (errata E38).
fn plane(local: &mut Local, scale: f64, hermite: &[[f64; 4]; 4]) {
    for (places, sign) in PLANES {
        let signs = [1.0, sign, 1.0, sign];
        for row in 0..4 {
            for column in 0..4 {
                local[(places[row], places[column])] =
                    scale * signs[row] * signs[column] * hermite[row][column];
            }
        }
    }
}

/// From the frame of the segment to that of the plant.
fn turned(local: &Local, direction: &Vector3<f64>) -> Ends {
    let frame = frame(direction);
    let block = |row: usize, column: usize| {
        let mut block = Matrix6::zeros();
        for (i, j) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
            let part = local.fixed_view::<3, 3>(row + i, column + j);
            block.fixed_view_mut::<3, 3>(i, j).copy_from(&(frame * part * frame.transpose()));
        }
        block
    };
    Ends { base: block(0, 0), tip: block(6, 6), across: block(6, 0) }
}

/// A right-handed frame with its x-axis in a direction of length 1: its columns are the axes.
pub(crate) fn frame(direction: &Vector3<f64>) -> Matrix3<f64> {
    // Whatever axis lies most across.
    let across = if direction.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() };
    let y = across.cross(direction).normalize();
    Matrix3::from_columns(&[*direction, y, direction.cross(&y)])
}
