//! Rigs: a mesh, bones that carry it, and how these turn, as glTF has them (skins and animations).

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use honami_model::mesh::Binding;
use honami_model::skeleton::Skeleton;
use serde_json::{Value, json};

use super::joints::{Joints, MOST_JOINTS, rotations};
use crate::glb::{ARRAY, Document, F32, KEPT, Matrix, OTHER, Piece, TRIANGLES, U8, U16, product};

/// Why there is no rig.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// More joints than glTF counts.
    #[error(
        "a rig has {MOST_JOINTS} joints at most, with the ends of tips, not {0}: fewer groups or copies are wanted"
    )]
    TooMany(usize),
    /// Frames that floats of 32 bits cannot tell apart.
    #[error("frames {0} and {next} are less apart in time than a .glb can say", next = .0 + 1)]
    Times(usize),
    /// Not one binding a vertex, to bones that there are.
    #[error("{came} of {wanted} vertices are bound to bones that there are")]
    Bindings {
        /// Vertices that are.
        came: usize,
        /// Vertices.
        wanted: usize,
    },
}

/// The pieces of a scene, bound to the bones of `rest`, where these are at rest, which turn as those of `motion` do; both are
/// of the same bones. Bindings, and colours if there are any, are vertex by vertex, piece after piece. Lengths are those of
/// the scene. What the scene's own animations were is left out. `kept` are the rows of the bones that become joints, the root
/// and what bears them among them, or `None` for all.
///
/// # Errors
/// [`RigError`].
pub fn rigged(
    mut document: Document,
    pieces: &[Piece],
    bindings: &[Binding],
    colours: &[[u8; 3]],
    rest: &Skeleton,
    motion: &Skeleton,
    kept: Option<&[usize]>,
) -> Result<Document, RigError> {
    let joints = Joints::of(rest, kept)?;
    check(bindings, colours, &joints, pieces.iter().flat_map(|piece| &piece.counts).sum())?;
    let joints = Nodes::add(&mut document, joints);
    joints.turn(&mut document, rest, motion)?;
    if !colours.is_empty() {
        look_at_weights(&mut document);
    }
    let named = named(pieces, bindings, &joints.joints);
    let (mut used, mut skins, mut first) = (BTreeSet::new(), BTreeMap::new(), 0);
    let meshes = document.words["meshes"].clone();
    for piece in pieces {
        let mut mesh = meshes[piece.mesh].clone();
        let (place, named) = (place(piece), named.get(&place(piece)).map_or(&[][..], Vec::as_slice));
        for (k, &n) in piece.counts.iter().enumerate() {
            let (primitive, own) = (&mut mesh["primitives"][k], first..first + n);
            let attributes = &mut primitive["attributes"];
            bind(&mut document, attributes, &bindings[own.clone()], &joints.joints, named);
            if !colours.is_empty() {
                colour(&mut document, attributes, &colours[own]);
            }
            // The node was the mirror, and bones carry what they carry whichever node it is of.
            if let Some(triangles) = piece.turned.get(k).filter(|triangles| !triangles.is_empty()) {
                primitive["mode"] = TRIANGLES.into();
                primitive["indices"] = document.triangles(triangles).into();
            }
            first += n;
        }
        // A mesh that stands in several places is bound differently in each.
        let mesh = if used.insert(piece.mesh) {
            document.words["meshes"][piece.mesh] = mesh;
            piece.mesh
        } else {
            document.put("meshes", mesh)
        };
        let skin = *skins.entry(place).or_insert_with(|| joints.skin(&mut document, &piece.matrix, named));
        stand(&mut document, piece.node, mesh, skin);
    }
    list(document.scene()).push(joints.nodes[0].into());
    Ok(document)
}

/// Where a piece stands: what stands in one place has one skin.
fn place(piece: &Piece) -> [u64; 16] {
    piece.matrix.map(f64::to_bits)
}

