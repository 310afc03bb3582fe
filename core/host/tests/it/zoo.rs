//! True plugins of every kind through the ABI: the same bits as without it, and the rules of streams.

#[path = "../zoo/drift.rs"]
mod drift;

use crate::tools::{HEIGHT, WIDTH, host, ids, of_zoo, pixels, point, push, start, stream, view};
use honami_host::{
    CallContext, DetectRequest, Flow, FrameView, HostError, Kind, Level, ParamKind, StreamInfo, Tracks,
    Value, Values,
};
use honami_model::hierarchy::Merge;
use honami_model::picture::{Chroma, Gray, Range};
use honami_model::track::Status;
use honami_plugin::{Frame, Seed, testing};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Bits of a row, so that equal means equal.
type Bits = (u32, u32, u32, u8, Option<u32>);

#[test]
fn through_the_abi_is_bit_for_bit_native() {
    let seeds = [(5, 0.1, 0.7), (9, 3.3, 1.9), (7, 6.9, 2.25)];
    let frames: Vec<Vec<u8>> = (0..6).map(pixels).collect();
    let seeds_native: Vec<Seed> = seeds.iter().map(|&(id, x, y)| Seed { id, x, y }).collect();
    let views = frames.iter().zip(0..).map(|(data, index)| {
        Frame::new(honami_plugin::Gray::packed(data, WIDTH, HEIGHT), index, index as f64 / 25.0)
    });
    let settings = drift::Settings { speed: 0.3, ..drift::Settings::default() };
    let native_rows =
        testing::track::<drift::Drift>(&settings, &testing::stream(WIDTH, HEIGHT), &seeds_native, views)
            .unwrap();
    let native: Vec<Vec<Bits>> = native_rows[..frames.len()]
        .iter()
        .map(|rows| {
            let bits = |p: &honami_plugin::Point| {
                (p.id, p.x.to_bits(), p.y.to_bits(), p.status as u8, p.fb.map(f32::to_bits))
            };
            rows.iter().map(bits).collect()
        })
        .collect();

    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &["speed=0.3"]).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    tracker.seed(&seeds.map(|(id, x, y)| point(id, x, y)), &cx).unwrap();
    let through: Vec<Vec<Bits>> = (0..6)
        .map(|n| {
            let points = push(&mut tracker, n).unwrap().remove(0);
            assert_eq!(points.frame, n);
            let bits = |p: &honami_host::PointRow| {
                (p.id, p.x.to_bits(), p.y.to_bits(), p.status as u8, p.fb.map(f32::to_bits))
            };
            points.rows.iter().map(bits).collect()
        })
        .collect();
    assert_eq!(native, through);
    assert!(tracker.end(&cx).unwrap().is_empty());
}

#[test]
fn a_stream_may_be_reversed_reseeded_corrected_and_retired_from() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &["speed=1"]).unwrap();
    tracker.begin(StreamInfo { reversed: true, ..stream() }, &cx).unwrap();
    assert!(push(&mut tracker, 9).unwrap()[0].rows.is_empty());
    tracker.seed(&[point(1, 5.0, 1.0), point(2, 6.0, 1.0)], &cx).unwrap();
    assert_eq!(push(&mut tracker, 8).unwrap()[0].rows[0].x.to_bits(), 4.0_f32.to_bits());
    // A correction of 1, a new 3, and 2 is retired; frames may be left out.
    tracker.seed(&[point(3, 2.0, 2.0), point(1, 7.0, 1.0)], &cx).unwrap();
    tracker.retire(&[2, 77], &cx).unwrap();
    let points = push(&mut tracker, 5).unwrap().remove(0);
    let mut at: Vec<(u32, f32)> = points.rows.iter().map(|row| (row.id, row.x)).collect();
    at.sort_by_key(|row| row.0);
    assert_eq!(at, [(1, 6.0), (3, 1.0)]);
    assert_eq!(points.ended, Vec::<u32>::new());
    let wrong_way = push(&mut tracker, 6).expect_err("a frame against the direction").to_string();
    assert!(wrong_way.contains("frame 6 does not come after frame 5"), "{wrong_way}");
    // That was the caller's mistake, not the tracker's: the stream goes on.
    assert_eq!(push(&mut tracker, 4).unwrap()[0].rows.len(), 2);
}

#[test]
fn seeds_that_are_no_places_do_not_reach_the_tracker() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &[]).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    for (seeds, want) in [
        ([point(1, 1.0, 1.0), point(2, f32::NAN, 1.0)], "point 2 has no finite position"),
        ([point(1, 1.0, f32::INFINITY), point(2, 1.0, 1.0)], "point 1 has no finite position"),
        ([point(5, 1.0, 1.0), point(5, 2.0, 1.0)], "point 5 is seeded twice"),
    ] {
        let refused = tracker.seed(&seeds, &cx).expect_err(want).to_string();
        assert!(refused.contains(want), "{refused}");
    }
    assert_eq!(push(&mut tracker, 0).unwrap()[0].rows, []);
}

