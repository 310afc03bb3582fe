//! Corners that are followed for the sake of a point that would be alone.

use super::Params;
use super::live::{Live, OWN};
use super::neighbours::NEAR_PX;
use super::template::Desk;
use crate::detect;
use crate::{Gray, Point, simd};

/// A corner counts from this share of the strongest around.
const QUALITY: f32 = 0.02;

/// So many may be followed for the sake of others, or as many as there are others.
const AT_MOST: usize = 2000;

/// Adds companions to new points with fewer neighbours than they should have; whether any came.
///
/// Those that came for the sake of a point near by count. Where there could be more than [`AT_MOST`], all get fewer.
/// `go_on` is asked before every point that is given some.
pub(super) fn join<E>(
    live: &mut Vec<Live>,
    picture: &Gray<'_>,
    params: &Params,
    simd: simd::Level,
    n_seeds: &mut u32,
    go_on: &mut dyn FnMut(f64) -> Result<(), E>,
) -> Result<bool, E> {
    let desk = Desk::new(params, simd);
    let wanted = params.companions.min(params.neighbours) as usize;
    let n_before = live.len();
    let n_others = live.partition_point(|point| !point.is_companion());
    let alone: Vec<usize> = (0..n_others)
        .filter(|&slot| {
            let point = &mut live[slot];
            let is_new = point.is_sure && !std::mem::replace(&mut point.has_company, true);
            is_new && point.near.len() < wanted
        })
        .collect();
    let room = AT_MOST.max(n_others).saturating_sub(n_before - n_others);
    let share = room / alone.len().max(1);
    for (k, &slot) in alone.iter().enumerate() {
        go_on(k as f64 / alone.len() as f64)?;
        let [x, y] = live[slot].at;
        let is_near = |other: &&Live| (other.at[0] - x).hypot(other.at[1] - y) <= NEAR_PX;
        let n_near = live[slot].near.len() + live[n_before..].iter().filter(is_near).count();
        let missing = wanted.saturating_sub(n_near).min(share);
        if missing > 0 {
            for at in corners(live, slot, picture, params, missing) {
                *n_seeds += 1;
                live.push(Live::new(OWN + u64::from(*n_seeds), at, *n_seeds, Some(picture), &desk));
            }
        }
    }
    Ok(live.len() > n_before)
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
    let reach = 2.0 * NEAR_PX;
    let is_around = |other: &&Live| (other.at[0] - x).abs().max((other.at[1] - y).abs()) <= reach;
    let inward = |other: &Live| [other.at[0] - origin[0], other.at[1] - origin[1]];
    let taken: Vec<Point> = live.iter().filter(is_around).map(inward).collect();
    let wanted = detect::Params {
        max_corners: n,
        quality: QUALITY,
        min_distance_px: params.radius_px as f32,
        ..detect::Params::default()
    };
    let found = detect::corners(&around, None, &taken, &wanted);
    found.iter().map(|corner| [corner.at[0] + origin[0], corner.at[1] + origin[1]]).collect()
}
