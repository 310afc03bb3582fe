//! Wind between its rows.

use super::Wind;

const X: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
const TWO: [[f32; 3]; 4] = [[0.0; 3], [8.0, 0.0, 0.0], [4.0, 0.0, 0.0], [8.0, 2.0, 0.0]];

#[test]
fn wind_is_straight_between_its_times_and_stays_beyond_them() {
    let all = Wind { times_s: &[1.0, 2.0, 4.0], velocities: &X };
    let each = Wind { times_s: &[0.0, 1.0], velocities: &TWO };
    let rows = [
        (all, 0.0, 0, [1.0, 0.0, 0.0]),
        (all, 1.0, 0, [1.0, 0.0, 0.0]),
        (all, 1.25, 7, [1.5, 0.0, 0.0]),
        (all, 3.0, 0, [2.5, 0.0, 0.0]),
        (all, 4.0, 0, [2.0, 0.0, 0.0]),
        (all, 9.0, 0, [2.0, 0.0, 0.0]),
        (each, 0.5, 0, [2.0, 0.0, 0.0]),
        (each, 0.5, 1, [8.0, 1.0, 0.0]),
        (Wind::default(), 1.0, 3, [0.0; 3]),
    ];
    for (wind, time_s, copy, wanted) in rows {
        assert_eq!(
            wind.at(time_s, copy).map(f32::to_bits),
            wanted.map(f32::to_bits),
            "{wind:?} at {time_s} s, copy {copy}"
        );
    }
    assert!(each.is_per_copy() && !all.is_per_copy());
}
