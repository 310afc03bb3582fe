//! What edits do, refuse, and take back.

use proptest::prelude::*;

use super::{Edit, EditError, Transaction, apply};
use crate::document::{ClusteringId, Document, Key, Made, MatteId, Origin, RunId, ShownClustering};
use crate::judgement::{Effort, Judgement, Verdict};
use crate::over::{Laid, Over};
use crate::scale::ScaleBar;
use crate::shape::Shape;
use crate::track::{Quality, Sample, Source, Status, TrackId, TrackSet};

const N_FRAMES: u32 = 8;

fn set(tracks: std::ops::Range<u32>) -> TrackSet {
    tracks.map(TrackId).collect()
}

/// A document with a hand-placed track 0 and tracks 1..5 of run 1.
fn small() -> Document {
    let mut document = Document::new(N_FRAMES);
    for step in [Transaction::add_track(TrackId(0), 2, 3.0, 4.0), Transaction::show_run(RunId(1), set(1..5))]
    {
        apply(&mut document, &step).expect("a valid beginning");
    }
    document
}

fn any_edit() -> impl Strategy<Value = Edit> {
    let track = || (0_u32..7).prop_map(TrackId);
    let tracks = || (0_u32..7, 1_u32..4).prop_map(|(start, n)| set(start..start + n));
    let run = || (1_u32..4).prop_map(RunId);
    let name = || prop::option::of("[a-b]{0,2}");
    let made = prop_oneof![Just(Made::Set), Just(Made::Confirmed)];
    let x = prop_oneof![9 => -9.0_f32..99.0, 1 => Just(f32::NAN)];
    let key = (x, 0.0_f32..99.0, made).prop_map(|(x, y, made)| Key { made, ..Key::set(x, y) });
    let shown = (1_u32..3, 0_u32..4).prop_map(|(id, k)| ShownClustering { id: ClusteringId(id), k });
    prop_oneof![
        track().prop_map(|track| Edit::AddTrack { track }),
        track().prop_map(|track| Edit::RemoveTrack { track }),
        tracks().prop_map(|tracks| Edit::DeleteTracks { tracks }),
        tracks().prop_map(|tracks| Edit::RestoreTracks { tracks }),
        (track(), name()).prop_map(|(track, name)| Edit::NameTrack { track, name }),
        (track(), 0..N_FRAMES + 1, key).prop_map(|(track, frame, key)| Edit::SetKey { track, frame, key }),
        (track(), 0..N_FRAMES).prop_map(|(track, frame)| Edit::ClearKey { track, frame }),
        (track(), 0..N_FRAMES, prop::collection::vec(any_over(), 0..4))
            .prop_map(|(track, first_frame, over)| Edit::Lay { track, first_frame, over }),
        (track(), 0..N_FRAMES, prop::option::of(0_u32..N_FRAMES + 2)).prop_map(
            |(track, first_frame, end)| { Edit::Judge { track, first_frame, judgement: end.map(judgement) } }
        ),
        (run(), tracks(), prop::option::of(0_u32..3)).prop_map(|(run, tracks, above)| Edit::ShowRun {
            run,
            tracks,
            above
        }),
        (run(), prop_oneof![Just(TrackSet::default()), tracks()])
            .prop_map(|(run, forget)| Edit::HideRun { run, forget }),
        prop::option::of(shown).prop_map(|clustering| Edit::ShowClustering { clustering }),
        (0_u32..4).prop_map(|k| Edit::SetCut { k }),
        (1_u32..3, 0_u32..5, name()).prop_map(|(id, node, name)| Edit::NameGroup {
            clustering: ClusteringId(id),
            node,
            name
        }),
        (1_u32..3, prop::collection::vec(prop::collection::vec(0_u32..9, 0..3), 0..3))
            .prop_map(|(id, groups)| Edit::HoldGroups { clustering: ClusteringId(id), groups }),
        prop::option::of([any_number(), any_number()]).prop_map(|root| Edit::PlaceRoot { root }),
        prop::option::of((0..N_FRAMES + 1, any_number(), any_number())).prop_map(|bar| Edit::SetScale {
            bar: bar.map(|(frame, x, length_m)| ScaleBar {
                frame,
                ends: [[0.0, 1.0], [x, 9.0]],
                length_m,
                length_error_m: 0.0,
                end_error_px: 0.5,
            }),
        }),
        (1_u32..3, 0_u32..5, prop::option::of(any_shape())).prop_map(|(id, node, shape)| Edit::ShapeBone {
            clustering: ClusteringId(id),
            node,
            shape
        }),
        (0..N_FRAMES + 1, prop::option::of((0_u32..3).prop_map(MatteId)))
            .prop_map(|(frame, matte)| Edit::KeepMatte { frame, matte }),
    ]
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![9 => -2.5_f64..5.0, 1 => Just(f64::NAN)]
}

