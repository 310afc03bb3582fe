//! The model does what its formula says, and fitting finds the model that made the samples.

use honami_model::track::{Quality, Sample};
use rand::{RngExt, SeedableRng};

use super::*;

#[test]
fn log_odds_by_hand() {
    let weight = |slope| Weight { slope, missing: 0.25, ordinary: 0.0 };
    let weights = Weights {
        base: -1.0,
        parts: [1.0, 2.0, 3.0, 4.0, 5.0, -4.0, 6.0, 7.0].map(weight),
        track: [0.5, 2.0],
    };
    let (fb_px, ncc, nbr_px, own_ncc) = (Some(0.98), Some(0.5), Some(0.5), Some(0.9375));
    let parts = Parts { fb_px, ncc, nbr_px, own_ncc, group_px: nbr_px, ..Parts::default() };
    // -1 + ln 1 + 2·.5 + .25 + 4·ln 1 + .25 - 4/16 + .25 + 7·ln 1
    assert!((weights.log_odds(&parts).0 - 0.5).abs() < 1e-6);
    assert!((weights.probability(&parts) - 0.622_459).abs() < 1e-6);
    // Odds 1 to 3 are -ln 3; twice that and a half more.
    assert!((weights.of_track(0.25) - 1.0 / (1.0 + (2.0 * 3.0_f64.ln() - 0.5).exp())).abs() < 1e-9);
}

#[test]
fn worse_evidence_is_never_less_suspicious() {
    let fair = Some(0.3);
    let good = Parts {
        fb_px: Some(0.05),
        ncc: Some(0.95),
        jump: Some(1.0),
        nbr_px: Some(0.5),
        group_px: Some(0.5),
        dis_px: fair,
        ..Parts::of(Kind::Stepwise)
    };
    let stepwise = Parts { anchored_px: fair, ..good };
    let anchored = Parts { own_ncc: Some(0.95), kind: Kind::Anchored, ..good };
    for good in [stepwise, anchored] {
        let worse = [
            Parts { fb_px: Some(3.0), ..good },
            Parts { ncc: Some(0.2), ..good },
            Parts { jump: Some(9.0), ..good },
            Parts { nbr_px: Some(12.0), ..good },
            Parts { group_px: Some(12.0), ..good },
            Parts { dis_px: Some(9.0), ..good },
        ];
        for parts in worse {
            assert!(probability(&parts) > probability(&good), "{parts:?}");
        }
        assert!(probability(&good) < 0.02);
    }
    let likeness = probability(&Parts { own_ncc: Some(0.5), ..anchored });
    assert!(likeness > probability(&anchored));
}

#[test]
fn a_stepwise_tracker_that_an_anchored_one_contradicts_is_doubtful() {
    // Nothing else speaks against it.
    let good = Parts {
        fb_px: Some(0.05),
        ncc: Some(0.9),
        jump: Some(1.0),
        nbr_px: Some(1.0),
        ..Parts::of(Kind::Stepwise)
    };
    let apart = |px| probability(&Parts { anchored_px: Some(px), ..good });
    assert!(apart(0.5) < 0.01 && apart(13.0) > 10.0 * apart(0.5), "{} {}", apart(0.5), apart(13.0));
}

#[test]
fn a_contradiction_is_not_outvoted_by_all_that_looks_right() {
    // As on malva, where KLT sits on another vein: every measure of the step is perfect.
    let smooth = Parts {
        kind: Kind::Stepwise,
        fb_px: Some(0.01),
        ncc: Some(0.99),
        jump: Some(0.1),
        nbr_px: Some(0.2),
        dis_px: Some(12.2),
        ..Parts::default()
    };
    for (anchored_px, wanted) in [(None, 0.0), (Some(1.0), 0.0), (Some(7.9), 0.0), (Some(12.2), CONTRADICTED)]
    {
        let came = probability(&Parts { anchored_px, ..smooth });
        assert!((came - wanted).abs() < 0.02, "{anchored_px:?}: {came}");
    }
    let anchored = Parts { kind: Kind::Anchored, anchored_px: Some(12.2), ..smooth };
    assert!(probability(&anchored) < 0.1, "the other way round it says little");
}

#[test]
fn a_persons_word_is_not_doubted_and_a_loss_is() {
    let sample = |status, source| Sample { x: 0.0, y: 0.0, status, source, quality: Quality::default() };
    let of = |status, source| of_sample(&sample(status, source), &Parts::default());
    for (status, source, want) in [
        (Status::Tracked, Source::Key, 0.0),
        (Status::Lost, Source::Key, 0.0),
        (Status::Tracked, Source::Sketch, 0.0),
        (Status::Occluded, Source::Tracked, 0.0),
        (Status::Outside, Source::Tracked, 0.0),
        (Status::Lost, Source::Tracked, LOST),
        (Status::Lost, Source::Interpolated, LOST),
    ] {
        assert!((of(status, source) - want).abs() < 1e-6, "{status:?} {source:?}");
    }
    let unknown = of(Status::Tracked, Source::Tracked);
    assert!(unknown > 0.0 && unknown < 1.0);
}

#[test]
fn fitting_finds_the_weights_that_made_the_samples() {
    let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let weight = |slope: f64| Weight { slope, missing: 0.5, ordinary: 0.0 };
    let slopes = [1.0, 3.0, 0.0, 0.8, 0.3, 2.0, 0.5, 0.6];
    let weights = Weights { base: -3.0, parts: slopes.map(weight), track: [0.0, 1.0] };
    let samples: Vec<(Parts, bool)> = (0..60_000)
        .map(|_| {
            let mut some = |to: f32| (rng.random_range(0.0..1.0) < 0.8).then(|| rng.random_range(0.0..to));
            let parts = Parts {
                fb_px: some(4.0),
                ncc: some(1.0),
                jump: some(9.0),
                nbr_px: some(20.0),
                dis_px: some(9.0),
                own_ncc: some(1.0),
                anchored_px: some(9.0),
                group_px: some(9.0),
                ..Parts::default()
            };
            let is_bad = rng.random_range(0.0..1.0) < weights.probability(&parts);
            (parts, is_bad)
        })
        .collect();
    let (base, parts) = fit::parts(&samples);
    let fitted = Weights { base, parts, ..weights };
    for (got, want) in fitted.parts.iter().zip(&weights.parts) {
        assert!((got.slope - want.slope).abs() < 0.2, "{fitted:?}");
    }
    let gap = |(parts, _): &(Parts, bool)| (fitted.probability(parts) - weights.probability(parts)).abs();
    assert!(samples.iter().map(gap).fold(0.0, f64::max) < 0.06);
    let of_track = Weights { track: [-0.7, 1.5], ..weights };
    let worst: Vec<(f64, bool)> = (0..20_000)
        .map(|_| {
            let p = rng.random_range(0.01..0.99);
            (p, rng.random_range(0.0..1.0) < of_track.of_track(p))
        })
        .collect();
    let [offset, slope] = fit::track(&worst);
    assert!((offset + 0.7).abs() < 0.1 && (slope - 1.5).abs() < 0.1, "{offset} {slope}");
    assert_eq!(fit::parts(&[]).0.to_bits(), 0.0_f64.to_bits());
}
