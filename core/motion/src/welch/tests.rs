//! Spectra held against SciPy's numbers, against what power is by definition, and against many draws of noise.

use std::f64::consts::{PI, TAU};

use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::*;

fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| StandardNormal.sample(&mut rng)).collect()
}

/// Two series without a random number: what both sides can compute.
fn fixed() -> [Vec<f64>; 2] {
    let x = (0..101).map(|k| f64::from((k * k * 7919 + k * 37) % 1009) / 1009.0 + 0.02 * f64::from(k));
    let x: Vec<f64> = x.collect();
    let own = |k: i32| f64::from((k * k * k * 31 + k * 5) % 997) / 997.0 - 0.01 * f64::from(k);
    let y = (0..101).map(|k| own(k) + 0.5 * x[k as usize]).collect();
    [x, y]
}

fn near(found: f64, wanted: f64, what: &str) {
    assert!((found - wanted).abs() < 1e-9 * wanted.abs().max(1e-6), "{what}: {found}, wanted {wanted}");
}

#[test]
fn densities_are_those_of_scipy() {
    // SciPy 1.17: welch(x, fs=8, window=W, nperseg=24, noverlap=12, nfft=96, detrend="linear") at bins 1, 7, 20, 48.
    let table = [
        (
            Window::Hann,
            [0.015591155854913762, 0.03185420439471354, 0.016716448520131186, 0.0034340472226312385],
        ),
        (
            Window::Hamming,
            [0.012906696465653114, 0.032640098859997003, 0.017121857814315786, 0.0029330486794017425],
        ),
        (
            Window::Blackman,
            [0.02017009475471137, 0.030414292864264687, 0.014433583790112444, 0.0037019948647635456],
        ),
        (
            Window::Rect,
            [0.0002719632785676466, 0.03008697305417606, 0.01645831035464581, 0.003360905572058695],
        ),
    ];
    let [x, _] = fixed();
    for (window, wanted) in table {
        let found = Welch::new(8.0, window, 24).unwrap().density(&[&x]).unwrap();
        assert_eq!((found.per_hz.len(), found.n_pieces), (49, 7));
        for (bin, wanted) in [1, 7, 20, 48].into_iter().zip(wanted) {
            near(found.per_hz[bin], wanted, window.word());
        }
    }
    // And of 25 samples a piece, 12 of them the one before's.
    let odd = Welch::new(8.0, Window::Hann, 25).unwrap().density(&[&x]).unwrap();
    for (bin, wanted) in [(1, 0.00871304622096304), (20, 0.018041586210003374), (50, 0.0029865233119676575)] {
        near(odd.per_hz[bin], wanted, "odd");
    }
}

#[test]
fn coherence_and_phase_are_those_of_scipy() {
    // SciPy 1.17: coherence and minus the angle of csd, of the same pieces, at bins 7, 20, 33.
    let [x, y] = fixed();
    let found = Welch::new(8.0, Window::Hann, 24).unwrap().cross(&[[&x, &y]]).unwrap();
    let coherence = [0.10940310706459792, 0.4481278720773604, 0.23863910192260582];
    let phase = [0.032532750886400764, -0.11396524899129698, -2.0330384064573983];
    for ((bin, coherence), phase) in [7, 20, 33].into_iter().zip(coherence).zip(phase) {
        near(found.coherence[bin], coherence, "coherence");
        near(found.phase_rad[bin], phase, "phase");
    }
}

