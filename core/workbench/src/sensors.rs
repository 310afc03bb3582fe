//! Tracks in space beside what reference sensors have recorded: brought together in time and in space, and how far apart they
//! are then (thesis 2.3.3: table 2.1 with errata E12, figure 2.11).

mod table;
#[cfg(test)]
mod tests;
mod together;

use std::path::Path;

use honami_cameras::CameraError;
pub use honami_cameras::Place;
use honami_cameras::align::deviations;
pub use honami_cameras::align::{Deviation, Similarity};
use honami_cameras::clock::{Offset, Signal};
use honami_model::space::SpaceTrack;
use honami_motion::accuracy;
use honami_motion::welch::{Cross, Density, Welch};
use honami_store::Project;

use crate::densities::Pieces;
use crate::error::{SensorsError, WorkbenchError};
use crate::space::{self, InSpace};
pub use table::{Wind, records, wind};

/// Fewer samples are no record.
const FEWEST: usize = 3;
/// A gap is longer than so many usual steps: nothing is read across it.
const GAP: f64 = 2.5;
/// What swings less often in a piece is a drift.
const SLOWEST: f64 = 1.5;
/// Steps of a stretch differ by less than this from the usual one, in parts of it.
const EVEN: f64 = 0.5;

/// Where something was over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// What it is called.
    pub name: String,
    /// Seconds, growing.
    pub times_s: Vec<f64>,
    /// Metres, one for each time.
    pub places: Vec<Place>,
}

/// How tracks and sensors are brought together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// What happened at t by the tracks' clock happened at t + this by the sensors'; found where it is not given, seconds.
    pub offset_s: Option<f64>,
    /// Clocks are not further apart than this, seconds.
    pub most_s: f64,
    /// Height of the plant, metres, if it is known.
    pub height_m: Option<f64>,
    /// What spectra are taken of.
    pub pieces: Pieces,
}

/// Tracks beside sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// How far the clocks are apart; without an error where it was given.
    pub offset_s: f64,
    /// Its standard error, and how alike they are then.
    pub found: Option<Offset>,
    /// From the tracks' axes to the sensors'; its scale is 1.
    pub axes: Similarity,
    /// What the scale would be if it were free: the sensors' metres by the cameras'.
    pub scale: f64,
    /// Whether the sensors' places fit far better seen in a mirror: one of both has left-handed axes.
    pub is_mirrored: bool,
    /// Of all markers together, along each axis of the sensors, metres.
    pub all: [Deviation; 3],
    /// Height of the plant, metres, if it is known.
    pub height_m: Option<f64>,
    /// Length of the pieces that spectra are of, seconds, where there are any.
    pub piece_s: Option<f64>,
    /// Each of them.
    pub markers: Vec<Marker>,
    /// Names of tracks and of sensors that have no partner.
    pub alone: [Vec<String>; 2],
}

/// A sensor and its track.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// The sensor's name.
    pub name: String,
    /// The track's.
    pub track: String,
    /// Times at which both are known, seconds of the tracks' clock.
    pub times_s: Vec<f64>,
    /// Where the track is, metres, in the sensors' axes.
    pub tracked: Vec<Place>,
    /// Where the sensor is.
    pub sensed: Vec<Place>,
    /// How far they are apart along each axis.
    pub deviations: [Deviation; 3],
    /// Spectra along each axis; `None` where they are never together as long as two pieces.
    pub axes: Option<[Axis; 3]>,
}

/// What both do along an axis, by frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Of the track and of the sensor, m²/Hz.
    pub densities: [Density; 2],
    /// How much of it is common, and how far the sensor is behind; `None` where one of them stands still.
    pub cross: Option<Cross>,
    /// At the strongest frequency of the sensor.
    pub strongest: Option<Strongest>,
}

/// What is common at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strongest {
    /// Where the sensor's density is highest, hertz.
    pub hz: f64,
    /// Magnitude-squared coherence, 0 to 1.
    pub coherence: f64,
    /// How far the sensor is behind the track, radians.
    pub phase_rad: f64,
    /// Its standard error.
    pub phase_error_rad: f64,
}

