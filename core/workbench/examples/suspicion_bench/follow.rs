//! Tracks of generated clips as the trackers' plugins find them, their evidence, and which of their samples are bad.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use honami_model::document::Key;
use honami_model::edit::{Edit, Transaction};
use honami_model::track::{Span, TrackId};
use honami_motion::accuracy::TruePath;
use honami_review::evidence::{Evidence, Kind, Parts, Rival, Subject, is_judged};
use honami_review::suspicion::BAD_PX;
use honami_workbench::cluster::{self, ClusterRequest};
use honami_workbench::compare::{Truth, points_of, read_truth};
use honami_workbench::drive::Seed;
use honami_workbench::generate::generate;
use honami_workbench::plugins::Values;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::synth::{Level, Settings};
use honami_workbench::track::{self, Area, PointSource, TrackRequest};

/// The trackers whose tracks are judged, and which disagree.
pub(super) const TRACKERS: [&str; 4] = ["anchored", "klt", "lucas-kanade", "box"];
/// Without key-frames, and with one every so many frames.
const KEYED: [Option<u32>; 2] = [None, Some(40)];

/// Where things are, and how much is followed.
pub(super) struct Place {
    pub(super) plugin: PathBuf,
    pub(super) folder: PathBuf,
    /// Tracks of a clip.
    pub(super) tracks: usize,
}

/// One clip as one tracker found it, the others beside it.
pub(super) struct Case {
    pub(super) level: Level,
    pub(super) tracker: &'static str,
    pub(super) tracks: Vec<Track>,
}

impl Case {
    /// How the tracker knows its features.
    pub(super) fn kind(&self) -> Kind {
        kind_of(self.tracker)
    }
}

/// A track of a clip.
pub(super) struct Track {
    /// The evidence of every visible judged sample, and whether it is bad.
    pub(super) samples: Vec<Option<(Parts, bool)>>,
}

/// What a tracker found, and the tracks as they are shown with its run on top.
struct Follower {
    found: BTreeMap<TrackId, Arc<Span>>,
    shown: Vec<(TrackId, Arc<Span>)>,
    groups: BTreeMap<TrackId, u32>,
}

/// The clip of a level and seed, followed by every tracker, without key-frames and with exact ones.
pub(super) fn cases(level: Level, seed: u64, place: &Place) -> Result<Vec<Case>, Box<dyn Error>> {
    let folder = place.folder.join(format!("{level}-{seed}"));
    fs::create_dir_all(&folder)?;
    let clip = folder.join("clip.y4m");
    let settings = Settings { seed, ..Settings::benchmark(level) };
    if !clip.exists() {
        generate(&settings, &clip, &())?;
    }
    let mut truth = read_truth(&clip.with_extension("truth.csv"), settings.n_frames)?;
    truth.retain(|_, path| path.first_frame == 0 && path.positions[0].2);
    let step = (truth.len() / place.tracks.max(1)).max(1);
    let chosen: Vec<TrackId> = truth.keys().copied().step_by(step).take(place.tracks).collect();
    truth.retain(|track, _| chosen.contains(track));
    let mut cases = Vec::new();
    for key_every in KEYED {
        let project = folder.join("suspicion.honami");
        if project.exists() {
            fs::remove_file(&project)?;
        }
        let options =
            SessionOptions { plugin_paths: vec![place.plugin.clone()], ..SessionOptions::default() };
        let mut session = Session::create(&project, &clip, None, &options)?;
        let followers = follow(&mut session, &truth, key_every, settings.n_frames)?;
        for (k, tracker) in TRACKERS.into_iter().enumerate() {
            let tracks = judged(&session, &followers, k, &truth)?;
            cases.push(Case { level, tracker, tracks });
        }
    }
    Ok(cases)
}

/// The frames of a track's key-frames. Not all in the same frame, as a person would.
fn keyed(track: TrackId, path: &TruePath, every: Option<u32>) -> impl Iterator<Item = (u32, Key)> {
    let is_key = move |frame: &u32| every.is_some_and(|n| (frame + 13 * track.0).is_multiple_of(n));
    let visible = (1..).zip(&path.positions[1..]).filter(|(_, position)| position.2);
    visible
        .filter(move |(frame, _)| is_key(frame))
        .map(|(frame, &(x, y, _))| (frame, Key::set(x as f32, y as f32)))
}

