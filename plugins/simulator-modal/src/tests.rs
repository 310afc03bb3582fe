//! The plugin through its trait: which rows move how, what it tells of modes, what it refuses.

use honami_plugin::{Node, Wind, testing};

use super::*;

fn node(parent: Option<u32>, position: [f32; 3], radius: f32) -> Node {
    Node { parent, position, radius, track: None }
}

/// A rod of 1 m and 2 cm radius; its fourth node lies where its third lies.
fn rod() -> Vec<Node> {
    let heights = [0.0, 0.1, 0.2, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
    (0..).zip(heights).map(|(k, z)| node(u32::checked_sub(k, 1), [0.0, 0.0, z], 0.02)).collect()
}

fn prepared(settings: &Settings, nodes: &[Node], instances: &[Instance]) -> Result<Modal> {
    let plant = Plant { nodes, instances, max_threads: 1, seed: 1 };
    Modal::prepare(settings, &plant, &testing::cx())
}

fn go(modal: &mut Modal, n: u32, dt: f64, out: &mut [[f32; 3]]) -> Result<()> {
    let wind = Wind { times_s: &[0.0], velocities: &[[8.0, 0.0, 0.0]] };
    modal.step(&Steps { dt, n, wind, detail: None }, out, &testing::cx())
}

#[test]
fn every_row_moves_also_where_nodes_are_merged_or_segments_divided() {
    for longest in [0.0, 0.03] {
        let settings = Settings { longest, modes: 4, ..Settings::default() };
        let mut modal = prepared(&settings, &rod(), &[Instance::default(); 2]).unwrap();
        // (1.8751^2) / 2 pi * sqrt(E r^2 / 4 rho), in both planes.
        let modes = modal.modes();
        assert!((modes[0].hz / 17.695_83 - 1.0).abs() < 1e-3 && modes[0].certified, "{modes:?}");
        let mut out = [[f32::NAN; 3]; 24];
        go(&mut modal, 100, 0.01, &mut out).unwrap();
        let (first, second) = out.split_at(12);
        assert_eq!(first, second, "copies in one wind");
        assert_eq!((first[0], first[2]), ([0.0; 3], first[3]), "the root, and nodes in one place");
        assert!(first.is_sorted_by(|a, b| a[0] <= b[0]) && first[11][0] > 1e-4, "{first:?}");
    }
}

#[test]
fn what_is_pulled_begins_where_it_was_pulled_to_after_a_reset_too() {
    let settings = Settings { pull: 0.1, bend: settings::Bend::Linear, ..Settings::default() };
    let mut modal = prepared(&settings, &rod(), &[Instance::default()]).unwrap();
    let mut out = [[0.0; 3]; 12];
    for _ in 0..2 {
        go(&mut modal, 0, 1.0, &mut out).unwrap();
        let far = out[11].iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((far - 0.1).abs() < 1e-6, "{far}");
        go(&mut modal, 3, 0.01, &mut out).unwrap();
        modal.reset();
    }
}

#[test]
fn a_step_too_long_is_refused_when_it_is_taken_and_with_the_limit() {
    let settings = Settings { method: settings::Method::Symplectic, ..Settings::default() };
    let mut modal = prepared(&settings, &rod(), &[Instance::default()]).unwrap();
    let mut out = [[0.0; 3]; 12];
    let error = go(&mut modal, 1, 1.0, &mut out).unwrap_err().to_string();
    assert!(error.contains("s is wanted, or another method"), "{error}");
    modal.retune(&Settings::default()).unwrap();
    go(&mut modal, 1, 1.0, &mut out).unwrap();
}

#[test]
fn what_is_no_plant_is_refused_in_words() {
    let thin: Vec<Node> = rod().into_iter().map(|node| Node { radius: 0.0, ..node }).collect();
    let one_place: Vec<Node> = rod().into_iter().map(|node| Node { position: [0.0; 3], ..node }).collect();
    for (nodes, wanted) in [
        (&rod()[..1], "a plant has two nodes at least"),
        (&thin, "with radius 0 m"),
        (&one_place, "all nodes of the plant lie in one place"),
    ] {
        let error = prepared(&Settings::default(), nodes, &[Instance::default()]).err().unwrap();
        assert!(error.to_string().contains(wanted), "{error}");
    }
}
