//! Frequencies of tracks and groups, in Hz from the frame times.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use honami_exchange::TrackRow;
use honami_model::clip::FrameTimes;
use honami_model::track::{Span, TrackId};
use honami_motion::spectrum::{Analyser, Spectrum};
use honami_motion::welch::Welch;

use honami_store::Project;

pub use honami_motion::spectrum::Peak;

use crate::densities::{self, Density, HalfPower, Pieces};
use crate::error::WorkbenchError;
use crate::scale::ScaleBar;
use crate::sways::{self, ABOUT, Swing, Within};

/// How many times the noise around it the power of a peak of one track must be: foliage has broad peaks.
pub(crate) const OVER_FLOOR: f64 = 3.0;
/// The same for the median of several tracks: its noise is quieter, and its peaks are broader.
pub(crate) const OVER_FLOOR_OF_MANY: f64 = 1.5;

/// Of more tracks than this some are taken for how they swing: a fit takes longer than a spectrum.
const MOST_SWINGS: usize = 100;

/// Which peaks are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// So many at most, the strongest first.
    pub n_peaks: usize,
    /// When, and none at or below which frequency.
    pub within: Within,
    /// What densities are taken of.
    pub pieces: Pieces,
}

/// What sways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// All tracks together: the median of their power.
    All,
    /// A group of the shown clustering: the median power of its tracks.
    Group(u32),
    /// One track.
    Track(TrackId),
}

/// The sways that stand out of something.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What sways.
    pub subject: Subject,
    /// Tracks it is the median of.
    pub n_tracks: usize,
    /// Strongest first.
    pub peaks: Vec<Peak>,
    /// How fast and how long it swings at the strongest: of several tracks the median.
    pub swing: Option<Swing>,
    /// The share of the power about the strongest that is common to several tracks, 0 to 1 (see
    /// [`Analyser::coherence`]).
    pub coherence: Option<f64>,
    /// Power of x and y together over frequency, px²/Hz, or m²/Hz where there is a scale: of several tracks the median. `None` where frames are unevenly timed, or
    /// nothing was seen as long as a piece without a break.
    pub density: Option<Density>,
}

impl Line {
    /// How broad the density is about the strongest peak.
    #[must_use]
    pub fn half_power(&self) -> Option<HalfPower> {
        let hz = self.peaks.first()?.hz;
        self.density.as_ref()?.peak([hz / ABOUT, hz * ABOUT])
    }
}

/// Frequencies of a project or of a table of tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Two sways closer than this cannot be told apart.
    pub resolution_hz: f64,
    /// Nothing above can be seen.
    pub nyquist_hz: f64,
    /// Time of the first frame that was looked at, seconds.
    pub start_s: f64,
    /// Frame rate, where frames are evenly timed.
    pub fps: Option<f64>,
    /// Length of the pieces that densities are of, seconds, where there are any.
    pub piece_s: Option<f64>,
    /// What says how many metres a pixel is: densities are of metres then, of pixels without.
    pub scale: Option<ScaleBar>,
    /// All tracks together, then groups, then tracks.
    pub lines: Vec<Line>,
    /// Tracks that were seen too briefly to say anything of, in fewer than 8 of the frames that were looked at.
    pub brief: Vec<TrackId>,
}

/// Spectra of a project's shown tracks, its groups and all together.
///
/// # Errors
/// [`WorkbenchError::NoTracks`], [`WorkbenchError::TooBrief`], and for a clip too short for a spectrum.
pub fn of_project(project: &Project, wanted: Wanted) -> Result<Spectra, WorkbenchError> {
    let tracks = project.shown_all()?;
    let group_of = project.grouping()?.map(|grouping| grouping.group_of).unwrap_or_default();
    let mut found = of(&project.clip().clip.times, &tracks, &group_of, wanted)?;
    if let Some(bar) = project.document().scale() {
        let densities = found.lines.iter_mut().filter_map(|line| line.density.as_mut());
        densities.for_each(|density| density.scale(bar.m_per_px()));
        found.scale = Some(bar);
    }
    Ok(found)
}

/// Spectra of a table of tracks; its own times count, so every frame of the table needs one.
///
/// # Errors
/// What the table says of its lines, [`WorkbenchError::NoTimes`], and for a table too short for a spectrum.
pub fn of_table(path: &Path, wanted: Wanted) -> Result<Spectra, WorkbenchError> {
    let (_, (times, tracks)) = table(path)?;
    of(&times, &tracks, &BTreeMap::new(), wanted)
}

