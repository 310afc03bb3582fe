//! The plugin as a host drives it; its motion is tested with the algorithm.

use honami_plugin::{Seed, Status, testing};
use honami_vision::texture;

use super::*;

/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [5.7, -2.9];

#[test]
fn bad_input_is_borne() {
    testing::suite::<Piv>(&Settings { weighting: Weighting::Uniform, repeats: 0, ..Settings::default() });
    testing::suite::<Piv>(&Settings { backward: false, radius: 4, ..Settings::default() });
}

#[test]
fn points_follow_a_drifting_texture() {
    let clip = testing::Clip::drifting(240, 180, 6, STEP, |x, y| texture::value(2, x, y));
    let seeds: Vec<Seed> =
        (0..50).map(|id| Seed { id, x: 30.0 + 3.0 * id as f32, y: 150.0 - 2.1 * id as f32 }).collect();
    for (t, rows) in clip.track::<Piv>(&Settings::default(), &seeds).unwrap().iter().enumerate() {
        let off = rows.iter().zip(&seeds).map(|(row, seed)| testing::off_px(row, seed, STEP, t));
        let mut off: Vec<f64> = off.collect();
        off.sort_by(f64::total_cmp);
        assert!(off[25] < 0.15 && off[49] < 0.5, "frame {t}: median {}, worst {}", off[25], off[49]);
        assert!(rows.iter().all(|row| row.status == Status::Tracked));
        // Quality belongs to a step: the first frame has none.
        assert!(rows.iter().all(|row| (row.fb.is_some(), row.ncc.is_some()) == (t > 0, t > 0)));
    }
}
