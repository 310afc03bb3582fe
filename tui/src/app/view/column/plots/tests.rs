//! Axes of slow and fast clips.

use super::*;

#[test]
fn an_axis_has_round_numbers_in_a_unit_that_suits_it() {
    for (top_hz, n, unit_is, expect) in [
        (12.5, 6, "Hz", "0 5 10"),
        (5.0, 6, "Hz", "0 1 2 3 4 5"),
        (0.9, 5, "Hz", "0.0 0.2 0.4 0.6 0.8"),
        (0.2, 5, "Hz", "0.00 0.05 0.10 0.15 0.20"),
        // A picture a minute: half of that is 8.3 mHz.
        (1.0 / 120.0, 5, "mHz", "0 2 4 6 8"),
        (0.0015, 3, "mHz", "0.0 0.5 1.0 1.5"),
        // A picture an hour.
        (1.0 / 7200.0, 5, "/h", "0.0 0.1 0.2 0.3 0.4 0.5"),
    ] {
        let ticks = ticks(top_hz, n);
        let labels: Vec<&str> = ticks.iter().map(|(_, label)| label.as_str()).collect();
        assert_eq!((unit(top_hz).0, &*labels.join(" ")), (unit_is, expect), "up to {top_hz} Hz");
        for (hz, label) in &ticks {
            let value: f64 = label.parse().unwrap();
            assert!((hz * unit(top_hz).1 - value).abs() < 1e-9, "{hz} Hz is not {label}");
        }
    }
    assert_eq!(ticks(0.0, 5).len(), 1, "no range is no reason to count for ever");
}