fn any_shape() -> impl Strategy<Value = Shape> {
    [any_number(), any_number(), any_number()].prop_map(|[plane_rad, lean_rad, gain]| Shape {
        plane_rad,
        lean_rad,
        gain,
    })
}

fn any_over() -> impl Strategy<Value = Option<Over>> {
    let x = prop_oneof![9 => -9.0_f32..99.0, 1 => Just(f32::NAN)];
    let laid = x.prop_map(|x| {
        let (status, source) = (Status::Tracked, Source::Sketch);
        let sample = Sample { x, y: 0.0, status, source, quality: Quality::default() };
        Some(Over::Sample(Laid { sample, run: None }))
    });
    prop_oneof![2 => laid, 1 => Just(Some(Over::Nothing)), 1 => Just(None)]
}

fn judgement(end_frame: u32) -> Judgement {
    Judgement {
        end_frame,
        verdict: Verdict::Fixed,
        reasons: vec!["FB".to_owned()],
        reviewer: "ana".to_owned(),
        time: "2026-11-22T00:00:00Z".to_owned(),
        effort: Effort::default(),
        seal: Some(7),
    }
}

proptest! {
    /// Over random histories: what fails changes nothing, what succeeds can be taken back and done again,
    /// one by one, and it is what was written to the file.
    #[test]
    fn inverse_takes_back_exactly(
        steps in prop::collection::vec(prop::collection::vec(any_edit(), 1..4), 1..40)
    ) {
        let mut document = small();
        let mut done = Vec::new();
        for edits in steps {
            let before = document.clone();
            let transaction = Transaction::new("step", edits);
            match apply(&mut document, &transaction) {
                Err(_) => prop_assert_eq!(&document, &before),
                Ok(inverse) => {
                    let json = serde_json::to_string(&(&transaction, &inverse)).unwrap();
                    let (forward, back): (Transaction, Transaction) = serde_json::from_str(&json).unwrap();
                    prop_assert_eq!((&forward, &back), (&transaction, &inverse));
                    let mut again = document.clone();
                    prop_assert_eq!(apply(&mut again, &back).map(|t| t.label), Ok("step".to_owned()));
                    prop_assert_eq!(&again, &before);
                    prop_assert_eq!(apply(&mut again, &forward), Ok(inverse.clone()));
                    prop_assert_eq!(&again, &document);
                    done.push((before, inverse));
                }
            }
        }
        while let Some((before, inverse)) = done.pop() {
            prop_assert!(apply(&mut document, &inverse).is_ok());
            prop_assert_eq!(&document, &before);
        }
    }
}

#[test]
fn refuses_and_says_why() {
    let key = |x| Key::set(x, 0.0);
    let cases = [
        (Edit::AddTrack { track: TrackId(3) }, "track 3 exists already; reserve a new number"),
        (Edit::RemoveTrack { track: TrackId(0) }, "track 0 has hand work; delete it instead"),
        (Edit::RemoveTrack { track: TrackId(1) }, "track 1 is in run 1; delete it instead"),
        (Edit::DeleteTracks { tracks: set(4..7) }, "there is no track 5"),
        (Edit::RestoreTracks { tracks: set(1..2) }, "track 1 is not deleted"),
        (
            Edit::SetKey { track: TrackId(1), frame: N_FRAMES, key: key(1.0) },
            "frame 8 is beyond the clip, whose last frame is 7",
        ),
        (
            Edit::SetKey { track: TrackId(1), frame: 3, key: key(f32::INFINITY) },
            "track 1: the position at frame 3 is not finite",
        ),
        (Edit::ClearKey { track: TrackId(1), frame: 3 }, "track 1 has no key-frame at 3"),
        (
            Edit::Lay { track: TrackId(1), first_frame: 3, over: vec![] },
            "a range of frames is wanted; this one is empty",
        ),
        (
            Edit::Lay { track: TrackId(1), first_frame: N_FRAMES - 1, over: vec![None, None] },
            "frame 8 is beyond the clip, whose last frame is 7",
        ),
        (
            Edit::Judge { track: TrackId(1), first_frame: 3, judgement: Some(judgement(3)) },
            "a range of frames is wanted; this one is empty",
        ),
        (Edit::ShowRun { run: RunId(1), tracks: set(1..2), above: None }, "run 1 is shown already"),
        (Edit::HideRun { run: RunId(2), forget: TrackSet::default() }, "run 2 is not shown"),
        (
            Edit::HideRun { run: RunId(1), forget: set(0..1) },
            "track 0 is not run 1's own; it cannot be forgotten with it",
        ),
        (Edit::SetCut { k: 3 }, "no clustering is shown; show one before cutting it"),
        (Edit::NameTrack { track: TrackId(1), name: Some(" ".to_owned()) }, "a name cannot be empty"),
    ];
    for (edit, want) in cases {
        let mut document = small();
        // The first edit succeeds and must be taken back with the second.
        let first = Edit::NameTrack { track: TrackId(2), name: Some("bud".to_owned()) };
        let error = apply(&mut document, &Transaction::new("", vec![first, edit])).unwrap_err();
        assert_eq!(error.to_string(), want);
        assert_eq!(document, small(), "{want}: nothing changed");
    }
    assert_eq!(apply(&mut small(), &Transaction::new("", vec![])), Err(EditError::Empty));
}

