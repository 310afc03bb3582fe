//! What is written is read back by another's reader; what cannot be is refused.

use super::reach::Reach;
use super::{Body, GlbError, Placed, Sizes, Target, write_glb};
use crate::atomic::AtomicFile;
use gltf::animation::util::ReadOutputs;
use std::path::Path;

/// Two triangles that can move in two ways.
fn body() -> Body {
    let target = |name: &str, k: f32| Target { name: name.to_owned(), moved: vec![[k, 2.0 * k, 3.0 * k]; 4] };
    Body {
        positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        targets: vec![target("mode 1", 0.5), target("mode 2", -1.0)],
    }
}

fn copies() -> Vec<Placed> {
    let copy = |x: f32, turn: f32| Placed {
        place: [x, 10.0, 0.0],
        turn,
        scale: 1.0 + x / 10.0,
        weights: (0..6).map(|k| x / 8.0 - 0.3 * k as f32).collect(),
    };
    vec![copy(0.0, 0.0), copy(5.0, std::f32::consts::FRAC_PI_2)]
}

fn close(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
}

#[test]
fn another_reader_finds_the_mesh_its_targets_and_the_motion_of_every_copy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.glb");
    let n_bytes =
        write_glb(AtomicFile::create(&path, |_| true).unwrap(), "plant", 10.0, &body(), &copies()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(n_bytes, bytes.len() as u64);
    let sizes = Sizes { n_vertices: 4, n_triangles: 2, n_targets: 2, n_copies: 2, n_frames: 3 };
    assert!((n_bytes..n_bytes + 10_000).contains(&sizes.bytes().unwrap()));
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    let data = |_: gltf::Buffer<'_>| Some(blob.as_slice());
    let mesh = document.meshes().next().unwrap();
    let primitive = mesh.primitives().next().unwrap();
    let reader = primitive.reader(data);
    let places: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(indices, [0, 1, 2, 0, 2, 3]);
    let targets: Vec<Vec<[f32; 3]>> =
        reader.read_morph_targets().map(|(moved, ..)| moved.unwrap().collect()).collect();
    let rest = mesh.weights().unwrap();
    // As readers sum it, and as it was given; y up: x, z, -y.
    let is_moved = |weights: &[f32], wanted: &[f32]| {
        assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{weights:?}");
        for (k, place) in body().positions.into_iter().enumerate() {
            let there: [f32; 3] = std::array::from_fn(|axis| {
                places[k][axis]
                    + weights.iter().zip(&targets).map(|(w, moved)| w * moved[k][axis]).sum::<f32>()
            });
            let [x, y, z] = std::array::from_fn(|axis| {
                let targets = body().targets;
                place[axis]
                    + wanted.iter().zip(&targets).map(|(w, target)| w * target.moved[k][axis]).sum::<f32>()
            });
            assert!(close(&there, &[x, z, -y]), "vertex {k} by {wanted:?}: {there:?}");
        }
    };
    is_moved(rest, &[0.0, 0.0]);
    let animation = document.animations().next().unwrap();
    for (channel, copy) in animation.channels().zip(copies()) {
        let reader = channel.reader(data);
        let times: Vec<f32> = reader.read_inputs().unwrap().collect();
        assert!(close(&times, &[0.0, 0.1, 0.2]), "{times:?}");
        let Some(ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() else { unreachable!() };
        let weights: Vec<f32> = weights.into_f32().collect();
        assert_eq!(weights.len(), copy.weights.len());
        weights.chunks(2).zip(copy.weights.chunks(2)).for_each(|(there, wanted)| is_moved(there, wanted));
        let ([x, y, z], [_, sin, _, cos], _) = channel.target().node().transform().decomposed();
        let [east, north, up] = copy.place;
        assert!(close(&[x, y, z], &[east, up, -north]));
        assert!(close(&[sin, cos], &[(copy.turn / 2.0).sin(), (copy.turn / 2.0).cos()]));
    }
}

/// Least and most of all copies and rest are 0 and 1, so that none of what a weight can say is wasted; a target that never
/// moves is there as it is.
#[test]
fn weights_fill_what_tools_take() {
    let by = |weights: [f32; 6]| Placed { weights: weights.to_vec(), ..copies().swap_remove(0) };
    let reach = Reach::new(2, &[by([-2.0, 0.0, -1.0, 0.0, -3.0, 0.0]), by([1.0, 0.0, 0.0, 0.0, -1.5, 0.0])]);
    assert!(close(&[-3.0, 0.0, 1.0].map(|weight| reach.weight(0, weight)), &[0.0, 0.75, 1.0]));
    assert!(close(&reach.rest(), &[0.75, 0.0]), "{reach:?}");
    assert!(close(&reach.way(0, [0.5, 0.0, -1.0]), &[2.0, 0.0, -4.0]), "{reach:?}");
    assert!(close(&reach.way(1, [0.5, 0.0, -1.0]), &[0.5, 0.0, -1.0]), "{reach:?}");
}

/// What stands still has no targets and no animation, which the standard has none of without any.
#[test]
fn what_cannot_move_is_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("still.glb");
    let body = Body { targets: Vec::new(), ..body() };
    let copies: Vec<Placed> =
        copies().into_iter().map(|copy| Placed { weights: Vec::new(), ..copy }).collect();
    write_glb(AtomicFile::create(&path, |_| true).unwrap(), "plant", 10.0, &body, &copies).unwrap();
    let read = gltf::Gltf::open(&path).unwrap();
    let primitive = read.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(
        (read.animations().count(), primitive.morph_targets().count(), read.nodes().count()),
        (0, 0, 2)
    );
    assert!(read.views().all(|view| view.length() > 0));
}

#[test]
fn what_readers_cannot_hold_is_refused_before_it_is_made() {
    let sizes =
        Sizes { n_vertices: 40_000, n_triangles: 80_000, n_targets: 50, n_copies: 100_000, n_frames: 500 };
    let error = sizes.bytes().unwrap_err();
    let words = error.to_string();
    assert!(matches!(error, GlbError::TooLarge { .. }));
    assert!(words.contains("100000 copies in 500 frames") && words.contains("2147 MB at most"), "{words}");
    let endless = Sizes { n_vertices: usize::MAX, n_copies: usize::MAX, n_targets: 1 << 40, ..sizes };
    assert!(endless.bytes().is_err());
}

#[test]
fn numbers_that_are_missing_or_none_are_refused_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no.glb");
    let wrong = |body: &Body, copies: &[Placed]| {
        let error =
            write_glb(AtomicFile::create(&path, |_| true).unwrap(), "plant", 10.0, body, copies).unwrap_err();
        assert!(matches!(error, GlbError::Uneven { .. }), "{error}");
        assert!(!Path::new(&path).exists());
    };
    let (whole, two) = (body(), copies());
    let with = |change: fn(&mut Body)| {
        let mut body = body();
        change(&mut body);
        body
    };
    wrong(&with(|body| body.targets[1].moved.truncate(3)), &two);
    wrong(&with(|body| body.positions[1][2] = f32::NAN), &two);
    wrong(&with(|body| body.triangles[0][0] = 4), &two);
    wrong(&with(|body| body.triangles.clear()), &two);
    wrong(&whole, &[]);
    wrong(&whole, &[two[0].clone(), Placed { weights: vec![0.0; 5], ..two[1].clone() }]);
    wrong(&whole, &[Placed { weights: vec![f32::INFINITY; 6], ..two[0].clone() }]);
}
