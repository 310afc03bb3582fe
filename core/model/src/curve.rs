//! The motion curve through key-frames: cubic Hermite segments (Diener 2009, 3.4.1; errata E9).

/// A position at a time: what a key-frame says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// Seconds.
    pub t_s: f64,
    /// Pixels, (x, y).
    pub at: [f64; 2],
}

/// The Hermite basis `[h00, h10, h01, h11]` at `tau` in 0..=1 of a segment that lasts `dt_s` (errata E9).
///
/// h00 and h01 weigh the positions, h10 and h11 the speeds: they carry the factor `dt_s`.
#[must_use]
pub fn basis(tau: f64, dt_s: f64) -> [f64; 4] {
    let rest = 1.0 - tau;
    [
        (1.0 + 2.0 * tau) * rest * rest,
        tau * rest * rest * dt_s,
        tau * tau * (3.0 - 2.0 * tau),
        tau * tau * (tau - 1.0) * dt_s,
    ]
}

/// One segment of a curve: two knots and the speeds there, pixels per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where it starts.
    pub from: Knot,
    /// Speed at the start.
    pub from_speed: [f64; 2],
    /// Where it ends, later than it starts.
    pub to: Knot,
    /// Speed at the end.
    pub to_speed: [f64; 2],
}

impl Segment {
    /// The position at a time between the knots, pixels.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [f64; 2] {
        let dt_s = self.to.t_s - self.from.t_s;
        let [h00, h10, h01, h11] = basis((t_s - self.from.t_s) / dt_s, dt_s);
        [0, 1].map(|axis| {
            h00 * self.from.at[axis]
                + h10 * self.from_speed[axis]
                + h01 * self.to.at[axis]
                + h11 * self.to_speed[axis]
        })
    }
}

/// The speed at a knot, pixels per second: the mean of the speeds to its neighbours, the nearer one in
/// time weighing more (alpha = (k1 - k) / (k1 - k0) on the earlier side; exact for quadratics).
///
/// With one neighbour it is the one-sided difference (errata E9), alone it is zero.
#[must_use]
pub fn speed(before: Option<Knot>, here: Knot, after: Option<Knot>) -> [f64; 2] {
    let slope = |a: Knot, b: Knot| [0, 1].map(|axis| (b.at[axis] - a.at[axis]) / (b.t_s - a.t_s));
    match (before, after) {
        (Some(before), Some(after)) => {
            let alpha = (after.t_s - here.t_s) / (after.t_s - before.t_s);
            let (earlier, later) = (slope(before, here), slope(here, after));
            [0, 1].map(|axis| alpha * earlier[axis] + (1.0 - alpha) * later[axis])
        }
        (Some(before), None) => slope(before, here),
        (None, Some(after)) => slope(here, after),
        (None, None) => [0.0, 0.0],
    }
}

/// The segments between consecutive knots, which must be in strictly increasing time.
#[must_use]
pub fn through(knots: &[Knot]) -> Vec<Segment> {
    let at = |k: Option<usize>| k.and_then(|k| knots.get(k)).copied();
    let speeds: Vec<_> =
        (0..knots.len()).map(|k| speed(at(k.checked_sub(1)), knots[k], at(Some(k + 1)))).collect();
    knots
        .windows(2)
        .zip(speeds.windows(2))
        .map(|(knot, speed)| Segment { from: knot[0], from_speed: speed[0], to: knot[1], to_speed: speed[1] })
        .collect()
}

#[cfg(test)]
mod tests;
