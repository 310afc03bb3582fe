//! Frame times: what is refused, what the rate is.

use super::{FrameTimes, TimesError};

#[test]
fn refuses_what_is_no_time_line() {
    let cases = [
        (vec![], TimesError::Empty),
        (vec![0.0, f64::NAN], TimesError::NotFinite { frame: 1 }),
        (vec![0.0, 1.0, 1.0], TimesError::NotIncreasing { frame: 2 }),
    ];
    for (times, want) in cases {
        assert_eq!(FrameTimes::new(times), Err(want));
    }
    assert_eq!(FrameTimes::constant(3, 0.0), Err(TimesError::Rate));
}

#[test]
fn rate_is_the_median_step() {
    let times = FrameTimes::new(vec![0.0, 0.033, 0.067, 0.100, 0.133]).unwrap();
    assert!((times.nominal_fps().unwrap() - 30.0).abs() < 0.4);
    assert!(!times.is_variable(), "rounding to milliseconds is not a variable rate");
    let gap = FrameTimes::new(vec![0.0, 1.0, 2.0, 5.0, 6.0]).unwrap();
    assert!(gap.is_variable());
    assert_eq!(FrameTimes::constant(1, 25.0).unwrap().nominal_fps(), None);
}
