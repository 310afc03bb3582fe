//! Middles of drawn discs.

use honami_model::picture::Gray;

use super::middle;

const SIDE: usize = 64;

/// An ellipse on a slope of gray, edges smooth; `dark` on bright or the other way.
fn drawn(at: [f64; 2], radii: [f64; 2], turn: f64, is_dark: bool) -> Vec<u8> {
    let covered = |x: f64, y: f64| {
        let (dx, dy) = (x - at[0], y - at[1]);
        let (u, v) = (dx * turn.cos() + dy * turn.sin(), dy * turn.cos() - dx * turn.sin());
        (u / radii[0]).hypot(v / radii[1]) <= 1.0
    };
    (0..SIDE * SIDE)
        .map(|i| {
            let (x, y) = ((i % SIDE) as f64, (i / SIDE) as f64);
            let n = (0..64).filter(|k| {
                covered(x - 0.5 + f64::from(k % 8) / 8.0 + 0.0625, y - 0.5 + f64::from(k / 8) / 8.0 + 0.0625)
            });
            let share = n.count() as f64 / 64.0;
            let ground = 90.0 + 0.3 * x;
            let disc = if is_dark { 20.0 } else { 220.0 };
            (ground + share * (disc - ground)).round() as u8
        })
        .collect()
}

#[test]
fn middles_are_found_to_some_hundredths_of_a_pixel() {
    // Very obliquely, a few pixels at the ends tell where the middle lies along the ellipse.
    for (at, radii, turn, is_dark, bound) in [
        ([31.3, 30.8], [6.0, 6.0], 0.0, false, 0.05),
        ([30.55, 31.45], [6.0, 6.0], 0.0, true, 0.05),
        ([31.0, 31.0], [9.0, 9.0], 0.0, false, 0.05),
        ([31.7, 30.2], [8.0, 4.0], 0.6, false, 0.05),
        ([31.2, 31.9], [8.0, 3.0], -1.1, true, 0.3),
        ([31.4, 31.4], [3.0, 3.0], 0.0, false, 0.05),
    ] {
        let bytes = drawn(at, radii, turn, is_dark);
        let picture = Gray::packed(&bytes, SIDE as u32, SIDE as u32);
        let found = middle(&picture, [at[0] + 1.1, at[1] - 0.9], radii[0]).unwrap();
        let off = (found[0] - at[0]).hypot(found[1] - at[1]);
        assert!(off < bound, "{off:.3} px of {radii:?} at {at:?}");
    }
}

#[test]
fn where_nothing_is_round_there_is_no_middle() {
    let flat = vec![90; SIDE * SIDE];
    let edge: Vec<u8> = (0..SIDE * SIDE).map(|i| if i % SIDE < 30 { 40 } else { 200 }).collect();
    for bytes in [flat, edge] {
        let picture = Gray::packed(&bytes, SIDE as u32, SIDE as u32);
        assert_eq!(middle(&picture, [31.0, 31.0], 6.0), None);
    }
    let small = drawn([31.0, 31.0], [1.5, 1.5], 0.0, false);
    assert_eq!(middle(&Gray::packed(&small, SIDE as u32, SIDE as u32), [31.0, 31.0], 1.5), None);
}
