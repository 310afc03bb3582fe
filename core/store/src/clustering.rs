//! Clusterings: immutable hierarchies of tracks, and when they have become stale.

use std::collections::BTreeMap;

use honami_model::document::ClusteringId;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::history::EntryId;
use honami_model::provenance::Provenance;
use honami_model::track::{TrackId, TrackSet};
use rusqlite::{OptionalExtension, Row, params};

use crate::codec::len_u32;
use crate::error::StoreError;
use crate::journal;
use crate::project::Project;

/// What a clusterer found.
#[derive(Clone, Debug, PartialEq)]
pub struct Clustering {
    /// What made it, from what; its input revision decides when it is stale.
    pub provenance: Provenance,
    /// The tracks it grouped: leaf k of the dendrogram is the k-th.
    pub tracks: Vec<TrackId>,
    /// The tree of groups.
    pub dendrogram: Dendrogram,
    /// Number of groups the clusterer proposes.
    pub cut: u32,
    /// Frames it left out.
    pub outlier_frames: Vec<u32>,
    /// What it has to say, a line each.
    pub notes: Vec<String>,
}

/// A clustering, without its tree.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusteringInfo {
    /// Its number.
    pub id: ClusteringId,
    /// How many tracks it grouped.
    pub n_tracks: usize,
    /// Number of groups the clusterer proposes.
    pub cut: u32,
    /// What made it, from what.
    pub provenance: Provenance,
}

/// Why a clustering, or tracks in space, no longer speak of what is shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stale {
    /// The tracks it used that have changed since.
    pub changed: TrackSet,
    /// How many tracks it used.
    pub n_tracks: usize,
    /// The revision it was made at.
    pub since: EntryId,
}

impl std::fmt::Display for Stale {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { changed, n_tracks, since } = self;
        write!(f, "stale: {} of its {n_tracks} tracks changed since revision {since}", changed.len())
    }
}

/// The shown clustering, cut: the group of every track.
#[derive(Clone, Debug, PartialEq)]
pub struct Grouping {
    /// The clustering.
    pub clustering: ClusteringId,
    /// The group of each track it knows, 0 to the number of groups.
    pub group_of: BTreeMap<TrackId, u32>,
    /// The dendrogram's node of every group, of one made by hand its largest: what a group's name hangs on.
    pub nodes: Vec<u32>,
}

