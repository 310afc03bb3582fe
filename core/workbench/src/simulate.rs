//! A simulated reviewer: what it takes to bring tracks within a tolerance of the truth, correction by correction.
//!
//! It is ideal but for its hand, which trembles: it always knows which frame to correct, places the feature where it
//! is, and does so with the corrections that a person has, in a real project. Nothing here is any better than what the
//! terminal offers.

use std::time::Instant;

use honami_model::document::Key;
use honami_model::track::{Span, TrackId};
use honami_motion::accuracy::TruePath;
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::error::WorkbenchError;
use crate::retrack::{self, Way};
use crate::script::{self, ScriptError};
use crate::session::Session;

/// What becomes of the samples beside one that is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Straight lines between key-frames.
    Linear,
    /// Hermite curves through key-frames.
    Hermite,
    /// The tracked path, displaced up to the next key-frames.
    Space,
    /// Tracked again, forward from the key-frame.
    Forward,
    /// Tracked again from the key-frames on both sides, and blended.
    Both,
}

impl Model {
    /// All of them, the cheapest to make first.
    pub const ALL: [Self; 5] = [Self::Linear, Self::Hermite, Self::Space, Self::Forward, Self::Both];

    /// Its name in tables; also the word of a script that does it, where there is one.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Hermite => "hermite",
            Self::Space => "space",
            Self::Forward => "forward",
            Self::Both => "both ways",
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
) -> Result<Taken, ScriptError> {
    let mut rng = Pcg64Mcg::seed_from_u64(habits.seed ^ (u64::from(track.0) << 32));
    let born = place(session, truth, truth.first_frame, || 0.0).map(|v| v.to_string());
    script::step(session, &["key", &track.to_string(), &truth.first_frame.to_string(), &born[0], &born[1]])?;
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
        // What is said to be lost where it can be seen is wrong wherever it is.
        let error_px = shown.get(frame).map_or(f64::INFINITY, |sample| {
            let error_px = (f64::from(sample.x) - x).hypot(f64::from(sample.y) - y);
            if sample.status.is_seen() { error_px } else { error_px.max(2.0 * habits.tolerance_px) }
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

/// Places a sample, and does with those beside it what the model says; `false` where the tracker has found nothing
/// and only the key-frame was set.
fn correct(
    session: &mut Session,
    track: TrackId,
    frame: u32,
    at: [f32; 2],
    model: Model,
) -> Result<bool, ScriptError> {
    let numbers = [track.to_string(), frame.to_string(), at[0].to_string(), at[1].to_string()];
    let mut by_word = |word: &str| {
        let [track, frame, x, y] = &numbers;
        script::step(session, &[word, track, frame, x, y]).map(drop)
    };
    let way = match model {
        Model::Linear | Model::Hermite | Model::Space => return by_word(model.name()).map(|()| true),
        Model::Forward => Way::Forward,
        Model::Both => Way::Both,
    };
    let key = Some((frame, Key::set(at[0], at[1])));
    let request = retrack::around(&session.project, track, way, frame, key)?;
    let tracked = retrack::prepare(session, &request).and_then(|job| job.run(&()));
    match tracked {
        Ok(tracked) => retrack::finish(session, tracked).map(|_| true).map_err(ScriptError::from),
        Err(WorkbenchError::LostAtOnce { .. } | WorkbenchError::NoAnchor { .. }) => {
            let [track, frame, x, y] = &numbers;
            script::step(session, &["key", track, frame, x, y]).map(|_| false)
        }
        Err(error) => Err(error.into()),
    }
}