/// The first frame of a table, and its times and tracks; their frames count from that one.
pub(crate) fn table(path: &Path) -> Result<(u32, Timed), WorkbenchError> {
    let rows = honami_exchange::read::<TrackRow>(path)?.collect::<Result<Vec<_>, _>>()?;
    let mut times = BTreeMap::new();
    for row in &rows {
        let time_s = row.time_s.ok_or_else(|| WorkbenchError::NoTimes { path: path.to_owned() })?;
        times.insert(row.frame, time_s);
    }
    // Frames are counted from the table's first to its last; one that no track has cannot be timed.
    let (Some(&first), Some(&last)) = (times.keys().next(), times.keys().last()) else {
        return Err(WorkbenchError::NoTracks);
    };
    if times.len() != (last - first) as usize + 1 {
        return Err(WorkbenchError::NoTimes { path: path.to_owned() });
    }
    let times = FrameTimes::new(times.into_values().collect())
        .map_err(|_times| WorkbenchError::NoTimes { path: path.to_owned() })?;
    let n_frames = times.len();
    let rows = rows.into_iter().map(|row| Ok(TrackRow { frame: row.frame - first, ..row }));
    let tracks: Vec<_> =
        honami_exchange::spans(rows, n_frames)?.into_iter().map(|(id, span)| (id, Arc::new(span))).collect();
    Ok((first, (times, tracks)))
}

/// Times of frames, and tracks in these.
pub(crate) type Timed = (FrameTimes, Vec<(TrackId, Arc<Span>)>);

fn of(
    times: &FrameTimes,
    tracks: &[(TrackId, Arc<Span>)],
    group_of: &BTreeMap<TrackId, u32>,
    wanted: Wanted,
) -> Result<Spectra, WorkbenchError> {
    if tracks.is_empty() {
        return Err(WorkbenchError::NoTracks);
    }
    let (times, tracks) = &cut(times, tracks, wanted.within)?;
    let analyser = Analyser::new(times)?;
    let spectra: Vec<(TrackId, Spectrum)> = tracks
        .iter()
        .filter_map(|(id, span)| Some((*id, analyser.track(&positions(span, times.len())).ok()?)))
        .collect();
    let told: BTreeSet<TrackId> = spectra.iter().map(|(id, _)| *id).collect();
    let brief = tracks.iter().map(|(id, _)| *id).filter(|id| !told.contains(id)).collect();
    let spans: BTreeMap<TrackId, &Span> = tracks.iter().map(|(id, span)| (*id, &**span)).collect();
    let fps = spectra.first().and_then(|(_, spectrum)| spectrum.even_fps);
    let swing = |ids: &[TrackId], peaks: &[Peak]| swing_of(&spans, ids, fps?, peaks.first()?.hz);
    let welch = match fps {
        Some(fps) => wanted.pieces.welch(fps, times.len() as usize)?,
        None => None,
    };
    let of_track = |(id, span): &(TrackId, Arc<Span>)| {
        Some((*id, densities::of_track(welch.as_ref()?, &positions(span, times.len()))?))
    };
    let densities: BTreeMap<TrackId, Density> = tracks.iter().filter_map(of_track).collect();
    let density = |ids: &[TrackId]| {
        let of: Vec<Density> = ids.iter().filter_map(|id| densities.get(id).cloned()).collect();
        Density::median(&of)
    };
    let median = |subject, of: Vec<Spectrum>, ids: &[TrackId]| {
        let median = Spectrum::median(&of)?;
        let peaks = wanted.of(&median, OVER_FLOOR_OF_MANY);
        let positions: Vec<_> =
            ids.iter().filter_map(|id| Some(positions(spans.get(id)?, times.len()))).collect();
        let coherence = peaks.first().and_then(|peak| analyser.coherence(&positions, peak.hz));
        let swing = swing(ids, &peaks);
        let n_tracks = median.n_tracks;
        Some(Line { subject, n_tracks, peaks, swing, coherence, density: density(ids) })
    };
    let all: Vec<Spectrum> = spectra.iter().map(|(_, spectrum)| spectrum.clone()).collect();
    let first = all.first().cloned().ok_or(WorkbenchError::TooBrief)?;
    wanted.within.check_above(first.nyquist_hz)?;
    let ids: Vec<TrackId> = spectra.iter().map(|(id, _)| *id).collect();
    let mut groups = BTreeMap::<u32, (Vec<Spectrum>, Vec<TrackId>)>::new();
    for (id, spectrum) in &spectra {
        if let Some(&group) = group_of.get(id) {
            let (spectra, ids) = groups.entry(group).or_default();
            spectra.push(spectrum.clone());
            ids.push(*id);
        }
    }
    let mut lines: Vec<Line> = median(Subject::All, all, &ids).into_iter().collect();
    lines.extend(groups.into_iter().filter_map(|(group, (of, ids))| median(Subject::Group(group), of, &ids)));
    let are_few = ids.len() <= MOST_SWINGS;
    lines.extend(spectra.iter().map(|(id, spectrum)| {
        let peaks = wanted.of(spectrum, OVER_FLOOR);
        let swing = if are_few { swing(&[*id], &peaks) } else { None };
        let density = density(&[*id]);
        Line { subject: Subject::Track(*id), n_tracks: 1, peaks, swing, coherence: None, density }
    }));
    Ok(Spectra {
        resolution_hz: first.resolution_hz,
        nyquist_hz: first.nyquist_hz,
        start_s: times.as_slice()[0],
        fps: first.even_fps,
        piece_s: welch.as_ref().map(Welch::piece_s),
        scale: None,
        brief,
        lines,
    })
}

