//! The plugin as a host drives it; its motion is tested with the algorithm.

use honami_plugin::{Frame, Gray as Luma, Seed, Status, testing};
use honami_vision::texture;

use super::*;

const WIDTH: u32 = 240;
const HEIGHT: u32 = 180;
/// Motion from each frame to the next, pixels.
const STEP: [f64; 2] = [5.7, -2.9];

#[test]
fn bad_input_is_borne() {
    testing::suite::<Piv>(&Settings { weighting: Weighting::Uniform, repeats: 0, ..Settings::default() });
    testing::suite::<Piv>(&Settings { backward: false, radius: 4, ..Settings::default() });
}

#[test]
fn points_follow_a_drifting_texture() {
    let clip: Vec<Vec<u8>> = (0..6_u8)
        .map(|t| {
            let [dx, dy] = STEP.map(|step| step * f64::from(t));
            texture::render(WIDTH, HEIGHT, |x, y| texture::value(2, x - dx, y - dy))
        })
        .collect();
    let frames =
        (0..).zip(&clip).map(|(t, data)| Frame::new(Luma::packed(data, WIDTH, HEIGHT), t, t as f64 / 25.0));
    let seeds: Vec<Seed> =
        (0..50).map(|id| Seed { id, x: 30.0 + 3.0 * id as f32, y: 150.0 - 2.1 * id as f32 }).collect();
    let stream = testing::stream(WIDTH, HEIGHT);
    let rows = testing::track::<Piv>(&Settings::default(), &stream, &seeds, frames).unwrap();
    for (t, rows) in rows[..6].iter().enumerate() {
        let off = rows.iter().zip(&seeds).map(|(row, seed)| {
            let want = [seed.x + (STEP[0] * t as f64) as f32, seed.y + (STEP[1] * t as f64) as f32];
            (row.x - want[0]).hypot(row.y - want[1])
        });
        let mut off: Vec<f32> = off.collect();
        off.sort_by(f32::total_cmp);
        assert!(off[25] < 0.15 && off[49] < 0.5, "frame {t}: median {}, worst {}", off[25], off[49]);
        assert!(rows.iter().all(|row| row.status == Status::Tracked));
        // Quality belongs to a step: the first frame has none.
        assert!(rows.iter().all(|row| (row.fb.is_some(), row.ncc.is_some()) == (t > 0, t > 0)));
    }
}
