//! Two runs over the same tracks, A and B: which there are, and how they disagree.
//!
//! Runs that were hidden again can be compared too; the passes of re-trackings cannot, for they are of one track each.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

use honami_model::document::RunId;
use honami_model::provenance::{Provenance, Value};
use honami_model::track::{Quality, Sample, Span, Status, TrackId, TrackSet};
use honami_store::{Access, Project, RunState};

pub use honami_motion::disagreement::{
    AtKeys, Disagreement, FAR_PX, LIMITS_PX, Paired, Place, Row, Sight, Summary, at_keys, class,
    disagreement, sight,
};

use crate::error::WorkbenchError;
use crate::stamp::REBUILT;

/// A run that can be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrant {
    /// The run.
    pub run: RunId,
    /// Id of its tracker.
    pub plugin_id: String,
    /// Short name of that.
    pub tracker: String,
    /// Content hash of its library.
    pub sha256: String,
    /// Which build of its tracker it is, and when it began, where another run is of another build of the same:
    /// `3f2a1c09, 2026-11-22 18:20`.
    pub build: Option<String>,
    /// The parameters in which it differs from other runs of the same tracker: `radius=5`; empty where in none.
    pub params: String,
    /// The tracks it has samples of.
    pub tracks: TrackSet,
    /// The frames it has samples in.
    pub frames: Range<u32>,
    /// Whether it is shown.
    pub is_shown: bool,
    /// Whether a tracker that was rebuilt in the middle of a run did the frames before again.
    pub is_beside: bool,
}

impl Entrant {
    /// What it is called: `run 2 klt radius=5`.
    #[must_use]
    pub fn name(&self) -> String {
        let gap = if self.params.is_empty() { "" } else { " " };
        let rebuilt = if self.is_beside { " rebuilt" } else { "" };
        let build = self.build.as_ref().map_or_else(String::new, |build| format!(" ({build})"));
        format!("run {} {}{rebuilt}{gap}{}{build}", self.run, self.tracker, self.params)
    }

    /// Whether the same build of a tracker with the same parameters made both.
    fn is_alike(&self, other: &Self) -> bool {
        let made = |one: &Self| (one.plugin_id.clone(), one.sha256.clone(), one.params.clone());
        made(self) == made(other)
    }

    /// Whether both have samples of some track.
    #[must_use]
    pub fn shares_tracks(&self, other: &Self) -> bool {
        self.tracks.iter().any(|track| other.tracks.contains(track))
    }
}

/// The runs that can be compared, the newest first.
///
/// # Errors
/// What the project met.
pub fn entrants(project: &Project) -> Result<Vec<Entrant>, WorkbenchError> {
    let shown: BTreeSet<RunId> = project.document().runs().iter().map(|shown| shown.run).collect();
    let mut runs = project.runs()?;
    runs.retain(|run| {
        let is_whole = matches!(run.head.provenance.what.as_str(), "track" | "import" | REBUILT);
        is_whole && run.state != RunState::Running && !run.tracks.is_empty()
    });
    let made: Vec<Provenance> = runs.iter().map(|run| run.head.provenance.clone()).collect();
    let entrant = |run: honami_store::RunInfo| {
        let Provenance { what, plugin_id, plugin_sha256, .. } = &run.head.provenance;
        Entrant {
            run: run.id,
            plugin_id: plugin_id.clone(),
            tracker: plugin_id.rsplit('.').next().unwrap_or(plugin_id).to_owned(),
            sha256: plugin_sha256.clone(),
            build: build(&run.head.provenance, &made),
            is_beside: what == REBUILT,
            params: differing(&run.head.provenance, &made),
            is_shown: shown.contains(&run.id),
            tracks: run.tracks,
            frames: run.found,
        }
    };
    Ok(runs.into_iter().rev().map(entrant).collect())
}

/// Which build made a run, where other runs are of other builds of the same tracker.
fn build(own: &Provenance, all: &[Provenance]) -> Option<String> {
    let is_other =
        |other: &Provenance| other.plugin_id == own.plugin_id && other.plugin_sha256 != own.plugin_sha256;
    all.iter().any(is_other).then(|| {
        let hash = own.plugin_sha256.get(..8).unwrap_or(&own.plugin_sha256);
        // To the minute.
        let date = own.date.get(..16).unwrap_or(&own.date).replace('T', " ");
        format!("{hash}, {date}")
    })
}

/// The last two builds of one tracker that followed the same tracks, the earlier one first; `None` where there are no two.
#[must_use]
pub fn last_builds(entrants: &[Entrant]) -> Option<[Entrant; 2]> {
    entrants.iter().enumerate().find_map(|(at, b)| {
        let is_before =
            |a: &&Entrant| a.plugin_id == b.plugin_id && a.sha256 != b.sha256 && a.shares_tracks(b);
        Some([entrants[at + 1..].iter().find(is_before)?.clone(), b.clone()])
    })
}

