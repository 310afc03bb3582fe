//! How much of the sky is seen from a place in a crown: what is left of rays on their way up through its leaves.

use honami_mechanics::Vector;

use super::foliage::Hung;

/// Cells along the longest side of the box round all leaves.
const CELLS: f64 = 24.0;
/// Of a leaf's length squared, the mean area that it takes out of a ray.
pub(crate) const SHADE: f64 = 0.12;

/// Leaves in cells, and what is seen through them.
pub(super) struct Light {
    least: Vector,
    cell: f64,
    sizes: [usize; 3],
    /// What a metre of a cell takes away, per metre.
    thickness: Vec<f64>,
    rays: Vec<Vector>,
}

impl Light {
    pub(super) fn through(hung: &[Hung]) -> Self {
        let (mut least, mut most) = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        for leaf in hung {
            (least, most) = (least.inf(&leaf.at), most.sup(&leaf.at));
        }
        let sides = if hung.is_empty() { Vector::zeros() } else { most - least };
        let cell = (sides.max() / CELLS).max(1e-9);
        let sizes = [0, 1, 2].map(|axis| (sides[axis] / cell) as usize + 1);
        let thickness = vec![0.0; sizes.iter().product()];
        let mut made = Self { least, cell, sizes, thickness, rays: rays() };
        for leaf in hung {
            if let Some(at) = made.cell_of(&leaf.at) {
                made.thickness[at] += SHADE * f64::from(leaf.length).powi(2) / cell.powi(3);
            }
        }
        made
    }

    /// The share of the sky that is left, weighted as on a level surface.
    pub(super) fn at(&self, place: &Vector) -> f32 {
        if self.thickness.len() == 1 && self.thickness[0] == 0.0 {
            return 1.0;
        }
        let (mut seen, mut all) = (0.0, 0.0);
        for ray in &self.rays {
            let (mut at, mut taken) = (place + ray * self.cell, 0.0);
            while let Some(cell) = self.cell_of(&at) {
                taken += self.thickness[cell] * self.cell;
                at += ray * self.cell;
            }
            seen += ray.z * (-taken).exp();
            all += ray.z;
        }
        (seen / all) as f32
    }

    fn cell_of(&self, at: &Vector) -> Option<usize> {
        let mut index = 0;
        for axis in [2, 1, 0] {
            let along = ((at[axis] - self.least[axis]) / self.cell).floor();
            if !(along >= 0.0 && along < self.sizes[axis] as f64) {
                return None;
            }
            index = index * self.sizes[axis] + along as usize;
        }
        Some(index)
    }
}

/// Up, and two rings about it.
fn rays() -> Vec<Vector> {
    let ring = |n: u32, from_up: f64| {
        (0..n).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
            let (out, up) = from_up.sin_cos();
            Vector::new(cos * out, sin * out, up)
        })
    };
    std::iter::once(Vector::z()).chain(ring(6, 0.6)).chain(ring(8, 1.15)).collect()
}
