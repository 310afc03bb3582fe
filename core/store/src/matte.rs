//! Mattes: how much of every pixel of one frame is plant, what it is of, and what a person has marked. Immutable.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use honami_model::document::MatteId;
use honami_model::provenance::Provenance;
use rusqlite::{OptionalExtension, Row, TransactionBehavior, params};

use crate::error::StoreError;
use crate::project::Project;

#[cfg(test)]
mod tests;

/// A matte to keep; its planes have a byte a pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptMatte {
    /// What made it, from what.
    pub provenance: Provenance,
    /// The frame that it is of.
    pub frame: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 0 outside, 1 inner background, 2 boundary, 3 trunk, 4 kept.
    pub parts: Vec<u8>,
    /// 0 background to 255 plant.
    pub opacity: Vec<u8>,
    /// 0 unknown, 1 background, 2 foreground.
    pub marks: Vec<u8>,
}

/// A matte, without its planes.
#[derive(Clone, Debug, PartialEq)]
pub struct MatteInfo {
    /// Its number.
    pub id: MatteId,
    /// The frame that it is of.
    pub frame: u32,
    /// What made it, from what.
    pub provenance: Provenance,
}

impl Project {
    /// Keeps mattes, all or none; that they count from now on is an edit.
    ///
    /// # Errors
    /// [`StoreError::Planes`] where a plane has not a byte a pixel; [`StoreError::ReadOnly`].
    pub fn save_mattes(&mut self, mattes: &[KeptMatte]) -> Result<Vec<MatteId>, StoreError> {
        let tx = self.writer()?.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let mut ids = Vec::with_capacity(mattes.len());
        for matte in mattes {
            let [parts, opacity, marks] =
                [&matte.parts, &matte.opacity, &matte.marks].map(|plane| pack(plane, matte));
            tx.prepare_cached(
                "INSERT INTO matte (frame, width, height, parts, opacity, marks, provenance)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
            )?
            .execute(params![
                matte.frame,
                matte.width,
                matte.height,
                parts?,
                opacity?,
                marks?,
                serde_json::to_string(&matte.provenance).map_err(StoreError::corrupt)?,
            ])?;
            ids.push(MatteId(u32::try_from(tx.last_insert_rowid()).map_err(StoreError::corrupt)?));
        }
        tx.commit()?;
        Ok(ids)
    }

    /// A matte with its planes.
    ///
    /// # Errors
    /// [`StoreError::NoSuchMatte`], or what SQLite met.
    pub fn matte(&self, id: MatteId) -> Result<KeptMatte, StoreError> {
        let sql =
            "SELECT id, frame, provenance, width, height, parts, opacity, marks FROM matte WHERE id = ?1";
        let mut statement = self.conn.prepare_cached(sql)?;
        let row = statement.query_row([id.0], |row| Ok(of_row(row))).optional()?;
        row.unwrap_or(Err(StoreError::NoSuchMatte(id)))
    }

    /// What made a matte, of which frame.
    ///
    /// # Errors
    /// [`StoreError::NoSuchMatte`], or what SQLite met.
    pub fn matte_info(&self, id: MatteId) -> Result<MatteInfo, StoreError> {
        let mut statement =
            self.conn.prepare_cached("SELECT id, frame, provenance FROM matte WHERE id = ?1")?;
        let row = statement.query_row([id.0], |row| Ok(info_of_row(row))).optional()?;
        row.unwrap_or(Err(StoreError::NoSuchMatte(id)))
    }

    /// All mattes in the order they were found, also those that do not count.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn mattes(&self) -> Result<Vec<MatteInfo>, StoreError> {
        let mut statement = self.conn.prepare("SELECT id, frame, provenance FROM matte ORDER BY id")?;
        let rows = statement.query_map([], |row| Ok(info_of_row(row)))?;
        rows.map(|row| row?).collect()
    }
}

fn info_of_row(row: &Row<'_>) -> Result<MatteInfo, StoreError> {
    let provenance = row.get_ref(2)?.as_str().map_err(StoreError::corrupt)?;
    let provenance = serde_json::from_str(provenance).map_err(StoreError::corrupt)?;
    Ok(MatteInfo { id: MatteId(row.get(0)?), frame: row.get(1)?, provenance })
}

fn of_row(row: &Row<'_>) -> Result<KeptMatte, StoreError> {
    let MatteInfo { frame, provenance, .. } = info_of_row(row)?;
    let (width, height): (u32, u32) = (row.get(3)?, row.get(4)?);
    let plane =
        |column| unpack(row.get_ref(column)?.as_blob().map_err(StoreError::corrupt)?, [width, height]);
    let (parts, opacity, marks) = (plane(5)?, plane(6)?, plane(7)?);
    Ok(KeptMatte { provenance, frame, width, height, parts, opacity, marks })
}

fn pack(plane: &[u8], matte: &KeptMatte) -> Result<Vec<u8>, StoreError> {
    let wanted = u64::from(matte.width) * u64::from(matte.height);
    if plane.len() as u64 != wanted {
        return Err(StoreError::Planes { wanted, came: plane.len() });
    }
    let mut out = ZlibEncoder::new(Vec::new(), Compression::default());
    out.write_all(plane).map_err(StoreError::corrupt)?;
    out.finish().map_err(StoreError::corrupt)
}

/// A plane of as many bytes as there are pixels, and no more: the file may be anybody's.
fn unpack(bytes: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, StoreError> {
    let wanted = u64::from(width) * u64::from(height);
    let mut plane = Vec::new();
    ZlibDecoder::new(bytes).take(wanted + 1).read_to_end(&mut plane).map_err(StoreError::corrupt)?;
    match plane.len() as u64 == wanted {
        true => Ok(plane),
        false => Err(StoreError::corrupt("a matte has not a byte for each of its pixels")),
    }
}