/// Tracks in the frames between two times, and those times; frames count from the first of them.
fn cut(times: &FrameTimes, tracks: &[(TrackId, Arc<Span>)], within: Within) -> Result<Timed, WorkbenchError> {
    if within.from_s.is_none() && within.to_s.is_none() {
        return Ok((times.clone(), tracks.to_vec()));
    }
    let range = within.range(times.as_slice()).map_err(|what| WorkbenchError::NothingLeft { what })?;
    let of_span = |span: &Span| {
        let frames = span.frames();
        let first = range.start.max(frames.start as usize);
        let end = range.end.min(frames.end as usize).max(first);
        let samples = (first..end).filter_map(|frame| span.get(frame as u32).copied()).collect();
        Arc::new(Span { first_frame: (first - range.start) as u32, samples })
    };
    let tracks = tracks.iter().map(|(id, span)| (*id, of_span(span))).collect();
    let times = FrameTimes::new(times.as_slice()[range.clone()].to_vec());
    Ok((times.map_err(|error| WorkbenchError::NothingLeft { what: error.to_string() })?, tracks))
}

impl Wanted {
    fn of(self, spectrum: &Spectrum, over_floor: f64) -> Vec<Peak> {
        let mut peaks = spectrum.peaks(usize::MAX, over_floor);
        peaks.retain(|peak| peak.hz > self.within.above_hz);
        peaks.truncate(self.n_peaks);
        peaks
    }
}

/// How tracks swing about a frequency, each in the direction in which it moves most: the median of those that were seen
/// without a gap.
fn swing_of(spans: &BTreeMap<TrackId, &Span>, ids: &[TrackId], fps: f64, hz: f64) -> Option<Swing> {
    let about = [hz / ABOUT, hz * ABOUT];
    let every = ids.len().div_ceil(MOST_SWINGS).max(1);
    let of_track = |id: &TrackId| {
        let span = spans.get(id)?;
        let samples: Vec<[f64; 2]> = span
            .samples
            .iter()
            .map(|s| s.status.is_seen().then_some([f64::from(s.x), f64::from(s.y)]))
            .collect::<Option<_>>()?;
        let axes = [0, 1].map(|axis| samples.iter().map(|at| at[axis]).collect::<Vec<f64>>());
        let most = axes.into_iter().max_by(|a, b| sways::variance(a).total_cmp(&sways::variance(b)))?;
        let swing = honami_motion::swing::swing(&most, fps, about).ok()?;
        Some(Swing { first: swing.first + span.first_frame as usize, ..swing })
    };
    sways::median(ids.iter().step_by(every).filter_map(of_track).collect())
}

/// The position in every frame of the clip where the track is seen.
pub(crate) fn positions(span: &Span, n_frames: u32) -> Vec<Option<[f32; 2]>> {
    let seen = |frame| span.get(frame).filter(|s| s.status.is_seen()).map(|s| [s.x, s.y]);
    (0..n_frames).map(seen).collect()
}
