//! The plugin as a host drives it; its motion is tested with the algorithm.

use honami_plugin::{Seed, Status, testing};
use honami_vision::texture;

use super::*;

/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [1.7, -0.9];

#[test]
fn bad_input_does_no_harm() {
    testing::suite::<LucasKanade>(&Settings::default());
}

#[test]
fn points_follow_a_drifting_texture() {
    let clip = testing::Clip::drifting(240, 180, 6, STEP, |x, y| texture::value(2, x, y));
    let seeds: Vec<Seed> =
        (0..60).map(|id| Seed { id, x: 30.0 + 3.0 * id as f32, y: 150.0 - 2.1 * id as f32 }).collect();
    for (t, rows) in clip.track::<LucasKanade>(&Settings::default(), &seeds).unwrap().iter().enumerate() {
        let off = rows.iter().zip(&seeds).map(|(row, seed)| testing::off_px(row, seed, STEP, t));
        let worst = off.fold(0.0, f64::max);
        assert!(worst < 0.25, "frame {t}: {worst}");
        assert!(rows.iter().all(|row| row.status == Status::Tracked));
        // Quality belongs to a step: the first frame has none.
        let is_good = |row: &honami_plugin::Point| {
            row.fb.is_some_and(|fb| fb < 0.1) && row.ncc.is_some_and(|ncc| ncc > 0.98)
        };
        assert!(rows.iter().all(|row| is_good(row) == (t > 0)), "frame {t}");
    }
}
