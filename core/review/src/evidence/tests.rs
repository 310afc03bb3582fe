//! Evidence: known errors are seen, missing parts stay missing, one track anew is the same as all anew.

use honami_model::track::{Quality, Status};
use honami_vision::Gray;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

use super::*;

/// A sample that a tracker found; `fb` is the forward-backward error of the step to it.
fn found(x: f32, y: f32, fb_px: Option<f32>) -> Sample {
    let quality = Quality { fb_px, ncc: None };
    Sample { x, y, status: Status::Tracked, source: Source::Tracked, quality }
}

/// A track from frame 0, written a letter a sample: `k` key-frame, `t` tracked, `i` interpolated, `l` lost,
/// `o` occluded; it moves by one pixel a frame.
fn written(letters: &str) -> Span {
    let sample = |(frame, letter): (usize, char)| {
        let t = found(frame as f32, 5.0, Some(0.1));
        match letter {
            'b' => Sample { quality: Quality::default(), ..t },
            't' => t,
            'k' => Sample { source: Source::Key, quality: Quality::default(), ..t },
            'i' => Sample { source: Source::Interpolated, quality: Quality::default(), ..t },
            'l' => Sample { status: Status::Lost, ..t },
            'o' => Sample { status: Status::Occluded, ..t },
            other => unreachable!("{other}"),
        }
    };
    Span { first_frame: 0, samples: letters.chars().enumerate().map(sample).collect() }
}

fn subject(track: u32, span: Span) -> Subject {
    let (span, kind) = (Arc::new(span), Kind::Stepwise);
    Subject { track: TrackId(track), kind, span, rivals: Vec::new(), unseen: Vec::new() }
}

#[test]
fn errors_add_up_from_key_frame_to_key_frame() {
    let mut span = written("btttkttt");
    for (frame, fb) in [(1, 0.2), (2, 0.9), (3, 0.1), (5, 0.3), (6, 0.1), (7, 0.4)] {
        span.samples[frame].quality.fb_px = Some(fb);
    }
    let parts = Evidence::new(vec![subject(1, span)], 1).parts(TrackId(1)).unwrap();
    let fb: Vec<Option<f32>> = parts.iter().map(|parts| parts.fb_px).collect();
    assert_eq!(fb, [Some(0.0), Some(0.2), Some(0.9), Some(0.9), None, Some(0.3), Some(0.3), Some(0.4)]);
}

#[test]
fn backwards_from_the_first_key_frame_they_add_up_backwards() {
    // The first sample has a forward-backward error: it was reached by tracking, not given.
    let mut span = written("tttk");
    for (frame, fb) in [(0, 0.1), (1, 0.7), (2, 0.3)] {
        span.samples[frame].quality.fb_px = Some(fb);
    }
    let parts = Evidence::new(vec![subject(1, span)], 1).parts(TrackId(1)).unwrap();
    let fb: Vec<Option<f32>> = parts.iter().map(|parts| parts.fb_px).collect();
    assert_eq!(fb, [Some(0.7), Some(0.7), Some(0.3), None]);
}

#[test]
fn a_jump_is_seen_from_where_it_happens_and_not_across_a_key_frame() {
    let mut span = written("bttttttktttt");
    // One step of 4 px more than usual; from the key-frame on the track is elsewhere by right.
    span.samples[4..].iter_mut().for_each(|sample| sample.x += 4.0);
    span.samples[7..].iter_mut().for_each(|sample| sample.y += 30.0);
    let parts = Evidence::new(vec![subject(1, span)], 1).parts(TrackId(1)).unwrap();
    let jumps: Vec<Option<f32>> = parts.iter().map(|parts| parts.jump).collect();
    let some = |x: f32| Some(x / 0.25);
    assert_eq!(jumps[..7], [some(0.0), None, some(0.0), some(0.0), some(4.0), some(4.0), some(4.0)]);
    assert_eq!(jumps[7..], [None, None, some(0.0), some(0.0), some(0.0)]);
}

#[test]
fn hand_work_and_what_is_not_seen_have_no_parts() {
    for (letters, judged) in [
        ("bttt", vec![true, true, true, true]),
        ("kiik", vec![false, true, true, false]),
        ("ktlo", vec![false, true, false, false]),
    ] {
        let span = written(letters);
        assert_eq!(span.samples.iter().map(is_judged).collect::<Vec<_>>(), judged, "{letters}");
        let parts = Evidence::new(vec![subject(1, span)], 1).parts(TrackId(1)).unwrap();
        for (parts, judged) in parts.iter().zip(judged) {
            assert!(judged || *parts == Parts::default(), "{letters}: {parts:?}");
        }
    }
}