#[test]
fn births_take_ids_from_the_reserved_range_and_end() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &["life=2"]).unwrap();
    tracker.begin(StreamInfo { births: 100..103, ..stream() }, &cx).unwrap();
    let taken = tracker.seed(&[point(101, 1.0, 1.0)], &cx).expect_err("an id of the births").to_string();
    assert!(taken.contains("101 has an id that is reserved for births"), "{taken}");
    let steps: Vec<_> = (0..5).map(|n| push(&mut tracker, n).unwrap().remove(0)).collect();
    let rows: Vec<_> = steps.iter().map(ids).collect();
    let newborn = Status::Newborn as u8;
    assert_eq!(
        rows,
        [
            vec![(100, newborn)],
            vec![(100, 1), (101, newborn)],
            vec![(101, 1), (102, newborn)],
            vec![(102, 1)],
            vec![],
        ]
    );
    let ended: Vec<_> = steps.iter().map(|points| points.ended.clone()).collect();
    assert_eq!(ended, [vec![], vec![], vec![100], vec![101], vec![102]]);
}

#[test]
fn late_rows_find_their_frames() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "delayed"), &[]).unwrap();
    assert_eq!(tracker.latency(), 2);
    tracker.begin(stream(), &cx).unwrap();
    let mut come = Vec::new();
    for n in 0..6 {
        match n {
            1 => tracker.seed(&[point(1, 1.0, 1.0), point(2, 2.0, 2.0)], &cx).unwrap(),
            4 => tracker.retire(&[1], &cx).unwrap(),
            _ => {}
        }
        come.push(push(&mut tracker, n * 10).unwrap());
    }
    come.push(tracker.end(&cx).unwrap());
    let shape: Vec<Vec<_>> = come
        .iter()
        .map(|all| {
            all.iter().map(|points| (points.frame, points.rows.iter().map(|r| r.id).collect())).collect()
        })
        .collect();
    assert_eq!(
        shape,
        [
            vec![],
            vec![],
            vec![(0, vec![])],
            vec![(10, vec![1, 2])],
            vec![(20, vec![1, 2])],
            vec![(30, vec![1, 2])],
            vec![(40, vec![2]), (50, vec![2])],
        ]
    );
}

/// What a seed or a retirement changes lies behind frames whose rows are still to come.
#[test]
fn late_rows_may_tell_of_several_lives() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "delayed"), &[]).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    let mut come = Vec::new();
    for n in 0..7 {
        match n {
            1 => tracker.seed(&[point(1, 1.0, 1.0), point(2, 2.0, 2.0), point(3, -1.0, 1.0)], &cx).unwrap(),
            // Point 3 has ended, which nobody but the tracker knows yet; this brings it back.
            3 => {
                tracker.retire(&[1, 2], &cx).unwrap();
                tracker.seed(&[point(2, 2.5, 2.0), point(3, 3.0, 1.0)], &cx).unwrap();
            }
            4 => tracker.seed(&[point(1, 1.5, 1.0), point(3, 3.5, 1.0)], &cx).unwrap(),
            5 => tracker.retire(&[1], &cx).unwrap(),
            6 => tracker.seed(&[point(1, 1.75, 1.0)], &cx).unwrap(),
            _ => {}
        }
        come.extend(push(&mut tracker, n).unwrap());
    }
    come.extend(tracker.end(&cx).unwrap());
    let shape: Vec<_> = come
        .iter()
        .map(|points| {
            let mut rows: Vec<_> = points.rows.iter().map(|row| (row.id, row.x)).collect();
            rows.sort_by_key(|row| row.0);
            (rows, points.ended.clone())
        })
        .collect();
    assert_eq!(
        shape,
        [
            (vec![], vec![]),
            (vec![(1, 1.0), (2, 2.0), (3, -1.0)], vec![]),
            (vec![(1, 1.0), (2, 2.0)], vec![3]),
            (vec![(2, 2.5), (3, 3.0)], vec![]),
            (vec![(1, 1.5), (2, 2.5), (3, 3.5)], vec![]),
            (vec![(2, 2.5), (3, 3.5)], vec![]),
            (vec![(1, 1.75), (2, 2.5), (3, 3.5)], vec![]),
        ]
    );
}

