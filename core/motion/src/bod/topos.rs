//! What a topos says at a glance: how much of all motion it is, along which line it goes, and how many tracks have most of it.

use super::Bod;

/// The line along which tracks go with a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// Its angle as seen in the picture, radians, 0 to π: 0 is horizontal, π / 2 vertical, between them it rises to the right.
    pub angle_rad: f64,
    /// How far all go along it: 1 where none goes any other way, 0 where no way is before others.
    pub straight: f64,
}

impl Bod {
    /// The share of a component in all that moves, noise among it, 0 to 1: the squares of singular values add up to it.
    #[must_use]
    pub fn portion(&self, component: usize) -> f64 {
        let all: f64 = self.singular.iter().map(|s| s * s).sum();
        self.singular[component].powi(2) / all
    }

    /// The line of a component: the main axis of how far tracks go in x and y, whichever way along it.
    #[must_use]
    pub fn axis(&self, component: usize) -> Axis {
        let [x, y] = self.topos(component);
        let [mut across, mut slanted] = [0.0, 0.0];
        for (x, y) in x.iter().zip(y) {
            across += x * x - y * y;
            // y is down in images.
            slanted -= 2.0 * x * y;
        }
        // A topos has the length 1. From -π to π, of the doubled angle.
        let angle = 0.5 * slanted.atan2(across);
        let angle_rad = if angle < 0.0 { angle + std::f64::consts::PI } else { angle };
        Axis { angle_rad, straight: across.hypot(slanted).min(1.0) }
    }

    /// The fewest tracks that have half of a component: those that go farthest with it.
    #[must_use]
    pub fn n_half(&self, component: usize) -> usize {
        let [x, y] = self.topos(component);
        let mut squares: Vec<f64> = x.iter().zip(y).map(|(x, y)| x * x + y * y).collect();
        squares.sort_by(|a, b| b.total_cmp(a));
        let half = 0.5 * squares.iter().sum::<f64>();
        let sums = squares.iter().scan(0.0, |sum, square| {
            *sum += square;
            Some(*sum)
        });
        // Of equal halves rounding must not ask for one more.
        sums.take_while(|sum| *sum < half * (1.0 - 1e-9)).count() + 1
    }
}
