//! Plants that move, as one file of glTF 2.0 (.glb): what viewers, engines and modellers read.
//!
//! The mesh is there once. What it can do are its morph targets, displacements of all its vertices; every copy is a node
//! of its own that has them by its own weights, frame by frame; from 0 to 1, whatever they are here, for many tools know no
//! others ([`reach`]). Lengths are metres; z, which is up here, is y there.

mod layout;
mod reach;
#[cfg(test)]
mod tests;

use std::io::{self, Write as _};

use crate::atomic::AtomicFile;
use crate::table::TableError;
use layout::Layout;
use reach::Reach;
use serde_json::{Value, json};

/// Readers take such a file into memory whole, and many count its bytes in 31 bits.
const MOST_BYTES: u64 = i32::MAX as u64;
/// Bytes of a vertex's three numbers, of a triangle and of a weight or a time.
const VERTEX: u64 = 12;
const TRIANGLE: u64 = 12;
const NUMBER: u64 = 4;
/// Bytes of words about a copy, at most.
const WORDS: u64 = 512;
/// What wood looks like: linear red, green, blue, and how opaque.
const COLOUR: [f32; 4] = [0.16, 0.1, 0.06, 1.0];
const ROUGHNESS: f32 = 0.9;

/// A mesh at rest, and how it can move; z up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Vertices, metres.
    pub positions: Vec<[f32; 3]>,
    /// Of length 1, one a vertex.
    pub normals: Vec<[f32; 3]>,
    /// Anticlockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Displacements of all vertices.
    pub targets: Vec<Target>,
}

/// A way in which a mesh can move.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// What readers list it as.
    pub name: String,
    /// Displacement of every vertex at weight 1, metres.
    pub moved: Vec<[f32; 3]>,
}

/// A copy of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// Where it stands, metres.
    pub place: [f32; 3],
    /// About the upright, anticlockwise from above, radians.
    pub turn: f32,
    /// So many times as large as the mesh.
    pub scale: f32,
    /// `(n_frames, n_targets)`, any finite ones; the file has them from 0 to 1.
    pub weights: Vec<f32>,
}

/// How much goes into a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Of the mesh.
    pub n_vertices: usize,
    /// Of the mesh.
    pub n_triangles: usize,
    /// Of the mesh.
    pub n_targets: usize,
    /// Copies of the mesh.
    pub n_copies: usize,
    /// Of the animation.
    pub n_frames: u32,
}

/// Why there is no such file.
#[derive(Debug, thiserror::Error)]
pub enum GlbError {
    /// The disk says no.
    #[error(transparent)]
    File(#[from] TableError),
    /// More than readers can hold.
    #[error(
        "a .glb of {} copies in {} frames, with {} vertices and {} ways for each to move, takes {} MB, and its readers \
         hold {} MB at most: fewer copies, frames, modes or nodes are wanted",
        .sizes.n_copies, .sizes.n_frames, .sizes.n_vertices, .sizes.n_targets, .bytes / 1_000_000, MOST_BYTES / 1_000_000
    )]
    TooLarge {
        /// Of what.
        sizes: Sizes,
        /// Of the file.
        bytes: u64,
    },
    /// Numbers that are missing, too many or none.
    #[error("{what} of a .glb has {came} numbers, {wanted} finite ones were wanted")]
    Uneven {
        /// Which part.
        what: String,
        /// There.
        came: usize,
        /// Wanted.
        wanted: usize,
    },
}

impl Sizes {
    /// Bytes of the file, at most; to be asked before anything of that size is made.
    ///
    /// # Errors
    /// [`GlbError::TooLarge`].
    pub fn bytes(&self) -> Result<u64, GlbError> {
        let [vertices, triangles, targets, copies] =
            [self.n_vertices, self.n_triangles, self.n_targets, self.n_copies].map(|n| n as u64);
        let weights = targets.saturating_mul(u64::from(self.n_frames)).saturating_mul(NUMBER);
        let bytes = vertices
            .saturating_mul(VERTEX)
            .saturating_mul(targets.saturating_add(2))
            .saturating_add(triangles.saturating_mul(TRIANGLE))
            .saturating_add(u64::from(self.n_frames) * NUMBER)
            .saturating_add(copies.saturating_mul(weights.saturating_add(WORDS)))
            .saturating_add(targets.saturating_add(8).saturating_mul(WORDS));
        if bytes > MOST_BYTES { Err(GlbError::TooLarge { sizes: *self, bytes }) } else { Ok(bytes) }
    }
}

