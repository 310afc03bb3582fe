//! A plant, its wind and its camera: the frames, and the truth about them.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::cover::Cover;
use crate::moving::{Given, Moving};
use crate::plant::{Plant, frames_of};
use crate::pose::Pose;
use crate::render::{Camera, Picture};
use crate::settings::{Settings, SynthError};
use crate::truth::{At, BranchTruth, LeafTruth, Truth};
use crate::wind::Wind;

/// Steps that one task measures.
const STRETCH: u32 = 16;

/// A clip that is rendered frame by frame, in any order and from any thread, with the same bits.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) settings: Settings,
    pub(crate) plant: Plant,
    motion: Motion,
    pub(crate) camera: Camera,
    truth: Truth,
    mean_step_px: f64,
}

/// What moves the plant.
#[derive(Clone, Debug)]
enum Motion {
    /// Sways of every branch.
    Sways {
        wind: Wind,
        /// Amplitude of all.
        scale: f64,
    },
    /// Whoever gave it.
    Given(Given),
}

impl Motion {
    fn pose(&self, plant: &Plant, settings: &Settings, frame: u32) -> Pose {
        match self {
            Self::Sways { wind, scale } => Pose::at(plant, wind, *scale, time_secs(settings, frame)),
            Self::Given(given) => given.pose(plant, frame),
        }
    }
}

impl Scene {
    /// Grows the plant, sets the wind to the level, and finds where every leaf is in every frame.
    ///
    /// # Errors
    /// A setting out of its range; [`SynthError::Level`] where the plant cannot move that far.
    pub fn new(settings: &Settings) -> Result<Self, SynthError> {
        settings.check()?;
        let mut rng = Pcg64Mcg::seed_from_u64(settings.seed);
        let plant = Plant::grow(settings, &mut rng);
        let wind = Wind::new(&mut rng, f64::from(settings.width));
        let camera = Camera::new(settings, &mut rng);
        let (scale, mean_step_px) = fit_scale(settings, &plant, &wind)?;
        let motion = Motion::Sways { wind, scale };
        let truth = observe(settings, &plant, &motion);
        Ok(Self { settings: settings.clone(), plant, motion, camera, truth, mean_step_px })
    }

    /// Films a plant that moves by itself; the level of the settings is not looked at.
    ///
    /// # Errors
    /// A setting out of its range, [`SynthError::Moving`] for what is no plant.
    pub fn of(settings: &Settings, moving: &Moving) -> Result<Self, SynthError> {
        settings.check()?;
        let mut rng = Pcg64Mcg::seed_from_u64(settings.seed);
        let (given, sticks) = moving.given(settings)?;
        let plant = Plant::of(settings, &sticks, &mut rng);
        let camera = Camera::new(settings, &mut rng);
        let motion = Motion::Given(given);
        let truth = observe(settings, &plant, &motion);
        let mean_step_px = mean_step_px(settings, &plant, |frame| motion.pose(&plant, settings, frame));
        Ok(Self { settings: settings.clone(), plant, motion, camera, truth, mean_step_px })
    }

    /// The settings it was grown from.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Frames in the clip.
    #[must_use]
    pub fn n_frames(&self) -> u32 {
        self.settings.n_frames
    }

    /// One frame.
    ///
    /// # Panics
    /// When there is no such frame.
    #[must_use]
    #[track_caller]
    pub fn render(&self, frame: u32) -> Picture {
        assert!(frame < self.n_frames(), "frame {frame} of {}", self.n_frames());
        self.camera.picture(&self.plant, &self.pose(frame), frame, time_secs(&self.settings, frame))
    }

    /// Where every leaf is in every frame.
    #[must_use]
    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// Mean displacement of a leaf centre from one frame to the next, pixels, over all leaves and frames.
    #[must_use]
    pub fn mean_step_px(&self) -> f64 {
        self.mean_step_px
    }

    pub(crate) fn pose(&self, frame: u32) -> Pose {
        self.motion.pose(&self.plant, &self.settings, frame)
    }
}

fn time_secs(settings: &Settings, frame: u32) -> f64 {
    f64::from(frame) / settings.fps
}

/// The scale of the sways that meets the level, and the step that it gives.
///
/// Displacement is all but proportional to the scale, so a few proportional corrections meet the level;
/// where a leaf or two over a few frames make it a crooked function, halving what brackets it does.
fn fit_scale(settings: &Settings, plant: &Plant, wind: &Wind) -> Result<(f64, f64), SynthError> {
    let wanted_px = settings.level.step_px(settings.height, settings.fps);
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut scale = 0.02;
    let mut reached_px = 0.0;
    for attempt in 0..40 {
        reached_px =
            mean_step_px(settings, plant, |frame| Pose::at(plant, wind, scale, time_secs(settings, frame)));
        if (reached_px / wanted_px - 1.0).abs() < 1e-3 {
            return Ok((scale, reached_px));
        }
        if reached_px < wanted_px {
            low = scale;
        } else {
            high = scale;
        }
        let proportional = scale * wanted_px / reached_px;
        let usable = attempt < 6 && low < proportional && proportional < high;
        scale = if usable || high.is_infinite() { proportional } else { 0.5 * (low + high) };
    }
    Err(SynthError::Level { wanted_px, reached_px })
}

fn mean_step_px(settings: &Settings, plant: &Plant, pose: impl Fn(u32) -> Pose + Sync) -> f64 {
    let step_px = |from: &Pose, to: &Pose| -> f64 {
        from.leaves.iter().zip(&to.leaves).map(|(a, b)| (b.frame.origin - a.frame.origin).norm()).sum()
    };
    // Sums of fixed stretches, added in order: the same bits for any number of threads.
    let n_steps = settings.n_frames - 1;
    let stretches: Vec<f64> = (0..n_steps.div_ceil(STRETCH))
        .into_par_iter()
        .map(|stretch| {
            let first = stretch * STRETCH;
            let mut here = pose(first);
            let mut total_px = 0.0;
            for frame in first..n_steps.min(first + STRETCH) {
                let next = pose(frame + 1);
                total_px += step_px(&here, &next);
                here = next;
            }
            total_px
        })
        .collect();
    stretches.iter().sum::<f64>() / (f64::from(n_steps) * plant.leaves.len() as f64)
}

fn observe(settings: &Settings, plant: &Plant, motion: &Motion) -> Truth {
    let seen: Vec<Vec<At>> = (0..settings.n_frames)
        .into_par_iter()
        .map(|frame| {
            let pose = motion.pose(plant, settings, frame);
            Cover::new(settings, plant, &pose).observe()
        })
        .collect();
    let leaves = (0_u32..)
        .zip(&plant.leaves)
        .map(|(id, leaf)| LeafTruth {
            id,
            branch: leaf.branch as u32,
            path: seen.iter().map(|frame| frame[id as usize]).collect(),
        })
        .collect();
    let at_rest = frames_of(&plant.branches, |_| 0.0);
    let branches = (0_u32..)
        .zip(plant.branches.iter().zip(&at_rest))
        .map(|(id, (branch, frame))| {
            let tip = frame.out(branch.along(1.0));
            BranchTruth {
                id,
                parent: branch.parent.map(|p| p as u32),
                order: branch.order,
                mode_hz: branch.modes.iter().map(|mode| mode.hz).collect(),
                base: [frame.origin.x, frame.origin.y],
                tip: [tip.x, tip.y],
            }
        })
        .collect();
    Truth { leaves, branches }
}
