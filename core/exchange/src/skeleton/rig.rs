//! Rigs: a mesh, bones that carry it, and how these turn, as glTF has them (skins and animations).
//!
//! As in BVH every bone has a joint of its own at its base, those of one fork in one place; the ends of tips are joints
//! that carry nothing, so that programs know how long the last bones are. At rest no joint is turned.

#[cfg(test)]
mod tests;

use honami_model::mesh::{Binding, Mesh};
use honami_model::skeleton::{Skeleton, turns};
use serde_json::{Value, json};

use crate::glb::{ARRAY, Document, F32, OTHER, U16, upright};

/// Numbers of joints have 16 bits.
const MOST_JOINTS: usize = u16::MAX as usize;

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

/// A mesh bound to the bones of `rest`, where these are at rest, which turn as those of `motion` do; both are of the same
/// bones. Lengths are metres.
///
/// # Errors
/// [`RigError`].
pub fn rigged(
    mesh: &Mesh,
    bindings: &[Binding],
    rest: &Skeleton,
    motion: &Skeleton,
) -> Result<Document, RigError> {
    let is_bound = |binding: &&Binding| binding.shares().all(|(bone, _)| bone < rest.joints().len());
    let (came, wanted) = (bindings.iter().filter(is_bound).count(), mesh.positions.len());
    if came != wanted || bindings.len() != wanted {
        return Err(RigError::Bindings { came: came.min(wanted), wanted });
    }
    let mut document = Document::of(mesh);
    let joints = Joints::add(&mut document, rest)?;
    joints.turn(&mut document, rest, motion)?;
    let mut attributes = document.words["meshes"][0]["primitives"][0]["attributes"].take();
    bind(&mut document, &mut attributes, bindings);
    document.words["meshes"][0]["primitives"][0]["attributes"] = attributes;
    let skin = joints.skin(&mut document);
    let node = document.put("nodes", json!({ "name": "plant", "mesh": 0, "skin": skin }));
    document.words["scenes"][0]["nodes"] = json!([node, joints.nodes[0]]);
    Ok(document)
}

/// Joints of a skeleton as nodes of a document: the root, bones in the order of their rows, ends of tips.
struct Joints {
    nodes: Vec<usize>,
    /// Where each is at rest, y up.
    places: Vec<[f64; 3]>,
}

impl Joints {
    fn add(document: &mut Document, rest: &Skeleton) -> Result<Self, RigError> {
        let n = rest.joints().len();
        let are_tips = rest.are_tips();
        let tips: Vec<usize> = (1..n).filter(|row| are_tips[*row]).collect();
        if n + tips.len() > MOST_JOINTS {
            return Err(RigError::TooMany(n + tips.len()));
        }
        let first = document.words["nodes"].as_array().map_or(0, Vec::len);
        let ends: Vec<[f64; 3]> = rest.places(rest.rest()).into_iter().map(upright).collect();
        let base = |row: usize| rest.joints()[row].parent.map_or(0, |parent| parent as usize);
        let bases = (0..n).map(|row| ends[base(row)]);
        let places: Vec<[f64; 3]> = bases.chain(tips.iter().map(|tip| ends[*tip])).collect();
        // What a bone hangs on is the bone that it begins at, and the root where it begins there.
        let borne_by = |k: usize| if k < n { base(k) } else { tips[k - n] };
        let mut children = vec![Vec::new(); places.len()];
        (1..places.len()).for_each(|k| children[borne_by(k)].push(first + k));
        for (k, place) in places.iter().enumerate() {
            let from = if k == 0 { [0.0; 3] } else { places[borne_by(k)] };
            let by: [f64; 3] = std::array::from_fn(|axis| place[axis] - from[axis]);
            let name = match k {
                0 => "root".to_owned(),
                _ if k < n => format!("bone_{k}"),
                _ => format!("tip_{}", tips[k - n]),
            };
            let mut node = json!({ "name": name, "translation": by.map(|v| v as f32) });
            if !children[k].is_empty() {
                node["children"] = children[k].clone().into();
            }
            document.put("nodes", node);
        }
        Ok(Self { nodes: (first..first + places.len()).collect(), places })
    }

    /// Lets them turn as bones do: every joint off the one before, by a quaternion a frame.
    fn turn(&self, document: &mut Document, rest: &Skeleton, motion: &Skeleton) -> Result<(), RigError> {
        let input = times(document, motion)?;
        let (n, n_frames) = (rest.joints().len(), motion.times().len());
        let mut tracks: Vec<Vec<u8>> = vec![Vec::with_capacity(16 * n_frames as usize); n];
        let mut before = vec![[0.0; 4]; n];
        for frame in 0..n_frames {
            let turns = turns(rest.rest(), motion.directions(frame));
            for row in 1..n {
                let own = rest.joints()[row].parent.filter(|parent| *parent > 0);
                let off = own.map_or(turns[row], |parent| turns[parent as usize].back().after(&turns[row]));
                let ([x, y, z, w], last) = (off.quaternion(), &mut before[row]);
                let [x, y, z] = upright([x, y, z]);
                let now = [x, y, z, w];
                // A turn is two quaternions: that which is nearer to the frame before does not go the long way round.
                let along: f64 = now.iter().zip(*last).map(|(now, last)| now * last).sum();
                *last = if along < 0.0 { now.map(|v| -v) } else { now };
                tracks[row].extend(last.iter().flat_map(|v| (*v as f32).to_le_bytes()));
            }
        }
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for (row, bytes) in tracks.iter().enumerate().skip(1) {
            let what = json!({ "componentType": F32, "type": "VEC4", "count": n_frames });
            let output = document.add(OTHER, bytes, what);
            let target = json!({ "node": self.nodes[row], "path": "rotation" });
            channels.push(json!({ "sampler": samplers.len(), "target": target }));
            samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
        }
        document.words["animations"] =
            json!([{ "name": "filmed", "samplers": samplers, "channels": channels }]);
        Ok(())
    }

    /// The skin of a mesh that lies where these joints are.
    fn skin(&self, document: &mut Document) -> usize {
        let mut bytes = Vec::with_capacity(64 * self.places.len());
        for [x, y, z] in &self.places {
            let back = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -x, -y, -z, 1.0];
            bytes.extend(back.iter().flat_map(|v| (*v as f32).to_le_bytes()));
        }
        let what = json!({ "componentType": F32, "type": "MAT4", "count": self.places.len() });
        let matrices = document.add(OTHER, &bytes, what);
        document.put(
            "skins",
            json!({ "joints": self.nodes, "skeleton": self.nodes[0], "inverseBindMatrices": matrices }),
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

/// Says of every vertex which joints carry it.
fn bind(document: &mut Document, attributes: &mut Value, bindings: &[Binding]) {
    let count = bindings.len();
    let bones: Vec<u8> = bindings.iter().flat_map(Binding::bones).flat_map(u16::to_le_bytes).collect();
    let what = json!({ "componentType": U16, "type": "VEC4", "count": count });
    attributes["JOINTS_0"] = document.add(ARRAY, &bones, what).into();
    let weights: Vec<u8> = bindings.iter().flat_map(Binding::weights).flat_map(f32::to_le_bytes).collect();
    let what = json!({ "componentType": F32, "type": "VEC4", "count": count });
    attributes["WEIGHTS_0"] = document.add(ARRAY, &weights, what).into();
}
