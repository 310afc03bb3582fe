//! Winds against what defines them.

use super::{
    Constant, Draw, Field, Frozen, Growth, Kaimal, Mask, Noise, Power, Primitive, Profile, Series, Shape,
    Sine, Spectrum, Sum, Wind, series,
};
use nalgebra::Vector3;
use realfft::RealFftPlanner;

const PLACES: [[f64; 3]; 4] = [[3.0, 4.0, 2.0], [-7.5, 0.3, 0.0], [0.9, -12.0, 8.0], [40.0, 25.0, 1.0]];

/// Derivatives by differences: divergence, and the upright part of the turning.
fn change(wind: &dyn Wind, place: &Vector3<f64>) -> (f64, f64) {
    let h = 1e-4;
    let along = |axis: usize| {
        let step = Vector3::from_fn(|k, _| if k == axis { h } else { 0.0 });
        (wind.sample(&(place + step), 0.0) - wind.sample(&(place - step), 0.0)) / (2.0 * h)
    };
    let [x, y, z] = [along(0), along(1), along(2)];
    (x.x + y.y + z.z, x.y - y.x)
}

#[test]
fn flow_primitives_neither_spring_nor_turn_away_from_their_axis() {
    for shape in [Shape::Source, Shape::Sink, Shape::Vortex] {
        let flow = Primitive { shape, centre: [0.5, -0.5], strength: 30.0, core: 0.1 };
        for place in PLACES.map(Vector3::from) {
            let (divergence, turning) = change(&flow, &place);
            assert!(
                divergence.abs() < 1e-7 && turning.abs() < 1e-7,
                "{shape:?} {place}: {divergence} {turning}"
            );
        }
    }
}

/// What flows through a circle, and round it, is the strength whatever the radius.
#[test]
fn strength_is_what_flows_through_or_round_every_circle() {
    for radius in [0.2, 1.0, 30.0] {
        let through = |shape: Shape, round: bool| {
            let flow = Primitive { shape, centre: [2.0, 1.0], strength: 12.0, core: 0.1 };
            let n = 360;
            let part = |k: i32| {
                let (sin, cos) = (f64::from(k) / f64::from(n) * std::f64::consts::TAU).sin_cos();
                let v = flow.sample(&Vector3::new(2.0 + radius * cos, 1.0 + radius * sin, 0.0), 0.0);
                let speed = if round { v.y * cos - v.x * sin } else { v.x * cos + v.y * sin };
                speed * std::f64::consts::TAU * radius / f64::from(n)
            };
            (0..n).map(part).sum::<f64>()
        };
        let cases = [(Shape::Source, [12.0, 0.0]), (Shape::Sink, [-12.0, 0.0]), (Shape::Vortex, [0.0, 12.0])];
        for (shape, [out, round]) in cases {
            assert!(
                (through(shape, false) - out).abs() < 1e-9 && (through(shape, true) - round).abs() < 1e-9
            );
        }
    }
}

#[test]
fn the_axis_itself_is_calm() {
    let flow = Primitive { shape: Shape::Vortex, centre: [0.0, 0.0], strength: 5.0, core: 0.5 };
    assert_eq!(flow.sample(&Vector3::new(0.0, 0.0, 3.0), 1.0), Vector3::zeros());
}

/// w(x + mean d, t + d) = w(x, t), and at t* it is what was given (errata E25).
#[test]
fn frozen_flow_is_the_same_air_further_on() {
    let turbulence = Noise { speed: 2.0, cell: 3.0, second: 1.5, seed: 7, n_cells: None };
    let wind = Frozen { mean: Vector3::new(4.0, -1.0, 0.0), turbulence, time: 11.0 };
    for place in PLACES.map(Vector3::from) {
        let given = wind.mean + turbulence.sample(&place, 11.0);
        assert!((wind.sample(&place, 11.0) - given).norm() < 1e-12);
        for d in [0.1, 2.0, -5.0] {
            let later = wind.sample(&(place + wind.mean * d), 13.0 + d);
            assert!((later - wind.sample(&place, 13.0)).norm() < 1e-9);
        }
    }
}

