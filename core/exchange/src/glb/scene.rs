//! What stands in the scene of a file of others: its meshes, where they stand.

use std::collections::{BTreeMap, BTreeSet};

use honami_model::mesh::Mesh;
use serde_json::Value;

use super::accessor::Rows;
use super::{Document, F32, U8, U16, U32, laid};
use crate::mesh::fan;
use crate::plant::PlantFileError;

/// Columns of a matrix, one after another.
pub(crate) type Matrix = [f64; 16];

const NONE: Matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
/// What may be required of a reader and changes no vertex.
const HARMLESS: [&str; 5] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp"];
/// How corners make triangles: three by three, each with the two before it, or each with the one before it and the first.
pub(crate) const TRIANGLES: usize = 4;
const STRIP: usize = 5;
const FAN: usize = 6;
/// Vertices and corners of a scene that is read: gigabytes of memory, twenty million vertices of a usual mesh.
const MOST_NUMBERS: usize = 1 << 27;

/// A mesh at its place in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Which of the trees of nodes that stand in the scene it is of, from 0.
    pub(crate) tree: usize,
    pub(crate) node: usize,
    pub(crate) mesh: usize,
    /// From the mesh to the scene, y up.
    pub(crate) matrix: Matrix,
    /// Vertices of each of its primitives.
    pub(crate) counts: Vec<usize>,
    /// Where its place is a mirror, triangles of each of its primitives, counterclockwise there; else none.
    pub(crate) turned: Vec<Vec<[u32; 3]>>,
}

impl Piece {
    /// Which of the trees of nodes that stand in the scene it is of, from 0.
    #[must_use]
    pub fn tree(&self) -> usize {
        self.tree
    }

    /// How many vertices it has.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.counts.iter().sum()
    }
}

/// A tree of nodes that stands in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// What its root node is called, or which node it is.
    pub name: String,
    /// Where that stands, z up.
    pub pivot: [f64; 3],
}

/// A mesh that a node bears.
#[derive(Clone, Copy, Debug)]
struct Stand {
    tree: usize,
    node: usize,
    mesh: usize,
    matrix: Matrix,
}

impl Document {
    /// Bytes of its numbers.
    #[must_use]
    pub fn n_bytes(&self) -> usize {
        self.numbers.len()
    }