impl Project {
    /// Keeps a clustering; showing it is an edit.
    ///
    /// # Errors
    /// [`StoreError::Clustering`] when tracks and leaves differ in number; [`StoreError::ReadOnly`].
    pub fn save_clustering(&mut self, clustering: &Clustering) -> Result<ClusteringId, StoreError> {
        let Clustering { provenance, tracks, dendrogram, cut, outlier_frames, notes } = clustering;
        let leaves = dendrogram.n_leaves();
        if leaves as usize != tracks.len() {
            return Err(StoreError::Clustering { leaves, tracks: tracks.len() });
        }
        let json = |what: serde_json::Result<String>| what.map_err(StoreError::corrupt);
        let conn = self.writer()?;
        conn.execute(
            "INSERT INTO clustering (tracks, merges, cut, outliers, notes, provenance)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            params![
                json(serde_json::to_string(tracks))?,
                encode_merges(dendrogram.merges()),
                cut,
                json(serde_json::to_string(outlier_frames))?,
                json(serde_json::to_string(notes))?,
                json(serde_json::to_string(provenance))?,
            ],
        )?;
        Ok(ClusteringId(u32::try_from(conn.last_insert_rowid()).map_err(StoreError::corrupt)?))
    }

    /// A clustering with its tree.
    ///
    /// # Errors
    /// [`StoreError::NoSuchClustering`], or what SQLite met.
    pub fn clustering(&self, id: ClusteringId) -> Result<Clustering, StoreError> {
        let sql = "SELECT tracks, cut, provenance, merges, outliers, notes FROM clustering WHERE id = ?1";
        let mut statement = self.conn.prepare_cached(sql)?;
        let row = statement.query_row([id.0], |row| Ok(clustering_of_row(row))).optional()?;
        row.unwrap_or(Err(StoreError::NoSuchClustering(id)))
    }

    /// All clusterings in the order they were made.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn clusterings(&self) -> Result<Vec<ClusteringInfo>, StoreError> {
        let mut statement =
            self.conn.prepare("SELECT tracks, cut, provenance, id FROM clustering ORDER BY id")?;
        let rows = statement.query_map([], |row| {
            Ok((|| {
                Ok(ClusteringInfo {
                    id: ClusteringId(row.get(3)?),
                    n_tracks: from_json::<Vec<TrackId>>(row, 0)?.len(),
                    cut: row.get(1)?,
                    provenance: from_json(row, 2)?,
                })
            })())
        })?;
        rows.map(|row| row?).collect()
    }

    /// The shown clustering at its cut, with the groups that were made by hand; `None` when none is shown.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn grouping(&self) -> Result<Option<Grouping>, StoreError> {
        let Some(shown) = self.document().clustering() else { return Ok(None) };
        let clustering = self.clustering(shown.id)?;
        let groups = clustering.dendrogram.groups(shown.k, self.document().held_groups(shown.id));
        Ok(Some(Grouping {
            clustering: shown.id,
            nodes: groups.mains().collect(),
            group_of: clustering.tracks.into_iter().zip(groups.of).collect(),
        }))
    }

    /// Whether tracks that a clustering used have changed since: what was edited on the way through the
    /// undo tree from its input revision to now. `None`: it is as fresh as on the first day. Reads every edit
    /// on that way: keep the answer until the revision changes.
    ///
    /// # Errors
    /// [`StoreError::NoSuchClustering`], or what SQLite met.
    pub fn is_stale(&self, id: ClusteringId) -> Result<Option<Stale>, StoreError> {
        let Clustering { provenance, tracks, .. } = self.clustering(id)?;
        self.changed_since(EntryId(provenance.input_revision), &tracks.into_iter().collect())
    }

    /// Which of these tracks have changed since a revision, on the way through the undo tree to now; `None`: none has.
    ///
    /// # Errors
    /// [`StoreError::NoSuchEntry`], or what SQLite met.
    pub fn changed_since(&self, since: EntryId, used: &TrackSet) -> Result<Option<Stale>, StoreError> {
        let path = self.history().path(since, self.revision()).ok_or(StoreError::NoSuchEntry(since))?;
        let mut changed = Vec::new();
        for step in path {
            for tracks in journal::touched(&self.conn, step)? {
                changed.extend(tracks.iter().filter(|&track| used.contains(track)));
            }
        }
        let changed: TrackSet = changed.into_iter().collect();
        Ok((!changed.is_empty()).then_some(Stale { changed, n_tracks: used.len(), since }))
    }

    pub(crate) fn check_clustering(&self, id: ClusteringId) -> Result<(), StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM clustering WHERE id = ?1)";
        let exists: bool = self.conn.prepare_cached(sql)?.query_row([id.0], |row| row.get(0))?;
        if exists { Ok(()) } else { Err(StoreError::NoSuchClustering(id)) }
    }
}

fn clustering_of_row(row: &Row<'_>) -> Result<Clustering, StoreError> {
    let tracks: Vec<TrackId> = from_json(row, 0)?;
    let merges = decode_merges(row.get_ref(3)?.as_blob().map_err(StoreError::corrupt)?);
    Ok(Clustering {
        cut: row.get(1)?,
        provenance: from_json(row, 2)?,
        dendrogram: Dendrogram::new(len_u32(tracks.len()), merges).map_err(StoreError::corrupt)?,
        outlier_frames: from_json(row, 4)?,
        notes: from_json(row, 5)?,
        tracks,
    })
}

pub(crate) fn from_json<T: serde::de::DeserializeOwned>(
    row: &Row<'_>,
    column: usize,
) -> Result<T, StoreError> {
    let json = row.get_ref(column)?.as_str().map_err(StoreError::corrupt)?;
    serde_json::from_str(json).map_err(StoreError::corrupt)
}

const MERGE_BYTES: usize = 20;

fn encode_merges(merges: &[Merge]) -> Vec<u8> {
    let mut out = Vec::with_capacity(merges.len() * MERGE_BYTES);
    for Merge { a, b, height, size } in merges {
        out.extend_from_slice(&a.to_le_bytes());
        out.extend_from_slice(&b.to_le_bytes());
        out.extend_from_slice(&height.to_le_bytes());
        out.extend_from_slice(&size.to_le_bytes());
    }
    out
}

fn decode_merges(bytes: &[u8]) -> Vec<Merge> {
    let rows = bytes.as_chunks::<MERGE_BYTES>().0.iter();
    rows.map(|row| {
        let words = row.as_chunks::<4>().0;
        let [a, b, low, high, size] = [0, 1, 2, 3, 4].map(|k| u32::from_le_bytes(words[k]));
        Merge { a, b, height: f64::from_bits(u64::from(high) << 32 | u64::from(low)), size }
    })
    .collect()
}
