//! Who is whose partner, how far clocks are apart, and how axes are turned.

use honami_cameras::align::{Similarity, aligned};
use honami_cameras::assign::assigned;
use honami_cameras::clock::{Offset, Signal, by_movement};
use honami_cameras::{CameraError, Place};

use super::{Record, Wish};
use crate::error::SensorsError;

/// Turns of the power method: the axis in which something moves most need not be exact.
const TURNS: usize = 40;
/// Once axes are known, the offset is looked for within so many steps.
const STEPS: f64 = 2.0;

/// A track and its sensor at the times at which both are known.
pub(super) struct Pair {
    pub(super) track: usize,
    pub(super) sensor: usize,
    pub(super) times_s: Vec<f64>,
    /// In the tracks' axes.
    pub(super) tracked: Vec<Place>,
    pub(super) sensed: Vec<Place>,
}

/// All that is together.
pub(super) struct Met {
    pub(super) offset_s: f64,
    pub(super) found: Option<Offset>,
    pub(super) axes: Similarity,
    pub(super) scale: f64,
    /// Whether the sensors' places fit far better seen in a mirror.
    pub(super) is_mirrored: bool,
    pub(super) pairs: Vec<Pair>,
}

pub(super) fn meet(tracks: &[Record], sensors: &[Record], wish: &Wish) -> Result<Met, SensorsError> {
    let named = by_name(tracks, sensors);
    let (mut partners, start) = if named.is_empty() {
        by_movement_of(tracks, sensors, wish)?
    } else {
        let offsets =
            named.iter().filter_map(|&[a, b]| principal(&tracks[a], &sensors[b], 0.0, wish.most_s).ok());
        let start = wish.offset_s.or_else(|| Some(mean(&offsets.collect::<Vec<_>>())?.seconds));
        (named.clone(), start.ok_or(SensorsError::Clock(CameraError::Strangers))?)
    };
    let (mut pairs, mut axes) = aligned_at(tracks, sensors, &partners, start)?;
    if named.is_empty() {
        let nearest = by_place(tracks, sensors, &axes);
        if nearest != partners {
            partners = nearest;
            (pairs, axes) = aligned_at(tracks, sensors, &partners, start)?;
        }
    }
    let found = match wish.offset_s {
        Some(_) => None,
        None => Some(refined(tracks, sensors, &partners, &axes, start)?),
    };
    let offset_s = found.map_or(start, |found| found.seconds);
    if found.is_some() {
        (pairs, axes) = aligned_at(tracks, sensors, &partners, offset_s)?;
    }
    let (from, to) = joined(&pairs);
    let scale = aligned(&from, &to, true).map_err(SensorsError::Axes)?.scale;
    let is_mirrored = is_mirrored(&from, &to)?;
    Ok(Met { offset_s, found, axes, scale, is_mirrored, pairs })
}

/// Whether places fit others far better in a mirror than turned, whatever their scale: one of both has left-handed axes.
fn is_mirrored(from: &[Place], to: &[Place]) -> Result<bool, SensorsError> {
    /// A fit that leaves so much of what the other leaves is far better.
    const FAR_BETTER: f64 = 0.5;
    let left_over = |to: &[Place]| -> Result<f64, SensorsError> {
        let axes = aligned(from, to, true).map_err(SensorsError::Axes)?;
        let squares = from.iter().zip(to).map(|(from, to)| (axes.of(from) - to).norm_squared());
        Ok(squares.sum::<f64>().sqrt() / axes.scale.abs())
    };
    let mirror: Vec<Place> = to.iter().map(|place| Place::new(-place.x, place.y, place.z)).collect();
    Ok(left_over(&mirror)? < FAR_BETTER * left_over(to)?)
}

/// Tracks and sensors of the same name; a track may be `track 3` where the sensor is `3`.
fn by_name(tracks: &[Record], sensors: &[Record]) -> Vec<[usize; 2]> {
    let plain = |name: &str| {
        let name = name.trim().to_lowercase();
        ["track ", "marker ", "sensor "]
            .iter()
            .find_map(|word| name.strip_prefix(word))
            .unwrap_or(&name)
            .to_owned()
    };
    let track_of =
        |sensor: &Record| tracks.iter().position(|track| plain(&track.name) == plain(&sensor.name));
    sensors.iter().enumerate().filter_map(|(b, sensor)| Some([track_of(sensor)?, b])).collect()
}

