//! Points on pictures whose motion is known: without drift, through turns, light and things that pass before them.

use super::*;
use crate::texture;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;

/// A tracker that has seen no picture, with points on a grid `step` pixels apart, 20 px from the border.
fn on_grid(params: Params, step: usize) -> (Tracker, Vec<Point>) {
    let mut tracker = Tracker::new(params, 1);
    let points: Vec<Point> = (20..HEIGHT as usize - 20)
        .step_by(step)
        .flat_map(|y| (20..WIDTH as usize - 20).step_by(step).map(move |x| [x as f32 + 0.3, y as f32 - 0.2]))
        .collect();
    tracker.seed((0..).zip(points.iter().copied()));
    (tracker, points)
}

fn push(tracker: &mut Tracker, picture: &[u8]) -> Vec<Row> {
    let gray = Gray::packed(picture, WIDTH, HEIGHT);
    let done: Result<(), std::convert::Infallible> = tracker.push(&gray, |_| Ok(()));
    assert!(done.is_ok());
    tracker.rows().collect()
}

fn distance(a: Point, b: Point) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values[values.len() / 2]
}

/// A motion of the whole picture: angle, growth, shift, gain and offset of the light.
#[derive(Clone, Copy)]
struct Motion {
    turn_rad: f64,
    growth: f64,
    shift: [f64; 2],
    gain: f64,
    offset: f64,
}

const REST: Motion = Motion { turn_rad: 0.0, growth: 1.0, shift: [0.0; 2], gain: 1.0, offset: 0.0 };

impl Motion {
    fn to(self, [x, y]: Point) -> Point {
        let (sin, cos) = self.turn_rad.sin_cos();
        let (x, y) = (f64::from(x) - 80.0, f64::from(y) - 60.0);
        let moved = [
            80.0 + self.growth * (cos * x - sin * y) + self.shift[0],
            60.0 + self.growth * (sin * x + cos * y) + self.shift[1],
        ];
        moved.map(|c| c as f32)
    }

    fn picture(self, frame: usize) -> Vec<u8> {
        let (sin, cos) = self.turn_rad.sin_cos();
        texture::render(WIDTH, HEIGHT, |x, y| {
            let (x, y) = ((x - 80.0 - self.shift[0]) / self.growth, (y - 60.0 - self.shift[1]) / self.growth);
            let noise = 1.5 * texture::hash(frame as u64, (x * 64.0) as i64, (y * 64.0) as i64);
            let value = texture::value(5, 80.0 + cos * x + sin * y, 60.0 - sin * x + cos * y);
            self.gain * (value - 128.0) + 128.0 + self.offset + noise
        })
    }
}

