//! Edits: everything a person can do to a document, each with its inverse.
//!
//! A [`Transaction`] is what one key press did. [`apply`] either does all of it and returns the transaction
//! that takes it back, or changes nothing. Edits are written to the project file as JSON: a variant may gain
//! fields with a default, but is never renamed.

use serde::{Deserialize, Serialize};

use crate::document::{
    ClusteringId, Document, Key, MatteId, Origin, RunId, ShownClustering, ShownRun, Track,
};
use crate::judgement::Judgement;
use crate::over::Over;
use crate::scale::ScaleBar;
use crate::shape::Shape;
use crate::space::SpaceId;
use crate::track::{TrackId, TrackSet};

pub use error::EditError;

mod error;
mod label;

/// One change of a document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Edit {
    /// A person places a new track; its number must be new.
    AddTrack {
        /// The new track.
        track: TrackId,
    },
    /// Takes [`Edit::AddTrack`] back; a track with hand work or in a shown run is deleted instead.
    RemoveTrack {
        /// The track, placed by hand and nothing else.
        track: TrackId,
    },
    /// Tracks vanish; their work is kept.
    DeleteTracks {
        /// The tracks, none of them deleted.
        tracks: TrackSet,
    },
    /// Deleted tracks come back.
    RestoreTracks {
        /// The tracks, all of them deleted.
        tracks: TrackSet,
    },
    /// A track gets a name, or loses it.
    NameTrack {
        /// The track.
        track: TrackId,
        /// The name, not empty.
        name: Option<String>,
    },
    /// A person sets or confirms a sample.
    SetKey {
        /// The track.
        track: TrackId,
        /// Its frame, in the clip.
        frame: u32,
        /// What it becomes.
        key: Key,
    },
    /// A key-frame is given back to the runs below it.
    ClearKey {
        /// The track.
        track: TrackId,
        /// The key-frame's frame.
        frame: u32,
    },
    /// A correction is laid over the runs of a track, or taken away from them.
    Lay {
        /// The track.
        track: TrackId,
        /// Frame of the first of `over`.
        first_frame: u32,
        /// What lies over consecutive frames from now on; `None`: nothing does, the runs show.
        over: Vec<Option<Over>>,
    },
    /// A reviewer judges a segment of a track, or takes the judgement back.
    Judge {
        /// The track.
        track: TrackId,
        /// The segment's first frame.
        first_frame: u32,
        /// The judgement.
        judgement: Option<Judgement>,
    },
    /// A run is shown; tracks not known before are born.
    ShowRun {
        /// The run, not shown yet.
        run: RunId,
        /// The tracks it has samples of.
        tracks: TrackSet,
        /// How many shown runs lie below it; `None`: all.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        above: Option<u32>,
    },
    /// A run is hidden; hand work on its tracks stays.
    HideRun {
        /// The run, shown.
        run: RunId,
        /// Tracks without hand work that are forgotten with it: those whose birth this takes back.
        #[serde(default, skip_serializing_if = "TrackSet::is_empty")]
        forget: TrackSet,
    },
    /// A clustering is shown, or none.
    ShowClustering {
        /// The clustering and its cut.
        clustering: Option<ShownClustering>,
    },
    /// The shown clustering is cut into k groups.
    SetCut {
        /// Number of groups, at least 1.
        k: u32,
    },
    /// A group gets a name, or loses it.
    NameGroup {
        /// The clustering the group belongs to.
        clustering: ClusteringId,
        /// The node of its dendrogram.
        node: u32,
        /// The name, not empty.
        name: Option<String>,
    },
    /// A person says which groups of a clustering stay as they are wherever its cut is.
    HoldGroups {
        /// The clustering.
        clustering: ClusteringId,
        /// Of each group the nodes of the dendrogram that it consists of, at least one; no node is in two.
        groups: Vec<Vec<u32>>,
    },
    /// A person says where skeletons stand, or leaves it to whoever grows them.
    PlaceRoot {
        /// Pixels (right, down), finite.
        root: Option<[f64; 2]>,
    },
    /// A person says how long something in the picture is, or takes that back.
    SetScale {
        /// The bar, which measures; its frame is in the clip.
        bar: Option<ScaleBar>,
    },
    /// A person shapes a bone, or leaves it as it grows.
    ShapeBone {
        /// The clustering whose groups the skeleton is of.
        clustering: ClusteringId,
        /// The node of its dendrogram whose centre the bone ends at.
        node: u32,
        /// How it is shaped.
        shape: Option<Shape>,
    },
    /// A matte says from now on where in a frame features may be, or none does.
    KeepMatte {
        /// Its frame, in the clip.
        frame: u32,
        /// The matte.
        matte: Option<MatteId>,
    },
    /// Tracks in space are shown, or none.
    ShowSpace {
        /// Which of them.
        space: Option<SpaceId>,
    },
}

