//! What keys do to groups. The fixture: tracks 1 and 2 are a group, 7 is one by itself.

use super::tests::{line, start};
use crate::app::fixture::{self, press};

#[test]
fn groups_by_hand() {
    for (from, keys, expect) in [
        ("", "G m Enter", "Regroup(Merge(0, 1), \"u undoes\")"),
        ("", "j j G m Enter", "Regroup(Merge(1, 0), \"u undoes\")"),
        ("", "G s", "Regroup(Split(0), \"u undoes\")"),
        ("", "G t Enter", "Regroup(Take(TrackSet([1..=1]), 1), \"u undoes\")"),
        ("", "y j y G t Enter", "Regroup(Take(TrackSet([1..=2]), 1), \"u undoes\")"),
        ("", "G n l e f t Enter", "Regroup(Name(0, Some(\"left\")), \"u undoes\")"),
        ("", "G n Enter", "review"),
        ("", "G n x Esc", "review"),
        ("", "G n x", "name of the group \"x\""),
        ("", "G r", "error no group was made by hand: G m merges, G s splits, G t takes tracks into another"),
        ("empty", "G s", "error the selected track is in no group: c groups the tracks"),
        ("locked", "G m", "error read only: ada on lab2 holds this project; nothing can be changed here"),
        ("locked", "G r", "error read only: ada on lab2 holds this project; nothing can be changed here"),
        ("", "+", "commit cut into 3 groups"),
        ("", "9 9 -", "commit cut into 1 group"),
    ] {
        let mut state = start(from);
        let effects = press(&mut state, keys);
        let seen = line(&state, &effects);
        assert!(seen.split(" | ").any(|part| part == expect), "{seen} by `{keys}`, not {expect}");
    }
}

#[test]
fn what_is_held_stays_when_the_cut_moves() {
    let mut state = start("");
    let groups = fixture::groups(3);
    let tree = (groups.clustering, groups.tracks.clone(), groups.dendrogram.clone());
    let mut groups = crate::app::groups::Groups::new(groups.what, tree, (2, &[vec![0, 2]]), Vec::new());
    groups.names[0] = Some("left".to_owned());
    state.groups = Some(groups);
    for (keys, expect) in [
        ("+", "said 2 groups is as far as it goes: those made by hand stay"),
        ("-", "said 2 groups is as far as it goes: those made by hand stay"),
        ("G n", "name of the group \"left\""),
        ("Esc G r", "Regroup(Release, \"u undoes\")"),
    ] {
        let effects = press(&mut state, keys);
        let seen = line(&state, &effects);
        assert!(seen.split(" | ").any(|part| part == expect), "{seen} by `{keys}`, not {expect}");
    }
}
