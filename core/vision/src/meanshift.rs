//! Mean shift on histograms of colour: where the region went whose colours are known.
//!
//! D. Comaniciu, V. Ramesh, P. Meer, "Real-time tracking of non-rigid objects using mean shift", CVPR 2000, and
//! "Kernel-based object tracking", PAMI 25, 2003; J. Diener's thesis, 2.4.2, whose letters are used here: `p` is the
//! histogram of the region that is sought, `q` that of the region looked at.
//!
//! Both are weighted by Epanechnikov's kernel `1 - d²/h²` of the distance d from the centre, and sum to 1. Their
//! likeness is Bhattacharyya's coefficient `ρ = Σ √(p_i q_i)`. A pixel of bin i weighs `w = √(p_i / q_i)`, and the
//! region moves to the mean of its pixels, `Σ w x / Σ w`; where ρ would not rise, by half of that, and so on.

mod colours;
#[cfg(test)]
mod tests;

pub use colours::{Bins, Colours};

use crate::Point;
use crate::work::{shared, threads};

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Steps, at most.
    pub max_iterations: u32,
    /// A shorter step ends the search, pixels.
    pub epsilon_px: f32,
    /// Whether regions a tenth smaller and a tenth larger are tried too; a tenth of the difference is then kept, as in
    /// the paper (PAMI 2003, 4.4).
    pub adapts: bool,
}

impl Params {
    /// How long a region of this radius takes on one thread, roughly, nanoseconds: it is looked at a few times.
    #[must_use]
    pub fn cost_ns(&self, radius_px: f64) -> f64 {
        const PIXEL_NS: f64 = 20.0;
        let n_sizes = if self.adapts { 3.0 } else { 1.0 };
        PIXEL_NS * n_sizes * (2.0 * radius_px + 1.0).powi(2)
    }
}

/// A disc in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its centre.
    pub at: Point,
    /// Its radius `h`, where the kernel ends, pixels.
    pub radius_px: f32,
}

/// The share of each bin of colours in a region: bins that occur, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    shares: Vec<(u16, f32)>,
}

impl Histogram {
    /// Its bins with their shares, in the order of their numbers; the shares sum to 1.
    #[must_use]
    pub fn shares(&self) -> &[(u16, f32)] {
        &self.shares
    }

    /// Bhattacharyya's coefficient, 0 for histograms that share no bin, 1 for equal ones.
    #[must_use]
    pub fn similarity(&self, other: &Self) -> f64 {
        let mut others = other.shares.iter().peekable();
        let mut sum = 0.0;
        for &(bin, p) in &self.shares {
            while others.next_if(|(other, _)| *other < bin).is_some() {}
            if let Some((_, q)) = others.next_if(|(other, _)| *other == bin) {
                sum += (f64::from(p) * f64::from(*q)).sqrt();
            }
        }
        sum
    }
}

/// Where a region went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Place and size; always finite.
    pub region: Region,
    /// Bhattacharyya's coefficient there, 0..=1.
    pub similarity: f64,
}

/// One region to look for.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// Its colours.
    pub model: &'a Histogram,
    /// Where to start.
    pub from: Region,
}

/// Looks for many regions on up to `max_threads` threads; the same bits for any number of them.
///
/// `None` where a region begins outside the picture.
#[must_use]
pub fn follow(
    colours: &Colours,
    targets: &[Target<'_>],
    params: &Params,
    max_threads: usize,
) -> Vec<Option<Found>> {
    let largest = targets.iter().map(|target| target.from.radius_px).fold(0.0, f32::max);
    let n_threads = threads(targets.len(), params.cost_ns(f64::from(largest)), max_threads);
    let mut found = vec![None; targets.len()];
    shared([&mut found], 1, n_threads, |first, [found]| {
        let mut search = Search::new(colours, params);
        for (found, target) in found.iter_mut().zip(&targets[first..]) {
            *found = search.follow(target);
        }
    });
    found
}

/// Looks for regions in one picture, one after the other.
#[derive(Debug)]
pub struct Search<'a> {
    colours: &'a Colours,
    params: &'a Params,
    /// `p` by bin.
    sought: Vec<f64>,
    /// What the region looked at last has of each bin.
    seen: Vec<Pixels>,
    /// The bins that it has.
    occurring: Vec<u16>,
}

/// The pixels of a region whose colour lies in one bin.
#[derive(Clone, Copy, Debug, Default)]
struct Pixels {
    /// Sum under the kernel: the bin's `q`, not yet divided by that of all bins.
    kernel: f64,
    n: f64,
    /// Sums of what they lie right of and below the centre, pixels.
    x: f64,
    y: f64,
}

impl<'a> Search<'a> {
    /// A search in this picture.
    #[must_use]
    pub fn new(colours: &'a Colours, params: &'a Params) -> Self {
        let n = colours.bins().len();
        let (sought, seen) = (vec![0.0; n], vec![Pixels::default(); n]);
        Self { colours, params, sought, seen, occurring: Vec::new() }
    }

    /// The colours of a region; `None` where it shares no pixel with the picture.
    #[must_use]
    pub fn histogram(&mut self, region: Region) -> Option<Histogram> {
        let total = self.look(region)?;
        self.occurring.sort_unstable();
        let share = |&bin: &u16| (bin, (self.seen[usize::from(bin)].kernel / total) as f32);
        Some(Histogram { shares: self.occurring.iter().map(share).collect() })
    }