#[test]
fn a_track_that_leaves_its_neighbours_strays_by_as_much() {
    let crowd = |n: u32| -> Vec<Subject> {
        (0..n)
            .map(|track| {
                let mut span = written("bttttt");
                span.samples.iter_mut().for_each(|sample| sample.y += 10.0 * track as f32);
                if track == 2 {
                    span.samples[3..].iter_mut().for_each(|sample| sample.y += 7.0);
                }
                subject(track, span)
            })
            .collect()
    };
    let strays = |evidence: &Evidence, track| -> Vec<Option<f32>> {
        evidence.parts(TrackId(track)).unwrap().iter().map(|parts| parts.nbr_px).collect()
    };
    let evidence = Evidence::new(crowd(5), 2);
    let near = |a: Option<f32>, b: f32| a.is_some_and(|a| (a - b).abs() < 1e-4);
    let got = strays(&evidence, 2);
    assert!([0.0, 0.0, 0.0, 7.0, 7.0, 7.0].iter().zip(&got).all(|(want, got)| near(*got, *want)), "{got:?}");
    assert!(strays(&evidence, 0).iter().all(|px| near(*px, 0.0)));
    // With two neighbours there is no majority.
    assert!(strays(&Evidence::new(crowd(3), 1), 2)[1..].iter().all(Option::is_none));
}

/// A run of a tracker of this kind that is off by so many pixels to the right, written as in [`written`].
fn rival(kind: Kind, letters: &str, off: f32) -> Rival {
    let mut span = written(letters);
    span.samples.iter_mut().for_each(|sample| sample.x += off);
    Rival { name: format!("{kind:?} {off}").into(), kind, span: Arc::new(span) }
}

#[test]
fn trackers_disagree_where_another_sees_the_feature_elsewhere() {
    use Kind::{Anchored, Stepwise};
    let own = |kind| rival(kind, "bttt", 0.0);
    for (kind, rivals, dis, anchored, opponent) in [
        (Stepwise, vec![own(Stepwise)], [None; 3], [None; 3], None),
        // Where the other has lost it, it says nothing.
        (
            Stepwise,
            vec![own(Stepwise), rival(Stepwise, "btlt", 3.0)],
            [Some(3.0), None, Some(3.0)],
            [None; 3],
            Some("Stepwise 3"),
        ),
        // The nearest of a kind is asked; an anchored one by itself.
        (
            Stepwise,
            vec![
                rival(Anchored, "bttt", 13.0),
                own(Stepwise),
                rival(Stepwise, "bttt", 2.0),
                rival(Stepwise, "bttt", 9.0),
            ],
            [Some(2.0); 3],
            [Some(13.0); 3],
            Some("Anchored 13"),
        ),
        (
            Anchored,
            vec![rival(Stepwise, "bttt", 5.0), own(Anchored), rival(Anchored, "bttt", 7.0)],
            [Some(5.0); 3],
            [None; 3],
            Some("Stepwise 5"),
        ),
        // What a correction has laid is none of the runs' any more.
        (
            Stepwise,
            vec![rival(Stepwise, "bttt", 1.0), rival(Stepwise, "bttt", 4.0)],
            [None; 3],
            [None; 3],
            None,
        ),
    ] {
        let subject = Subject { rivals, kind, ..subject(1, written("bttt")) };
        let parts = Evidence::new(vec![subject.clone()], 1).parts(TrackId(1)).unwrap();
        let got: Vec<_> = parts[1..].iter().map(|parts| (parts.dis_px, parts.anchored_px)).collect();
        assert_eq!(got, dis.into_iter().zip(anchored).collect::<Vec<_>>(), "{subject:?}");
        assert_eq!(subject.opponent(1, &parts[1]).as_deref(), opponent);
    }
}

#[test]
fn likeness_that_a_tracker_found_itself_counts_of_anchored_ones() {
    let mut span = written("btt");
    span.samples[2].quality.ncc = Some(0.6);
    for (kind, want) in [(Kind::Stepwise, [None; 3]), (Kind::Anchored, [Some(1.0), None, Some(0.6)])] {
        let subject = Subject { kind, ..subject(1, span.clone()) };
        let parts = Evidence::new(vec![subject], 1).parts(TrackId(1)).unwrap();
        assert_eq!(parts.iter().map(|parts| parts.own_ncc).collect::<Vec<_>>(), want, "{kind:?}");
    }
}

