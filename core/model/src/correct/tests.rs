//! What every correction owes: it can be taken back, it leaves key-frames alone, and it says what it changes.

use std::ops::Range;

use proptest::prelude::*;

use super::tracks::{average, duplicate, join, many, split, swap};
use super::*;
use crate::document::Origin;
use crate::track::TrackSet;

mod beside;
mod oracles;
mod ranges;
mod slid;

const N_FRAMES: u32 = 24;
const ID: TrackId = TrackId(42);

/// A track before it is corrected, with the runs below it.
#[derive(Clone, Debug)]
struct Given {
    track: Track,
    runs: Vec<(RunId, Span)>,
    times: FrameTimes,
}

impl Given {
    /// A run over all frames, at `path` of the frame's time; frames last 40 ms.
    fn run(path: impl Fn(f64) -> [f64; 2]) -> Self {
        let times = FrameTimes::constant(N_FRAMES, 25.0).expect("a rate");
        let at = |&t_s: &f64| sample(path(t_s), Status::Tracked, Source::Tracked);
        let samples = times.as_slice().iter().map(at).collect();
        let runs = vec![(RunId(1), Span { first_frame: 0, samples })];
        Self { track: Track::new(Origin::Run(RunId(1))), runs, times }
    }

    fn keyed(mut self, keys: &[(u32, f32, f32)]) -> Self {
        self.track.keys.extend(keys.iter().map(|&(frame, x, y)| (frame, Key::set(x, y))));
        self
    }

    fn unseen(mut self, frames: Range<u32>) -> Self {
        for frame in frames {
            self.runs[0].1.samples[frame as usize].status = Status::Lost;
        }
        self
    }

    fn shown(&self) -> Shown<'_> {
        Shown::new(ID, &self.track, &self.runs, &self.times)
    }
}

fn sample([x, y]: [f64; 2], status: Status, source: Source) -> Sample {
    Sample {
        x: x as f32,
        y: y as f32,
        status,
        source,
        quality: Quality { fb_px: Some(0.5), ncc: Some(0.75) },
    }
}

fn any_status() -> impl Strategy<Value = Status> {
    prop_oneof![6 => Just(Status::Tracked), 2 => Just(Status::Occluded), 2 => Just(Status::Lost), 1 => Just(Status::Outside)]
}

fn any_sample() -> impl Strategy<Value = Sample> {
    let source =
        prop_oneof![3 => Just(Source::Tracked), 1 => Just(Source::Sketch), 1 => Just(Source::Interpolated)];
    (0.0..99.0, 0.0..99.0, any_status(), source)
        .prop_map(|(x, y, status, source)| sample([x, y], status, source))
}

fn any_given() -> impl Strategy<Value = Given> {
    let key = (0.0_f32..99.0, 0.0_f32..99.0, any_status())
        .prop_map(|(x, y, status)| Key { status, ..Key::set(x, y) });
    let keys = prop::collection::btree_map(0..N_FRAMES, key, 0..6);
    let over = prop_oneof![
        5 => any_sample().prop_map(|sample| Over::Sample(Laid { sample, run: None })),
        1 => Just(Over::Nothing),
    ];
    let over = prop::collection::btree_map(0..N_FRAMES, over, 0..9);
    let run = (0..N_FRAMES, prop::collection::vec(any_sample(), 1..30));
    let steps = prop::collection::vec(0.01_f64..0.1, N_FRAMES as usize);
    (keys, over, prop::collection::vec(run, 0..4), steps).prop_map(|(keys, over, runs, steps)| {
        let mut t_s = 0.0;
        let times = steps
            .iter()
            .map(|step| {
                t_s += step;
                t_s
            })
            .collect();
        let span = |(first_frame, samples)| Span { first_frame, samples };
        Given {
            track: Track { keys, over, ..Track::new(Origin::Hand) },
            runs: (1..).map(RunId).zip(runs.into_iter().map(span)).collect(),
            times: FrameTimes::new(times).expect("increasing"),
        }
    })
}