/// The joints that the skin of each place names, upwards. The first has all, so that whoever reads the file knows all of them
/// as bones, the ends of tips, too; others have those alone that carry what stands there: all of all would grow with the
/// square of branches.
fn named(pieces: &[Piece], bindings: &[Binding], joints: &Joints) -> BTreeMap<[u64; 16], Vec<usize>> {
    let whole = pieces.first().map(place);
    let (mut named, mut first): (BTreeMap<_, BTreeSet<usize>>, usize) = (BTreeMap::new(), 0);
    for piece in pieces {
        let own = first..first + piece.n_vertices();
        first = own.end;
        let there = named.entry(place(piece)).or_default();
        if Some(place(piece)) == whole {
            there.extend(0..joints.names.len());
            continue;
        }
        let bones = bindings[own].iter().flat_map(Binding::shares);
        there.extend(bones.filter_map(|(bone, _)| joints.joint(bone)));
    }
    // Nothing is carried by the root, and a skin has a joint.
    let least = |there: BTreeSet<usize>| if there.is_empty() { vec![0] } else { there.into_iter().collect() };
    named.into_iter().map(|(place, there)| (place, least(there))).collect()
}

/// One look for all meshes, on which the colours of vertices are seen, in place of their own and what only these needed.
fn look_at_weights(document: &mut Document) {
    let look = json!({ "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    let words = &mut document.words;
    for name in ["textures", "images", "samplers"] {
        words.as_object_mut().into_iter().for_each(|words| drop(words.remove(name)));
    }
    words["materials"] = json!([{ "name": "weights", "pbrMetallicRoughness": look, "doubleSided": true }]);
    let meshes = words["meshes"].as_array_mut().into_iter().flatten();
    for primitive in meshes.filter_map(|mesh| mesh["primitives"].as_array_mut()).flatten() {
        primitive["material"] = 0.into();
        // Other looks to choose from are by rows that there are no more.
        primitive.as_object_mut().into_iter().for_each(|words| drop(words.remove("extensions")));
    }
}

/// Whether so many vertices are bound to bones that there are.
pub(super) fn check(
    bindings: &[Binding],
    colours: &[[u8; 3]],
    joints: &Joints,
    wanted: usize,
) -> Result<(), RigError> {
    let is_bound = |binding: &&Binding| binding.shares().all(|(bone, _)| joints.joint(bone).is_some());
    let came = bindings.iter().filter(is_bound).count();
    if came != wanted || bindings.len() != wanted || !(colours.is_empty() || colours.len() == wanted) {
        return Err(RigError::Bindings { came: came.min(wanted), wanted });
    }
    Ok(())
}

/// Puts a mesh that bones carry into the scene, in place of the node that bore it: where that lies is in the skin.
fn stand(document: &mut Document, node: usize, mesh: usize, skin: usize) {
    let old = &mut document.words["nodes"][node];
    let mut made = json!({ "mesh": mesh, "skin": skin });
    for name in KEPT {
        if !old[name].is_null() {
            made[name] = old[name].take();
        }
    }
    old.as_object_mut()
        .into_iter()
        .for_each(|old| old.retain(|name, value| name != "mesh" && !value.is_null()));
    // Where there is more than its place to it, a camera or what others hung there, it stays for that.
    let is_place = |(name, _): (&String, &Value)| {
        ["matrix", "translation", "rotation", "scale"].contains(&name.as_str())
    };
    let is_alone = old.as_object().is_some_and(|old| old.iter().all(is_place));
    let is_alone = is_alone && list(document.scene()).contains(&node.into());
    if is_alone {
        document.words["nodes"][node] = made;
    } else {
        let node = document.put("nodes", made);
        list(document.scene()).push(node.into());
    }
}

/// A list of words; made where there is none.
fn list(words: &mut Value) -> &mut Vec<Value> {
    if !words.is_array() {
        *words = json!([]);
    }
    match words {
        Value::Array(list) => list,
        _ => unreachable!("it was made one"),
    }
}

/// Joints as nodes of a document, in their order.
struct Nodes {
    nodes: Vec<usize>,
    joints: Joints,
}

impl Nodes {
    fn add(document: &mut Document, joints: Joints) -> Self {
        let n = joints.names.len();
        let first = document.words["nodes"].as_array().map_or(0, Vec::len);
        let mut children = vec![Vec::new(); n];
        for (joint, parent) in joints.parents.iter().enumerate() {
            parent.iter().for_each(|&parent| children[parent].push(first + joint));
        }
        for (joint, children) in children.into_iter().enumerate() {
            let by = joints.offset(joint).map(|v| v as f32);
            let mut node = json!({ "name": joints.names[joint], "translation": by });
            if !children.is_empty() {
                node["children"] = children.into();
            }
            document.put("nodes", node);
        }
        Self { nodes: (first..first + n).collect(), joints }
    }

    /// Lets them turn as bones do: every joint off the one before, by a quaternion a frame.
    fn turn(&self, document: &mut Document, rest: &Skeleton, motion: &Skeleton) -> Result<(), RigError> {
        let input = times(document, motion)?;
        let (rows, n_frames) = (&self.joints.rows, motion.times().len());
        let mut tracks: Vec<Vec<u8>> = vec![Vec::with_capacity(16 * n_frames as usize); rows.len()];
        for turns in rotations(rest, motion) {
            for (track, row) in tracks.iter_mut().zip(rows) {
                track.extend(turns[*row].iter().flat_map(|v| (*v as f32).to_le_bytes()));
            }
        }
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for (joint, bytes) in tracks.iter().enumerate().skip(1) {
            let what = json!({ "componentType": F32, "type": "VEC4", "count": n_frames });
            let output = document.add(OTHER, bytes, what);
            let target = json!({ "node": self.nodes[joint], "path": "rotation" });
            channels.push(json!({ "sampler": samplers.len(), "target": target }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
        document.words["animations"] =
            json!([{ "name": "filmed", "samplers": samplers, "channels": channels }]);
        Ok(())
    }

    /// The skin of a mesh that lies so in the scene, of those joints that are named.
    fn skin(&self, document: &mut Document, matrix: &Matrix, named: &[usize]) -> usize {
        let mut bytes = Vec::with_capacity(64 * named.len());
        for [x, y, z] in named.iter().map(|joint| self.joints.places[*joint]) {
            let back = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -x, -y, -z, 1.0];
            bytes.extend(product(&back, matrix).iter().flat_map(|v| (*v as f32).to_le_bytes()));
        }
        let what = json!({ "componentType": F32, "type": "MAT4", "count": named.len() });
        let matrices = document.add(OTHER, &bytes, what);
        let joints: Vec<usize> = named.iter().map(|joint| self.nodes[*joint]).collect();
        document.put(
            "skins",
            json!({ "joints": joints, "skeleton": self.nodes[0], "inverseBindMatrices": matrices }),
        )
    }
}

/// Times of frames, from the first on; the number of the accessor.
fn times(document: &mut Document, motion: &Skeleton) -> Result<usize, RigError> {
    let times = motion.times().as_slice();
    let times: Vec<f32> = times.iter().map(|time| (time - times[0]) as f32).collect();
    if let Some(frame) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(RigError::Times(frame));
    }
    let bytes: Vec<u8> = times.iter().flat_map(|time| time.to_le_bytes()).collect();
    let what = json!({
        "componentType": F32, "type": "SCALAR", "count": times.len(),
        "min": times.first().as_slice(), "max": times.last().as_slice(),
    });
    Ok(document.add(OTHER, &bytes, what))
}

/// Says of every vertex which joints carry it, counted in those that its skin names; what carries nothing of it is the first.
fn bind(
    document: &mut Document,
    attributes: &mut Value,
    bindings: &[Binding],
    joints: &Joints,
    named: &[usize],
) {
    let count = bindings.len();
    let row = |bone: u16| {
        let joint = joints.joint(bone.into());
        joint.and_then(|joint| named.binary_search(&joint).ok()).unwrap_or(0) as u16
    };
    let bones = bindings.iter().flat_map(|binding| binding.bones().map(row));
    let bones: Vec<u8> = bones.flat_map(u16::to_le_bytes).collect();
    let what = json!({ "componentType": U16, "type": "VEC4", "count": count });
    attributes["JOINTS_0"] = document.add(ARRAY, &bones, what).into();
    let weights: Vec<u8> = bindings.iter().flat_map(Binding::weights).flat_map(f32::to_le_bytes).collect();
    let what = json!({ "componentType": F32, "type": "VEC4", "count": count });
    attributes["WEIGHTS_0"] = document.add(ARRAY, &weights, what).into();
}

/// Says of every vertex what it looks like.
fn colour(document: &mut Document, attributes: &mut Value, colours: &[[u8; 3]]) {
    let bytes: Vec<u8> =
        colours.iter().flat_map(|[red, green, blue]| [*red, *green, *blue, u8::MAX]).collect();
    let what = json!({ "componentType": U8, "type": "VEC4", "normalized": true, "count": colours.len() });
    attributes["COLOR_0"] = document.add(ARRAY, &bytes, what).into();
}
