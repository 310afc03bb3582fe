//! Tracks in space: what two cameras see of the same features, and when it has become stale.

use honami_model::history::EntryId;
use honami_model::provenance::Provenance;
use honami_model::space::{Fix, SpaceId, SpaceTrack};
use honami_model::track::TrackId;
use rusqlite::{OptionalExtension, Row, params};

use crate::clustering::{Stale, from_json};
use crate::error::StoreError;
use crate::project::Project;

/// Tracks in space that were found together.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    /// What made them, from what; its input revision decides when they are stale.
    pub provenance: Provenance,
    /// The tracks, in order of the left project's numbers.
    pub tracks: Vec<SpaceTrack>,
}

/// Tracks in space, without their fixes.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceInfo {
    /// Their number.
    pub id: SpaceId,
    /// How many tracks they are.
    pub n_tracks: usize,
    /// How many fixes these have.
    pub n_fixes: u64,
    /// What made them, from what.
    pub provenance: Provenance,
}

/// Left track, right track, and how many fixes they have.
type Pairs = Vec<(TrackId, TrackId, u32)>;

impl Project {
    /// Keeps tracks in space; showing them is an edit.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], or what SQLite met.
    pub fn save_space(&mut self, space: &Space) -> Result<SpaceId, StoreError> {
        let Space { provenance, tracks } = space;
        let pair = |track: &SpaceTrack| (track.track, track.right, crate::codec::len_u32(track.fixes.len()));
        let pairs: Pairs = tracks.iter().map(pair).collect();
        let json = |what: serde_json::Result<String>| what.map_err(StoreError::corrupt);
        let (pairs, provenance) =
            (json(serde_json::to_string(&pairs))?, json(serde_json::to_string(provenance))?);
        let conn = self.writer()?;
        conn.execute(
            "INSERT INTO space (tracks, fixes, provenance) VALUES (?1, ?2, ?3)",
            params![pairs, encode(tracks), provenance],
        )?;
        Ok(SpaceId(u32::try_from(conn.last_insert_rowid()).map_err(StoreError::corrupt)?))
    }

    /// Tracks in space with their fixes.
    ///
    /// # Errors
    /// [`StoreError::NoSuchSpace`], or what SQLite met.
    pub fn space(&self, id: SpaceId) -> Result<Space, StoreError> {
        let sql = "SELECT tracks, provenance, fixes FROM space WHERE id = ?1";
        let mut statement = self.conn.prepare_cached(sql)?;
        let row = statement.query_row([id.0], |row| Ok(space_of_row(row))).optional()?;
        row.unwrap_or(Err(StoreError::NoSuchSpace(id)))
    }

    /// All tracks in space in the order they were made.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn spaces(&self) -> Result<Vec<SpaceInfo>, StoreError> {
        let mut statement = self.conn.prepare("SELECT tracks, provenance, id FROM space ORDER BY id")?;
        let info = |row: &Row<'_>| {
            let pairs: Pairs = from_json(row, 0)?;
            let n_fixes = pairs.iter().map(|&(.., n)| u64::from(n)).sum();
            let (id, provenance) = (SpaceId(row.get(2)?), from_json(row, 1)?);
            Ok(SpaceInfo { id, n_tracks: pairs.len(), n_fixes, provenance })
        };
        let rows = statement.query_map([], |row| Ok(info(row)))?;
        rows.map(|row| row?).collect()
    }

    /// Whether this project's tracks have changed since tracks in space were made of them, as
    /// [`is_stale`](Self::is_stale) of a clustering.
    ///
    /// # Errors
    /// [`StoreError::NoSuchSpace`], or what SQLite met.
    pub fn is_space_stale(&self, id: SpaceId) -> Result<Option<Stale>, StoreError> {
        // Fixes are many, and not asked for.
        let sql = "SELECT tracks, provenance FROM space WHERE id = ?1";
        let mut statement = self.conn.prepare_cached(sql)?;
        let pair = |row: &Row<'_>| Ok::<(Pairs, Provenance), _>((from_json(row, 0)?, from_json(row, 1)?));
        let found = statement.query_row([id.0], |row| Ok(pair(row))).optional()?;
        let (pairs, provenance) = found.unwrap_or(Err(StoreError::NoSuchSpace(id)))?;
        let used = pairs.iter().map(|(track, ..)| *track).collect();
        self.changed_since(EntryId(provenance.input_revision), &used)
    }

    pub(crate) fn check_space(&self, id: SpaceId) -> Result<(), StoreError> {
        let sql = "SELECT EXISTS (SELECT 1 FROM space WHERE id = ?1)";
        let exists: bool = self.conn.prepare_cached(sql)?.query_row([id.0], |row| row.get(0))?;
        if exists { Ok(()) } else { Err(StoreError::NoSuchSpace(id)) }
    }
}

