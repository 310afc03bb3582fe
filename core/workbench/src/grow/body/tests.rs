//! Tubes go from joint to joint, carried by the bones that they are about, as thick as what they bear.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::Joint;

use super::super::{Blend, Carried, MeshFormat, Out, write};
use super::*;

/// A stem, and two branches from its end, the first of which bears two more; rows are not in the order of branches.
fn shrub() -> Skeleton {
    let joint = |parent: u32, length: f64| Joint { parent: Some(parent), length, ..Joint::default() };
    let joints =
        vec![Joint::default(), joint(0, 2.0), joint(1, 1.0), joint(1, 1.0), joint(2, 1.0), joint(2, 1.0)];
    let lean = |degrees: f64| [degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()];
    let directions = [0.0, 0.0, 30.0, -40.0, 10.0, 60.0].map(lean).to_vec();
    Skeleton::new([3.0, 0.0, 1.0], joints, directions, FrameTimes::constant(1, 25.0).unwrap()).unwrap()
}

#[test]
fn tubes_are_about_the_bones_that_carry_them() {
    let skeleton = shrub();
    let (mesh, bindings) = body(&skeleton).unwrap();
    assert_eq!((mesh.positions.len(), mesh.normals.len()), (bindings.len(), bindings.len()));
    let ends = skeleton.places(skeleton.rest());
    let mut is_carrying = [false; 6];
    for (place, binding) in mesh.positions.iter().zip(&bindings) {
        let bones: Vec<usize> = binding.shares().map(|(bone, _)| bone).collect();
        for &bone in &bones {
            is_carrying[bone] = true;
            let base = skeleton.joints()[bone].parent.unwrap() as usize;
            let far = |end: [f64; 3]| norm(std::array::from_fn(|axis| place[axis] - end[axis]));
            let nearest = far(ends[base]).min(far(ends[bone]));
            assert!(nearest < 0.081, "{place:?} is {nearest} from the ends of bone {bone}");
        }
        assert!((1..=2).contains(&bones.len()), "{binding:?}");
    }
    assert_eq!(is_carrying, [false, true, true, true, true, true]);
}

/// 3 : 2 : 1 tips are borne by the stem, the first branch and each tip.
#[test]
fn areas_add_up() {
    let skeleton = shrub();
    let places = skeleton.places(skeleton.rest());
    let radii = radii(&skeleton, &places);
    let farthest = norm(std::array::from_fn(|axis| places[4][axis] - places[0][axis]));
    for (radius, share) in radii.iter().zip([3.0, 3.0, 2.0, 1.0, 1.0, 1.0]) {
        assert!((radius - THICKEST * farthest * (share / 3.0_f64).sqrt()).abs() < 1e-12, "{radii:?}");
    }
}

/// Rows that bindings cannot count would be carried by another bone.
#[test]
fn more_bones_than_bindings_count_are_refused() {
    let broom = |n: usize| {
        let joint = Joint { parent: Some(0), length: 1.0, ..Joint::default() };
        let joints: Vec<Joint> = [Joint::default()].into_iter().chain(vec![joint; n - 1]).collect();
        let times = FrameTimes::constant(1, 25.0).unwrap();
        Skeleton::new([0.0; 3], joints, vec![[0.0, 0.0, 1.0]; n], times).unwrap()
    };
    for n in [65_536, 65_600] {
        let error = body(&broom(n)).unwrap_err().to_string();
        assert!(error.contains(&format!("65535 joints at most, not {n}")), "{error}");
    }
}

/// A file of others that one frame would replace keeps all of them from being written.
#[test]
fn frames_are_written_all_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let times = FrameTimes::constant(3, 25.0).unwrap();
    let joints = vec![Joint::default(), Joint { parent: Some(0), length: 1.0, ..Joint::default() }];
    let skeleton = Skeleton::new([0.0; 3], joints, vec![[0.0, 0.0, 1.0]; 6], times).unwrap();
    let carried = Carried {
        bound: None,
        library: None,
        unit: 1.0,
        blend: Blend::Linear,
        fewer: None,
        again_s: None,
        are_weights_shown: false,
    };
    let path = folder.path().join("%d.ply");
    std::fs::write(folder.path().join("2.ply"), "ply\nmine\n").unwrap();
    let kind = Out::Frames(MeshFormat::Ply);
    let error = write(&skeleton, 0, kind, &carried, &path).unwrap_err().to_string();
    assert!(error.contains("2.ply") && !folder.path().join("0.ply").exists(), "{error}");
    std::fs::remove_file(folder.path().join("2.ply")).unwrap();
    write(&skeleton, 0, kind, &carried, &path).unwrap();
    assert!(folder.path().join("2.ply").exists());
}

#[test]
fn names_say_what_is_written() {
    let kinds = super::super::ENDINGS.split([' ', ',']).filter(|word| word.contains('.'));
    let kinds: Vec<Out> = kinds
        .map(|word| Out::of(std::path::Path::new(&format!("a{word}").replace("aout/", ""))).unwrap())
        .collect();
    assert_eq!(kinds.len(), 8);
    assert!((1..8).all(|row| !kinds[..row].contains(&kinds[row])), "{kinds:?}");
    for name in ["a", "a.ply", "a.obj", "a.gltf", "%04d.glb", "mv/%d.pc2", "%04d.csv", "a%db%d.ply", "%x.ply"]
    {
        assert_eq!(Out::of(std::path::Path::new(name)), None, "{name}");
    }
}
