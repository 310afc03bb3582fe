//! Transactions with their line: what happened, in the user's words, with numbers.

use super::{Edit, Transaction};
use crate::brief::Brief;
use crate::brief::counted;
use crate::correct::Refused;
use crate::document::{ClusteringId, Key, MatteId, RunId, ShownClustering};
use crate::judgement::Judgement;
use crate::scale::ScaleBar;
use crate::space::SpaceId;
use crate::track::{Sample, TrackId, TrackSet};

impl Transaction {
    /// One edit under a line.
    #[must_use]
    pub fn new(label: impl Into<String>, edits: Vec<Edit>) -> Self {
        Self { label: label.into(), edits }
    }

    /// A person places a new track, with its first key-frame.
    #[must_use]
    pub fn add_track(track: TrackId, frame: u32, x: f32, y: f32) -> Self {
        let key = Key::set(x, y);
        let edits = vec![Edit::AddTrack { track }, Edit::SetKey { track, frame, key }];
        Self::new(format!("track {track}: placed at frame {frame} ({x:.1}, {y:.1})"), edits)
    }

    /// A person moves a sample, or places one; `from` is where it was shown before, pixels.
    #[must_use]
    pub fn set_key(track: TrackId, frame: u32, to: [f32; 2], from: Option<[f32; 2]>) -> Self {
        let [x, y] = to;
        let how = from.map_or_else(
            || format!("placed at {x:.1}, {y:.1}"),
            |was| format!("moved {:.1} px", (x - was[0]).hypot(y - was[1])),
        );
        let key = Key::set(x, y);
        Self::new(
            format!("track {track}: key-frame at {frame} ({how})"),
            vec![Edit::SetKey { track, frame, key }],
        )
    }

    /// A person finds the sample shown there right; a hidden feature stays hidden.
    ///
    /// # Errors
    /// [`Refused::Unseen`] where the feature is lost, outside or rejected: no place was found there.
    pub fn confirm_key(track: TrackId, frame: u32, shown: &Sample) -> Result<Self, Refused> {
        let unseen = Refused::Unseen { track, frame, status: shown.status };
        let key = Key::confirming(shown).ok_or(unseen)?;
        Ok(Self::new(
            format!("track {track}: key-frame at {frame} (confirmed)"),
            vec![Edit::SetKey { track, frame, key }],
        ))
    }

    /// A key-frame is given back to the runs.
    #[must_use]
    pub fn clear_key(track: TrackId, frame: u32) -> Self {
        Self::new(
            format!("track {track}: key-frame at {frame} cleared"),
            vec![Edit::ClearKey { track, frame }],
        )
    }

    /// A reviewer judges a segment.
    #[must_use]
    pub fn judge(track: TrackId, first_frame: u32, judgement: Judgement) -> Self {
        let last = judgement.end_frame.saturating_sub(1);
        let label = format!("track {track}: frames {first_frame}-{last} {}", judgement.verdict.word());
        Self::new(label, vec![Edit::Judge { track, first_frame, judgement: Some(judgement) }])
    }

    /// Tracks are deleted.
    #[must_use]
    pub fn delete_tracks(tracks: TrackSet) -> Self {
        Self::new(format!("{tracks} deleted"), vec![Edit::DeleteTracks { tracks }])
    }

    /// Deleted tracks come back.
    #[must_use]
    pub fn restore_tracks(tracks: TrackSet) -> Self {
        Self::new(format!("{tracks} restored"), vec![Edit::RestoreTracks { tracks }])
    }

    /// A track gets a name, or loses it.
    #[must_use]
    pub fn name_track(track: TrackId, name: Option<String>) -> Self {
        let label = named(&format!("track {track}"), name.as_deref());
        Self::new(label, vec![Edit::NameTrack { track, name }])
    }

    /// A run is laid over those shown.
    #[must_use]
    pub fn show_run(run: RunId, tracks: TrackSet) -> Self {
        Self::new(format!("run {run} shown: {tracks}"), vec![Edit::ShowRun { run, tracks, above: None }])
    }

    /// A run is hidden; hand work on its tracks stays.
    #[must_use]
    pub fn hide_run(run: RunId) -> Self {
        Self::new(format!("run {run} hidden"), vec![Edit::HideRun { run, forget: TrackSet::default() }])
    }

    /// A clustering is shown, cut into k groups.
    #[must_use]
    pub fn show_clustering(id: ClusteringId, k: u32) -> Self {
        Self::new(
            format!("clustering {id} shown: {}", groups(k)),
            vec![Edit::ShowClustering { clustering: Some(ShownClustering { id, k }) }],
        )
    }

    /// No clustering is shown any more.
    #[must_use]
    pub fn hide_clustering() -> Self {
        Self::new("groups hidden", vec![Edit::ShowClustering { clustering: None }])
    }

    /// The shown clustering is cut elsewhere.
    #[must_use]
    pub fn set_cut(k: u32) -> Self {
        Self::new(format!("cut into {}", groups(k)), vec![Edit::SetCut { k }])
    }

    /// A group, a node of the clustering's dendrogram, gets a name or loses it.
    #[must_use]
    pub fn name_group(clustering: ClusteringId, node: u32, name: Option<String>) -> Self {
        let label = named("group", name.as_deref());
        Self::new(label, vec![Edit::NameGroup { clustering, node, name }])
    }

    /// A scale bar says what a pixel is, or none does.
    #[must_use]
    pub fn set_scale(bar: Option<ScaleBar>) -> Self {
        let label = match &bar {
            Some(bar) => format!("scale: {} m are {:.1} px", Brief(bar.length_m), bar.length_px()),
            None => "scale removed".to_owned(),
        };
        Self::new(label, vec![Edit::SetScale { bar }])
    }

    /// Mattes are kept, each with the frame that it is of.
    #[must_use]
    pub fn keep_mattes(mattes: &[(u32, MatteId)]) -> Self {
        let frames: Vec<u32> = mattes.iter().map(|(frame, _)| *frame).collect();
        let keep = |&(frame, matte): &(u32, MatteId)| Edit::KeepMatte { frame, matte: Some(matte) };
        Self::new(format!("{} kept", of_mattes(&frames)), mattes.iter().map(keep).collect())
    }

    /// The mattes of these frames are kept no longer.
    #[must_use]
    pub fn remove_mattes(frames: &[u32]) -> Self {
        let remove = |&frame: &u32| Edit::KeepMatte { frame, matte: None };
        Self::new(format!("{} removed", of_mattes(frames)), frames.iter().map(remove).collect())
    }

    /// So many tracks in space are shown.
    #[must_use]
    pub fn show_space(id: SpaceId, n_tracks: usize) -> Self {
        Self::new(
            format!("{} in space shown", counted(n_tracks, "track")),
            vec![Edit::ShowSpace { space: Some(id) }],
        )
    }

    /// The tracks whose samples this transaction may change.
    #[must_use]
    pub fn touched(&self) -> TrackSet {
        self.edits.iter().map(Edit::touched).collect()
    }
}

fn named(what: &str, name: Option<&str>) -> String {
    name.map_or_else(|| format!("{what}: name removed"), |name| format!("{what} named {name}"))
}

fn groups(k: u32) -> String {
    if k == 1 { "1 group".to_owned() } else { format!("{k} groups") }
}

/// `matte of frame 12`, `mattes of 5 frames`.
fn of_mattes(frames: &[u32]) -> String {
    match frames {
        [frame] => format!("matte of frame {frame}"),
        frames => format!("mattes of {} frames", frames.len()),
    }
}
