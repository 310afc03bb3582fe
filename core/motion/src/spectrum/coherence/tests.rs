//! Motions of which it is known how much of them is common.

use rand::{RngExt, SeedableRng};

use super::*;
use honami_model::clip::FrameTimes;

type Track = Vec<Option<[f32; 2]>>;

/// How far each of several tracks sways, and how much later, turns.
type Sways<'a> = &'a dyn Fn(u32) -> Vec<(f64, f64)>;

const HZ: f64 = 1.3;

/// 300 frames, evenly timed or not.
fn times(is_even: bool) -> Vec<f64> {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
    let shift = (0..300).map(|_| if is_even { 0.0 } else { rng.random_range(-0.015..0.015) });
    (0..300).zip(shift).map(|(frame, shift)| f64::from(frame) / 25.0 + shift).collect()
}

fn coherence(times_s: &[f64], tracks: &[Track], hz: f64) -> Option<f64> {
    let times = FrameTimes::new(times_s.to_vec()).unwrap();
    Analyser::new(&times).unwrap().coherence(tracks, hz)
}

/// A track that sways about a place of its own: how far, and how much later, turns.
fn sway(times_s: &[f64], at: f64, sways: &[(f64, f64)]) -> Track {
    let value = |t: f64| sways.iter().map(|(far, late)| far * (TAU * (HZ * t - late)).sin()).sum::<f64>();
    let place =
        |t: &f64| Some([(at + 0.6 * value(*t)) as f32, (90.0 - at + 0.8 * value(*t) + 0.4 * t) as f32]);
    times_s.iter().map(place).collect()
}

#[test]
fn known_shares() {
    let even = times(true);
    let own = |n: u32| move |k: u32| vec![(2.0, 0.1), (1.0, f64::from(k) / f64::from(n))];
    let lever = |k: u32| vec![(f64::from(k + 1), 0.1)];
    let cases: [(&str, u32, Sways<'_>, f64); 6] = [
        ("all alike", 5, &|_| vec![(3.0, 0.2)], 1.0),
        // What eight add of their own adds up to nothing, less than by chance: (8 C / (C + D) - 1) / 7.
        ("some of their own", 8, &own(8), (8.0 * 0.8 - 1.0) / 7.0),
        ("some of their own, three", 3, &own(3), (3.0 * 0.8 - 1.0) / 2.0),
        // ((Σ g)² - Σ g²) / ((n - 1) Σ g²), of 1 to 4.
        ("by different amounts", 4, &lever, (100.0 - 30.0) / (3.0 * 30.0)),
        ("a tip and its middle", 2, &lever, 0.8),
        ("one against the other", 2, &|k| vec![(2.0, 0.5 * f64::from(k))], 0.0),
    ];
    for (name, n, sways, wanted) in cases {
        let tracks: Vec<Track> = (0..n).map(|k| sway(&even, 40.0 * f64::from(k), &sways(k))).collect();
        let found = coherence(&even, &tracks, HZ).unwrap();
        assert!((found - wanted).abs() < 2e-3, "{name}: {found}, not {wanted}");
        // Neither uneven times nor frames in which some are not seen make it another.
        let uneven = times(false);
        let mut tracks: Vec<Track> = (0..n).map(|k| sway(&uneven, 40.0 * f64::from(k), &sways(k))).collect();
        tracks[0][250..].fill(None);
        let found = coherence(&uneven, &tracks, HZ).unwrap();
        assert!((found - wanted).abs() < 0.05, "{name}, with gaps: {found}, not {wanted}");
    }
}

#[test]
fn what_is_shared_under_noise() {
    let even = times(true);
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
    let mut noise = || rng.random_range(-1.0_f32..1.0);
    for (common_px, least, most) in [(0.0, 0.0, 0.03), (0.08, 0.2, 0.8), (5.0, 0.99, 1.0)] {
        let mut track = |k: u32| -> Track {
            let sway = sway(&even, f64::from(k), &[(common_px, 0.0)]);
            sway.into_iter().map(|at| at.map(|[x, y]| [x + noise(), y + noise()])).collect()
        };
        let tracks: Vec<Track> = (0..60).map(&mut track).collect();
        let found = coherence(&even, &tracks, HZ).unwrap();
        assert!((least..=most).contains(&found), "{found} of {common_px} px");
    }
}

#[test]
fn what_shares_nothing_or_is_nothing() {
    let even = times(true);
    let (moves, still) = (sway(&even, 1.0, &[(2.0, 0.0)]), sway(&even, 9.0, &[]));
    let brief: Track = moves.iter().enumerate().map(|(k, at)| at.filter(|_| k < 7)).collect();
    let stands = vec![Some([3.0, 4.0]); even.len()];
    for (tracks, wanted) in [
        (vec![], None),
        (vec![moves.clone()], None),
        (vec![moves.clone(), brief], None),
        (vec![stands.clone(), stands], None),
    ] {
        assert_eq!(coherence(&even, &tracks, HZ), wanted);
    }
    assert!(coherence(&even, &[moves.clone(), still], HZ).unwrap() < 1e-3);
    // Also where the band reaches below 0 Hz.
    assert!(coherence(&even, &[moves.clone(), moves], 0.05).is_some());
}
