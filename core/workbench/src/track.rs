//! Tracking: a tracker plugin follows features through the clip, and a run is kept.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use honami_host::{CallContext, Host, Kind, PluginInfo, Tracker, Values};
use honami_media::Media;
use honami_model::clip::Clip;
use honami_model::document::{RunId, ShownRun};
use honami_model::track::{TrackId, TrackSet};
use honami_store::{Build, Project, RunHead, RunWriter, Seam};

use crate::drive::{self, Detect, Driven, Plan, Seed};
use crate::error::WorkbenchError;
use crate::matte::kept::frames;
use crate::progress::Progress;
use crate::rebuilt::{Difference, Found, Made};
use crate::session::Session;
use crate::stamp::{REBUILT, stamp};

mod area;
mod ends;
mod frames;
mod kept;
mod resume;

pub use area::Area;
pub(crate) use area::image;
pub use ends::Ends;
use frames::Kept;
use kept::Tracked;
use resume::Asked;
pub use resume::{detection_of, resume, unfinished};

/// Numbers that a table of points may use: above them there must be room for those of features to come.
pub(crate) const MAX_NUMBER: u32 = i32::MAX.unsigned_abs();

/// Which features are followed.
#[derive(Clone, Debug, PartialEq)]
pub enum PointSource {
    /// The project's tracks, each from its first seen sample on and again from each of its key-frames.
    Existing,
    /// These of the project's tracks, likewise.
    Tracks(TrackSet),
    /// Those that the tracker finds.
    Detect,
    /// These; a number that the project knows is that track.
    Given(Vec<Seed>),
}

/// What to track, with what.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackRequest {
    /// The tracker: short name or full id.
    pub plugin: String,
    /// Its parameters; the rest take their defaults.
    pub params: Values,
    /// The features.
    pub points: PointSource,
    /// Frames to track.
    pub frames: Range<u32>,
    /// Detect again every so many frames.
    pub every: Option<u32>,
    /// Where features may be found.
    pub area: Area,
}

/// A run that is ready to go.
pub struct TrackJob {
    media: Arc<Media>,
    tracker: (Tracker, Made),
    host: Host,
    plan: Plan,
    writer: RunWriter,
    /// The run that it goes on with.
    resumes: Option<RunId>,
    /// Tracks that are hidden in its first frame.
    hidden: TrackSet,
    /// Frames of the mattes that it heeds.
    mattes: Vec<u32>,
}

/// A run that has ended; give it to [`finish`].
pub struct TrackDone {
    run: RunId,
    plugin: String,
    frames: Range<u32>,
    resumes: Option<RunId>,
    driven: Driven,
    seconds: f64,
    error: Option<WorkbenchError>,
    /// What a rebuilt tracker makes of the frames before it took over.
    beside: Option<Found>,
    mattes: Vec<u32>,
}

/// A run beside a run: what the tracker that was rebuilt on its way makes of the frames before.
#[derive(Clone, Debug, PartialEq)]
pub struct Rebuilt {
    /// The first frame that the rebuilt one tracked in the run.
    pub seam: u32,
    /// Its build.
    pub build: Build,
    /// The run that holds what it makes of the frames before; it is not shown.
    pub run: RunId,
    /// How that differs from what the build before had made of them.
    pub difference: Difference,
}

/// What a run found.
#[derive(Debug)]
pub struct TrackOutcome {
    /// The run.
    pub run: RunId,
    /// Tracks with samples.
    pub n_tracks: usize,
    /// The shown run that had the same tracks, over which this one lies now; `None` where there was none, or this one is
    /// not shown.
    pub instead_of: Option<RunId>,
    /// How these ended.
    pub ends: Ends,
    /// Frames tracked.
    pub frames: Range<u32>,
    /// The frame after the last in which a feature was seen: [`resume()`] begins there.
    pub unseen_from: u32,
    /// Whether it ended before the frames that were asked for.
    pub stopped: bool,
    /// Time it took, decoding included.
    pub seconds: f64,
    /// Time in the tracker alone.
    pub tracker_secs: f64,
    /// Why it ended early, when nobody stopped it; the frames before are kept.
    pub error: Option<WorkbenchError>,
    /// What the tracker warned of, and what became of builds that could not take over.
    pub warnings: Vec<String>,
    /// Where the tracker was started again, and why.
    pub seams: Vec<Seam>,
    /// What the tracker was rebuilt to last, where it was and had done frames before.
    pub rebuilt: Option<Rebuilt>,
    /// Frames of the kept mattes inside which features were looked for; none where they were not, or everywhere.
    pub mattes: Vec<u32>,
    /// All of that in one line.
    pub line: String,
}

