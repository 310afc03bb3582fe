//! Structure builders: what goes in comes out, what is no skeleton is named, wherever they work.

use crate::tools::{host, isolating, named, of_zoo, scratch};
use honami_host::sdk::{Language, begin};
use honami_host::{CallContext, Filmed, GroupTree, Grown, HostError, Kind, Tracks, Value, Values};
use honami_model::picture::Gray;
use honami_model::track::{Status, TrackId};
use std::fs;
use std::process::Command;

const SIZE: [u32; 2] = [4, 3];

/// Three tracks over three frames.
fn tracks() -> Tracks {
    let mut tracks = Tracks::new(SIZE[0], SIZE[1], 0, vec![0.0, 0.5, 0.75]);
    for id in [7, 5, 9] {
        tracks.push(id, 1, [(1.0, 1.0, Status::Tracked); 2]);
    }
    tracks
}

/// The whole, and its two parts: the first and the last track, and the one between.
fn groups() -> GroupTree {
    let mut groups = GroupTree::new(3);
    groups.push(None, 0, &[]);
    groups.push(Some(0), 4, &[0, 2]);
    groups.push(Some(0), 1, &[1]);
    groups
}

/// What the stick of the zoo grows in this process, and in one of its own.
fn grow(fault: &str, filmed: &Filmed<'_>) -> [Result<Grown, HostError>; 2] {
    let info = of_zoo(Kind::Structure, "stick");
    let values: Values = [("fault".to_owned(), Value::Text(fault.to_owned()))].into_iter().collect();
    [host(), isolating()].map(|host| {
        let cx = CallContext::silent();
        host.structure(&info, &values, &cx)?.0.run(filmed, &cx)
    })
}

#[test]
fn a_skeleton_comes_checked_with_what_it_bears() {
    let (tracks, groups) = (tracks(), groups());
    let mut pixels = vec![0; 15];
    pixels[7] = 3;
    let mask = Gray { data: &pixels, width: 4, height: 3, stride: 5 };
    let bare = Filmed { tracks: &tracks, groups: &groups, root: None, mask: None };
    let rooted = Filmed { root: Some([2.5, 1.5]), mask: Some(mask), ..bare };
    for (filmed, root, depth) in [(bare, [0.25, 0.0, -3.0], 0.0), (rooted, [2.5, 0.0, -1.5], 3.0)] {
        for grown in grow("none", &filmed) {
            let Grown { skeleton, bears } = grown.unwrap();
            assert_eq!((skeleton.root(), bears), (root, vec![(1, 0), (2, 1), (3, 2)]));
            let joints = skeleton.joints().iter();
            let told: Vec<_> =
                joints.map(|j| (j.parent, j.length, j.groups.clone(), j.tracks.len())).collect();
            let wanted = [
                (None, 0.0, vec![], 0),
                (Some(0), 1.0, vec![], 0),
                (Some(1), 2.0, vec![4], 2),
                (Some(2), 3.0, vec![1], 1),
            ];
            assert_eq!(
                told, wanted,
                "joints bear groups by their numbers; forks are told of, and bear no track"
            );
            assert_eq!(skeleton.joints()[2].tracks, [TrackId(7), TrackId(9)]);
            assert_eq!(skeleton.directions(2)[3..], [[0.2_f64.sin(), 0.0, 0.2_f64.cos()]]);
            let leaves: Vec<_> = skeleton.leaves().iter().map(|leaf| (leaf.track.0, leaf.joint)).collect();
            assert_eq!(leaves, [(7, 2), (5, 3), (9, 2)]);
            assert_eq!(skeleton.leaves()[1].offsets, [0.0, 1.0, 2.0].map(|frame| [frame, depth, 0.5]));
        }
    }
}

#[test]
fn what_is_no_skeleton_is_named() {
    let (tracks, groups) = (tracks(), groups());
    let filmed = Filmed { tracks: &tracks, groups: &groups, root: None, mask: None };
    for (fault, wanted) in [
        ("cycle", "joint 1 has parent 1, which does not come before it"),
        ("roots", "joint 1 has no parent: a skeleton has one root"),
        ("short", "the bone of joint 1 is 0.0 px long"),
        ("endless", "the bone of joint 1 is 1e308 px long, and one above 0, of 1e9 px at most"),
        ("long-root", "gave the root, which has no bone, one of 1 px"),
        ("lost", "joint 1 has no direction in frame 0"),
        ("adrift", "the root lies at [0.25, inf, -3.0] px"),
        ("brief", "8 directions, and 12 were wanted"),
        ("stranger", "let joint 1 of 4 bear group 3 of 3"),
        ("twice", "let joint 1 bear group 0 twice"),
        ("leaf", "committed a leaf of track 3 of 3"),
        ("fall", "committed 7 offsets of 3 leaves, wanted one in each of 3 frames"),
        ("blown", "leaf 1 wants a joint that there is and a place within 1e9 px of it"),
        ("stump", "a skeleton has two joints at least, this one has 1"),
    ] {
        for grown in grow(fault, &filmed) {
            let said = grown.expect_err(fault).to_string();
            assert!(said.contains("misbehaves in run: ") && said.contains(wanted), "{fault}: {said}");
        }
    }
}

