//! A plant with its motion as a .glb: what is in the file is what was simulated, and it is glTF as the standard wants it.

use std::fs;
use std::process::Command;

use honami_tests::{Bench, missing, root, rows};
use serde_json::Value;

use super::plants::own_simulator;

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

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// A plant in a file, with the ring of every node.
struct Filed {
    glb: Glb,
    /// Where all weights are 0.
    least: Vec<f64>,
    targets: Vec<Vec<f64>>,
    /// Of the mesh that nothing plays.
    at_rest: Vec<f64>,
    /// Of every copy, frame after frame.
    weights: Vec<Vec<f64>>,
    rings: Vec<usize>,
}

impl Filed {
    fn read(bytes: &[u8], nodes: &[[f64; 3]]) -> Self {
        let glb = Glb::read(bytes);
        let primitive = &glb.words["meshes"][0]["primitives"][0];
        let least = glb.floats(&primitive["attributes"]["POSITION"]);
        let targets = primitive["targets"].as_array().unwrap();
        let targets = targets.iter().map(|target| glb.floats(&target["POSITION"])).collect();
        let at_rest = glb.words["meshes"][0]["weights"].as_array().unwrap().iter();
        let at_rest = at_rest.map(|weight| weight.as_f64().unwrap()).collect();
        let samplers = glb.words["animations"][0]["samplers"].as_array().unwrap();
        let weights = samplers.iter().map(|sampler| glb.floats(&sampler["output"])).collect();
        let mut made = Self { glb, least, targets, at_rest, weights, rings: Vec::new() };
        // A thousandth: where a simulator moves each node for itself, rings turn by kilometres, in single precision.
        let ring = |place: &[f64; 3]| {
            let off = |ring: usize| apart(made.moved(&made.at_rest, ring), *place);
            let rings = (0..made.least.len() / 3 / SIDES).map(|ring| (off(ring), ring));
            let (off, ring) = rings.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            assert!(off < 1e-3, "no ring is at {place:?}: the nearest is {off} m off");
            ring
        };
        made.rings = nodes.iter().map(ring).collect();
        made
    }

    /// Where the middle of a ring is by such weights.
    fn moved(&self, weights: &[f64], ring: usize) -> [f64; 3] {
        let mut own = middle(&self.least, ring);
        for (weight, target) in weights.iter().zip(&self.targets) {
            let moved = middle(target, ring);
            own = [0, 1, 2].map(|axis| own[axis] + weight * moved[axis]);
        }
        own
    }

    /// Where a node of a copy is in a frame, or at rest.
    fn place(&self, copy: usize, frame: Option<usize>, node: usize) -> [f64; 3] {
        let weights =
            frame.map_or(&self.at_rest[..], |frame| &self.weights[copy][frame * self.targets.len()..]);
        let own = self.moved(weights, self.rings[node]);
        let of = |name: &str, k: usize| self.glb.words["nodes"][copy][name][k].as_f64().unwrap();
        let (sin, cos) = (2.0 * of("rotation", 1).atan2(of("rotation", 3))).sin_cos();
        let size = of("scale", 0);
        let turned = [cos * own[0] - sin * own[1], sin * own[0] + cos * own[1], own[2]].map(|v| v * size);
        let foot = [of("translation", 0), -of("translation", 2), of("translation", 1)];
        [0, 1, 2].map(|axis| foot[axis] + turned[axis])
    }
}

/// A tree with twigs of no length, which bear no leaves.
const BUDDED: &str = "1 1 0 0 0 .07 -1\n2 1 .1 0 2.4 .06 1\n3 1 .05 0 3.4 .045 2\n4 1 .1 .3 4.4 .03 3\n\
    5 1 .7 .1 3 .025 2\n6 1 1.3 .2 3.5 .015 5\n7 1 .1 0 2.4 .02 2\n8 1 1.3 .2 3.5 .01 6\n";

/// A cross of equal arms: its slowest modes are any of their sums.
fn cross() -> String {
    let arms = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let arm = |(k, [x, y]): (usize, [f64; 2])| {
        let first = 3 + 2 * k;
        format!("{first} 1 {} {} 1 .01 2\n{} 1 {x} {y} 1 .01 {first}\n", x / 2.0, y / 2.0, first + 1)
    };
    "1 1 0 0 0 .02 -1\n2 1 0 0 1 .02 1\n".to_owned()
        + &arms.into_iter().enumerate().map(arm).collect::<String>()
}

