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

/// With leaves, twigs of no length, copies of several sizes and masses, in gusts: the plugin is the forest of the library, to
/// the bit.
#[test]
fn the_plugin_moves_as_the_forest_does() {
    let mut nodes = rod();
    nodes.extend([node(Some(5), [0.0, 0.0, 0.4], 0.02), node(Some(5), [0.2, 0.1, 0.5], 0.01)]);
    nodes.extend([node(Some(13), [0.2, 0.1, 0.5], 0.01), node(Some(11), [0.0, 0.0, 1.0], 0.005)]);
    let instances: Vec<Instance> = (0..5)
        .map(|k| Instance { yaw: k as f32, scale: 1.0 + 0.3 * k as f32, mass: 1.0 + 0.1 * k as f32 })
        .collect();
    let settings = Settings {
        leaf_mass: 0.3,
        leaf_drag: 0.2,
        drag: 0.8,
        air_density: 1.3,
        modes: 6,
        pull: 0.05,
        ..Settings::default()
    };
    let mut modal = prepared(&settings, &nodes, &instances).unwrap();

    let measured = plant::Plant::new(
        nodes
            .iter()
            .map(|node| plant::Node {
                parent: node.parent,
                position: node.position.map(f64::from),
                radius: f64::from(node.radius),
            })
            .collect(),
    );
    let mut beams = Beams::new(&measured.unwrap(), &settings.options()).unwrap();
    let drag = Leaves { mass: 0.3, drag: 0.2 }.hang(&mut beams).unwrap();
    let drag = Drag { branches: 0.8, density: 1.3, ..drag };
    assert_eq!(drag.leaves.len(), 2, "the end of the rod, and of its twig");
    let modes = Modes::new(&beams, 6, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &drag);
    let stirring = Stirring::new(&beams, &modes, basis, settings.form());
    let stands: Vec<Stand> = instances.iter().map(stand).collect();
    let pace = Pace { step: 0.02, ..settings.pace() };
    let mut forest = Forest::new(&stirring, beams.of_plant(), &stands, &pace).unwrap();
    forest.pull_all(&stirring.pulled(0.05).unwrap());

    let threads = Threads::new(1).unwrap();
    let [mut ours, mut theirs] = [0; 2].map(|_| vec![[0.0; 3]; 5 * nodes.len()]);
    for frame in 0..20 {
        let velocities: Vec<[f32; 3]> = (0..5).map(|k| [frame as f32, 3.0 - k as f32, 0.5]).collect();
        let wind = Wind { times_s: &[0.0], velocities: &velocities };
        modal.step(&Steps { dt: 0.02, n: 1, wind, detail: None }, &mut theirs, &testing::cx()).unwrap();
        let blowing = |copy: usize| Vector::from(velocities[copy].map(f64::from));
        let pose = Pose { details: None, motion: &mut ours };
        forest.step(&blowing, Some(pose), &threads).unwrap();
        assert!(ours == theirs, "frame {frame}");
    }
    assert_eq!(modal.save().unwrap(), forest.save());
    assert!(ours.as_flattened().iter().any(|v| v.abs() > 1e-3), "they move");
}

/// Everything that is kept while plants move, and what is written of them: positions, the matrix of the plant, two numbers a
/// mode, and a tenth of it for the rest.
#[test]
fn a_running_plant_keeps_little_more_than_its_positions() {
    let (k, n, m) = (1500, 60, 10);
    let nodes: Vec<Node> =
        (0..n as u32).map(|k| node(k.checked_sub(1), [0.0, 0.0, k as f32 / 60.0], 0.02)).collect();
    for bend in [settings::Bend::Turn, settings::Bend::S3, settings::Bend::Linear] {
        let settings = Settings { modes: m as i64, bend, ..Settings::default() };
        let mut modal = prepared(&settings, &nodes, &vec![Instance::default(); k]).unwrap();
        let mut out = vec![[0.0; 3]; k * n];
        go(&mut modal, 1, 0.01, &mut out).unwrap();
        let Modal { forest, pace, modes, pulled, threads, details } = &modal;
        let bytes = forest.bytes()
            + size_of_val(modes.as_slice())
            + size_of_val(pulled.as_slice())
            + size_of_val(details.as_slice())
            + size_of_val(pace)
            + size_of_val(threads)
            + size_of_val(out.as_slice());
        let bound = 1.1 * ((k * n * 3 + n * m * 9 + k * m * 2) * 4) as f64;
        assert!((bytes as f64) < bound, "{bytes} of {bound}");
    }
}
