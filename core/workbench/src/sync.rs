//! How far the clocks of two clips are apart: by a flash that both recorded, or by what moves in both.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use honami_cameras::clock::{Movement, Offset, Signal, by_movements, flash_s};
use honami_media::Media;
use honami_model::clip::FrameTimes;
use honami_model::picture::{Planes, Range};
use honami_model::track::{Span, TrackId};
use honami_motion::spectrum::detrended;
use honami_store::Project;

use crate::error::{SpaceError, WorkbenchError};
use crate::progress::{Flow, Progress};

/// Where and how a lamp is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// x, y, width, height, pixels; the whole picture where it is not said.
    pub region: Option<[f64; 4]>,
    /// For which part of a frame's length light is gathered, 0 to 1.
    pub exposure: f64,
    /// A pixel's value grows with light to the power of one over this; 1 of cameras that count light.
    pub gamma: f64,
}

impl Default for Lamp {
    fn default() -> Self {
        Self { region: None, exposure: 1.0, gamma: 2.2 }
    }
}

/// When a lamp was switched on, by the clip's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flash {
    /// Seconds.
    pub seconds: f64,
    /// Its standard error.
    pub error_s: f64,
}

/// Finds when a lamp was switched on in a clip.
///
/// # Errors
/// [`SpaceError::NoPixel`] of a region outside the picture, [`SpaceError::Clip`] where nothing flashes, [`WorkbenchError::Stopped`], and
/// what reading met.
pub fn flash(
    media: &Media,
    path: &Path,
    lamp: &Lamp,
    progress: &dyn Progress,
) -> Result<Flash, WorkbenchError> {
    let clip = media.clip();
    let region = lamp.region.unwrap_or([0.0, 0.0, clip.width.into(), clip.height.into()]);
    let light = Light::new(lamp.gamma);
    let n_frames = clip.n_frames();
    let mut values = Vec::with_capacity(n_frames as usize);
    for n in 0..n_frames {
        if progress.report(n.into(), n_frames.into(), "frame") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let size = [clip.width, clip.height];
        let outside = || SpaceError::NoPixel { path: path.to_owned(), region, size };
        values.push(light.mean(&media.frame(n)?.planes(), region).ok_or_else(outside)?);
    }
    let brightness = Signal { times_s: clip.times.as_slice(), values: &values };
    let found = flash_s(brightness, lamp.exposure, |light| rounded(light, lamp.gamma));
    let (seconds, error_s) = found.map_err(|source| SpaceError::Clip { path: path.to_owned(), source })?;
    Ok(Flash { seconds, error_s })
}

/// How far two clocks are apart by the same flash.
#[must_use]
pub fn by_flash([left, right]: [Flash; 2]) -> Offset {
    let error_s = left.error_s.hypot(right.error_s);
    Offset { seconds: right.seconds - left.seconds, error_s, alike: 1.0, rival_s: None }
}

/// The offset of two clocks by movement, and what it is from.
#[derive(Clone, Debug, PartialEq)]
pub struct ByMotion {
    /// How far the clocks are apart.
    pub offset: Offset,
    /// Tracks of the left and of the right project that were compared.
    pub n_tracks: [usize; 2],
    /// Whether they are those that have the same names in both.
    pub named: bool,
}

/// How far the clocks of two projects are apart, `most_s` at most, by how their tracks move on average: those that have the same names in
/// both, or all of each.
///
/// # Errors
/// [`SpaceError::NoTracks`], and [`SpaceError::Both`] where movements are too short or not alike at any offset.
pub fn by_motion(left: &Project, right: &Project, most_s: f64) -> Result<ByMotion, WorkbenchError> {
    let names = shared_names([left, right]);
    let [first, second] = [tracks(left, &names)?, tracks(right, &names)?];
    let courses = [(left, &first), (right, &second)]
        .map(|(project, spans)| Course::of(&project.clip().clip.times, spans));
    let [ours, theirs] = courses.each_ref().map(Course::movement);
    let offset = by_movements(&ours, &theirs, most_s).map_err(|source| {
        let [left, right] = [left, right].map(|project| project.path().to_owned());
        SpaceError::Both { left, right, source }
    })?;
    Ok(ByMotion { offset, n_tracks: [first.len(), second.len()], named: !names.is_empty() })
}

/// Names that tracks of both projects have.
pub(crate) fn shared_names(projects: [&Project; 2]) -> BTreeSet<String> {
    let [left, right] = projects.map(|project| {
        let names = project.document().tracks().filter_map(|(_, track)| track.name.clone());
        names.collect::<BTreeSet<_>>()
    });
    left.intersection(&right).cloned().collect()
}

