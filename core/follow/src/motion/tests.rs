//! Points through motion that is given, not measured: what the tracker makes of it.

use std::sync::atomic::{AtomicBool, Ordering};

use honami_plugin::{Gray as Luma, Listener, Point, Points, Seed, Status, Tracker, params, testing};
use honami_vision::field::Grid;

use super::*;
use crate::{Follower, Losing};

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

params! {
    /// Motion to the right that is not known below the middle, and comes back too short.
    pub struct Given {
        /// Whether it is measured back.
        backward: bool = true => {},
        ..losing: Losing,
        ..detection: Detection,
    }
}

impl Motion for Given {
    const INFO: Info =
        Info { id: "org.example.given", name: "Given", doc: "u = brightness / 10", ..Info::NEW };
    type Kept = Vec<u8>;

    fn keep(&self, picture: &Gray<'_>, _: usize) -> Vec<u8> {
        (0..picture.height).flat_map(|y| picture.row(y)).copied().collect()
    }

    fn kept(kept: &Vec<u8>) -> Gray<'_> {
        Gray::packed(kept, WIDTH, HEIGHT)
    }

    fn measure(&self, from: &Vec<u8>, to: &Vec<u8>, _: usize, go_on: &dyn Fn(f64) -> bool) -> Option<Field> {
        let [u, later] = [from[0], to[0]].map(|b| f32::from(b) / 10.0);
        let u = if u < later { u } else { -0.75 * later };
        let grid = Grid::over(WIDTH, HEIGHT, 1);
        let known = |[_, y]: Place| (y < 15.0).then_some([u, 0.0]);
        go_on(0.5).then(|| Field::new(grid, grid.nodes().map(known)))
    }

    fn is_backward(&self) -> bool {
        self.backward
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: 3, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

/// Rows of each frame, without those of the end; frame t has brightness 10 (t + 1).
fn rows(given: &Given, seeds: &[(f32, f32)], n: u8) -> Vec<Vec<Point>> {
    let data: Vec<Vec<u8>> = (1..=n).map(|t| vec![10 * t; (WIDTH * HEIGHT) as usize]).collect();
    let frames = data.iter().enumerate();
    let frames = frames.map(|(t, data)| Frame::new(Luma::packed(data, WIDTH, HEIGHT), t as i64, t as f64));
    let seeds: Vec<Seed> = (0..).zip(seeds).map(|(id, &(x, y))| Seed { id, x, y }).collect();
    let mut rows = testing::track::<Follower<Given>>(given, &testing::stream(WIDTH, HEIGHT), &seeds, frames);
    rows.as_mut().unwrap().pop();
    rows.unwrap()
}

#[test]
fn points_are_carried_lost_where_motion_is_not_known_and_left_outside() {
    let rows = rows(&Given::default(), &[(3.5, 4.0), (5.0, 20.0), (37.5, 2.0), (90.0, 3.0)], 4);
    let x: Vec<f32> = rows.iter().map(|rows| rows[0].x).collect();
    assert_eq!(x, [3.5, 4.5, 6.5, 9.5]);
    let statuses = |i: usize| rows.iter().map(|rows| rows[i].status).collect::<Vec<_>>();
    use Status::{Lost, Outside, Tracked};
    assert_eq!(statuses(1), [Tracked, Lost, Lost, Lost]);
    assert_eq!(statuses(2), [Tracked, Tracked, Outside, Outside]);
    assert_eq!(statuses(3), [Tracked, Outside, Outside, Outside]);
    assert_eq!((rows[3][1].x, rows[3][2].x), (5.0, 38.5));
}

#[test]
fn the_way_back_is_measured_when_asked_for_and_limits_when_told() {
    let fb = |given: &Given| rows(given, &[(3.5, 4.0)], 3)[1..].iter().map(|r| r[0].fb).collect::<Vec<_>>();
    assert_eq!(fb(&Given::default()), [Some(0.25), Some(0.5)]);
    let forward = Given { backward: false, ..Given::default() };
    assert_eq!(fb(&forward), [None, None]);
    let limited = Given { losing: Losing { lose_fb: 0.3, ..Losing::default() }, ..forward };
    let rows = rows(&limited, &[(3.5, 4.0)], 3);
    let last = rows[2][0];
    assert_eq!((rows[1][0].status, last.status, last.x), (Status::Tracked, Status::Lost, 4.5));
}

#[test]
fn a_cancel_comes_out_of_the_measurement() {
    struct Stop(AtomicBool);
    impl Listener for Stop {
        fn progress(&self, _: f64, _: &str) -> bool {
            self.0.load(Ordering::Relaxed)
        }
        fn log(&self, _: i32, _: &str) {}
    }
    let stop = Stop(AtomicBool::new(false));
    let cx = Cx::new(&stop);
    let data = vec![9; (WIDTH * HEIGHT) as usize];
    let frame = Frame::new(Luma::packed(&data, WIDTH, HEIGHT), 0, 0.0);
    let mut tracker =
        Follower::<Given>::begin(&Given::default(), &testing::stream(WIDTH, HEIGHT), &cx).unwrap();
    tracker.seed(&[Seed { id: 1, x: 3.0, y: 3.0 }], &cx).unwrap();
    tracker.push(&frame, &mut Points::default(), &cx).unwrap();
    stop.0.store(true, Ordering::Relaxed);
    let error = tracker.push(&frame, &mut Points::default(), &cx).unwrap_err();
    assert_eq!(error, Error::cancelled());
}
