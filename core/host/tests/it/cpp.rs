//! Plugins in C++ that have all that the header for C++ offers: detection, dense motion, state, clusterers,
//! structure builders.

use crate::tools::{has_compiler, host, isolating, named, pixels, point, scratch, start_in, stream, view};
use honami_host::{
    CallContext, DetectRequest, Filmed, GroupTree, Host, HostError, Kind, Registry, Tracker, Tracks, Value,
};
use honami_model::picture::Gray;
use honami_model::track::Status;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

/// The library; `None` without a compiler for C++.
fn every() -> Option<Registry> {
    static BUILT: OnceLock<bool> = OnceLock::new();
    let library = scratch().join("every.so");
    let is_built = BUILT.get_or_init(|| {
        if !has_compiler("c++") {
            return false;
        }
        std::fs::create_dir_all(scratch()).unwrap();
        let output = Command::new("c++")
            .args(["-std=c++17", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"])
            .args(["-fvisibility=hidden", "-fvisibility-inlines-hidden", "-I", "../abi/include"])
            .args([Path::new("tests/cpp/every.cpp"), Path::new("-o"), &library])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        true
    });
    is_built.then(|| named(&[&library]))
}

fn faster(registry: &Registry, host: &Host, settings: &[&str]) -> Tracker {
    start_in(host, registry.find(Kind::Tracker, "faster").unwrap(), settings).unwrap()
}

fn xs(tracker: &mut Tracker, frames: std::ops::Range<i64>) -> Vec<f32> {
    let cx = CallContext::silent();
    let all = frames.flat_map(|n| tracker.push(&view(&pixels(n), n), &cx).unwrap());
    all.flat_map(|points| points.rows).map(|row| row.x).collect()
}

#[test]
fn what_a_class_has_is_in_its_manifest() {
    let Some(registry) = every() else { return };
    assert!(registry.problems().is_empty(), "{:?}", registry.problems());
    let interfaces = |kind, name| registry.find(kind, name).unwrap().interfaces.clone();
    assert_eq!(
        interfaces(Kind::Tracker, "faster"),
        ["honami.tracker/1", "honami.detect/1", "honami.field/1", "honami.state/1"]
    );
    assert_eq!(interfaces(Kind::Clusterer, "chain"), ["honami.clusterer/1"]);
    assert_eq!(interfaces(Kind::Structure, "fan"), ["honami.structure/1"]);
}

#[test]
fn a_tracker_in_cpp_detects_and_measures_dense_motion() {
    let Some(registry) = every() else { return };
    let cx = CallContext::silent();
    for host in [host(), isolating()] {
        let mut tracker = faster(&registry, &host, &[]);
        let mut bright = vec![10; 32];
        (bright[9], bright[20], bright[30]) = (90, 200, 100);
        let mut mask = vec![1; 32];
        mask[30] = 0;
        let wanted = DetectRequest {
            frame: view(&bright, 0),
            max_features: 5,
            mask: Some(Gray::packed(&mask, 8, 4)),
            points: &[],
            max_threads: 1,
            seed: 1,
        };
        let places = |tracker: &mut Tracker, wanted: &DetectRequest<'_>| -> Vec<[f32; 3]> {
            let found = tracker.detect(wanted, &cx).unwrap();
            found.iter().map(|feature| [feature.x, feature.y, feature.score]).collect()
        };
        assert_eq!(places(&mut tracker, &wanted), [[4.0, 2.0, 200.0], [1.0, 1.0, 90.0]]);
        let few = DetectRequest { max_features: 1, points: &[point(7, 4.0, 2.0)], ..wanted };
        assert_eq!(places(&mut tracker, &few), [[1.0, 1.0, 90.0]]);
        let field = tracker.field(&view(&bright, 0), &view(&[30; 32], 1), 1, &cx).unwrap();
        assert_eq!((field.origin, field.step, field.nx, field.ny), ([0.5, 1.0], 2.0, 4, 2));
        let row = |down: f32, third: f32| [Some([20.0, down]), Some([20.0, down]), Some([third, down]), None];
        assert_eq!(field.vectors, [row(0.0, 20.0), row(1.0, -170.0)].concat());
    }
}

#[test]
fn a_tracker_in_cpp_goes_on_from_what_it_saved_and_takes_nothing_else() {
    let Some(registry) = every() else { return };
    let cx = CallContext::silent();
    for host in [host(), isolating()] {
        let begun = |settings: &[&str]| {
            let mut tracker = faster(&registry, &host, settings);
            tracker.begin(stream(), &cx).unwrap();
            tracker
        };
        let mut tracker = begun(&["from=0.3"]);
        tracker.seed(&[point(5, 0.1, 0.7), point(9, 1.3, 1.9)], &cx).unwrap();
        let first = xs(&mut tracker, 0..3);
        assert_eq!(first.len(), 6);
        let saved = tracker.save(&cx).unwrap();
        let rest = xs(&mut tracker, 3..6);
        let mut other = begun(&["from=0.3"]);
        for bit in [0, 70, 140, 8 * saved.bytes.len() - 1] {
            let mut damaged = saved.clone();
            damaged.bytes[bit / 8] ^= 1 << (bit % 8);
            let why = other.load(&damaged, &cx).unwrap_err().to_string();
            assert!(why.contains("what was saved is cut or damaged"), "{why}");
        }
        other.load(&saved, &cx).unwrap();
        assert_eq!(xs(&mut other, 3..6), rest);
        let why = begun(&["from=0.4"]).load(&saved, &cx).unwrap_err().to_string();
        assert!(why.contains("of other parameters"), "{why}");
    }
}

#[test]
fn a_clusterer_in_cpp_gives_a_tree_and_says_why_it_cannot() {
    let Some(registry) = every() else { return };
    let info = registry.find(Kind::Clusterer, "chain").unwrap();
    let cx = CallContext::silent();
    for host in [host(), isolating()] {
        let (mut clusterer, _) = host.clusterer(info, &honami_host::Values::default(), &cx).unwrap();
        let mut tracks = Tracks::new(8, 4, 10, vec![0.5, 1.0]);
        tracks.push(4, 10, [(1.0, 1.0, Status::Tracked), (2.0, 1.0, Status::Tracked)]);
        let alone = clusterer.run(&tracks, &cx).unwrap_err();
        assert!(
            matches!(&alone, HostError::Failed { text, .. } if text == "one alone is no group"),
            "{alone}"
        );
        tracks.push(6, 10, [(4.0, 1.0, Status::Tracked), (5.0, 1.0, Status::Tracked)]);
        tracks.push(8, 10, [(6.0, 1.0, Status::Tracked), (7.0, 1.0, Status::Lost)]);
        let (mut clusterer, _) = host.clusterer(info, &honami_host::Values::default(), &cx).unwrap();
        let found = clusterer.run(&tracks, &cx).unwrap();
        let merges = found.dendrogram.merges().iter().map(|m| (m.a, m.b, m.height, m.size));
        assert_eq!(merges.collect::<Vec<_>>(), [(0, 1, 3.0, 2), (3, 2, 5.0, 3)]);
        let frames = found.frames.iter().map(|note| (note.frame, note.outlier, note.distance));
        assert_eq!(frames.collect::<Vec<_>>(), [(10, false, 0.5), (11, true, 1.0)]);
    }
}

#[test]
fn a_structure_builder_in_cpp_gives_a_skeleton_and_says_why_it_cannot() {
    let Some(registry) = every() else { return };
    let info = registry.find(Kind::Structure, "fan").unwrap();
    let cx = CallContext::silent();
    let mut tracks = Tracks::new(8, 4, 0, vec![0.5, 1.0]);
    tracks.push(4, 0, [(5.0, 1.0, Status::Tracked), (2.0, 4.0, Status::Tracked)]);
    tracks.push(6, 0, [(2.0, 2.0, Status::Tracked), (6.0, 1.0, Status::Tracked)]);
    let mut groups = GroupTree::new(2);
    groups.push(None, 9, &[]);
    groups.push(Some(0), 2, &[1]);
    groups.push(Some(0), 7, &[0]);
    let black = [0; 32];
    let filmed = Filmed {
        tracks: &tracks,
        groups: &groups,
        root: Some([2.0, 1.0]),
        mask: Some(Gray::packed(&black, 8, 4)),
    };
    for host in [host(), isolating()] {
        let grow = |filmed: &Filmed<'_>| {
            let (mut fan, _) = host.structure(info, &honami_host::Values::default(), &cx).unwrap();
            fan.run(filmed, &cx)
        };
        for (fault, wanted) in [
            ("joint", "joint 1000000 of 3 was placed in frame 1 of 2"),
            ("leaf", "leaf 1000000 of 2 was placed in frame 1 of 2"),
            ("frame", "joint 1 of 3 was placed in frame 1000000 of 2"),
            ("nowhere", "joint 1 is pointed nowhere in frame 1"),
            ("endless", "joint 2 is pointed nowhere in frame 0"),
        ] {
            let values = [("fault".to_owned(), Value::Text(fault.to_owned()))].into_iter().collect();
            let (mut fan, _) = host.structure(info, &values, &cx).unwrap();
            let error = fan.run(&filmed, &cx).unwrap_err();
            assert!(
                matches!(&error, HostError::Failed { text, .. } if text.starts_with(wanted)),
                "{fault}: {error}"
            );
        }
        let rootless = grow(&Filmed { root: None, ..filmed }).unwrap_err();
        assert!(
            matches!(&rootless, HostError::Failed { text, .. } if text == "a fan wants a root"),
            "{rootless}"
        );
        let grown = grow(&filmed).unwrap();
        let skeleton = &grown.skeleton;
        assert_eq!((skeleton.root(), &grown.bears[..]), ([2.0, 5.0, -1.0], &[(1, 1), (2, 2)][..]));
        assert_eq!(skeleton.directions(0)[1..], [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]);
        assert_eq!(skeleton.directions(1)[1..], [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
        let joints = skeleton.joints().iter().map(|joint| (joint.parent, joint.length, joint.groups.clone()));
        assert_eq!(
            joints.collect::<Vec<_>>(),
            [(None, 0.0, vec![]), (Some(0), 1.0, vec![2]), (Some(0), 1.0, vec![7])]
        );
        let leaves = skeleton.leaves().iter().map(|leaf| (leaf.track.0, leaf.joint, leaf.offsets.clone()));
        let wanted =
            [(6, 1, vec![[2.0, 0.5, 2.0], [6.0, 0.5, 1.0]]), (4, 2, vec![[5.0, 0.5, 1.0], [2.0, 0.5, 4.0]])];
        assert_eq!(leaves.collect::<Vec<_>>(), wanted);
    }
}