/// Every tool on one track, at a frame and up to another one.
fn every_tool(
    shown: &Shown<'_>,
    frame: u32,
    end: u32,
    to: [f32; 2],
) -> Vec<(&'static str, Result<Correction, Refused>)> {
    let frames = frame.min(end)..frame.max(end);
    let at = |to: [f32; 2]| to.map(f64::from);
    let drawn =
        [(0.0, to), (0.1, [5.0, 6.0]), (0.7, to)].map(|(elapsed_s, to)| Drawn { elapsed_s, at: at(to) });
    let played = Played { from_s: shown.times().get(frame).unwrap_or(0.0), rate: 0.5, delay_s: 0.195 };
    let stroke = Stroke { played, drawn: drawn.to_vec() };
    vec![
        ("key only", key_only(shown, frame, to)),
        ("linear", linear(shown, frame, to)),
        ("hermite", hermite(shown, frame, to)),
        ("space", space(shown, frame, to)),
        ("time", time(shown, frame, f64::from(to[0]) / 200.0 - 0.25).map(|slid| slid.correction)),
        ("sketch", sketch(shown, &[stroke])),
        ("lost", mark(shown, frames.clone(), Status::Lost)),
        ("occluded", mark(shown, frames.clone(), Status::Occluded)),
        ("seen", mark(shown, frames.clone(), Status::Tracked)),
        ("delete", delete_range(shown, frames)),
        (
            "then",
            key_only(shown, frame, to)
                .and_then(|first| shown.then(&first, |shown| space(shown, frame, to), "corrected")),
        ),
    ]
}

fn document(tracks: &[(TrackId, &Track)]) -> Document {
    let mut document = Document::new(N_FRAMES);
    document.tracks.extend(tracks.iter().map(|&(id, track)| (id, track.clone())));
    document
}

proptest! {
    #[test]
    fn corrections_keep_their_word(
        given in any_given(), frame in 0..N_FRAMES, end in 0..N_FRAMES + 4,
        to in prop::array::uniform2(0.0_f32..99.0),
    ) {
        let shown = given.shown();
        for (tool, correction) in every_tool(&shown, frame, end, to) {
            let Ok(correction) = correction else { continue };
            let before = document(&[(ID, &given.track)]);
            let mut after = before.clone();
            let back = apply(&mut after, &correction.transaction).unwrap();
            let track = after.track(ID).unwrap();
            prop_assert_eq!(track, &correction.track, "{}: the preview is what is done", tool);
            let now = Shown::new(ID, track, &given.runs, &given.times);
            prop_assert_eq!(now.span(), &correction.span, "{}: and what is shown", tool);
            for at in (0..N_FRAMES).filter(|at| !correction.affected.contains(at)) {
                prop_assert_eq!(shown.span().get(at), now.span().get(at), "{}: frame {} is not affected", tool, at);
            }
            for (at, key) in given.track.keys.iter().filter(|(at, _)| **at != frame && tool != "delete") {
                let now = track.keys.get(at).map(|key| (key.x, key.y, key.made));
                prop_assert_eq!(now, Some((key.x, key.y, key.made)), "{}: the key-frame at {}", tool, at);
            }
            apply(&mut after, &back).unwrap();
            prop_assert_eq!(&after, &before, "{}: it is taken back", tool);
        }
    }

    #[test]
    fn steps_on_whole_tracks_are_taken_back(
        a in any_given(), b in any_given(), frame in 0..N_FRAMES, end in 0..N_FRAMES + 4,
    ) {
        let (other, new) = (TrackId(50), TrackId(99));
        let (shown, beside) = (a.shown(), Shown::new(other, &b.track, &b.runs, &a.times));
        let frames = frame.min(end)..frame.max(end);
        let both = [shown.clone(), beside.clone()];
        for (tool, step) in [
            ("split", split(&shown, frame, new)),
            ("swap", swap(&shown, &beside, frames.clone())),
            ("join", join(&shown, &beside)),
            ("duplicate", duplicate(&shown, new)),
            ("average", average(&both, new)),
            ("many", many(&both, |shown| mark(shown, frames.clone(), Status::Lost))),
        ] {
            let Ok(step) = step else { continue };
            let before = document(&[(ID, &a.track), (other, &b.track)]);
            let mut after = before.clone();
            let back = apply(&mut after, &step).unwrap();
            let span = |id, runs| Shown::new(id, after.track(id).unwrap(), runs, &a.times).span().clone();
            let same = |was: &Span, is: &Span, frames: Range<u32>| frames.clone().all(|at| {
                let seen = |span: &Span| span.get(at).filter(|sample| sample.status != Status::Lost).copied();
                seen(was) == seen(is)
            });
            let all = 0..N_FRAMES;
            match tool {
                "split" => {
                    prop_assert!(same(shown.span(), &span(ID, &a.runs), 0..frame), "{:?}", step);
                    prop_assert!(same(shown.span(), &span(new, &[]), frame..N_FRAMES), "{:?}", step);
                    prop_assert!(span(ID, &a.runs).frames().end <= frame);
                }
                "swap" => {
                    for (was, id, runs) in [(&shown, ID, &a.runs), (&beside, other, &b.runs)] {
                        prop_assert!(same(was.span(), &span(id, runs), 0..frames.start), "{:?}", step);
                        prop_assert!(same(was.span(), &span(id, runs), frames.end..N_FRAMES.max(frames.end)), "{:?}", step);
                    }
                    prop_assert!(same(shown.span(), &span(other, &b.runs), frames.clone()), "{:?}", step);
                    prop_assert!(same(beside.span(), &span(ID, &a.runs), frames.clone()), "{:?}", step);
                }
                "duplicate" => prop_assert!(same(shown.span(), &span(new, &[]), all), "{:?}", step),
                "join" => prop_assert!(after.track(other).unwrap().deleted),
                _ => {}
            }
            apply(&mut after, &back).unwrap();
            prop_assert_eq!(&after, &before, "{}: it is taken back", tool);
        }
    }
}

