//! The trackers whose runs are shown: how each knows a feature, and what they say of the same tracks.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use honami_model::document::{Document, RunId};
use honami_model::track::TrackId;
use honami_review::evidence::{Kind, Rival};
use honami_store::Project;

use super::MANY;
use crate::error::WorkbenchError;

/// The trackers that look for a feature as its key-frame shows it. Suspicion has weights of their own for them.
pub(super) const ANCHORED: [&str; 1] = ["org.honami.anchored"];

/// A shown run.
struct Member {
    run: RunId,
    kind: Kind,
    /// The short name of its tracker.
    name: String,
    /// Whether it is the tracker's last word: no run of the same tracker with the same parameters lies over it.
    is_last: bool,
}

/// The shown runs, the topmost last.
pub(super) struct Crew(Vec<Member>);

impl Crew {
    /// # Errors
    /// What the project met.
    pub(super) fn of(project: &Project) -> Result<Self, WorkbenchError> {
        let mut members: Vec<(String, Member)> = Vec::new();
        for shown in project.document().runs() {
            let made = project.run(shown.run)?.head.provenance;
            let id = made.plugin_id;
            let kind = if ANCHORED.contains(&id.as_str()) { Kind::Anchored } else { Kind::Stepwise };
            let name = id.rsplit('.').next().unwrap_or(&id).to_owned();
            let tracker = format!("{id} {:?}", made.params);
            // A tracker that was run again has changed its mind: its earlier word does not count.
            members
                .iter_mut()
                .filter(|(other, _)| *other == tracker)
                .for_each(|(_, old)| old.is_last = false);
            members.push((tracker, Member { run: shown.run, kind, name, is_last: true }));
        }
        Ok(Self(members.into_iter().map(|(_, member)| member).collect()))
    }

    /// How the tracker knows a feature whose run is shown of a track.
    pub(super) fn kind(&self, document: &Document, track: TrackId) -> Kind {
        let topmost = document.runs_of(track).next_back();
        self.0.iter().find(|member| Some(member.run) == topmost).map(|member| member.kind).unwrap_or_default()
    }

    /// What runs of different trackers say of some tracks; of those followed by one only, nothing.
    pub(super) fn rivals(
        &self,
        project: &Project,
        tracks: &BTreeSet<TrackId>,
    ) -> Result<BTreeMap<TrackId, Vec<Rival>>, WorkbenchError> {
        let tops: Vec<&Member> = self.0.iter().filter(|member| member.is_last).collect();
        let mut rivals = BTreeMap::<TrackId, Vec<Rival>>::new();
        if tops.len() < 2 {
            return Ok(rivals);
        }
        for top in &tops {
            let run = top.run;
            let is_alone = tops.iter().filter(|other| other.name == top.name).count() == 1;
            // Of one tracker with several parameters the run tells.
            let name: Arc<str> =
                if is_alone { top.name.as_str().into() } else { format!("{} (run {run})", top.name).into() };
            let spans = if tracks.len() > MANY {
                project.run_tracks(run)?
            } else {
                let of = |&track: &TrackId| {
                    Ok(project.run_spans(run, track)?.into_iter().map(move |span| (track, span)))
                };
                tracks
                    .iter()
                    .map(of)
                    .collect::<Result<Vec<_>, WorkbenchError>>()?
                    .into_iter()
                    .flatten()
                    .collect()
            };
            for (track, span) in spans.into_iter().filter(|(track, _)| tracks.contains(track)) {
                let (name, span) = (Arc::clone(&name), Arc::new(span));
                rivals.entry(track).or_default().push(Rival { name, kind: top.kind, span });
            }
        }
        Ok(rivals)
    }
}