/// Edits that are done and undone together, and one line that says what happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transaction {
    /// What happened, in the user's words: `track 42: key-frame at 187 (moved 6.3 px)`.
    pub label: String,
    /// The changes, in order.
    pub edits: Vec<Edit>,
}

impl Edit {
    /// The tracks whose samples this edit may change.
    #[must_use]
    pub fn touched(&self) -> TrackSet {
        match self {
            Self::AddTrack { track } | Self::RemoveTrack { track } => (*track).into(),
            Self::SetKey { track, .. } | Self::ClearKey { track, .. } | Self::Lay { track, .. } => {
                (*track).into()
            }
            Self::DeleteTracks { tracks } | Self::RestoreTracks { tracks } | Self::ShowRun { tracks, .. } => {
                tracks.clone()
            }
            Self::HideRun { forget, .. } => forget.clone(),
            Self::NameTrack { .. }
            | Self::Judge { .. }
            | Self::ShowClustering { .. }
            | Self::SetCut { .. }
            | Self::NameGroup { .. }
            | Self::HoldGroups { .. }
            | Self::PlaceRoot { .. }
            | Self::SetScale { .. }
            | Self::ShapeBone { .. }
            | Self::KeepMatte { .. }
            | Self::ShowSpace { .. } => TrackSet::default(),
        }
    }
}

/// Does all edits of a transaction and returns the one that takes them back; its label is the same.
///
/// # Errors
/// [`EditError`] names the first edit that cannot be done; then the document is as before.
pub fn apply(document: &mut Document, transaction: &Transaction) -> Result<Transaction, EditError> {
    if transaction.edits.is_empty() {
        return Err(EditError::Empty);
    }
    let mut inverse = Vec::with_capacity(transaction.edits.len());
    for edit in &transaction.edits {
        match document.edit(edit) {
            Ok(back) => inverse.push(back),
            Err(error) => {
                for back in inverse.iter().rev() {
                    let undone = document.edit(back);
                    debug_assert!(undone.is_ok(), "{back:?} takes back what was just done: {undone:?}");
                }
                return Err(error);
            }
        }
    }
    inverse.reverse();
    Ok(Transaction { label: transaction.label.clone(), edits: inverse })
}

impl Document {
    /// Does one edit and returns its inverse; an edit that fails has changed nothing.
    fn edit(&mut self, edit: &Edit) -> Result<Edit, EditError> {
        match edit {
            Edit::AddTrack { track } => self.add_track(*track),
            Edit::RemoveTrack { track } => {
                self.forget(*track)?;
                Ok(Edit::AddTrack { track: *track })
            }
            Edit::DeleteTracks { tracks } => {
                self.mark_deleted(tracks, true)?;
                Ok(Edit::RestoreTracks { tracks: tracks.clone() })
            }
            Edit::RestoreTracks { tracks } => {
                self.mark_deleted(tracks, false)?;
                Ok(Edit::DeleteTracks { tracks: tracks.clone() })
            }
            Edit::NameTrack { track, name } => {
                check_name(name.as_deref())?;
                let old = std::mem::replace(&mut self.live(*track)?.name, name.clone());
                Ok(Edit::NameTrack { track: *track, name: old })
            }
            Edit::SetKey { track, frame, key } => self.set_key(*track, *frame, *key),
            Edit::ClearKey { track, frame } => self.clear_key(*track, *frame),
            Edit::Lay { track, first_frame, over } => self.lay(*track, *first_frame, over),
            Edit::Judge { track, first_frame, judgement } => {
                self.judge(*track, *first_frame, judgement.as_ref())
            }
            Edit::ShowRun { run, tracks, above } => self.show_run(*run, tracks, *above),
            Edit::HideRun { run, forget } => self.hide_run(*run, forget),
            Edit::ShowClustering { clustering } => {
                check_cut(clustering.map(|shown| shown.k))?;
                let clustering = std::mem::replace(&mut self.clustering, *clustering);
                Ok(Edit::ShowClustering { clustering })
            }
            Edit::SetCut { k } => {
                check_cut(Some(*k))?;
                let shown = self.clustering.as_mut().ok_or(EditError::NoClustering)?;
                Ok(Edit::SetCut { k: std::mem::replace(&mut shown.k, *k) })
            }
            Edit::NameGroup { clustering, node, name } => {
                let name = self.name_group((*clustering, *node), name.as_ref())?;
                Ok(Edit::NameGroup { clustering: *clustering, node: *node, name })
            }
            Edit::HoldGroups { clustering, groups } => {
                check_groups(groups)?;
                let old = match &groups[..] {
                    [] => self.held.remove(clustering),
                    groups => self.held.insert(*clustering, groups.to_vec()),
                };
                Ok(Edit::HoldGroups { clustering: *clustering, groups: old.unwrap_or_default() })
            }
            Edit::PlaceRoot { root } => {
                check_root(*root)?;
                Ok(Edit::PlaceRoot { root: std::mem::replace(&mut self.root, *root) })
            }
            Edit::SetScale { bar } => self.set_scale(*bar),
            Edit::ShapeBone { clustering, node, shape } => {
                shape.as_ref().map_or(Ok(()), Shape::check)?;
                let at = (*clustering, *node);
                let old = match shape {
                    Some(shape) => self.shapes.insert(at, *shape),
                    None => self.shapes.remove(&at),
                };
                Ok(Edit::ShapeBone { clustering: *clustering, node: *node, shape: old })
            }
            Edit::KeepMatte { frame, matte } => self.keep_matte(*frame, *matte),
            Edit::ShowSpace { space } => {
                Ok(Edit::ShowSpace { space: std::mem::replace(&mut self.space, *space) })
            }
        }
    }