#[test]
fn the_power_of_all_frequencies_is_the_mean_square() {
    // Parseval: exact for one piece without a window; a sine of amplitude A has A²/2 through any.
    let series = straightened(&noise(64, 1));
    let welch = Welch::new(10.0, Window::Rect, 64).unwrap();
    let mean_square = series.iter().map(|v| v * v).sum::<f64>() / 64.0;
    near(welch.density(&[&series]).unwrap().mean_square(), mean_square, "Parseval");
    let sine: Vec<f64> = (0..2000).map(|k| 3.0 * (TAU * 1.3 * f64::from(k) / 10.0 + 0.4).sin()).collect();
    for window in Window::ALL {
        let found = Welch::new(10.0, window, 200).unwrap().density(&[&sine]).unwrap();
        assert!((found.mean_square() / 4.5 - 1.0).abs() < 0.01, "{window:?}: {}", found.mean_square());
        // Its peak is its power over the noise bandwidth, and as broad as the window has it.
        let top = found.per_hz.iter().copied().fold(0.0, f64::max);
        assert!((top * found.noise_hz / 4.5 - 1.0).abs() < 0.02, "{window:?}: {top}");
        let peak = found.peak([0.2, 5.0]).unwrap();
        assert!((peak.hz - 1.3).abs() < 1e-3, "{window:?}: {peak:?}");
        assert!((peak.width_hz / peak.window_hz - 1.0).abs() < 0.04, "{window:?}: {peak:?}");
    }
}

#[test]
fn noise_is_within_its_band_as_often_as_it_says() {
    // White noise of variance 1 at 20 a second has 0.1 for each hertz. Values four apart are of other frequencies.
    for (window, n_piece, n) in
        [(Window::Hann, 32, 300), (Window::Rect, 40, 220), (Window::Blackman, 64, 200)]
    {
        let welch = Welch::new(20.0, window, n_piece).unwrap();
        let (mut inside, mut tried, mut sum, mut squares) = (0, 0, 0.0, 0.0);
        let mut freedom = 0.0;
        for seed in 0..300 {
            let series = noise(n, seed);
            let found = welch.density(&[&series]).unwrap();
            let [low, high] = found.band(0.9);
            freedom = found.freedom;
            for k in (2 * PADDING + 4..found.per_hz.len() - 2 * PADDING).step_by(PADDING) {
                let value = found.per_hz[k];
                inside += u32::from((low * value..=high * value).contains(&0.1));
                tried += 1;
                (sum, squares) = (sum + value, squares + value * value);
            }
        }
        let mean = sum / f64::from(tried);
        let variance = squares / f64::from(tried) - mean * mean;
        assert!((mean / 0.1 - 1.0).abs() < 0.02, "{window:?}: {mean}");
        // Bendat and Piersol: the variance is the mean squared, twice, over the degrees of freedom.
        let of_variance = 2.0 * mean * mean / variance;
        assert!((of_variance / freedom - 1.0).abs() < 0.07, "{window:?}: {of_variance} and {freedom}");
        let share = f64::from(inside) / f64::from(tried);
        assert!((share - 0.9).abs() < 0.015, "{window:?}: {share} of {tried}");
    }
}

#[test]
fn stretches_are_not_joined() {
    // A sine that begins anew after a gap: joined it would be broader.
    let part =
        |phase: f64| (0..150).map(|k| (TAU * 1.1 * f64::from(k) / 10.0 + phase).sin()).collect::<Vec<_>>();
    let (a, b) = (part(0.0), part(2.5));
    let welch = Welch::new(10.0, Window::Hann, 100).unwrap();
    let found = welch.density(&[&a, &[1.0, 2.0], &b]).unwrap();
    assert_eq!(found.n_pieces, 4, "two of each");
    assert!((found.peak([0.5, 2.0]).unwrap().width_hz / found.window_hz - 1.0).abs() < 0.03);
    // Two stretches of two pieces that overlap by half, against one of all four.
    let whole: Vec<f64> = a.iter().chain(&b[..100]).copied().collect();
    let joined = welch.density(&[&whole]).unwrap();
    assert!(joined.n_pieces == 4 && joined.freedom < found.freedom, "{joined:?}");
    assert_eq!(welch.density(&[&a[..99]]), None);
    assert_eq!(Welch::new(10.0, Window::Hann, 7).unwrap_err(), TooShort { came: 7 });
}

