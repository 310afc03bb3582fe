//! The motion between two pictures as a few places know it.

use crate::Point;

/// Motion at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where it was in the first picture.
    pub at: Point,
    /// Displacement to the second, pixels.
    pub motion: [f32; 2],
    /// By how much that differs from its displacement before, pixels; `None`: there was none.
    pub change_px: Option<f32>,
}

/// Motion everywhere, from that at some places.
#[derive(Clone, Debug)]
pub struct Spots {
    scale_px: f64,
    reach_px: f32,
    /// Cells as large as the reach, so that only nine of them are looked at, `columns` in a row.
    cells: Vec<Vec<Spot>>,
    columns: usize,
    rows: usize,
    /// Top left of the first cell.
    origin: Point,
}

impl Spots {
    /// Of these places, in any order; see [`Params`](super::Params) for the scale and the reach.
    #[must_use]
    pub fn new(spots: Vec<Spot>, scale_px: f64, reach_px: f32) -> Self {
        let bound = |axis: usize, pick: fn(f32, f32) -> f32, none: f32| {
            spots.iter().map(|spot| spot.at[axis]).fold(none, pick)
        };
        let low = [0, 1].map(|axis| bound(axis, f32::min, f32::INFINITY));
        let high = [0, 1].map(|axis| bound(axis, f32::max, f32::NEG_INFINITY));
        let n =
            [0, 1].map(
                |axis| if spots.is_empty() { 0 } else { ((high[axis] - low[axis]) / reach_px) as usize + 1 },
            );
        let mut all = Self {
            scale_px,
            reach_px,
            cells: vec![Vec::new(); n[0] * n[1]],
            columns: n[0],
            rows: n[1],
            origin: low,
        };
        for spot in spots {
            let [column, row] = [0, 1].map(|axis| ((spot.at[axis] - low[axis]) / reach_px) as usize);
            all.cells[row * all.columns + column].push(spot);
        }
        all
    }

    /// How long [`at`](Self::at) takes, at most and roughly, nanoseconds.
    #[must_use]
    pub fn cost_ns(&self) -> f64 {
        const SPOT_NS: f64 = 20.0;
        let largest = self.cells.iter().map(Vec::len).max().unwrap_or(0);
        SPOT_NS * (9 * largest).max(1) as f64
    }

    /// Displacement of whatever is at this place in the first picture; `None` where no particle reaches.
    #[must_use]
    pub fn at(&self, place: Point) -> Option<[f32; 2]> {
        let mut near: Vec<(f64, f64, &Spot)> = Vec::new();
        for spot in self.around(place) {
            let squared =
                (0..2).map(|axis| (f64::from(place[axis]) - f64::from(spot.at[axis])).powi(2)).sum::<f64>();
            let rest = 1.0 - squared / f64::from(self.reach_px).powi(2);
            if rest > 0.0 {
                let change = spot.change_px.map_or(1.0, |change| (f64::from(change) / self.scale_px).powi(2));
                near.push((rest * rest, change, spot));
            }
        }
        // Only ratios of weights count: with the steadiest at 1 they cannot all vanish.
        let steadiest = near.iter().map(|(_, change, _)| *change).fold(f64::INFINITY, f64::min);
        let (mut sum, mut motion) = (0.0, [0.0; 2]);
        for (kernel, change, spot) in near {
            let weight = kernel * (steadiest - change).exp();
            sum += weight;
            (0..2).for_each(|axis| motion[axis] += weight * f64::from(spot.motion[axis]));
        }
        (sum > 0.0).then(|| motion.map(|m| (m / sum) as f32))
    }

    /// The places in the nine cells around.
    fn around(&self, place: Point) -> impl Iterator<Item = &Spot> {
        let range = |axis: usize, n: usize| {
            let cell = ((place[axis] - self.origin[axis]) / self.reach_px).floor();
            // Not so of a place that is no number.
            let is_near = cell >= -1.0 && cell <= n as f32;
            if is_near { (cell - 1.0).max(0.0) as usize..((cell + 2.0) as usize).min(n) } else { 0..0 }
        };
        let (columns, rows) = (range(0, self.columns), range(1, self.rows));
        rows.flat_map(move |row| &self.cells[row * self.columns..][columns.clone()]).flatten()
    }
}