    /// Climbs from where the target starts to where its colours are most alike.
    fn follow(&mut self, target: &Target<'_>) -> Option<Found> {
        for &(bin, share) in &target.model.shares {
            self.sought[usize::from(bin)] = f64::from(share);
        }
        let found = self.climb_in_sizes(target.from);
        for &(bin, _) in &target.model.shares {
            self.sought[usize::from(bin)] = 0.0;
        }
        found
    }

    /// Climbs, with regions of other sizes too if that is wanted.
    fn climb_in_sizes(&mut self, from: Region) -> Option<Found> {
        let best = self.climb(from)?;
        if !self.params.adapts {
            return Some(best);
        }
        let mut best = best;
        for factor in [0.9, 1.1] {
            let radius_px = from.radius_px * factor;
            best = match self.climb(Region { radius_px, ..from }) {
                Some(other) if other.similarity > best.similarity => other,
                _ => best,
            };
        }
        best.region.radius_px = 0.9 * from.radius_px + 0.1 * best.region.radius_px;
        Some(best)
    }

    /// Steps of the mean shift, each to where ρ is higher.
    fn climb(&mut self, mut region: Region) -> Option<Found> {
        let mut similarity = self.similarity(region)?;
        for _ in 0..self.params.max_iterations {
            let Some([mut dx, mut dy]) = self.shift() else { break };
            let (at, before) = (region.at, similarity);
            while similarity <= before && dx.hypot(dy) >= f64::from(self.params.epsilon_px) {
                let to = Region { at: [at[0] + dx as f32, at[1] + dy as f32], ..region };
                if let Some(there) = self.similarity(to).filter(|there| *there > before) {
                    (region, similarity) = (to, there);
                }
                (dx, dy) = (dx / 2.0, dy / 2.0);
            }
            if similarity <= before {
                break;
            }
        }
        Some(Found { region, similarity })
    }

    /// The bins of the region looked at last, each with its `p`.
    fn bins(&self) -> impl Iterator<Item = (f64, &Pixels)> {
        self.occurring.iter().map(|&bin| (self.sought[usize::from(bin)], &self.seen[usize::from(bin)]))
    }

    /// ρ of a region with what is sought.
    fn similarity(&mut self, region: Region) -> Option<f64> {
        let total = self.look(region)?;
        let sum: f64 = self.bins().map(|(p, seen)| (p * seen.kernel).sqrt()).sum();
        // Rounding may carry it a hair over 1.
        Some((sum / total.sqrt()).min(1.0))
    }

    /// The mean of the pixels looked at last under their weights, relative to their region's centre; `None` where all
    /// weigh nothing. All pixels of a bin weigh the same, so the bins' sums will do.
    fn shift(&self) -> Option<[f64; 2]> {
        let [mut sum, mut sum_x, mut sum_y] = [0.0; 3];
        for (p, seen) in self.bins() {
            let weight = (p / seen.kernel).sqrt();
            sum += weight * seen.n;
            sum_x += weight * seen.x;
            sum_y += weight * seen.y;
        }
        (sum > 0.0).then(|| [sum_x / sum, sum_y / sum])
    }

    /// Weighs the colours of a region; the sum of the weights, `None` where it has no pixel.
    fn look(&mut self, region: Region) -> Option<f64> {
        for bin in self.occurring.drain(..) {
            self.seen[usize::from(bin)] = Pixels::default();
        }
        if !region.at.iter().all(|c| c.is_finite()) {
            return None;
        }
        let mut total = 0.0;
        for Run { bins, dx, dy, inverse } in runs(self.colours, region) {
            let start = 1.0 - dy * dy * inverse;
            for (&bin, k) in bins.iter().zip(0_u32..) {
                let dx = dx + f64::from(k);
                let kernel = start - dx * dx * inverse;
                let seen = &mut self.seen[usize::from(bin)];
                if seen.n < 0.5 {
                    self.occurring.push(bin);
                }
                seen.kernel += kernel;
                seen.n += 1.0;
                seen.x += dx;
                seen.y += dy;
                total += kernel;
            }
        }
        (total > 0.0).then_some(total)
    }
}

/// Pixels of a region that lie in one row of the picture.
struct Run<'a> {
    bins: &'a [u16],
    /// From the centre to the first of them.
    dx: f64,
    dy: f64,
    /// Of the radius squared.
    inverse: f64,
}

/// The rows of a region, as far as the picture goes.
fn runs(colours: &Colours, region: Region) -> impl Iterator<Item = Run<'_>> {
    /// Pixels so near the rim are left out: with next to no share in `q` they would weigh more than all others.
    const INSIDE_PX: f64 = 0.05;
    let [x, y] = region.at.map(f64::from);
    let radius = f64::from(region.radius_px);
    let (width, height) = colours.size();
    // Whole numbers from `low` to `high` among 0..n.
    let within = |low: f64, high: f64, n: u32| {
        let (low, high) = (low.ceil().max(0.0), high.floor().min(f64::from(n) - 1.0));
        (low <= high).then_some(low as u32..=high as u32)
    };
    let rows = within(y - radius, y + radius, height);
    rows.into_iter().flatten().filter_map(move |row| {
        let dy = f64::from(row) - y;
        let chord = (radius * radius - dy * dy).max(0.0).sqrt() - INSIDE_PX;
        let xs = within(x - chord, x + chord, width)?;
        let dx = f64::from(*xs.start()) - x;
        Some(Run { bins: colours.row(row, xs), dx, dy, inverse: 1.0 / (radius * radius) })
    })
}
