//! What a correction must leave alone: samples beside a range, samples before a loss, numbers that nothing says.

use super::*;

/// Frames outside a range in which something that is known has changed.
fn changed_beside(before: &Span, after: &Span, inside: &Range<u32>) -> Vec<u32> {
    let known = |span: &Span, at| span.get(at).filter(|sample| sample.status != Status::Lost).copied();
    (0..N_FRAMES).filter(|at| !inside.contains(at) && known(before, *at) != known(after, *at)).collect()
}

proptest! {
    #[test]
    fn marks_and_removals_change_nothing_beside_their_range(
        given in any_given(), frame in 0..N_FRAMES, end in 0..N_FRAMES + 4,
    ) {
        let shown = given.shown();
        let frames = frame.min(end)..frame.max(end);
        for (tool, correction) in [
            ("lost", mark(&shown, frames.clone(), Status::Lost)),
            ("occluded", mark(&shown, frames.clone(), Status::Occluded)),
            ("seen", mark(&shown, frames.clone(), Status::Tracked)),
            ("delete", delete_range(&shown, frames.clone())),
        ] {
            let Ok(correction) = correction else { continue };
            let beside = changed_beside(shown.span(), &correction.span, &frames);
            prop_assert!(beside.is_empty(), "{} of {:?} changes {:?}", tool, frames, beside);
        }
    }

    /// Only what is seen or predicted was displaced: from anywhere else, nothing but the curve of key-frames moves.
    #[test]
    fn a_lost_sample_drags_nothing_along(given in any_given(), frame in 0..N_FRAMES, to in prop::array::uniform2(0.0_f32..99.0)) {
        let shown = given.shown();
        if let Some(sample) = shown.span().get(frame)
            && !is_placed(sample.status)
        {
            prop_assert_eq!(space(&shown, frame, to), key_only(&shown, frame, to));
        }
    }
}

#[test]
fn a_feature_found_again_leaves_the_path_before_its_loss() {
    let given = Given::run(|t_s| [100.0 * t_s, 10.0]).unseen(12..N_FRAMES).keyed(&[(3, 12.0, 10.0)]);
    let (was, placed) = (given.shown(), space(&given.shown(), 18, [150.0, 60.0]).unwrap());
    for frame in 0..12 {
        assert_eq!(placed.span.get(frame), was.span().get(frame), "frame {frame}");
    }
    assert_eq!(placed.span.get(18).map(|sample| sample.status), Some(Status::Tracked));
}

#[test]
fn a_mark_on_a_key_frame_keeps_the_curves_beside_it() {
    let keys = [(2, 0.0, 0.0), (10, 8.0, 30.0), (20, 0.0, 0.0)];
    let given = Given::run(|_| [0.0, 0.0]).unseen(0..N_FRAMES).keyed(&keys);
    let shown = given.shown();
    let lost = mark(&shown, 10..12, Status::Lost).unwrap();
    assert_eq!(
        (lost.affected.clone(), lost.transaction.label.as_str()),
        (10..12, "track 42: frames 10-11 lost with 1 key-frame")
    );
    let away = delete_range(&shown, 9..12).unwrap();
    assert_eq!(away.affected, 9..12);
}

/// The samples before a loss slide as they would without what comes after it.
#[test]
fn a_slide_ends_where_the_feature_is_lost() {
    let path = |t_s: f64| [100.0 * t_s, 20.0 * t_s];
    let (whole, mut short) = (Given::run(path).unseen(14..N_FRAMES), Given::run(path));
    short.runs[0].1.samples.truncate(14);
    for frame in 1..13 {
        let slid = [&whole, &short].map(|given| time(&given.shown(), frame, 0.05).unwrap());
        assert_eq!(slid[0].shift_s.to_bits(), slid[1].shift_s.to_bits(), "frame {frame}");
        for at in 0..14 {
            assert_eq!(
                slid[0].correction.span.get(at),
                slid[1].correction.span.get(at),
                "frame {frame}: {at}"
            );
        }
    }
    let why = time(&whole.shown(), 16, 0.05).unwrap_err().to_string();
    assert_eq!(why, "track 42 is not seen at frame 16; go to a frame where it is");
}

#[test]
fn a_join_does_not_take_what_was_merely_interpolated() {
    // Both are curves between key-frames; the second has seen frames 10 to 12.
    let keys = |y: f32| [(2, 0.0, y), (20, 18.0, y)];
    let a = Given::run(|_| [0.0, 0.0]).unseen(0..N_FRAMES).keyed(&keys(0.0));
    let b = Given::run(|_| [50.0, 50.0]).unseen(0..10).unseen(13..N_FRAMES).keyed(&keys(9.0));
    let beside = Shown::new(TrackId(50), &b.track, &b.runs, &a.times);
    let step = join(&a.shown(), &beside).unwrap();
    let mut after = document(&[(ID, &a.track), (TrackId(50), &b.track)]);
    apply(&mut after, &step).unwrap();
    let joined = Shown::new(ID, after.track(ID).unwrap(), &a.runs, &a.times);
    let seen: Vec<u32> = (0..N_FRAMES).filter(|&at| joined.span().get(at).unwrap().y > 1.0).collect();
    assert_eq!(seen, [10, 11, 12]);
}

#[test]
fn what_is_computed_is_not_said_to_be_tracked() {
    let (a, b) = (Given::run(|_| [0.0, 0.0]), Given::run(|_| [4.0, 4.0]));
    let step = average(&[a.shown(), b.shown()], TrackId(99)).unwrap();
    let mut after = document(&[]);
    apply(&mut after, &step).unwrap();
    let mean = Shown::new(TrackId(99), after.track(TrackId(99)).unwrap(), &[], &a.times);
    assert!(mean.span().samples.iter().all(|sample| sample.source == Source::Interpolated));
}

#[test]
fn what_is_confirmed_is_what_is_shown() {
    let at = |status| sample([5.0, 4.0], status, Source::Tracked);
    let confirmed = |status| Transaction::confirm_key(ID, 7, &at(status)).map(|step| step.edits);
    for (shown, said) in [
        (Status::Tracked, Status::Tracked),
        (Status::Newborn, Status::Tracked),
        (Status::Occluded, Status::Occluded),
    ] {
        let key = Key { status: said, ..Key::confirmed(5.0, 4.0) };
        assert_eq!(confirmed(shown), Ok(vec![Edit::SetKey { track: ID, frame: 7, key }]));
    }
    for (shown, why) in [
        (Status::Lost, "track 42 is lost at frame 7: place it, or leave it so"),
        (Status::Outside, "track 42 is outside at frame 7: place it, or leave it so"),
        (Status::Rejected, "track 42 is rejected at frame 7: place it, or leave it so"),
    ] {
        assert_eq!(confirmed(shown).unwrap_err().to_string(), why);
    }
}