#[test]
fn refusals_say_what_to_do() {
    let given = Given::run(|_| [0.0, 0.0]).keyed(&[(5, 0.0, 0.0), (6, 0.0, 0.0)]);
    let shown = given.shown();
    let mut short = given.clone();
    short.runs[0].1.samples.truncate(10);
    for (refused, want) in [
        (
            space(&short.shown(), 12, [1.0, 1.0]).err(),
            "track 42 is not seen at frame 12; go to a frame where it is",
        ),
        (mark(&short.shown(), 12..20, Status::Lost).err(), "track 42 has no samples in frames 12-19"),
        (mark(&short.shown(), 2..4, Status::Tracked).err(), "track 42: frames 2-3 are already seen"),
        (delete_range(&short.shown(), 0..20).err(), "that is all of track 42: delete the track instead"),
        (
            sketch(&shown, &[]).err(),
            "the stroke covers no frame; draw while the clip plays, for longer than its delay",
        ),
        (key_only(&shown, 3, [f32::NAN, 0.0]).err(), "track 42: the position at frame 3 is not finite"),
        (split(&shown, 0, TrackId(99)).err(), "track 42 has no samples in frame 0"),
        (average(&[], TrackId(99)).err(), "none of these tracks is seen where it would help; pick others"),
    ] {
        assert_eq!(refused.map(|why| why.to_string()).as_deref(), Some(want));
    }
}

#[test]
fn lines_say_which_frames_and_how_far() {
    let given = Given::run(|t_s| [100.0 * t_s, 10.0]).keyed(&[(4, 16.0, 10.0), (16, 64.0, 10.0)]);
    let shown = given.shown();
    let label =
        |correction: Result<Correction, Refused>| correction.map(|correction| correction.transaction.label);
    let mut other = given.clone();
    other.runs[0].1.samples.truncate(12);
    let beside = Shown::new(TrackId(50), &other.track, &other.runs, &given.times);
    let whole = |step: Result<Transaction, Refused>| step.map(|step| step.label);
    for (line, want) in [
        (label(key_only(&shown, 10, [40.0, 16.3])), "track 42: key-frame at 10 (moved 6.3 px)"),
        (label(space(&shown, 10, [40.0, 16.3])), "track 42: frames 5-15 corrected, up to 6.3 px"),
        (
            label(hermite(&shown, 10, [40.0, 16.3])),
            "track 42: frames 5-15 drawn through key-frames, up to 6.3 px",
        ),
        (
            label(linear(&shown, 10, [40.0, 16.3])),
            "track 42: frames 5-15 drawn straight between key-frames, up to 6.3 px",
        ),
        (
            label(time(&shown, 10, 0.04).map(|slid| slid.correction)),
            "track 42: frames 5-15 shifted in time, up to 4.0 px",
        ),
        (label(mark(&shown, 10..20, Status::Occluded)), "track 42: frames 10-19 occluded with 1 key-frame"),
        (label(delete_range(&shown, 2..18)), "track 42: frames 2-17 taken away with 2 key-frames"),
        (whole(split(&shown, 10, TrackId(99))), "track 42 split at 10: track 99 goes on"),
        (whole(swap(&shown, &beside, 10..N_FRAMES)), "tracks 42 and 50 swapped: frames 10-23"),
        (whole(join(&beside, &shown)), "track 50 joined with track 42: frames 12-23 filled"),
        (whole(duplicate(&shown, TrackId(99))), "track 42 duplicated: track 99"),
        (whole(average(&[shown.clone(), beside.clone()], TrackId(99))), "average of 2 tracks: track 99"),
        (
            whole(many(&[shown.clone(), beside.clone()], |shown| mark(shown, 2..4, Status::Lost))),
            "2 tracks: frames 2-3 lost",
        ),
    ] {
        assert_eq!(line.as_deref(), Ok(want));
    }
    let tracks: TrackSet = [ID, TrackId(50)].into_iter().collect();
    assert_eq!(swap(&shown, &beside, 10..N_FRAMES).unwrap().touched(), tracks);
}
