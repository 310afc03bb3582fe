//! Where the numbers of a file of others lie.

use serde_json::Value;

use super::scene::{lacks, whole};
use super::{Document, U8, U16, U32};
use crate::plant::PlantFileError;

/// Rows of numbers, all in the file and none over another.
pub(super) struct Rows<'a> {
    /// From the first on.
    bytes: &'a [u8],
    size: u32,
    columns: usize,
    /// From row to row, bytes.
    stride: usize,
    pub(super) count: usize,
}

impl Document {
    /// The rows of an accessor, which must be of a kind and of one of the sizes that are wanted.
    pub(super) fn rows(
        &self,
        accessor: usize,
        kind: &str,
        wanted: &[u32],
    ) -> Result<Rows<'_>, PlantFileError> {
        let words = &self.words["accessors"][accessor];
        let size = whole(&words["componentType"]).unwrap_or(0) as u32;
        let is_plain = words["type"] == kind && wanted.contains(&size) && words["sparse"].is_null();
        let view = whole(&words["bufferView"]).map(|view| &self.words["bufferViews"][view]);
        let view = view.filter(|view| view.is_object());
        let (true, Some(view)) = (is_plain, view) else {
            let what = format!("the numbers of accessor {accessor} are packed: export the mesh unpacked");
            return Err(lacks(&what));
        };
        let columns = if kind == "VEC3" { 3 } else { 1 };
        let row = columns * width(size);
        let of = |value: &Value| whole(value).unwrap_or(0);
        let stride = whole(&view["byteStride"]).unwrap_or(row);
        if stride < row {
            let what = format!("rows of accessor {accessor} take {row} bytes and begin every {stride}");
            return Err(lacks(&what));
        }
        let (first, count) =
            (of(&view["byteOffset"]).saturating_add(of(&words["byteOffset"])), of(&words["count"]));
        let length =
            count.saturating_sub(1).saturating_mul(stride).saturating_add(if count == 0 { 0 } else { row });
        let bytes = self.numbers.get(first..first.saturating_add(length));
        let bytes = bytes.ok_or_else(|| lacks("numbers lie beyond the end of the file"))?;
        Ok(Rows { bytes, size, columns, stride, count })
    }
}

impl Rows<'_> {
    /// Row after row.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        let width = width(self.size);
        let rows = (0..self.count).map(move |row| &self.bytes[row * self.stride..][..self.columns * width]);
        rows.flat_map(move |row| row.chunks_exact(width)).map(move |number| match *number {
            [byte] => f64::from(byte),
            [a, b] => f64::from(u16::from_le_bytes([a, b])),
            [a, b, c, d] if self.size == U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => f64::NAN,
        })
    }
}

/// Bytes of a number.
fn width(size: u32) -> usize {
    match size {
        U8 => 1,
        U16 => 2,
        _ => 4,
    }
}
