//! The linear system of Horn and Schunck, relaxed in the order of a checkerboard.
//!
//! A pixel with the neighbours' mean `(ū, v̄)`, of `n` neighbours in the picture (4; 3 at an edge, 2 in a corner), and
//! the constraint `g·(u, v) + c = 0` is at rest where
//!
//! `(u, v) = (ū, v̄) - g (g·(ū, v̄) + c) / (n α² + |g|²)`,
//!
//! which is Horn and Schunck's iteration. Here the black pixels are all set from the white ones, then the white from
//! the black (D. M. Young, "Iterative solution of large linear systems", 1971), each going [`RELAXATION`] times as far
//! as it is asked to; that lowers the energy with every pixel, and the order of pixels of one colour does not matter.
//!
//! Each colour has memory of its own, so that neighbours lie side by side and rows are many pixels at a time.

use super::Constraint;
use crate::plane::{Motion, Plane, bands};

/// How far a pixel goes of the way it is asked to, 0..2. The number of sweeps that carry motion a distance of L pixels
/// falls from L² (at 1) to L as it nears 2.
const RELAXATION: f32 = 1.9;

/// Sweeps between two looks at how far pixels are off.
const SWEEPS_A_LOOK: u32 = 8;

/// Values of the pixels of either colour. Row y of colour c has the pixels `x = 2k + (y + c) % 2`; where that is
/// beyond the picture the value is 0.
type Colours = [Vec<f32>; 2];

/// The system, and its solution so far.
pub(super) struct System {
    width: usize,
    height: usize,
    /// Values in a row of one colour.
    half: usize,
    u: Colours,
    v: Colours,
    /// Of the constraint, each divided by `√(n α² + |g|²)`.
    gx: Colours,
    gy: Colours,
    rest: Colours,
}

impl System {
    /// `alpha` is in the units of the constraint.
    pub(super) fn new(constraint: &Constraint, start: &Motion, alpha: f32) -> Self {
        let (width, height) = (start.u.width, start.u.height);
        let mut system = Self {
            width,
            height,
            half: width.div_ceil(2),
            u: colours(&start.u),
            v: colours(&start.v),
            gx: colours(&constraint.gx),
            gy: colours(&constraint.gy),
            rest: colours(&constraint.rest),
        };
        for colour in 0..2 {
            for y in 0..height {
                for k in 0..system.half {
                    let i = y * system.half + k;
                    let x = 2 * k + (y + colour) % 2;
                    let n =
                        [x > 0, x + 1 < width, y > 0, y + 1 < height].map(usize::from).iter().sum::<usize>();
                    let (gx, gy) = (system.gx[colour][i], system.gy[colour][i]);
                    let size = n as f32 * alpha * alpha + gx * gx + gy * gy;
                    let scale = if size > 0.0 { 1.0 / size.sqrt() } else { 0.0 };
                    for values in [&mut system.gx, &mut system.gy, &mut system.rest] {
                        values[colour][i] *= scale;
                    }
                }
            }
        }
        system
    }

    /// Sweeps until pixels are off by less than the tolerance, root of the mean square, or so many times; `None` where
    /// `go_on`, told the share of the sweeps, said no.
    pub(super) fn solve(
        &mut self,
        max_sweeps: u32,
        tolerance_px: f32,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<()> {
        for n in 0..max_sweeps {
            if !go_on(f64::from(n) / f64::from(max_sweeps)) {
                return None;
            }
            if n % SWEEPS_A_LOOK == 0 && self.off_px() <= tolerance_px {
                break;
            }
            self.sweep(RELAXATION, n_threads);
        }
        Some(())
    }

    /// Sets every pixel once.
    pub(super) fn sweep(&mut self, relaxation: f32, n_threads: usize) {
        let Self { width, half, .. } = *self;
        let (gx, gy, rest) = (&self.gx, &self.gy, &self.rest);
        for colour in 0..2 {
            let ([own_u, other_u], [own_v, other_v]) = (turn(&mut self.u, colour), turn(&mut self.v, colour));
            let (others, zeros) = ([&*other_u, &*other_v], vec![0.0; half]);
            bands([own_u, own_v], half, n_threads, |first, [u, v]| {
                let rows = u.chunks_exact_mut(half).zip(v.chunks_exact_mut(half));
                for (y, (u, v)) in (first..).zip(rows) {
                    let line = Line { width, offset: (y + colour) % 2, near: near(&others, y, half, &zeros) };
                    let span = y * half..(y + 1) * half;
                    let asks = [gx, gy, rest].map(|values| &values[colour][span.clone()]);
                    line.relax([u, v], asks, relaxation);
                }
            });
        }
    }

    /// How far pixels are off what is asked of them, root of the mean square, pixels.
    fn off_px(&self) -> f32 {
        let zeros = vec![0.0; self.half];
        let mut squares = 0.0_f64;
        let mut row = [0, 1].map(|_| vec![0.0; self.half]);
        for (y, colour) in (0..self.height).flat_map(|y| [(y, 0), (y, 1)]) {
            let span = y * self.half..(y + 1) * self.half;
            let own = [&self.u[colour][span.clone()], &self.v[colour][span.clone()]];
            let others = [&self.u[1 - colour], &self.v[1 - colour]];
            let near = near(&others.map(Vec::as_slice), y, self.half, &zeros);
            let line = Line { width: self.width, offset: (y + colour) % 2, near };
            let asks = [&self.gx, &self.gy, &self.rest].map(|values| &values[colour][span.clone()]);
            row.iter_mut().zip(own).for_each(|(row, own)| row.copy_from_slice(own));
            let [u, v] = &mut row;
            line.relax([u, v], asks, 1.0);
            for (row, own) in row.iter().zip(own) {
                squares += row.iter().zip(own).map(|(a, b)| f64::from((a - b) * (a - b))).sum::<f64>();
            }
        }
        (squares / (self.width * self.height) as f64).sqrt() as f32
    }

    /// The solution so far.
    pub(super) fn motion(&self) -> Motion {
        let whole = |values: &Colours| {
            let mut plane = Plane::blank(self.width, self.height);
            for (y, row) in plane.data.chunks_exact_mut(self.width).enumerate() {
                for (colour, values) in values.iter().enumerate() {
                    let own = row.iter_mut().skip((y + colour) % 2).step_by(2);
                    own.zip(&values[y * self.half..]).for_each(|(to, from)| *to = *from);
                }
            }
            plane
        };
        Motion { u: whole(&self.u), v: whole(&self.v) }
    }
}

/// Sorts the pixels of a picture by colour.
fn colours(plane: &Plane) -> Colours {
    let half = plane.width.div_ceil(2);
    [0, 1].map(|colour| {
        let mut values = vec![0.0; half * plane.height];
        for (y, row) in values.chunks_exact_mut(half).enumerate() {
            let own = plane.row(y).iter().skip((y + colour) % 2).step_by(2);
            row.iter_mut().zip(own).for_each(|(to, from)| *to = *from);
        }
        values
    })
}

/// This colour, and the other.
fn turn(values: &mut Colours, colour: usize) -> [&mut [f32]; 2] {
    let [black, white] = values;
    if colour == 0 { [black, white] } else { [white, black] }
}

/// Rows of the other colour, of u and v: above, beside and below row `y`; zeros beyond the picture.
fn near<'a>(others: &[&'a [f32]; 2], y: usize, half: usize, zeros: &'a [f32]) -> Near<'a> {
    let height = others[0].len() / half;
    let row = |values: &'a [f32], y: usize| &values[y * half..(y + 1) * half];
    Near {
        above: others.map(|values| if y > 0 { row(values, y - 1) } else { zeros }),
        here: others.map(|values| row(values, y)),
        below: others.map(|values| if y + 1 < height { row(values, y + 1) } else { zeros }),
        n_rows: usize::from(y > 0) + usize::from(y + 1 < height),
    }
}

