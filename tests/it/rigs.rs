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
        // Rigs of loops end with their first pose.
        let n_more = if more == "--loop" { "1" } else { "0" };
        command.args([&script, &bench.path("rig.glb"), &bench.path("joints.csv")]).args([unit, n_more]);
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
        ("grow p.honami rig.glb --groups 9 --joints 12 --weights", "rig.glb"),
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
        ("grow p.honami rig.bvh --unit 0.01", 2, "--unit goes with a .glb, as out.glb, or with frames"),
        ("grow p.honami rig.glb --unit 1e-12", 1, "is it the unit?"),
        (
            "grow p.honami rig.glb --joints 2",
            2,
            "a rig has 3 joints at least, the root, a bone and its end, not 2",
        ),
        ("grow p.honami rig.bvh --joints 9", 2, "--joints goes with a .glb or .usda"),
        ("grow p.honami rig.glb --unit 1e12", 2, "is it the unit?"),
    ] {
        let ran = bench.line(line);
        assert!(ran.code == Some(code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
        assert!(!bench.path("rig.glb").exists(), "{line}");
    }
    assert!(bench.text("grow p.honami rig.glb").contains("y up, a pixel taken as 0.001 m"));
}

/// As many joints as were asked for, each where the table has the bone that it is named after.
#[test]
fn a_rig_has_no_more_joints_than_an_engine_takes() {
    let bench = grouped();
    let words = |name: &str| -> Value {
        let bytes = std::fs::read(bench.path(name)).unwrap();
        let size = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice(&bytes[20..20 + size]).unwrap()
    };
    let names = |words: &Value| -> Vec<(String, Value)> {
        let joints = words["skins"][0]["joints"].as_array().unwrap();
        let node = |joint: &Value| words["nodes"][joint.as_u64().unwrap() as usize].clone();
        joints
            .iter()
            .map(node)
            .map(|node| (node["name"].as_str().unwrap().to_owned(), node["translation"].clone()))
            .collect()
    };
    bench.json("grow p.honami all.glb --groups 9");
    let all = names(&words("all.glb"));
    for most in [3, 12, 20, 21, 1000] {
        let answer = bench.json(&format!("grow p.honami few.glb few.usda --groups 9 --joints {most}"));
        let few = words("few.glb");
        let few = names(&few);
        assert_eq!(answer["rig"]["joints"], few.len());
        assert!(few.len() <= most && few.len() + 2 > most.min(all.len()), "{most}: {}", few.len());
        let n_bones =
            |names: &[(String, Value)]| names.iter().filter(|(name, _)| name.starts_with("bone")).count();
        assert_eq!(answer["rig"]["left_out"], n_bones(&all) - n_bones(&few));
        assert!(
            few.iter().filter(|(name, _)| name.starts_with("bone")).all(|joint| all.contains(joint)),
            "{few:?}"
        );
        let text = std::fs::read_to_string(bench.path("few.usda")).unwrap();
        let list = text.lines().find(|line| line.contains("token[] joints")).unwrap();
        assert_eq!(list.matches("\"root").count(), few.len());
    }
}

/// A stem and two branches of square section, y up, its foot beside the origin; `Wavefront`'s text.
fn shrub() -> String {
    let mut text = "# by hand\n".to_owned();
    let stem = (0..=8).map(|k| [3.0, f64::from(k) * 0.25, 1.0]);
    let branch =
        |side: f64| (0..=4).map(move |k| [3.0 + side * f64::from(k) * 0.2, 1.0 + f64::from(k) * 0.2, 1.0]);
    let mut first = 1;
    for axis in [stem.collect::<Vec<_>>(), branch(1.0).collect(), branch(-1.0).collect()] {
        for (k, [x, y, z]) in axis.iter().enumerate() {
            for [a, b] in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]] {
                text += &format!("v {} {y} {}\n", x + 0.05 * a, z + 0.05 * b);
            }
            let ring = first + 4 * k;
            for side in 0..if k > 0 { 4 } else { 0 } {
                let next = (side + 1) % 4;
                text +=
                    &format!("f {} {} {} {}\n", ring - 4 + side, ring - 4 + next, ring + next, ring + side);
            }
        }
        first += 4 * axis.len();
    }
    text
}

