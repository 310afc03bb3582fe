//! Skeletons and what they carry as rigs, through the real program: other programs read them.

use std::process::Command;

use honami_tests::{Bench, missing, python_with, root};
use serde_json::Value;

/// A project of a generated clip, tracked and grouped.
fn grouped() -> Bench {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 6");
    bench
}

/// pygltflib finds joints where the table has them, to 1e-4 of the plant's size, and trimesh a mesh, where they are
/// installed.
#[test]
fn other_programs_read_the_same_rig() {
    let (Some(python), Some(_)) = (python_with("pygltflib"), python_with("trimesh")) else { return };
    let bench = grouped();
    let script = root().join("tests/peers/glb_readers.py");
    for (more, unit) in [("--flat", "0.001"), ("--groups 9 --unit 0.02", "0.02"), ("--loop", "0.001")] {
        bench.text(&format!("grow p.honami rig.glb joints.csv {more}"));
        let mut command = Command::new(&python);
        command.args([&script, &bench.path("rig.glb"), &bench.path("joints.csv")]).arg(unit);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{more}: {output:?}");
    }
}

/// Khronos's validator finds no error and nothing to warn of, where it is installed.
#[test]
fn a_rig_is_as_the_standard_wants_it() {
    let node = |args: &[&str]| Command::new("node").args(args).current_dir(root()).output();
    let is_there = node(&["-e", "require('gltf-validator')"]).is_ok_and(|output| output.status.success());
    if !is_there {
        return missing("gltf-validator for node (cargo xtask peers)");
    }
    let bench = grouped();
    for (line, file) in [
        ("grow p.honami rig.glb --flat", "rig.glb"),
        ("grow p.honami rig.glb --groups 9 --siblings 1 --level 1", "rig-1.glb"),
        ("grow p.honami rig.glb --with zeng --loop", "rig.glb"),
    ] {
        bench.text(line);
        let output = node(&["tests/peers/glb_validator.cjs", bench.path(file).to_str().unwrap()]).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["errors"] == 0 && found["warnings"] == 0, "{line}: {found}");
    }
}

#[test]
fn what_is_no_rig_says_why() {
    let bench = grouped();
    for (line, code, wanted) in [
        ("grow p.honami rig.glb --unit 0", 2, "--unit takes metres of a pixel, more than 0"),
        ("grow p.honami rig.glb --unit=-1", 2, "--unit takes metres of a pixel, more than 0"),
        ("grow p.honami rig.glb --unit nan", 2, "--unit takes metres of a pixel, more than 0"),
        ("grow p.honami rig.bvh --unit 0.01", 2, "--unit goes with a .glb, as out.glb"),
        ("grow p.honami rig.glb --unit 1e-12", 1, "is it the unit?"),
        ("grow p.honami rig.glb --unit 1e12", 1, "is it the unit?"),
    ] {
        let ran = bench.line(line);
        assert!(ran.code == Some(code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
        assert!(!bench.path("rig.glb").exists(), "{line}");
    }
    assert!(bench.text("grow p.honami rig.glb").contains("y up, a pixel taken as 0.001 m"));
}
