//! What is counted as dropped, for painters of several speeds.

use super::*;

/// The figure after some seconds of playing 25 frames per second, painting only every `nth` of them.
fn after(seconds: u64, nth: u64, rate: f64, around: Option<u32>) -> Option<[u32; 2]> {
    let times: Vec<f64> = (0..2000).map(|k| f64::from(k) / 25.0).collect();
    let play = Play { rate, since: Duration::from_secs(1), from: 1000, around };
    let mut tally = Tally::default();
    let mut figure = tally.dropped(Some(play), &times, play.since);
    for ms in (0..seconds * 1000).step_by(5) {
        let now = play.since + Duration::from_millis(ms);
        if play.n_due(&times, now).is_multiple_of(nth) {
            tally.painted(play.frame(&times, now));
        }
        figure = tally.dropped(Some(play), &times, now);
    }
    figure
}

#[test]
fn pictures_that_were_due_and_not_painted_are_dropped() {
    for (nth, rate, around, expect) in [
        (1, 1.0, None, None),
        (1, -0.5, None, None),
        (1, 2.0, Some(8), None),
        (2, 1.0, None, Some([13, 25])),
        (5, 1.0, None, Some([5, 25])),
        (5, 2.0, None, Some([10, 50])),
        (5, -1.0, Some(8), Some([5, 25])),
    ] {
        let figure = after(3, nth, rate, around);
        match (figure, expect) {
            (Some([shown, due]), Some([wanted, of])) => {
                assert!(shown.abs_diff(wanted) <= 1 && due.abs_diff(of) <= 1, "{nth} {rate}: {figure:?}");
            }
            _ => assert_eq!(figure, expect, "every {nth}th at {rate}"),
        }
    }
}

#[test]
fn a_figure_needs_a_second_and_goes_with_the_playing() {
    assert_eq!(after(1, 5, 1.0, None), None);
    let times = [0.0, 0.04, 0.08];
    let play = Play { rate: 0.001, since: Duration::ZERO, from: 0, around: None };
    let mut tally = Tally { dropped: Some([3, 25]), ..Tally::default() };
    assert_eq!(tally.dropped(Some(play), &times, Duration::ZERO), None);
    tally.dropped = Some([3, 25]);
    assert_eq!(tally.dropped(None, &times, Duration::ZERO), None);
}