/// Vertices of a `.ply` of ours, and how many triangles.
fn ply(path: &std::path::Path) -> (Vec<[f32; 3]>, usize) {
    let bytes = std::fs::read(path).unwrap();
    let end = bytes.windows(11).position(|bytes| bytes == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(bytes[..end].to_vec()).unwrap();
    let count = |name: &str| -> usize {
        header.split(name).nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap()
    };
    let (n, n_faces) = (count("element vertex"), count("element face"));
    let row = if header.contains("red") { 15 } else { 12 };
    assert_eq!(bytes.len(), end + row * n + 13 * n_faces);
    let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    ((0..n).map(|k| [0, 4, 8].map(|by| number(end + row * k + by))).collect(), n_faces)
}

#[test]
fn another_plant_moves_as_the_filmed_one() {
    let bench = grouped();
    std::fs::write(bench.path("shrub.obj"), shrub()).unwrap();
    let line = "grow p.honami rig.glb moved/%04d.ply at.pc2 j.csv --onto shrub.obj --groups 9";
    let answer = bench.json(line);
    assert_eq!((&answer["onto"]["vertices"], &answer["onto"]["triangles"]), (&76.into(), &128.into()));
    let frames: Vec<_> = (0..40).map(|frame| ply(&bench.path(&format!("moved/{frame:04}.ply")))).collect();
    assert!(!bench.path("moved/0040.ply").exists());
    assert_eq!(answer["onto"]["notes"], serde_json::json!([]));
    // What stands behind a shorter motion is told, and so is a folder.
    std::fs::copy(bench.path("moved/0039.ply"), bench.path("moved/0040.ply")).unwrap();
    let told = bench.text(&line.replace("moved/", "other/"));
    assert!(
        told.contains("other/%04d.ply: 40 frames of what it carries, in a folder made for them\n"),
        "{told}"
    );
    let told = bench.text(line);
    assert!(
        told.contains("moved/%04d.ply: 40 frames of what it carries; 1 more stand behind them"),
        "{told}"
    );
    let cache = std::fs::read(bench.path("at.pc2")).unwrap();
    let cached: Vec<f32> =
        cache[32..].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    assert_eq!(
        cached,
        frames.iter().flat_map(|(places, _)| places.as_flattened().to_vec()).collect::<Vec<_>>()
    );
    let rest: Vec<[f32; 3]> = shrub()
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| {
            line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f32>>().try_into().unwrap()
        })
        .collect();
    // What is low hardly moves, what is high moves as the skeleton does, and not far from the mean of its frames.
    let apart = |a: [f32; 3], b: [f32; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f32>().sqrt();
    let farthest = |vertices: std::ops::Range<usize>| {
        let far = |(places, n): &(Vec<[f32; 3]>, usize)| {
            assert_eq!((places.len(), *n), (76, 128));
            vertices.clone().map(|k| apart(places[k], rest[k])).fold(0.0, f32::max)
        };
        frames.iter().map(far).fold(0.0, f32::max)
    };
    let (low, high) = (farthest(0..4), farthest(32..36));
    assert!(low < 0.3 * high && (0.005..0.5).contains(&high), "{low} {high}");
    // Siblings are the plant in other shapes: at rest already, of which the first frame tells enough.
    bench.json("grow p.honami moved/%04d.ply --onto shrub.obj --groups 9 --siblings 1 --level 1");
    let sibling = ply(&bench.path("moved/0000-1.ply")).0;
    let shift = (0..76).map(|k| apart(sibling[k], frames[0].0[k])).fold(0.0, f32::max);
    assert!(shift > 2.0 * high, "{shift} {high}");
    // Blended otherwise it is near, and not the same.
    bench.json("grow p.honami dual/%d.obj --onto shrub.obj --groups 9 --blend dual --weights");
    let dual = std::fs::read_to_string(bench.path("dual/39.obj")).unwrap();
    let vertices = dual.lines().filter_map(|line| line.strip_prefix("v "));
    let vertices: Vec<Vec<f32>> =
        vertices.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect();
    let off = (0..76).map(|k| apart([vertices[k][0], vertices[k][1], vertices[k][2]], frames[39].0[k]));
    let off = off.fold(0.0, f32::max);
    assert!(off > 0.0 && off < 0.1 * high, "{off} {high}");
    assert!(
        vertices
            .iter()
            .all(|vertex| vertex[3..].iter().all(|v| (0.1..=1.0).contains(v)) && vertex.len() == 6)
    );
}

/// Pixar's own reader has the vertices of a rig where frames have them, to 1e-4 of the plant's size, where it is installed.
#[test]
fn a_rig_in_words_moves_alike() {
    let Some(python) = python_with("pxr") else { return };
    let bench = grouped();
    std::fs::write(bench.path("shrub.obj"), shrub()).unwrap();
    let script = root().join("tests/peers/usd_skel.py");
    for more in ["--groups 9 --weights", "--flat --turn 30", "--siblings 1 --level 1"] {
        bench.text(&format!("grow p.honami rig.usda moved/%d.ply --onto shrub.obj {more}"));
        let name = if more.contains("siblings") {
            ["rig-1.usda", "moved/%d-1.ply"]
        } else {
            ["rig.usda", "moved/%d.ply"]
        };
        let output =
            Command::new(&python).arg(&script).args(name.map(|name| bench.path(name))).output().unwrap();
        assert!(output.status.success(), "{more}: {output:?}");
    }
    bench.text("grow p.honami own.usda --unit 0.01");
}

/// Plants in every format that is read, with their motion, are glTF without an error, where the validator is installed.
#[test]
fn plants_of_every_format_are_carried() {
    let node = |args: &[&str]| Command::new("node").args(args).current_dir(root()).output();
    let is_there = node(&["-e", "require('gltf-validator')"]).is_ok_and(|output| output.status.success());
    let bench = grouped();
    std::fs::write(bench.path("shrub.obj"), shrub()).unwrap();
    bench.json("grow p.honami shrub/%d.ply --onto shrub.obj --up y");
    bench.json("grow p.honami rest.swc");
    // A grove: one mesh in three places, with morph targets and an animation of its own.
    bench.json("simulate synth::tree:30,1 --forest 3 --wind wind --seconds 1 --glb grove.glb");
    for (plant, more) in [
        ("shrub.obj", "--weights"),
        ("shrub/0.ply", "--up y --turn 90"),
        ("grove.glb", "--groups 9"),
        ("grove.glb", "--weights --unit 0.01"),
        ("rest.swc", "--loop"),
    ] {
        let answer = bench.json(&format!("grow p.honami out.glb --onto {plant} {more}"));
        assert!(answer["onto"]["triangles"].as_u64().unwrap() > 20, "{plant}: {answer}");
        if !is_there {
            continue;
        }
        let output =
            node(&["tests/peers/glb_validator.cjs", bench.path("out.glb").to_str().unwrap()]).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["errors"] == 0 && found["warnings"] == 0, "{plant} {more}: {found}");
    }
    if !is_there {
        missing("gltf-validator for node (cargo xtask peers)");
    }
}