    /// Takes a file apart.
    ///
    /// # Errors
    /// [`PlantFileError::Lacks`] for what is no `.glb` of glTF 2.0, keeps its numbers elsewhere, or wants what is not read.
    pub fn read(bytes: &[u8]) -> Result<Self, PlantFileError> {
        let word = |at: usize| {
            let four = bytes.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(four) as usize)
        };
        if bytes.get(..4) != Some(b"glTF") || word(4) != Some(2) {
            return Err(lacks("a .glb begins with `glTF` and the number 2, this does not"));
        }
        let (mut at, mut words, mut numbers) = (12, None, Vec::new());
        while let (Some(size), Some(kind)) = (word(at), bytes.get(at + 4..at + 8)) {
            let chunk = at.checked_add(8 + size).and_then(|end| bytes.get(at + 8..end));
            let chunk = chunk.ok_or_else(|| lacks("the file ends before it should: was it copied whole?"))?;
            match kind {
                b"JSON" if words.is_none() => words = Some(chunk),
                b"BIN\0" if numbers.is_empty() => numbers = chunk.to_vec(),
                _ => {}
            }
            at += 8 + size.next_multiple_of(4);
        }
        let words = words.ok_or_else(|| lacks("a .glb has words in JSON, this has none"))?;
        let words: Value = serde_json::from_slice(words)
            .map_err(|error| lacks(&format!("the words of the .glb are no JSON: {error}")))?;
        let required = words["extensionsRequired"].as_array().into_iter().flatten();
        let names = required.filter_map(Value::as_str);
        if let Some(name) = names.into_iter().find(|name| !HARMLESS.iter().any(|it| name.starts_with(it))) {
            return Err(lacks(&format!("it wants readers that know {name}: export it without")));
        }
        let buffers = words["buffers"].as_array().map_or(&[][..], Vec::as_slice);
        if buffers.len() != 1 || !buffers[0]["uri"].is_null() {
            return Err(lacks("its numbers are in other files: export it as one .glb"));
        }
        if !words["asset"].is_object() {
            return Err(lacks("a .glb says in `asset`, an object, of which glTF it is, this does not"));
        }
        if words["skins"].as_array().is_some_and(|skins| !skins.is_empty()) {
            return Err(lacks("it is bound to bones already: export the mesh without its bones"));
        }
        Ok(Self { words, numbers })
    }

    /// What is lost of it, a sentence each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let list = |name: &str| self.words[name].as_array().map_or(&[][..], Vec::as_slice);
        let mut notes = Vec::new();
        if !list("animations").is_empty() {
            notes.push("its own animations are left out".to_owned());
        }
        let is_elsewhere =
            |image: &&Value| image["uri"].as_str().is_some_and(|uri| !uri.starts_with("data:"));
        let n = list("images").iter().filter(is_elsewhere).count();
        if n > 0 {
            notes.push(format!(
                "{n} of its pictures are in files of their own: keep these beside what is written"
            ));
        }
        let bear = list("nodes").iter().filter(|node| node["mesh"].is_u64());
        let names: BTreeSet<&String> =
            bear.filter_map(|node| node["extensions"].as_object()).flat_map(serde_json::Map::keys).collect();
        if !names.is_empty() {
            let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
            notes.push(format!("meshes go without what their nodes say by {}", names.join(", ")));
        }
        notes
    }

    /// All meshes of the scene as one, z up, vertices primitive by primitive; and the pieces that these are of.
    ///
    /// # Errors
    /// [`PlantFileError::Lacks`] for words that do not fit one another, for meshes that are packed, and for more of them than
    /// memory is for.
    pub fn pieces(&self) -> Result<(Mesh, Vec<Piece>), PlantFileError> {
        let stands = self.stands()?;
        self.check_size(&stands)?;
        let mut all = Mesh::default();
        let pieces: Result<Vec<Piece>, PlantFileError> =
            stands.into_iter().map(|stand| self.take(stand, &mut all)).collect();
        Ok((all, pieces?))
    }

    /// The trees of nodes that stand in the scene, in the order in which pieces count them.
    ///
    /// # Errors
    /// [`PlantFileError::Lacks`] for a node whose place is none.
    pub fn trees(&self) -> Result<Vec<Tree>, PlantFileError> {
        let tree = |node: usize| {
            let words = &self.words["nodes"][node];
            let name = words["name"].as_str().map_or_else(|| format!("node {node}"), str::to_owned);
            Ok(Tree { name, pivot: laid(placed(&own(words)?, [0.0; 3])) })
        };
        self.roots().into_iter().map(tree).collect()
    }

    fn roots(&self) -> Vec<usize> {
        let scene = whole(&self.words["scene"]).unwrap_or(0);
        indices(&self.words["scenes"][scene]["nodes"])
    }

    /// Nodes of the scene that bear a mesh, which, and where they stand.
    fn stands(&self) -> Result<Vec<Stand>, PlantFileError> {
        let n_nodes = self.words["nodes"].as_array().map_or(0, Vec::len);
        let mut open: Vec<(usize, usize, Matrix)> =
            self.roots().into_iter().enumerate().rev().map(|(tree, node)| (tree, node, NONE)).collect();
        let (mut stands, mut n_seen) = (Vec::new(), 0);
        while let Some((tree, node, before)) = open.pop() {
            n_seen += 1;
            let words = &self.words["nodes"][node];
            let children = indices(&words["children"]);
            // Those that wait are counted, too: small files may name one child a million times.
            if node >= n_nodes || n_seen + open.len() + children.len() > n_nodes {
                return Err(lacks("its nodes are no trees"));
            }
            let matrix = product(&before, &own(words)?);
            open.extend(children.into_iter().rev().map(|child| (tree, child, matrix)));
            stands.extend(whole(&words["mesh"]).map(|mesh| Stand { tree, node, mesh, matrix }));
        }
        Ok(stands)
    }

    /// Whether there is memory for all: a mesh is there as often as nodes bear it, so that small files may be large scenes.
    fn check_size(&self, stands: &[Stand]) -> Result<(), PlantFileError> {
        let mut sizes = BTreeMap::new();
        let mut sum = 0_usize;
        for &Stand { mesh, .. } in stands {
            let size = match sizes.get(&mesh) {
                Some(size) => *size,
                None => self.primitives(mesh)?.iter().map(Primitive::size).sum(),
            };
            sizes.insert(mesh, size);
            sum = sum.saturating_add(size);
        }
        if sum > MOST_NUMBERS {
            let what = format!(
                "its meshes, each as often as it stands in the scene, have {sum} vertices and corners, and {MOST_NUMBERS} are \
                 read at most: a smaller scene is wanted"
            );
            return Err(lacks(&what));
        }
        Ok(())
    }

    fn primitives(&self, mesh: usize) -> Result<Vec<Primitive<'_>>, PlantFileError> {
        let primitives = self.words["meshes"][mesh]["primitives"].as_array();
        let primitives = primitives.ok_or_else(|| lacks(&format!("mesh {mesh} has no primitives")))?;
        let primitive = |words| self.primitive(mesh, words);
        primitives.iter().map(primitive).collect()
    }

    fn primitive<'a>(&'a self, mesh: usize, words: &'a Value) -> Result<Primitive<'a>, PlantFileError> {
        let missing = || lacks(&format!("mesh {mesh} has no positions"));
        let positions = whole(&words["attributes"]["POSITION"]).ok_or_else(missing)?;
        let vertices = self.rows(positions, "VEC3", &[F32])?;
        let mode = whole(&words["mode"]).unwrap_or(TRIANGLES);
        let indices = whole(&words["indices"]).filter(|_| (TRIANGLES..=FAN).contains(&mode));
        let indices = indices.map(|accessor| self.rows(accessor, "SCALAR", &[U8, U16, U32])).transpose()?;
        let targets = words["targets"].as_array().map_or(&[][..], Vec::as_slice);
        Ok(Primitive { vertices, mode, indices, targets })
    }

    /// Where vertices are when nothing moves: with as much of every shape as the node says, or else the mesh.
    fn at_rest(
        &self,
        node: usize,
        mesh: usize,
        primitive: &Primitive<'_>,
    ) -> Result<Vec<f64>, PlantFileError> {
        let mut floats: Vec<f64> = primitive.vertices.numbers().collect();
        let weights = [&self.words["nodes"][node]["weights"], &self.words["meshes"][mesh]["weights"]];
        let weights = weights.into_iter().find_map(Value::as_array).map_or(&[][..], Vec::as_slice);
        for (target, weight) in primitive.targets.iter().zip(weights.iter().filter_map(Value::as_f64)) {
            let Some(shape) = whole(&target["POSITION"]).filter(|_| weight.abs() > 0.0) else { continue };
            let shape = self.rows(shape, "VEC3", &[F32])?;
            if shape.count != primitive.vertices.count {
                return Err(lacks(&format!("a shape of mesh {mesh} is not of its vertices")));
            }
            floats.iter_mut().zip(shape.numbers()).for_each(|(float, by)| *float += weight * by);
        }
        Ok(floats)
    }

    /// Adds the primitives of a mesh where it stands.
    fn take(&self, stand: Stand, all: &mut Mesh) -> Result<Piece, PlantFileError> {
        let Stand { tree, node, mesh, matrix } = stand;
        let is_mirror = determinant(&matrix) < 0.0;
        let (mut counts, mut turned) = (Vec::new(), Vec::new());
        for primitive in self.primitives(mesh)? {
            let first = all.positions.len() as u32;
            let floats = self.at_rest(node, mesh, &primitive)?;
            let places = floats.as_chunks::<3>().0.iter();
            all.positions.extend(places.map(|place| laid(placed(&matrix, *place))));
            counts.push(primitive.vertices.count);
            let none = || lacks(&format!("a triangle of mesh {mesh} has a corner that is none"));
            let mut triangles = primitive.triangles().ok_or_else(none)?;
            if is_mirror {
                triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
            }
            all.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| first + corner)));
            if is_mirror {
                turned.push(triangles);
            }
        }
        Ok(Piece { tree, node, mesh, matrix, counts, turned })
    }
}

