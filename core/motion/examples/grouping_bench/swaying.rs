//! Tips of a tree in turbulent wind, as a camera sees them.

use honami_mechanics::wind::{Kaimal, Spectrum};
use honami_mechanics::{Beams, Damping, Modes, Oscillator, State, Vector};
use honami_motion::Positions;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use std::error::Error;
use std::f64::consts::TAU;

pub(crate) const N_FRAMES: usize = 300;
const FPS: f64 = 25.0;
const N_MODES: usize = 150;
const DAMPING: f64 = 0.08;
/// Mean wind, metres per second, and its turbulence along, across and up as shares of it.
const SPEED: f64 = 4.0;
const INTENSITY: [f64; 3] = [0.4, 0.32, 0.2];
/// Of coherence exp(-c f d / U) of places d apart.
const DECAY: f64 = 10.0;
const N_PATCHES: usize = 120;
/// Samples of the wind, which then begins again: the first round is not filmed.
const N_WIND: usize = 512;
const HEIGHT_PX: f64 = 900.0;
const RMS_PX: f64 = 2.0;

/// Where tips are, pixels: at rest, and how far from there in every frame.
pub(crate) struct Filmed {
    rest: Vec<[f64; 2]>,
    moved: Vec<Vec<[f64; 2]>>,
}

/// The slowest modes of a tree.
pub(crate) fn modes(beams: &Beams) -> Result<Modes, Box<dyn Error>> {
    Ok(Modes::new(beams, N_MODES, 1)?)
}

/// Moves a tree by its modes in a wind of this seed, from a direction and before a camera that it chooses too.
pub(crate) fn film(beams: &Beams, modes: &Modes, tips: &[u32], seed: u64) -> Filmed {
    let mut rng = Pcg64::seed_from_u64(seed);
    let patches: Vec<usize> = (0..N_PATCHES).map(|_| rng.random_range(1..beams.len())).collect();
    let places: Vec<Vector> = patches.iter().map(|node| beams.position(*node)).collect();
    let wind = wind(&places, rng.random_range(0.0..TAU), &mut rng);
    let felt = felt(beams, modes, tips, &places);
    let mut swings: Vec<Vec<f64>> = Vec::new();
    for (mode, felt) in felt.iter().enumerate() {
        let omega = modes.omegas[mode];
        let gamma = 2.0 * DAMPING * omega;
        let step = Oscillator { gamma, ..Oscillator::new(omega, &Damping::default()) }.step(1.0 / FPS);
        let mut state = State::default();
        let mut swing = Vec::new();
        for frame in 0..N_WIND + N_FRAMES {
            if frame >= N_WIND {
                swing.push(state.q);
            }
            let pressure = wind.iter().zip(felt).map(|(wind, felt)| {
                let air = wind[frame % N_WIND];
                air.norm() * air.dot(felt)
            });
            state = step.next(state, pressure.sum());
        }
        swings.push(swing);
    }
    seen(beams, modes, tips, &swings, rng.random_range(0.0..TAU))
}

/// How much each mode feels of the wind at each patch: areas of wood, and of leaves at tips, times displacements.
fn felt(beams: &Beams, modes: &Modes, tips: &[u32], places: &[Vector]) -> Vec<Vec<Vector>> {
    let mut areas = vec![0.0; beams.len()];
    for (node, area) in areas.iter_mut().enumerate() {
        if let Some(parent) = beams.parent(node) {
            let length = (beams.position(node) - beams.position(parent as usize)).norm();
            *area = 2.0 * beams.radius(node) * length;
        }
    }
    tips.iter().for_each(|tip| areas[*tip as usize] += 0.01);
    let nearest = |node: usize| {
        let far = |patch: &usize| (places[*patch] - beams.position(node)).norm_squared();
        (0..places.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0)
    };
    let patch_of: Vec<usize> = (0..beams.len()).map(nearest).collect();
    let mut felt = vec![vec![Vector::zeros(); places.len()]; modes.len()];
    for (mode, felt) in felt.iter_mut().enumerate() {
        for (node, area) in areas.iter().enumerate() {
            felt[patch_of[node]] += *area * modes.displacement(mode, node);
        }
    }
    felt
}

