//! Segments from samples, and the order of the queue.

use honami_model::judgement::{Effort, Judgement, Verdict};
use honami_model::track::{Quality, Sample, Source, Span, Status};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

use super::*;

/// A track and its evidence, a letter a sample: `.` good, `d` doubtful, `D` more so, `l` lost, `k` key-frame,
/// `o` occluded; `L` and `O` where a person has said so.
fn written(letters: &str) -> (Span, Vec<Parts>) {
    let good =
        Parts { fb_px: Some(0.02), ncc: Some(0.99), jump: Some(1.0), nbr_px: Some(0.2), ..Parts::default() };
    let doubtful = Parts { fb_px: Some(2.0), ncc: Some(0.3), nbr_px: Some(20.0), ..good };
    let bad = Parts { ncc: Some(-0.2), nbr_px: Some(60.0), ..doubtful };
    let each = letters.chars().map(|letter| {
        let (status, source, parts) = match letter {
            '.' => (Status::Tracked, Source::Tracked, good),
            'd' => (Status::Tracked, Source::Tracked, doubtful),
            'D' => (Status::Tracked, Source::Tracked, bad),
            'l' | 'L' => (Status::Lost, Source::Tracked, Parts::default()),
            'o' | 'O' => (Status::Occluded, Source::Tracked, Parts::default()),
            _ => (Status::Tracked, Source::Key, Parts::default()),
        };
        (Sample { x: 1.0, y: 2.0, status, source, quality: Quality::default() }, parts)
    });
    let (samples, parts) = each.unzip();
    (Span { first_frame: 100, samples }, parts)
}

fn judged(span: &Span, frames: Range<u32>, verdict: Verdict) -> (u32, Judgement) {
    let seal = Some(span.seal(frames.clone()));
    let (reasons, reviewer, time) = Default::default();
    let effort = Effort::default();
    (frames.start, Judgement { end_frame: frames.end, verdict, reasons, reviewer, time, effort, seal })
}

fn found(letters: &str, judgements: &[(u32, Judgement)]) -> Segments {
    let (span, parts) = written(letters);
    let unseen: Vec<u32> =
        (100..).zip(letters.chars()).filter(|(_, c)| "LO".contains(*c)).map(|(f, _)| f).collect();
    let judgements = judgements.iter().map(|(frame, judgement)| (*frame, judgement));
    segments(TrackId(1), &span, (&parts, &unseen), judgements)
}

#[test]
fn segments_lie_between_key_frames_and_near_ones_are_one() {
    for (letters, want) in [
        ("....", vec![]),
        ("..ddd..", vec![(102..105, 102, "FB NCC NBR")]),
        ("..dDd..", vec![(102..105, 103, "FB NCC NBR")]),
        ("dd........dd", vec![(100..112, 100, "FB NCC NBR")]),
        ("dd.........dd", vec![(100..102, 100, "FB NCC NBR"), (111..113, 111, "FB NCC NBR")]),
        ("ddkdd", vec![(100..102, 100, "FB NCC NBR"), (103..105, 103, "FB NCC NBR")]),
        ("..lll.", vec![(102..105, 102, "LOST")]),
        ("..dDllll", vec![(102..108, 103, "FB NCC NBR LOST")]),
        ("ddoodd", vec![(100..106, 100, "FB NCC NBR")]),
        ("kook", vec![]),
        ("..LLLL", vec![]),
        ("..OO..", vec![]),
        ("ddLLLl", vec![(100..102, 100, "FB NCC NBR"), (105..106, 105, "LOST")]),
        ("ddOdd", vec![(100..102, 100, "FB NCC NBR"), (103..105, 103, "FB NCC NBR")]),
        ("", vec![]),
    ] {
        let items = found(letters, &[]).items;
        let got: Vec<_> = items.iter().map(|i| (i.frames.clone(), i.worst, i.reasons.to_string())).collect();
        let want: Vec<_> = want.into_iter().map(|(f, w, r)| (f, w, r.to_owned())).collect();
        assert_eq!(got, want, "{letters}");
    }
}

#[test]
fn judged_segments_leave_and_come_back_when_their_samples_change() {
    let (span, parts) = written("..ddd.....");
    let accepted = judged(&span, 102..105, Verdict::Accepted);
    let later = judged(&span, 102..105, Verdict::Later);
    assert_eq!(found("..ddd.....", std::slice::from_ref(&accepted)).items, []);
    // A few frames more than were judged are no new item; many are.
    assert_eq!(found("..dddd....", std::slice::from_ref(&accepted)).items, []);
    assert_eq!(found("..ddddddddddddd", std::slice::from_ref(&accepted)).items.len(), 1);
    let put_off = found("..ddd.....", &[later]);
    assert!(put_off.items[0].later && put_off.judged.done() == 0);

    let mut moved = span;
    moved.samples[3].x += 0.5;
    let back = segments(TrackId(1), &moved, (&parts, &[]), [(accepted.0, &accepted.1)]);
    assert_eq!((back.items.len(), back.judged), (1, Tally::default()));
}

