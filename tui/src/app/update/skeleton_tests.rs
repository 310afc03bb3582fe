//! A skeleton is grown when it is shown, anew when what it grows from has changed, and never shown when it is of another.

use std::sync::Arc;

use super::tests::{check, line, start};
use honami_model::document::ClusteringId;
use honami_workbench::shape::{Shape, Step};

use super::{Effect, Fact, Mode, Msg, State, update};
use crate::app::fixture::{self, press};
use crate::app::layout::Lens;
use crate::app::skeleton::{Awaited, Bones, Hand, Pose, Skeletal};
use crate::app::tracks::TrackRow;

const LOCKED: &str =
    "review | frame 0 track 1 | error read only: ada on lab2 holds this project; nothing can be changed here";

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
        // The root is placed where it is, or from the middle on, and the skeleton is seen meanwhile.
        ("", "G p 3 l K", "root 163 119.75 | frame 0 track 1"),
        ("", "G p Esc", "review | frame 0 track 1"),
        (
            "",
            "G p 9 9 9 j Enter",
            "review | frame 0 track 1 | Shape(Root(Some([160.0, 239.0])), \"u undoes\")",
        ),
        ("locked", "G p", LOCKED),
        ("", "G R", "review | frame 0 track 1 | Shape(Release, \"u undoes\")"),
        ("locked", "G R", LOCKED),
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
    assert!(state.skeleton.pose.is_some() && state.skeleton.awaited.is_none());
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
fn a_root_is_placed_from_where_it_is() {
    let mut state = start("");
    press(&mut state, "G p");
    fixture::skeleton::grow(&mut state);
    assert!(state.skeleton.bones.is_some(), "it is shown while its root is placed");
    press(&mut state, "Esc G p l");
    assert!(line(&state, &[]).starts_with("root 161 210"), "{}", line(&state, &[]));
    // It is kept where it is moved to, and nowhere else.
    press(&mut state, "Esc");
    let between = Hand { root: Some([12.3, -3.75]), ..Hand::default() };
    drop(update(&mut state, Msg::Fact(Fact::Hand(between))));
    press(&mut state, "G p");
    assert_eq!(line(&state, &[]), "root 12.3 -3.75 | frame 0 track 1");
    let asked = press(&mut state, "Enter");
    assert_eq!(line(&state, &asked), "review | frame 0 track 1 | said the root stays where it is");
    state.notice = None;
    // The project has it elsewhere: it grows anew, from there.
    let hand = Hand { root: Some([12.0, 34.0]), ..Hand::default() };
    drop(update(&mut state, Msg::Fact(Fact::Hand(hand.clone()))));
    assert!(Skeletal::request(&mut state).is_some());
    press(&mut state, "G p");
    assert!(line(&state, &[]).starts_with("root 12 34"), "{}", line(&state, &[]));
    drop(update(&mut state, Msg::Fact(Fact::Hand(hand.clone()))));
    assert_eq!(Skeletal::request(&mut state), None, "the same once more");
    // The mouse puts it where it is clicked, and takes it along.
    let words = ["press:13,1", "drag:40,12", "Enter"];
    let by_mouse: Vec<_> =
        words.into_iter().flat_map(|word| fixture::send(&mut state, fixture::msg(word))).collect();
    let [Effect::Shape(Step::Root(Some(at)), _)] = by_mouse[..] else { panic!("{by_mouse:?}") };
    let lens = Lens::shown(&state);
    assert_eq!(Some(at.map(|v| v as f32)), lens.point_of(40, 12));
    press(&mut state, "G p");
    // What the project refuses can be placed anew.
    press(&mut state, "l Enter");
    drop(update(&mut state, Msg::Fact(Fact::Refused)));
    assert!(line(&state, &[]).starts_with("root 13 34"), "{}", line(&state, &[]));
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
    let pose = Bones::of(growth).pose(|_| Shape::default()).unwrap();
    assert_eq!((pose.at(11), pose.at(92)), (None, None));
    let [root, fork, .., tip] = pose.at(12).unwrap() else { panic!("four joints") };
    assert_eq!((*root, *fork), ([160.0, 0.0, -210.0], [160.0, 0.0, -150.0]));
    // 120 px from the fork, at 0.8, 0.6: at rest, as the sway of frame 0 of the growth is none.
    assert!((tip[0] - 256.0).abs() < 1e-3 && (tip[2] + 78.0).abs() < 1e-3, "{tip:?}");
    let swung = pose.at(20).unwrap()[3];
    assert!((swung[0] - tip[0]).hypot(swung[2] - tip[2]) > 20.0, "{swung:?}");
}

/// The state after some keys, with a skeleton that has grown; and what was asked for.
fn shaped(keys: &str) -> (State, Vec<Effect>) {
    let mut state = start("");
    fixture::skeleton::show(&mut state);
    let effects = press(&mut state, keys);
    (state, effects)
}