/// A part of a mesh.
struct Primitive<'a> {
    vertices: Rows<'a>,
    mode: usize,
    /// Vertices are corners in their own order where there are none.
    indices: Option<Rows<'a>>,
    /// Shapes that it may take on.
    targets: &'a [Value],
}

impl Primitive<'_> {
    /// Vertices and corners; none is for nothing.
    fn size(&self) -> usize {
        1 + self.vertices.count + self.indices.as_ref().map_or(0, |indices| indices.count)
    }

    /// Vertices of each triangle; `None` where one is beyond the last.
    fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        let n = self.vertices.count as u32;
        let corners: Vec<u32> = match &self.indices {
            Some(indices) => indices.numbers().map(|index| index as u32).collect(),
            None => (0..n).collect(),
        };
        let triangles = match self.mode {
            TRIANGLES => corners.as_chunks::<3>().0.to_vec(),
            // Every other one lies the other way round.
            STRIP => {
                corners.windows(3).enumerate().map(|(k, at)| [at[0], at[1 + k % 2], at[2 - k % 2]]).collect()
            }
            FAN => fan(&corners).collect(),
            _ => return Some(Vec::new()),
        };
        corners.iter().all(|corner| *corner < n).then_some(triangles)
    }
}

pub(super) fn lacks(what: &str) -> PlantFileError {
    PlantFileError::Lacks(what.to_owned())
}

