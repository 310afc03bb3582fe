//! Hand work on groups, against sets of leaves that are merged, split and moved about by themselves.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;
use crate::edit::apply;
use crate::hierarchy::Merge;

type Sets = BTreeSet<BTreeSet<u32>>;

const ID: ClusteringId = ClusteringId(4);

fn tree(n: u32, picks: &[(usize, usize, u8)]) -> Dendrogram {
    let mut open: Vec<(u32, u32)> = (0..n).map(|leaf| (leaf, 1)).collect();
    let mut rows = Vec::new();
    for (made, &(a, b, height)) in (n..).zip(picks) {
        let (a, size_a) = open.swap_remove(a % open.len());
        let (b, size_b) = open.swap_remove(b % open.len());
        rows.push(Merge { a, b, height: f64::from(height), size: size_a + size_b });
        open.push((made, size_a + size_b));
    }
    Dendrogram::new(n, rows).unwrap()
}

/// ((0 1) ((2 3) 4)), of tracks 10 to 14.
fn five() -> (Vec<TrackId>, Dendrogram) {
    let merge = |a, b, height, size| Merge { a, b, height, size };
    let rows = vec![merge(0, 1, 1.0, 2), merge(2, 3, 2.0, 2), merge(6, 4, 3.0, 3), merge(5, 7, 4.0, 5)];
    ((10..15).map(TrackId).collect(), Dendrogram::new(5, rows).unwrap())
}

fn cut(k: u32) -> Document {
    let mut document = Document::new(1);
    apply(&mut document, &Transaction::show_clustering(ID, k)).unwrap();
    document
}

fn groups(document: &Document, dendrogram: &Dendrogram) -> Groups {
    dendrogram.groups(document.clustering().unwrap().k, document.held_groups(ID))
}

/// The groups in the order of their numbers, and what they are called.
fn seen(document: &Document, dendrogram: &Dendrogram) -> String {
    let groups = groups(document, dendrogram);
    let one = |(group, main): (u32, u32)| {
        let of = (0..).zip(&groups.of).filter(|(_, of)| **of == group);
        let leaves: String = of.map(|(leaf, _): (u32, _)| leaf.to_string()).collect();
        format!("{leaves}{}", document.group_name(ID, main).map_or(String::new(), |name| format!("={name}")))
    };
    (0..).zip(groups.mains()).map(one).collect::<Vec<_>>().join(" ")
}

fn sets(groups: &Groups) -> Vec<BTreeSet<u32>> {
    let mut sets = vec![BTreeSet::new(); groups.len()];
    (0..).zip(&groups.of).for_each(|(leaf, of)| _ = sets[*of as usize].insert(leaf));
    sets
}

#[test]
fn groups_by_hand() {
    let (tracks, dendrogram) = five();
    let set = |tracks: &[u32]| tracks.iter().copied().map(TrackId).collect::<TrackSet>();
    let name = |group, name: &str| Step::Name(group, Some(name.to_owned()));
    for (k, steps, wanted) in [
        (3, vec![], "01 23 4"),
        (3, vec![Step::Merge(0, 2)], "014 23"),
        // Siblings are their parent again.
        (3, vec![Step::Merge(2, 1), name(1, "right")], "01 234=right"),
        (3, vec![Step::Split(1)], "01 2 3 4"),
        (3, vec![Step::Merge(0, 2), Step::Split(0)], "01 23 4"),
        (3, vec![Step::Take(set(&[11, 13]), 2)], "0 134 2"),
        (2, vec![Step::Take(set(&[10, 11]), 1)], "01234"),
        (3, vec![Step::Merge(0, 2), Step::Release], "01 234"),
        // The larger keeps its name, else the other, and what loses a track its own.
        (3, vec![name(0, "a"), name(2, "b"), Step::Merge(0, 2)], "014=a 23"),
        (3, vec![name(2, "b"), Step::Merge(0, 2)], "014=b 23"),
        (2, vec![name(1, "b"), Step::Take(set(&[12]), 0)], "012 34=b"),
        (2, vec![name(1, "b"), Step::Split(1)], "01 23 4"),
    ] {
        let mut document = cut(k);
        let mut undo = Vec::new();
        for step in &steps {
            let made = transaction(&document, (&tracks, &dendrogram), step).unwrap();
            undo.push((document.clone(), apply(&mut document, &made).unwrap()));
        }
        assert_eq!(seen(&document, &dendrogram), wanted, "{steps:?} at {k}");
        while let Some((before, inverse)) = undo.pop() {
            apply(&mut document, &inverse).unwrap();
            assert_eq!(document, before, "{steps:?} taken back");
        }
    }
}

