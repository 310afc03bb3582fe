//! Accuracy against hand-counted tables.

use honami_model::track::{Quality, Sample, Source, Span, Status};

use super::{Accuracy, Histogram, TruePath, accuracy, compared, drift, histogram, median};

/// A track that stands at the origin; an offset of `None` is a lost sample.
fn track(offsets: &[Option<f32>]) -> Span {
    let sample = |offset: &Option<f32>| Sample {
        x: offset.unwrap_or(0.0),
        y: 0.0,
        status: if offset.is_some() { Status::Tracked } else { Status::Lost },
        source: Source::Tracked,
        quality: Quality::default(),
    };
    Span { first_frame: 10, samples: offsets.iter().map(sample).collect() }
}

fn truth(visible: &[bool]) -> TruePath {
    TruePath { first_frame: 10, positions: visible.iter().map(|&v| (0.0, 0.0, v)).collect() }
}

/// The accuracy of one track whose query is its first frame.
#[track_caller]
fn of(visible: &[bool], offsets: &[Option<f32>]) -> Accuracy {
    accuracy([(&truth(visible), 10, &track(offsets))]).unwrap()
}

#[track_caller]
fn close(got: f64, wanted: f64, what: &str) {
    assert!((got - wanted).abs() < 1e-6, "{what}: {got}, wanted {wanted}");
}

/// Visibility, offsets, and what they give: delta_avg, survival, ok, visibility told, precision, recall.
type Case<'a> = (&'a [bool], &'a [Option<f32>], [f64; 6]);