    fn live(&mut self, track: TrackId) -> Result<&mut Track, EditError> {
        match self.tracks.get_mut(&track) {
            None => Err(EditError::NoSuchTrack(track)),
            Some(known) if known.deleted => Err(EditError::Deleted(track)),
            Some(known) => Ok(known),
        }
    }

    fn name_group(
        &mut self,
        at: (ClusteringId, u32),
        name: Option<&String>,
    ) -> Result<Option<String>, EditError> {
        check_name(name.map(String::as_str))?;
        Ok(match name {
            Some(name) => self.group_names.insert(at, name.clone()),
            None => self.group_names.remove(&at),
        })
    }

    fn add_track(&mut self, track: TrackId) -> Result<Edit, EditError> {
        if self.tracks.contains_key(&track) {
            return Err(EditError::TrackExists(track));
        }
        self.tracks.insert(track, Track::new(Origin::Hand));
        Ok(Edit::RemoveTrack { track })
    }

    fn forget(&mut self, track: TrackId) -> Result<(), EditError> {
        let known = self.tracks.get(&track).ok_or(EditError::NoSuchTrack(track))?;
        if let Origin::Run(run) = known.origin {
            return Err(EditError::InRun { run, track });
        }
        if known.has_work() {
            return Err(EditError::HasWork(track));
        }
        if let Some(run) = self.runs_of(track).next() {
            return Err(EditError::InRun { run, track });
        }
        self.tracks.remove(&track);
        Ok(())
    }

    fn mark_deleted(&mut self, tracks: &TrackSet, deleted: bool) -> Result<(), EditError> {
        for track in tracks.iter() {
            match self.tracks.get(&track) {
                None => return Err(EditError::NoSuchTrack(track)),
                Some(known) if known.deleted == deleted => {
                    return Err(if deleted {
                        EditError::Deleted(track)
                    } else {
                        EditError::NotDeleted(track)
                    });
                }
                Some(_) => {}
            }
        }
        for track in tracks.iter() {
            if let Some(known) = self.tracks.get_mut(&track) {
                known.deleted = deleted;
            }
        }
        Ok(())
    }

    /// Refuses a range of frames that is empty or not in the clip.
    fn within(&self, frames: std::ops::Range<u64>) -> Result<(), EditError> {
        let n_frames = self.n_frames;
        match frames {
            _ if frames.is_empty() => Err(EditError::NoFrames),
            _ if frames.end > u64::from(n_frames) => {
                let frame = u32::try_from(frames.end - 1).unwrap_or(u32::MAX);
                Err(EditError::BeyondClip { frame, n_frames })
            }
            _ => Ok(()),
        }
    }

    fn lay(&mut self, track: TrackId, first_frame: u32, over: &[Option<Over>]) -> Result<Edit, EditError> {
        let first = u64::from(first_frame);
        self.within(first..first + over.len() as u64)?;
        let known = self.live(track)?;
        for (frame, over) in (first_frame..).zip(over) {
            let sample = over.as_ref().and_then(Over::sample);
            if sample.is_some_and(|sample| !(sample.x.is_finite() && sample.y.is_finite())) {
                return Err(EditError::NotFinite { track, frame });
            }
        }
        let lay = |(frame, over): (u32, &Option<Over>)| match over {
            Some(over) => known.over.insert(frame, *over),
            None => known.over.remove(&frame),
        };
        let over = (first_frame..).zip(over).map(lay).collect();
        Ok(Edit::Lay { track, first_frame, over })
    }

