//! Against values worked out with 40 digits, moments in closed form, and angles at the ends of what there is.

use proptest::prelude::*;

use super::*;

/// κ, e^-κ I₀(κ), I₁(κ) / I₀(κ), and what that lacks to 1.
const BESSEL: [(f64, f64, f64, f64); 15] = [
    (1e-9, 0.999_999_999, 5.0e-10, 0.999_999_999_5),
    (0.01, 0.990_074_585_149_707_5, 0.004_999_937_501_041_649, 0.995_000_062_498_958_4),
    (0.5, 0.645_035_270_449_150_1, 0.242_499_612_580_801_95, 0.757_500_387_419_198_1),
    (1.5, 0.367_433_609_054_158_34, 0.596_133_238_831_290_7, 0.403_866_761_168_709_3),
    (2.0, 0.308_508_322_553_671_04, 0.697_774_657_964_008, 0.302_225_342_035_992),
    (5.0, 0.183_540_812_609_328_35, 0.893_383_137_044_085_2, 0.106_616_862_955_914_78),
    (10.0, 0.127_833_337_163_428_6, 0.948_599_825_954_846, 0.051_400_174_045_154_04),
    (19.99, 0.089_803_061_428_909_37, 0.974_657_662_618_498_2, 0.025_342_337_381_501_8),
    (20.0, 0.089_780_311_884_826_02, 0.974_670_507_889_807_1, 0.025_329_492_110_192_874),
    (20.01, 0.089_757_579_627_575_3, 0.974_683_340_138_214, 0.025_316_659_861_786_02),
    (50.0, 0.056_561_626_647_454_19, 0.989_948_967_378_497_8, 0.010_051_032_621_502_247),
    (700.0, 0.015_081_295_651_531_358, 0.999_285_458_818_426_1, 0.000_714_541_181_573_906_7),
    (701.0, 0.015_070_530_981_047_303, 0.999_286_478_499_809, 0.000_713_521_500_190_953_4),
    (1e5, 0.001_261_567_837_976_776_8, 0.999_994_999_987_499_9, 5.000_012_500_125_002e-6),
    (1e8, 0.000_039_894_228_090_011_05, 0.999_999_995, 5.000_000_012_5e-9),
];

fn is_near(found: f64, wanted: f64, share: f64) -> bool {
    (found - wanted).abs() <= share * wanted.abs()
}

#[test]
fn bessel_functions_and_the_inverse_of_their_ratio() {
    for (kappa, i0, ratio, gap) in BESSEL {
        let found = bessel::ratio(kappa);
        assert!(is_near(bessel::i0_scaled(kappa), i0, 1e-14), "{kappa}");
        assert!(is_near(found.0, ratio, 1e-14) && is_near(found.1, gap, 1e-13), "{kappa}: {found:?}");
        assert!(is_near(bessel::inverse(ratio, gap), kappa, 1e-12), "{kappa}");
    }
    for (ratio, gap, wanted) in [(0.0, 1.0, 0.0), (1e-12, 1.0, 2e-12), (1.0, 0.0, MAX_KAPPA)] {
        assert!((bessel::inverse(ratio, gap) - wanted).abs() <= 1e-12 * wanted, "{ratio}");
    }
}

/// E cos n(x - μ) = I_n(κ) / I₀(κ); of all angles by summing over the circle, which for smooth periodic functions is exact.
#[test]
fn the_density_has_its_moments() {
    for (kappa, wanted) in [(1.5, 0.596_133), (5.0, 0.893_383), (20.0, 0.974_671), (0.0, 0.0)] {
        let of = VonMises { mu: 2.0, kappa };
        let angles = (0..4096).map(|k| f64::from(k) * TAU / 4096.0);
        let sums = angles.fold([0.0; 2], |sums, angle| {
            let density = of.density(angle) * TAU / 4096.0;
            [sums[0] + density, sums[1] + density * (angle - 2.0).cos()]
        });
        assert!((sums[0] - 1.0).abs() < 1e-12 && (sums[1] - wanted).abs() < 1e-6, "{kappa}: {sums:?}");
    }
    // Errata Z5: peaks at the thresholds that Zeng recommends.
    for (kappa, peak) in [(1.044, 0.35), (1.314, 0.4), (1.597, 0.45)] {
        assert!((VonMises { mu: 0.0, kappa }.peak() - peak).abs() < 1e-4, "{kappa}");
    }
}

#[test]
fn the_ends_of_what_there_is() {
    let fit = |angles: &[f64]| VonMises::fit(angles);
    assert_eq!((fit(&[]), fit(&[f64::NAN]), fit(&[0.0, f64::INFINITY])), (None, None, None));
    for angles in [&[3.0][..], &[3.0; 40], &[3.0, 3.0 + TAU], &[3.0 - 1e-7, 3.0 + 1e-7]] {
        let found = fit(angles).unwrap();
        assert!((found.mu - 3.0).abs() < 1e-12 && found.kappa >= MAX_KAPPA, "{found:?}");
        let drawn = found.above(0.4).unwrap();
        assert!((drawn.quantile(0.0) - 3.0).abs() < 1e-3 && (drawn.quantile(1.0) - 3.0).abs() < 1e-3);
    }
    let across = fit(&[PI - 0.1, 0.1 - PI]).unwrap();
    assert!((across.mu.abs() - PI).abs() < 1e-12 && is_near(across.kappa, 1.0 / 0.01, 0.01), "{across:?}");
    let even: Vec<f64> = (0..8).map(|k| f64::from(k) * TAU / 8.0).collect();
    let even = fit(&even).unwrap();
    assert!(even.kappa < 1e-12, "{even:?}");
    let anywhere = even.above(0.1).unwrap();
    assert!((anywhere.half_width() - PI).abs() < 1e-12 && (anywhere.share() - 1.0).abs() < 1e-12);
    assert!((wrapped(anywhere.quantile(0.75) - even.mu) - PI / 2.0).abs() < 1e-9);
    assert_eq!(even.above(0.16), None, "1/2π is the density everywhere");
    assert_eq!(across.above(f64::NAN), None);
    assert!(across.above(across.peak()).unwrap().half_width() < 1e-12);
    assert!((across.above(-1.0).unwrap().share() - 1.0).abs() < 1e-12);
}

