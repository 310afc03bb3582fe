//! Turbulence that is alike at places near one another: less so across the wind the farther apart they are and the faster
//! it changes (Davenport, Q. J. R. Meteorol. Soc. 87, 1961; drawn as by Veers, Sandia report 88-0152, 1988).

use super::spectrum::Spectrum;
use super::{Series, Wind};
use nalgebra::{DMatrix, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// A turbulent wind over land, carried by its mean: between stations across it, it is read along a line.
#[derive(Clone, Debug)]
pub struct Field {
    mean: Vector3<f64>,
    /// Metres between stations, of which the middle is at the origin.
    spacing: f64,
    stations: Vec<Series>,
}

/// How a field is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Metres per second; level, and not still.
    pub mean: Vector3<f64>,
    /// c in the coherence exp(-c f d / U) of places d apart across the wind: 10 or so.
    pub decay: f64,
    /// Stations across the wind, one at least.
    pub n_stations: usize,
    /// Metres between them.
    pub spacing: f64,
    /// Samples in time; then it begins again.
    pub n_samples: usize,
    /// Seconds between them.
    pub step: f64,
    /// Of its phases.
    pub seed: u64,
}

impl Field {
    /// Draws turbulence with a spectrum for each direction: along the mean, across it to the left, and up.
    #[must_use]
    pub fn new(draw: &Draw, spectra: [&dyn Spectrum; 3]) -> Self {
        let along = draw.mean.normalize();
        let axes = [along, Vector3::z().cross(&along), Vector3::z()];
        let mut stations = vec![
            Series { step: draw.step, samples: vec![draw.mean; draw.n_samples] };
            draw.n_stations.max(1)
        ];
        let mut chance = Pcg64::seed_from_u64(draw.seed);
        for (axis, spectrum) in axes.iter().zip(spectra) {
            for (station, samples) in stations.iter_mut().zip(component(draw, spectrum, &mut chance)) {
                station.samples.iter_mut().zip(samples).for_each(|(sum, v)| *sum += axis * v);
            }
        }
        Self { mean: draw.mean, spacing: draw.spacing, stations }
    }

    /// What blows past each station.
    #[must_use]
    pub fn stations(&self) -> &[Series] {
        &self.stations
    }
}

/// Samples of one direction at all stations.
fn component(draw: &Draw, spectrum: &dyn Spectrum, chance: &mut Pcg64) -> Vec<Vec<f64>> {
    let (n, n_stations) = (draw.n_samples, draw.n_stations.max(1));
    if n == 0 {
        return vec![Vec::new(); n_stations];
    }
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(n);
    let mut waves = vec![inverse.make_input_vec(); n_stations];
    let df = 1.0 / (n as f64 * draw.step);
    for k in 1..waves[0].len() {
        let hz = k as f64 * df;
        let phases: Vec<Complex<f64>> =
            (0..n_stations).map(|_| Complex::from_polar(1.0, chance.random_range(0.0..TAU))).collect();
        let lower = root_of_coherence(draw, hz);
        let amplitude = (2.0 * spectrum.density(hz) * df).sqrt() / 2.0;
        let is_last = n.is_multiple_of(2) && k + 1 == waves[0].len();
        for (row, wave) in waves.iter_mut().enumerate() {
            let sum: Complex<f64> = (0..=row).map(|column| phases[column] * lower[(row, column)]).sum();
            // The highest of an even number has no phase.
            wave[k] = if is_last { Complex::new(sum.re, 0.0) } else { sum } * amplitude;
        }
    }
    let back = |mut waves: Vec<Complex<f64>>| {
        let mut samples = inverse.make_output_vec();
        match inverse.process(&mut waves, &mut samples) {
            Ok(()) => samples,
            // Lengths are those that the plan has made.
            Err(_) => Vec::new(),
        }
    };
    waves.into_iter().map(back).collect()
}

/// L of the coherence C = L L^T of all stations at a frequency. Neighbours that are alike to the last digit leave
/// nothing of their own.
fn root_of_coherence(draw: &Draw, hz: f64) -> DMatrix<f64> {
    let n = draw.n_stations.max(1);
    // exp(-a |i - j|) is a chain: each depends on the one before alone, L is known in closed form.
    let near = (-draw.decay * hz * draw.spacing / draw.mean.norm()).exp();
    let own = (1.0 - near.powi(2)).max(0.0).sqrt();
    DMatrix::from_fn(n, n, |row, column| match (row, column) {
        (row, column) if column > row => 0.0,
        (row, 0) => near.powi(row as i32),
        (row, column) => own * near.powi((row - column) as i32),
    })
}

impl Wind for Field {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let (speed, last) = (self.mean.norm(), self.stations.len() - 1);
        let along = self.mean / speed;
        let across = Vector3::z().cross(&along);
        let station = place.dot(&across) / self.spacing + last as f64 / 2.0;
        let station = station.clamp(0.0, last as f64);
        // What is here now was at the origin by so much earlier.
        let time = time - place.dot(&along) / speed;
        let (first, share) = (station.floor() as usize, station.fract());
        let at = |k: usize| self.stations[k.min(last)].at(time);
        at(first).lerp(&at(first + 1), share)
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.stations.iter().all(|station| station.repeats(seconds))
    }
}