    fn judge(
        &mut self,
        track: TrackId,
        first_frame: u32,
        judgement: Option<&Judgement>,
    ) -> Result<Edit, EditError> {
        if let Some(judgement) = judgement {
            self.within(first_frame.into()..judgement.end_frame.into())?;
        }
        let judgements = &mut self.live(track)?.judgements;
        let old = match judgement {
            Some(judgement) => judgements.insert(first_frame, judgement.clone()),
            None => judgements.remove(&first_frame),
        };
        Ok(Edit::Judge { track, first_frame, judgement: old })
    }

    fn set_key(&mut self, track: TrackId, frame: u32, key: Key) -> Result<Edit, EditError> {
        self.within(frame.into()..u64::from(frame) + 1)?;
        let known = self.live(track)?;
        if !(key.x.is_finite() && key.y.is_finite()) {
            return Err(EditError::NotFinite { track, frame });
        }
        Ok(match known.keys.insert(frame, key) {
            Some(key) => Edit::SetKey { track, frame, key },
            None => Edit::ClearKey { track, frame },
        })
    }

    fn clear_key(&mut self, track: TrackId, frame: u32) -> Result<Edit, EditError> {
        let key = self.live(track)?.keys.remove(&frame).ok_or(EditError::NoKey { track, frame })?;
        Ok(Edit::SetKey { track, frame, key })
    }

    fn set_scale(&mut self, bar: Option<ScaleBar>) -> Result<Edit, EditError> {
        if let Some(bar) = &bar {
            bar.check()?;
            self.within(bar.frame.into()..u64::from(bar.frame) + 1)?;
        }
        Ok(Edit::SetScale { bar: std::mem::replace(&mut self.scale, bar) })
    }

    fn keep_matte(&mut self, frame: u32, matte: Option<MatteId>) -> Result<Edit, EditError> {
        self.within(frame.into()..u64::from(frame) + 1)?;
        let old = match matte {
            Some(matte) => self.mattes.insert(frame, matte),
            None => self.mattes.remove(&frame),
        };
        Ok(Edit::KeepMatte { frame, matte: old })
    }

    fn show_run(&mut self, run: RunId, tracks: &TrackSet, above: Option<u32>) -> Result<Edit, EditError> {
        if self.runs.iter().any(|shown| shown.run == run) {
            return Err(EditError::RunShown(run));
        }
        let at = above.map_or(self.runs.len(), |n| self.runs.len().min(n as usize));
        self.runs.insert(at, ShownRun { run, tracks: tracks.clone() });
        let born = |track: &TrackId| !self.tracks.contains_key(track);
        let forget: TrackSet = tracks.iter().filter(born).collect();
        self.tracks.extend(forget.iter().map(|track| (track, Track::new(Origin::Run(run)))));
        Ok(Edit::HideRun { run, forget })
    }

    fn hide_run(&mut self, run: RunId, forget: &TrackSet) -> Result<Edit, EditError> {
        let at = self.runs.iter().position(|shown| shown.run == run).ok_or(EditError::RunHidden(run))?;
        for track in forget.iter() {
            let known = self.tracks.get(&track).ok_or(EditError::NoSuchTrack(track))?;
            if known.origin != Origin::Run(run) || !self.runs_of(track).eq([run]) {
                return Err(EditError::NotItsOwn { run, track });
            }
            if known.has_work() {
                return Err(EditError::HasWork(track));
            }
        }
        self.tracks.retain(|&track, _| !forget.contains(track));
        let above = (at + 1 < self.runs.len()).then(|| u32::try_from(at).unwrap_or(u32::MAX));
        let ShownRun { tracks, .. } = self.runs.remove(at);
        Ok(Edit::ShowRun { run, tracks, above })
    }
}

fn check_name(name: Option<&str>) -> Result<(), EditError> {
    if name.is_some_and(|name| name.trim().is_empty()) { Err(EditError::EmptyName) } else { Ok(()) }
}

fn check_cut(k: Option<u32>) -> Result<(), EditError> {
    if k == Some(0) { Err(EditError::NoGroups) } else { Ok(()) }
}

fn check_root(root: Option<[f64; 2]>) -> Result<(), EditError> {
    match root {
        Some([x, y]) if !(x.is_finite() && y.is_finite()) => Err(EditError::Root(format!("{x}, {y}"))),
        _ => Ok(()),
    }
}

fn check_groups(groups: &[Vec<u32>]) -> Result<(), EditError> {
    let mut nodes: Vec<u32> = groups.concat();
    nodes.sort_unstable();
    let is_twice = nodes.windows(2).any(|pair| pair[0] == pair[1]);
    if is_twice || groups.iter().any(Vec::is_empty) { Err(EditError::NotApart) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