/// Partners by how they move, each along the axis in which it moves most, and the offset of the clocks.
fn by_movement_of(
    tracks: &[Record],
    sensors: &[Record],
    wish: &Wish,
) -> Result<(Vec<[usize; 2]>, f64), SensorsError> {
    let about = wish.offset_s.unwrap_or(0.0);
    let within = if wish.offset_s.is_some() { 0.0 } else { wish.most_s };
    let mut best: Result<Offset, CameraError> = Err(CameraError::Strangers);
    for (track, sensor) in tracks.iter().flat_map(|track| sensors.iter().map(move |sensor| (track, sensor))) {
        if let Ok(found) = principal(track, sensor, about, within)
            && !best.as_ref().is_ok_and(|best| best.alike.abs() >= found.alike.abs())
        {
            best = Ok(found);
        }
    }
    let best = best.map_err(|error| match wish.offset_s {
        Some(offset_s) if !is_together(tracks, sensors, offset_s) => apart(tracks, sensors, offset_s),
        _ => SensorsError::Clock(error),
    })?;
    let offset = wish.offset_s.unwrap_or(best.seconds);
    let cost = |track: &Record, sensor: &Record| {
        let near = STEPS * track.step_s().max(sensor.step_s());
        principal(track, sensor, offset, near).map_or(1.0, |found| 1.0 - found.alike.abs())
    };
    let costs: Vec<f64> =
        sensors.iter().flat_map(|sensor| tracks.iter().map(move |track| cost(track, sensor))).collect();
    let found = assigned(&costs, tracks.len());
    Ok((found.iter().enumerate().filter_map(|(b, a)| Some([(*a)?, b])).collect(), offset))
}

/// For each sensor the track that is nearest on average, once axes are known.
fn by_place(tracks: &[Record], sensors: &[Record], axes: &Similarity) -> Vec<[usize; 2]> {
    let middle = |record: &Record| record.places.iter().sum::<Place>() / record.places.len() as f64;
    let tracked: Vec<Place> = tracks.iter().map(|track| axes.of(&middle(track))).collect();
    let cost = |sensor: &Record| {
        let sensed = middle(sensor);
        tracked.iter().map(move |place| (place - sensed).norm_squared()).collect::<Vec<_>>()
    };
    let costs: Vec<f64> = sensors.iter().flat_map(cost).collect();
    assigned(&costs, tracks.len()).iter().enumerate().filter_map(|(b, a)| Some([(*a)?, b])).collect()
}

/// The offset at which two move most alike, each along the axis in which it moves most.
fn principal(track: &Record, sensor: &Record, about_s: f64, most_s: f64) -> Result<Offset, CameraError> {
    let shifted: Vec<f64> = sensor.times_s.iter().map(|t| t - about_s).collect();
    let (mine, theirs) = (strongest(track), strongest(sensor));
    let first = Signal { times_s: &track.times_s, values: &mine };
    let second = Signal { times_s: &shifted, values: &theirs };
    let is_near = most_s <= STEPS * track.step_s().max(sensor.step_s());
    let found = match by_movement(first, second, most_s) {
        // How alike they are near an offset that is given, whether or not they are more so elsewhere.
        Err(CameraError::AtTheEnd { offset }) if is_near => offset,
        found => found?,
    };
    Ok(Offset {
        seconds: found.seconds + about_s,
        rival_s: found.rival_s.map(|rival| rival + about_s),
        ..found
    })
}

/// Displacements along the axis in which something moves most.
fn strongest(record: &Record) -> Vec<f64> {
    let middle = record.places.iter().sum::<Place>() / record.places.len().max(1) as f64;
    let moved: Vec<Place> = record.places.iter().map(|place| place - middle).collect();
    // No axis of a plant is exactly across this one.
    let mut axis = Place::new(0.61, 0.55, 0.57);
    for _ in 0..TURNS {
        let next: Place = moved.iter().map(|d| d * d.dot(&axis)).sum();
        axis = next.try_normalize(0.0).unwrap_or(axis);
    }
    moved.iter().map(|d| d.dot(&axis)).collect()
}

