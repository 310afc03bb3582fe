//! Which bone is which, of what both methods grow in depth, and what is said of hand work.

use honami_model::clip::FrameTimes;
use honami_model::document::ClusteringId;
use honami_model::edit::{Transaction, apply};
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::shape::{Step, transaction};
use honami_model::track::TrackId;
use honami_structure::follow::Path;
use honami_structure::tree::tree;
use honami_structure::zeng;

use super::*;

const ID: ClusteringId = ClusteringId(1);
const N_FRAMES: u32 = 24;

/// Eight tips of a plant that forks in two three times, swaying; each its own group.
fn paths() -> Vec<Path> {
    let at = |tip: u32, t: u32| {
        let sway = 4.0 * (0.4 * f64::from(t) + f64::from(tip)).sin();
        Some([60.0 + 40.0 * f64::from(tip) + sway, 80.0 + 25.0 * f64::from(tip % 3)])
    };
    (0..8).map(|tip| Path { track: TrackId(tip), at: (0..N_FRAMES).map(|t| at(tip, t)).collect() }).collect()
}

/// ((0 1) (2 3)) ((4 5) (6 7)): nodes 8 to 11, 12, 13, and 14 for the whole.
fn dendrogram() -> Dendrogram {
    let pairs = [(0, 1, 2), (2, 3, 2), (4, 5, 2), (6, 7, 2), (8, 9, 4), (10, 11, 4), (12, 13, 8)];
    let rows = (1_u32..).zip(pairs).map(|(height, (a, b, size))| Merge { a, b, height: height.into(), size });
    Dendrogram::new(8, rows.collect()).unwrap()
}

fn groups(k: u32) -> Vec<Group> {
    tree(&dendrogram(), k, &[true; 8])
}

fn times() -> FrameTimes {
    FrameTimes::constant(N_FRAMES, 25.0).unwrap()
}

fn deep() -> (Grown, Vec<Group>) {
    let groups = groups(8);
    let settings = diener::Settings { root: Some([200.0, 400.0]), is_flat: false };
    (diener::grow(&paths(), &groups, &times(), settings).unwrap(), groups)
}

fn names(groups: &[Group]) -> Vec<Bone> {
    named(ID, groups, |node| (node == 5).then_some("bud"))
}

#[test]
fn bones_are_called_by_the_groups_they_bear() {
    let called = |k| names(&groups(k)).into_iter().map(|bone| format!("{} {}", bone.node, bone.name));
    assert_eq!(called(1).collect::<Vec<_>>(), ["14 group 1"]);
    assert_eq!(
        called(8).collect::<Vec<_>>(),
        [
            "14 fork 1-8",
            "12 fork 1-4",
            "8 fork 1,2",
            "0 group 1",
            "1 group 2",
            "9 fork 3,4",
            "2 group 3",
            "3 group 4",
            "13 fork 5-8",
            "10 fork 5,6",
            "4 group 5",
            "5 group 6 bud",
            "11 fork 7,8",
            "6 group 7",
            "7 group 8"
        ]
    );
}

/// Structure builders tell forks of the copy in the picture alone.
#[test]
fn a_mirror_image_has_the_bones_of_what_it_is_an_image_of() {
    let (grown, groups) = deep();
    let joints = grown.skeleton.joints();
    let bones = Bones::of(&grown.skeleton, &names(&groups), &borne(&grown, &groups));
    assert_eq!(bones.known[0], None, "the root has no bone");
    assert!(bones.known[1..].iter().all(Option::is_some), "{:?}", bones.known);
    let half = 1 + (joints.len() - 1) / 2;
    for row in half..joints.len() {
        let of = bones.copy_of[row].unwrap() as usize;
        assert!(bones.copy_of[of].is_none() && of < half);
        assert_eq!(bones.known[row], bones.known[of]);
        for t in 0..N_FRAMES {
            let ([x, y, z], is) = (grown.skeleton.directions(t)[of], grown.skeleton.directions(t)[row]);
            assert_eq!([x, -y, z].map(f64::to_bits), is.map(f64::to_bits), "joint {row} of {of}");
        }
    }
    // Shaped, it is an image still.
    let shape = Shape { plane_rad: 0.8, lean_rad: -0.3, gain: 1.5 };
    let made =
        bones.shaped(&grown.skeleton, |bone| if bone.groups.len() == 2 { shape } else { Shape::default() });
    let made = made.unwrap();
    assert_ne!(made, grown.skeleton);
    for row in half..joints.len() {
        let ([x, y, z], is) =
            (made.directions(7)[bones.copy_of[row].unwrap() as usize], made.directions(7)[row]);
        assert!((0..3).all(|k| ([x, -y, z][k] - is[k]).abs() < 1e-12), "joint {row}");
    }
}

