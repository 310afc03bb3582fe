//! Plants put together: branches of a library on the bones of a skeleton that bear no others, tubes along those that do.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use honami_exchange::glb::{Document, Grafting, Piece, Tree};
use honami_exchange::mesh::{MeshFormat, Up};
use honami_mechanics::{Beams, Options};
use honami_model::mesh::Mesh;
use honami_model::skeleton::{Joint, Skeleton};
use honami_structure::StructureError;
use honami_structure::assemble::{Branch, Graft, assemble, branches};

use super::body::{bearing, tubes};
use super::bound::{Bound, Read, in_origin, nodes, read, refused};
use crate::error::WorkbenchError;
use crate::plant::sway::free;

/// Vertices of all branches on a plant, whatever is free: no reader of what is written takes more.
const MOST_VERTICES: usize = 1 << 26;
/// What a vertex and a triangle take until they are written, bytes: places, normals and bindings, and most of it their text in
/// a `.usda`, which is moved as it grows.
const VERTEX_BYTES: usize = 400;
const TRIANGLE_BYTES: usize = 80;
/// Numbers of the library's scenes are in the plant's, and once more in what is written.
const SCENES: usize = 2;
/// Root nodes that are told by their names.
const MOST_NAMES: usize = 8;

/// Branches to put plants together of.
#[derive(Clone, Debug)]
pub struct Library {
    documents: Vec<Document>,
    branches: Vec<Kept>,
    /// What was left out or guessed of each file, a sentence each.
    pub notes: Vec<(PathBuf, String)>,
}

/// Where a branch begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Where whoever made its mesh holds it: the root node of its tree, or the origin of its file.
    Pivot,
    /// Where its mesh is lowest, for the pivot is not of it.
    Lowest,
    /// At the fork of a plant of nodes.
    Fork,
}

#[derive(Clone, Debug)]
struct Kept {
    branch: Branch,
    begin: Begin,
    /// z up.
    mesh: Mesh,
    document: usize,
    /// Of the document, in the order of the mesh's vertices.
    pieces: Vec<Piece>,
}

/// What a plant was put together of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assembled {
    /// Branches in the library.
    pub n_branches: usize,
    /// How many of them are on the plant.
    pub n_used: usize,
    /// Bones that bear one.
    pub n_grafts: usize,
    /// The smallest and the largest, of what they are in the library.
    pub scales: [f64; 2],
    /// Forks that are the centres of groups, whose leaves have no branch.
    pub n_bare: usize,
}

impl Library {
    /// Reads files: meshes, each a branch, or of a `.glb` each tree of nodes that stands in its scene; and plants of nodes, of
    /// which each branch at a fork that is not small becomes tubes. `up` is that of `.obj` and `.ply`. Trees that are no branches
    /// are left out where others of the file are.
    ///
    /// # Errors
    /// What is wrong with a file, [`WorkbenchError::Onto`] where nothing of it is a branch, [`WorkbenchError::NoFork`], and
    /// [`WorkbenchError::NoMeaning`] for `up` of a library of other files.
    pub fn read(paths: &[PathBuf], up: Option<Up>) -> Result<Self, WorkbenchError> {
        let mut library = Self { documents: Vec::new(), branches: Vec::new(), notes: Vec::new() };
        let takes_up = |path: &PathBuf| MeshFormat::of(path).is_some();
        let does_any = paths.iter().any(takes_up);
        for path in paths {
            // Where none does, the first refuses it.
            let up = up.filter(|_| takes_up(path) || !does_any);
            match read(path, up)? {
                Some(read) => library.add_mesh(path, read)?,
                None => library.add_nodes(path)?,
            }
        }
        Ok(library)
    }