#[test]
fn bones_are_shaped_by_keys() {
    for (keys, expect) in [
        // The bone of the selected track's group, or the one that is chosen among the bones.
        ("G b", "shape group 1 bud "),
        ("j j G b", "shape group 2  | frame 0 track 7"),
        ("P s Enter", "shape group 1 bud "),
        ("P s k Enter", "shape fork 1,2 "),
        ("P s j Enter", "shape group 2 "),
        ("P s 9 j Enter Esc", "review"),
        ("P s 9 j P s G b", "shape group 1 bud "),
        ("G b 6 l", "shape group 1 bud plane 30°"),
        ("G b L H H k", "shape group 1 bud plane -0.5°, lean -5°"),
        ("G b 3 J 2 + -", "shape group 1 bud lean 1.5°, gain 1.1"),
        // There and back is nowhere; a plane turned on comes round, and a gain ends.
        ("G b l j + h k -", "shape group 1 bud "),
        ("G b l j + h k - Enter", "review | frame 0 track 1 | said group 1 bud stays as it was"),
        ("G b 3 6 l", "shape group 1 bud plane 180°"),
        ("G b 3 7 l", "shape group 1 bud plane -175°"),
        ("G b 2 0 -", "shape group 1 bud gain 0"),
        ("G b 9 9 9 +", "shape group 1 bud gain 10"),
        ("G b 5 . space", "shape group 1 bud  | frame 5 track 1 | play 1"),
        ("G b l Esc", "review"),
        (
            "G b l Q",
            "shape group 1 bud plane 5° | frame 0 track 1 | error a bone's shape is not kept: Enter keeps, Esc drops, Q again leaves",
        ),
        ("G b l h Q", "shape group 1 bud  | frame 0 track 1 | Leave"),
        // What is open is accepted before bones are shaped, and without a skeleton Enter does what it does elsewhere.
        (
            "P s n Enter",
            "review | frame 70 track 7 | said track 7: frames 40-99, FB LOST (0.85) | track 1 70-79 lost with 1 keys",
        ),
        (
            "P s v k Enter",
            "review | frame 70 track 1 | said track 1: frames 70-79, LOST (0.85), item 1 of 2 of the track",
        ),
        ("G b Enter", "review | frame 0 track 1 | said group 1 bud stays as it was"),
        (
            "v k G b",
            "review | frame 0 track 1 | error no skeleton is shown: v k grows it, and P s lists its bones",
        ),
    ] {
        let (state, effects) = shaped(keys);
        let line = line(&state, &effects);
        let expect =
            if expect.contains(" | ") { expect.to_owned() } else { format!("{expect} | frame 0 track 1") };
        assert_eq!(line, expect, "by `{keys}`");
    }
    check(
        "",
        "G b",
        "review | frame 0 track 1 | error no skeleton is shown: v k grows it, and P s lists its bones",
    );
    check("locked", "G b", LOCKED);
}

/// What is seen while a bone is shaped is what is kept, and until then nothing is.
#[test]
fn a_shape_is_its_preview() {
    let (mut state, _) = shaped("G b");
    let before = state.skeleton.pose.clone().unwrap();
    press(&mut state, "6 l 2 j +");
    assert!(
        Arc::ptr_eq(&before, state.skeleton.pose.as_ref().unwrap()),
        "what is kept is not worked out again"
    );
    assert_eq!(before.moves_deg.len(), 3, "the root does not move");
    let Mode::Shape(shaping) = &state.mode else { panic!("not shaping") };
    let (seen, kept) = (shaping.pose.clone(), state.skeleton.pose.clone().unwrap());
    let bits = |pose: &Pose, row: usize| pose.at(7).unwrap()[row].map(f32::to_bits);
    assert_ne!(bits(&seen, 2), bits(&kept, 2));
    assert_eq!(seen.middle.map(f32::to_bits), kept.middle.map(f32::to_bits), "both are gone round together");
    assert_eq!(bits(&seen, 3), bits(&kept, 3), "of what it does not bear nothing moves");
    let asked = press(&mut state, "Enter");
    let [Effect::Shape(Step::Bone(bone, shape), "u undoes")] = &asked[..] else { panic!("{asked:?}") };
    let wanted = Shape { plane_rad: 30_f64.to_radians(), lean_rad: 10_f64.to_radians(), gain: 1.1 };
    assert_eq!((bone.node, shape.to_string()), (3, wanted.to_string()));
    // Refused, it is open again as it was; kept, it is drawn so, without growing anew.
    drop(update(&mut state, Msg::Fact(Fact::Refused)));
    assert!(line(&state, &[]).starts_with("shape group 1 bud plane 30°, lean 10°, gain 1.1"));
    press(&mut state, "Esc");
    let hand = Hand { root: None, shapes: [(bone.node, *shape)].into() };
    drop(update(&mut state, Msg::Fact(Fact::Hand(hand))));
    assert_eq!(Skeletal::request(&mut state), None);
    assert_eq!(state.skeleton.pose, Some(seen));
    drop(update(&mut state, Msg::Fact(Fact::Hand(Hand::default()))));
    assert_eq!(state.skeleton.pose, Some(kept));
}

