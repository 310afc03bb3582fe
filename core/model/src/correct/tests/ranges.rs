//! Ranges marked and taken away, and steps on whole tracks: each written as a string, one letter a frame.

use super::*;

/// t tracked, o occluded, x lost, > outside, K key, i interpolated, space nothing.
fn letters(span: &Span) -> String {
    let letter = |frame| match span.get(frame).map(|sample| (sample.source, sample.status)) {
        None => ' ',
        Some((_, Status::Lost)) => 'x',
        Some((_, Status::Occluded)) => 'o',
        Some((_, Status::Outside)) => '>',
        Some((Source::Key, _)) => 'K',
        Some((Source::Interpolated, _)) => 'i',
        Some(_) => 't',
    };
    (0..12).map(letter).collect()
}

fn short(keys: &[(u32, f32, f32)]) -> Given {
    let mut given = Given::run(|t_s| [100.0 * t_s, 0.0]).keyed(keys);
    given.runs[0].1.samples.truncate(12);
    given
}

#[test]
fn ranges() {
    let given = short(&[(3, 0.0, 0.0), (8, 0.0, 0.0)]);
    let shown = given.shown();
    for (what, correction, want) in [
        ("as given", key_only(&shown, 3, [0.0, 0.0]), "tttKttttKttt"),
        ("lost up to a key-frame", mark(&shown, 5..8, Status::Lost), "tttKtxxxKttt"),
        ("lost over a key-frame", mark(&shown, 5..9, Status::Lost), "tttKtxxxxttt"),
        ("occluded, beyond the end", mark(&shown, 10..99, Status::Occluded), "tttKttttKtoo"),
        ("outside", mark(&shown, 0..2, Status::Outside), ">>tKttttKttt"),
        ("taken away in the middle", delete_range(&shown, 5..7), "tttKtxxtKttt"),
        ("taken away at an end", delete_range(&shown, 7..99), "tttKttt     "),
    ] {
        assert_eq!(letters(&correction.unwrap().span), want, "{what}");
    }
}

#[test]
fn what_a_run_found_is_taken() {
    let given = short(&[(3, 9.0, 9.0)]);
    let marked = mark(&given.shown(), 5..7, Status::Occluded).unwrap();
    let given = Given { track: marked.track, ..given };
    let shown = given.shown();
    let mut found = given.runs[0].1.clone();
    found.samples.iter_mut().for_each(|sample| sample.y = 2.0);
    found.samples[8].status = Status::Lost;
    found.samples.truncate(10);
    let taken = |frames| take(&shown, RunId(7), &found, frames).unwrap();
    for (frames, want, line) in [
        (0..99, "tttKttttxttt", "track 42: frames 0-9 taken from run 7, up to 2.0 px"),
        (4..6, "tttKtto", "track 42: frames 4-5 taken from run 7, up to 2.0 px"),
    ] {
        let taken = taken(frames.clone());
        assert!(letters(&taken.span).starts_with(want), "{:?} in {frames:?}", letters(&taken.span));
        assert_eq!(taken.transaction.label, line);
        let all = taken.span.frames().zip(&taken.span.samples);
        for (frame, sample) in all {
            let is_taken = frames.contains(&frame) && frame < 10 && frame != 3;
            let was = shown.span().get(frame).unwrap();
            assert_eq!(sample, if is_taken { found.get(frame).unwrap() } else { was }, "frame {frame}");
        }
    }
    let refused = |found: &Span, frames| take(&shown, RunId(1), found, frames).unwrap_err().to_string();
    assert_eq!(refused(&found, 10..12), "track 42 has no samples in frames 10-11");
    assert_eq!(
        refused(&given.runs[0].1, 8..12),
        "track 42: frames 8-11 are already as run 1 found them",
        "it is the run that is shown"
    );
}

#[test]
fn a_marked_frame_stays_marked_when_key_frames_are_set_beside_it() {
    let given = short(&[(1, 0.0, 0.0)]);
    let marked = mark(&given.shown(), 5..7, Status::Occluded).unwrap();
    let given = Given { track: marked.track, ..given };
    for (tool, want) in [
        (hermite(&given.shown(), 9, [5.0, 5.0]), "tKiiiooiiKtt"),
        (linear(&given.shown(), 9, [5.0, 5.0]), "tKiiiooiiKtt"),
        (space(&given.shown(), 9, [5.0, 5.0]), "tKtttoottKtt"),
    ] {
        assert_eq!(letters(&tool.unwrap().span), want);
    }
}

#[test]
fn a_join_fills_what_the_first_has_not_seen() {
    let (mut a, b) = (short(&[(9, 0.0, 0.0)]).unseen(4..12), short(&[(6, 1.0, 1.0)]).unseen(0..2));
    a.runs[0].1.samples.truncate(7);
    assert_eq!(letters(a.shown().span()), "ttttxxxxxK  ");
    let beside = Shown::new(TrackId(50), &b.track, &b.runs, &a.times);
    let step = join(&a.shown(), &beside).unwrap();
    let mut after = document(&[(ID, &a.track), (TrackId(50), &b.track)]);
    apply(&mut after, &step).unwrap();
    let joined = Shown::new(ID, after.track(ID).unwrap(), &a.runs, &a.times);
    assert_eq!(letters(joined.span()), "ttttttKttKtt", "its key-frames come along");
    assert_eq!(step.label, "track 42 joined with track 50: frames 4-11 filled");
}

#[test]
fn an_average_is_of_those_that_are_seen() {
    let (a, b) = (short(&[]).unseen(6..12), Given::run(|t_s| [100.0 * t_s + 8.0, 4.0]));
    let beside = Shown::new(TrackId(50), &b.track, &b.runs, &a.times);
    let step = average(&[a.shown(), beside], TrackId(99)).unwrap();
    let mut after = document(&[]);
    apply(&mut after, &step).unwrap();
    let mean = Shown::new(TrackId(99), after.track(TrackId(99)).unwrap(), &[], &a.times);
    let at = |frame| mean.span().get(frame).map(|sample| (sample.x, sample.y));
    assert_eq!((at(0), at(5), at(6)), (Some((4.0, 2.0)), Some((24.0, 2.0)), Some((32.0, 4.0))));
}
