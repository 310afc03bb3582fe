//! Simulators: plugins that move plants in the wind. Metres, z up, right-handed; radians; seconds.

use crate::{Cx, Error, Info, Params, Result};

/// Moves copies of a plant in the wind.
///
/// Parameters with `affects: "step"` may change in mid-motion ([`retune`](Self::retune)); where others change, the host
/// prepares it anew.
pub trait Simulator: Sized + Send + 'static {
    /// Its parameters, made by [`params!`](crate::params!) (or `()`).
    type Params: Params;
    /// Id, name and description.
    const INFO: Info;
    /// Where it can save what it carries: another number when the bytes mean something else.
    const STATE_VERSION: Option<u32> = None;

    /// Takes the plant, every copy at rest at time 0.
    ///
    /// # Errors
    /// Whatever keeps it from working on it.
    fn prepare(params: &Self::Params, plant: &Plant<'_>, cx: &Cx<'_>) -> Result<Self>;

    /// The vibration modes that it has found, lowest first, if it works with such.
    fn modes(&self) -> Vec<Mode> {
        Vec::new()
    }

    /// Goes on under other values of the parameters that affect `"step"`.
    ///
    /// # Errors
    /// When it cannot go by them; it then goes on as before.
    fn retune(&mut self, _params: &Self::Params) -> Result<()> {
        Ok(())
    }

    /// Back to rest at time 0.
    fn reset(&mut self);

    /// Goes so many steps, then writes how far every wanted node is from rest, metres in the axes and the size of the plant,
    /// whatever its copy's yaw and scale. The same bits in one call as in many.
    ///
    /// # Errors
    /// Whatever keeps it from that, as a `dt` that the method cannot take.
    fn step(&mut self, steps: &Steps<'_>, out: &mut [[f32; 3]], cx: &Cx<'_>) -> Result<()>;

    /// What later steps depend on; the same bytes for the same state.
    ///
    /// # Errors
    /// Where it cannot save ([`STATE_VERSION`](Self::STATE_VERSION)).
    fn save(&self) -> Result<Vec<u8>> {
        Err(Error::unsupported("it cannot save what it carries"))
    }

    /// Goes on from what was saved of the same plant. It must bear any other bytes, too, and then go on as before.
    ///
    /// # Errors
    /// When the bytes are not what it has saved.
    fn load(&mut self, _bytes: &[u8]) -> Result<()> {
        Err(Error::unsupported("it cannot save what it carries"))
    }
}

/// A node of a skeleton at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Row of its parent, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Metres.
    pub position: [f32; 3],
    /// Metres.
    pub radius: f32,
    /// Row of the track it was grown from.
    pub track: Option<u32>,
}

/// A copy of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Turned about z, from x towards y, radians.
    pub yaw: f32,
    /// Of all its lengths, above 0.
    pub scale: f32,
    /// Times the plant's mass, above 0.
    pub mass: f32,
}

impl Default for Instance {
    fn default() -> Self {
        Self { yaw: 0.0, scale: 1.0, mass: 1.0 }
    }
}

/// What a simulator moves.
#[derive(Clone, Copy, Debug)]
pub struct Plant<'a> {
    /// At rest, parents before their children.
    pub nodes: &'a [Node],
    /// Its copies, at least one.
    pub instances: &'a [Instance],
    /// Threads that may work at a time, at least 1.
    pub max_threads: u32,
    /// Seed of every random choice.
    pub seed: u64,
}

/// A vibration mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Frequency, above 0.
    pub hz: f64,
    /// |K x - w² M x| over |K x|.
    pub residual: f64,
    /// Whether it was proved that there is no other below.
    pub certified: bool,
}

/// How far a simulator is to go, in which wind.
#[derive(Clone, Copy, Debug)]
pub struct Steps<'a> {
    /// Seconds a step, above 0.
    pub dt: f64,
    /// How many; 0: only where everything is now.
    pub n: u32,
    /// The wind on the way.
    pub wind: Wind<'a>,
    /// How much of every copy is wanted, one a copy; `None`: everything.
    pub detail: Option<&'a [Detail]>,
}

/// How much of a copy is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// Its first so many nodes,
    pub nodes: u32,
    /// moved by its first so many modes.
    pub modes: u32,
}

/// Wind over time at every copy: straight between its times, before the first and after the last as there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wind<'a> {
    /// Seconds since the last reset, rising; none: still air.
    pub times_s: &'a [f64],
    /// Metres per second in the world: one a time for all copies alike, or `(time, copy)` row-major.
    pub velocities: &'a [[f32; 3]],
}

impl Wind<'_> {
    /// Whether every copy has a wind of its own.
    #[must_use]
    pub fn is_per_copy(&self) -> bool {
        self.velocities.len() != self.times_s.len()
    }

    /// At a time, at a copy, metres per second.
    #[must_use]
    pub fn at(&self, time_s: f64, copy: usize) -> [f32; 3] {
        self.blowing(time_s).at(copy)
    }

    /// At a time, at all copies.
    #[must_use]
    pub fn blowing(&self, time_s: f64) -> Blowing<'_> {
        let n = self.velocities.len().checked_div(self.times_s.len()).unwrap_or(0);
        let row = |k: usize| self.velocities.get(k * n..(k + 1) * n).unwrap_or_default();
        let after = self.times_s.partition_point(|&t| t <= time_s);
        let before = after.saturating_sub(1);
        let ends = self.times_s.get(before).zip(self.times_s.get(after));
        let share = ends.map_or(0.0, |(&a, &b)| ((time_s - a) / (b - a)).max(0.0));
        Blowing { before: row(before), after: row(after.min(self.times_s.len().saturating_sub(1))), share }
    }
}

/// Wind at a time.
#[derive(Clone, Copy, Debug)]
pub struct Blowing<'a> {
    before: &'a [[f32; 3]],
    after: &'a [[f32; 3]],
    share: f64,
}

impl Blowing<'_> {
    /// At a copy, metres per second.
    #[must_use]
    pub fn at(&self, copy: usize) -> [f32; 3] {
        let of = |row: &[[f32; 3]]| match row {
            [all] => *all,
            each => each.get(copy).copied().unwrap_or_default(),
        };
        let (from, to) = (of(self.before), of(self.after));
        std::array::from_fn(|axis| {
            let [from, to] = [from, to].map(|wind| f64::from(wind[axis]));
            (from + self.share * (to - from)) as f32
        })
    }
}

#[cfg(test)]
mod tests;