/// In every frame the middles of rings are as near as is told, and as was promised, to where the point cache has the nodes
/// of every copy, and the sensors those of the first: straight, bent and turned, in the wind and pulled, of equal modes
/// whichever are found, and moved by another.
#[test]
fn a_glb_has_its_nodes_where_the_simulation_has_them() {
    let mut moved: Vec<String> = Vec::new();
    for bend in ["linear", "s2", "s3", "turn"] {
        for begun in [
            "synth::tree:30,1 --wind calm",
            "synth::tree:30,1 --wind storm --size-spread 0.5 --mass-spread 2",
            "synth::tree:30,1 --pull 0.3",
            "budded.swc --pull=-0.3 --leaf-mass 20",
            "budded.swc --wind calm --leaf-mass 20 --leaf-drag 3",
            "cross.swc --pull 0.3 --seed 2",
        ] {
            moved.push(format!("{begun} --modes 4 --bend {bend}"));
        }
    }
    let bench = Bench::new();
    fs::write(bench.path("budded.swc"), BUDDED).unwrap();
    fs::write(bench.path("cross.swc"), cross()).unwrap();
    if own_simulator(&bench) {
        moved.push("synth::tree:30,1 --wind wind --plugin own.so --with bad".to_owned());
    }
    for begun in moved {
        let made = bench.json(&format!(
            "simulate {begun} --forest 3 --seconds 1 --fps 10 --sensors 2 \
             --out sway.csv --beams beams.csv --cache sway.pc2 --glb sway.glb"
        ));
        let nodes: Vec<[f64; 3]> = rows(&bench.path("beams.csv")).iter().map(at).collect();
        let filed = Filed::read(&fs::read(bench.path("sway.glb")).unwrap(), &nodes);
        let sizes = filed.glb.words["nodes"].as_array().unwrap().iter().map(|node| &node["scale"][0]);
        let sizes: Vec<f64> = sizes.map(|size| size.as_f64().unwrap()).collect();
        let is_own = |copy: usize| (sizes[copy] - 1.0).abs() < 1e-6;
        assert!(is_own(0) && (is_own(1) && is_own(2)) != begun.contains("spread"), "{sizes:?}");
        assert!(sizes.iter().all(|size| (0.66..1.51).contains(size)), "{sizes:?}");
        let n_targets = filed.targets.len();
        let n_named = filed.glb.words["meshes"][0]["extras"]["targetNames"].as_array().unwrap().len();
        assert_eq!((&made["motion"]["glb"]["targets"], n_named), (&n_targets.into(), n_targets));
        assert_eq!(filed.weights.len(), 3);
        // What lies outside is cut off by many who read it.
        let mut weights = filed.weights.iter().flatten().chain(&filed.at_rest);
        assert!(weights.all(|weight| (0.0..=1.0).contains(weight)), "{begun}");
        let is_few = if begun.contains("linear") { n_targets <= 4 } else { n_targets <= 30 };
        assert!(is_few, "{begun}: {n_targets} shapes");
        let off = made["motion"]["glb"]["off_m"].as_f64().unwrap();
        let height = made["height_m"].as_f64().unwrap();
        assert!(off <= 1e-3 * height * sizes.iter().copied().fold(0.0, f64::max) + 1e-9, "{begun}: {off} m");
        let points = &fs::read(bench.path("sway.pc2")).unwrap()[32..];
        let mut points = points.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
        for (frame, copy) in (0..10).flat_map(|frame| (0..3).map(move |copy| (frame, copy))) {
            let mut farthest: f64 = 0.0;
            for node in 0..nodes.len() {
                let cached = [0; 3].map(|_| points.next().unwrap());
                let (place, rest) = (filed.place(copy, Some(frame), node), filed.place(copy, None, node));
                let apart = apart(place, cached);
                assert!(apart < off + 2e-5, "{begun}, copy {copy}, {frame}: {place:?} {cached:?}");
                farthest = farthest.max(self::apart(place, rest));
            }
            let is_pulled = frame == 0 && begun.contains("--pull");
            assert!(!is_pulled || farthest > 0.25, "{begun}, copy {copy}: {farthest}");
        }
        for row in rows(&bench.path("sway.csv")) {
            let place = filed.place(0, row["frame"].parse().ok(), row["node"].parse().unwrap());
            assert!(apart(place, at(&row)) < off + 2e-5, "{begun}: {row:?} {place:?}");
        }
    }
}