/// Every tracker follows the leaves, from their true places in the first frame and in the key-frames.
fn follow(
    session: &mut Session,
    truth: &Truth,
    key_every: Option<u32>,
    n_frames: u32,
) -> Result<Vec<Follower>, Box<dyn Error>> {
    let mut seeds: Vec<Seed> = points_of(truth);
    let mut keys = Transaction { label: "the true key-frames".to_owned(), edits: Vec::new() };
    for (&track, path) in truth {
        for (frame, key) in keyed(track, path, key_every) {
            seeds.push(Seed { frame, track, x: key.x, y: key.y });
            keys.edits.push(Edit::SetKey { track, frame, key });
        }
    }
    let mut followers = Vec::new();
    for plugin in TRACKERS {
        let frames: Range<u32> = 0..n_frames;
        let (points, plugin) = (PointSource::Given(seeds.clone()), plugin.to_owned());
        let (params, every, area) = (Values::default(), None, Area::Whole);
        let request = TrackRequest { plugin, params, points, frames, every, area };
        let done = track::prepare(session, &request)?.run(&())?;
        let run = track::finish(session, done)?.run;
        if followers.is_empty() && !keys.edits.is_empty() {
            session.project.commit(keys.clone())?;
        }
        let found = session.project.run_tracks(run)?.into_iter();
        let found = found.map(|(track, span)| (track, Arc::new(span))).collect();
        let groups = groups(session)?;
        followers.push(Follower { found, shown: session.project.shown_all()?, groups });
    }
    Ok(followers)
}

/// The groups of the shown tracks as who clusters them has them.
fn groups(session: &mut Session) -> Result<BTreeMap<TrackId, u32>, Box<dyn Error>> {
    let request = ClusterRequest { plugin: "bod".to_owned(), params: Values::default(), groups: None };
    let done = cluster::prepare(session, &request)?.run(&())?;
    cluster::finish(session, done)?;
    Ok(session.project.grouping()?.map(|grouping| grouping.group_of).unwrap_or_default())
}

/// How a tracker knows its feature.
fn kind_of(tracker: &str) -> Kind {
    if tracker == "anchored" { Kind::Anchored } else { Kind::Stepwise }
}

/// What speaks against the tracks of one of the trackers.
fn judged(
    session: &Session,
    followers: &[Follower],
    shown: usize,
    truth: &Truth,
) -> Result<Vec<Track>, Box<dyn Error>> {
    let spans = &followers[shown].shown;
    let subject = |(k, (track, span)): (usize, &(TrackId, Arc<Span>))| {
        // Some were followed by this tracker only, some by one other, too, and some by all.
        let is_asked = |other: usize| match k % (followers.len() + 1) {
            0 => false,
            n if n == followers.len() => true,
            n => other == shown || other == (shown + n) % followers.len(),
        };
        let asked = followers.iter().enumerate().filter(|(other, _)| is_asked(*other));
        let said = asked.filter_map(|(other, f)| {
            let (name, kind) = (TRACKERS[other].into(), kind_of(TRACKERS[other]));
            Some(Rival { name, kind, span: Arc::clone(f.found.get(track)?) })
        });
        let (kind, span, rivals) = (kind_of(TRACKERS[shown]), Arc::clone(span), said.collect());
        Subject { track: *track, kind, span, rivals, unseen: Vec::new() }
    };
    let mut evidence = Evidence::new(spans.iter().enumerate().map(subject).collect(), 2);
    evidence.group(followers[shown].groups.clone());
    let mut correlator = evidence.correlator(&evidence.tracks().collect::<Vec<_>>());
    for frame in correlator.template_frames() {
        correlator.cut(frame, &session.media.frame(frame)?.planes().y);
    }
    for frame in correlator.sample_frames() {
        correlator.look(frame, &session.media.frame(frame)?.planes().y);
    }
    evidence.correlated(correlator);
    let track = |(track, span): &(TrackId, Arc<Span>)| {
        let path = truth.get(track)?;
        let each = span.frames().zip(&span.samples).zip(evidence.parts(*track)?);
        let samples = each.map(|((frame, sample), parts)| {
            let &(x, y, visible) = path.positions.get(frame as usize)?;
            let error_px = (f64::from(sample.x) - x).hypot(f64::from(sample.y) - y);
            (visible && is_judged(sample)).then_some((parts, error_px > BAD_PX))
        });
        Some(Track { samples: samples.collect() })
    };
    Ok(spans.iter().filter_map(track).collect())
}