fn item(track: u32, first: u32, suspicion: f32, later: bool) -> Item {
    let frames = first..first + 5;
    let (reasons, parts) = Default::default();
    let (measured, opponent) = (first, None);
    Item { track: TrackId(track), worst: first, frames, reasons, measured, parts, opponent, suspicion, later }
}

#[test]
fn next_and_previous_go_by_rank_also_from_an_item_that_has_left() {
    let items =
        [item(7, 0, 0.9, false), item(3, 0, 0.5, false), item(3, 50, 0.5, false), item(1, 0, 0.99, true)];
    let mut queue = Queue::new(items.clone());
    let order: Vec<(u32, u32)> = queue.iter().map(|i| (i.track.0, i.frames.start)).collect();
    assert_eq!(order, [(7, 0), (3, 0), (3, 50), (1, 0)]);
    assert_eq!(queue.first(), Some(&items[0]));
    assert_eq!(queue.after(items[0].rank()), Some(&items[1]));
    assert_eq!(queue.before(items[2].rank()), Some(&items[1]));
    assert_eq!(queue.after(items[3].rank()), None);
    queue.set(TrackId(3), [item(3, 50, 0.95, false)]);
    assert_eq!(queue.get(items[1].rank()), None);
    assert_eq!(queue.after(items[1].rank()), Some(&items[3]));
    assert_eq!(queue.first().map(|i| i.frames.start), Some(50));
    assert_eq!((queue.len(), queue.of_track(TrackId(3)).count()), (3, 1));
    queue.set(TrackId(3), []);
    assert_eq!((queue.len(), queue.of_track(TrackId(3)).count()), (2, 0));
}

proptest! {
    #![proptest_config(Config { cases: 128, rng_seed: RngSeed::Fixed(0), failure_persistence: None, ..Config::default() })]

    #[test]
    fn order_of_arrival_does_not_matter(
        drawn in prop::collection::vec((0..9_u32, 0..9_u32, 0..5_u8, any::<bool>()), 0..40),
    ) {
        let mut items: BTreeMap<(u32, u32), Item> = BTreeMap::new();
        for (track, first, suspicion, later) in drawn {
            items.insert((track, first), item(track, first, f32::from(suspicion) / 5.0, later));
        }
        let queue = Queue::new(items.values().cloned());
        let mut by_track = Queue::default();
        for track in (0..9).rev() {
            by_track.set(TrackId(track), items.values().filter(|i| i.track.0 == track).rev().cloned());
        }
        prop_assert!(queue.iter().eq(by_track.iter()));
        let falls = |pair: &[&Item]| (pair[0].later, -pair[0].suspicion) <= (pair[1].later, -pair[1].suspicion);
        prop_assert!(queue.iter().collect::<Vec<_>>().windows(2).all(falls));
        prop_assert_eq!(queue.len(), items.len());
    }
}

#[test]
fn reasons_are_written_in_the_order_of_the_parts() {
    let nothing = Reasons::default();
    assert_eq!(nothing.to_string(), "");
    let all = Parts {
        fb_px: Some(9.0),
        ncc: Some(-0.5),
        jump: Some(90.0),
        nbr_px: Some(90.0),
        dis_px: Some(900.0),
        group_px: Some(900.0),
        ..Parts::default()
    };
    assert_eq!(Reasons::of(&all).and(Reasons::LOST).codes().collect::<Vec<_>>(), Reasons::CODES);
    assert_eq!(Reasons::of(&Parts { fb_px: Some(5.0), ..Parts::default() }).to_string(), "FB");
}

#[test]
fn effort_is_summed_by_track() {
    use honami_model::document::Document;
    use honami_model::edit::{Edit, Transaction, apply};
    let mut document = Document::new(200);
    let judge = |first_frame, keystrokes| {
        let (_, mut judgement) = judged(&Span::default(), first_frame..first_frame + 5, Verdict::Fixed);
        judgement.effort = Effort { keystrokes, key_frames: 1, seconds: 2.5 };
        Edit::Judge { track: TrackId(4), first_frame, judgement: Some(judgement) }
    };
    let mut edits = Transaction::add_track(TrackId(4), 0, 1.0, 2.0).edits;
    edits.extend([judge(10, 3), judge(20, 9)]);
    apply(&mut document, &Transaction { label: "judged".to_owned(), edits }).unwrap();
    let want = TrackEffort { segments: 2, effort: Effort { keystrokes: 12, key_frames: 2, seconds: 5.0 } };
    assert_eq!(effort(&document), [(TrackId(4), want)].into());
}
