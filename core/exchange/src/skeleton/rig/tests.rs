//! Rigs, read back by another's reader and posed by arithmetic of their own, are the skeleton.

use gltf::animation::util::ReadOutputs;
use honami_model::clip::FrameTimes;
use honami_model::mesh::Mesh;
use honami_model::skeleton::{Joint, turns};
use proptest::prelude::*;

use super::super::tests::skeleton;
use super::super::usda;
use super::*;
use crate::glb::tests::scene;
use crate::glb::upright;

type Matrix = [[f64; 4]; 4];

/// `a` after `b`; columns, as glTF has them.
fn after(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}

fn moved(m: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|row| m[0][row] * x + m[1][row] * y + m[2][row] * z + m[3][row])
}

fn matrix([x, y, z, w]: [f64; 4], [a, b, c]: [f64; 3]) -> Matrix {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0],
        [a, b, c, 1.0],
    ]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A rig as another reader finds it.
struct Rig {
    names: Vec<String>,
    /// Of every joint, frame after frame.
    turns: Vec<Vec<[f64; 4]>>,
    /// Of every joint in every frame, to the scene.
    poses: Vec<Vec<Matrix>>,
    /// From the mesh to each joint.
    inverse: Vec<Matrix>,
    times: Vec<f32>,
    vertices: Vec<[f64; 3]>,
    bindings: Vec<([u16; 4], [f32; 4])>,
    colours: Vec<[u8; 4]>,
    corners: Vec<u32>,
}

const UNMOVED: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

impl Rig {
    fn read(document: Document) -> Self {
        let mut rigs = Self::all(document);
        assert_eq!(rigs.len(), 1);
        rigs.remove(0)
    }

    /// One a mesh that stands in the scene.
    fn all(document: Document) -> Vec<Self> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rig.glb");
        let n_bytes = document.write(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes.len() as u64, n_bytes);
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = blob.unwrap();
        let data = |_: gltf::Buffer<'_>| Some(blob.as_slice());
        let animation = document.animations().next().unwrap();
        let (mut times, mut turns) = (Vec::new(), vec![None; document.nodes().len()]);
        for channel in animation.channels() {
            let reader = channel.reader(data);
            times = reader.read_inputs().unwrap().collect();
            let Some(ReadOutputs::Rotations(found)) = reader.read_outputs() else { unreachable!() };
            let found: Vec<[f64; 4]> = found.into_f32().map(|q| q.map(f64::from)).collect();
            turns[channel.target().node().index()] = Some(found);
        }
        let mut parents = vec![None; document.nodes().len()];
        for node in document.nodes() {
            node.children().for_each(|child| parents[child.index()] = Some(node.index()));
        }
        let n_frames = times.len();
        let still = vec![[0.0, 0.0, 0.0, 1.0]; n_frames];
        let turns: Vec<Vec<[f64; 4]>> =
            turns.into_iter().map(|found| found.unwrap_or_else(|| still.clone())).collect();
        let by: Vec<[f64; 3]> =
            document.nodes().map(|node| node.transform().decomposed().0.map(f64::from)).collect();
        let pose = |joints: &[gltf::Node<'_>], frame: usize| {
            let chain = |joint: &gltf::Node<'_>| {
                let mut pose = matrix(turns[joint.index()][frame], by[joint.index()]);
                let mut at = parents[joint.index()];
                while let Some(node) = at {
                    pose = after(&matrix(turns[node][frame], by[node]), &pose);
                    at = parents[node];
                }
                pose
            };
            joints.iter().map(chain).collect()
        };
        let rig = |node: gltf::Node<'_>| {
            let skin = node.skin()?;
            let joints: Vec<gltf::Node<'_>> = skin.joints().collect();
            assert!(parents[node.index()].is_none() && node.transform().matrix() == UNMOVED);
            let primitive = node.mesh().unwrap().primitives().next().unwrap();
            let reader = primitive.reader(data);
            let inverse = skin.reader(data).read_inverse_bind_matrices().unwrap();
            let bones = reader.read_joints(0).unwrap().into_u16();
            let colours = reader.read_colors(0).into_iter().flat_map(|colours| colours.into_rgba_u8());
            Some(Self {
                names: joints.iter().map(|joint| joint.name().unwrap().to_owned()).collect(),
                turns: joints.iter().map(|joint| turns[joint.index()].clone()).collect(),
                poses: (0..n_frames).map(|frame| pose(&joints, frame)).collect(),
                inverse: inverse.map(|m| m.map(|column| column.map(f64::from))).collect(),
                times: times.clone(),
                vertices: reader.read_positions().unwrap().map(|v| v.map(f64::from)).collect(),
                bindings: bones.zip(reader.read_weights(0).unwrap().into_f32()).collect(),
                colours: colours.collect(),
                corners: reader
                    .read_indices()
                    .map_or((0..3).collect(), |corners| corners.into_u32().collect()),
            })
        };
        document.scenes().next().unwrap().nodes().filter_map(rig).collect()
    }

    /// Where a vertex is in a frame, blended linearly, as every program that reads the file does.
    fn vertex(&self, vertex: usize, frame: usize) -> [f64; 3] {
        let (bones, weights) = self.bindings[vertex];
        let mut sum = [0.0; 3];
        for (bone, weight) in bones.into_iter().map(usize::from).zip(weights) {
            let carried = after(&self.poses[frame][bone], &self.inverse[bone]);
            let place = moved(&carried, self.vertices[vertex]);
            (0..3).for_each(|axis| sum[axis] += f64::from(weight) * place[axis]);
        }
        sum
    }
}