#[test]
fn detection_keeps_mask_distance_and_maximum() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &[]).unwrap();
    let (data, mut allowed) = (pixels(0), vec![0; 32]);
    allowed[8..24].fill(1);
    let mask = Gray { data: &allowed, width: WIDTH, height: HEIGHT, stride: WIDTH as usize };
    let points = [point(1, 7.0, 2.0)];
    let wanted = DetectRequest {
        frame: view(&data, 0),
        max_features: 2,
        mask: Some(mask),
        points: &points,
        max_threads: 1,
        seed: 0,
    };
    let found: Vec<_> = tracker.detect(&wanted, &cx).unwrap().iter().map(|f| (f.x, f.y, f.score)).collect();
    assert_eq!(found, [(6.0, 2.0, 154.0), (5.0, 2.0, 147.0)]);
    let small = Gray { width: WIDTH - 1, ..mask };
    let got = tracker
        .detect(&DetectRequest { mask: Some(small), ..wanted }, &cx)
        .expect_err("a mask that is too small");
    assert!(got.to_string().contains("the mask has another size"), "{got}");
}

#[test]
fn a_field_comes_with_its_grid() {
    let mut tracker = start(&of_zoo(Kind::Tracker, "drift"), &["speed=2"]).unwrap();
    let (a, b) = (pixels(0), pixels(1));
    let field = tracker.field(&view(&a, 0), &view(&b, 1), 1, &CallContext::silent()).unwrap();
    assert_eq!((field.nx, field.ny, field.origin, field.step), (2, 3, [1.0, 2.0], 4.0));
    let moved = Some([2.0, 0.0]);
    assert_eq!(field.vectors, [moved, moved, moved, moved, moved, None]);
}

#[test]
fn a_call_tells_its_progress_and_stops_when_told() {
    let info = of_zoo(Kind::Tracker, "drift");
    let (heard, lines) = (AtomicU32::new(0), Mutex::new(Vec::new()));
    let cx = CallContext {
        progress: &|fraction, words| {
            assert_eq!((fraction, words), (0.5, "drifting"));
            if heard.fetch_add(1, Relaxed) == 1 { Flow::Stop } else { Flow::Continue }
        },
        log: &|level, line| lines.lock().unwrap().push((level, line.to_owned())),
        ..CallContext::silent()
    };
    let (mut tracker, _) = host().tracker(&info, &Values::default(), &cx).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    assert_eq!(*lines.lock().unwrap(), [(Level::Info, "speed 0.1 Right ".to_owned())]);
    let data = pixels(0);
    tracker.push(&view(&data, 0), &cx).unwrap();
    assert!(matches!(tracker.push(&view(&data, 1), &cx), Err(HostError::Cancelled { .. })));
    // A cancelled stream is over; the instance is as good as new.
    tracker.begin(stream(), &cx).unwrap();
    tracker.push(&view(&data, 0), &cx).unwrap();
}

#[test]
fn a_panic_costs_the_instance_and_nothing_else() {
    let info = of_zoo(Kind::Tracker, "panics");
    for (place, wanted) in [("begin", "in begin"), ("push", "in push"), ("thread", "in a thread")] {
        let lines = Mutex::new(Vec::new());
        let log = |level, line: &str| lines.lock().unwrap().push((level, line.to_owned()));
        let cx = CallContext { log: &log, ..CallContext::silent() };
        let mut tracker = start(&info, &[&format!("place={place}")]).unwrap();
        let data = pixels(0);
        let failure = tracker
            .begin(stream(), &cx)
            .and_then(|()| tracker.push(&view(&data, 0), &cx).map(|_| ()))
            .expect_err(place)
            .to_string();
        assert!(failure.contains("a fault in the plugin") && failure.contains("panics.rs"), "{failure}");
        let told = lines.lock().unwrap();
        assert!(
            told.iter().any(|(level, line)| *level == Level::Error && line.contains("panics.rs")),
            "{told:?}"
        );
        // A scope tells of its thread's panic in words of its own; both are in the report of the first.
        assert!(place == "thread" || failure.contains(wanted), "{failure}");
    }
    let mut tracker = start(&info, &["place=drop"]).unwrap();
    tracker.begin(stream(), &CallContext::silent()).unwrap();
    drop(tracker);
}