/// Loads the tracker and begins a run.
///
/// # Errors
/// When the plugin, its parameters, the frames or the points are not what they must be.
pub fn prepare(session: &mut Session, request: &TrackRequest) -> Result<TrackJob, WorkbenchError> {
    let clip = session.media.clip();
    check_frames(&request.frames, clip)?;
    let registry = Arc::clone(&session.registry);
    let plugin = registry.find(Kind::Tracker, &request.plugin)?;
    let area = request.area.meant(session.project.document());
    let request = &TrackRequest { area, ..request.clone() };
    let areas = request.area.read(&session.project, clip)?;
    if areas.are_empty() {
        return Err(request.area.nowhere(clip));
    }
    let (seeds, detect) = match &request.points {
        PointSource::Existing => (existing(session, &request.frames, None)?, None),
        PointSource::Tracks(tracks) => (existing(session, &request.frames, Some(tracks))?, None),
        PointSource::Given(seeds) => (given(session, seeds)?, None),
        PointSource::Detect if plugin.offers("honami.detect/1") => {
            let present = session.project.shown_all()?;
            (Vec::new(), Some(Detect { every: request.every, areas, present, since: request.frames.start }))
        }
        PointSource::Detect => {
            return Err(WorkbenchError::CannotDetect { plugin: plugin.short_name.clone() });
        }
    };
    if detect.is_none() {
        drive::check_seeds(&seeds, session.media.clip())?;
    }
    let asked = Asked::of(request, &seeds, detect.as_ref());
    begin(session, plugin, request, seeds, detect, &asked)
}

fn check_frames(&Range { start, end }: &Range<u32>, clip: &Clip) -> Result<(), WorkbenchError> {
    let n_frames = clip.n_frames();
    if start < end && end <= n_frames { Ok(()) } else { Err(WorkbenchError::Frames { start, end, n_frames }) }
}

fn begin(
    session: &mut Session,
    plugin: &PluginInfo,
    request: &TrackRequest,
    seeds: Vec<Seed>,
    detect: Option<Detect>,
    asked: &Asked,
) -> Result<TrackJob, WorkbenchError> {
    let (host, params) = (session.options.host.clone(), request.params.clone());
    let (tracker, made) = Made::start(&host, plugin.clone(), params, &CallContext::silent())?;
    let revision = session.project.revision();
    let head = RunHead {
        provenance: stamp(revision, "track", plugin, &request.params, made.origin.clone()),
        tracks: seeds.iter().map(|seed| seed.track).collect(),
        frames: request.frames.clone(),
    };
    let mut writer = session.project.begin_run(&head)?;
    writer.keep_request(&asked.text())?;
    let max_threads = threads();
    let mattes = if detect.is_some() { request.area.mattes(&session.project)? } else { Vec::new() };
    Ok(TrackJob {
        media: Arc::clone(&session.media),
        tracker: (tracker, made),
        host,
        plan: Plan { frames: request.frames.clone(), seeds, detect, max_threads },
        writer,
        resumes: None,
        hidden: TrackSet::default(),
        mattes,
    })
}

impl TrackJob {
    /// Short name of the tracker.
    #[must_use]
    pub fn plugin(&self) -> &str {
        &self.tracker.1.plugin.short_name
    }

    /// Frames that it is to track.
    #[must_use]
    pub fn frames(&self) -> &Range<u32> {
        &self.plan.frames
    }