/// See [`near`].
struct Near<'a> {
    above: [&'a [f32]; 2],
    here: [&'a [f32]; 2],
    below: [&'a [f32]; 2],
    /// How many of above and below lie in the picture.
    n_rows: usize,
}

/// Pixels of one colour in a row: `x = 2k + offset`, less than `width`.
struct Line<'a> {
    width: usize,
    offset: usize,
    near: Near<'a>,
}

impl Line<'_> {
    /// Sets the pixels; `asks` are gx, gy and the rest of the constraint.
    fn relax(&self, [u, v]: [&mut [f32]; 2], [gx, gy, rest]: [&[f32]; 3], relaxation: f32) {
        let Self { width, offset, ref near } = *self;
        let n_pixels = (width - offset).div_ceil(2);
        // All but those at the ends of the row have neighbours to the left and to the right.
        let first = (1 - offset).min(n_pixels);
        let end = ((width - 1).max(offset) - offset).div_ceil(2).max(first);
        let share = 1.0 / (near.n_rows + 2) as f32;
        let n = end - first;
        let [[ua, va], [ul, vl], [ur, vr], [ub, vb]] = [
            near.above.map(|row| &row[first..end]),
            near.here.map(|row| &row[(first + offset).max(1) - 1..][..n]),
            near.here.map(|row| &row[(first + offset).min(row.len() - n)..][..n]),
            near.below.map(|row| &row[first..end]),
        ];
        let [gx_inner, gy_inner, rest_inner] = [gx, gy, rest].map(|row| &row[first..end]);
        let (u_inner, v_inner) = (&mut u[first..end], &mut v[first..end]);
        for k in 0..n {
            let mean = [(ua[k] + ub[k] + (ul[k] + ur[k])) * share, (va[k] + vb[k] + (vl[k] + vr[k])) * share];
            let to = at_rest(mean, gx_inner[k], gy_inner[k], rest_inner[k]);
            u_inner[k] += relaxation * (to[0] - u_inner[k]);
            v_inner[k] += relaxation * (to[1] - v_inner[k]);
        }
        for k in (0..first).chain(end..n_pixels) {
            let x = 2 * k + offset;
            let beside = [(x > 0).then(|| k + offset - 1), (x + 1 < width).then(|| k + offset)];
            let n_near = near.n_rows + beside.iter().flatten().count();
            if n_near == 0 {
                continue;
            }
            let mean = [0, 1].map(|axis| {
                let sides: f32 = beside.iter().flatten().map(|&k| near.here[axis][k]).sum();
                (near.above[axis][k] + near.below[axis][k] + sides) / n_near as f32
            });
            let to = at_rest(mean, gx[k], gy[k], rest[k]);
            u[k] += relaxation * (to[0] - u[k]);
            v[k] += relaxation * (to[1] - v[k]);
        }
    }
}

/// Where a pixel is at rest, from its neighbours' mean and its own constraint.
#[inline(always)]
fn at_rest(mean: [f32; 2], gx: f32, gy: f32, rest: f32) -> [f32; 2] {
    let off = gx * mean[0] + gy * mean[1] + rest;
    [mean[0] - gx * off, mean[1] - gy * off]
}