/// Turbulence at places, alike as far as they are near and it is slow: a series of velocities each.
fn wind(places: &[Vector], towards: f64, rng: &mut Pcg64) -> Vec<Vec<Vector>> {
    let n = places.len();
    let along = Vector::new(towards.cos(), towards.sin(), 0.0);
    let axes = [along, Vector::new(-along.y, along.x, 0.0), Vector::new(0.0, 0.0, 1.0)];
    let mut wind = vec![vec![along * SPEED; N_WIND]; n];
    let turns: Vec<(f64, f64)> = (0..N_WIND).map(|k| (TAU * k as f64 / N_WIND as f64).sin_cos()).collect();
    let df = FPS / N_WIND as f64;
    for k in 1..N_WIND / 2 {
        let hz = k as f64 * df;
        let root = root(places, DECAY * hz / SPEED);
        for (axis, intensity) in axes.iter().zip(INTENSITY) {
            let size = (Kaimal::along(intensity * SPEED, SPEED, 60.0).density(hz) * df).sqrt();
            let chance: Vec<[f64; 2]> =
                (0..n).map(|_| [0; 2].map(|_| StandardNormal.sample(&mut *rng))).collect();
            for (row, series) in wind.iter_mut().enumerate() {
                let part =
                    |side: usize| -> f64 { (0..=row).map(|j| root[row * n + j] * chance[j][side]).sum() };
                let (c, s) = (size * part(0), size * part(1));
                for (t, air) in series.iter_mut().enumerate() {
                    let (sin, cos) = turns[k * t % N_WIND];
                    *air += *axis * (c * cos + s * sin);
                }
            }
        }
    }
    wind
}

/// L of the coherence C = L L^T of all places.
fn root(places: &[Vector], per_metre: f64) -> Vec<f64> {
    let n = places.len();
    let mut root = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let alike = (-per_metre * (places[i] - places[j]).norm()).exp();
            let known: f64 = (0..j).map(|k| root[i * n + k] * root[j * n + k]).sum();
            root[i * n + j] = if i == j {
                (alike - known).max(0.0).sqrt()
            } else if root[j * n + j] > 1e-9 {
                (alike - known) / root[j * n + j]
            } else {
                0.0
            };
        }
    }
    root
}

/// From the side, the picture as high as the tree; motion of 2 px (root of the mean square).
fn seen(beams: &Beams, modes: &Modes, tips: &[u32], swings: &[Vec<f64>], azimuth: f64) -> Filmed {
    let project = |at: Vector| [at.x * azimuth.cos() + at.y * azimuth.sin(), -at.z];
    let ground = beams.position(0).z;
    let height = (0..beams.len()).map(|node| beams.position(node).z - ground).fold(0.0, f64::max);
    let scale = HEIGHT_PX / height;
    let rest = tips.iter().map(|tip| project(beams.position(*tip as usize)).map(|v| scale * v)).collect();
    let mut moved = vec![vec![[0.0; 2]; N_FRAMES]; tips.len()];
    for (tip, path) in tips.iter().zip(&mut moved) {
        for (mode, swing) in swings.iter().enumerate() {
            let [x, y] = project(modes.displacement(mode, *tip as usize));
            for (at, q) in path.iter_mut().zip(swing) {
                *at = [at[0] + q * x, at[1] + q * y];
            }
        }
        let mean = [0, 1].map(|axis| path.iter().map(|at| at[axis]).sum::<f64>() / N_FRAMES as f64);
        path.iter_mut().for_each(|at| *at = [at[0] - mean[0], at[1] - mean[1]]);
    }
    let square: f64 = moved.iter().flatten().map(|at| at[0].powi(2) + at[1].powi(2)).sum();
    let factor = RMS_PX / (square / (tips.len() * N_FRAMES) as f64).sqrt();
    moved.iter_mut().flatten().for_each(|at| *at = at.map(|v| factor * v));
    Filmed { rest, moved }
}

impl Filmed {
    /// As a tracker would give them: with noise of its own at every position, and leaves that flutter at 1 to 4 Hz, pixels
    /// (root of the mean square, along an axis and of both).
    pub(crate) fn tracked(&self, noise_px: f64, flutter_px: f64, seed: u64) -> Positions {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut positions = Positions::new(self.rest.len(), N_FRAMES);
        let duration = N_FRAMES as f64 / FPS;
        let waves: Vec<usize> = (duration as usize..=(4.0 * duration) as usize).collect();
        for (track, (rest, path)) in self.rest.iter().zip(&self.moved).enumerate() {
            let amounts: Vec<[f64; 4]> =
                waves.iter().map(|_| [0; 4].map(|_| StandardNormal.sample(&mut rng))).collect();
            let size = flutter_px / (2.0 * waves.len() as f64).sqrt();
            for (frame, moved) in path.iter().enumerate() {
                let mut at = [rest[0] + moved[0], rest[1] + moved[1]];
                if flutter_px > 0.0 {
                    for (cycles, [a, b, c, d]) in waves.iter().zip(&amounts) {
                        let (sin, cos) = (TAU * (cycles * frame) as f64 / N_FRAMES as f64).sin_cos();
                        at = [at[0] + size * (a * sin + b * cos), at[1] + size * (c * sin + d * cos)];
                    }
                }
                let at = at.map(|v| v + noise_px * Distribution::<f64>::sample(&StandardNormal, &mut rng));
                positions.set(track, frame, at.map(|v| v as f32));
            }
        }
        positions
    }
}