/// The parameters of a run that others of the same tracker have otherwise.
fn differing(own: &Provenance, all: &[Provenance]) -> String {
    let is_other = |(id, value): &(&String, &Value)| {
        let alike = all.iter().filter(|other| other.plugin_id == own.plugin_id);
        alike.into_iter().any(|other| other.params.get(*id) != Some(*value))
    };
    let words = own.params.iter().filter(is_other).map(|(id, value)| format!("{id}={value}"));
    words.collect::<Vec<_>>().join(" ")
}

/// The two that are compared unless others are wished for: B is the newest that is shown, A the newest before it of
/// another tracker or build, or else of the same, that has some of its tracks. After a run in which the tracker was rebuilt
/// they are that run and what the rebuilt one made of the frames before. `None` where no two runs have a track together.
#[must_use]
pub fn usual(entrants: &[Entrant]) -> Option<[Entrant; 2]> {
    if let Some((newest, others)) = entrants.split_first()
        && newest.is_beside
        && let Some(run) = others.iter().find(|other| other.is_shown && other.shares_tracks(newest))
    {
        return Some([run.clone(), newest.clone()]);
    }
    let (shown, hidden): (Vec<&Entrant>, Vec<&Entrant>) = entrants.iter().partition(|one| one.is_shown);
    let by_rank: Vec<&Entrant> = shown.into_iter().chain(hidden).collect();
    by_rank.iter().enumerate().find_map(|(at, b)| {
        let others = || by_rank[at + 1..].iter().filter(|other| other.shares_tracks(b));
        let a = others().find(|other| !other.is_alike(b)).or_else(|| others().next())?;
        Some([(*a).clone(), (*b).clone()])
    })
}

/// Two runs beside each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compared {
    /// The tracks that both have, in order of their numbers.
    pub tracks: Vec<Paired>,
    /// How they disagree.
    pub found: Disagreement,
}

impl Compared {
    /// A track as both have it.
    #[must_use]
    pub fn track(&self, track: TrackId) -> Option<&Paired> {
        let at = self.tracks.binary_search_by_key(&track, |paired| paired.track).ok()?;
        self.tracks.get(at)
    }

    /// Both against key-frames: track, frame, and where a person has put the feature, pixels.
    pub fn at_keys(&self, keys: impl IntoIterator<Item = (TrackId, u32, [f32; 2])>) -> AtKeys {
        at_keys(keys.into_iter().filter_map(|(track, frame, at)| {
            let [a, b] = &self.track(track)?.spans;
            Some(([a.get(frame)?, b.get(frame)?], at))
        }))
    }
}

/// Compares two runs on these tracks, as far as both have them. Opens the project for reading by itself, so that it can
/// be done on any thread.
///
/// # Errors
/// What the project met.
pub fn compare(project: &Path, runs: [RunId; 2], tracks: &TrackSet) -> Result<Compared, WorkbenchError> {
    let project = Project::open(project, Access::Read)?;
    let [a, b] = runs;
    let mut of_b = spans(&project, b, tracks)?;
    let tracks: Vec<Paired> = spans(&project, a, tracks)?
        .into_iter()
        .filter_map(|(track, a)| Some(Paired { track, spans: [a, of_b.remove(&track)?] }))
        .collect();
    let found = disagreement(&tracks);
    Ok(Compared { tracks, found })
}

/// What a run found of some tracks, each to the end of the run.
fn spans(
    project: &Project,
    run: RunId,
    tracks: &TrackSet,
) -> Result<BTreeMap<TrackId, Span>, WorkbenchError> {
    let end = project.run(run)?.found.end;
    let mut pieces = BTreeMap::<TrackId, Vec<Span>>::new();
    for (track, span) in project.run_tracks(run)?.into_iter().filter(|(track, _)| tracks.contains(*track)) {
        pieces.entry(track).or_default().push(span);
    }
    Ok(pieces.into_iter().map(|(track, pieces)| (track, whole(pieces, end))).collect())
}

/// A track of a run in one piece, up to a frame if it ends before: a frame that the tracker left out is lost, where it
/// was before.
pub(crate) fn whole(mut pieces: Vec<Span>, end: u32) -> Span {
    pieces.sort_by_key(|piece| piece.first_frame);
    let mut all =
        Span { first_frame: pieces.first().map_or(0, |piece| piece.first_frame), samples: Vec::new() };
    let fill = |all: &mut Span, up_to: u32| {
        if let Some(&last) = all.samples.last() {
            let lost = Sample { status: Status::Lost, quality: Quality::default(), ..last };
            let n = up_to.saturating_sub(all.first_frame) as usize;
            all.samples.resize(n.max(all.samples.len()), lost);
        }
    };
    for piece in pieces {
        fill(&mut all, piece.first_frame);
        all.samples.truncate((piece.first_frame - all.first_frame) as usize);
        all.samples.extend(piece.samples);
    }
    fill(&mut all, end);
    all
}

#[cfg(test)]
mod tests;
