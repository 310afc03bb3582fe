//! Marks that were carried are right, and make the later frame's matte.

use super::*;
use crate::tests::noise;
use crate::{Options, Picture, matte};

const WIDTH: usize = 90;
const HEIGHT: usize = 70;

/// A disc of one texture before another, both of which move; its opacities are known.
fn frame(middle: [f64; 2], behind: [f64; 2]) -> (Vec<[u8; 3]>, Vec<f32>) {
    let mut grain = noise(4, 7);
    (0..WIDTH * HEIGHT)
        .map(|pixel| {
            let [x, y] = [(pixel % WIDTH) as f64, (pixel / WIDTH) as f64];
            let [u, v] = [x - middle[0], y - middle[1]];
            let alpha = (18.5 - u.hypot(v)).clamp(0.0, 1.0);
            let leaf = [60.0, 150.0 + 30.0 * (u / 4.0).sin(), 40.0 + 20.0 * (v / 3.0).cos()];
            let sky = [
                190.0 + 30.0 * ((x - behind[0]) / 9.0).sin(),
                120.0,
                170.0 + 40.0 * ((y - behind[1]) / 8.0).cos(),
            ];
            let colour = std::array::from_fn(|c| {
                (alpha * leaf[c] + (1.0 - alpha) * sky[c] + f64::from(grain())).round() as u8
            });
            (colour, alpha as f32)
        })
        .unzip()
}

fn as_matte(alpha: Vec<f32>) -> Matte {
    Matte { width: WIDTH as u32, height: HEIGHT as u32, alpha, n_steps: 0 }
}

#[test]
fn marks_follow_features_and_make_a_matte_anew() {
    let (_, before) = frame([35.0, 40.0], [0.0, 0.0]);
    let (rgb, after) = frame([44.0, 33.0], [2.0, 1.0]);
    // Features of the disc are a pixel wrong at most, each its own way.
    let mut wrong = noise(9, 3);
    let moved: Vec<Moved> = (0..12)
        .map(|k| {
            let about = f64::from(k);
            let from = [35.0 + 12.0 * about.cos(), 40.0 + 12.0 * about.sin()];
            Moved { from, to: [from[0] + 8.0 + f64::from(wrong()), from[1] - 8.0 + f64::from(wrong())] }
        })
        .collect();
    let marks = carry(&as_matte(before), &moved, 3).unwrap();
    for (pixel, mark) in marks.iter().enumerate() {
        if let Some(alpha) = mark.alpha() {
            let off = (alpha as f32 - after[pixel]).abs();
            assert!(off < 0.01, "pixel {pixel} of opacity {} is marked {mark:?}", after[pixel]);
        }
    }
    // All but the band: no less than the disc and its surroundings without it.
    let n_known = marks.iter().filter(|mark| mark.alpha().is_some()).count();
    assert!(n_known > WIDTH * HEIGHT * 3 / 5, "{n_known}");

    let picture = Picture::new(WIDTH as u32, HEIGHT as u32, &rgb).unwrap();
    let found = matte(&picture, &marks, &Options::default(), &mut |_| true).unwrap();
    let off: f32 =
        found.alpha.iter().zip(&after).map(|(a, b)| (a - b).abs()).sum::<f32>() / after.len() as f32;
    assert!(off < 0.01, "mean {off}");
}

#[test]
fn every_pixel_follows_the_feature_nearest_to_it() {
    // The left half came from the right end, and the right half has not moved.
    let alpha = (0..WIDTH * HEIGHT).map(|pixel| if pixel % WIDTH >= 80 { 1.0 } else { 0.0 }).collect();
    let here = |x: f64| Moved { from: [x, 30.0], to: [x, 30.0] };
    let moved = [Moved { from: [85.0, 30.0], to: [20.0, 30.0] }, here(60.0), here(80.0)];
    let marks = carry(&as_matte(alpha), &moved, 0).unwrap();
    let at = |x: usize| marks[30 * WIDTH + x];
    use Mark::{Background, Foreground, Unknown};
    let found = [0, 10, 14, 15, 24, 25, 30, 45, 79, 80, 89].map(at);
    let wanted = [
        Background, Background, Background, Foreground, Foreground, Unknown, Unknown, Background, Background,
        Foreground, Foreground,
    ];
    assert_eq!(found, wanted);
}

#[test]
fn what_cannot_be_carried_has_a_name() {
    let (_, alpha) = frame([35.0, 40.0], [0.0, 0.0]);
    let matte = as_matte(alpha);
    let still = Moved { from: [35.0, 40.0], to: [35.0, 40.0] };
    let lost = Moved { from: [35.0, f64::NAN], ..still };
    assert_eq!(carry(&matte, &[], 3), Err(MattingError::NothingMoved));
    assert!(matches!(carry(&matte, &[still, lost], 3), Err(MattingError::Place { .. })));
    assert_eq!(carry(&matte, &[still], 20), Err(MattingError::NoForeground));
    let away = Moved { from: [35.0, 40.0], to: [535.0, 40.0] };
    assert_eq!(carry(&matte, &[away], 3), Err(MattingError::NothingMarked));
    assert!(carry(&matte, &[still], 3).is_ok());
}
