//! Components of motion: what moves together, where, along which line and how fast.
//!
//! The bi-orthogonal decomposition of tracks ([`honami_motion::bod`]) as it is shown: a map and a spectrum for each component that
//! stands out of the noise.

use std::path::Path;
use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::track::{Span, TrackId};
use honami_motion::Positions;
use honami_motion::bod::{Axis, Bod, Table};
use honami_motion::spectrum::{Analyser, Peak, Spectrum};
use honami_store::Project;

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};
use crate::spectra::{self, OVER_FLOOR, positions};

/// The edge of noise is told from the median of as many singular values as there are frames, or twice as many as tracks.
pub(crate) const FEWEST_TRACKS: usize = 4;
pub(crate) const FEWEST_FRAMES: usize = 8;

/// Something that moves together.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Singular value, pixels.
    pub singular_px: f64,
    /// Its share of all motion, noise included, 0 to 1.
    pub share: f64,
    /// Where it goes along which line.
    pub axis: Axis,
    /// The fewest tracks that have half of it.
    pub n_half: usize,
    /// How it moves in time, of mean square 1: a number for every frame of the clip, `None` where fewer than two tracks are seen.
    pub chronos: Vec<Option<f64>>,
    /// How far each track goes with it, root of the mean square over frames, pixels, x right and y down; in the order of
    /// [`Components::places`]. A track's motion is the sum over components of this times the chronos.
    pub topos_px: Vec<[f64; 2]>,
    /// Power of the chronos over frequency, without a unit: a sine has 2 at its peak.
    pub spectrum: Spectrum,
    /// Where the chronos is strongest, if that stands out.
    pub peak: Option<Peak>,
    /// How broad the peak is at half its power.
    pub width_hz: Option<f64>,
}

/// The components of tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// Tracks that are seen together with others, and their mean places, pixels.
    pub places: Vec<(TrackId, [f64; 2])>,
    /// Frames in which two or more are seen.
    pub n_frames: usize,
    /// The frame that times and chronoi begin with: 0, or the first of a table.
    pub first_frame: u32,
    /// Time of every frame of the clip, seconds.
    pub times_s: Vec<f64>,
    /// Positions that were not seen in these, and are filled from the other tracks.
    pub n_filled: usize,
    /// The largest singular value that noise alone could have, pixels.
    pub edge_px: f64,
    /// Components above it.
    pub n_above: usize,
    /// And below it.
    pub n_below: usize,
    /// Those above, or the strongest of them, the strongest first.
    pub list: Vec<Component>,
}

/// The components of a project's shown tracks, so many at most.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], [`WorkbenchError::TooFewToPart`], [`WorkbenchError::Still`], tracks that are never seen together,
/// a clip too short for a spectrum, and a stop.
pub fn of_project(
    project: &Project,
    most: usize,
    progress: &dyn Progress,
) -> Result<Components, WorkbenchError> {
    of(&project.clip().clip.times, &project.shown_all()?, most, progress)
}

/// The components of a table of tracks; every frame of it needs a time.
///
/// # Errors
/// What the table says of its lines, [`WorkbenchError::NoTimes`], and as [`of_project`].
pub fn of_table(path: &Path, most: usize, progress: &dyn Progress) -> Result<Components, WorkbenchError> {
    let (first_frame, (times, tracks)) = spectra::table(path)?;
    Ok(Components { first_frame, ..of(&times, &tracks, most, progress)? })
}

fn of(
    times: &FrameTimes,
    tracks: &[(TrackId, Arc<Span>)],
    most: usize,
    progress: &dyn Progress,
) -> Result<Components, WorkbenchError> {
    if tracks.is_empty() {
        return Err(WorkbenchError::NoTracks);
    }
    let (n_tracks, n_frames) = (tracks.len(), times.len() as usize);
    let few = |n_frames| WorkbenchError::TooFewToPart { n_tracks, n_frames };
    if n_tracks < FEWEST_TRACKS || n_frames < FEWEST_FRAMES {
        return Err(few(n_frames));
    }
    let mut all = Positions::new(n_tracks, n_frames);
    for (track, (_, span)) in tracks.iter().enumerate() {
        for (frame, at) in positions(span, times.len()).into_iter().enumerate() {
            at.into_iter().for_each(|at| all.set(track, frame, at));
        }
    }
    let mut told = |done: f64| progress.report((100.0 * done) as u64, 100, "components") == Flow::Continue;
    let table = Table::new(&all, &mut told)?;
    if table.n_frames() < FEWEST_FRAMES {
        return Err(few(table.n_frames()));
    }
    let bod = Bod::new(&table);
    if bod.is_empty() {
        return Err(WorkbenchError::Still { n_tracks, n_frames: table.n_frames() });
    }
    let analyser = Analyser::new(times)?;
    let n_above = bod.n_above();
    let list = (0..n_above.min(most)).map(|k| component(&bod, k, &table, &analyser, n_frames));
    let list = list.collect::<Result<Vec<_>, _>>()?;
    let place = |(track, (id, _)): (usize, &(TrackId, Arc<Span>))| Some((*id, table.place(track)?));
    Ok(Components {
        places: tracks.iter().enumerate().filter_map(place).collect(),
        n_frames: table.n_frames(),
        first_frame: 0,
        times_s: times.as_slice().to_vec(),
        n_filled: table.n_filled(),
        edge_px: bod.edge,
        n_above,
        n_below: bod.singular.len() - n_above,
        list,
    })
}

fn component(
    bod: &Bod,
    k: usize,
    table: &Table,
    analyser: &Analyser,
    n_frames: usize,
) -> Result<Component, WorkbenchError> {
    let singular_px = bod.singular[k];
    // A chronos is a unit vector: its mean square is 1 / T.
    let root = (table.n_frames() as f64).sqrt();
    let mut chronos = vec![None; n_frames];
    for (&frame, value) in table.frames().iter().zip(bod.chronos(k)) {
        chronos[frame] = Some(root * value);
    }
    let [x, y] = bod.topos(k).map(|topos| topos.iter().map(|v| v * singular_px / root));
    let known = |(track, at): (usize, [f64; 2])| table.place(track).map(|_| at);
    let topos_px = x.zip(y).map(|(x, y)| [x, y]).enumerate().filter_map(known).collect();
    let line: Vec<Option<[f32; 2]>> = chronos.iter().map(|v| v.map(|v| [v as f32, 0.0])).collect();
    let spectrum = analyser.track(&line)?;
    let peak = spectrum.peaks(1, OVER_FLOOR).into_iter().next();
    Ok(Component {
        singular_px,
        share: bod.portion(k),
        axis: bod.axis(k),
        n_half: bod.n_half(k),
        chronos,
        topos_px,
        width_hz: peak.as_ref().map(|peak| spectrum.width_hz(peak)),
        spectrum,
        peak,
    })
}

#[cfg(test)]
mod tests;