#[test]
fn noise_is_smooth_bounded_and_the_same_for_the_same_seed() {
    let noise = Noise { speed: 3.0, cell: 2.0, second: 1.0, seed: 1, n_cells: None };
    let other = Noise { seed: 2, ..noise };
    let (mut sum, mut squares, n) = (0.0, 0.0, 4000);
    // At whole numbers it is 0.
    for k in 1..=n {
        let at = Vector3::new(f64::from(k) * 0.3173, f64::from(k) * -0.0711, f64::from(k) * 0.0137);
        let v = noise.sample(&at, f64::from(k) * 0.0293);
        assert_eq!(v, noise.sample(&at, f64::from(k) * 0.0293));
        assert_ne!(v, other.sample(&at, f64::from(k) * 0.0293));
        assert!(v.amax() <= 3.0);
        let near = noise.sample(&(at + Vector3::new(1e-6, 0.0, 0.0)), f64::from(k) * 0.0293);
        assert!((v - near).norm() < 1e-4);
        sum += v.x;
        squares += v.x * v.x;
    }
    let (mean, deviation) = (sum / f64::from(n), (squares / f64::from(n)).sqrt());
    assert!(mean.abs() < 0.1 && (0.3..2.0).contains(&deviation), "{mean} {deviation}");
}

/// The variance is the integral of the density, and the slope in double logarithms is -beta (errata E24).
#[test]
fn a_draw_has_the_spectrum_that_it_was_drawn_from() {
    let (n, step) = (1 << 14, 0.05);
    let df = 1.0 / (n as f64 * step);
    let kaimal = Kaimal::along(1.3, 5.0, 30.0);
    let power = Power { at_1_hz: 0.2, beta: 5.0 / 3.0 };
    let density = |samples: &[f64]| {
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let (mut input, mut output) = (samples.to_vec(), forward.make_output_vec());
        forward.process(&mut input, &mut output).unwrap();
        output.iter().map(|v| 2.0 * v.norm_sqr() / (n as f64).powi(2) / df).collect::<Vec<f64>>()
    };
    let check = |samples: Vec<f64>, spectrum: &dyn Spectrum| {
        assert!(samples.iter().sum::<f64>().abs() < 1e-6);
        let got = density(&samples);
        for k in [1, 10, 100, 1000, 8000] {
            let wanted = spectrum.density(k as f64 * df);
            assert!((got[k] / wanted - 1.0).abs() < 1e-9, "{k}: {} {wanted}", got[k]);
        }
        let variance = samples.iter().map(|v| v * v).sum::<f64>() / n as f64;
        let wanted: f64 = (1..n / 2).map(|k| spectrum.density(k as f64 * df) * df).sum();
        assert!((variance / wanted - 1.0).abs() < 1e-3, "{variance} {wanted}");
        (got[4000].ln() - got[2000].ln()) / 2.0_f64.ln()
    };
    let slope = check(series(&power, n, step, 3), &power);
    assert!((slope + 5.0 / 3.0).abs() < 1e-6, "{slope}");
    let slope = check(series(&kaimal, n, step, 3), &kaimal);
    assert!((slope + 5.0 / 3.0).abs() < 0.02, "{slope}");
    // All of its variance: of a wind of 1.3 m/s deviation, but for what is slower or faster than the draw.
    let variance: f64 = (0..200_000).map(|k| kaimal.density((f64::from(k) + 0.5) * 1e-3) * 1e-3).sum();
    assert!((variance.sqrt() - 1.3).abs() < 0.02, "{variance}");
}

#[test]
fn a_series_repeats_and_is_read_between_its_samples() {
    let wind =
        Series { step: 0.5, samples: [0.0, 2.0, 4.0, 8.0].map(|x| Vector3::new(x, 0.0, 0.0)).to_vec() };
    for (time, wanted) in
        [(0.0, 0.0), (0.25, 1.0), (1.5, 8.0), (1.75, 4.0), (2.0, 0.0), (-0.25, 4.0), (2.75, 3.0)]
    {
        assert!((wind.at(time).x - wanted).abs() < 1e-12, "{time}");
    }
    assert_eq!(Series { step: 1.0, samples: Vec::new() }.at(3.0), Vector3::zeros());
}

#[test]
fn winds_add_up_and_a_mask_travels() {
    let wave = Sine { amplitude: Vector3::x(), hz: 0.5, waves: Vector3::new(0.1, 0.0, 0.0), phase: 0.0 };
    // A crest moves at f / k.
    let crest = |t: f64| Vector3::new(5.0 * t - 2.5, 0.0, 0.0);
    assert!((wave.sample(&crest(0.0), 0.0).x - 1.0).abs() < 1e-12);
    assert!((wave.sample(&crest(3.3), 3.3).x - 1.0).abs() < 1e-12);
    let squall = Mask {
        wind: Constant(Vector3::new(0.0, 9.0, 0.0)),
        centre: [0.0, 0.0],
        velocity: [2.0, 0.0],
        radius: 5.0,
    };
    assert!((squall.sample(&Vector3::new(8.0, 0.0, 1.0), 4.0).y - 9.0).abs() < 1e-12);
    assert!((squall.sample(&Vector3::new(8.0, 5.0, 1.0), 4.0).y - 9.0 / std::f64::consts::E).abs() < 1e-12);
    let sum = Sum(vec![Box::new(Constant(Vector3::z())), Box::new(wave)]);
    assert!((sum.sample(&crest(0.0), 0.0) - Vector3::new(1.0, 0.0, 1.0)).norm() < 1e-12);
}