/// Equal modes are pulled to one place, whichever the simulator has found.
#[test]
fn a_cross_is_pulled_to_one_place_by_any_seed() {
    let bench = Bench::new();
    fs::write(bench.path("cross.swc"), cross()).unwrap();
    let begun = |seed: u32| {
        bench.json(&format!(
            "simulate cross.swc --modes 4 --pull 0.3 --seed {seed} --seconds 0.1 --out {seed}.csv"
        ));
        rows(&bench.path(&format!("{seed}.csv"))).iter().map(at).collect::<Vec<_>>()
    };
    let first = begun(1);
    for seed in [2, 3, 4] {
        let other = begun(seed);
        assert!(
            other.len() == first.len() && other.iter().zip(&first).all(|(a, b)| apart(*a, *b) < 1e-4),
            "{seed}"
        );
    }
}

/// What a simulator is set is what it is when it is typed: in the table of modes, and in everything that is written.
#[test]
fn what_is_set_holds_for_all_that_is_told_and_written() {
    let bench = Bench::new();
    let line = "simulate synth::tree:30,1 --wind wind --forest 2 --seconds 1 --out a.csv --cache a.pc2 --glb a.glb \
                --beams b.csv";
    let files = || ["a.csv", "a.pc2", "a.glb", "b.csv"].map(|name| fs::read(bench.path(name)).unwrap());
    let made = |more: &str| (bench.json(&format!("{line} {more}")), files());
    let (usual, usual_files) = made("");
    for (typed, set) in [
        ("--young 3e9", "--set young=3e9"),
        ("--density 700 --poisson 0.2", "--set density=700 --set poisson=0.2"),
        ("--heavier 2 --alpha 1 --beta 0.01", "--set heavier=2 --set alpha=1 --set beta=0.01"),
        ("--air-damping 0 --pull 0.2", "--set air_damping=0 --set pull=0.2 --with modal"),
        ("--modes 7 --bend s2", "--set modes=7 --set bend=s2"),
        ("--leaf-mass 3 --leaf-drag 2", "--set leaf_mass=3 --set leaf_drag=2"),
        ("--method newmark", "--set method=newmark"),
        ("--longest 0.3 --radius tip", "--set longest=0.3 --set radius=tip"),
    ] {
        let ((typed, typed_files), (set, set_files)) = (made(typed), made(set));
        for key in ["modes", "height_m", "beam_nodes", "radius", "material"] {
            assert_eq!(typed[key], set[key], "{typed} {set}");
        }
        assert_eq!(typed["motion"]["deviation_m"], set["motion"]["deviation_m"], "{set}");
        assert!(typed_files == set_files && set_files[..3] != usual_files[..3], "{set}");
        assert!(typed["motion"]["deviation_m"] != usual["motion"]["deviation_m"], "{typed}");
    }
    // Also where nothing moves.
    let modes = |more: &str| bench.json(&format!("simulate synth::tree:30,1 {more}"))["modes"].clone();
    assert!(modes("--set young=3e9") == modes("--young 3e9") && modes("--young 3e9") != modes(""));
}

/// Khronos's validator finds no error and nothing to warn of, where it is installed.
#[test]
fn a_glb_is_as_the_standard_wants_it() {
    let node = |args: &[&str]| Command::new("node").args(args).current_dir(root()).output();
    let is_there = node(&["-e", "require('gltf-validator')"]).is_ok_and(|output| output.status.success());
    if !is_there {
        return missing("gltf-validator for node (cargo xtask peers)");
    }
    let bench = Bench::new();
    let plants = [
        "synth::tree:2,1 --modes 1 --pull 0.1",
        "synth::tree:2,1",
        "synth::tree:300,2 --forest 5 --wind storm --bend s3",
    ];
    for plant in plants {
        bench.json(&format!("simulate {plant} --seconds 2 --glb sway.glb"));
        let output =
            node(&["tests/peers/glb_validator.cjs", bench.path("sway.glb").to_str().unwrap()]).unwrap();
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["errors"] == 0 && found["warnings"] == 0, "{plant}: {found}");
    }
}