/// Writes copies of a mesh that move into a file that was begun, and says how many bytes that took.
///
/// # Errors
/// [`GlbError`]; nothing is left behind then.
pub fn write_glb(
    mut file: AtomicFile,
    name: &str,
    fps: f64,
    body: &Body,
    copies: &[Placed],
) -> Result<u64, GlbError> {
    let n_targets = body.targets.len();
    let n_frames = copies.first().map_or(0, |copy| copy.weights.len() / n_targets.max(1));
    let sizes = Sizes {
        n_vertices: body.positions.len(),
        n_triangles: body.triangles.len(),
        n_targets,
        n_copies: copies.len(),
        n_frames: n_frames as u32,
    };
    sizes.bytes()?;
    check(body, copies, n_frames)?;
    // What cannot move has no frames: the standard has no animations of nothing.
    let times: Vec<f32> = (0..n_frames).map(|frame| (frame as f64 / fps) as f32).collect();
    let reach = Reach::new(n_targets, copies);
    let least = reach.least(body);
    let mut layout = Layout::default();
    let mesh = mesh(&mut layout, name, body, &least, &reach);
    let animations: Vec<Value> =
        (n_targets > 0).then(|| animation(&mut layout, &times, copies)).into_iter().collect();
    let nodes: Vec<Value> = (1..).zip(copies).map(|(k, copy)| node(k, copy)).collect();
    let (buffers, views, accessors) = layout.finish();
    let mut root = json!({
        "asset": { "version": "2.0", "generator": concat!("honami ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": [mesh],
        "materials": [{
            "name": "wood",
            "pbrMetallicRoughness": {
                "baseColorFactor": COLOUR, "metallicFactor": 0.0, "roughnessFactor": ROUGHNESS,
            },
        }],
        "buffers": buffers,
        "bufferViews": views,
        "accessors": accessors,
    });
    if !animations.is_empty() {
        root["animations"] = animations.into();
    }
    let n_bytes = root["buffers"][0]["byteLength"].as_u64().unwrap_or_default() as u32;
    let mut words = root.to_string().into_bytes();
    // Chunks begin and end at whole words; JSON is filled up with blanks.
    words.resize(words.len().next_multiple_of(4), b' ');
    let whole = 12 + 8 + words.len() as u32 + 8 + n_bytes;
    let numbers = Numbers { body, least: &least, reach: &reach, times: &times, copies };
    put(&mut file, &words, whole, n_bytes, &numbers)
        .map_err(|source| TableError::File { path: file.path().to_owned(), source })?;
    file.finish()?;
    Ok(u64::from(whole))
}

/// What is not words.
struct Numbers<'a> {
    body: &'a Body,
    /// Vertices where all weights are 0.
    least: &'a [[f32; 3]],
    reach: &'a Reach,
    /// Seconds.
    times: &'a [f32],
    copies: &'a [Placed],
}

/// The header, the words, and all numbers in the order in which [`mesh`] and [`animation`] have laid them out.
fn put(
    file: &mut AtomicFile,
    words: &[u8],
    whole: u32,
    n_bytes: u32,
    numbers: &Numbers<'_>,
) -> io::Result<()> {
    let Numbers { body, least, reach, times, copies } = numbers;
    file.write_all(b"glTF")?;
    for word in [2, whole, words.len() as u32] {
        file.write_all(&word.to_le_bytes())?;
    }
    file.write_all(b"JSON")?;
    file.write_all(words)?;
    file.write_all(&n_bytes.to_le_bytes())?;
    file.write_all(b"BIN\0")?;
    for index in body.triangles.iter().flatten() {
        file.write_all(&index.to_le_bytes())?;
    }
    let ways = (0..).zip(&body.targets);
    let ways = ways.flat_map(|(k, target)| target.moved.iter().map(move |moved| reach.way(k, *moved)));
    for vertex in least.iter().chain(&body.normals).copied().chain(ways) {
        for number in upright(vertex) {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    let n_targets = body.targets.len().max(1);
    let of_frame =
        |frame: &[f32]| (0..).zip(frame).map(|(k, weight)| reach.weight(k, *weight)).collect::<Vec<_>>();
    let weights = copies.iter().flat_map(|copy| copy.weights.chunks(n_targets)).flat_map(of_frame);
    for number in times.iter().copied().chain(weights) {
        file.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}

/// From z up to y up.
fn upright([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x, z, -y]
}

fn mesh(layout: &mut Layout, name: &str, body: &Body, least: &[[f32; 3]], reach: &Reach) -> Value {
    let indices = layout.indices(body.triangles.len());
    let position = layout.vertices(least.iter().copied());
    let normal = layout.vertices(body.normals.iter().copied());
    let target = |(k, target): (usize, &Target)| {
        let ways = target.moved.iter().map(|moved| reach.way(k, *moved));
        json!({ "POSITION": layout.vertices(ways) })
    };
    let targets: Vec<Value> = body.targets.iter().enumerate().map(target).collect();
    let names: Vec<&str> = body.targets.iter().map(|target| target.name.as_str()).collect();
    let mut mesh = json!({
        "name": name,
        "primitives": [{
            "attributes": { "POSITION": position, "NORMAL": normal },
            "indices": indices,
            "material": 0,
        }],
    });
    if !targets.is_empty() {
        mesh["weights"] = reach.rest().into();
        mesh["primitives"][0]["targets"] = targets.into();
        // Not of the standard, but where most readers look for names.
        mesh["extras"] = json!({ "targetNames": names });
    }
    mesh
}

fn animation(layout: &mut Layout, times: &[f32], copies: &[Placed]) -> Value {
    let input = layout.times(times);
    let samplers: Vec<Value> = copies
        .iter()
        .map(|copy| {
            json!({ "input": input, "output": layout.weights(copy.weights.len()), "interpolation": "LINEAR" })
        })
        .collect();
    let channels: Vec<Value> = (0..copies.len())
        .map(|k| json!({ "sampler": k, "target": { "node": k, "path": "weights" } }))
        .collect();
    json!({ "name": "sway", "samplers": samplers, "channels": channels })
}

fn node(k: usize, copy: &Placed) -> Value {
    let (sin, cos) = (f64::from(copy.turn) / 2.0).sin_cos();
    json!({
        "name": format!("copy {k}"),
        "mesh": 0,
        "translation": upright(copy.place),
        "rotation": [0.0, sin, 0.0, cos],
        "scale": vec![copy.scale; 3],
    })
}

fn check(body: &Body, copies: &[Placed], n_frames: usize) -> Result<(), GlbError> {
    let n_vertices = body.positions.len();
    let uneven =
        |what: &str, came: usize, wanted: usize| GlbError::Uneven { what: what.to_owned(), came, wanted };
    let is_whole = |vertices: &[[f32; 3]]| {
        vertices.len() == n_vertices && vertices.iter().flatten().all(|v| v.is_finite())
    };
    let rows = [("position", &body.positions), ("normal", &body.normals)];
    let targets = body.targets.iter().map(|target| (target.name.as_str(), &target.moved));
    for (what, vertices) in rows.into_iter().chain(targets) {
        if n_vertices == 0 || !is_whole(vertices) {
            return Err(uneven(what, 3 * vertices.len(), 3 * n_vertices.max(1)));
        }
    }
    let n_indices = body.triangles.iter().flatten().filter(|index| (**index as usize) < n_vertices).count();
    if n_indices == 0 || n_indices != 3 * body.triangles.len() {
        return Err(uneven("a triangle", n_indices, 3 * body.triangles.len().max(1)));
    }
    let wanted = n_frames * body.targets.len();
    for copy in copies {
        let is_empty = wanted == 0 && !body.targets.is_empty();
        if is_empty || copy.weights.len() != wanted || !copy.weights.iter().all(|v| v.is_finite()) {
            return Err(uneven("a copy", copy.weights.len(), wanted.max(1)));
        }
    }
    if copies.is_empty() { Err(uneven("the scene", 0, 1)) } else { Ok(()) }
}