/// Those that say so are after that time what they were, and no others say so.
#[test]
fn winds_that_repeat_say_after_how_long() {
    let noise = Noise { speed: 3.0, cell: 5.0, second: 0.5, seed: 1, n_cells: Some(12) };
    let wave = Sine { amplitude: Vector3::x(), hz: 0.3, waves: Vector3::y(), phase: 1.0 };
    let recorded = Series { step: 0.75, samples: PLACES.map(Vector3::from).to_vec() };
    let kaimal = Kaimal::along(1.0, 5.0, 30.0);
    let mean = Vector3::new(3.0, 4.0, 0.0);
    let draw = Draw {
        mean,
        decay: 10.0,
        first: -9.0,
        n_stations: 4,
        spacing: 6.0,
        n_samples: 20,
        step: 0.1,
        seed: 1,
    };
    let vortex = Primitive { shape: Shape::Vortex, centre: [0.5, -0.5], strength: 30.0, core: 0.1 };
    let mask = |pace| Mask { wind: Constant(mean), centre: [0.0; 2], velocity: [pace, 0.0], radius: 9.0 };
    type Case = (Box<dyn Wind>, &'static [f64], &'static [f64]);
    let cases: Vec<Case> = vec![
        (Box::new(Constant(mean)), &[0.1, 7.0], &[]),
        (Box::new(vortex), &[0.1, 7.0], &[]),
        (Box::new(wave), &[10.0, 20.0, 10.0 / 3.0], &[1.0, 5.0]),
        (Box::new(recorded.clone()), &[3.0, 9.0], &[1.5, 4.0]),
        (Box::new(Series { step: 1.0, samples: Vec::new() }), &[], &[1.0]),
        (Box::new(Field::new(&draw, [&kaimal; 3])), &[2.0, 8.0], &[1.0, 3.0]),
        (Box::new(noise), &[6.0, 12.0], &[3.0, 9.0]),
        (Box::new(Noise { n_cells: None, ..noise }), &[], &[6.0]),
        (Box::new(mask(0.0)), &[1.0], &[]),
        (Box::new(mask(2.0)), &[], &[1.0]),
        (Box::new(Frozen { mean, turbulence: noise, time: 0.0 }), &[], &[6.0]),
        (Box::new(Sum(vec![Box::new(recorded), Box::new(wave)])), &[30.0], &[3.0, 10.0]),
    ];
    for (which, (wind, repeats, others)) in cases.iter().enumerate() {
        for seconds in *repeats {
            assert!(wind.repeats(*seconds), "{which} {seconds}");
            for (k, place) in (0..).zip(PLACES.map(Vector3::from)) {
                let time = f64::from(k) * 1.37 - 2.0;
                let off = (wind.sample(&place, time + seconds) - wind.sample(&place, time)).norm();
                assert!(off < 1e-9, "{which} {seconds}: {off}");
            }
        }
        others.iter().for_each(|seconds| assert!(!wind.repeats(*seconds), "{which} {seconds}"));
    }
}

/// Coherence of stations is exp(-c f d / U), the spectrum of each is what was asked for, and it is carried by the mean.
#[test]
fn places_across_the_wind_are_alike_as_far_as_davenport_says() {
    let mean = Vector3::new(3.0, 4.0, 0.0);
    let (n, step) = (64, 0.5);
    let (kaimal, power) = (Kaimal::along(1.0, 5.0, 30.0), Power { at_1_hz: 0.3, beta: 5.0 / 3.0 });
    are_alike(mean, n, step, &kaimal);
    are_alike(mean, n, step, &power);
    let draw =
        Draw { mean, decay: 10.0, first: -9.0, n_stations: 4, spacing: 6.0, n_samples: n, step, seed: 1 };
    let field = Field::new(&draw, [&kaimal, &kaimal, &power]);
    let across = Vector3::new(-0.8, 0.6, 0.0);
    for (station, series) in field.stations().iter().enumerate() {
        // Anywhere nearer to it than to another it is its own wind and no mean of two, and so beyond the last.
        for off in [-2.9, 0.0, 2.9, if station == 3 { 100.0 } else { 1.0 }] {
            let place = across * (-9.0 + 6.0 * station as f64 + off);
            assert!((field.sample(&place, 7.0 * step) - series.samples[7]).norm() < 1e-9, "{station} {off}");
        }
    }
    for place in PLACES.map(Vector3::from) {
        for d in [0.1, 2.0, -5.0] {
            assert!((field.sample(&(place + mean * d), 3.0 + d) - field.sample(&place, 3.0)).norm() < 1e-9);
        }
    }
}