    /// Tracks to the end, or until a person stops it. What was tracked is kept in any case, also when the
    /// tracker fails: [`TrackDone`] then holds its error.
    ///
    /// # Errors
    /// When the project cannot be written; what a tracker met that failed before it had tracked a frame: then there is
    /// no run.
    pub fn run(self, progress: &dyn Progress) -> Result<TrackDone, WorkbenchError> {
        let begun = Instant::now();
        let frames = self.plan.frames.clone();
        let plugin = self.tracker.1.plugin.short_name.clone();
        let mut kept = Kept::new(self.writer, frames.start, self.hidden);
        let tracked = kept::track(&mut kept, &self.media, self.tracker, &self.host, self.plan, progress);
        let run = kept.writer.run();
        let reached = kept.first_frame;
        let (Tracked { driven, beside }, error) = match tracked {
            Ok(tracked) => (tracked, None),
            // A run that goes on with another has that one's last frame first.
            Err(error) if reached <= frames.start + u32::from(self.resumes.is_some()) => {
                kept.writer.discard()?;
                return Err(error);
            }
            Err(error) => (Tracked::up_to(reached), Some(error)),
        };
        match &error {
            Some(error) => kept.writer.abandon(&error.to_string()).map(drop)?,
            None if driven.end < frames.end => kept.writer.abandon("stopped").map(drop)?,
            None => kept.writer.finish().map(drop)?,
        }
        let seconds = begun.elapsed().as_secs_f64();
        let (resumes, mattes) = (self.resumes, self.mattes);
        Ok(TrackDone { run, plugin, frames, resumes, driven, seconds, error, beside, mattes })
    }
}

/// Shows what a run found: one edit, which undo takes back.
///
/// # Errors
/// What the project met.
pub fn finish(session: &mut Session, done: TrackDone) -> Result<TrackOutcome, WorkbenchError> {
    let TrackDone { run, plugin, frames, resumes, driven, seconds, error, beside, mattes } = done;
    let info = session.project.run(run)?;
    let found = info.tracks;
    let n_tracks = found.len();
    let reached = frames.start..driven.end;
    let last = reached.end.saturating_sub(1);
    let spans = session.project.run_tracks(run)?;
    let ends = Ends::of(&spans, last);
    let seen = spans.iter().flat_map(|(_, span)| span.frames().zip(&span.samples));
    let seen = seen.filter(|(_, sample)| sample.status.is_seen()).map(|(frame, _)| frame + 1);
    let unseen_from = seen.max().unwrap_or(reached.start);
    let stopped = driven.end < frames.end;
    // Half a run laid over tracks that reach further would leave a seam in each: it is kept, and not shown.
    let shown = n_tracks > 0 && !(stopped && any_reaches(&session.project, &found, driven.end)?);
    let tracks = found.to_string();
    let of_same = |before: &&ShownRun| before.tracks.iter().any(|track| found.contains(track));
    let instead_of = session.project.document().runs().iter().rev().find(of_same).map(|before| before.run);
    let instead_of = instead_of.filter(|before| shown && Some(*before) != resumes);
    if shown {
        let shown = resume::shown(&session.project, run, found, resumes)?;
        session.project.commit(shown)?;
    }
    let mut line = format!("{plugin}: {tracks}, frames {}-{last}, {ends}, {seconds:.1} s", reached.start);
    if let Some(inside) = inside(&mattes) {
        line += &format!("; {inside}");
    }
    let kept = match (shown, n_tracks) {
        (true, _) => format!("{tracks} up to there kept"),
        (false, 0) => "nothing was tracked".to_owned(),
        (false, _) => format!("the tracks stay as they were, run {run} is kept beside them"),
    };
    for seam in &info.seams {
        line += &format!("; {seam}");
    }
    let rebuilt = beside.map(|found| keep_beside(session, found)).transpose()?;
    if stopped {
        line = format!("{plugin}: stopped at frame {}; {kept}", driven.end);
    }
    if let Some(error) = &error {
        line = format!("{plugin} failed at frame {}, {kept}: {error}", driven.end);
    }
    if let Some(Rebuilt { seam, difference, .. }) = &rebuilt {
        line += &format!("; rebuilt at frame {seam}: {difference}");
    }
    let Driven { step_secs, warnings, .. } = driven;
    let (frames, tracker_secs) = (reached, step_secs.iter().sum());
    Ok(TrackOutcome {
        run,
        n_tracks,
        instead_of,
        ends,
        frames,
        unseen_from,
        stopped,
        seconds,
        tracker_secs,
        error,
        warnings,
        seams: info.seams,
        rebuilt,
        mattes,
        line,
    })
}