/// The shown tracks that have one of these names; all, where there are none.
fn tracks(project: &Project, names: &BTreeSet<String>) -> Result<Vec<Arc<Span>>, WorkbenchError> {
    let document = project.document();
    let is_meant = |id: &TrackId| {
        let name = document.track(*id).and_then(|track| track.name.as_ref());
        names.is_empty() || name.is_some_and(|name| names.contains(name))
    };
    let shown = project.shown_all()?.into_iter().filter(|(id, _)| is_meant(id));
    let spans: Vec<_> = shown.map(|(_, span)| span).collect();
    if spans.is_empty() {
        return Err(SpaceError::NoTracks { path: project.path().to_owned() }.into());
    }
    Ok(spans)
}

/// How tracks move on average: their mean steps from frame to frame, added up where there are some, less a drift.
#[derive(Clone, Debug, PartialEq)]
struct Course {
    times_s: Vec<f64>,
    right: Vec<f64>,
    down: Vec<f64>,
}

impl Course {
    /// The longest time in which some of the tracks are seen.
    fn of(times: &FrameTimes, spans: &[Arc<Span>]) -> Self {
        let times = times.as_slice();
        let mut best = Self::begun(times[0]);
        let mut course = Self::begun(times[0]);
        for (frame, &time_s) in (1..).zip(&times[1..]) {
            match mean_step(spans, frame) {
                Some(step) => course.go(time_s, step),
                None => course = Self::begun(time_s),
            }
            if course.times_s.len() > best.times_s.len() {
                best.clone_from(&course);
            }
        }
        // What creeps is alike at any offset.
        let Self { times_s, right, down } = best;
        let [right, down] = [right, down].map(|values| detrended(&times_s, values));
        Self { times_s, right, down }
    }

    fn begun(time_s: f64) -> Self {
        Self { times_s: vec![time_s], right: vec![0.0], down: vec![0.0] }
    }

    fn go(&mut self, time_s: f64, [right, down]: [f64; 2]) {
        let last = self.times_s.len() - 1;
        self.right.push(self.right[last] + right);
        self.down.push(self.down[last] + down);
        self.times_s.push(time_s);
    }

    fn movement(&self) -> Movement<'_> {
        Movement { times_s: &self.times_s, right: &self.right, down: &self.down }
    }
}

/// How far tracks that are seen in this frame and the one before have gone, pixels.
fn mean_step(spans: &[Arc<Span>], frame: u32) -> Option<[f64; 2]> {
    let at = |span: &Span, frame: u32| {
        let sample = span.get(frame).filter(|sample| sample.status.is_seen())?;
        Some([sample.x, sample.y].map(f64::from))
    };
    let steps: Vec<[f64; 2]> = spans
        .iter()
        .filter_map(|span| {
            let ([x, y], [was_x, was_y]) = (at(span, frame)?, at(span, frame - 1)?);
            Some([x - was_x, y - was_y])
        })
        .collect();
    let mean = |axis: usize| steps.iter().map(|step| step[axis]).sum::<f64>() / steps.len() as f64;
    (!steps.is_empty()).then(|| [mean(0), mean(1)])
}

/// What pixels' values say of light, for both meanings that they have.
struct Light {
    full: [f64; 256],
    limited: [f64; 256],
}

impl Light {
    fn new(gamma: f64) -> Self {
        let of = |black: f64, white: f64| {
            std::array::from_fn(|value| {
                let share = (value as f64 - black) / (white - black);
                255.0 * share.signum() * share.abs().powf(gamma)
            })
        };
        Self { full: of(0.0, 255.0), limited: of(16.0, 235.0) }
    }

    /// Of the pixels whose centres lie in a region; `None` where there are none.
    fn mean(&self, planes: &Planes<'_>, [x, y, width, height]: [f64; 4]) -> Option<f64> {
        let light = match planes.range {
            Range::Full => &self.full,
            Range::Limited => &self.limited,
        };
        let within = |from: f64, length: f64, n: u32| {
            let end = (from + length).ceil().clamp(0.0, n.into()) as usize;
            (from.ceil().clamp(0.0, n.into()) as usize).min(end)..end
        };
        let (columns, rows) = (within(x, width, planes.y.width), within(y, height, planes.y.height));
        let n = columns.len() * rows.len();
        let row = |row: usize| &planes.y.data[row * planes.y.stride..][columns.clone()];
        let sum: f64 = rows.map(|at| row(at).iter().map(|&v| light[usize::from(v)]).sum::<f64>()).sum();
        (n > 0).then(|| sum / n as f64)
    }
}

/// Standard error of an even light, 0 to 255, that is kept as whole levels.
fn rounded(light: f64, gamma: f64) -> f64 {
    /// Of a level: rounding moves a value by as much as half of one either way.
    const LEVEL: f64 = 0.288_675_134_594_812_9;
    let share = (light / 255.0).clamp(0.0, 1.0).powf(1.0 / gamma);
    LEVEL * gamma * share.powf(gamma - 1.0).min(1e3)
}

#[cfg(test)]
mod tests;