fn are_alike(mean: Vector3<f64>, n: usize, step: f64, spectrum: &dyn Spectrum) {
    let df = 1.0 / (n as f64 * step);
    let bins = [2, 5, 9];
    // Cross and own spectra of stations 0, 1 and 3 at a few frequencies, over many draws.
    let (mut cross, mut own) = ([[0.0; 3]; 3], [0.0; 3]);
    let n_draws = 3000;
    for seed in 0..n_draws {
        let draw =
            Draw { mean, decay: 10.0, first: -9.0, n_stations: 4, spacing: 6.0, n_samples: n, step, seed };
        let field = Field::new(&draw, [spectrum; 3]);
        let along = mean.normalize();
        let waves: Vec<_> = [0, 1, 3]
            .map(|station| {
                let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
                let samples = &field.stations()[station].samples;
                let mut input: Vec<f64> = samples.iter().map(|v| (v - mean).dot(&along)).collect();
                let mut output = forward.make_output_vec();
                forward.process(&mut input, &mut output).unwrap();
                output
            })
            .to_vec();
        for (b, bin) in bins.into_iter().enumerate() {
            own[b] += waves[2][bin].norm_sqr();
            for (k, wave) in waves.iter().enumerate() {
                cross[b][k] += (wave[bin] * waves[0][bin].conj()).re;
            }
        }
    }
    for (b, bin) in bins.into_iter().enumerate() {
        let hz = bin as f64 * df;
        let density = 2.0 * own[b] / f64::from(n_draws as u32) / (n as f64).powi(2) / df;
        assert!((density / spectrum.density(hz) - 1.0).abs() < 0.06, "{hz} Hz: {density}");
        for (k, apart) in [(1, 6.0), (2, 18.0)] {
            let wanted = (-10.0 * hz * apart / 5.0_f64).exp();
            let got = cross[b][k] / cross[b][0];
            assert!((got - wanted).abs() < 0.05, "{hz} Hz, {apart} m: {got} {wanted}");
        }
    }
}

/// Over rough ground the wind's shear is u*/(0.4 (z - d)), the same at all heights when multiplied by z - d; by a power the
/// wind doubles from height to height where it doubled once.
#[test]
fn wind_grows_with_height_as_its_profile_says() {
    let steady = Constant(Vector3::new(6.0, 2.0, 0.0));
    let at = |profile: &Profile<Constant>, z: f64| profile.sample(&Vector3::new(3.0, 4.0, z), 1.0);
    let log = Profile { wind: steady, at: 10.0, growth: Growth::Log { roughness: 0.5, displacement: 2.0 } };
    let shear = |z: f64| (at(&log, z + 1e-4).x - at(&log, z - 1e-4).x) / 2e-4 * (z - 2.0);
    for z in [3.0, 7.5, 10.0, 60.0] {
        assert!((shear(z) / shear(20.0) - 1.0).abs() < 1e-6, "{z}");
    }
    // A tenfold height above d is ln 10 / ln 16 more.
    let more = (at(&log, 82.0) - at(&log, 10.0)).norm() / steady.0.norm();
    assert!((more - 10.0_f64.log(16.0)).abs() < 1e-12, "{more}");
    let power = Profile { wind: steady, at: 10.0, growth: Growth::Power { exponent: 0.25 } };
    for z in [0.3, 4.0, 25.0] {
        assert!((at(&power, 16.0 * z) - 2.0 * at(&power, z)).norm() < 1e-12, "{z}");
    }
    for profile in [&log, &power] {
        assert!((at(profile, 10.0) - steady.0).norm() < 1e-12);
        assert_eq!((at(profile, 0.0), at(profile, -1.0)), (Vector3::zeros(), Vector3::zeros()));
        assert!(profile.repeats(7.0));
    }
    assert_eq!(at(&log, 2.5), Vector3::zeros());
    let even = Profile { growth: Growth::Power { exponent: 0.0 }, ..power };
    assert_eq!(at(&even, 3.0), steady.0);
}