/// A member of a group that goes to and fro along x: moved `gain` times as far, turned by a quarter; in some frames
/// off by 9 px downwards.
fn member(track: u32, gain: f32, is_turned: bool, off: &[u32]) -> Subject {
    let sample = |frame: u32| {
        let sway = 10.0 * (frame as f32 * 0.7).sin() * gain;
        let (dx, dy) = if is_turned { (0.0, sway) } else { (sway, 0.0) };
        let off = if off.contains(&frame) { 9.0 } else { 0.0 };
        found(100.0 * track as f32 + dx, 50.0 + dy + off, Some(0.1))
    };
    subject(track, Span { first_frame: 0, samples: (0..40).map(sample).collect() })
}

#[test]
fn a_member_that_leaves_its_groups_way_is_seen_however_far_and_whither_it_moves() {
    let off = [20, 21, 22];
    let mut tracks: Vec<Subject> = (0..6).map(|track| member(track, 1.0, false, &[])).collect();
    tracks.push(member(6, 3.0, true, &[]));
    tracks.push(member(7, 0.5, false, &off));
    let mut evidence = Evidence::new(tracks.clone(), 1);
    let strays = |evidence: &Evidence, track: u32| -> Vec<Option<f32>> {
        evidence.parts(TrackId(track)).unwrap().iter().map(|parts| parts.group_px).collect()
    };
    assert!(strays(&evidence, 7).iter().all(Option::is_none), "it is in no group");
    let all: BTreeMap<TrackId, u32> = (0..8).map(|track| (TrackId(track), 5)).collect();
    assert_eq!(evidence.group(all.clone()).len(), 8);
    for track in 0..7 {
        // The course is the median, so that what the seventh does moves it by nothing; a gain is damped by noise.
        assert!(strays(&evidence, track).iter().all(|px| px.unwrap() < 0.1), "{track}");
    }
    for (frame, px) in (0..).zip(strays(&evidence, 7)) {
        let want = if off.contains(&frame) { 9.0 } else { 0.0 };
        assert!((px.unwrap() - want).abs() < 0.2, "{frame}: {px:?}");
    }
    // Four are too few to tell a course.
    let few = all.iter().filter(|(track, _)| track.0 > 3).map(|(&track, &group)| (track, group)).collect();
    evidence.group(few);
    assert!((1..40).all(|frame| strays(&evidence, 7)[frame].is_none()));
    assert!(strays(&evidence, 0).iter().all(Option::is_none), "it has left its group");
}

/// A picture with a bright square about `(x, 20)`.
fn picture(x: u32) -> Vec<u8> {
    let inside = |k: u32| (k % 64).abs_diff(x) < 4 && (k / 64).abs_diff(20) < 3;
    (0..64 * 40).map(|k| if inside(k) { 200 } else { (k * 37 % 23) as u8 }).collect()
}

fn look(evidence: &mut Evidence, tracks: &[TrackId]) {
    let mut correlator = evidence.correlator(tracks);
    for frame in correlator.template_frames() {
        correlator.cut(frame, &Gray::packed(&picture(20 + frame), 64, 40));
    }
    for frame in correlator.sample_frames() {
        correlator.look(frame, &Gray::packed(&picture(20 + frame), 64, 40));
    }
    evidence.correlated(correlator);
}

/// A track on the square, but for `off` pixels to the right from a frame on.
fn on_square(off: f32, from: usize, keys: &[usize]) -> Span {
    let sample = |frame: usize| {
        let x = 20.0 + frame as f32 + if frame >= from { off } else { 0.0 };
        let source = if keys.contains(&frame) { Source::Key } else { Source::Tracked };
        Sample { source, ..found(x, 20.0, (frame > 0).then_some(0.1)) }
    };
    Span { first_frame: 0, samples: (0..8).map(sample).collect() }
}

#[test]
fn correlation_is_with_the_templates_around() {
    let mut evidence = Evidence::new(vec![subject(1, on_square(9.0, 4, &[]))], 1);
    look(&mut evidence, &[TrackId(1)]);
    let ncc = |evidence: &Evidence| -> Vec<f32> {
        evidence.parts(TrackId(1)).unwrap().iter().filter_map(|parts| parts.ncc).collect()
    };
    let got = ncc(&evidence);
    assert!(
        got.len() == 8 && got[..4].iter().all(|c| *c > 0.9) && got[4..].iter().all(|c| *c < 0.6),
        "{got:?}"
    );
    // A key-frame on the square at the end: what is off it agrees with neither end.
    evidence.replace(subject(1, on_square(0.0, 4, &[7])));
    look(&mut evidence, &[TrackId(1)]);
    assert!(ncc(&evidence).iter().all(|c| *c > 0.9), "{:?}", ncc(&evidence));
}