/// A plant of branches from a mesh, a scene of several trees of nodes and a plant of nodes; where the validator is installed,
/// glTF without an error.
#[test]
fn plants_are_put_together_of_branches() {
    let node = |args: &[&str]| Command::new("node").args(args).current_dir(root()).output();
    let is_there = node(&["-e", "require('gltf-validator')"]).is_ok_and(|output| output.status.success());
    let bench = grouped();
    std::fs::write(bench.path("shrub.obj"), shrub()).unwrap();
    bench.json("simulate synth::tree:30,1 --forest 3 --wind wind --seconds 1 --glb grove.glb");
    bench.json("grow p.honami rest.swc");
    let joints = bench.json("grow p.honami j.csv --groups 9");
    // The shrub stands beside the origin of its file.
    for (library, n_branches, [pivot, lowest]) in [
        ("--branches shrub.obj", 1, [0, 1]),
        ("--branches grove.glb --branches shrub.obj", 4, [3, 1]),
        ("--branches rest.swc --weights", 0, [0, 0]),
    ] {
        let line = format!("grow p.honami out.glb out.usda out/%d.ply --groups 9 --unit 0.01 {library}");
        let answer = bench.json(&line);
        let branches = &answer["branches"];
        assert!(n_branches == 0 || branches["library"] == n_branches, "{library}: {answer}");
        let begin = &branches["begin"];
        assert_eq!((&begin["pivot"], &begin["lowest"]), (&pivot.into(), &lowest.into()), "{answer}");
        assert!((n_branches == 0) == (begin["fork"] == branches["library"]), "{answer}");
        // 9 groups, and their mirror images.
        assert_eq!((&branches["bones"], &answer["joints"]), (&18.into(), &joints["joints"]), "{answer}");
        let scales = [0, 1].map(|k| branches["scales"][k].as_f64().unwrap());
        assert!(0.0 < scales[0] && scales[0] < scales[1] && scales[1] < 10.0, "{answer}");
        let frame = ply(&bench.path("out/39.ply"));
        assert_eq!(
            (frame.0.len() as u64, frame.1 as u64),
            (branches["vertices"].as_u64().unwrap(), branches["triangles"].as_u64().unwrap())
        );
        let bytes = std::fs::read(bench.path("out.glb")).unwrap();
        bench.json(&line);
        assert!(std::fs::read(bench.path("out.glb")).unwrap() == bytes, "the same seed gives the same bytes");
        if is_there {
            let output =
                node(&["tests/peers/glb_validator.cjs", bench.path("out.glb").to_str().unwrap()]).unwrap();
            let found: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert!(found["errors"] == 0 && found["warnings"] == 0, "{library}: {found}");
        }
    }
    let told =
        bench.text("grow p.honami out.glb --groups 9 --branches shrub.obj --siblings 1 --level 1 --seed 4");
    assert!(
        told.contains("branches: on 18 bones, 1 of the library's 1, ") && told.contains("seed 4;"),
        "{told}"
    );
    let [own, sibling] = ["out.glb", "out-1.glb"].map(|name| std::fs::read(bench.path(name)).unwrap());
    assert!(own.len().abs_diff(sibling.len()) < own.len() / 10);
    if !is_there {
        missing("gltf-validator for node (cargo xtask peers)");
    }
}