/// κ, threshold, half width, share that is left, and of these the angle that a share lies below.
const CUT: [(f64, f64, f64, f64, f64, f64); 12] = [
    (0.5, 0.0, PI, 1.0, 0.01, -3.031_535_182_306_86),
    (0.5, 0.0, PI, 1.0, 0.9, 2.128_474_984_280_33),
    (1.5, 0.4, 0.327_293_806_295_13, 0.276_161_227_782_352, 0.01, -0.320_401_165_378_926),
    (1.5, 0.4, 0.327_293_806_295_13, 0.276_161_227_782_352, 0.9, 0.259_303_750_038_762),
    (5.0, 0.4, 0.563_756_714_754_076, 0.772_764_949_170_77, 0.2, -0.285_554_806_975_874),
    (5.0, 0.4, 0.563_756_714_754_076, 0.772_764_949_170_77, 0.9, 0.405_437_426_276_622),
    (10.0, 0.4, 0.481_166_094_331_058, 0.862_868_113_055_29, 0.01, -0.460_591_921_766_905),
    (20.0, 0.4, 0.388_284_694_528_836, 0.913_530_609_496_219, 0.2, -0.169_504_788_996_163),
    (20.0, 0.4, 0.388_284_694_528_836, 0.913_530_609_496_219, 0.9, 0.249_325_562_069_75),
    (800.0, 0.001, 0.152_881_995_638_942, 0.999_984_345_281_103, 0.01, -0.082_274_718_672_128_7),
    (800.0, 0.001, 0.152_881_995_638_942, 0.999_984_345_281_103, 0.9, 0.045_319_393_094_376_3),
    (5.0, 0.001, 1.931_613_908_260_97, 0.999_503_829_701_057, 0.01, -1.132_664_413_736_42),
];

#[test]
fn what_is_left_above_a_threshold() {
    for (kappa, threshold, half_width, left, share, angle) in CUT {
        let of = VonMises { mu: 0.0, kappa };
        let cut = of.above(threshold).unwrap();
        assert!(is_near(cut.half_width(), half_width, 1e-12), "{kappa} {threshold}: {}", cut.half_width());
        assert!(is_near(cut.share(), left, 1e-11), "{kappa} {threshold}: {}", cut.share());
        assert!(is_near(cut.quantile(share), angle, 1e-11), "{kappa} {threshold}: {}", cut.quantile(share));
        if threshold > 0.0 {
            assert!(is_near(of.density(half_width), threshold, 1e-11));
        }
    }
}

proptest! {
    /// Angles spread as the distribution has them are fitted by it, wherever it lies.
    #[test]
    fn a_fit_finds_what_angles_came_from(mu in -3.1..3.1_f64, log_kappa in -1.0..7.0_f64) {
        let of = VonMises { mu, kappa: log_kappa.exp() };
        let all = of.above(0.0).unwrap();
        let angles: Vec<f64> = (0..300).map(|k| all.quantile((f64::from(k) + 0.5) / 300.0)).collect();
        prop_assert!(angles.iter().all(|angle| -PI < *angle && *angle <= PI));
        let found = VonMises::fit(&angles).unwrap();
        prop_assert!(wrapped(found.mu - mu).abs() < 1e-6, "{found:?}");
        prop_assert!(is_near(found.kappa, of.kappa, 0.01), "{found:?}");
    }

    /// Nothing that is drawn is less dense than the threshold, and a larger share is never an earlier angle.
    #[test]
    fn angles_keep_to_the_threshold(kappa in 0.0..2000.0_f64, of_peak in 0.0..1.0_f64, a in 0.0..1.0_f64, b in 0.0..1.0_f64) {
        let of = VonMises { mu: 0.0, kappa };
        let threshold = of_peak * of.peak();
        let cut = of.above(threshold).unwrap();
        let angles = [a.min(b), a.max(b)].map(|share| cut.quantile(share));
        prop_assert!(angles[0] <= angles[1]);
        for angle in angles {
            prop_assert!(angle.abs() <= cut.half_width() + 1e-12);
            prop_assert!(of.density(angle) >= threshold * (1.0 - 1e-9));
        }
        // Shares are counted back from where they are not too close to tell.
        for share in [a, b] {
            let found = cut.share_below(cut.quantile(share));
            prop_assert!(of_peak > 0.999 || (found - share).abs() < 1e-9, "{share}: {found}");
        }
        prop_assert!(cut.share_below(-4.0) <= 0.0 && cut.share_below(4.0) >= 1.0);
    }
}
