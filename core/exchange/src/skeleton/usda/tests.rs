//! What the text says, word by word; that others read it as it is meant is a test of the whole program.

use honami_model::clip::FrameTimes;
use honami_model::skeleton::Joint;

use super::*;

fn moving(times_s: &[f64]) -> Skeleton {
    let joints = vec![Joint::default(), Joint { parent: Some(0), length: 2.0, ..Joint::default() }];
    let up = [0.0, 0.0, 1.0];
    let directions = vec![up; 2 * times_s.len()];
    Skeleton::new([0.0; 3], joints, directions, FrameTimes::new(times_s.to_vec()).unwrap()).unwrap()
}

fn written(times_s: &[f64], bone: u16) -> Result<String, RigError> {
    let skeleton = moving(times_s);
    let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 3.5]];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let binding = Binding::new([(bone, 0.75), (0, 0.25), (0, 0.0), (0, 0.0)]);
    usda(&mesh, &[binding; 3], &[[255, 0, 51]; 3], &skeleton, &skeleton, None)
}

#[test]
fn a_rig_is_told_in_words() {
    let text = written(&[4.0, 4.25, 4.5, 5.0], 1).unwrap();
    for wanted in [
        "#usda 1.0\n",
        "endTimeCode = 4\n    timeCodesPerSecond = 4\n",
        "uniform token[] joints = [\"root\", \"root/bone_1\", \"root/bone_1/tip_1\"]\n",
        "(0, 0, 1, 0), (0, 2, 0, 1))]\n        rel skel:animationSource",
        "float3[] translations = [(0, 0, 0), (0, 0, 0), (0, 2, 0)]\n",
        "                0: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n                1: [",
        "                2: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n                4: [",
        "float3[] extent = [(0, 0, -2), (1, 3.5, 0)]\n",
        "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 3.5, -2)]\n",
        "primvars:displayColor = [(1, 0, 0.2), (1, 0, 0.2), (1, 0, 0.2)] (",
        "jointIndices = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0] (\n            elementSize = 4\n",
        "jointWeights = [0.75, 0.25, 0, 0, 0.75, 0.25, 0, 0, 0.75, 0.25, 0, 0] (",
    ] {
        // What is nothing may have a sign.
        assert!(text.replace("-0,", "0,").replace("-0)", "0)").contains(wanted), "{wanted}\n{text}");
    }
    let depth = text.chars().fold(0, |depth, c| depth + i32::from(c == '{') - i32::from(c == '}'));
    assert_eq!(depth, 0);
    assert!(written(&[0.0], 1).unwrap().contains("timeCodesPerSecond = 25\n"));
    // Steps are not the same to the last bit.
    for (fps, wanted) in [(25.0, "25\n"), (30.0, "30\n"), (30_000.0 / 1001.0, "29.97003\n")] {
        let times: Vec<f64> = (0..60).map(|frame| 0.1 + f64::from(frame) / fps).collect();
        let text = written(&times, 1).unwrap();
        assert!(text.contains(&format!("timeCodesPerSecond = {wanted}")), "{fps}: {text}");
        assert!(text.contains("endTimeCode = 59\n"), "{fps}");
    }
}

#[test]
fn what_cannot_be_told_is_refused() {
    assert_eq!(written(&[0.0], 2).unwrap_err(), RigError::Bindings { came: 0, wanted: 3 });
    assert_eq!(written(&[0.0, 1.0, 2.0, 2.0 + 1e-9], 1).unwrap_err(), RigError::Times(2));
}

#[test]
fn a_file_of_another_kind_is_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rig.usda");
    let text = written(&[0.0], 1).unwrap();
    write_usda(&path, &text).unwrap();
    write_usda(&path, &text).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    for theirs in ["my notes", "#usda 1.0\n(\n    doc = \"an oak\"\n)\n"] {
        std::fs::write(&path, theirs).unwrap();
        assert!(matches!(write_usda(&path, &text), Err(TableError::Unlike { .. })), "{theirs}");
    }
}
