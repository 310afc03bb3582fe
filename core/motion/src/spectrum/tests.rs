//! Sines of known frequency and amplitude, even and uneven, clean and noisy; aliases; the two methods agree.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};

use super::*;

struct Clip {
    times_s: Vec<f64>,
}

impl Clip {
    fn even(n: u32, fps: f64) -> Self {
        Self { times_s: (0..n).map(|k| f64::from(k) / fps).collect() }
    }

    /// Steps of 20 to 100 ms.
    fn uneven(n: u32) -> Self {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        let steps = (0..n).map(|_| rng.random_range(0.02..0.1));
        Self { times_s: steps.scan(0.0, |t, step| Some(std::mem::replace(t, *t + step))).collect() }
    }

    fn analyser(&self) -> Analyser {
        Analyser::new(&FrameTimes::new(self.times_s.clone()).expect("times")).expect("long enough")
    }

    /// Sways (hz, amplitude along the direction (3, 4)/5), drift, and noise of the given size in x and y.
    fn track(&self, sways: &[(f64, f64)], noise: f64, seed: u64) -> Vec<Option<[f32; 2]>> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let at = |t: &f64| {
            let sway: f64 = sways.iter().map(|(hz, a)| a * (TAU * hz * t + 0.7).sin()).sum();
            let mut shake = || noise * 3.0_f64.sqrt() * rng.random_range(-1.0..1.0);
            Some([(300.0 + 2.0 * t + 0.6 * sway + shake()) as f32, (40.0 + 0.8 * sway + shake()) as f32])
        };
        self.times_s.iter().map(at).collect()
    }

    fn peaks(&self, track: &[Option<[f32; 2]>]) -> Vec<Peak> {
        self.analyser().track(track).expect("a spectrum").peaks(4, 5.0)
    }
}

#[test]
fn an_even_clip_gives_frequency_and_amplitude_between_its_bins() {
    for (n, fps, hz, amplitude) in
        [(378, 25.0, 1.06, 8.2), (200, 25.0, 3.517, 0.4), (500, 500.0, 31.97, 2.0), (175, 29.97, 9.3, 1.0)]
    {
        let clip = Clip::even(n, fps);
        let peaks = clip.peaks(&clip.track(&[(hz, amplitude)], 0.0, 0));
        let cell = fps / f64::from(n);
        assert_eq!(peaks.len(), 1, "{peaks:?}");
        assert!((peaks[0].hz - hz).abs() < 0.02 * cell, "{} for {hz}, cell {cell}", peaks[0].hz);
        assert!(
            (peaks[0].amplitude_px / amplitude - 1.0).abs() < 0.02,
            "{} for {amplitude}",
            peaks[0].amplitude_px
        );
    }
}

/// 1.44 bins: the -3 dB bandwidth of Hann's window (Harris, Proc. IEEE 66, 1978, table 1); of a sway that dies away as
/// exp(-a t), a / π in a long clip.
#[test]
fn a_steady_peak_is_as_broad_as_the_window_and_a_damped_one_broader() {
    let width = |clip: &Clip, track: &[Option<[f32; 2]>]| {
        let spectrum = clip.analyser().track(track).expect("a spectrum");
        // What is broad does not stand out of what is around it.
        spectrum.width_hz(&spectrum.peaks(1, 0.0)[0])
    };
    let clip = Clip::even(400, 25.0);
    let wanted = 1.44 * 25.0 / 400.0;
    let got = width(&clip, &clip.track(&[(3.21, 5.0)], 0.0, 1));
    assert!((got / wanted - 1.0).abs() < 0.03, "{got} Hz, wanted {wanted}");
    let (long, decay) = (Clip::even(1000, 25.0), 6.0);
    // From the middle of the clip on, where the window is flat.
    let at = |t: &f64| {
        let since = t - 20.0;
        let swing = if since < 0.0 { 0.0 } else { 50.0 * (-decay * since).exp() * (TAU * 5.0 * since).sin() };
        Some([(100.0 + swing) as f32, 40.0])
    };
    let damped: Vec<_> = long.times_s.iter().map(at).collect();
    let (got, wanted) = (width(&long, &damped), decay / std::f64::consts::PI);
    assert!((got / wanted - 1.0).abs() < 0.1, "{got} Hz, wanted {wanted}");
}

#[test]
fn two_sways_are_told_apart_in_noise() {
    let clip = Clip::even(400, 25.0);
    let peaks = clip.peaks(&clip.track(&[(1.2, 2.0), (2.9, 0.7)], 0.3, 5));
    let found: Vec<f64> = peaks.iter().map(|p| p.hz).collect();
    assert_eq!(found.len(), 2, "{peaks:?}");
    assert!((found[0] - 1.2).abs() < 0.01 && (found[1] - 2.9).abs() < 0.01, "{found:?}");
    assert!((peaks[1].amplitude_px - 0.7).abs() < 0.1);
}

