//! The points on which trackers are compared: from a table, from the truth, or as a tracker finds them.

use std::path::Path;

use honami_exchange::PointRow;
use honami_host::{CallContext, DetectRequest, Host, Kind, PluginInfo, Registry, Values};
use honami_media::Media;
use honami_model::track::TrackId;
use honami_motion::accuracy::TruePath;

use super::Truth;
use crate::drive::{MAX_FEATURES, Seed, view};
use crate::error::WorkbenchError;
use crate::stamp::SEED;

/// The interface of trackers that find features themselves.
const DETECT: &str = "honami.detect/1";

/// Points to track from a table.
///
/// # Errors
/// What the table says of its lines.
pub fn read_points(path: &Path) -> Result<Vec<Seed>, WorkbenchError> {
    let seed =
        |row: PointRow| Seed { frame: row.frame.unwrap_or(0), track: TrackId(row.id), x: row.x, y: row.y };
    let rows = honami_exchange::read::<PointRow>(path)?;
    Ok(rows.map(|row| row.map(seed)).collect::<Result<_, _>>()?)
}

/// The points of a truth where they can first be seen.
#[must_use]
pub fn points_of(truth: &Truth) -> Vec<Seed> {
    let first_seen = |(&track, path): (&TrackId, &TruePath)| {
        let (frame, &(x, y, _)) =
            (path.first_frame..).zip(&path.positions).find(|(_, position)| position.2)?;
        Some(Seed { frame, track, x: x as f32, y: y as f32 })
    };
    truth.iter().filter_map(first_seen).collect()
}

/// Points that the first of these trackers finds in a frame that finds any itself, or else the first one there is, with
/// its defaults.
///
/// # Errors
/// [`WorkbenchError::CannotDetect`] when there is none, and what the clip or the tracker met.
pub fn detect(
    media: &Media,
    registry: &Registry,
    host: &Host,
    trackers: &[(&str, &Values)],
    frame: u32,
) -> Result<Vec<Seed>, WorkbenchError> {
    let named = trackers.iter().map(|(name, params)| Ok((registry.find(Kind::Tracker, name)?, *params)));
    let named: Vec<(&PluginInfo, &Values)> = named.collect::<Result<_, WorkbenchError>>()?;
    let usual = Values::default();
    let any = registry.plugins().iter().filter(|plugin| plugin.kind == Kind::Tracker);
    let any = any.map(|plugin| (plugin, &usual));
    let first = named.iter().map(|(plugin, _)| plugin.short_name.clone()).next().unwrap_or_default();
    let (plugin, params) = named
        .into_iter()
        .chain(any)
        .find(|(plugin, _)| plugin.offers(DETECT))
        .ok_or(WorkbenchError::CannotDetect { plugin: first })?;
    let cx = CallContext::silent();
    let (mut tracker, _) = host.tracker(plugin, params, &cx)?;
    let picture = media.frame(frame)?;
    let wanted = DetectRequest {
        frame: view(media, &picture, frame),
        max_features: MAX_FEATURES,
        mask: None,
        points: &[],
        max_threads: 1,
        seed: SEED,
    };
    let found = tracker.detect(&wanted, &cx)?;
    Ok((0..).zip(found).map(|(id, at)| Seed { frame, track: TrackId(id), x: at.x, y: at.y }).collect())
}
