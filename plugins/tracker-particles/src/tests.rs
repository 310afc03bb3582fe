//! The plugin as a host drives it, on pictures whose motion is known.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use honami_follow::Search;
use honami_plugin::Listener;
use honami_plugin::testing::{self, Clip};
use honami_vision::texture;

use super::*;

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;
/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [1.4, -0.7];

fn clip(n_frames: usize) -> Clip {
    Clip::drifting(WIDTH, HEIGHT, n_frames, STEP, |x, y| texture::value(2, x, y))
}

fn settings() -> Settings {
    let search = Search { levels: 2, ..Search::default() };
    Settings { life: 5, spacing: 10.0, reach: 25.0, search, ..Settings::default() }
}

fn track(settings: &Settings, births: std::ops::Range<u32>, seeds: &[Seed], n: usize) -> Vec<Vec<Point>> {
    let clip = clip(n);
    let stream = Stream { births, ..testing::stream(WIDTH, HEIGHT) };
    let mut rows = testing::track::<Particles>(settings, &stream, seeds, clip.frames()).unwrap();
    rows.truncate(n);
    rows
}

#[test]
fn it_bears_whatever_a_host_hands_it() {
    testing::suite::<Particles>(&Settings::default());
}

#[test]
fn points_move_with_the_particles_around_them() {
    let seeds = [Seed { id: 4, x: 60.2, y: 70.8 }, Seed { id: 9, x: 153.5, y: 60.0 }];
    let rows = track(&settings(), 0..0, &seeds, 12);
    for (t, rows) in rows.iter().enumerate() {
        let ids: Vec<u32> = rows.iter().map(|row| row.id).collect();
        assert_eq!(ids, [4, 9], "without numbers for births there are only the seeded");
        let error = testing::off_px(&rows[0], &seeds[0], STEP, t);
        assert!(rows[0].status == Status::Tracked && error < 0.3, "frame {t}: {:?}, {error} px off", rows[0]);
        assert_eq!(rows[0].ncc.is_some(), t > 0, "quality belongs to a step");
        assert_eq!(rows[1].status, if t < 5 { Status::Tracked } else { Status::Outside }, "frame {t}");
    }
}

/// Newborn once, then tracked without a gap for a life at most, each with an id of its own.
#[test]
fn particles_are_points_that_are_born_live_and_end() {
    let rows = track(&settings(), 100..2000, &[Seed { id: 4, x: 60.0, y: 70.0 }], 16);
    let mut lives = BTreeMap::<u32, Vec<(usize, Status)>>::new();
    for (t, rows) in rows.iter().enumerate() {
        assert!(rows[1..].is_sorted_by(|a, b| a.id < b.id));
        assert!((40..=200).contains(&(rows.len() - 1)), "frame {t}: {} particles", rows.len() - 1);
        for row in &rows[1..] {
            lives.entry(row.id).or_default().push((t, row.status));
        }
    }
    let mut born = BTreeSet::new();
    for (id, life) in &lives {
        assert!((100..2000).contains(id) && life.len() <= 5, "{id} lives for {} frames", life.len());
        assert_eq!(life[0].1, Status::Newborn, "{id}");
        assert!(life[1..].iter().all(|(_, status)| *status == Status::Tracked), "{id}: {life:?}");
        assert_eq!(life[life.len() - 1].0 - life[0].0 + 1, life.len(), "{id} has a gap");
        born.insert(life[0].0);
    }
    assert_eq!(born.len(), 16, "some are born in each frame: {born:?}");
    assert_eq!(track(&Settings { emit: false, ..settings() }, 100..2000, &[], 3), [[], [], []]);
}

/// Collects warnings.
#[derive(Default)]
struct Ear(Mutex<Vec<String>>);

impl Listener for Ear {
    fn progress(&self, _: f64, _: &str) -> bool {
        false
    }
    fn log(&self, _: i32, text: &str) {
        self.0.lock().unwrap().push(text.to_owned());
    }
}

#[test]
fn when_numbers_run_out_it_warns_once_and_goes_on() {
    let (clip, ear) = (clip(10), Ear::default());
    let cx = Cx::new(&ear);
    let stream = Stream { births: 7..60, ..testing::stream(WIDTH, HEIGHT) };
    let mut tracker = Particles::begin(&settings(), &stream, &cx).unwrap();
    tracker.seed(&[Seed { id: 3, x: 80.0, y: 60.0 }], &cx).unwrap();
    let mut known = BTreeSet::new();
    for frame in clip.frames() {
        let mut out = Points::default();
        tracker.push(&frame, &mut out, &cx).unwrap();
        let rows = out.rows();
        assert_eq!(
            (rows[0].id, rows[0].status),
            (3, Status::Tracked),
            "points go on with particles that have no id"
        );
        for row in &rows[1..] {
            assert!((7..60).contains(&row.id));
            assert_eq!(known.insert(row.id), row.status == Status::Newborn, "{row:?}");
        }
    }
    assert_eq!(known.len(), 53);
    let said = ear.0.lock().unwrap();
    assert!(said.len() == 1 && said[0].contains("53 numbers"), "{said:?}");
}

#[test]
fn a_particle_that_is_retired_or_moved_by_hand_is_none_any_more() {
    let clip = clip(3);
    let stream = Stream { births: 100..900, ..testing::stream(WIDTH, HEIGHT) };
    let mut tracker = Particles::begin(&settings(), &stream, &testing::cx()).unwrap();
    let push = |tracker: &mut Particles, t: usize| {
        let mut out = Points::default();
        tracker.push(&clip.frame(t), &mut out, &testing::cx()).unwrap();
        out.rows().to_vec()
    };
    let first = push(&mut tracker, 0);
    let (gone, moved) = (first[3].id, first[4].id);
    tracker.retire(&[gone]);
    tracker.seed(&[Seed { id: moved, x: 50.0, y: 60.0 }], &testing::cx()).unwrap();
    let rows = push(&mut tracker, 1);
    assert!(rows.iter().all(|row| row.id != gone));
    let moved: Vec<&Point> = rows.iter().filter(|row| row.id == moved).collect();
    assert_eq!(moved.len(), 1);
    assert!((moved[0].x - 51.4).hypot(moved[0].y - 59.3) < 0.3, "{moved:?}");
}

#[test]
fn dense_motion_is_that_of_the_scene() {
    let clip = clip(2);
    let [from, to] = [0, 1].map(|t| clip.frame(t));
    let found = dense::field(&Settings::default(), &from, &to, 2, &testing::cx()).unwrap();
    let near = |[u, v]: &&[f32; 2]| (u - 1.4).hypot(v + 0.7) < 0.25;
    let n = found.vectors.len();
    assert_eq!(n, found.nx as usize * found.ny as usize);
    assert!(found.vectors.iter().flatten().filter(near).count() * 10 > 9 * n, "{:?}", found.vectors);
}