fn space_of_row(row: &Row<'_>) -> Result<Space, StoreError> {
    let pairs: Pairs = from_json(row, 0)?;
    let bytes = row.get_ref(2)?.as_blob().map_err(StoreError::corrupt)?;
    let mut fixes = bytes.as_chunks::<FIX_BYTES>().0.iter().map(decode);
    let tracks: Vec<SpaceTrack> = pairs
        .into_iter()
        .map(|(track, right, n)| SpaceTrack {
            track,
            right,
            fixes: fixes.by_ref().take(n as usize).collect(),
        })
        .collect();
    Ok(Space { provenance: from_json(row, 1)?, tracks })
}

const FIX_BYTES: usize = 44;

fn encode(tracks: &[SpaceTrack]) -> Vec<u8> {
    let mut out = Vec::new();
    for Fix { frame, place_m, errors_m, residual_px } in tracks.iter().flat_map(|track| &track.fixes) {
        out.extend_from_slice(&frame.to_le_bytes());
        place_m.iter().for_each(|c| out.extend_from_slice(&c.to_le_bytes()));
        errors_m.iter().chain([residual_px]).for_each(|c| out.extend_from_slice(&c.to_le_bytes()));
    }
    out
}

fn decode(bytes: &[u8; FIX_BYTES]) -> Fix {
    let words = bytes.as_chunks::<4>().0;
    let word = |k: usize| u32::from_le_bytes(words[k]);
    let double = |k: usize| f64::from_bits(u64::from(word(k + 1)) << 32 | u64::from(word(k)));
    let single = |k: usize| f32::from_bits(word(k));
    Fix {
        frame: word(0),
        place_m: [1, 3, 5].map(double),
        errors_m: [7, 8, 9].map(single),
        residual_px: single(10),
    }
}

#[cfg(test)]
mod tests {
    use honami_model::edit::Transaction;

    use super::*;
    use crate::testing::{Bench, provenance, tracked};

    fn space(input_revision: u32) -> Space {
        let fix = |track: u32, frame: u32| Fix {
            frame,
            place_m: [f64::from(track) + 0.1, -f64::from(frame) / 3.0, 2.0 + 1e-9],
            errors_m: [1e-4, 2e-4, 3e-3],
            residual_px: 0.3 + frame as f32,
        };
        let of = |track: u32, frames: std::ops::Range<u32>| SpaceTrack {
            track: TrackId(track),
            right: TrackId(40 - track),
            fixes: frames.map(|frame| fix(track, frame)).collect(),
        };
        Space {
            provenance: provenance("triangulate", input_revision),
            tracks: vec![of(0, 3..9), of(2, 0..2)],
        }
    }

    #[test]
    fn tracks_in_space_come_back_with_every_bit_and_are_shown_by_an_edit() {
        let bench = Bench::new();
        let mut project = tracked(&bench, 0..4);
        let kept = space(project.revision().0);
        let id = project.save_space(&kept).unwrap();
        project.commit(Transaction::show_space(id, 2)).unwrap();
        let gone = project.commit(Transaction::show_space(SpaceId(id.0 + 1), 1));
        assert!(matches!(gone, Err(StoreError::NoSuchSpace(_))), "{gone:?}");
        drop(project);
        let mut project = Project::open(&bench.path(), crate::Access::Write).unwrap();
        assert_eq!(project.document().space(), Some(id));
        assert_eq!(project.space(id).unwrap(), kept);
        let [info] = &project.spaces().unwrap()[..] else { panic!("one") };
        assert_eq!((info.id, info.n_tracks, info.n_fixes), (id, 2, 8));
        project.undo().unwrap();
        assert_eq!(project.document().space(), None);
        project.redo().unwrap();
        assert_eq!(project.document().space(), Some(id));
    }

    #[test]
    fn they_are_stale_when_one_of_their_tracks_has_changed() {
        let bench = Bench::new();
        let mut project = tracked(&bench, 0..4);
        let id = project.save_space(&space(project.revision().0)).unwrap();
        project.commit(Transaction::set_key(TrackId(1), 5, [1.0, 2.0], None)).unwrap();
        assert_eq!(project.is_space_stale(id).unwrap(), None, "track 1 is none of them");
        project.commit(Transaction::set_key(TrackId(2), 5, [1.0, 2.0], None)).unwrap();
        let stale = project.is_space_stale(id).unwrap().unwrap();
        assert!(stale.to_string().starts_with("stale: 1 of its 2 tracks changed"), "{stale}");
        project.undo().unwrap();
        assert_eq!(project.is_space_stale(id).unwrap(), None);
    }
}
