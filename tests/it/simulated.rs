//! The simulated reviewer at work on a small clip: what must hold whatever the tracker and the hand do.

use honami_tests::{Bench, program};
use honami_workbench::compare::{points_of, read_truth};
use honami_workbench::plugins::Values;
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::simulate::{Habits, Model, Pick, review};
use honami_workbench::track::{self, Area, PointSource, TrackRequest};

const N_FRAMES: u32 = 30;
const TOLERANCE_PX: f64 = 2.0;

#[test]
fn whoever_finishes_is_right_and_every_key_frame_stays_where_it_was_put() {
    let bench = Bench::new();
    bench.synth("clip.y4m", N_FRAMES, "--leaves 30 --wind wind");
    let truth = read_truth(&bench.path("clip.truth.csv"), N_FRAMES).unwrap();
    let mut points = points_of(&truth);
    points.retain(|seed| seed.frame == 0);
    points.truncate(2);
    let options = SessionOptions {
        plugin_paths: vec![program().parent().unwrap().to_owned()],
        ..SessionOptions::default()
    };
    for (number, model) in Model::ALL.into_iter().enumerate() {
        let project = bench.path(&format!("{number}.honami"));
        let mut session = Session::create(&project, &bench.path("clip.y4m"), None, &options).unwrap();
        let request = TrackRequest {
            plugin: "klt".to_owned(),
            params: Values::default(),
            points: PointSource::Given(points.clone()),
            frames: 0..N_FRAMES,
            every: None,
            area: Area::Whole,
        };
        let done = track::prepare(&mut session, &request).unwrap().run(&()).unwrap();
        track::finish(&mut session, done).unwrap();
        for seed in &points {
            let pick = if number % 2 == 0 { Pick::Worst } else { Pick::First };
            let (tolerance_px, noise_px, max_keys, seed_of_hand) = (TOLERANCE_PX, 0.25, 8, 7);
            let habits = Habits { model, pick, tolerance_px, noise_px, max_keys, seed: seed_of_hand };
            let path = &truth[&seed.track];
            let taken = review(&mut session, seed.track, path, &habits).unwrap();
            let shown = session.project.shown(seed.track).unwrap().unwrap();
            let keys = &session.project.document().track(seed.track).unwrap().keys;
            assert!(taken.is_right || taken.n_keys == max_keys, "{model:?}: {taken:?}");
            assert!(keys.len() <= taken.n_keys as usize + 1);
            for (frame, key) in keys {
                let sample = shown.get(*frame).unwrap();
                assert_eq!((sample.x, sample.y), (key.x, key.y), "{model:?}: the key-frame at {frame}");
            }
            for (frame, (x, y, visible)) in (0..).zip(&path.positions) {
                let near = shown.get(frame).is_some_and(|sample| {
                    (f64::from(sample.x) - x).hypot(f64::from(sample.y) - y) <= TOLERANCE_PX
                });
                assert!(near || !visible || !taken.is_right, "{model:?}: frame {frame} of {}", seed.track);
            }
        }
    }
}