    fn add_mesh(&mut self, path: &Path, read: Read) -> Result<(), WorkbenchError> {
        let Read { mesh, up, document, pieces, notes, .. } = read;
        let trees = document.trees().map_err(|error| error.of(path))?;
        // A scene without a mesh is no branch either.
        let (mut why, n_before) = (None, self.branches.len());
        let (mut left_out, mut lowest) = (Vec::new(), Vec::new());
        for (tree, mesh, pieces) in parts(&mesh, pieces) {
            let Tree { name, pivot } = &trees[tree];
            let is_held = Branch::may_begin(&mesh, *pivot);
            match Branch::of(&mesh, is_held.then_some(*pivot)) {
                Ok(branch) if is_held => self.keep(branch, Begin::Pivot, mesh, pieces),
                Ok(branch) => {
                    lowest.push(name.as_str());
                    self.keep(branch, Begin::Lowest, mesh, pieces);
                }
                Err(error @ (StructureError::NoMesh | StructureError::NoBranch { .. })) => {
                    left_out.push(name.as_str());
                    why = why.or(Some(error));
                }
                Err(error) => return Err(refused(error, path, up)),
            }
        }
        if self.branches.len() == n_before {
            return Err(refused(why.unwrap_or(StructureError::NoMesh), path, up));
        }
        let mut notes = notes;
        if !left_out.is_empty() {
            notes.push(format!("left out, for they have no triangle or go nowhere: {}", told(&left_out)));
        }
        if !lowest.is_empty() {
            // Of a file that is one mesh there is no node to name.
            let names =
                if MeshFormat::of(path).is_some() { String::new() } else { format!(": {}", told(&lowest)) };
            notes.push(format!(
                "begins where it is lowest, for its pivot is outside it or in its middle{names}"
            ));
        }
        self.notes.extend(notes.into_iter().map(|note| (path.to_owned(), note)));
        self.documents.push(document);
        Ok(())
    }

    fn add_nodes(&mut self, path: &Path) -> Result<(), WorkbenchError> {
        let measured = nodes(path)?;
        self.notes.extend(measured.notes.into_iter().map(|note| (path.to_owned(), note)));
        let plants = branches(&measured.plant).map_err(|error| refused(error, path, None))?;
        if plants.is_empty() {
            return Err(WorkbenchError::NoFork { path: path.to_owned() });
        }
        for plant in plants {
            let beams = Beams::new(&plant, &Options::default())?;
            let mesh = tubes(&beams);
            let document = Document::of(&mesh);
            let (_, pieces) = document.pieces()?;
            let foot = Some(beams.position(0).into());
            let branch = Branch::of(&mesh, foot).map_err(|error| refused(error, path, None))?;
            self.keep(branch, Begin::Fork, mesh, pieces);
            self.documents.push(document);
        }
        Ok(())
    }

    /// Of the document that comes next.
    fn keep(&mut self, branch: Branch, begin: Begin, mesh: Mesh, pieces: Vec<Piece>) {
        self.branches.push(Kept { branch, begin, mesh, document: self.documents.len(), pieces });
    }

    /// How many branches it has.
    #[must_use]
    pub fn n_branches(&self) -> usize {
        self.branches.len()
    }

    /// How many of them begin so.
    #[must_use]
    pub fn n_that(&self, begin: Begin) -> usize {
        self.branches.iter().filter(|kept| kept.begin == begin).count()
    }
}

/// Names in words, the first ones of many.
fn told(names: &[&str]) -> String {
    let more = names.len().saturating_sub(MOST_NAMES);
    let named = names[..names.len() - more].join(", ");
    if more > 0 { format!("{named} and {more} more") } else { named }
}

/// Whether there is memory for so much on a plant, of so many bytes that are there.
fn check_room(
    n_vertices: usize,
    n_triangles: usize,
    n_scenes: usize,
    there: usize,
) -> Result<(), WorkbenchError> {
    if n_vertices > MOST_VERTICES {
        return Err(WorkbenchError::TooManyVertices { n_vertices, most: MOST_VERTICES });
    }
    let of_triangles = n_triangles.saturating_mul(TRIANGLE_BYTES);
    let bytes = (n_vertices * VERTEX_BYTES).saturating_add(of_triangles).saturating_add(SCENES * n_scenes);
    if bytes > there {
        return Err(WorkbenchError::BranchesMemory { n_vertices, n_triangles, bytes, there });
    }
    Ok(())
}

/// Parts of a mesh by the trees of nodes that its pieces are of, and which these are.
fn parts(mesh: &Mesh, pieces: Vec<Piece>) -> Vec<(usize, Mesh, Vec<Piece>)> {
    let mut parts: BTreeMap<usize, (Mesh, Vec<Piece>)> = BTreeMap::new();
    let (mut first, mut triangles) = (0, mesh.triangles.iter().peekable());
    for piece in pieces {
        let (part, own) = parts.entry(piece.tree()).or_default();
        let (last, begin) = (first + piece.n_vertices(), part.positions.len());
        part.positions.extend(&mesh.positions[first..last]);
        // They come piece by piece, as vertices do.
        while let Some(corners) = triangles.next_if(|corners| (corners[0] as usize) < last) {
            part.triangles.push(corners.map(|corner| corner - first as u32 + begin as u32));
        }
        own.push(piece);
        first = last;
    }
    parts.into_iter().map(|(tree, (mesh, pieces))| (tree, mesh, pieces)).collect()
}

