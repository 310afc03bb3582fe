//! The space that branches are to fill (Zeng 5.5.2, 6.4): an outline turned about the upright axis of the plant.
//!
//! The outline is the convex hull of the plant in the picture, or what is white in an image. Turned about, its left half and
//! its right give two circles of one height; the wider one is taken (errata Z10).

use std::f64::consts::TAU;

/// Attractors in a circle, and circles: 256 in all; 200 to 300 serve (Zeng 5.5.2).
const AROUND: usize = 16;
const CIRCLES: usize = 16;
/// Heights at which the outline of a hull is looked at.
const HEIGHTS: u32 = 400;
/// A brightness from here on is white.
const WHITE: u8 = 128;
/// Beyond the outline by less than this share of its width is on it: what lies on the hull is turned about, too.
const ON_IT: f64 = 1e-9;

/// An image in which branches may be where it is white, as large as the clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alpha {
    /// Pixels a row.
    pub width: usize,
    /// Row after row, the uppermost first.
    pub pixels: Vec<u8>,
}

/// How far it goes from the axis, by height.
#[derive(Clone, Debug, PartialEq)]
enum Outline {
    /// Corners of a convex polygon, from the axis to the right and up.
    Hull(Vec<[f64; 2]>),
    /// Row by row of a picture, `None` where there is nothing.
    Rows(Vec<Option<f64>>),
}

/// The space within.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Envelope {
    /// Pixels, right.
    axis: f64,
    outline: Outline,
}

impl Envelope {
    /// Around places, pixels (right, up).
    pub(super) fn around(places: &[[f64; 2]], axis: f64) -> Self {
        let beside = places.iter().map(|[x, z]| [x - axis, *z]).collect();
        Self { axis, outline: Outline::Hull(hull(beside)) }
    }

    /// What is white in an image; `None` where nothing is.
    pub(super) fn painted(alpha: &Alpha, axis: f64) -> Option<Self> {
        let reach = |row: &[u8]| {
            let white = row.iter().enumerate().filter(|(_, pixel)| **pixel >= WHITE);
            // To the far edge of the pixel, whose number is its middle's.
            white.map(|(x, _)| (x as f64 - axis).abs() + 0.5).max_by(f64::total_cmp)
        };
        let rows: Vec<Option<f64>> = alpha.pixels.chunks(alpha.width.max(1)).map(reach).collect();
        rows.iter().any(Option::is_some).then_some(Self { axis, outline: Outline::Rows(rows) })
    }

    /// How far it goes from the axis at a height, pixels; `None` above and below it.
    fn reach(&self, z: f64) -> Option<f64> {
        match &self.outline {
            Outline::Rows(rows) => {
                let y = (-z).round();
                if y < 0.0 { None } else { rows.get(y as usize).copied().flatten() }
            }
            Outline::Hull(corners) => {
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).filter_map(|(a, b)| across(*a, *b, z)).max_by(f64::total_cmp)
            }
        }
    }

    /// Whether a place is within.
    pub(super) fn holds(&self, [x, y, z]: [f64; 3]) -> bool {
        let far = (x - self.axis).hypot(y);
        self.reach(z).is_some_and(|reach| far <= reach + ON_IT * (1.0 + reach))
    }

    /// Places all over it that draw branches: circles evenly spaced along the outline, from the axis at the bottom round to
    /// the axis at the top, and attractors evenly in each.
    pub(super) fn attractors(&self) -> Vec<[f64; 3]> {
        let walk = self.walk();
        let mut so_far = vec![0.0];
        let mut sum = 0.0;
        for pair in walk.windows(2) {
            sum += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            so_far.push(sum);
        }
        let mut attractors = Vec::with_capacity(AROUND * CIRCLES);
        for circle in 0..CIRCLES {
            let wanted = sum * (circle as f64 + 0.5) / CIRCLES as f64;
            let after = so_far.partition_point(|&far| far < wanted).clamp(1, walk.len().max(2) - 1);
            let (Some(a), Some(b)) = (walk.get(after - 1), walk.get(after)) else {
                continue;
            };
            let step = so_far[after] - so_far[after - 1];
            let share = if step > 0.0 { (wanted - so_far[after - 1]) / step } else { 0.0 };
            let (r, z) = (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]));
            attractors.extend((0..AROUND).map(|k| {
                let angle = TAU * k as f64 / AROUND as f64;
                [self.axis + r * angle.cos(), r * angle.sin(), z]
            }));
        }
        attractors
    }

    /// The outline as (from the axis, up), upwards.
    fn walk(&self) -> Vec<[f64; 2]> {
        let heights: Vec<f64> = match &self.outline {
            Outline::Rows(rows) => (0..rows.len()).rev().map(|y| -(y as f64)).collect(),
            Outline::Hull(corners) => {
                let low = corners.iter().map(|at| at[1]).fold(f64::INFINITY, f64::min);
                let high = corners.iter().map(|at| at[1]).fold(f64::NEG_INFINITY, f64::max);
                let at = |k: u32| low + (high - low) * f64::from(k) / f64::from(HEIGHTS);
                (0..HEIGHTS).map(at).chain([high]).collect()
            }
        };
        let mut walk: Vec<[f64; 2]> = heights.into_iter().filter_map(|z| Some([self.reach(z)?, z])).collect();
        let ends = walk.first().zip(walk.last()).map(|(first, last)| [[0.0, first[1]], [0.0, last[1]]]);
        if let Some([first, last]) = ends {
            walk.insert(0, first);
            walk.push(last);
        }
        walk
    }
}

/// How far from the axis an edge is at most at a height; `None` where it does not come to it.
fn across(a: [f64; 2], b: [f64; 2], z: f64) -> Option<f64> {
    if (a[1] - z) * (b[1] - z) > 0.0 {
        return None;
    }
    let rise = b[1] - a[1];
    if rise.abs() > 0.0 {
        Some((a[0] + (b[0] - a[0]) * (z - a[1]) / rise).abs())
    } else {
        Some(a[0].abs().max(b[0].abs()))
    }
}

/// Corners of the smallest convex polygon about places, counterclockwise (Andrew's monotone chain); one of one place, two of
/// places on a line.
fn hull(mut places: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    places.dedup();
    if places.len() < 3 {
        return places;
    }
    let half = |places: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for at in places {
            while let [.., a, b] = corners[..] {
                if (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]) > 0.0 {
                    break;
                }
                corners.pop();
            }
            corners.push(at);
        }
        corners.pop();
        corners
    };
    let mut corners = half(&mut places.iter().copied());
    corners.extend(half(&mut places.iter().rev().copied()));
    corners
}