pub(super) fn whole(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

fn indices(list: &Value) -> Vec<usize> {
    list.as_array().into_iter().flatten().filter_map(whole).collect()
}

/// A list of as many numbers as were wanted; `None` where there is none.
fn listed<const N: usize>(list: &Value) -> Result<Option<[f64; N]>, PlantFileError> {
    let Some(values) = list.as_array() else { return Ok(None) };
    let values: Vec<f64> = values.iter().filter_map(Value::as_f64).collect();
    let found = values.try_into().map_err(|_other| lacks(&format!("{N} numbers of a node were wanted")));
    found.map(Some)
}

/// How a node lies on the one before it.
fn own(node: &Value) -> Result<Matrix, PlantFileError> {
    if let Some(matrix) = listed::<16>(&node["matrix"])? {
        return Ok(matrix);
    }
    let by = listed::<3>(&node["translation"])?.unwrap_or_default();
    let [x, y, z, w] = listed::<4>(&node["rotation"])?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let [a, b, c] = listed::<3>(&node["scale"])?.unwrap_or([1.0; 3]);
    let column = |column: [f64; 3], size: f64| column.map(|v| v * size);
    let across = column([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)], a);
    let up = column([2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)], b);
    let near = column([2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)], c);
    let mut made = NONE;
    for (k, column) in [across, up, near, by].into_iter().enumerate() {
        made[4 * k..4 * k + 3].copy_from_slice(&column);
    }
    Ok(made)
}

/// One after another.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|at| (0..4).map(|k| a[4 * k + at % 4] * b[4 * (at / 4) + k]).sum())
}

/// Below zero where left becomes right.
fn determinant(m: &Matrix) -> f64 {
    m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8])
        + m[2] * (m[4] * m[9] - m[5] * m[8])
}

fn placed(m: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|row| m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row])
}