#[test]
fn a_skeleton_is_gone_round() {
    for (keys, azimuth) in [
        ("}", 15),
        ("3 {", -45),
        ("1 2 }", 180),
        ("1 3 }", -165),
        ("2 4 }", 0),
        ("} V", 0),
        ("} v k v k", 0),
        ("} Esc", 0),
        ("G b } }", 30),
    ] {
        let (state, _) = shaped(keys);
        assert_eq!(state.skeleton.azimuth, azimuth, "by `{keys}`");
    }
    // What is done in the picture is done from the front, and then it is seen from where it was.
    let (mut state, _) = shaped("2 }");
    for (keys, azimuth) in
        [("m", 0), ("Esc", 30), ("G p", 0), ("Esc", 30), ("G b", 30), ("Esc", 30), (":", 30)]
    {
        press(&mut state, keys);
        assert_eq!(Skeletal::azimuth(&state), azimuth, "after `{keys}`");
    }
    check("", "}", "review | frame 0 track 1 | error there is no skeleton to go round: v k grows it");
    // From the right, what is far away is to the right; what is up stays up.
    let (state, _) = shaped("");
    let pose = state.skeleton.pose.unwrap();
    let [x, y] = pose.middle;
    for (azimuth, seen, behind) in [
        (0, [x + 3.0, 7.0], 5.0),
        (90, [x + 5.0, 7.0], -3.0),
        (180, [x - 3.0, 7.0], -5.0),
        (-90, [x - 5.0, 7.0], 3.0),
    ] {
        let (at, far) = pose.seen([x + 3.0, y + 5.0, -7.0], azimuth);
        let off = [at[0] - seen[0], at[1] - seen[1], far - behind];
        assert!(off.iter().all(|v| v.abs() < 1e-4), "{azimuth}: {at:?} {far}");
    }
}

/// The groups as they are told, of a clustering.
fn regroup(state: &mut State, clustering: u32, k: u32) {
    let mut groups = fixture::groups(k);
    groups.clustering = ClusteringId(clustering);
    drop(update(state, Msg::Fact(Fact::Groups(Some(Box::new(groups))))));
}

#[test]
fn bones_of_other_groups_are_neither_shaped_nor_chosen() {
    let (mut state, _) = shaped("P s k");
    regroup(&mut state, 1, 3);
    assert!(state.skeleton.is_past && Skeletal::current(&state).is_none());
    for _ in ["before it is asked for", "and after"] {
        press(&mut state, "G b");
        assert_eq!(line(&state, &[]), "review | frame 0 track 1 | said the skeleton is still growing");
        // What grows by itself is nothing that Esc stops.
        press(&mut state, "Esc");
        assert!(state.skeleton.is_on);
        Skeletal::request(&mut state);
    }
    let revision = state.skeleton.revision;
    grown(&mut state, revision, Ok(()));
    assert_eq!((state.skeleton.is_past, state.skeleton.chosen), (false, Some(4)), "of the same dendrogram");
    // Of another one the node is another; a list may be open over it.
    let said = "the tracks are grouped otherwise now: the bone's shape is not kept";
    for (keys, clustering, close, expect) in [
        ("G b l", 2, "", format!("review | frame 0 track 1 | error {said}")),
        ("G b l ?", 3, "Esc", "review | frame 0 track 1".to_owned()),
    ] {
        state.notice = None;
        press(&mut state, keys);
        regroup(&mut state, clustering, 3);
        assert!(state.notice.as_ref().is_some_and(|notice| notice.is_error && notice.text == said));
        press(&mut state, close);
        assert_eq!((line(&state, &[]), state.skeleton.chosen), (expect, None), "after `{keys}`");
        fixture::skeleton::grow(&mut state);
    }
}

#[test]
fn the_log_says_what_was_done_before_it_had_grown() {
    let mut state = start("");
    press(&mut state, "v k G b");
    fixture::skeleton::grow(&mut state);
    press(&mut state, "}");
    let done = state.log.lines().iter().filter_map(|line| line.here.as_ref());
    assert_eq!(done.map(|here| here.growing).collect::<Vec<_>>(), [false, true, false]);
}

#[test]
fn hand_work_without_a_bone_is_told() {
    let shape = Shape { plane_rad: 0.5, ..Shape::default() };
    let hand = Hand { root: None, shapes: [(2, shape), (0, shape), (1, shape)].into() };
    let words = Bones::of(fixture::skeleton::growth()).words(&hand);
    let wanted = "skeleton: 3 bones of 2 groups, 1 bone by hand, diener, 0.2 s · 2 bones shaped by hand, but not there in these groups";
    assert_eq!(words, wanted);
}
