//! Dense motion as colour: velocities on a grid, painted over every pixel between its nodes.

use super::{Mapping, over};

/// The usual speed of a field is one that so many of its velocities do not pass: most of a picture is at rest.
const USUAL: f64 = 0.99;

/// Velocities at the nodes of a grid over a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityField {
    /// Position of node (0, 0), pixels.
    pub origin: [f64; 2],
    /// Distance between nodes, pixels, more than 0.
    pub step_px: f64,
    /// Nodes in x, at least 1.
    pub nx: usize,
    /// Velocities, px/s, row-major, whole rows of `nx`; `None` where nothing is known.
    pub velocities: Vec<Option<[f32; 2]>>,
}

impl VelocityField {
    /// Velocity at an image point, px/s: bilinear between the nodes round it, and up to half a step beyond the outer
    /// ones that of the nearest. Nodes that are not known leave their weight to the others; `None` where they have
    /// more than half of it, and farther out.
    #[must_use]
    pub fn at(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let place = |axis: usize, n: usize| {
            let last = n.checked_sub(1)? as f64;
            let place = (point[axis] - self.origin[axis]) / self.step_px;
            (-0.5..=last + 0.5).contains(&place).then(|| {
                let place = place.clamp(0.0, last);
                let first = place.floor() as usize;
                ([first, (first + 1).min(n - 1)], place.fract())
            })
        };
        let ny = self.velocities.len() / self.nx.max(1);
        let ((columns, right), (rows, down)) = (place(0, self.nx)?, place(1, ny)?);
        let (mut sum, mut known) = ([0.0; 2], 0.0);
        for (row, of_row) in rows.into_iter().zip([1.0 - down, down]) {
            for (column, of_column) in columns.into_iter().zip([1.0 - right, right]) {
                if let Some(velocity) = self.velocities[row * self.nx + column] {
                    let weight = of_row * of_column;
                    sum = [0, 1].map(|axis| sum[axis] + weight * f64::from(velocity[axis]));
                    known += weight;
                }
            }
        }
        (known >= 0.5).then(|| sum.map(|c| c / known))
    }

    /// The speed that all but a hundredth of the velocities do not pass, px/s; `None` where nothing moves.
    #[must_use]
    pub fn usual_speed(&self) -> Option<f64> {
        let speed = |[u, v]: &[f32; 2]| f64::from(*u).hypot(f64::from(*v));
        let mut speeds: Vec<f64> = self.velocities.iter().flatten().map(speed).collect();
        speeds.sort_by(f64::total_cmp);
        let at = (speeds.len().saturating_sub(1) as f64 * USUAL).round() as usize;
        speeds.get(at).copied().filter(|speed| *speed > 0.0)
    }
}

/// Paints a field over a picture of row-major pixels, `columns` wide; `image_of` says which image point a pixel, across
/// and down, shows in its middle.
pub fn paint_field(
    pixels: &mut [[u8; 3]],
    columns: usize,
    field: &VelocityField,
    mapping: &Mapping,
    image_of: impl Fn([f64; 2]) -> [f64; 2],
) {
    for (row, pixels) in pixels.chunks_mut(columns.max(1)).enumerate() {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let tint =
                field.at(image_of([column as f64, row as f64])).and_then(|velocity| mapping.tint(velocity));
            *pixel = tint.map_or(*pixel, |tint| over(*pixel, tint));
        }
    }
}

#[cfg(test)]
mod tests;
