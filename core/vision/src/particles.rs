//! Motion from particles of limited life: corners that are followed for a while, then replaced.
//!
//! J. Diener's thesis, 2.5.3. Errors of a tracker are mostly uncorrelated in time: a particle whose motion is much the
//! same from one frame to the next is more likely right. With its last two displacements `s1`, `s2` it weighs
//! `w = exp(-‖s1 - s2‖² / σ²)`; the thesis prints no `σ`, which is 1 pixel a frame. One that has a single displacement
//! weighs as if the next differed by `σ`. The motion anywhere is the mean of the displacements around, each weighted by
//! `w (1 - d²/r²)²`, where `d < r` is its distance.
//!
//! No particle lives long enough to drift far, and after each frame corners are born (J. Shi, C. Tomasi, CVPR 1994) wherever
//! none is near, so that their density holds.

mod spots;
#[cfg(test)]
mod tests;

pub use spots::{Spot, Spots};

use serde::{Deserialize, Serialize};

use crate::klt::{self, State};
use crate::pyramid::Pyramid;
use crate::work::in_looks;
use crate::{Gray, Point, detect};

/// How particles live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// How one is followed.
    pub klt: klt::Params,
    /// Where they are born; `max_corners` is how many may live.
    pub corners: detect::Params,
    /// Frames in which one lives, at least 1.
    pub life_frames: u32,
    /// Difference of two displacements at which a particle weighs 1/e, pixels a frame, above 0.
    pub scale_px: f64,
    /// How far the motion of a particle reaches, pixels, above 0.
    pub reach_px: f32,
}

/// One that lives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Particle {
    /// How many were born before it.
    pub number: u64,
    /// Where it is in the picture seen last.
    pub at: Point,
    /// Frames that it has left.
    left: u32,
    /// Its last displacement.
    speed: Option<[f32; 2]>,
}

/// The particles of a clip.
#[derive(Clone, Debug)]
pub struct Swarm {
    params: Params,
    living: Vec<Particle>,
    n_born: u64,
}

impl Swarm {
    /// Those of a first picture. Their lives have all lengths, so that not all end at once.
    #[must_use]
    pub fn new(params: &Params, picture: &Gray<'_>) -> Self {
        let mut swarm = Self { params: *params, living: Vec::new(), n_born: 0 };
        swarm.bear(picture);
        let life = f64::from(params.life_frames.max(1));
        for particle in &mut swarm.living {
            // Multiples of the golden ratio fill 0..1 evenly, in whatever order the corners come.
            let share = (particle.number as f64 * 0.618_033_988_749_894_9).fract();
            particle.left = 1 + (share * life) as u32;
        }
        swarm
    }

    /// Those that lived when another swarm was saved, of which this was [`n_born`](Self::n_born).
    #[must_use]
    pub fn of(params: &Params, living: Vec<Particle>, n_born: u64) -> Self {
        Self { params: *params, living, n_born }
    }

    /// How many have been born so far.
    #[must_use]
    pub fn n_born(&self) -> u64 {
        self.n_born
    }

    /// Those that live now, by their numbers.
    #[must_use]
    pub fn living(&self) -> &[Particle] {
        &self.living
    }

    /// Follows all into the next picture, lets those go whose life is over or that were lost, and bears others.
    ///
    /// Returns the motion from one picture to the next, or nothing where `go_on`, told the share that is done, said no.
    ///
    /// # Panics
    /// As [`klt::track`].
    #[track_caller]
    pub fn step(
        &mut self,
        [prev, next]: [&Pyramid; 2],
        max_threads: usize,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Spots> {
        let from: Vec<Point> = self.living.iter().map(|particle| particle.at).collect();
        let flows = in_looks(&from, self.params.klt.cost_ns(), go_on, |part| {
            klt::track(prev, next, part, None, &self.params.klt, max_threads)
        })?;
        let mut spots = Vec::with_capacity(from.len());
        let mut flows = flows.into_iter();
        self.living.retain_mut(|particle| {
            let Some(flow) = flows.next().filter(|flow| flow.state == State::Tracked) else { return false };
            let motion = [0, 1].map(|axis| flow.to[axis] - particle.at[axis]);
            let change = particle.speed.map(|before| (motion[0] - before[0]).hypot(motion[1] - before[1]));
            spots.push(Spot { at: particle.at, motion, change_px: change });
            particle.at = flow.to;
            particle.speed = Some(motion);
            particle.left = particle.left.saturating_sub(1);
            particle.left > 0
        });
        self.bear(&next.picture());
        Some(Spots::new(spots, self.params.scale_px, self.params.reach_px))
    }

    /// Particles at corners away from those that live.
    fn bear(&mut self, picture: &Gray<'_>) {
        let occupied: Vec<Point> = self.living.iter().map(|particle| particle.at).collect();
        let room = self.params.corners.max_corners.saturating_sub(occupied.len());
        let corners = detect::Params { max_corners: room, ..self.params.corners };
        let left = self.params.life_frames.max(1);
        for corner in detect::corners(picture, None, &occupied, &corners) {
            self.living.push(Particle { number: self.n_born, at: corner.at, left, speed: None });
            self.n_born += 1;
        }
    }
}
