//! The shown track, written as a string of sources: K key, t tracked, o occluded, i interpolated,
//! x lost in a run, . held.

use proptest::prelude::*;

use super::compose;
use crate::clip::FrameTimes;
use crate::document::{Key, Origin, RunId, Track};
use crate::over::{Laid, Over};
use crate::track::{Quality, Sample, Source, Span, Status};

fn times(n: u32) -> FrameTimes {
    FrameTimes::constant(n, 25.0).expect("a rate")
}

/// A span of a run at height `y`, one letter a frame: t tracked, o occluded, x lost, > outside.
fn span(first_frame: u32, y: f32, letters: &str) -> Span {
    let sample = |(x, letter)| Sample {
        x,
        y,
        status: match letter {
            't' => Status::Tracked,
            'o' => Status::Occluded,
            '>' => Status::Outside,
            _ => Status::Lost,
        },
        source: Source::Tracked,
        quality: Quality { fb_px: Some(0.5), ncc: None },
    };
    let x_px = (first_frame..).map(|frame| frame as f32);
    Span { first_frame, samples: x_px.zip(letters.chars()).map(sample).collect() }
}

fn track(keys: &[(u32, f32, f32)]) -> Track {
    let mut track = Track::new(Origin::Run(RunId(1)));
    track.keys = keys.iter().map(|&(frame, x, y)| (frame, Key::set(x, y))).collect();
    track
}

fn letters(span: &Span) -> String {
    let letter = |sample: &Sample| match (sample.source, sample.status) {
        (Source::Key, _) => 'K',
        (Source::Interpolated, Status::Lost) => '.',
        (Source::Interpolated, Status::Occluded) => 'I',
        (Source::Interpolated, _) => 'i',
        (_, Status::Tracked) => 't',
        (_, Status::Occluded) => 'o',
        (_, Status::Outside) => '>',
        _ => 'x',
    };
    span.samples.iter().map(letter).collect()
}

#[test]
fn layers_in_their_order() {
    let below = || span(0, 1.0, "ttttxxxxxx");
    type Case<'a> = (&'a str, &'a [(u32, f32, f32)], Vec<Span>, u32, &'a str);
    let cases: [Case<'_>; 10] = [
        ("a run alone", &[], vec![below()], 0, "ttttxxxxxx"),
        ("a key overrides its frame", &[(2, 9.0, 9.0)], vec![below()], 0, "ttKtxxxxxx"),
        ("lost between keys", &[(2, 0., 0.), (6, 0., 0.)], vec![below()], 0, "ttKtiiKxxx"),
        ("occluded between keys", &[(0, 0., 0.), (4, 0., 0.)], vec![span(0, 1.0, "to>xt")], 0, "KIiiK"),
        ("a later run overrides its range", &[], vec![below(), span(5, 2.0, "ttt")], 0, "ttttxtttxx"),
        ("keys alone", &[(3, 0., 0.), (6, 3., 0.)], vec![], 3, "KiiK"),
        ("one key", &[(3, 1., 1.)], vec![], 3, "K"),
        ("a gap is held", &[(8, 1., 1.)], vec![span(2, 1.0, "ttt")], 2, "ttt...K"),
        ("spans of one run with a gap", &[], vec![span(6, 1.0, "tt"), span(1, 1.0, "tt")], 1, "tt...tt"),
        ("nothing beyond the clip", &[(9, 1., 1.)], vec![span(8, 1.0, "tttt")], 8, "tK"),
    ];
    for (what, keys, runs, first_frame, want) in cases {
        let shown = compose(&track(keys), &runs.iter().collect::<Vec<_>>(), &times(10));
        assert_eq!((shown.first_frame, letters(&shown).as_str()), (first_frame, want), "{what}");
    }
}

#[test]
fn positions_come_from_the_topmost() {
    let runs = [span(0, 1.0, "tttt"), span(1, 2.0, "tx")];
    let shown = compose(&track(&[(3, 7.0, 8.0)]), &[&runs[0], &runs[1]], &times(10));
    let ys: Vec<f32> = shown.samples.iter().map(|sample| sample.y).collect();
    assert_eq!(ys, [1.0, 2.0, 2.0, 8.0], "also where the later run has lost it");
    assert_eq!(shown.samples[0].quality.fb_px, Some(0.5));
    assert_eq!(shown.samples[3].quality, Quality::default());
}

#[test]
fn deleted_and_empty_tracks_have_no_samples() {
    let mut deleted = track(&[(1, 1.0, 1.0)]);
    deleted.deleted = true;
    assert_eq!(compose(&deleted, &[&span(0, 1.0, "ttt")], &times(10)), Span::default());
    assert_eq!(compose(&track(&[]), &[], &times(10)), Span::default());
}