#[test]
fn uneven_times_and_gaps_give_the_same_sway() {
    let uneven = Clip::uneven(300);
    let even = Clip::even(300, 25.0);
    let mut with_gaps = even.track(&[(1.7, 3.0)], 0.1, 1);
    for frame in (40..60).chain(150..155).chain([200, 290]) {
        with_gaps[frame] = None;
    }
    for (clip, track) in [(&uneven, uneven.track(&[(1.7, 3.0)], 0.1, 1)), (&even, with_gaps)] {
        let peaks = clip.peaks(&track);
        assert!((peaks[0].hz - 1.7).abs() < 0.01, "{peaks:?}");
        assert!((peaks[0].amplitude_px - 3.0).abs() < 0.1, "{peaks:?}");
    }
    assert!(uneven.peaks(&uneven.track(&[(1.7, 3.0)], 0.1, 1))[0].aliases_hz.is_empty());
}

#[test]
fn both_methods_agree_on_even_samples() {
    let clip = Clip::even(128, 25.0);
    let analyser = clip.analyser();
    let values: Vec<f64> =
        clip.track(&[(2.2, 1.0)], 0.5, 9).iter().map(|p| f64::from(p.unwrap()[0])).collect();
    let values = detrended(&clip.times_s, values);
    let window = hann(&clip.times_s);
    let by_fft = analyser.by_fft(&values, &window);
    let by_fit = lomb::power(&clip.times_s, &values, &window, analyser.step_hz(), by_fft.len());
    let largest = by_fft.iter().fold(0.0_f64, |a, &b| a.max(b));
    // Away from 0 and Nyquist, where a sine and a constant look alike and the fit takes that into account.
    for k in 4 * PADDING..by_fft.len() - 4 * PADDING {
        assert!((by_fft[k] - by_fit[k]).abs() < 0.01 * largest, "bin {k}: {} {}", by_fft[k], by_fit[k]);
    }
}

#[test]
fn a_sway_beyond_the_band_is_named_among_the_aliases() {
    // The 128 Hz tuning fork at 250 frames a second.
    let clip = Clip::even(1000, 250.0);
    let peak = &clip.peaks(&clip.track(&[(128.0, 1.0)], 0.1, 2))[0];
    assert!((peak.hz - 122.0).abs() < 0.01);
    assert!((peak.aliases_hz[0] - 128.0).abs() < 0.01 && peak.near_nyquist, "{peak:?}");
    let wanted = [250.0 - peak.hz, 250.0 + peak.hz, 500.0 - peak.hz];
    assert!(peak.aliases_hz.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!(!clip.peaks(&clip.track(&[(32.0, 1.0)], 0.1, 2))[0].near_nyquist);
}

#[test]
fn rounded_times_count_as_even_and_keep_the_rate() {
    let times = (0..300).map(|k| (f64::from(k) * 1000.0 / 29.97).round() / 1000.0);
    let clip = Clip { times_s: times.collect() };
    assert!(clip.analyser().is_even && (clip.analyser().fps - 29.97).abs() < 0.01);
}

#[test]
fn noise_has_hardly_a_peak_and_a_group_shows_a_sway_that_no_track_does() {
    let clip = Clip::even(300, 25.0);
    let spectra = |sways: &[(f64, f64)]| -> Vec<Spectrum> {
        (0..100)
            .map(|seed| clip.analyser().track(&clip.track(sways, 1.0, seed)).expect("a spectrum"))
            .collect()
    };
    let n_peaks = |spectra: &[Spectrum]| spectra.iter().map(|s| s.peaks(9, 7.0).len()).sum::<usize>();
    assert!(n_peaks(&spectra(&[])) <= 10, "{}", n_peaks(&spectra(&[])));
    let hidden = spectra(&[(4.0, 0.15)]);
    let group = Spectrum::median(&hidden).unwrap();
    assert_eq!(group.n_tracks, 100);
    let peaks = group.peaks(3, 1.3);
    assert!((peaks[0].hz - 4.0).abs() < 0.05, "{peaks:?}");
    assert!(Spectrum::median(&[]).is_none());
}

#[test]
fn a_gap_costs_no_more_memory_than_there_is() {
    let gap_after_49 = |gap_s: f64| {
        let times = (0..100).map(|k| f64::from(k) * 0.04 + if k < 50 { 0.0 } else { gap_s });
        Analyser::new(&FrameTimes::new(times.collect()).expect("times"))
    };
    assert!(gap_after_49(40_000.0).is_ok(), "a million frames");
    for gap_s in [43_200.0, 1e9, 1e12] {
        let error = gap_after_49(gap_s).unwrap_err();
        assert!(matches!(error, SpectrumError::Gap { frame: 49, .. }), "{error:?}");
        assert!(error.to_string().contains("between frames 49 and 50"), "{error}");
    }
}

#[test]
fn what_cannot_be_analysed_says_so_and_stillness_is_zero() {
    assert_eq!(
        Analyser::new(&FrameTimes::constant(7, 25.0).unwrap()).unwrap_err(),
        SpectrumError::TooFew { came: 7 }
    );
    let clip = Clip::even(100, 25.0);
    let mut track = vec![None; 100];
    track[..7].fill(Some([1.0, 2.0]));
    assert_eq!(clip.analyser().track(&track).unwrap_err(), SpectrumError::TooFew { came: 7 });
    for still in [vec![Some([1.0, 2.0]); 100], track.iter().map(|_| Some([f32::MAX, 0.0])).collect()] {
        let spectrum = clip.analyser().track(&still).unwrap();
        assert!(spectrum.power_px2.iter().all(|p| p.is_finite()));
        assert!(
            spectrum.peaks(5, 10.0).iter().all(|peak| peak.hz.is_finite() && peak.over_floor.is_finite())
        );
    }
}