#[test]
fn turns_growth_light_and_all_at_once_are_followed() {
    type Case = (&'static str, fn(f64) -> Motion);
    let cases: [Case; 5] = [
        ("turn by 60 degrees", |t| Motion { turn_rad: t * 1.05, ..REST }),
        ("growth by a third", |t| Motion { growth: 1.0 + t / 3.0, ..REST }),
        ("light to 60 % and brighter", |t| Motion { gain: 1.0 - 0.4 * t, offset: 30.0 * t, ..REST }),
        ("shift by 4.5 px a frame", |t| Motion { shift: [54.0 * t, -72.0 * t], ..REST }),
        ("all of it", |t| Motion {
            turn_rad: -0.5 * t,
            growth: 1.0 - 0.2 * t,
            shift: [20.0 * t, 10.0 * t],
            gain: 1.0 + 0.2 * t,
            offset: -15.0 * t,
        }),
    ];
    for (name, motion) in cases {
        for neighbours in [0, 32] {
            let (mut tracker, points) = on_grid(Params { neighbours, ..Params::default() }, 13);
            for frame in 0..=20 {
                let motion = motion(frame as f64 / 20.0);
                let rows = push(&mut tracker, &motion.picture(frame));
                let gray = Gray { data: &[], width: WIDTH, height: HEIGHT, stride: 0 };
                let inner = |at: Point| {
                    live::holds(&gray, [at[0] - 12.0, at[1] - 12.0])
                        && live::holds(&gray, [at[0] + 12.0, at[1] + 12.0])
                };
                let truths = points.iter().map(|&at| motion.to(at));
                let errors: Vec<f32> = rows
                    .iter()
                    .zip(truths)
                    .filter(|(_, to)| inner(*to))
                    .map(|(row, to)| {
                        assert_eq!(row.state, State::Tracked, "{name}, frame {frame}: {row:?}");
                        distance(row.at, to)
                    })
                    .collect();
                let worst = errors.iter().copied().fold(0.0, f32::max);
                assert!(worst < 0.35, "{name}, {neighbours} neighbours, frame {frame}: {worst}");
                assert!(median(errors) < 0.12, "{name}, {neighbours} neighbours, frame {frame}");
            }
        }
    }
}

#[test]
fn three_hundred_frames_do_not_add_up_to_a_drift() {
    let motion = |frame: usize| {
        let t = frame as f64;
        Motion {
            shift: [9.0 * (0.21 * t).sin(), 6.0 * (0.33 * t).sin()],
            turn_rad: 0.3 * (0.17 * t).sin(),
            ..REST
        }
    };
    let (mut tracker, points) = on_grid(Params::default(), 20);
    let params = klt::Params::default();
    let mut before = Pyramid::new(&Gray::packed(&motion(0).picture(0), WIDTH, HEIGHT), 4, 10);
    let mut chained = points.clone();
    let mut rows = Vec::new();
    for frame in 0..300 {
        let picture = motion(frame).picture(frame);
        rows = push(&mut tracker, &picture);
        let now = Pyramid::new(&Gray::packed(&picture, WIDTH, HEIGHT), 4, 10);
        chained = klt::track(&before, &now, &chained, None, &params, 1).iter().map(|flow| flow.to).collect();
        before = now;
    }
    let truth = |at: &Point| motion(299).to(*at);
    let anchored = median(rows.iter().zip(&points).map(|(row, at)| distance(row.at, truth(at))).collect());
    let chained = median(chained.iter().zip(&points).map(|(to, at)| distance(*to, truth(at))).collect());
    assert!(rows.iter().all(|row| row.state == State::Tracked));
    assert!(anchored < 0.06 && chained > 4.0 * anchored, "anchored {anchored}, chained {chained}");
}

/// Frames of a drifting texture with a disc that stands before it in some of them.
fn passing(frame: usize, hidden: std::ops::Range<usize>) -> (Motion, Vec<u8>) {
    let motion = Motion { shift: [0.8 * frame as f64, 0.5 * frame as f64], ..REST };
    let mut picture = motion.picture(frame);
    if hidden.contains(&frame) {
        for (k, pixel) in picture.iter_mut().enumerate() {
            let (x, y) = ((k % WIDTH as usize) as f64, (k / WIDTH as usize) as f64);
            if (x - 70.0).hypot(y - 60.0) < 22.0 {
                *pixel = (120.0 + 3.0 * texture::hash(frame as u64, x as i64, y as i64)) as u8;
            }
        }
    }
    (motion, picture)
}

#[test]
fn a_hidden_point_is_carried_by_its_neighbours_and_found_again() {
    for (neighbours, reach_px) in [(32, 2.0), (0, 30.0)] {
        let (mut tracker, points) = on_grid(Params { neighbours, ..Params::default() }, 13);
        let middle = (0..points.len()).min_by(|&a, &b| {
            let off = |k: usize| distance(points[k], [62.0, 56.0]);
            off(a).total_cmp(&off(b))
        });
        let middle = middle.unwrap_or(0);
        for frame in 0..26 {
            let (motion, picture) = passing(frame, 5..15);
            let row = push(&mut tracker, &picture)[middle];
            let off = distance(row.at, motion.to(points[middle]));
            let hidden = (5..15).contains(&frame);
            let state = if hidden { State::Occluded } else { State::Tracked };
            let name = format!("{neighbours} neighbours, frame {frame}: {row:?}, off by {off}");
            // By itself it has to come upon the point; with its neighbours it waits for it.
            if neighbours > 0 || frame < 15 {
                assert_eq!(row.state, state, "{name}");
                assert!(off < if hidden { reach_px } else { 0.3 }, "{name}");
            }
            assert_eq!(row.ncc.is_some(), row.state == State::Tracked && frame > 0, "{name}");
        }
    }
}

/// Brightness around a point that a drifting texture carries: at an offset, where there was a texture, in a frame.
type Look = fn(Point, u8, usize) -> f64;

#[test]
fn what_only_resembles_the_template_stays_hidden() {
    let cases: [(&str, Look); 2] = [
        ("its own look, later a trace of it on plain ground", |_, own, frame| {
            if frame < 5 { f64::from(own) } else { 120.0 + 0.05 * (f64::from(own) - 128.0) }
        }),
        ("stripes, later five pixels aside", |[x, _], _, frame| {
            let aside = if frame < 5 { 0.0 } else { 5.0 };
            128.0 + 60.0 * ((f64::from(x) - aside) * 0.6).sin()
        }),
    ];
    for (name, look) in cases {
        let (mut tracker, points) = on_grid(Params::default(), 9);
        let middle = points.len() / 2;
        for frame in 0..20 {
            let motion = Motion { shift: [0.8 * frame as f64, 0.5 * frame as f64], ..REST };
            let mut picture = motion.picture(frame);
            let to = motion.to(points[middle]);
            for (k, pixel) in picture.iter_mut().enumerate() {
                let off = [(k % WIDTH as usize) as f32 - to[0], (k / WIDTH as usize) as f32 - to[1]];
                if off[0].abs().max(off[1].abs()) < 8.5 {
                    *pixel = look(off, *pixel, frame) as u8;
                }
            }
            let row = push(&mut tracker, &picture)[middle];
            let state = if frame < 5 { State::Tracked } else { State::Occluded };
            assert_eq!(row.state, state, "{name}, frame {frame}: {row:?}");
            assert!(distance(row.at, to) < 3.0, "{name}, frame {frame}: {row:?} for {to:?}");
        }
    }
}

#[test]
fn a_point_leaves_the_picture_and_comes_back() {
    let (mut tracker, points) = on_grid(Params::default(), 13);
    let mut states = Vec::new();
    for frame in 0..60_usize {
        let motion = Motion { shift: [40.0 * (0.105 * frame as f64).sin(), 0.0], ..REST };
        let row = push(&mut tracker, &motion.picture(frame))[8];
        let to = motion.to(points[8]);
        assert!(row.at[0].is_finite() && row.at[1].is_finite());
        if row.state == State::Tracked {
            assert!(distance(row.at, to) < 0.5, "frame {frame}: {row:?} for {to:?}");
        }
        states.push(row.state);
    }
    assert!(states.contains(&State::Outside), "{states:?}");
    assert_eq!(states.last(), Some(&State::Tracked));
}

#[test]
fn a_key_frame_elsewhere_ends_the_older_templates_and_one_here_keeps_them() {
    let (mut tracker, points) = on_grid(Params::default(), 13);
    let from = points[20];
    for (frame, seeded, n_templates) in [
        (0, None, 1),
        (3, Some([0.0, 0.0]), 2),
        (6, Some([0.6, -0.4]), 3),
        (9, Some([0.0, 0.0]), 3),
        (12, Some([17.0, 9.0]), 1),
    ] {
        let motion = |frame: usize| Motion { shift: [0.7 * frame as f64, -0.4 * frame as f64], ..REST };
        let gray = motion(frame).picture(frame);
        if frame == 0 {
            push(&mut tracker, &gray);
        } else {
            for frame in frame - 2..=frame {
                push(&mut tracker, &motion(frame).picture(frame));
            }
        }
        let to = motion(frame).to(from);
        if let Some([dx, dy]) = seeded {
            tracker.seed([(20, [to[0] + dx, to[1] + dy])]);
        }
        assert_eq!(tracker.live[20].templates.len(), n_templates, "frame {frame}");
        let Some([dx, dy]) = seeded else { continue };
        let row = push(&mut tracker, &motion(frame + 1).picture(frame + 1))[20];
        let to = motion(frame + 1).to([from[0] + dx, from[1] + dy]);
        assert!(
            distance(row.at, to) < 0.15 && row.state == State::Tracked,
            "frame {frame}: {row:?} for {to:?}"
        );
        // The next case begins from there.
        push(&mut tracker, &motion(frame).picture(frame));
    }
}

#[test]
fn levels_and_threads_give_the_same_bits() {
    let run = |level: simd::Level, n_threads: usize| {
        let mut tracker = Tracker::at_level(level, Params::default(), n_threads);
        let place = |k: u32| [(k * 37 % 160) as f32 + 0.31, (k * 53 % 120) as f32 - 0.17];
        tracker.seed((0..300).map(|k| (k, place(k))));
        (0..6).map(|frame| push(&mut tracker, &passing(frame, 2..5).1)).collect::<Vec<_>>()
    };
    let plain = run(simd::available().next().unwrap_or(simd::best()), 1);
    for level in simd::available() {
        for n_threads in [1, 3] {
            assert!(run(level, n_threads) == plain, "{} with {n_threads} threads", level.name());
        }
    }
}

#[test]
fn what_cannot_be_found_is_hidden_then_lost_and_stays_finite() {
    let flat = vec![90; (WIDTH * HEIGHT) as usize];
    let noise = texture::render(WIDTH, HEIGHT, |x, y| 128.0 + 90.0 * texture::hash(3, x as i64, y as i64));
    for later in [flat.clone(), noise] {
        let (mut tracker, _) = on_grid(Params { patience: 3, companions: 0, ..Params::default() }, 29);
        push(&mut tracker, &REST.picture(0));
        for frame in 1..7 {
            for row in push(&mut tracker, &later) {
                let state = if frame <= 3 { State::Occluded } else { State::Lost };
                assert!(row.state == state || row.state == State::Outside, "frame {frame}: {row:?}");
                assert!(row.at.iter().all(|c| c.is_finite()));
            }
        }
    }
    let mut tracker = Tracker::new(Params::default(), 1);
    tracker.seed([(0, [f32::NAN, 3.0]), (1, [30.0, 30.0]), (2, [-1e30, 1e30])]);
    for _ in 0..3 {
        let rows = push(&mut tracker, &flat);
        assert!(rows.iter().all(|row| row.at.iter().all(|c| c.is_finite())), "{rows:?}");
        assert_eq!((rows[0].state, rows[2].state), (State::Outside, State::Outside));
    }
}

#[test]
fn a_single_point_is_given_company_that_is_not_reported() {
    for (companions, reach_px) in [(24, 2.0), (0, 60.0)] {
        let mut tracker = Tracker::new(Params { companions, ..Params::default() }, 1);
        tracker.seed([(7, [58.0, 52.0])]);
        for frame in 0..24 {
            let (motion, picture) = passing(frame, 5..15);
            let rows = push(&mut tracker, &picture);
            assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), [7]);
            let off = distance(rows[0].at, motion.to([58.0, 52.0]));
            let hidden = (5..15).contains(&frame);
            if companions > 0 || frame < 15 {
                let state = if hidden { State::Occluded } else { State::Tracked };
                assert_eq!(rows[0].state, state, "{companions} companions, frame {frame}: {:?}", rows[0]);
                assert!(off < if hidden { reach_px } else { 0.3 }, "frame {frame}: off by {off}");
            }
        }
        assert_eq!(tracker.live.len() > 10, companions > 0);
        // It leaves with the point: nobody follows what nobody asks for.
        tracker.retire([7]);
        push(&mut tracker, &REST.picture(0));
        assert_eq!(tracker.live.len(), 0);
    }
}