#[test]
fn a_cut_leaves_what_was_made_by_hand() {
    let (tracks, dendrogram) = five();
    let mut document = cut(3);
    let made = transaction(&document, (&tracks, &dendrogram), &Step::Merge(0, 2)).unwrap();
    assert_eq!(made.label, "groups 1 and 3 merged: 3 tracks");
    apply(&mut document, &made).unwrap();
    for (k, wanted) in [(1, "014 23"), (2, "014 23"), (3, "014 2 3"), (9, "014 2 3")] {
        apply(&mut document, &Transaction::set_cut(k)).unwrap();
        assert_eq!(seen(&document, &dendrogram), wanted, "at {k}");
    }
}

#[test]
fn what_would_change_nothing_is_refused() {
    let (tracks, dendrogram) = five();
    let of = |track| TrackSet::from(TrackId(track));
    for (step, wanted) in [
        (Step::Merge(0, 3), "there are groups 1 to 3, no group 4"),
        (Step::Merge(1, 1), "group 2 is one group already: two are wanted"),
        (Step::Split(2), "group 3 is one track: there is nothing to split"),
        (Step::Take(of(9), 0), "track 9 is in no group: cluster the tracks again with it"),
        (Step::Take(of(10), 0), "track 10: in group 1 already"),
        (Step::Take(of(10), 7), "there are groups 1 to 3, no group 8"),
        (Step::Release, "no group was made by hand: they are those of the cut"),
        (Step::Name(3, None), "there are groups 1 to 3, no group 4"),
    ] {
        let refused = transaction(&cut(3), (&tracks, &dendrogram), &step).unwrap_err();
        assert_eq!(refused.to_string(), wanted);
    }
    let nothing = transaction(&Document::new(1), (&tracks, &dendrogram), &Step::Release);
    assert_eq!(nothing, Err(Refused::NoGroups));
}

proptest! {
    /// Whatever is done, to any tree at any cut: what it is done to becomes what it should, all else stays.
    #[test]
    fn other_groups_stay(
        picks in prop::collection::vec((0_usize..99, 0_usize..99, 0_u8..6), 1..24),
        k in 1_u32..12,
        steps in prop::collection::vec((0_u8..4, 0_u32..99, 0_u32..99), 1..12),
    ) {
        let n = picks.len() as u32 + 1;
        let dendrogram = tree(n, &picks);
        let tracks: Vec<TrackId> = (0..n).map(TrackId).collect();
        let mut document = cut(k);
        for (what, a, b) in steps {
            let before = sets(&groups(&document, &dendrogram));
            let n_groups = before.len() as u32;
            let (a, b) = (a % n_groups, b % n_groups);
            let leaf = b * 7 % n;
            let step = match what {
                0 => Step::Merge(a, b),
                1 => Step::Split(a),
                2 => Step::Take(TrackId(leaf).into(), a),
                _ => Step::Take([leaf, (leaf + 1) % n].into_iter().map(TrackId).collect(), a),
            };
            let Ok(made) = transaction(&document, (&tracks, &dendrogram), &step) else { continue };
            apply(&mut document, &made).unwrap();
            let now = groups(&document, &dendrogram);
            let after: Sets = sets(&now).into_iter().collect();
            prop_assert_eq!(document.clustering().unwrap().k as usize, now.len(), "{:?}", step);
            let mut wanted: Sets = before.iter().cloned().collect();
            match &step {
                Step::Merge(a, b) => {
                    wanted.remove(&before[*a as usize]);
                    wanted.remove(&before[*b as usize]);
                    wanted.insert(&before[*a as usize] | &before[*b as usize]);
                }
                Step::Take(taken, into) => {
                    let taken: BTreeSet<u32> = taken.iter().map(|track| track.0).collect();
                    wanted = before.iter().map(|set| set - &taken).filter(|set| !set.is_empty()).collect();
                    wanted.remove(&(&before[*into as usize] - &taken));
                    wanted.insert(&before[*into as usize] | &taken);
                }
                _ => {
                    let whole = &before[a as usize];
                    wanted.remove(whole);
                    let parts: Vec<_> = after.difference(&wanted).cloned().collect();
                    prop_assert_eq!(parts.len(), 2);
                    prop_assert_eq!(&(&parts[0] | &parts[1]), whole);
                    wanted.extend(parts);
                }
            }
            prop_assert_eq!(&after, &wanted, "{:?}", step);
            for (group, nodes) in now.nodes.iter().enumerate() {
                let leaves: BTreeSet<u32> = nodes.iter().flat_map(|node| dendrogram.leaves(*node)).collect();
                prop_assert_eq!(&leaves, &sets(&now)[group]);
                prop_assert!(nodes.is_sorted_by_key(|node| std::cmp::Reverse(dendrogram.size(*node))));
            }
        }
    }
}
