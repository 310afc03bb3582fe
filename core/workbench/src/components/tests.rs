//! Swings that are known, noise alone, and what has no components.

use honami_model::track::{Quality, Sample, Source, Status};

use super::*;

const FPS: f64 = 25.0;

struct Deaf;

impl Progress for Deaf {
    fn report(&self, _: u64, _: u64, _: &str) -> Flow {
        Flow::Continue
    }
}

/// So many tracks in so many frames.
fn of_tracks(
    n_tracks: u32,
    n_frames: u32,
    at: impl Fn(u32, u32) -> [f64; 2],
) -> Result<Components, WorkbenchError> {
    let sample = |[x, y]: [f64; 2]| Sample {
        x: x as f32,
        y: y as f32,
        status: Status::Tracked,
        source: Source::Tracked,
        quality: Quality { fb_px: None, ncc: None },
    };
    let span = |track| {
        let samples = (0..n_frames).map(|frame| sample(at(track, frame))).collect();
        (TrackId(track), Arc::new(Span { first_frame: 0, samples }))
    };
    let tracks: Vec<_> = (0..n_tracks).map(span).collect();
    of(&FrameTimes::constant(n_frames, FPS).unwrap(), &tracks, 8, &Deaf)
}

/// Numbers between -1 and 1 that look like chance (the fractions of the golden ratio's multiples, scrambled).
fn noise(k: u32) -> f64 {
    let mut state = u64::from(k).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Ten tracks swing by 6 px across at 1 Hz, thirty others by 2 px at 60 degrees at 2.5 Hz, half of these the other way.
#[test]
fn two_swings_are_two_components_with_their_numbers() {
    let swing = |hz: f64, frame: u32| (std::f64::consts::TAU * hz * f64::from(frame) / FPS).sin();
    let up = 60.0_f64.to_radians();
    let place = |track: u32| [20.0 * f64::from(track), 100.0 + f64::from(track * 37 % 50)];
    let found = of_tracks(40, 400, |track, frame| {
        let [x, y] = place(track);
        let k = 2 * (track * 400 + frame);
        let (dx, dy) = if track < 10 {
            (6.0 * swing(1.0, frame), 0.0)
        } else {
            let way = if track % 2 == 0 { 2.0 } else { -2.0 };
            (way * up.cos() * swing(2.5, frame), -way * up.sin() * swing(2.5, frame))
        };
        [x + dx + 0.05 * noise(k), y + dy + 0.05 * noise(k + 1)]
    })
    .unwrap();
    assert_eq!((found.n_above, found.n_below, found.list.len()), (2, 78, 2));
    // Whole periods: the squares of sines sum to T / 2.
    for (component, wanted) in found.list.iter().zip([(1.0, 0.0, 6.0, 10.0), (2.5, 60.0, 2.0, 30.0)]) {
        let (hz, degrees, px, n) = wanted;
        let peak = component.peak.as_ref().unwrap();
        assert!((peak.hz - hz).abs() < 0.005, "{peak:?}");
        assert!((component.width_hz.unwrap() / (1.44 * FPS / 400.0) - 1.0).abs() < 0.05);
        let off = (component.axis.angle_rad.to_degrees() - degrees + 90.0).rem_euclid(180.0) - 90.0;
        assert!(off.abs() < 0.5 && component.axis.straight > 0.99, "{:?}", component.axis);
        assert!((component.singular_px / (px * (n * 200.0_f64).sqrt()) - 1.0).abs() < 0.01);
        let share = px * px * n / (36.0 * 10.0 + 4.0 * 30.0);
        assert!((component.share - share).abs() < 0.01, "{} of {share}", component.share);
        assert_eq!(component.n_half, n as usize / 2);
        let square: f64 = component.chronos.iter().flatten().map(|v| v * v).sum::<f64>() / 400.0;
        assert!((square - 1.0).abs() < 1e-9);
        for (k, &[dx, dy]) in component.topos_px.iter().enumerate() {
            let joins = (k < 10) == (px > 3.0);
            let wanted = if joins { px * 0.5_f64.sqrt() } else { 0.0 };
            assert!((dx.hypot(dy) - wanted).abs() < 0.03, "track {k}: {dx} {dy}, wanted {wanted}");
        }
    }
    let [a, b] = [10, 11].map(|k| found.list[1].topos_px[k]);
    assert!(a[0] * b[0] + a[1] * b[1] < 0.0, "every other goes the other way");
    for (track, (id, at)) in (0..40).zip(&found.places) {
        let [x, y] = place(track);
        assert!(id.0 == track && (at[0] - x).hypot(at[1] - y) < 0.02);
    }
}

#[test]
fn noise_alone_has_none_and_what_has_no_components_says_why() {
    let of_noise = of_tracks(60, 150, |track, frame| {
        let k = 2 * (track * 150 + frame);
        [0, 1].map(|axis| 50.0 + noise(k + axis))
    })
    .unwrap();
    assert_eq!((of_noise.n_above, of_noise.n_below, of_noise.list.len()), (0, 120, 0));
    let few = "at least 4 tracks in 8 frames";
    for (n_tracks, n_frames, why) in [
        (0, 50, "no tracks"),
        (1, 50, few),
        (2, 50, few),
        (9, 2, few),
        (9, 7, "came 9 tracks in 7 frames"),
        (9, 50, "nothing moves: 9 tracks stand still in all 50 frames"),
    ] {
        let said = of_tracks(n_tracks, n_frames, |track, _| [f64::from(track), 3.0]).unwrap_err().to_string();
        assert!(said.contains(why), "{n_tracks} {n_frames}: {said}");
    }
}