/// Partners at the times that they share, and what brings the tracks over the sensors.
fn aligned_at(
    tracks: &[Record],
    sensors: &[Record],
    partners: &[[usize; 2]],
    offset_s: f64,
) -> Result<(Vec<Pair>, Similarity), SensorsError> {
    let pairs: Vec<Pair> = partners.iter().map(|&[a, b]| pair(tracks, sensors, [a, b], offset_s)).collect();
    let (from, to) = joined(&pairs);
    if from.is_empty() {
        return Err(apart(tracks, sensors, offset_s));
    }
    let axes = aligned(&from, &to, false).map_err(SensorsError::Axes)?;
    Ok((pairs, axes))
}

/// First and last time of several.
fn ends(records: &[Record]) -> [f64; 2] {
    let times = || records.iter().flat_map(|record| record.times_s.iter().copied());
    [times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)]
}

fn is_together(tracks: &[Record], sensors: &[Record], offset_s: f64) -> bool {
    let ([first, last], [begin, end]) = (ends(tracks), ends(sensors));
    first + offset_s <= end && begin <= last + offset_s
}

fn apart(tracks: &[Record], sensors: &[Record], offset_s: f64) -> SensorsError {
    SensorsError::Apart { offset_s, tracks_s: ends(tracks), sensors_s: ends(sensors) }
}

fn pair(tracks: &[Record], sensors: &[Record], [track, sensor]: [usize; 2], offset_s: f64) -> Pair {
    let own = &tracks[track];
    let times: Vec<f64> = own.times_s.iter().map(|t| t + offset_s).collect();
    let mut pair = Pair { track, sensor, times_s: Vec::new(), tracked: Vec::new(), sensed: Vec::new() };
    for ((sensed, t), tracked) in sensors[sensor].at(&times).into_iter().zip(&own.times_s).zip(&own.places) {
        if let Some(sensed) = sensed {
            pair.times_s.push(*t);
            pair.tracked.push(*tracked);
            pair.sensed.push(sensed);
        }
    }
    pair
}

fn joined(pairs: &[Pair]) -> (Vec<Place>, Vec<Place>) {
    let all = |of: fn(&Pair) -> &Vec<Place>| pairs.iter().flat_map(|pair| of(pair).iter().copied()).collect();
    (all(|pair| &pair.tracked), all(|pair| &pair.sensed))
}

/// The offset along all axes of all partners, now that axes are known.
fn refined(
    tracks: &[Record],
    sensors: &[Record],
    partners: &[[usize; 2]],
    axes: &Similarity,
    about_s: f64,
) -> Result<Offset, SensorsError> {
    let mut found = Vec::new();
    for &[a, b] in partners {
        let turned = Record {
            places: tracks[a].places.iter().map(|place| axes.of(place)).collect(),
            ..tracks[a].clone()
        };
        let shifted: Vec<f64> = sensors[b].times_s.iter().map(|t| t - about_s).collect();
        let most = STEPS * turned.step_s().max(sensors[b].step_s());
        for axis in 0..3 {
            let (mine, theirs) = (turned.along(axis), sensors[b].along(axis));
            let first = Signal { times_s: &turned.times_s, values: &mine };
            let second = Signal { times_s: &shifted, values: &theirs };
            if let Ok(offset) = by_movement(first, second, most)
                && offset.alike > 0.0
            {
                found.push(Offset { seconds: offset.seconds + about_s, ..offset });
            }
        }
    }
    mean(&found).ok_or(SensorsError::Clock(CameraError::Strangers))
}

/// Offsets weighted by their errors; the error of the mean is as large as they differ, if that is more.
fn mean(offsets: &[Offset]) -> Option<Offset> {
    let weight = |offset: &Offset| 1.0 / (offset.error_s * offset.error_s);
    let total: f64 = offsets.iter().map(weight).sum();
    let average = |of: fn(&Offset) -> f64| offsets.iter().map(|o| weight(o) * of(o)).sum::<f64>() / total;
    let seconds = average(|offset| offset.seconds);
    let misfit: f64 = offsets.iter().map(|o| weight(o) * (o.seconds - seconds).powi(2)).sum();
    let excess = (misfit / (offsets.len().max(2) - 1) as f64).max(1.0);
    let alike = average(|offset| offset.alike.abs());
    (!offsets.is_empty()).then(|| Offset { seconds, error_s: (excess / total).sqrt(), alike, rival_s: None })
}
