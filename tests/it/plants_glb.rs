//! A plant with its motion as a .glb: what is in the file is what was simulated, and it is glTF as the standard wants it.

use std::fs;
use std::process::Command;

use honami_tests::{Bench, root, rows, skipped};
use serde_json::Value;

/// Vertices of a ring about a node.
const SIDES: usize = 6;

/// A file as its words and its numbers.
struct Glb {
    words: Value,
    numbers: Vec<u8>,
}

impl Glb {
    fn read(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let end = 20 + word(12);
        assert_eq!((&bytes[16..20], &bytes[end + 4..end + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
        assert_eq!(end + 8 + word(end), bytes.len());
        Self { words: serde_json::from_slice(&bytes[20..end]).unwrap(), numbers: bytes[end + 8..].to_vec() }
    }

    fn floats(&self, accessor: &Value) -> Vec<f64> {
        let number = |value: &Value| value.as_u64().unwrap() as usize;
        let accessor = &self.words["accessors"][number(accessor)];
        let view = &self.words["bufferViews"][number(&accessor["bufferView"])];
        let first = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
        let n = number(&accessor["count"]) * if accessor["type"] == "VEC3" { 3 } else { 1 };
        let floats = self.numbers[first..first + 4 * n].as_chunks::<4>().0;
        floats.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect()
    }
}

/// The middle of a ring from x, y, z of all vertices: y up there, z up here.
fn middle(vertices: &[f64], ring: usize) -> [f64; 3] {
    let of = |axis: usize| {
        let vertices = &vertices[3 * SIDES * ring..][..3 * SIDES];
        vertices.iter().skip(axis).step_by(3).sum::<f64>() / SIDES as f64
    };
    [of(0), -of(2), of(1)]
}

fn at(row: &std::collections::BTreeMap<String, String>) -> [f64; 3] {
    ["x", "y", "z"].map(|name| row[name].parse().unwrap())
}

fn near(a: [f64; 3], b: [f64; 3], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance)
}

/// Straight, bent with two powers and with three: in every frame the middles of rings are where the sensors are; where
/// segments turn they are as near as is told.
#[test]
fn a_glb_has_its_nodes_where_the_simulation_has_them() {
    for (bend, n_targets) in [("linear", 4), ("s2", 8), ("s3", 12), ("turn", 8)] {
        let bench = Bench::new();
        let made = bench.json(&format!(
            "simulate synth::tree:30,1 --modes 4 --wind calm --forest 3 --seconds 1 --fps 10 --sensors 2 --bend {bend} \
             --out sway.csv --beams beams.csv --glb sway.glb"
        ));
        let glb = Glb::read(&fs::read(bench.path("sway.glb")).unwrap());
        assert_eq!(made["motion"]["glb"]["targets"], n_targets);
        let off = made["motion"]["glb"]["off_m"].as_f64().unwrap();
        assert!(if bend == "turn" { off < 0.05 } else { off < 1e-5 }, "{bend}: {off} m");
        let mesh = &glb.words["meshes"][0];
        let primitive = &mesh["primitives"][0];
        let rest = glb.floats(&primitive["attributes"]["POSITION"]);
        let targets: Vec<Vec<f64>> = primitive["targets"]
            .as_array()
            .unwrap()
            .iter()
            .map(|target| glb.floats(&target["POSITION"]))
            .collect();
        assert!(
            targets.len() == n_targets
                && mesh["extras"]["targetNames"].as_array().unwrap().len() == n_targets
        );
        let animation = &glb.words["animations"][0];
        assert_eq!(glb.words["nodes"].as_array().unwrap().len(), 3);
        // The first copy stands at the root, not turned.
        let weights = glb.floats(&animation["samplers"][0]["output"]);
        let beams = rows(&bench.path("beams.csv"));
        let ring_of = |node: &str| {
            let place = at(&beams[node.parse::<usize>().unwrap()]);
            (0..rest.len() / 3 / SIDES).find(|ring| near(middle(&rest, *ring), place, 1e-4)).unwrap()
        };
        for row in rows(&bench.path("sway.csv")) {
            let (frame, ring): (usize, usize) = (row["frame"].parse().unwrap(), ring_of(&row["node"]));
            let mut place = middle(&rest, ring);
            for (weight, target) in weights[frame * n_targets..].iter().zip(&targets) {
                let moved = middle(target, ring);
                place = [0, 1, 2].map(|axis| place[axis] + weight * moved[axis]);
            }
            assert!(near(place, at(&row), off + 1e-4), "{bend}: {row:?} {place:?}");
        }
    }
}

/// Khronos's validator finds no error and nothing to warn of, where it is installed.
#[test]
fn a_glb_is_as_the_standard_wants_it() {
    let node = |args: &[&str]| Command::new("node").args(args).current_dir(root()).output();
    let is_there = node(&["-e", "require('gltf-validator')"]).is_ok_and(|output| output.status.success());
    if !is_there {
        skipped("gltf-validator (npm install gltf-validator)");
        return;
    }
    let bench = Bench::new();
    let plants =
        ["synth::tree:2,1 --modes 1 --pull 0.1", "synth::tree:300,2 --forest 5 --wind storm --bend s3"];
    for plant in plants {
        bench.json(&format!("simulate {plant} --seconds 2 --glb sway.glb"));
        let output =
            node(&["tests/peers/glb_validator.cjs", bench.path("sway.glb").to_str().unwrap()]).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["errors"] == 0 && found["warnings"] == 0, "{plant}: {found}");
    }
}

#[test]
fn a_glb_that_its_readers_could_not_hold_is_refused() {
    let bench = Bench::new();
    let ran = bench.line("simulate synth::tree:300,1 --forest 100000 --seconds 100 --glb forest.glb");
    assert!(ran.code == Some(1) && ran.stderr.contains("its readers hold 2147 MB at most"), "{ran:?}");
    assert!(!bench.path("forest.glb").exists());
}
