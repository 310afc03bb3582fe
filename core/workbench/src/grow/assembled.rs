//! Plants put together: branches of a library on the bones of a skeleton that bear no others, tubes along those that do.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use honami_exchange::glb::{Document, Grafting, Piece};
use honami_exchange::mesh::{MeshFormat, Up};
use honami_mechanics::{Beams, Options};
use honami_model::mesh::Mesh;
use honami_model::skeleton::{Joint, Skeleton};
use honami_structure::assemble::{Branch, Graft, assemble, branches};

use super::body::{bearing, tubes};
use super::bound::{Bound, Read, in_origin, nodes, read, refused};
use crate::error::WorkbenchError;

/// Vertices of all branches on a plant: gigabytes of memory.
const MOST_VERTICES: usize = 1 << 26;

/// Branches to put plants together of.
#[derive(Clone, Debug)]
pub struct Library {
    documents: Vec<Document>,
    branches: Vec<Kept>,
    /// What was left out or guessed of each file, a sentence each.
    pub notes: Vec<(PathBuf, String)>,
}

#[derive(Clone, Debug)]
struct Kept {
    branch: Branch,
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
    /// which each branch at a fork that is not small becomes tubes. `up` is that of `.obj` and `.ply`.
    ///
    /// # Errors
    /// What is wrong with a file, [`WorkbenchError::Onto`] with what is no branch, [`WorkbenchError::NoFork`], and
    /// [`WorkbenchError::NoMeaning`] for `up` of a library of other files.
    pub fn read(paths: &[PathBuf], up: Option<Up>) -> Result<Self, WorkbenchError> {
        let mut library = Self { documents: Vec::new(), branches: Vec::new(), notes: Vec::new() };
        let is_typed = paths.iter().any(|path| MeshFormat::of(path).is_some());
        for path in paths {
            let up = up.filter(|_| MeshFormat::of(path).is_some() || !is_typed);
            match read(path, up)? {
                Some(read) => library.add_mesh(path, read)?,
                None => library.add_nodes(path)?,
            }
        }
        Ok(library)
    }

    fn add_mesh(&mut self, path: &Path, read: Read) -> Result<(), WorkbenchError> {
        let Read { mesh, up, document, pieces, notes, .. } = read;
        self.notes.extend(notes.into_iter().map(|note| (path.to_owned(), note)));
        let parts = parts(&mesh, pieces);
        // A scene without a mesh is no branch either, which the first look at it says.
        let parts = if parts.is_empty() { vec![(Mesh::default(), Vec::new())] } else { parts };
        for (mesh, pieces) in parts {
            let branch = Branch::of(&mesh, None).map_err(|error| refused(error, path, up))?;
            self.keep(branch, mesh, pieces);
        }
        self.documents.push(document);
        Ok(())
    }

    fn add_nodes(&mut self, path: &Path) -> Result<(), WorkbenchError> {
        let measured = nodes(path)?;
        self.notes.extend(measured.notes.into_iter().map(|note| (path.to_owned(), note)));
        let plants = branches(&measured.plant)?;
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
            self.keep(branch, mesh, pieces);
            self.documents.push(document);
        }
        Ok(())
    }

    /// Of the document that comes next.
    fn keep(&mut self, branch: Branch, mesh: Mesh, pieces: Vec<Piece>) {
        self.branches.push(Kept { branch, mesh, document: self.documents.len(), pieces });
    }

    /// How many branches it has.
    #[must_use]
    pub fn n_branches(&self) -> usize {
        self.branches.len()
    }
}

/// Parts of a mesh by the trees of nodes that its pieces are of.
fn parts(mesh: &Mesh, pieces: Vec<Piece>) -> Vec<(Mesh, Vec<Piece>)> {
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
    parts.into_values().collect()
}

impl Bound {
    /// A plant put together of a library, its root in the origin, a pixel so many metres; the `number`-th sibling of a seed
    /// has other branches.
    ///
    /// # Errors
    /// [`WorkbenchError::Unit`], [`WorkbenchError::Structure`], [`WorkbenchError::Beams`], [`WorkbenchError::TooManyVertices`].
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
        if n_vertices > MOST_VERTICES {
            return Err(WorkbenchError::TooManyVertices { n_vertices, most: MOST_VERTICES });
        }
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
        let mut others: Vec<usize> = used.iter().map(|row| library.branches[*row].document).collect();
        others.dedup();
        document.credit(&others.iter().map(|row| &library.documents[*row]).collect::<Vec<_>>());
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