#[test]
fn what_nothing_grows_from_is_said_before_the_plugin_sees_it() {
    let (tracks, whole) = (tracks(), groups());
    let filmed = Filmed { tracks: &tracks, groups: &whole, root: None, mask: None };
    let changed = |change: fn(&mut GroupTree)| {
        let mut groups = groups();
        change(&mut groups);
        groups
    };
    let trees = [
        (GroupTree::new(3), "0 groups of 3 of 3 tracks"),
        (GroupTree::new(2), "0 groups of 2 of 3 tracks"),
        (
            changed(|groups| groups.push(Some(5), 5, &[1])),
            "group 3 is part of 5, which does not come before it",
        ),
        (
            changed(|groups| groups.push(None, 5, &[1])),
            "group 3 is part of -1, which does not come before it",
        ),
        (changed(|groups| groups.push(Some(1), 5, &[1])), "track 0 is in group 1, which has parts"),
        (changed(|groups| groups.push(Some(0), 5, &[])), "group 3 has neither tracks nor parts"),
    ];
    let pixels = [0; 8];
    let mask = Gray { data: &pixels, width: 4, height: 2, stride: 4 };
    let trees = trees.iter().map(|(groups, wanted)| (Filmed { groups, ..filmed }, *wanted));
    let others = [
        (Filmed { root: Some([f64::NAN, 0.0]), ..filmed }, "a root at [NaN, 0.0]"),
        (Filmed { mask: Some(mask), ..filmed }, "a mask of 4x2 for frames of 4x3"),
    ];
    for (filmed, wanted) in trees.chain(others) {
        for grown in grow("none", &filmed) {
            let said = grown.expect_err(wanted).to_string();
            assert!(said.contains(wanted), "{said}");
        }
    }
}

/// The template in Python, with a track that comes late, and one that is in no group.
#[test]
fn a_structure_builder_in_python_grows_what_it_sees() {
    let has_numpy = Command::new("python3").args(["-c", "import numpy"]).output();
    if !has_numpy.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: needs python3 with numpy");
        return;
    }
    let begun = begin("fan", Kind::Structure, Language::Python).unwrap();
    let folder = scratch().join("fan");
    fs::create_dir_all(&folder).unwrap();
    begun.files.iter().for_each(|(file, text)| fs::write(folder.join(file), text).unwrap());
    let written = Command::new("python3").args(["fan.py", "--honami-manifest"]).current_dir(&folder).output();
    assert!(written.as_ref().is_ok_and(|output| output.status.success()), "{written:?}");
    let registry = named(&[&folder.join("fan.py")]);
    let info = registry.find(Kind::Structure, "fan").unwrap();

    let mut tracks = Tracks::new(40, 30, 5, vec![0.0, 0.5, 0.75]);
    let at = |x, y| (x, y, Status::Tracked);
    tracks.push(7, 5, [at(10.0, 16.0), at(16.0, 20.0), at(10.0, 16.0)]);
    tracks.push(5, 6, [at(20.0, 10.0), at(20.0, 8.0)]);
    tracks.push(9, 5, [at(0.0, 0.0); 3]);
    let mut groups = GroupTree::new(3);
    groups.push(None, 0, &[]);
    groups.push(Some(0), 1, &[1]);
    groups.push(Some(0), 2, &[0]);
    let filmed = Filmed { tracks: &tracks, groups: &groups, root: Some([10.0, 20.0]), mask: None };
    let cx = CallContext::silent();
    let (mut fan, _) = isolating().structure(info, &Values::default(), &cx).unwrap();
    let Grown { skeleton, bears } = fan.run(&filmed, &cx).unwrap();
    assert_eq!((skeleton.root(), bears), ([10.0, 0.0, -20.0], vec![(1, 1), (2, 2)]));
    let lengths: Vec<f64> = skeleton.joints().iter().map(|joint| joint.length).collect();
    let [long, longer] = [200.0_f64.sqrt(), 244.0_f64.sqrt()];
    let wanted = [0.0, (2.0 * long + longer) / 3.0, 14.0 / 3.0];
    assert!(lengths.iter().zip(wanted).all(|(came, wanted)| (came - wanted).abs() < 1e-12), "{lengths:?}");
    assert_eq!(skeleton.directions(1)[2..], [[1.0, 0.0, 0.0]]);
    assert_eq!(
        skeleton.directions(0)[1..2],
        skeleton.directions(1)[1..2],
        "not seen yet: as when it is first seen"
    );
    let leaf = &skeleton.leaves()[1];
    assert_eq!((leaf.track, leaf.joint, skeleton.leaves().len()), (TrackId(7), 2, 2));
    let end = skeleton.places(skeleton.directions(2))[2];
    assert!((end[2] + leaf.offsets[2][2] + 16.0).abs() < 1e-12, "a leaf is where it is seen: {leaf:?}");
}