/// Where features were looked for, where mattes of these frames say so: `inside the matte of frame 0`.
#[must_use]
pub fn inside(mattes: &[u32]) -> Option<String> {
    let many = if mattes.len() > 1 { "s" } else { "" };
    (!mattes.is_empty()).then(|| format!("inside the matte{many} of {}", frames(mattes)))
}

/// Keeps what a rebuilt tracker makes of the frames before, beside the run.
fn keep_beside(session: &mut Session, found: Found) -> Result<Rebuilt, WorkbenchError> {
    let Found { made, seam, frames, spans, difference } = found;
    let (build, revision) = (made.build(), session.project.revision());
    let head = RunHead {
        provenance: stamp(revision, REBUILT, &made.plugin, &made.params, made.origin),
        tracks: spans.iter().map(|(track, _)| *track).collect(),
        frames,
    };
    let kept = session.project.keep_runs(&[(head, spans)])?;
    let run = kept.first().copied().ok_or(WorkbenchError::Fault)?;
    Ok(Rebuilt { seam, build, run, difference })
}

/// Whether any of the tracks, as it is shown, goes on at this frame.
pub(crate) fn any_reaches(project: &Project, tracks: &TrackSet, frame: u32) -> Result<bool, WorkbenchError> {
    for track in tracks.iter() {
        if project.shown(track)?.is_some_and(|span| span.frames().end > frame) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Seeds of the project's own tracks, or of some: where each is first seen, and each of its key-frames.
///
/// # Errors
/// What the project met.
pub fn existing(
    session: &Session,
    frames: &Range<u32>,
    only: Option<&TrackSet>,
) -> Result<Vec<Seed>, WorkbenchError> {
    let mut seeds = Vec::new();
    let wanted = |track: &TrackId| only.is_none_or(|only| only.contains(*track));
    for (track, span) in session.project.shown_all()?.into_iter().filter(|(track, _)| wanted(track)) {
        let keys = session.project.document().track(track).map(|known| &known.keys);
        let keyed: BTreeSet<u32> =
            keys.into_iter().flat_map(|keys| keys.range(frames.clone())).map(|k| *k.0).collect();
        let first_seen =
            span.frames().zip(&span.samples).find(|(f, s)| frames.contains(f) && s.status.is_seen());
        for frame in first_seen.map(|(frame, _)| frame).into_iter().chain(keyed).collect::<BTreeSet<_>>() {
            if let Some(sample) = span.get(frame) {
                seeds.push(Seed { frame, track, x: sample.x, y: sample.y });
            }
        }
    }
    Ok(seeds)
}

/// A user's points; numbers that no track has yet are set aside for them.
fn given(session: &mut Session, seeds: &[Seed]) -> Result<Vec<Seed>, WorkbenchError> {
    drive::check_seeds(seeds, session.media.clip())?;
    if let Some(seed) = seeds.iter().find(|seed| seed.track.0 > MAX_NUMBER) {
        return Err(WorkbenchError::Number { id: seed.track.0, max: MAX_NUMBER });
    }
    let document = session.project.document();
    let new: TrackSet =
        seeds.iter().map(|seed| seed.track).filter(|&track| document.track(track).is_none()).collect();
    session.project.claim_tracks(&new)?;
    Ok(seeds.to_vec())
}

/// How many threads a plugin may use: as many as this process, by `RAYON_NUM_THREADS` or the cores it may run on.
#[must_use]
pub fn threads() -> u32 {
    u32::try_from(rayon::current_num_threads()).unwrap_or(1)
}
