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