#[test]
fn a_run_brings_its_tracks_and_takes_them_back() {
    let mut document = Document::new(N_FRAMES);
    let inverse = apply(&mut document, &Transaction::show_run(RunId(7), set(1..4))).unwrap();
    assert_eq!(document.tracks().count(), 3);
    assert_eq!(document.track(TrackId(2)).unwrap().origin, Origin::Run(RunId(7)));
    apply(&mut document, &inverse).unwrap();
    assert_eq!(document, Document::new(N_FRAMES));
}

#[test]
fn hiding_a_run_keeps_hand_work_on_its_tracks() {
    let mut document = small();
    apply(&mut document, &Transaction::set_key(TrackId(3), 5, [1.0, 2.0], None)).unwrap();
    apply(&mut document, &Transaction::hide_run(RunId(1))).unwrap();
    let seen: Vec<u32> = document.tracks().map(|(id, _)| id.0).collect();
    assert_eq!(seen, [0, 3], "placed by hand, or keyed");
    assert!(document.track(TrackId(1)).is_some() && !document.shows(TrackId(1)));
    apply(&mut document, &Transaction::delete_tracks(set(3..4))).unwrap();
    assert!(!document.shows(TrackId(3)));
    assert_eq!(document.deleted().collect::<Vec<_>>(), [TrackId(3)]);
}

#[test]
fn a_confirmed_sample_keeps_what_is_seen_of_it() {
    for (status, becomes) in [
        (Status::Tracked, Some(Status::Tracked)),
        (Status::Newborn, Some(Status::Tracked)),
        (Status::Occluded, Some(Status::Occluded)),
        (Status::Lost, None),
        (Status::Outside, None),
        (Status::Rejected, None),
    ] {
        let shown = Sample { x: 5.0, y: 4.0, status, source: Source::Tracked, quality: Quality::default() };
        let key = Key::confirming(&shown);
        assert_eq!(key.map(|key| key.status), becomes, "{status:?}");
        assert!(key.is_none_or(|key| (key.x, key.y, key.made) == (5.0, 4.0, Made::Confirmed)));
    }
}

#[test]
fn lines_say_what_happened() {
    let (status, source, quality) = (Status::Tracked, Source::Tracked, Quality::default());
    let seen = Sample { x: 5.0, y: 4.0, status, source, quality };
    let cases = [
        (
            Transaction::set_key(TrackId(42), 187, [5.0, 4.0], Some([0.0, 0.0])),
            "track 42: key-frame at 187 (moved 6.4 px)",
        ),
        (
            Transaction::confirm_key(TrackId(42), 187, &seen).unwrap(),
            "track 42: key-frame at 187 (confirmed)",
        ),
        (Transaction::add_track(TrackId(9), 3, 1.25, 2.0), "track 9: placed at frame 3 (1.2, 2.0)"),
        (Transaction::clear_key(TrackId(9), 3), "track 9: key-frame at 3 cleared"),
        (Transaction::delete_tracks(set(4..5)), "track 4 deleted"),
        (Transaction::restore_tracks(set(4..9)), "5 tracks restored"),
        (Transaction::show_run(RunId(3), set(0..135)), "run 3 shown: 135 tracks"),
        (Transaction::hide_run(RunId(3)), "run 3 hidden"),
        (Transaction::show_clustering(ClusteringId(2), 7), "clustering 2 shown: 7 groups"),
        (Transaction::set_cut(1), "cut into 1 group"),
        (Transaction::name_track(TrackId(4), Some("bud".to_owned())), "track 4 named bud"),
        (Transaction::name_group(ClusteringId(2), 9, None), "group: name removed"),
    ];
    for (transaction, want) in cases {
        assert_eq!(transaction.label, want);
    }
    assert_eq!(Transaction::add_track(TrackId(9), 3, 1.0, 2.0).touched(), set(9..10));
}
