//! Files of glTF 2.0 (`.glb`): words, which are JSON, and the numbers that they speak of.
//!
//! Up is y there and z here: x right, y up, z towards the camera, so that what is at (x, y, z) here is at (x, z, -y) there.

mod accessor;
mod graft;
mod own;
mod scene;
#[cfg(test)]
pub(crate) mod tests;

pub use graft::Grafting;
pub use own::is_own;
pub(crate) use scene::{Matrix, TRIANGLES, product};
pub use scene::{Piece, Tree};

use std::io::Write as _;
use std::path::Path;

use honami_model::mesh::Mesh;
use serde_json::{Value, json};

use crate::atomic::AtomicFile;
use crate::table::TableError;

/// Readers take such a file into memory whole, and many count its bytes in 31 bits.
const MOST_BYTES: u64 = i32::MAX as u64;
/// Names of the standard: what a number is, and what it is for.
pub(crate) const U8: u32 = 5121;
pub(crate) const U16: u32 = 5123;
const U32: u32 = 5125;
pub(crate) const F32: u32 = 5126;
/// Of a vertex, of indices, or of neither.
pub(crate) const ARRAY: u32 = 34962;
const INDICES: u32 = 34963;
pub(crate) const OTHER: u32 = 0;
/// What a node that bears a mesh says beside where it stands.
pub(crate) const KEPT: [&str; 3] = ["name", "weights", "extras"];
/// What wood looks like: linear red, green, blue, and how opaque.
const COLOUR: [f32; 4] = [0.16, 0.1, 0.06, 1.0];
const ROUGHNESS: f32 = 0.9;

/// A file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    pub(crate) words: Value,
    pub(crate) numbers: Vec<u8>,
}

/// Why there is no such file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// The disk says no.
    #[error(transparent)]
    File(#[from] TableError),
    /// More than readers can hold.
    #[error(
        "a .glb of this mesh and motion takes {} MB, and its readers hold {} MB at most: a smaller mesh, fewer frames or \
         fewer groups are wanted",
        .bytes / 1_000_000, MOST_BYTES / 1_000_000
    )]
    TooLarge {
        /// Of the file.
        bytes: u64,
    },
}

impl Document {
    /// A scene with a mesh of wood.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let mut made = Self {
            words: json!({
                "scene": 0,
                "scenes": [{ "nodes": [0] }],
                "nodes": [{ "name": "plant", "mesh": 0 }],
                "materials": [{
                    "name": "wood",
                    "pbrMetallicRoughness": {
                        "baseColorFactor": COLOUR, "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS,
                    },
                }],
            }),
            numbers: Vec::new(),
        };
        let indices = made.triangles(&mesh.triangles);
        let mut attributes = json!({ "POSITION": made.vertices(&mesh.positions) });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = made.vertices(&mesh.normals).into();
        }
        let primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
        made.put("meshes", json!({ "name": "plant", "primitives": [primitive] }));
        made
    }

    /// Appends to a list of the words; the number it has there.
    pub(crate) fn put(&mut self, list: &str, what: Value) -> usize {
        if !self.words[list].is_array() {
            self.words[list] = json!([]);
        }
        let list = self.words[list].as_array_mut();
        list.map_or(0, |list| {
            list.push(what);
            list.len() - 1
        })
    }

    /// The list of nodes that stand in the scene by themselves.
    pub(crate) fn scene(&mut self) -> &mut Value {
        let scene = self.words["scene"].as_u64().unwrap_or(0) as usize;
        &mut self.words["scenes"][scene]["nodes"]
    }

    /// Appends numbers that are for something; the number of their accessor.
    pub(crate) fn add(&mut self, target: u32, bytes: &[u8], mut accessor: Value) -> usize {
        // Numbers begin where their size divides the place.
        self.numbers.resize(self.numbers.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.numbers.len(), "byteLength": bytes.len() });
        if target != OTHER {
            view["target"] = target.into();
        }
        self.numbers.extend(bytes);
        accessor["bufferView"] = self.put("bufferViews", view).into();
        self.put("accessors", accessor)
    }

    /// Appends corners; the number of their accessor.
    pub(crate) fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|index| index.to_le_bytes()).collect();
        let what = json!({ "componentType": U32, "type": "SCALAR", "count": 3 * triangles.len() });
        self.add(INDICES, &bytes, what)
    }

    /// Appends three numbers a vertex, which are turned upright.
    fn vertices(&mut self, vertices: &[[f64; 3]]) -> usize {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let mut bytes = Vec::with_capacity(12 * vertices.len());
        for vertex in vertices {
            for (axis, v) in upright(*vertex).map(|v| v as f32).into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(v), high[axis].max(v));
                bytes.extend(v.to_le_bytes());
            }
        }
        let count = vertices.len();
        let what = json!({ "componentType": F32, "type": "VEC3", "count": count, "min": low, "max": high });
        self.add(ARRAY, &bytes, what)
    }

    /// Writes it, whole or not at all, and says how many bytes that took.
    ///
    /// # Errors
    /// [`DocumentError`].
    pub fn write(mut self, path: &Path) -> Result<u64, DocumentError> {
        // Whose the plant is stays.
        self.words["asset"]["version"] = "2.0".into();
        self.words["asset"]["generator"] = concat!("honami ", env!("CARGO_PKG_VERSION")).into();
        self.numbers.resize(self.numbers.len().next_multiple_of(4), 0);
        self.words["buffers"] = json!([{ "byteLength": self.numbers.len() }]);
        let mut words = self.words.to_string().into_bytes();
        // Chunks begin and end at whole words; JSON is filled up with blanks.
        words.resize(words.len().next_multiple_of(4), b' ');
        let bytes = (12 + 8 + words.len() + 8 + self.numbers.len()) as u64;
        if bytes > MOST_BYTES {
            return Err(DocumentError::TooLarge { bytes });
        }
        let mut file = AtomicFile::create(path, |_head| is_own(path))?;
        let counts = [2, bytes as u32, words.len() as u32].map(u32::to_le_bytes).concat();
        let numbers = (self.numbers.len() as u32).to_le_bytes();
        for part in [b"glTF", &counts[..], b"JSON", &words, &numbers, b"BIN\0", &self.numbers] {
            file.write_all(part).map_err(|source| TableError::File { path: path.into(), source })?;
        }
        file.finish()?;
        Ok(bytes)
    }
}

/// From z up to y up.
pub(crate) fn upright([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, -y]
}

/// From y up to z up.
pub(crate) fn laid([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -z, y]
}