/// A mesh as a rig of its own.
fn own(mesh: &Mesh, bindings: &[Binding], rest: &Skeleton, motion: &Skeleton) -> Result<Document, RigError> {
    let document = Document::of(mesh);
    let (_, pieces) = document.pieces().unwrap();
    rigged(document, &pieces, bindings, &[], rest, motion, None)
}

/// A mesh with a vertex in the end of every bone, bound to it, and one half-way along, bound half to the bone before.
fn marks(skeleton: &Skeleton) -> (Mesh, Vec<Binding>) {
    let ends = skeleton.places(skeleton.rest());
    let (mut mesh, mut bindings) = (Mesh::default(), Vec::new());
    for (row, joint) in skeleton.joints().iter().enumerate() {
        let parent = joint.parent.unwrap_or(0);
        let middle = std::array::from_fn(|axis| f64::midpoint(ends[row][axis], ends[parent as usize][axis]));
        mesh.positions.extend([ends[row], middle]);
        bindings.push(Binding::new([(row as u16, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]));
        bindings.push(Binding::new([(row as u16, 0.5), (parent as u16, 0.5), (0, 0.0), (0, 0.0)]));
    }
    mesh.triangles = (2..mesh.positions.len() as u32).map(|k| [0, k - 1, k]).collect();
    (mesh, bindings)
}

#[track_caller]
fn assert_is_it(skeleton: &Skeleton) {
    let (mesh, bindings) = marks(skeleton);
    let rig = Rig::read(own(&mesh, &bindings, skeleton, skeleton).unwrap());
    let n = skeleton.joints().len();
    let rest = skeleton.places(skeleton.rest());
    let size = rest.iter().map(|place| apart(*place, rest[0])).fold(1.0, f64::max) + apart(rest[0], [0.0; 3]);
    let tips: Vec<usize> = (1..n).filter(|row| skeleton.are_tips()[*row]).collect();
    assert_eq!(rig.names.len(), n + tips.len());
    assert_eq!(rig.poses.len(), skeleton.times().len() as usize);
    for (frame, poses) in rig.poses.iter().enumerate() {
        let places = skeleton.places(skeleton.directions(frame as u32));
        let near = |found: [f64; 3], wanted: [f64; 3], what: &str| {
            let off = apart(found, upright(wanted)) / size;
            assert!(off < 1e-5, "frame {frame}, {what}: {off} of the size off");
        };
        for (row, (name, pose)) in rig.names.iter().zip(poses).enumerate() {
            let place = match name.split_once('_') {
                None => 0,
                Some(("bone", row)) => {
                    skeleton.joints()[row.parse::<usize>().unwrap()].parent.unwrap() as usize
                }
                Some((_, tip)) => tip.parse().unwrap(),
            };
            near([pose[3][0], pose[3][1], pose[3][2]], places[place], name);
            assert!(row < n || name == &format!("tip_{}", tips[row - n]));
        }
        for (row, place) in places.iter().enumerate() {
            near(rig.vertex(2 * row, frame), *place, "the end of a bone");
        }
    }
    for turns in &rig.turns {
        for turn in turns {
            assert!((turn.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-6, "{turn:?}");
        }
        for pair in turns.windows(2) {
            let along: f64 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
            assert!(along >= 0.0, "not the long way round: {pair:?}");
        }
    }
}

#[test]
fn joints_and_what_they_carry_are_where_the_skeleton_has_them() {
    let round: Vec<(f64, f64)> = (0..26).map(|k| (f64::from(k) * 0.5, 0.0)).collect();
    assert_is_it(&skeleton(&[(0, 10.0)], &round, 13));
    let opposite = [(0.0, 0.0), (0.4, 0.0), (0.0, 0.0), (0.4 + std::f64::consts::PI, 0.0)];
    assert_is_it(&skeleton(&[(0, 10.0)], &opposite, 2));
    let deep = [(0.0, 0.0), (0.0, 1.5), (0.0, -1.5), (1.0, std::f64::consts::FRAC_PI_2), (0.0, 0.2)];
    assert_is_it(&skeleton(&[(0, 10.0), (1, 20.0), (2, 5.0)], &deep, 5));
    assert_is_it(&skeleton(&[(0, 10.0)], &[(0.2, 0.1)], 1));
}

fn bits<const N: usize>(of: &[f64; N]) -> [u64; N] {
    of.map(f64::to_bits)
}

/// Bones 1 and 3 of six, and what bears them: their joints are to the last bit where they were, by the names that they had.
#[test]
fn fewer_joints_stay_where_they_were() {
    let angles = [(0.0, 0.0), (0.3, 0.0), (-0.4, 0.2), (0.1, 0.1), (0.5, -0.7)];
    let whole = skeleton(&[(0, 10.0), (1, 8.0), (1, 6.0), (3, 5.0), (3, 4.0), (2, 3.0)], &angles, 6);
    let (mesh, bindings) = marks(&whole);
    let all = Rig::read(own(&mesh, &bindings, &whole, &whole).unwrap());
    // Of every bone, which carries its vertices now.
    let bearers = [0, 1, 1, 3, 3, 3, 1];
    let fewer = |binding: &Binding| {
        let mut shares = [(0, 0.0); 4];
        for (share, (bone, weight)) in shares.iter_mut().zip(binding.shares()) {
            *share = (bearers[bone], weight);
        }
        Binding::new(shares)
    };
    let moved: Vec<Binding> = bindings.iter().map(fewer).collect();
    let document = Document::of(&mesh);
    let (_, pieces) = document.pieces().unwrap();
    let kept = Some(&[0, 1, 3][..]);
    let rig = Rig::read(rigged(document.clone(), &pieces, &moved, &[], &whole, &whole, kept).unwrap());
    assert_eq!(rig.names, ["root", "bone_1", "bone_3", "tip_3"]);
    for (joint, name) in rig.names.iter().enumerate() {
        // What ends in a joint now began others there.
        let name = if name == "tip_3" { "bone_4" } else { name };
        let there = all.names.iter().position(|known| known == name).unwrap();
        for (own, wanted) in rig.poses.iter().zip(&all.poses) {
            assert_eq!(bits(&own[joint][3]), bits(&wanted[there][3]), "{name}");
            let is_turned_alike = own[joint]
                .as_flattened()
                .iter()
                .zip(wanted[there].as_flattened())
                .all(|(a, b)| a.to_bits() == b.to_bits());
            assert!(name == "bone_4" || is_turned_alike, "{name}");
        }
    }
    for frame in 0..6 {
        for vertex in [1, 3, 6] {
            assert_eq!(
                bits(&rig.vertex(2 * vertex, frame)) == bits(&all.vertex(2 * vertex, frame)),
                vertex < 6,
                "{vertex}"
            );
        }
    }
    let error = rigged(document, &pieces, &bindings, &[], &whole, &whole, kept).unwrap_err();
    assert!(matches!(error, RigError::Bindings { came, wanted: 14 } if came < 14), "{error}");
    let text = usda(&mesh, &moved, &[], &whole, &whole, kept).unwrap();
    assert!(text.contains(
        "joints = [\"root\", \"root/bone_1\", \"root/bone_1/bone_3\", \"root/bone_1/bone_3/tip_3\"]"
    ));
    let rows = text.split("timeSamples").nth(1).unwrap().lines().nth(1).unwrap().matches('(').count();
    assert_eq!(rows, 4, "a turn a joint");
}

/// Where two bones carry a vertex half and half, it is half-way between where each would have it.
#[test]
fn weights_blend() {
    let bent = skeleton(&[(0, 10.0), (1, 10.0)], &[(0.0, 0.0), (0.3, 0.0), (-0.4, 0.2), (0.1, 0.1)], 6);
    let (mesh, bindings) = marks(&bent);
    let rig = Rig::read(own(&mesh, &bindings, &bent, &bent).unwrap());
    let rest = bent.places(bent.rest());
    for frame in 0..6 {
        let directions = bent.directions(frame);
        let (places, turns) = (bent.places(directions), turns(bent.rest(), directions));
        let middle = mesh.positions[5];
        // Bone 2 begins in joint 1, bone 1 in the root.
        let by = |bone: usize, base: usize| -> [f64; 3] {
            let from = turns[bone].apply(std::array::from_fn(|axis| middle[axis] - rest[base][axis]));
            std::array::from_fn(|axis| places[base][axis] + from[axis])
        };
        let (own, before) = (by(2, 1), by(1, 0));
        let wanted = std::array::from_fn(|axis| f64::midpoint(own[axis], before[axis]));
        assert!(apart(rig.vertex(5, frame as usize), upright(wanted)) < 1e-3, "frame {frame}");
        assert!(apart(own, before) > 0.1, "else nothing was blended");
    }
}

/// A mesh that stands in a scene twice, turned, larger and moved by its nodes, and one bone to each of the places: vertices
/// are where they stood, and go where the bones take them.
#[test]
fn meshes_of_others_are_carried_from_where_they_stand() {
    let bent = skeleton(&[(0, 3.0), (1, 4.0)], &[(0.0, 0.0), (0.3, 0.0), (-0.4, 0.2), (0.1, 0.1)], 6);
    let document = Document::read(&scene(|_| {})).unwrap();
    let (mesh, pieces) = document.pieces().unwrap();
    let binding = |bone: u16| Binding::new([(bone, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);
    let bindings = [0, 1, 2, 2, 1, 0].map(binding);
    let colours: Vec<[u8; 3]> = (0..6).map(|k| [k, 2 * k, 255]).collect();
    let bound = rigged(document, &pieces, &bindings, &colours, &bent, &bent, None).unwrap();
    assert_eq!(bound.words["asset"]["copyright"], "somebody");
    // The first hung on a node of the scene, and stands by itself now, behind the second.
    let rigs: Vec<Rig> = Rig::all(bound).into_iter().rev().collect();
    assert_eq!(rigs.len(), 2);
    let rest = bent.places(bent.rest());
    for frame in 0..6 {
        let directions = bent.directions(frame);
        let (places, turns) = (bent.places(directions), turns(bent.rest(), directions));
        for (k, (place, bone)) in mesh.positions.iter().zip([0, 1, 2, 2, 1, 0]).enumerate() {
            let base = bent.joints()[bone].parent.unwrap_or(0) as usize;
            let from = std::array::from_fn(|axis| place[axis] - rest[base][axis]);
            let by = if bone == 0 { from } else { turns[bone].apply(from) };
            let wanted = upright(std::array::from_fn(|axis| places[base][axis] + by[axis]));
            let found = rigs[k / 3].vertex(k % 3, frame as usize);
            assert!(apart(found, wanted) < 1e-3, "frame {frame}, vertex {k}: {found:?} {wanted:?}");
            assert_eq!(rigs[k / 3].colours[k % 3], [k as u8, 2 * k as u8, 255, 255]);
        }
    }
}

/// Branches on a broom of so many bones, each carried by its own and a little by the stem; as a rig, and how large it is.
fn broom(n: u16) -> (Skeleton, Document, usize) {
    let twigs = std::iter::repeat_n((1, 2.0), n.into());
    let angles: Vec<(f64, f64)> =
        (0..2 * (n + 1)).map(|k| (f64::from(k).sin(), f64::from(k).cos())).collect();
    let skeleton = skeleton(&std::iter::once((0, 3.0)).chain(twigs).collect::<Vec<_>>(), &angles, 2);
    let (stem, mut bindings) =
        (Mesh { positions: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() }, Vec::new());
    let mut document = Document::of(&stem);
    let (_, mut pieces) = document.pieces().unwrap();
    bindings.extend([Binding::new([(1, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]); 3]);
    let branch = Document::of(&Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], ..stem });
    let piece = branch.pieces().unwrap().1.remove(0);
    let mut grafting = crate::glb::Grafting::of(&branch);
    for bone in 2..n + 2 {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        pieces.push(grafting.graft(&mut document, &piece, axes, [f64::from(bone), 0.0, 0.0]));
        bindings.extend([Binding::new([(bone, 0.75), (1, 0.25), (0, 0.0), (0, 0.0)]); 3]);
    }
    let bound = rigged(document, &pieces, &bindings, &[], &skeleton, &skeleton, None).unwrap();
    let size = bound.numbers.len() + bound.words.to_string().len();
    (skeleton, bound, size)
}

/// The first skin has all joints, those of branches the two that carry them, by which they are where the bones take them; so
/// that twice as many branches take twice as much.
#[test]
fn skins_of_branches_name_what_carries_them() {
    let (skeleton, bound, size) = broom(60);
    let rigs = Rig::all(bound);
    assert_eq!((rigs.len(), rigs[0].names.len()), (61, 62 + 60));
    let rest = skeleton.places(skeleton.rest());
    for (bone, rig) in (2..).zip(&rigs[1..]) {
        assert_eq!(rig.names, ["bone_1".to_owned(), format!("bone_{bone}")]);
        for frame in 0..2 {
            let directions = skeleton.directions(frame);
            let (places, turns) = (skeleton.places(directions), turns(skeleton.rest(), directions));
            let place = [bone as f64, 2.0, 0.0];
            let by = |bone: usize, base: usize| -> [f64; 3] {
                let from = turns[bone].apply(std::array::from_fn(|axis| place[axis] - rest[base][axis]));
                std::array::from_fn(|axis| places[base][axis] + from[axis])
            };
            let (own, stem) = (by(bone, 1), by(1, 0));
            let wanted = upright(std::array::from_fn(|axis| 0.75 * own[axis] + 0.25 * stem[axis]));
            let found = rig.vertex(2, frame as usize);
            assert!(apart(found, wanted) < 1e-3, "bone {bone}, frame {frame}: {found:?} {wanted:?}");
        }
    }
    let ratio = broom(120).2 as f64 / size as f64;
    assert!(ratio < 2.1, "{ratio} times as large");
}

/// A mesh that stands in a scene in front of its mirror image: both are written with their outsides outside, of a list, a
/// strip and without indices.
#[test]
fn mirrors_are_written_with_their_outside_outside() {
    let small = skeleton(&[(0, 3.0)], &[(0.0, 0.0)], 1);
    for change in [json!({}), json!({ "mode": 5 }), json!({ "indices": null })] {
        for mirror in [1, 2] {
            let document = Document::read(&scene(|words| {
                words["nodes"][mirror]["scale"] = json!([1.0, -1.0, 1.0]);
                words["nodes"][2].as_object_mut().unwrap().remove("matrix");
                let primitive = words["meshes"][0]["primitives"][0].as_object_mut().unwrap();
                primitive.extend(change.as_object().unwrap().clone());
                primitive.retain(|_, value| !value.is_null());
            }));
            let document = document.unwrap();
            let (mesh, pieces) = document.pieces().unwrap();
            let bindings = vec![Binding::new([(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]); 6];
            let bound = rigged(document, &pieces, &bindings, &[], &small, &small, None).unwrap();
            // The first hung on a node of the scene, and stands by itself now, behind the second.
            let rigs: Vec<Rig> = Rig::all(bound).into_iter().rev().collect();
            for (k, rig) in rigs.iter().enumerate() {
                let wanted = mesh.triangles[k].map(|corner| corner - 3 * k as u32);
                assert_eq!(rig.corners, wanted, "{change} {mirror} {k}");
                assert_eq!(rig.corners == [0, 2, 1], k + 1 == mirror);
            }
        }
    }
}

/// A node goes where its mesh was all there was to it, and stays where it stood for what else it bears.
#[test]
fn what_nodes_bear_beside_meshes_stays() {
    let small = skeleton(&[(0, 3.0)], &[(0.0, 0.0)], 1);
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    for (more, n_nodes) in [
        (json!({}), 0),
        (json!({ "camera": 0 }), 1),
        (json!({ "extensions": light }), 1),
        (json!({ "extras": 7 }), 0),
    ] {
        let document = Document::read(&scene(|words| {
            words["nodes"][2].as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        }));
        let document = document.unwrap();
        let place = document.words["nodes"][2]["matrix"].clone();
        let (_, pieces) = document.pieces().unwrap();
        let bindings = vec![Binding::new([(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]); 6];
        let bound = rigged(document, &pieces, &bindings, &[], &small, &small, None).unwrap();
        let nodes = bound.words["nodes"].as_array().unwrap();
        // One for the first mesh, which hung on a node, and the joints: root, bone, end.
        assert_eq!(nodes.len(), 3 + 1 + 3 + n_nodes, "{more}");
        let bearers: Vec<&Value> = nodes.iter().filter(|node| node["skin"].is_u64()).collect();
        assert_eq!(bearers.len(), 2);
        assert!(bearers.iter().any(|node| node["name"] == "leaf" && node["extras"] == more["extras"]));
        if n_nodes == 1 {
            let mut wanted = more;
            wanted["matrix"] = place;
            assert_eq!(nodes[2], wanted);
        }
    }
}

#[test]
fn frames_have_the_times_of_the_clip_from_the_first_on() {
    let times = |times_s: &[f64]| {
        let joints = vec![Joint::default(), Joint { parent: Some(0), length: 1.0, ..Joint::default() }];
        let directions = vec![[0.0, 0.0, 1.0]; 2 * times_s.len()];
        let times = FrameTimes::new(times_s.to_vec()).unwrap();
        let skeleton = Skeleton::new([0.0; 3], joints, directions, times).unwrap();
        let (mesh, bindings) = marks(&skeleton);
        own(&mesh, &bindings, &skeleton, &skeleton).map(|document| Rig::read(document).times)
    };
    assert_eq!(times(&[4.0, 4.5, 6.0]).unwrap(), [0.0, 0.5, 2.0]);
    assert_eq!(times(&[0.0, 1000.0, 1000.0 + 1e-6]).unwrap_err(), RigError::Times(1));
}

#[test]
fn what_is_no_rig_is_named() {
    let small = skeleton(&[(0, 10.0)], &[(0.2, 0.1)], 1);
    let (mesh, mut bindings) = marks(&small);
    bindings[1] = Binding::new([(2, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);
    let error = own(&mesh, &bindings, &small, &small).unwrap_err();
    assert_eq!(error, RigError::Bindings { came: 3, wanted: 4 });
    let error = own(&mesh, &bindings[..1], &small, &small).unwrap_err();
    assert_eq!(error, RigError::Bindings { came: 1, wanted: 4 });
    let broom = skeleton(&vec![(0, 1.0); 33_000], &[(0.0, 0.0)], 1);
    let error = own(&Mesh::default(), &[], &broom, &broom).unwrap_err();
    assert!(matches!(error, RigError::TooMany(n) if n > 65_535), "{error}");
}

proptest! {
    #[test]
    fn any_motion_is_read_back(
        bones in prop::collection::vec((0..100_u32, 1.0..200.0_f64), 1..12),
        angles in prop::collection::vec((-3.5..3.5_f64, -1.57..1.57_f64), 40),
    ) {
        assert_is_it(&skeleton(&bones, &angles, 4));
    }
}