#[test]
fn a_resonance_is_as_broad_as_its_damping_and_the_window() {
    // An oscillator of 2 Hz and 5 % in white noise, stepped exactly: x[k] = 2 e cos(w) x[k-1] - e² x[k-2] + noise.
    let (fps, hz, zeta) = (20.0, 2.0, 0.05);
    let decay = (-zeta * TAU * hz / fps).exp();
    let turn = TAU * hz * f64::sqrt(1.0 - zeta * zeta) / fps;
    let mut x = vec![0.0, 0.0];
    for push in noise(200_000, 5) {
        let n = x.len();
        x.push(2.0 * decay * turn.cos() * x[n - 1] - decay * decay * x[n - 2] + push);
    }
    let peak =
        |n| Welch::new(fps, Window::Hann, n).unwrap().density(&[&x]).unwrap().peak([1.0, 3.0]).unwrap();
    let (long, short) = (peak(800), peak(200));
    assert!((long.hz - 2.0).abs() < 0.03 && (long.damping() - zeta).abs() < 0.005, "{long:?}");
    let decrement = long.log_decrement().unwrap();
    assert!((decrement - TAU * zeta).abs() < 0.04, "{decrement}");
    // Pieces of 10 s are too short for 0.2 Hz: broader, by no more than what the window is said to add.
    let excess = short.damping() - zeta;
    assert!(excess > 0.005 && excess < short.window_damping(), "{short:?}");
}

#[test]
fn a_copy_that_comes_later_is_behind_by_its_delay() {
    let series = noise(4003, 7);
    let tau = 3.0 / 25.0;
    let own = noise(4000, 8);
    let second: Vec<f64> = series[..4000].iter().zip(&own).map(|(v, own)| v + 0.5 * own).collect();
    let found = Welch::new(25.0, Window::Hann, 100).unwrap().cross(&[[&series[3..], &second]]).unwrap();
    let (mut misses, mut tried) = (0.0, 0.0);
    for k in (8..found.coherence.len() - 8).step_by(PADDING) {
        let hz = k as f64 * found.step_hz;
        let off = (found.phase_rad[k] - TAU * hz * tau + PI).rem_euclid(TAU) - PI;
        // 1 / (1 + 0.25) is the first's; errors of the phase are as they are said to be.
        assert!((found.coherence[k] - 0.8).abs() < 0.2, "{}", found.coherence[k]);
        misses += (off / found.phase_error_rad(k)).powi(2);
        tried += 1.0;
    }
    let ratio = f64::sqrt(misses / tried);
    assert!((0.75..1.3).contains(&ratio), "{ratio}");
    assert!((found.coherence.iter().sum::<f64>() / found.coherence.len() as f64 - 0.8).abs() < 0.03);
}

#[test]
fn strangers_have_the_coherence_of_chance() {
    let welch = Welch::new(10.0, Window::Hann, 40).unwrap();
    let (mut sum, mut tried, mut below, mut bias) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..200 {
        let (a, b) = (noise(220, 2 * seed), noise(220, 2 * seed + 1));
        let found = welch.cross(&[[&a, &b]]).unwrap();
        bias = found.bias();
        for k in (8..found.coherence.len() - 8).step_by(PADDING) {
            sum += found.coherence[k];
            below += f64::from(u8::from(found.coherence[k] < found.chance(0.9)));
            tried += 1.0;
        }
    }
    assert!((sum / tried / bias - 1.0).abs() < 0.05, "{} and {bias}", sum / tried);
    assert!((below / tried - 0.9).abs() < 0.02, "{}", below / tried);
}

#[test]
fn what_has_nothing_to_compare_is_said() {
    let welch = Welch::new(10.0, Window::Hann, 40).unwrap();
    let (series, still) = (noise(60, 1), vec![2.0; 60]);
    assert_eq!(welch.cross(&[[&series, &still]]), None);
    assert_eq!(welch.cross(&[[&series[..59], &series[..59]]]), None, "one piece always has coherence 1");
    let found = welch.cross(&[[&series, &series]]).unwrap();
    assert!(found.coherence[20] > 1.0 - 1e-12 && found.phase_error_rad(20) < 1e-5);
    assert_eq!((found.bin(0.0), found.bin(99.0)), (0, found.coherence.len() - 1));
}