impl Bound {
    /// A plant put together of a library, its root in the origin, a pixel so many metres; the `number`-th sibling of a seed
    /// has other branches.
    ///
    /// # Errors
    /// [`WorkbenchError::Unit`], [`WorkbenchError::Structure`], [`WorkbenchError::Beams`], [`WorkbenchError::TooManyVertices`],
    /// [`WorkbenchError::BranchesMemory`].
    pub fn assembled(
        skeleton: &Skeleton,
        library: &Library,
        unit: f64,
        seed: u64,
        number: u32,
    ) -> Result<Self, WorkbenchError> {
        let rest = in_origin(skeleton, unit)?;
        let known: Vec<Branch> = library.branches.iter().map(|kept| kept.branch).collect();
        let grafts = assemble(&rest, &known, seed, number)?;
        let of = |graft: &Graft| &library.branches[graft.branch];
        let n_vertices = grafts.iter().map(|graft| of(graft).mesh.positions.len()).sum();
        let n_triangles = grafts.iter().map(|graft| of(graft).mesh.triangles.len()).sum();
        let scenes: BTreeSet<usize> = grafts.iter().map(|graft| of(graft).document).collect();
        let n_scenes = scenes.iter().map(|row| library.documents[*row].n_bytes()).sum();
        check_room(n_vertices, n_triangles, n_scenes, free())?;
        let (mut mesh, mut bindings) = bearing(&rest)?;
        let mut document = if mesh.triangles.is_empty() { Document::empty() } else { Document::of(&mesh) };
        let (_, mut pieces) = document.pieces()?;
        let mut graftings: Vec<Grafting<'_>> = library.documents.iter().map(Grafting::of).collect();
        for graft in &grafts {
            let kept = of(graft);
            put(&mut mesh, &kept.mesh, graft);
            bindings.extend(kept.mesh.positions.iter().map(|place| graft.binding(*place)));
            let (axes, origin) = (graft.axes(), graft.apply([0.0; 3]));
            let grafting = &mut graftings[kept.document];
            pieces.extend(kept.pieces.iter().map(|piece| grafting.graft(&mut document, piece, axes, origin)));
        }
        let is_used = |row: &usize| grafts.iter().any(|graft| graft.branch == *row);
        let used: Vec<usize> = (0..known.len()).filter(is_used).collect();
        document.credit(&scenes.iter().map(|row| &library.documents[*row]).collect::<Vec<_>>());
        let scales = grafts.iter().map(|graft| graft.scale);
        let is_bare = |(joint, is_tip): &(&Joint, bool)| !is_tip && !joint.groups.is_empty();
        let assembled = Assembled {
            n_branches: known.len(),
            n_used: used.len(),
            n_grafts: grafts.len(),
            scales: [scales.clone().fold(f64::INFINITY, f64::min), scales.fold(0.0, f64::max)],
            n_bare: rest.joints().iter().zip(rest.are_tips()).filter(is_bare).count(),
        };
        Ok(Self {
            rest,
            mesh,
            bindings,
            up: None,
            document,
            pieces,
            is_one: false,
            foot: [0.0; 3],
            unit,
            turn_rad: 0.0,
            assembled: Some(assembled),
            notes: Vec::new(),
        })
    }
}

/// Adds a branch to a plant. What has normals has one a vertex: they are kept where all have them.
fn put(plant: &mut Mesh, branch: &Mesh, graft: &Graft) {
    let first = plant.positions.len() as u32;
    let has_all =
        plant.normals.len() == plant.positions.len() && branch.normals.len() == branch.positions.len();
    if has_all {
        plant.normals.extend(branch.normals.iter().map(|normal| graft.turned(*normal)));
    } else {
        plant.normals.clear();
    }
    plant.positions.extend(branch.positions.iter().map(|place| graft.apply(*place)));
    plant.triangles.extend(branch.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
}