#[test]
fn only_what_changed_is_looked_at_again() {
    let mut evidence = Evidence::new(vec![subject(1, on_square(0.0, 0, &[]))], 1);
    look(&mut evidence, &[TrackId(1)]);
    assert_eq!(evidence.correlator(&[TrackId(1)]).sample_frames().count(), 0);
    evidence.replace(subject(1, on_square(3.0, 6, &[])));
    assert_eq!(evidence.correlator(&[TrackId(1)]).sample_frames().collect::<Vec<_>>(), [6, 7]);
    // A key-frame changes the templates of all samples before and after it.
    evidence.replace(subject(1, on_square(0.0, 8, &[4])));
    look(&mut evidence, &[TrackId(1)]);
    evidence.replace(subject(1, on_square(0.0, 8, &[])));
    assert_eq!(evidence.correlator(&[TrackId(1)]).sample_frames().count(), 8);
}

/// Random walks that start near each other, some lost at times, some with key-frames.
fn walks() -> impl Strategy<Value = Vec<Span>> {
    let sample = (-3.0..3.0_f32, -3.0..3.0_f32, 0..12_u8);
    let walk = (0..4_u32, 0.0..60.0_f32, prop::collection::vec(sample, 1..12));
    let span = |(first_frame, x0, steps): (u32, f32, Vec<(f32, f32, u8)>)| {
        let mut at = (x0, 0.0);
        let samples = steps.into_iter().map(|(dx, dy, kind)| {
            at = (at.0 + dx, at.1 + dy);
            let sample = found(at.0, at.1, (kind > 1).then_some(dx.abs()));
            match kind {
                0 => Sample { status: Status::Lost, ..sample },
                1 => Sample { source: Source::Key, ..sample },
                _ => sample,
            }
        });
        Span { first_frame, samples: samples.collect() }
    };
    prop::collection::vec(walk.prop_map(span), 1..18)
}

fn all_parts(evidence: &Evidence) -> Vec<(TrackId, Vec<Parts>)> {
    evidence.tracks().map(|track| (track, evidence.parts(track).unwrap())).collect()
}

fn subjects(spans: &[Span]) -> Vec<Subject> {
    (0..).zip(spans).map(|(track, span)| subject(track, span.clone())).collect()
}

proptest! {
    #![proptest_config(Config { cases: 96, rng_seed: RngSeed::Fixed(0), failure_persistence: None, ..Config::default() })]

    #[test]
    fn one_track_anew_is_all_anew(before in walks(), edits in prop::collection::vec((0..20_u32, walks()), 1..4)) {
        let mut spans: BTreeMap<u32, Span> = (0..).zip(before.iter().cloned()).collect();
        let mut evidence = Evidence::new(subjects(&before), 1);
        let groups = |n: u32| (0..20).map(|track| (TrackId(track), track % n)).collect::<BTreeMap<_, _>>();
        let touched = evidence.group(groups(3));
        prop_assert!(touched.iter().all(|track| evidence.subject(*track).is_some()));
        for (track, new) in edits {
            // The first span takes the track's place; an odd number of others deletes it.
            let span = if new.len() % 4 == 3 { Span::default() } else { new[0].clone() };
            let old = all_parts(&evidence);
            let touched = evidence.replace(subject(track, span.clone()));
            if span.samples.is_empty() { spans.remove(&track); } else { spans.insert(track, span); }
            let mut anew = Evidence::new(spans.iter().map(|(&id, span)| subject(id, span.clone())).collect(), 2);
            anew.group(groups(2));
            anew.group(groups(3));
            prop_assert_eq!(all_parts(&evidence), all_parts(&anew));
            for (id, parts) in all_parts(&anew) {
                let same = old.iter().any(|(known, before)| *known == id && *before == parts);
                prop_assert!(same || touched.contains(&id), "{} changed and was not named", id);
            }
        }
    }

    #[test]
    fn neither_order_nor_threads_matter(spans in walks(), threads in 1..5_usize) {
        let mut turned = subjects(&spans);
        turned.reverse();
        let (a, b) = (Evidence::new(subjects(&spans), 1), Evidence::new(turned, threads));
        prop_assert_eq!(all_parts(&a), all_parts(&b));
    }
}
