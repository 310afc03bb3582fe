//! The own long table, read as any other file.

use std::collections::BTreeMap;
use std::path::Path;

use super::draft::{self, Draft, Room};
use super::{Flaw, ForeignError, ForeignTracks};
use crate::rows::TrackRow;
use crate::watch::Watched;

/// Reads a table of tracks as CSV.
pub(crate) fn read_csv(path: &Path, file: Watched) -> Result<ForeignTracks, ForeignError> {
    let mut table = Table::default();
    let flawed = |flaw| ForeignError::Flaw { path: path.to_owned(), flaw };
    for row in crate::table::read_from::<TrackRow>(path, file)? {
        table.put(&row?).map_err(flawed)?;
    }
    table.done().map_err(flawed)
}

/// Rows gathered into tracks.
#[derive(Debug)]
pub(crate) struct Table {
    drafts: BTreeMap<u32, Draft>,
    room: Room,
}

impl Default for Table {
    fn default() -> Self {
        Self { drafts: BTreeMap::new(), room: Room::new() }
    }
}

impl Table {
    pub(crate) fn put(&mut self, row: &TrackRow) -> Result<(), Flaw> {
        let number = row.track.0;
        let draft = self.drafts.entry(number).or_insert_with(|| Draft::numbered(number));
        draft.put(&mut self.room, row.frame, row.sample)
    }

    pub(crate) fn done(self) -> Result<ForeignTracks, Flaw> {
        let tracks = draft::all(self.drafts.into_values())?;
        Ok(ForeignTracks { tracks, ..ForeignTracks::default() })
    }
}