/// Brings tracks and sensors together, and says how far apart they are.
///
/// Partners are found by their names, or, where no track is called as a sensor, by how they move and, once the axes are
/// known, by which is nearest. The offset of the clocks is that at which partners move most alike; the axes are turned and
/// shifted, never stretched.
///
/// # Errors
/// [`SensorsError`], and [`crate::densities::PieceError`].
pub fn compare(tracks: &[Record], sensors: &[Record], wish: &Wish) -> Result<Compared, WorkbenchError> {
    if let Some(height) = wish.height_m.filter(|height| !(height.is_finite() && *height > 0.0)) {
        return Err(SensorsError::Height(height).into());
    }
    let met = together::meet(tracks, sensors, wish)?;
    let fps = tracks.iter().map(|track| 1.0 / track.step_s()).fold(0.0, f64::max);
    let longest = met.pairs.iter().map(|pair| pair.times_s.len()).max().unwrap_or(0);
    let welch = wish.pieces.welch(fps, longest)?;
    let markers: Vec<Marker> = met
        .pairs
        .into_iter()
        .filter_map(|pair| {
            let tracked: Vec<Place> = pair.tracked.iter().map(|place| met.axes.of(place)).collect();
            let deviations = deviations(&tracked, &pair.sensed)?;
            let axes =
                welch.as_ref().and_then(|welch| spectra(welch, fps, &pair.times_s, [&tracked, &pair.sensed]));
            let (name, track) = (sensors[pair.sensor].name.clone(), tracks[pair.track].name.clone());
            Some(Marker {
                name,
                track,
                times_s: pair.times_s,
                tracked,
                sensed: pair.sensed,
                deviations,
                axes,
            })
        })
        .collect();
    let every = |of: fn(&Marker) -> &Vec<Place>| {
        markers.iter().flat_map(|m| of(m).iter().copied()).collect::<Vec<_>>()
    };
    let all = deviations(&every(|m| &m.tracked), &every(|m| &m.sensed))
        .ok_or(SensorsError::Axes(CameraError::Unaligned { came: 0 }))?;
    let alone = |records: &[Record], is_paired: &dyn Fn(&str) -> bool| {
        records.iter().map(|record| record.name.clone()).filter(|name| !is_paired(name)).collect::<Vec<_>>()
    };
    Ok(Compared {
        offset_s: met.offset_s,
        found: met.found,
        axes: met.axes,
        scale: met.scale,
        is_mirrored: met.is_mirrored,
        all,
        height_m: wish.height_m,
        piece_s: welch.map(|welch| welch.piece_s()),
        alone: [
            alone(tracks, &|name| markers.iter().any(|marker| marker.track == name)),
            alone(sensors, &|name| markers.iter().any(|marker| marker.name == name)),
        ],
        markers,
    })
}

/// Spectra of both along each axis, from where they are together without a break.
fn spectra(welch: &Welch, fps: f64, times_s: &[f64], both: [&[Place]; 2]) -> Option<[Axis; 3]> {
    let is_break = |k: usize| ((times_s[k] - times_s[k - 1]) * fps - 1.0).abs() > EVEN;
    let mut ends: Vec<usize> = (1..times_s.len()).filter(|k| is_break(*k)).collect();
    ends.insert(0, 0);
    ends.push(times_s.len());
    let along = |axis: usize| {
        let of = both.map(|places| places.iter().map(|place| place[axis]).collect::<Vec<f64>>());
        let stretches: Vec<[&[f64]; 2]> =
            ends.windows(2).map(|ends| [0, 1].map(|k: usize| &of[k][ends[0]..ends[1]])).collect();
        let density = |k: usize| welch.density(&stretches.iter().map(|both| both[k]).collect::<Vec<_>>());
        let densities = [density(0)?, density(1)?];
        let cross = welch.cross(&stretches);
        // What is slower than a piece and a half is what is left of the straight lines.
        let per_hz = &densities[1].per_hz;
        let first = (SLOWEST / welch.piece_s() / densities[1].step_hz).ceil() as usize;
        let top = (first..per_hz.len()).max_by(|a, b| per_hz[*a].total_cmp(&per_hz[*b]));
        let strongest = top.zip(cross.as_ref()).map(|(bin, cross)| Strongest {
            hz: bin as f64 * cross.step_hz,
            coherence: cross.coherence[bin],
            phase_rad: cross.phase_rad[bin],
            phase_error_rad: cross.phase_error_rad(bin),
        });
        Some(Axis { densities, cross, strongest })
    };
    Some([along(0)?, along(1)?, along(2)?])
}

