//! Positions by hand, and there and back to the same bits.

use proptest::prelude::*;

use super::*;

/// A picture of 8x6 pixels: our position, and the same in every other way of counting.
#[test]
fn positions_worked_out_by_hand() {
    // ours, corner, top, bottom, normalised.
    let table: [[[f64; 2]; 5]; 5] = [
        // The centre of the top-left pixel.
        [[0.0, 0.0], [0.5, 0.5], [1.0, 1.0], [1.0, 6.0], [0.5 / 8.0, 0.5 / 6.0]],
        // The centre of the bottom-right pixel.
        [[7.0, 5.0], [7.5, 5.5], [8.0, 6.0], [8.0, 1.0], [7.5 / 8.0, 5.5 / 6.0]],
        // The outer corners.
        [[-0.5, -0.5], [0.0, 0.0], [0.5, 0.5], [0.5, 6.5], [0.0, 0.0]],
        [[7.5, 5.5], [8.0, 6.0], [8.5, 6.5], [8.5, 0.5], [1.0, 1.0]],
        // Between pixels.
        [[2.25, 3.5], [2.75, 4.0], [3.25, 4.5], [3.25, 2.5], [2.75 / 8.0, 4.0 / 6.0]],
    ];
    for [ours, corner, top, bottom, normalised] in table {
        let expected = [
            (Origin::Centre, ours),
            (Origin::Corner, corner),
            (Origin::Top, top),
            (Origin::Bottom, bottom),
            (Origin::Normalised, normalised),
        ];
        for (origin, theirs) in expected {
            let raster = Raster { origin, size: [8, 6] };
            let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(close(raster.from_ours(ours), theirs), "{ours:?} counted from {origin:?}");
            assert!(close(raster.to_ours(theirs), ours), "{theirs:?} of {origin:?}");
        }
    }
}

#[test]
fn corners_stay_corners_when_pictures_are_resized() {
    assert_eq!(resized([-0.5, -0.5], [8, 6], [80, 30]).map(f64::to_bits), [-0.5, -0.5].map(f64::to_bits));
    assert_eq!(resized([7.5, 5.5], [8, 6], [80, 30]).map(f64::to_bits), [79.5, 29.5].map(f64::to_bits));
    assert_eq!(resized([0.0, 0.0], [8, 6], [16, 12]).map(f64::to_bits), [0.5, 0.5].map(f64::to_bits));
}

#[test]
fn words_name_origins() {
    for origin in Origin::ALL {
        assert_eq!(origin.word().parse(), Ok(origin));
    }
    assert!("middle".parse::<Origin>().is_err_and(|e| e.to_string().ends_with("came middle")));
}

/// An f32 position that f64 shifts without rounding: zero, or not smaller than 2^-28.
fn position() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), (-1e5_f32..1e5).prop_filter("large enough", |x| x.abs() > 4e-9)]
}

proptest! {
    #[test]
    fn there_and_back_is_the_same_to_the_bit(x in position(), y in position(), w in 1_u32..10_000, h in 1_u32..10_000) {
        for origin in [Origin::Centre, Origin::Corner, Origin::Top, Origin::Bottom] {
            let raster = Raster { origin, size: [w, h] };
            let back = raster.to_ours(raster.from_ours([x.into(), y.into()]));
            prop_assert_eq!(back.map(|v| (v as f32).to_bits()), [x, y].map(f32::to_bits), "{:?}", origin);
        }
        let raster = Raster { origin: Origin::Normalised, size: [w, h] };
        let back = raster.to_ours(raster.from_ours([x.into(), y.into()]));
        prop_assert!((back[0] - f64::from(x)).abs() < 1e-9 && (back[1] - f64::from(y)).abs() < 1e-9);
    }
}
