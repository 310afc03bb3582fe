//! Corners that are followed for the sake of a point that would be alone.

use super::Params;
use super::live::{Live, OWN};
use super::neighbours::NEAR_PX;
use super::template::Desk;
use crate::detect;
use crate::{Gray, Point, simd};

/// A corner counts from this share of the strongest around.
const QUALITY: f32 = 0.02;

/// Adds companions to new points with fewer neighbours than they should have; whether any came.
pub(super) fn join(
    live: &mut Vec<Live>,
    picture: &Gray<'_>,
    params: &Params,
    simd: simd::Level,
    n_seeds: &mut u32,
) -> bool {
    let desk = Desk::new(params, simd);
    let wanted = params.companions.min(params.neighbours) as usize;
    let n_before = live.len();
    for slot in 0..n_before {
        let point = &mut live[slot];
        let missing = wanted.saturating_sub(point.near.len());
        let is_alone = point.is_sure && !point.is_companion() && !point.has_company && missing > 0;
        point.has_company = true;
        if is_alone {
            for at in corners(live, slot, picture, params, missing) {
                *n_seeds += 1;
                live.push(Live::new(OWN + u64::from(*n_seeds), at, *n_seeds, Some(picture), &desk));
            }
        }
    }
    live.len() > n_before
}

/// The strongest corners around a point, away from what is followed already.
fn corners(live: &[Live], slot: usize, picture: &Gray<'_>, params: &Params, n: usize) -> Vec<Point> {
    let [x, y] = live[slot].at;
    let first = [x, y].map(|c| (c - NEAR_PX).max(0.0) as u32);
    let end =
        [(x, picture.width), (y, picture.height)].map(|(c, size)| ((c + NEAR_PX).max(0.0) as u32).min(size));
    let [width, height] = [0, 1].map(|axis| end[axis].saturating_sub(first[axis]));
    if width == 0 || height == 0 {
        return Vec::new();
    }
    let data = &picture.data[first[1] as usize * picture.stride + first[0] as usize..];
    let around = Gray { data, width, height, stride: picture.stride };
    let origin = first.map(|c| c as f32);
    let taken: Vec<Point> =
        live.iter().map(|other| [other.at[0] - origin[0], other.at[1] - origin[1]]).collect();
    let wanted = detect::Params {
        max_corners: n,
        quality: QUALITY,
        min_distance_px: params.radius_px as f32,
        ..detect::Params::default()
    };
    let found = detect::corners(&around, None, &taken, &wanted);
    found.iter().map(|corner| [corner.at[0] + origin[0], corner.at[1] + origin[1]]).collect()
}