/// The tracks in space that a project shows, by their names, or their numbers where they have none; and a line for each reason
/// why they no longer speak of what the projects show.
///
/// # Errors
/// [`crate::SpaceError::NoSpace`] where none are shown, and what the project met.
pub fn of_project(project: &Project) -> Result<(Vec<Record>, Vec<String>), WorkbenchError> {
    let InSpace { tracks, names, times, stale, .. } = space::shown(project)?;
    let record = |(track, name): (SpaceTrack, Option<String>)| Record {
        name: name.unwrap_or_else(|| track.track.to_string()),
        times_s: track.fixes.iter().map(|fix| times.get(fix.frame).unwrap_or_default()).collect(),
        places: track.fixes.iter().map(|fix| Place::from(fix.place_m)).collect(),
    };
    // What was seen by both in hardly any frame is no record.
    let records = tracks.into_iter().zip(names).map(record).filter(|record| record.times_s.len() >= FEWEST);
    Ok((records.collect(), stale))
}

impl Record {
    /// The usual time from one sample to the next, seconds.
    pub(crate) fn step_s(&self) -> f64 {
        let steps = self.times_s.windows(2).map(|pair| pair[1] - pair[0]);
        accuracy::median(steps.collect()).unwrap_or(f64::INFINITY)
    }

    fn along(&self, axis: usize) -> Vec<f64> {
        self.places.iter().map(|place| place[axis]).collect()
    }

    /// Where it is at other times, by cubics; `None` where there is a gap, and before and after all.
    fn at(&self, times_s: &[f64]) -> Vec<Option<Place>> {
        let coordinates = [0, 1, 2].map(|axis| self.along(axis));
        let longest = GAP * self.step_s();
        let at = |t: f64| {
            let next =
                self.times_s.partition_point(|time| *time <= t).clamp(1, self.times_s.len().max(2) - 1);
            if self.times_s.get(next)? - self.times_s[next - 1] > longest {
                return None;
            }
            let along = |axis: usize| {
                let signal = Signal { times_s: &self.times_s, values: &coordinates[axis] };
                signal.at(t).map(|(value, _slope)| value)
            };
            Some(Place::new(along(0)?, along(1)?, along(2)?))
        };
        times_s.iter().map(|t| at(*t)).collect()
    }
}

/// The table of all that was compared: `marker,track,time_s,x_m,y_m,z_m,sensor_x_m,sensor_y_m,sensor_z_m`, in the sensors'
/// axes and by the tracks' clock.
///
/// # Errors
/// What the disk met.
pub fn write(compared: &Compared, out: &Path) -> Result<(), WorkbenchError> {
    let mut text = "marker,track,time_s,x_m,y_m,z_m,sensor_x_m,sensor_y_m,sensor_z_m\n".to_owned();
    for marker in &compared.markers {
        let name = |name: &str| name.replace([',', '"', '\n'], " ");
        let (sensor, track) = (name(&marker.name), name(&marker.track));
        for ((t, a), b) in marker.times_s.iter().zip(&marker.tracked).zip(&marker.sensed) {
            text += &format!(
                "{sensor},{track},{t:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6}\n",
                a.x, a.y, a.z, b.x, b.y, b.z
            );
        }
    }
    crate::export::text(out, &text)
}
