//! Which vectors are believed, and what stands in for the others.
//!
//! J. Westerweel, F. Scarano, "Universal outlier detection for PIV data", Exp. Fluids 39 (2005): a vector `U` among
//! neighbours `U_i` with the median `U_m` has the residual `|U - U_m| / (median |U_i - U_m| + ε)`.

use super::{Params, Vector};
use crate::field::{Field, Grid};

/// What correlation is off by at best, pixels: the ε of the residual.
const NOISE_PX: f32 = 0.1;
/// Fewer neighbours say nothing.
const NEIGHBOURS: usize = 3;
/// Of the eight neighbours so many stand in for a vector that is not believed.
const WITNESSES: usize = 5;

/// Believes, or not, and replaces.
pub(super) fn validate(grid: Grid, found: &[Option<Vector>], params: &Params) -> Field {
    let mut vectors: Vec<Option<[f32; 2]>> =
        found.iter().map(|v| v.filter(|v| v.ratio >= params.peak_ratio).map(|v| v.to)).collect();
    if params.median_limit > 0.0 {
        let believed: Vec<bool> = (0..vectors.len())
            .map(|i| {
                vectors[i].is_some_and(|v| residual(v, &around(&grid, &vectors, i)) <= params.median_limit)
            })
            .collect();
        vectors.iter_mut().zip(believed).for_each(|(vector, believed)| *vector = vector.filter(|_| believed));
    }
    // Those that were measured stand in for others; those that stand in do not.
    let replaced = (0..vectors.len()).map(|i| {
        vectors[i].or_else(|| {
            let around = around(&grid, &vectors, i);
            (around.len() >= WITNESSES).then(|| median(&around))
        })
    });
    Field::new(grid, replaced)
}

/// The field with every node that is not known at the mean of its neighbours, ring by ring: where to look next.
pub(super) fn filled(field: Field) -> Field {
    let mut vectors: Vec<Option<[f32; 2]>> =
        (0..field.known.len()).map(|i| field.known[i].then_some([field.u[i], field.v[i]])).collect();
    let mut ring: Vec<usize> = (0..vectors.len()).filter(|&i| vectors[i].is_none()).collect();
    while !ring.is_empty() {
        let found: Vec<_> =
            ring.iter().filter_map(|&i| Some((i, mean(&around(&field.grid, &vectors, i))?))).collect();
        found.iter().for_each(|&(i, vector)| vectors[i] = Some(vector));
        let next = found.iter().flat_map(|&(i, _)| neighbours(&field.grid, i));
        ring = next.filter(|&i| vectors[i].is_none()).collect();
        ring.sort_unstable();
        ring.dedup();
    }
    Field::new(field.grid, vectors)
}

/// How far a vector is from the median of its neighbours, in their own measure; 0 where there are too few.
fn residual(vector: [f32; 2], around: &[[f32; 2]]) -> f32 {
    if around.len() < NEIGHBOURS {
        return 0.0;
    }
    let middle = median(around);
    let away = |v: [f32; 2]| (v[0] - middle[0]).hypot(v[1] - middle[1]);
    let usual = middle_of(around.iter().map(|&v| away(v)).collect());
    away(vector) / (usual + NOISE_PX)
}

/// The eight nodes around one, or fewer at the border.
fn neighbours(grid: &Grid, i: usize) -> impl Iterator<Item = usize> + use<> {
    let (nx, ny) = (grid.nx as usize, grid.ny as usize);
    let (x, y) = (i % nx, i / nx);
    let rows = y.saturating_sub(1)..(y + 2).min(ny);
    let columns = x.saturating_sub(1)..(x + 2).min(nx);
    rows.flat_map(move |row| columns.clone().map(move |column| row * nx + column)).filter(move |&j| j != i)
}

/// Their vectors, without those that are not known.
fn around(grid: &Grid, vectors: &[Option<[f32; 2]>], i: usize) -> Vec<[f32; 2]> {
    neighbours(grid, i).filter_map(|j| vectors[j]).collect()
}

/// `None` of nothing.
fn mean(vectors: &[[f32; 2]]) -> Option<[f32; 2]> {
    let of = |axis: usize| vectors.iter().map(|v| v[axis]).sum::<f32>() / vectors.len() as f32;
    (!vectors.is_empty()).then(|| [of(0), of(1)])
}

/// Median along x and along y.
fn median(vectors: &[[f32; 2]]) -> [f32; 2] {
    [0, 1].map(|axis| middle_of(vectors.iter().map(|v| v[axis]).collect()))
}

/// The middle one of some numbers, or the mean of the two in the middle.
fn middle_of(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { (values[half - 1] + values[half]) / 2.0 }
}
