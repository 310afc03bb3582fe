//! Flowing air against closed forms.

use super::Layer;
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

const N: usize = 32;
const CELL: f64 = 2.0;

fn layer(viscosity: f64) -> Layer {
    Layer::new(N, CELL, viscosity)
}

/// Air that goes every way, the same each time.
fn stir(layer: &mut Layer) {
    layer.blow(|at, _| {
        let phase = at.x * 12.9898 + at.y * 78.233;
        Vector2::new((phase.sin() * 43_758.545).fract() * 8.0, (phase.cos() * 27_183.77).fract() * 8.0)
    });
}

fn most(layer: &Layer) -> f64 {
    layer.velocities().flatten().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// The largest divergence, by the matrix that differentiates waves of even number (Trefethen, Spectral Methods in
/// MATLAB, 3.10).
fn divergence(layer: &Layer) -> f64 {
    let air: Vec<[f64; 2]> = layer.velocities().collect();
    let slope = |d: usize| {
        let sign = if d.is_multiple_of(2) { 0.5 } else { -0.5 };
        if d == 0 { 0.0 } else { sign / (d as f64 * PI / N as f64).tan() * TAU / (N as f64 * CELL) }
    };
    let mut most: f64 = 0.0;
    for row in 0..N * N {
        let (x, y) = (row % N, row / N);
        let sum: f64 = (0..N)
            .map(|d| slope(d) * (air[y * N + (x + N - d) % N][0] + air[(y + N - d) % N * N + x][1]))
            .sum();
        most = most.max(sum.abs());
    }
    most
}

#[test]
fn settled_air_neither_springs_nor_sinks() {
    let mut air = layer(0.0);
    stir(&mut air);
    assert!(divergence(&air) > 1.0);
    air.settle(0.5);
    let speed = most(&air);
    assert!(speed > 1.0 && divergence(&air) < 1e-10 * speed, "{} of {speed}", divergence(&air));
    for _ in 0..20 {
        air.step(0.3);
        assert!(divergence(&air) < 1e-10 * speed);
    }
    // What is settled stays, and what only springs and sinks goes.
    let before: Vec<[f64; 2]> = air.velocities().collect();
    air.settle(0.5);
    let apart = air.velocities().zip(&before).map(|(a, b)| (a[0] - b[0]).abs() + (a[1] - b[1]).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-12 * speed);
    let k = TAU / (N as f64 * CELL);
    air.blow(|at, _| {
        Vector2::new(
            (k * at.x).cos() * (2.0 * k * at.y).sin(),
            2.0 * (k * at.x).sin() * (2.0 * k * at.y).cos(),
        )
    });
    air.settle(0.5);
    assert!(most(&air) < 1e-12, "{}", most(&air));
}

/// Taylor and Green's: sin kx cos ky, -cos kx sin ky, times exp(-2 nu k^2 t), whatever carries it. Here within 2 %, and
/// 4 % where it is carried as far as it is long.
#[test]
fn vortices_die_as_their_closed_form_says_and_go_with_the_wind() {
    let k = TAU / (N as f64 * CELL);
    let whirl = |at: Vector2<f64>| {
        Vector2::new((k * at.x).sin() * (k * at.y).cos(), -(k * at.x).cos() * (k * at.y).sin())
    };
    for (viscosity, wind, most) in
        [(0.0, Vector2::zeros(), 0.02), (1.5, Vector2::zeros(), 0.01), (1.5, Vector2::new(3.0, -1.3), 0.04)]
    {
        let (mut air, dt, n) = (layer(viscosity), 0.25, 80);
        air.blow(|at, _| whirl(at) + wind);
        for _ in 0..n {
            air.step(dt);
        }
        let t = dt * f64::from(n);
        let left = (-2.0 * viscosity * k * k * t).exp();
        assert!(viscosity == 0.0 || left < 0.6, "{left}");
        for (row, [x, y]) in air.velocities().enumerate() {
            let place = Vector2::new((row % N) as f64, (row / N) as f64) * CELL - wind * t;
            let off = Vector2::new(x, y) - wind - whirl(place) * left;
            assert!(off.norm() < most * left, "{viscosity} {wind}: {off} at {row}");
        }
    }
}

#[test]
fn a_uniform_wind_stays_uniform_and_falls_by_what_holds_it_back_alone() {
    for rate in [0.0, 0.3] {
        let mut air = layer(0.7);
        air.blow(|_, _| Vector2::new(6.0, -2.5));
        for row in 0..N * N {
            // Between places, too: what is shared adds up.
            let place = Vector2::new((row % N) as f64 + 0.3, (row / N) as f64 + 0.8) * CELL;
            air.hold(&place, rate * CELL * CELL);
        }
        for _ in 0..40 {
            air.step(0.25);
        }
        let left = (-rate * 10.0_f64).exp();
        for [x, y] in air.velocities() {
            assert!((x - 6.0 * left).abs() < 1e-12 && (y + 2.5 * left).abs() < 1e-12, "{rate}: {x} {y}");
        }
    }
}

/// Steps of any length, and any wind: nothing grows.
#[test]
fn air_never_gains_speed_by_itself() {
    for dt in [0.01, 1.0, 100.0] {
        let mut air = layer(0.0);
        stir(&mut air);
        // What only springs and sinks is gone at once, and counts for nothing.
        air.settle(dt);
        let energy = |air: &Layer| air.velocities().map(|[x, y]| x * x + y * y).sum::<f64>();
        let mut before = energy(&air);
        for step in 0..60 {
            air.step(dt);
            let now = energy(&air);
            // Air that has all but come to rest gains 4e-6 of what it has by rounding of its path.
            assert!(now <= 1.0001 * before, "{dt}, step {step}: {now} of {before}");
            before = now;
        }
    }
}

/// Beside a place that holds air back it goes faster, behind it slower.
#[test]
fn air_goes_round_what_holds_it_back() {
    let mut air = layer(0.5);
    air.blow(|_, _| Vector2::new(5.0, 0.0));
    air.hold(&(Vector2::new(10.0, 16.0) * CELL), 2.0 * CELL * CELL);
    for _ in 0..24 {
        air.step(0.25);
    }
    let at = |x: usize, y: usize| air.velocities().nth(y * N + x).unwrap();
    assert!(at(10, 16)[0] < 4.0 && at(12, 16)[0] < 4.5, "{:?} {:?}", at(10, 16), at(12, 16));
    assert!(at(11, 20)[0] > 5.05 && at(11, 12)[0] > 5.05, "{:?}", at(11, 20));
    // The same on both sides of the line along the wind.
    assert!((at(12, 19)[0] - at(12, 13)[0]).abs() < 1e-9 && (at(12, 19)[1] + at(12, 13)[1]).abs() < 1e-9);
}