#[test]
fn copies_round_a_trunk_have_the_bones_of_the_one_in_the_picture() {
    let groups = groups(8);
    let settings =
        zeng::Settings { root: Some([200.0, 400.0]), copies: 3, shift: 0.2, ..zeng::Settings::default() };
    let grown = zeng::grow(&paths(), &groups, &times(), &settings).unwrap();
    let bones = Bones::of(&grown.skeleton, &names(&groups), &borne(&grown, &groups));
    let count = |node: u32| bones.known.iter().flatten().filter(|bone| bone.node == node).count();
    assert_eq!(count(14), 1, "the trunk is one");
    for node in 0..14 {
        assert_eq!(count(node), 3, "node {node}");
    }
    // What a copy's bone is on is a copy of what the other is on.
    let parent = |row: usize| grown.skeleton.joints()[row].parent.unwrap_or_default() as usize;
    for (row, of) in bones.copy_of.iter().enumerate().filter_map(|(row, of)| Some((row, (*of)? as usize))) {
        let its = bones.copy_of[parent(row)].map_or(parent(row), |row| row as usize);
        assert_eq!(its, parent(of), "joint {row}");
    }
}

#[test]
fn what_was_laid_over_is_told() {
    let (grown, groups) = deep();
    let bones = names(&groups);
    let bears = borne(&grown, &groups);
    let mut document = Document::new(N_FRAMES);
    let mut act = |transaction: Transaction| _ = apply(&mut document, &transaction).unwrap();
    act(Transaction::show_clustering(ID, 8));
    let shape = Shape { plane_rad: 0.5, ..Shape::default() };
    let elsewhere = Bone { node: 99, ..bones[0].clone() };
    let laid = |document: &Document, root| {
        lay(grown.skeleton.clone(), &bears, (ID, &bones), Some(document), root).unwrap()
    };
    let bare = laid(&document, None);
    assert_eq!((bare.skeleton, bare.hand, bare.notes), (grown.skeleton.clone(), Hand::default(), vec![]));
    for bone in [&bones[1], &bones[11], &elsewhere] {
        let step = Step::Bone(bone.clone(), shape);
        let done = transaction(&document, &step).unwrap();
        apply(&mut document, &done).unwrap();
    }
    let done = laid(&document, Some([200.0, 400.0]));
    assert_ne!(done.skeleton, grown.skeleton);
    assert_eq!(
        done.notes,
        [
            "root placed by hand at 200.0, 400.0; 2 bones shaped by hand: fork 1-4; group 6 bud",
            "1 bone shaped by hand, of groups as they were cut or made otherwise"
        ]
    );
    let wanted = vec![(bones[1].clone(), shape), (bones[11].clone(), shape)];
    assert_eq!(done.hand, Hand { root: Some([200.0, 400.0]), bones: wanted });
    let told = Value::Text("fork 1-4: plane 28.65°; group 6 bud: plane 28.65°".to_owned());
    assert_eq!(done.hand.told(), Some(("shaped", told)));
    // A structure builder that tells of no forks.
    let tips: Vec<(u32, u32)> =
        bears.iter().copied().filter(|(_, row)| groups[*row as usize].children.is_empty()).collect();
    let blind = lay(grown.skeleton.clone(), &tips, (ID, &bones), Some(&document), None).unwrap();
    assert_eq!(blind.notes[0], "1 bone shaped by hand: group 6 bud");
    assert!(blind.notes[1].starts_with("fork 1-4: shaped by hand, but without"), "{:?}", blind.notes);
    let grown_so = lay(grown.skeleton.clone(), &bears, (ID, &bones), None, None).unwrap();
    assert_eq!((grown_so.skeleton, grown_so.notes), (grown.skeleton, vec![]));
}