#[test]
fn what_cannot_be_carried_says_why() {
    let bench = grouped();
    for (name, text) in [
        ("points.obj", "v 0 0 0\nv 0 1 0\n"),
        ("lost.obj", "v 0 0 0\nv 0 nan 0\nf 1 2 2\n"),
        ("far.obj", "v 0 0 0\nv 0 1e30 0\nf 1 2 2\n"),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\n"),
        ("good.obj", "v 0 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\n"),
        ("one.swc", "1 1 0 0 0 .07 -1\n"),
        ("stick.swc", "1 1 0 0 0 .2 -1\n2 1 0 0 1 .2 1\n"),
        ("dot.obj", "v 1 1 1\nf 1 1 1\n"),
        ("no.glb", "glTF"),
        ("leaf.txt", "leaf"),
    ] {
        std::fs::write(bench.path(name), text).unwrap();
    }
    bench.json("grow p.honami rig.glb");
    for (line, code, wanted) in [
        ("out.glb --onto points.obj", 1, "points.obj: a plant to carry has a triangle at least"),
        ("out.glb --onto lost.obj", 1, "lost.obj: line 2: a vertex is three finite numbers"),
        ("out.glb --onto far.obj", 1, "far.obj: vertex 2 lies at [0.0, 1e30, 0.0]"),
        ("out.glb --onto flat.obj", 1, "--unit says how much of the plant's length a pixel is"),
        ("out.glb --onto one.swc", 1, "two nodes at least, this one has 1"),
        ("out.glb --onto no.glb", 1, "no.glb: a .glb begins with `glTF`"),
        ("out.glb --onto rig.glb", 1, "rig.glb: it is bound to bones already"),
        ("out.glb --onto leaf.txt", 2, "not as leaf.txt"),
        ("out.glb --onto none.obj", 1, "none.obj: "),
        ("out.glb --onto good.obj --unit 1e-320", 2, "a pixel is 1e-9 to 1e9 of the plant's length"),
        ("out.glb --onto rig.glb --up z", 2, "--up"),
        ("out.pc2 --onto one.swc", 1, "two nodes"),
        ("out.pc2", 2, "a .pc2 has the vertices of an .obj or .ply"),
        ("out.ply --onto good.obj", 2, "or as frames, out/%04d.ply or out/%04d.obj, not as out.ply"),
        ("a%db%d.ply --onto good.obj", 2, "not as a%db%d.ply"),
        ("out.bvh --onto good.obj", 2, "--onto goes with a .glb, as out.glb, or with frames"),
        ("out.bvh --weights", 2, "--weights goes with a .glb"),
        ("out.glb --blend dual", 2, "who reads a .glb or .usda blends linearly"),
        ("out.usda --blend dual", 2, "who reads a .glb or .usda blends linearly"),
        ("out.glb --turn 9", 2, "--onto"),
        ("out.glb --onto good.obj --turn nan", 2, "--turn takes degrees"),
        ("rig.glb --onto rig.glb", 2, "another name than the plant that is read"),
        ("no/such/%d.ply --onto good.obj", 1, "no/such"),
        ("out.glb --branches good.obj --onto good.obj", 2, "--onto"),
        ("out.glb --branches good.obj --turn 9", 2, "--onto"),
        ("out.glb --branches none.obj", 1, "none.obj: "),
        (
            "out.glb --branches good.obj --branches points.obj",
            1,
            "points.obj: a plant to carry has a triangle at least",
        ),
        ("out.glb --branches stick.swc", 1, "stick.swc: the branches of a plant are what hangs on its forks"),
        ("out.glb --branches dot.obj", 1, "dot.obj: a branch goes from its foot"),
        ("out.glb --branches good.obj --unit 1e-12", 1, "is it the unit?"),
        ("out.pc2 --branches good.obj", 2, "a .pc2 has the vertices of an .obj or .ply"),
        ("out.bvh --branches good.obj", 2, "--branches goes with a .glb"),
        ("rig.glb --branches rig.glb", 2, "another name than the plant that is read"),
        ("out.glb --up z", 2, "--up goes with --onto or --branches"),
    ] {
        let ran = bench.line(&format!("grow p.honami {line}"));
        assert!(ran.code == Some(code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
        assert!(!bench.path("out.glb").exists() && !bench.path("out.pc2").exists(), "{line}");
    }
    bench.json("grow p.honami out.glb --onto flat.obj --unit 0.01");
}
