//! A simulated reviewer: what it takes to bring tracks within a tolerance of the truth, correction by correction.
//!
//! It is ideal but for its hand, which trembles: it always knows which frame to correct, places the feature where it
//! is, and does so with the corrections that a person has, in a real project. Nothing here is any better than what the
//! terminal offers.

use std::sync::Arc;
use std::time::Instant;

use honami_model::correct::{Refused, key_only, linear};
use honami_model::document::Key;
use honami_model::track::{Span, Status, TrackId};
use honami_motion::accuracy::TruePath;
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::error::WorkbenchError;
use crate::offer::{self, AtOnce, Granted, Wish};
use crate::retrack;
use crate::session::Session;

/// What becomes of the samples beside one that is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Straight lines between key-frames.
    Linear,
    /// What the terminal offers under this name.
    Offered(offer::Model),
    /// What the terminal offers first.
    First,
}

impl Model {
    /// All of them, the cheapest to make first.
    pub const ALL: [Self; 7] = [
        Self::Linear,
        Self::Offered(offer::Model::Hermite),
        Self::Offered(offer::Model::Space),
        Self::Offered(offer::Model::Forward),
        Self::Offered(offer::Model::Both),
        Self::Offered(offer::Model::Fused),
        Self::First,
    ];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Offered(model) => model.word(),
            Self::First => "first",
        }
    }
}

/// Which frame is corrected next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// The one that is farthest from the truth.
    Worst,
    /// The first that is beyond the tolerance.
    First,
}

/// How a reviewer works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Habits {
    /// What becomes of the samples beside.
    pub model: Model,
    /// Which frame comes next.
    pub pick: Pick,
    /// A visible sample this near to the truth is right, pixels.
    pub tolerance_px: f64,
    /// Standard deviation of where the hand places the feature, pixels, each axis.
    pub noise_px: f64,
    /// After so many key-frames the reviewer gives up.
    pub max_keys: u32,
    /// Seed of the hand's tremor; the n-th placement on a track trembles alike for every model.
    pub seed: u64,
}

/// What a track has taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken {
    /// Key-frames placed, the given one not counted.
    pub n_keys: u32,
    /// Whether every visible sample is right now.
    pub is_right: bool,
    /// Time of all corrections, seconds.
    pub seconds: f64,
    /// How many of them the tracker could add nothing to, so that only the key-frame was set.
    pub n_bare: u32,
}

/// Corrects a track until it is right, or the reviewer gives up.
///
/// The first key-frame is given: it says which feature it is. A track that no run has seen begins with nothing else.
///
/// # Errors
/// What the project, the clip or the tracker met.
pub fn review(
    session: &mut Session,
    track: TrackId,
    truth: &TruePath,
    habits: &Habits,
) -> Result<Taken, WorkbenchError> {
    let mut rng = Pcg64Mcg::seed_from_u64(habits.seed ^ (u64::from(track.0) << 32));
    let born = place(session, truth, truth.first_frame, || 0.0);
    at_once(session, track, truth.first_frame, born, key_only)?;
    let mut taken = Taken { n_keys: 0, is_right: false, seconds: 0.0, n_bare: 0 };
    loop {
        let shown = session.project.shown(track)?;
        let empty = Span::default();
        let wrong = next(shown.as_deref().unwrap_or(&empty), truth, habits);
        let Some(frame) = wrong else {
            taken.is_right = true;
            return Ok(taken);
        };
        if taken.n_keys == habits.max_keys {
            return Ok(taken);
        }
        let at = place(session, truth, frame, || {
            let tremor: f64 = StandardNormal.sample(&mut rng);
            habits.noise_px * tremor
        });
        let begun = Instant::now();
        taken.n_bare += u32::from(!correct(session, track, frame, at, habits.model)?);
        taken.seconds += begun.elapsed().as_secs_f64();
        taken.n_keys += 1;
    }
}

/// The frame to correct next; `None` when all that can be seen is right.
fn next(shown: &Span, truth: &TruePath, habits: &Habits) -> Option<u32> {
    let wrong = (truth.first_frame..).zip(&truth.positions).filter(|(_, position)| position.2);
    let mut wrong = wrong.filter_map(|(frame, &(x, y, _))| {
        // What is said to be lost where it can be seen is wrong wherever it is; what is said to be hidden is shown where
        // the tracker puts it, and right when it is there.
        let error_px = shown.get(frame).map_or(f64::INFINITY, |sample| {
            let error_px = (f64::from(sample.x) - x).hypot(f64::from(sample.y) - y);
            let is_told = sample.status.is_seen() || sample.status == Status::Occluded;
            if is_told { error_px } else { error_px.max(2.0 * habits.tolerance_px) }
        });
        (error_px > habits.tolerance_px).then_some((frame, error_px))
    });
    match habits.pick {
        Pick::First => wrong.next(),
        Pick::Worst => wrong.max_by(|a, b| a.1.total_cmp(&b.1)),
    }
    .map(|(frame, _)| frame)
}

/// Where the hand puts the feature: the truth with a tremor, in the clip.
fn place(session: &Session, truth: &TruePath, frame: u32, mut tremor: impl FnMut() -> f64) -> [f32; 2] {
    let clip = session.media.clip();
    let (x, y, _) = truth.positions[(frame - truth.first_frame) as usize];
    let inside = |v: f64, size: u32| v.clamp(0.0, f64::from(size) - 1.0) as f32;
    [inside(x + tremor(), clip.width), inside(y + tremor(), clip.height)]
}

/// Places a sample, and does with those beside it what the model says; `false` where it could find nothing and only the
/// key-frame was set.
fn correct(
    session: &mut Session,
    track: TrackId,
    frame: u32,
    to: [f32; 2],
    model: Model,
) -> Result<bool, WorkbenchError> {
    let model = match model {
        Model::Linear => return at_once(session, track, frame, to, linear),
        Model::Offered(model) => model,
        Model::First => {
            let study = retrack::study(session, track)?;
            let first = offer::errors(&study, frame, &())?.first();
            first.unwrap_or(offer::Model::Space)
        }
    };
    if let Some(correct) = model.at_once() {
        return at_once(session, track, frame, to, correct);
    }
    let keys = vec![(frame, Key::set(to[0], to[1]))];
    let study = Arc::new(retrack::study(session, track)?);
    match offer::grant(&study, &Wish { track, frame, model, keys }, &()) {
        Ok(Granted::Retracked(retracked)) => retrack::finish(session, *retracked).map(|_| true),
        Ok(Granted::Ready(correction)) => {
            session.project.commit(correction.transaction)?;
            Ok(true)
        }
        Err(
            WorkbenchError::LostAtOnce { .. }
            | WorkbenchError::NoAnchor { .. }
            | WorkbenchError::Followed { .. },
        ) => at_once(session, track, frame, to, key_only).map(|_| false),
        Err(error) => Err(error),
    }
}

fn at_once(
    session: &mut Session,
    track: TrackId,
    frame: u32,
    to: [f32; 2],
    correct: AtOnce,
) -> Result<bool, WorkbenchError> {
    let study = retrack::study(session, track)?;
    let shown = study.ground.shown(study.times());
    // Where the track is not shown there is nothing to carry along.
    let (correction, is_whole) = match correct(&shown, frame, to) {
        Err(Refused::NoSample { .. }) => (key_only(&shown, frame, to)?, false),
        corrected => (corrected?, true),
    };
    session.project.commit(correction.transaction)?;
    Ok(is_whole)
}
