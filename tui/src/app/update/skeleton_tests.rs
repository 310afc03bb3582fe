//! A skeleton is grown when it is shown, anew when what it grows from has changed, and never shown when it is of another.

use std::sync::Arc;

use super::tests::{check, line, start};
use super::{Fact, Msg, State, update};
use crate::app::fixture::{self, press};
use crate::app::skeleton::{Awaited, Bones, Skeletal};
use crate::app::tracks::TrackRow;

#[test]
fn skeletons_are_shown_and_hidden() {
    let growing = "review | frame 0 track 1 | said growing the skeleton of 2 groups … Esc stops";
    for (from, keys, expect) in [
        ("", "v k", growing),
        ("", "G g", growing),
        ("", "v k v k", "review | frame 0 track 1 | said the skeleton is hidden"),
        ("", "v k Esc", "review | frame 0 track 1 | said growing was stopped: no skeleton is shown"),
        (
            "empty",
            "v k",
            "review | frame 0 track - | error a skeleton grows from groups, and there are none: c groups the tracks",
        ),
        ("locked", "v k", growing),
    ] {
        check(from, keys, expect);
    }
}

/// Tells that the world has a skeleton of a revision.
fn grown(state: &mut State, revision: u64, grown: Result<(), &str>) {
    let grown = grown.map(|()| Arc::new(Bones::of(fixture::skeleton::growth()))).map_err(str::to_owned);
    drop(update(state, Msg::Fact(Fact::Grown(revision, grown))));
}

#[test]
fn what_has_grown_is_said_once_and_what_changes_grows_anew() {
    let mut state = start("");
    assert_eq!(Skeletal::request(&mut state), None, "what is not shown does not grow");
    press(&mut state, "v k");
    let first = Skeletal::request(&mut state).expect("a growth");
    assert_eq!(Skeletal::request(&mut state), None, "asked for once");
    grown(&mut state, first, Ok(()));
    let said = "review | frame 0 track 1 | said skeleton: 3 bones of 2 groups, diener, 0.2 s";
    assert_eq!(line(&state, &[]), said);
    assert!(state.skeleton.bones.is_some() && state.skeleton.awaited.is_none());
    // The same tracks and groups once more: nothing to grow.
    let (tracks, groups) = (state.tracks.clone(), state.groups.clone());
    let tell = |state: &mut State, tracks: Vec<TrackRow>, groups| {
        drop(update(state, Msg::Fact(Fact::Tracks(tracks))));
        drop(update(state, Msg::Fact(Fact::Groups(groups))));
    };
    tell(&mut state, tracks.clone(), groups.clone().map(Box::new));
    assert_eq!(Skeletal::request(&mut state), None);
    // Another cut, another name, other samples.
    state.notice = None;
    let cut = Some(Box::new(fixture::groups(3)));
    let mut named = fixture::groups(2);
    named.names[0] = Some("bud".to_owned());
    let moved = |row: &TrackRow| TrackRow::new(row.id, None, Arc::new((*row.span).clone()));
    let moved: Vec<TrackRow> = tracks.iter().map(moved).collect();
    let mut asked = vec![first];
    for (tracks, groups) in [
        (tracks.clone(), cut),
        (tracks.clone(), Some(Box::new(named))),
        (moved, groups.clone().map(Box::new)),
    ] {
        tell(&mut state, tracks, groups);
        asked.push(Skeletal::request(&mut state).expect("another growth"));
        assert_eq!(state.skeleton.awaited, Some(Awaited::Bones));
    }
    // Of those asked for only the newest is taken, and it says nothing where nobody asked.
    let old = state.skeleton.bones.clone();
    asked[..3].iter().for_each(|&revision| grown(&mut state, revision, Err("stopped")));
    assert!(Arc::ptr_eq(&old.unwrap(), state.skeleton.bones.as_ref().unwrap()) && state.notice.is_none());
    grown(&mut state, asked[3], Ok(()));
    assert!(state.skeleton.awaited.is_none() && state.notice.is_none());
    // What fails is said and not shown; without groups there is nothing to grow, until there are some again.
    tell(&mut state, tracks.clone(), Some(Box::new(fixture::groups(3))));
    let revision = Skeletal::request(&mut state).unwrap();
    grown(&mut state, revision, Err("no track of any group is seen"));
    let said = "review | frame 0 track 1 | error no skeleton: no track of any group is seen";
    assert_eq!((line(&state, &[]).as_str(), state.skeleton.bones.is_none()), (said, true));
    tell(&mut state, tracks.clone(), None);
    assert_eq!(Skeletal::request(&mut state), None);
    tell(&mut state, tracks, groups.map(Box::new));
    assert!(Skeletal::request(&mut state).is_some());
}

#[test]
fn what_was_hidden_does_not_come_back() {
    let mut state = start("");
    press(&mut state, "v k");
    let revision = Skeletal::request(&mut state).unwrap();
    press(&mut state, "Esc v k");
    grown(&mut state, revision, Err("stopped"));
    assert_eq!(state.skeleton.awaited, Some(Awaited::Line), "it is the next one that counts");
    let next = Skeletal::request(&mut state).unwrap();
    press(&mut state, "v k");
    grown(&mut state, next, Ok(()));
    assert!(state.skeleton.bones.is_none());
}

/// Joints are where the skeleton has them, in frames of the clip.
#[test]
fn joints_are_in_frames_of_the_clip() {
    let mut growth = fixture::skeleton::growth();
    growth.frames = 12..92;
    let bones = Bones::of(growth);
    assert_eq!((bones.at(11), bones.at(92)), (None, None));
    let [root, fork, .., tip] = bones.at(12).unwrap() else { panic!("four joints") };
    assert_eq!((*root, *fork), ([160.0, 0.0, -210.0], [160.0, 0.0, -150.0]));
    // 120 px from the fork, at 0.8, 0.6: at rest, as the sway of frame 0 of the growth is none.
    assert!((tip[0] - 256.0).abs() < 1e-3 && (tip[2] + 78.0).abs() < 1e-3, "{tip:?}");
    let swung = bones.at(20).unwrap()[3];
    assert!((swung[0] - tip[0]).hypot(swung[2] - tip[2]) > 20.0, "{swung:?}");
}
