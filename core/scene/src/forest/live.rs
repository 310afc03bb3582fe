//! A forest that goes on in its wind, step by step, as far as an eye sees it: on processors.

use std::sync::Arc;

use honami_mechanics::wind::Wind;
use honami_mechanics::{
    Damping, Detail, DetailError, Forest, ForestError, Pace, Pose, Stand, Threads, ThreadsError, Vector, View,
};

use super::ForestScene;
use crate::camera::Camera;
use crate::grove::Grove;
use crate::weather::{Typed, WeatherError, read};

/// The height of a picture, pixels, that levels of detail are made for: of one half as high they begin half as far away.
const HEIGHT_PX: f64 = 720.0;
/// Nothing is seen beyond so many metres, nor a plant beyond so many of its heights.
const FARTHEST: f64 = 5000.0;

/// Air that flows by itself is worked out for so many seconds of its own; from then on it blows as it did at their end.
const SECONDS: f64 = 120.0;

/// Why a forest does not go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// A wind that is none.
    #[error(transparent)]
    Weather(#[from] WeatherError),
    /// A forest that cannot be, or its wind.
    #[error(transparent)]
    Forest(#[from] ForestError),
    /// Levels that do not follow one another.
    #[error(transparent)]
    Levels(#[from] DetailError),
    /// Threads that the system does not give.
    #[error(transparent)]
    Threads(#[from] ThreadsError),
}

/// A wind by the time since it began: before that it blows as it would have, so that what travels comes from where it begins.
pub struct Begun {
    wind: Box<dyn Wind>,
    since: f64,
}

impl Begun {
    /// One that begins at a time, seconds.
    #[must_use]
    pub fn new(wind: Box<dyn Wind>, since: f64) -> Self {
        Self { wind, since }
    }

    /// The same wind with other values: its time goes on.
    pub fn turn(&mut self, wind: Box<dyn Wind>) {
        self.wind = wind;
    }

    /// It begins at another time, seconds.
    pub fn restart(&mut self, since: f64) {
        self.since = since;
    }
}

impl Wind for Begun {
    fn sample(&self, place: &Vector, time: f64) -> Vector {
        self.wind.sample(place, time - self.since)
    }

    fn repeats(&self, seconds: f64) -> bool {
        self.wind.repeats(seconds)
    }
}

/// A forest that goes on.
pub struct Live {
    scene: Arc<ForestScene>,
    grove: Grove,
    forest: Forest,
    wind: Begun,
    threads: Threads,
    most_bytes: usize,
    details: Vec<Detail>,
    motion: Vec<[f32; 3]>,
}

/// What is seen of one copy now.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Which.
    pub copy: usize,
    /// Row of its level.
    pub level: usize,
    /// How far its nodes are moved, in the axes and the size of the plant: rows of the order, those of the level.
    pub motion: &'a [[f32; 3]],
}

impl Live {
    /// A forest that has felt its wind for as long as the scene says, until this began; it takes so many threads, and air that flows so many
    /// bytes.
    ///
    /// # Errors
    /// [`LiveError`].
    pub fn new(scene: Arc<ForestScene>, n_threads: usize, most_bytes: usize) -> Result<Self, LiveError> {
        let threads = Threads::new(n_threads)?;
        let forest = Forest::new(&scene.stirring, &scene.body.order, &scene.stands, &scene.pace)?;
        let wind = Begun::new(wind(&scene, &scene.wind, most_bytes)?, scene.run_in);
        let (grove, details) = (scene.grove(), vec![Detail::default(); scene.places.len()]);
        let steps = (scene.run_in / scene.pace.step).round() as u32;
        let motion = Vec::new();
        let mut made = Self { scene, grove, forest, wind, threads, most_bytes, details, motion };
        for _ in 0..steps {
            made.step()?;
        }
        Ok(made)
    }

    /// The scene as it was given.
    #[must_use]
    pub fn scene(&self) -> &ForestScene {
        &self.scene
    }

    /// Where copies stand.
    #[must_use]
    pub fn grove(&self) -> &Grove {
        &self.grove
    }

    /// Seconds since what is shown began; below 0 before.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.forest.time() - self.scene.run_in
    }

    /// From now on this wind blows, as it is typed: it begins now.
    ///
    /// # Errors
    /// [`LiveError::Weather`]; the one before then goes on.
    pub fn blow(&mut self, words: &str) -> Result<(), LiveError> {
        self.begin(wind(&self.scene, words, self.most_bytes)?);
        Ok(())
    }

    /// From now on this wind blows: it begins now.
    pub fn begin(&mut self, wind: Box<dyn Wind>) {
        self.wind = Begun::new(wind, self.forest.time());
    }

    /// From now on the same wind blows with other values: its time goes on.
    pub fn turn(&mut self, wind: Box<dyn Wind>) {
        self.wind.turn(wind);
    }

    /// From now on it is damped so, and so heavy.
    ///
    /// # Errors
    /// [`LiveError::Forest`]; it then goes on as before.
    pub fn damp(&mut self, damping: Damping) -> Result<(), LiveError> {
        let pace = Pace { damping, ..*self.forest.pace() };
        Ok(self.forest.retune(&pace)?)
    }

    /// The wind at the crown of a copy now, metres per second.
    #[must_use]
    pub fn blowing(&self, copy: usize) -> Vector {
        self.grove.blowing(&self.wind, copy, self.forest.time())
    }

    /// At rest again, before its run-in; the wind that blows now begins where that ends.
    pub fn restart(&mut self) {
        self.forest.reset();
        self.wind.restart(self.scene.run_in);
    }

    /// A step on.
    ///
    /// # Errors
    /// [`LiveError::Forest`] of a wind that is no number.
    pub fn step(&mut self) -> Result<(), LiveError> {
        let (grove, wind, time) = (&self.grove, &self.wind, self.forest.time());
        let blowing = |copy: usize| grove.blowing(wind, copy, time);
        Ok(self.forest.step(&blowing, None, &self.threads)?)
    }

    /// What a camera sees in a picture of so many pixels, the copies in their order.
    ///
    /// # Errors
    /// [`LiveError::Levels`].
    pub fn seen(&mut self, camera: &Camera, [width, height]: [u32; 2]) -> Result<Vec<Seen<'_>>, LiveError> {
        let view = view(camera, f64::from(width) / f64::from(height.max(1)));
        let body = &self.scene.body;
        let (farther, levels) = (body.details(sharper(height))?, &body.levels);
        let stands = self.grove.places.iter().zip(&self.scene.stands);
        let level = |(place, stand): (&Vector, &Stand)| {
            farther.level(&self.scene.stirring, &view, place, f64::from(stand.scale))
        };
        let seen_as: Vec<Option<usize>> = stands.map(level).collect();
        for (detail, level) in self.details.iter_mut().zip(&seen_as) {
            *detail = level.map_or_else(Detail::default, |level| levels[level].detail());
        }
        let n: usize = self.details.iter().map(|detail| detail.n_nodes as usize).sum();
        self.motion.resize(n, [0.0; 3]);
        let pose = Pose { details: Some(&self.details), motion: &mut self.motion };
        self.forest.pose(pose, &self.threads);
        let (mut seen, mut rest) = (Vec::new(), self.motion.as_slice());
        for (copy, level) in seen_as.into_iter().enumerate() {
            let Some(level) = level else { continue };
            let (motion, others) = rest.split_at(levels[level].n_nodes as usize);
            rest = others;
            seen.push(Seen { copy, level, motion });
        }
        Ok(seen)
    }
}

/// By so many times as far away as usual levels begin in a picture so many pixels high.
#[must_use]
pub fn sharper(height: u32) -> f64 {
    f64::from(height) / HEIGHT_PX
}

/// What a camera sees, as the mechanics has it.
#[must_use]
pub fn view(camera: &Camera, aspect: f64) -> View {
    let eye = Vector::from(camera.eye.map(f64::from));
    let towards = Vector::from(camera.target.map(f64::from)) - eye;
    View { eye, towards, angle: f64::from(camera.angle), aspect, far: FARTHEST }
}

/// A wind as it is typed, over what stands in a scene; air that flows takes so many bytes.
///
/// # Errors
/// [`WeatherError`].
pub fn wind(scene: &ForestScene, words: &str, most_bytes: usize) -> Result<Box<dyn Wind>, WeatherError> {
    over(scene, &read(words)?, most_bytes)
}

/// The same of words that have been read: what takes long.
///
/// # Errors
/// [`WeatherError`].
pub fn over(scene: &ForestScene, typed: &Typed, most_bytes: usize) -> Result<Box<dyn Wind>, WeatherError> {
    typed.over(&scene.ground(SECONDS, most_bytes))
}

#[cfg(test)]
mod tests;