#[test]
fn whoever_is_asked_to_stop_stops() {
    let (mut tracker, _) = on_grid(Params::default(), 13);
    push(&mut tracker, &REST.picture(0));
    let picture = REST.picture(1);
    let gray = Gray::packed(&picture, WIDTH, HEIGHT);
    assert_eq!(tracker.push(&gray, |share| if share < 0.4 { Ok(()) } else { Err("enough") }), Err("enough"));
}

/// A tracker of a picture with many points, a quarter of a pixel and more apart.
fn crowded(n: u32) -> Tracker {
    let mut tracker = Tracker::new(Params { radius_px: 2, ..Params::default() }, 1);
    push(&mut tracker, &REST.picture(0));
    tracker.seed((0..n).map(|id| (id, [10.0 + 0.35 * (id % 400) as f32, 10.0 + 0.35 * (id / 400) as f32])));
    tracker
}

#[test]
fn a_hundred_thousand_points_come_and_go_at_once() {
    let mut tracker = crowded(100_000);
    assert_eq!(tracker.rows().len(), 100_000);
    tracker.retire((0..200_000).filter(|id| id % 4 > 0));
    let ids: Vec<u32> = tracker.rows().map(|row| row.id).collect();
    assert_eq!(ids, (0..100_000).step_by(4).collect::<Vec<u32>>());
    tracker.retire(ids);
    assert_eq!(tracker.rows().len(), 0);
}

