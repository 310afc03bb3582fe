//! Turbulence that is alike at places near one another: less so across the wind the farther apart they are and the faster
//! it changes (Davenport, Q. J. R. Meteorol. Soc. 87, 1961; drawn as by Veers, Sandia report 88-0152, 1988).

use super::spectrum::Spectrum;
use super::{Series, Wind};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// A turbulent wind over land, carried by its mean: at each place it is that of the nearest station across it. Between two
/// stations there is no mean of both, which would swing less than either.
#[derive(Clone, Debug)]
pub struct Field {
    mean: Vector3<f64>,
    /// Of the first station, metres across the mean, to the left.
    first: f64,
    /// Metres between stations.
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
    /// Where the first station is, metres across the wind, to the left.
    pub first: f64,
    /// Stations across the wind, from there on, one at least.
    pub n_stations: usize,
    /// Metres between them, more than 0.
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
        Self { mean: draw.mean, first: draw.first, spacing: draw.spacing, stations }
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
        // exp(-a |i - j|) is a chain: of the stations before, each depends on the last alone. Neighbours that are alike to
        // the last digit leave nothing of their own.
        let near = (-draw.decay * hz * draw.spacing / draw.mean.norm()).exp();
        let own = (1.0 - near.powi(2)).max(0.0).sqrt();
        let amplitude = (2.0 * spectrum.density(hz) * df).sqrt() / 2.0;
        let is_last = n.is_multiple_of(2) && k + 1 == waves[0].len();
        let mut before = None;
        for wave in &mut waves {
            let phase = Complex::from_polar(1.0, chance.random_range(0.0..TAU));
            let unit = before.map_or(phase, |before: Complex<f64>| before * near + phase * own);
            before = Some(unit);
            // The highest of an even number has no phase.
            wave[k] = if is_last { Complex::new(unit.re, 0.0) } else { unit } * amplitude;
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

impl Wind for Field {
    fn sample(&self, place: &Vector3<f64>, time: f64) -> Vector3<f64> {
        let (speed, last) = (self.mean.norm(), self.stations.len() - 1);
        let along = self.mean / speed;
        let across = Vector3::z().cross(&along);
        let station = (place.dot(&across) - self.first) / self.spacing;
        // What is here now was at the origin by so much earlier.
        let time = time - place.dot(&along) / speed;
        self.stations[station.round().clamp(0.0, last as f64) as usize].at(time)
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.stations.iter().all(|station| station.repeats(seconds))
    }
}