#[test]
fn counts_misses_by_hand() {
    // The first frame is the query and never counts.
    let cases: [Case<'_>; 8] = [
        (&[true, true], &[Some(9.0), Some(0.5)], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        (&[true, true], &[Some(0.0), Some(3.0)], [0.6, 1.0, 1.0, 1.0, 1.0, 1.0]),
        (&[true, true, true], &[Some(0.0), Some(0.0), None], [0.5, 0.5, 0.0, 0.5, 1.0, 0.5]),
        (&[true, true, true], &[Some(0.0), Some(20.0), Some(0.0)], [0.5, 0.0, 0.0, 1.0, 0.5, 0.5]),
        (&[true, true, false], &[Some(0.0), Some(0.0), None], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        // Called seen while it is hidden: its visibility is told wrongly, its place rightly; and then neither.
        (&[true, true, false], &[Some(0.0), Some(0.0), Some(0.0)], [1.0, 1.0, 1.0, 0.5, 1.0, 1.0]),
        (&[true, true, false], &[Some(0.0), Some(0.0), Some(9.0)], [1.0, 1.0, 1.0, 0.5, 0.5, 1.0]),
        // Two of three called seen are right, and two of four visible ones were found.
        (
            &[true; 5],
            &[Some(0.0), Some(7.9), Some(8.1), Some(8.0), None],
            [0.2, 0.75, 0.0, 0.75, 2.0 / 3.0, 0.5],
        ),
    ];
    for (visible, offsets, wanted) in cases {
        let got = of(visible, offsets);
        let parts =
            [got.delta_avg, got.survival, got.ok_tracks, got.visibility, got.precision.unwrap(), got.recall];
        for (got, wanted) in parts.into_iter().zip(wanted) {
            close(got, wanted, &format!("{offsets:?}: {parts:?}"));
        }
    }
}

#[test]
fn shares_moments_and_bias_by_hand() {
    let got = of(&[true; 6], &[Some(0.0), Some(0.5), Some(-1.5), Some(3.0), Some(-6.0), None]);
    // Five visible samples, of which one was lost: a fifth more with each threshold.
    for (share, wanted) in got.within.into_iter().zip([0.2, 0.4, 0.6, 0.8, 0.8]) {
        close(share, wanted, "within");
    }
    close(got.mean_px.unwrap(), 11.0 / 4.0, "mean");
    close(got.rms_px.unwrap(), (47.5_f64 / 4.0).sqrt(), "rms");
    close(got.axis_rms_px.unwrap()[0], got.rms_px.unwrap(), "all of it is to the right");
    close(got.axis_rms_px.unwrap()[1], 0.0, "nothing is down");
    close(got.bias_px.unwrap()[0], -1.0, "bias");
    close(got.median_px.unwrap(), 2.25, "median of 0.5, 1.5, 3, 6");
    close(got.trajectory_px.unwrap(), 3.0, "median of 0.5, 1.5, 3, 6 and the lost one");
    assert_eq!((got.n_samples, got.n_lost), (5, 1));
    let lost = of(&[true; 3], &[Some(0.0), None, None]);
    assert_eq!((lost.mean_px, lost.bias_px, lost.precision, lost.trajectory_px), (None, None, None, None));
    close(lost.recall, 0.0, "recall");
}

#[test]
fn the_median_trajectory_counts_tracks_and_not_samples() {
    let path = truth(&[true; 4]);
    let (long, short) =
        (track(&[Some(0.0), Some(5.0), Some(5.0), Some(5.0)]), track(&[Some(0.0), Some(1.0)]));
    let (one, brief) = (truth(&[true; 2]), track(&[Some(0.0), Some(2.0)]));
    let got = accuracy([(&path, 10, &long), (&one, 10, &short), (&one, 10, &brief)]).unwrap();
    close(got.trajectory_px.unwrap(), 2.0, "of 1, 2 and 5");
    close(got.median_px.unwrap(), 5.0, "of 1, 2, 5, 5, 5");
}

#[test]
fn nothing_visible_is_no_number() {
    assert_eq!(accuracy([(&truth(&[true, false]), 10, &track(&[Some(0.0), None]))]), None);
    assert_eq!(accuracy([]), None);
    assert_eq!(drift([]), []);
    assert_eq!(histogram([]), None);
    assert_eq!(median(Vec::new()), None);
}

#[test]
fn of_an_even_count_the_median_is_the_mean_of_the_two_in_the_middle() {
    for (numbers, wanted) in [
        (vec![4.0], 4.0),
        (vec![5.0, 1.0], 3.0),
        (vec![9.0, 2.0, 1.0], 2.0),
        (vec![9.0, 2.0, 1.0, 3.0], 2.5),
        (vec![1.0, f64::INFINITY, 2.0, f64::INFINITY], f64::INFINITY),
    ] {
        assert_eq!(median(numbers.clone()), Some(wanted), "{numbers:?}");
    }
}

#[test]
fn a_track_that_ends_early_is_lost_after_its_end() {
    let got = of(&[true; 3], &[Some(0.0), Some(0.0)]);
    assert_eq!((got.n_samples, got.n_lost), (2, 1));
}

#[test]
fn samples_one_by_one() {
    let path =
        TruePath { first_frame: 9, positions: vec![(0.0, 0.0, true), (0.0, 4.0, true), (3.0, 4.0, false)] };
    let samples = compared(&path, 9, &track(&[Some(3.0), None]));
    let told: Vec<_> = samples.iter().map(|s| (s.frame, s.visible, s.error_px())).collect();
    assert_eq!(told, [(10, true, Some(5.0)), (11, false, None)]);
}

#[test]
fn drift_by_time_since_the_query() {
    // Two queries in different frames: what counts is the time since.
    let late = TruePath { first_frame: 10, positions: vec![(0.0, 0.0, true); 3] };
    let early = truth(&[true; 3]);
    let (a, b) = (track(&[Some(0.0), Some(1.0), Some(2.0)]), track(&[Some(9.0), Some(0.0), Some(4.0)]));
    let curve = drift([(&early, 10, &a), (&late, 11, &b)]);
    let told: Vec<_> = curve.iter().map(|d| (d.first, d.last, d.median_px, d.n_samples)).collect();
    assert_eq!(told, [(1, 1, Some(2.5), 2), (2, 2, Some(2.0), 1)]);
    // Where most are lost, nothing can be said of the rest.
    let lost = drift([(&truth(&[true; 3]), 10, &track(&[Some(0.0), Some(0.0), None]))]);
    let told: Vec<_> = lost.iter().map(|d| (d.first, d.median_px, d.lost)).collect();
    assert_eq!(told, [(1, Some(0.0), 0.0), (2, None, 1.0)]);
    // Where nothing is visible there is no point, and a long clip has twelve.
    assert_eq!(drift([(&truth(&[true, false, true]), 10, &track(&[Some(0.0); 3]))]).len(), 1);
    let long = drift([(&truth(&[true; 151]), 10, &track(&[Some(0.0); 151]))]);
    assert_eq!(
        (long.len(), long[0].first, long[0].last, long[11].first, long[11].last),
        (12, 1, 12, 138, 150)
    );
    assert_eq!(long.iter().map(|d| d.n_samples).sum::<u64>(), 150);
}

#[test]
fn errors_fall_into_half_octaves() {
    close(Histogram::edge_px(1), 1.0 / 32.0, "lower edge");
    close(Histogram::edge_px(11), 1.0, "middle");
    close(Histogram::edge_px(23), 64.0, "upper edge");
    let offsets = [Some(0.0), Some(0.01), Some(1.0), Some(1.4), Some(1.5), Some(64.0), Some(1e6), None];
    let got = histogram([(&truth(&[true; 8]), 10, &track(&offsets))]).unwrap();
    let filled: Vec<_> = (0..24).filter(|&k| got.shares[k] > 0.0).map(|k| (k, got.shares[k] * 7.0)).collect();
    for ((bin, n), (wanted_bin, wanted_n)) in filled.iter().zip([(0, 1.0), (11, 2.0), (12, 1.0), (23, 2.0)]) {
        assert_eq!(*bin, wanted_bin);
        close(*n, wanted_n, &format!("{filled:?}"));
    }
    close(got.lost(), 1.0 / 7.0, "lost");
}