#[test]
fn a_hundred_thousand_points_can_be_stopped_between_any_few_hundred() {
    let mut tracker = crowded(100_000);
    let picture = REST.picture(1);
    let mut asked = Vec::new();
    // All of the relating and the first of the looking.
    let stopped = tracker.push(&Gray::packed(&picture, WIDTH, HEIGHT), |share| {
        asked.push(share);
        if share < 0.205 { Ok(()) } else { Err("enough") }
    });
    assert_eq!(stopped, Err("enough"));
    let relating = asked.iter().filter(|&&share| share < 0.2).count();
    assert!(relating >= 2 * 100_000 / POINTS_A_LOOK, "asked {relating} times");
    assert!(asked.is_sorted() && asked.iter().all(|share| (0.0..=1.0).contains(share)));
}

#[test]
fn larger_windows_are_asked_about_more_often() {
    let looks = |radius_px, search_px, n_threads| {
        Tracker::new(Params { radius_px, search_px, ..Params::default() }, n_threads).points_a_look()
    };
    let usual = Params::default();
    assert_eq!(looks(usual.radius_px, usual.search_px, 1), POINTS_A_LOOK);
    assert_eq!(looks(usual.radius_px, usual.search_px, 4), 4 * POINTS_A_LOOK);
    assert!((8..16).contains(&looks(50, 4, 1)));
    assert!((8..16).contains(&looks(7, 64, 1)));
    assert_eq!(looks(50, 64, 2), 2);
}

#[test]
fn companions_are_shared_and_bounded() {
    // A knot of points by itself: the company of the first serves the others; (points, pixels between them).
    for (n, step_px, most) in [(10, 3.0, 40), (1, 3.0, 24)] {
        let mut tracker = Tracker::new(Params::default(), 1);
        tracker.seed((0..n).map(|id| (id, [70.0 + step_px * id as f32, 60.0])));
        push(&mut tracker, &REST.picture(0));
        push(&mut tracker, &REST.picture(1));
        let n_companions = tracker.live.len() - n as usize;
        assert!((5..=most).contains(&n_companions), "{n} points have {n_companions}");
    }
}
