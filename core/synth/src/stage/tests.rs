//! What cameras film is where the same cameras see it.

use super::{Carried, Stage};
use crate::Settings;

#[test]
fn a_disc_is_bright_where_its_middle_is_seen_and_dark_about_it() {
    let settings =
        Settings { width: 960, height: 720, n_frames: 12, noise: 0.0, lighting: 0.0, ..Settings::default() };
    let stage = Stage::new(Carried::Bars, &settings).unwrap();
    let (mut n_seen, mut mean) = (0.0, [0.0; 2]);
    for frame in [0, 3, 7] {
        for camera in [0, 1] {
            let picture = stage.render(camera, frame);
            for point in stage.points() {
                let Some(at) = stage.seen(camera, frame, point) else { continue };
                // The middle of brightness of the white disc; perspective moves that of a disc of 8 px by some hundredths.
                let (mut sum, mut middle) = (0.0, [0.0; 2]);
                for y in (at.y.round() as usize - 5)..=(at.y.round() as usize + 5) {
                    for x in (at.x.round() as usize - 5)..=(at.x.round() as usize + 5) {
                        let value = (f64::from(picture.y[y * 960 + x]) - 30.0).max(0.0);
                        sum += value;
                        middle = [middle[0] + value * x as f64, middle[1] + value * y as f64];
                    }
                }
                let off = [middle[0] / sum - at.x, middle[1] / sum - at.y];
                assert!(off[0].hypot(off[1]) < 0.5, "{off:?} px at {at} of camera {camera} in frame {frame}");
                mean = [mean[0] + off[0], mean[1] + off[1]];
                n_seen += 1.0;
            }
        }
    }
    let mean = mean.map(|sum| sum / n_seen);
    assert!(n_seen > 24.0 && mean[0].hypot(mean[1]) < 0.05, "{mean:?} px, {n_seen}");
}

#[test]
fn what_is_carried_may_be_filmed_slowly_and_what_sways_may_not() {
    let settings = Settings { n_frames: 2, fps: 0.5, width: 64, height: 48, ..Settings::default() };
    let stage = Stage::new(Carried::Board, &settings).unwrap();
    assert_eq!(stage.render(0, 1).y.len(), 64 * 48);
    let said = crate::Scene::new(&settings).unwrap_err().to_string();
    assert!(said.contains("below 10 the sways alias"), "{said}");
    let said = Stage::new(Carried::Board, &Settings { fps: 0.0, ..settings }).unwrap_err().to_string();
    assert!(said.contains("0.001 to 1000 frames a second, got 0"), "{said}");
}

#[test]
fn all_corners_of_the_board_are_before_both_cameras() {
    let stage = Stage::new(Carried::Board, &Settings { n_frames: 20, ..Settings::default() }).unwrap();
    for frame in 0..20 {
        for camera in [0, 1] {
            let n_seen =
                stage.points().iter().filter(|&&point| stage.seen(camera, frame, point).is_some()).count();
            assert_eq!(n_seen, 54, "frame {frame}, camera {camera}");
        }
    }
}