#[test]
fn interpolation_runs_on_the_clips_own_times() {
    // Frames at 0, 1 and 4 s: a quarter of the way, not half.
    let times = FrameTimes::new(vec![0.0, 1.0, 4.0]).unwrap();
    let shown = compose(&track(&[(0, 0.0, 0.0), (2, 8.0, 0.0)]), &[], &times);
    assert!((shown.samples[1].x - 2.0).abs() < 1e-6, "{}", shown.samples[1].x);
}

proptest! {
    #[test]
    fn key_frames_stand_and_seen_samples_are_kept(
        keys in prop::collection::btree_map(0_u32..20, (0.0_f32..99.0, 0.0_f32..99.0), 0..6),
        runs in prop::collection::vec((0_u32..20, "[tox>]{1,12}"), 0..4),
    ) {
        let keys: Vec<_> = keys.into_iter().map(|(frame, (x, y))| (frame, x, y)).collect();
        let runs: Vec<_> = runs.iter().zip(1_u8..).map(|((at, s), y)| span(*at, f32::from(y), s)).collect();
        let shown = compose(&track(&keys), &runs.iter().collect::<Vec<_>>(), &times(20));
        for &(frame, x, y) in &keys {
            let sample = shown.get(frame).unwrap();
            prop_assert_eq!((sample.source, sample.x, sample.y), (Source::Key, x, y));
        }
        for frame in shown.frames().filter(|frame| keys.iter().all(|key| key.0 != *frame)) {
            let sample = shown.get(frame).unwrap();
            let top = runs.iter().rev().find_map(|run| run.get(frame));
            if let Some(seen) = top.filter(|sample| sample.status.is_seen()) {
                prop_assert_eq!(sample, seen);
            }
            let between = keys.iter().any(|key| key.0 < frame) && keys.iter().any(|key| key.0 > frame);
            if between {
                prop_assert!(sample.status != Status::Lost);
            }
            prop_assert!(sample.x.is_finite() && sample.y.is_finite());
        }
        prop_assert!(shown.frames().end <= 20);
    }
}

/// What corrections lay: letters as in [`span`], `-` for nothing; spaces lay nothing there.
fn laid(letters: &str) -> std::collections::BTreeMap<u32, Over> {
    let over = |(frame, letter): (u32, char)| match letter {
        ' ' => None,
        '-' => Some((frame, Over::Nothing)),
        _ => {
            let sample =
                Sample { source: Source::Sketch, ..span(frame, 5.0, &letter.to_string()).samples[0] };
            Some((frame, Over::Sample(Laid { sample, run: None })))
        }
    };
    (0..).zip(letters.chars()).filter_map(over).collect()
}

#[test]
fn corrections_over_runs() {
    let below = || vec![span(0, 1.0, "ttttxxxxxx")];
    type Case<'a> = (&'a str, &'a [u32], &'a str, Vec<Span>, u32, &'a str);
    let cases: [Case<'_>; 8] = [
        ("over a run", &[], "  tto", below(), 0, "ttttoxxxxx"),
        ("a key over all", &[3], "  ttt", below(), 0, "tttKtxxxxx"),
        ("no curve over a correction", &[2, 8], "     xx", below(), 0, "ttKtixxiKx"),
        ("nothing inside is lost", &[], " --", below(), 0, "t..txxxxxx"),
        ("nothing at the ends shortens", &[], "--      --", below(), 2, "ttxxxx"),
        ("nothing at all", &[], "----------", below(), 0, ""),
        ("longer than the run", &[], "            tt", vec![span(0, 1.0, "tt")], 0, "tt..........tt"),
        ("alone, within the clip", &[], "   ttttttttttttttttttttttttt", vec![], 3, "ttttttttttttttttt"),
    ];
    for (what, keys, over, runs, first_frame, expect) in cases {
        let keys: Vec<_> = keys.iter().map(|&frame| (frame, 0.0, 0.0)).collect();
        let track = Track { over: laid(over), ..track(&keys) };
        let runs: Vec<&Span> = runs.iter().collect();
        let shown = compose(&track, &runs, &times(20));
        assert_eq!((shown.first_frame, letters(&shown).as_str()), (first_frame, expect), "{what}");
    }
}

#[test]
fn no_curve_through_a_key_that_says_lost_or_outside() {
    for (status, expect) in [
        (Status::Tracked, "KiKiK"),
        (Status::Occluded, "KiKiK"),
        (Status::Outside, "K.K.K"),
        (Status::Lost, "K.K.K"),
    ] {
        let mut track = track(&[(0, 0.0, 0.0), (2, 1.0, 0.0), (4, 2.0, 0.0)]);
        track.keys.get_mut(&2).expect("placed above").status = status;
        let shown = compose(&track, &[], &times(20));
        assert_eq!(letters(&shown), expect, "{status:?}");
        assert_eq!(shown.samples[2].status, status);
    }
}