#[test]
fn clusterings_come_checked_with_their_frame_notes() {
    let info = of_zoo(Kind::Clusterer, "chain");
    let cx = CallContext::silent();
    let (mut clusterer, origin) = host().clusterer(&info, &Values::default(), &cx).unwrap();
    assert_eq!(
        (origin.plugin_id.as_str(), origin.abi, origin.sandbox.as_str()),
        ("org.honami.zoo.chain", (1, 1), "in process")
    );
    assert_eq!(origin.plugin_sha256, info.sha256().unwrap());
    let mut tracks = Tracks::new(WIDTH, HEIGHT, 10, vec![0.5, 1.0, 1.75]);
    tracks.push(4, 10, [(1.0, 1.0, Status::Tracked); 3]);
    tracks.push(8, 11, [(2.0, 1.0, Status::Tracked), (2.5, 1.0, Status::Lost)]);
    tracks.push(6, 10, [(3.0, 1.0, Status::Occluded)]);
    let clustering = clusterer.run(&tracks, &cx).unwrap();
    // x of the first sample + samples seen + time of the last one.
    assert_eq!(
        clustering.dendrogram.merges(),
        [
            Merge { a: 0, b: 1, height: 2.0 + 1.0 + 1.75, size: 2 },
            Merge { a: 3, b: 2, height: 3.0 + 0.0 + 0.5, size: 3 },
        ]
    );
    assert_eq!((clustering.frames[0].frame, clustering.frames[0].outlier), (10, true));
    tracks.push(7, 12, [(1.0, 1.0, Status::Tracked); 2]);
    let got = clusterer.run(&tracks, &cx).expect_err("a sample beyond the times").to_string();
    assert!(got.contains("track 7 has samples in frames without a time"), "{got}");
    let none = Tracks::new(WIDTH, HEIGHT, 0, vec![0.0]);
    let got = clusterer.run(&none, &cx).expect_err("no tracks").to_string();
    assert!(got.contains("there is nothing to group (unusable data)"), "{got}");
}

#[test]
fn the_manifest_says_what_the_source_says() {
    let info = of_zoo(Kind::Tracker, "drift");
    assert_eq!(info.interfaces, ["honami.tracker/1", "honami.detect/1", "honami.field/1"]);
    assert_eq!(of_zoo(Kind::Tracker, "delayed").interfaces, ["honami.tracker/1"]);
    let [speed, way, life, note, corner, dice] = &info.params[..] else { panic!("{:?}", info.params) };
    assert_eq!(speed.doc, "How far every point goes in a frame;\n\"quotes\", \\ and tabs\tcome through.");
    assert_eq!((speed.label.as_str(), speed.unit.as_str()), ("Speed", "px/frame"));
    assert_eq!(speed.wanted(), "a number, -10 to 10 (px/frame)");
    let ParamKind::Enum { entries, .. } = &way.kind else { panic!("{way:?}") };
    assert_eq!(
        entries.iter().map(|e| (e.id.as_str(), e.doc.as_str())).collect::<Vec<_>>(),
        [("right", "x grows."), ("down", "y grows."),]
    );
    assert!(life.advanced && life.label == "life");
    assert_eq!(corner.default(), Value::List(vec![0.5, -1.5]));
    assert_eq!(dice.default(), Value::Int(7));
    let mut values = Values::defaults(&info.params);
    assert!(!values.is_active(note));
    values.set_text(&info.params, "way = down").unwrap();
    assert!(values.is_active(note));
}

/// Chroma of the stream's frames, 4 x 2 in rows of 6 bytes, of which the last two are the host's own business.
fn chroma(first: u8) -> Vec<u8> {
    (0..2).flat_map(|j| [0, 1, 2, 3, 77, 77].map(|i| if i < 77 { first + 10 * j + i } else { i })).collect()
}

#[test]
fn colour_reaches_the_plugin_as_the_clip_has_it() {
    let cx = CallContext::silent();
    let mut tracker = start(&of_zoo(Kind::Tracker, "tint"), &[]).unwrap();
    tracker.begin(stream(), &cx).unwrap();
    tracker.seed(&[point(0, 0.0, 0.0), point(1, 7.0, 1.0), point(2, 3.0, 3.0)], &cx).unwrap();
    let (luma, cb, cr) = (pixels(0), chroma(100), chroma(200));
    let plane = |data| Gray { data, width: WIDTH / 2, height: HEIGHT / 2, stride: 6 };
    let coloured = FrameView {
        chroma: Some(Chroma { cb: plane(&cb), cr: plane(&cr) }),
        range: Some(Range::Limited),
        ..view(&luma, 0)
    };
    let rows = |points: Vec<honami_host::Points>| -> Vec<_> {
        points[0].rows.iter().map(|row| (row.x as u8, row.y as u8, row.fb.map(|fb| fb as u32))).collect()
    };
    let answer = rows(tracker.push(&coloured, &cx).unwrap());
    assert_eq!(answer, [(100, 200, Some(1)), (103, 203, Some(1)), (111, 211, Some(1))]);
    let grey = rows(tracker.push(&view(&luma, 1), &cx).unwrap());
    assert_eq!(grey, [(0, 0, None); 3], "a clip without colour");

    let cut = Gray { height: 3, ..plane(&cb) };
    for (cb, cr) in [(cut, cut), (plane(&cb), Gray { width: 3, ..plane(&cr) })] {
        let torn = FrameView { chroma: Some(Chroma { cb, cr }), ..view(&luma, 2) };
        let refused = tracker.push(&torn, &cx).expect_err("planes that are not whole").to_string();
        assert!(refused.contains("not whole"), "{refused}");
    }
}
