//! A forest in the wind: copies of a plant, each with what its modes do (thesis 6.4, 6.5).
//!
//! The buffers are those of figure 6.6: T and P, what turns the segments and what wind does to modes; Q, amplitudes and
//! speeds of all copies; U, the displacements of the nodes that are drawn. The `host` fills Q and U on the processor's cores,
//! the `card` in shaders, by the same numbers: what is drawn is the same. Wind is felt at each copy's crown.
//!
//! That leaves flutter is for the eye alone: nothing else moves by it, and nobody measures it.

mod body;
mod card;
mod chains;
mod host;
mod paint;
mod shade;
mod skin;
mod stage;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Instant;

use anyhow::ensure;
use honami_mechanics::wind::Wind;
use honami_mechanics::{Damping, Following, Vector};
use honami_scene::{ForestScene, Orbit};

use crate::gpu::Gpu;
use crate::offscreen::{Picture, Shot};
use crate::target::Target;
use card::Card;
use host::Host;
use paint::Paint;
use skin::Eye;
use stage::Stage;

/// By so much nearer levels begin where only a driver draws.
const LESS: u32 = 2;
/// Memory that air may take which flows by itself.
pub(crate) const MOST_BYTES: usize = 256 << 20;

/// Where modes and nodes are worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// On the processor's cores,
    Processor,
    /// or where it is drawn.
    Card,
}

impl By {
    /// What is sooner done: cards are faster than processors, and these than drivers that do without a card.
    #[must_use]
    pub fn best(gpu: &Gpu, scene: &ForestScene) -> Self {
        let are_turns = matches!(scene.stirring.following(), Following::Turns(_));
        if gpu.is_software() || !are_turns { Self::Processor } else { Self::Card }
    }
}

/// A forest that is drawn.
pub struct ForestPicture {
    scene: Arc<ForestScene>,
    mover: Mover,
    stage: Stage,
    paint: Option<Paint>,
    /// Steps since it was at rest.
    n_steps: u64,
}

enum Mover {
    Host(Box<Host>),
    Card(Box<Card>),
}

impl Mover {
    fn new(gpu: &Gpu, scene: &Arc<ForestScene>, by: By, stage: &Stage) -> anyhow::Result<Self> {
        Ok(match by {
            By::Processor => Self::Host(Box::new(Host::new(scene)?)),
            By::Card => Self::Card(Box::new(Card::new(gpu, scene, stage)?)),
        })
    }

    /// The wind at the crown of a copy now, metres per second.
    fn blowing(&mut self, copy: usize) -> Vector {
        match self {
            Self::Host(host) => host.live().blowing(copy),
            Self::Card(card) => card.blowing(copy),
        }
    }
}

impl ForestPicture {
    /// At the end of its run-in.
    ///
    /// # Errors
    /// A wind that there is not, more than the system or the card gives, or modes that a card has no way to add up.
    pub fn new(gpu: &Gpu, scene: ForestScene, by: By) -> anyhow::Result<Self> {
        let scene = Arc::new(scene);
        let stage = Stage::new(gpu, &scene, by)?;
        let mover = Mover::new(gpu, &scene, by, &stage)?;
        gpu.check()?;
        let mut made = Self { scene, mover, stage, paint: None, n_steps: 0 };
        made.n_steps = made.steps_until(0.0);
        Ok(made)
    }

    /// From now on this wind blows: it begins now.
    pub fn begin(&mut self, wind: Box<dyn Wind>) {
        match &mut self.mover {
            Mover::Host(host) => host.live().begin(wind),
            Mover::Card(card) => card.begin(wind),
        }
    }

    /// From now on the same wind blows with other values: its time goes on.
    pub fn turn(&mut self, wind: Box<dyn Wind>) {
        match &mut self.mover {
            Mover::Host(host) => host.live().turn(wind),
            Mover::Card(card) => card.turn(wind),
        }
    }

    /// From now on it is damped so, and so heavy.
    ///
    /// # Errors
    /// Damping that no plant has, or steps that its method does not bear; it then goes on as before.
    pub fn damp(&mut self, gpu: &Gpu, damping: Damping) -> anyhow::Result<()> {
        match &mut self.mover {
            Mover::Host(host) => Ok(host.live().damp(damping)?),
            Mover::Card(card) => Ok(card.damp(gpu, damping)?),
        }
    }

    /// The scene as it was given.
    #[must_use]
    pub fn scene(&self) -> &Arc<ForestScene> {
        &self.scene
    }

    /// Seconds since the end of its run-in; below 0 before.
    #[must_use]
    pub fn time(&self) -> f64 {
        (self.n_steps as f64 - self.run_in()) * self.scene.pace.step
    }

    /// Whether it is as near to a time, seconds after the run-in, as its steps come.
    #[must_use]
    pub fn is_at(&self, time: f64) -> bool {
        self.n_steps == self.steps_until(time)
    }

    /// Steps towards a time, seconds after the run-in, so many at most; back by way of rest and the run-in, in the wind and
    /// with the damping that hold now.
    ///
    /// # Errors
    /// A wind that is no number somewhere.
    pub fn go_towards(&mut self, gpu: &Gpu, time: f64, most: u64) -> anyhow::Result<()> {
        let wanted = self.steps_until(time);
        if wanted < self.n_steps {
            self.n_steps = 0;
            match &mut self.mover {
                Mover::Host(host) => host.live().restart(),
                Mover::Card(card) => card.restart(gpu, &self.scene),
            }
        }
        for _ in 0..most.min(wanted - self.n_steps) {
            match &mut self.mover {
                Mover::Host(host) => host.live().step()?,
                Mover::Card(card) => card.step(gpu)?,
            }
            self.n_steps += 1;
        }
        Ok(())
    }

    fn go_on(&mut self, gpu: &Gpu, time: f64) -> anyhow::Result<()> {
        self.go_towards(gpu, time, u64::MAX)
    }

    /// Steps of the run-in.
    fn run_in(&self) -> f64 {
        (self.scene.run_in / self.scene.pace.step).round()
    }

    fn steps_until(&self, time: f64) -> u64 {
        (self.run_in() + (time / self.scene.pace.step).round()) as u64
    }

    /// What the stage is told of what a camera sees in a picture: nodes and copies.
    fn put(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<()> {
        match &mut self.mover {
            Mover::Host(host) => {
                let pixel = paint::pixel(&shot.camera, target.size().height);
                let eye = Eye { eye: shot.camera.eye, pixel, time: shot.time as f32 };
                host.put(gpu, &self.scene, &shot.camera, of_levels(gpu, target), &eye)
            }
            Mover::Card(card) => Ok(card.put(gpu, &shot.camera, of_levels(gpu, target), &self.stage)?),
        }
    }

    fn paint(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) {
        let samples = target.size().samples;
        if self.paint.as_ref().is_none_or(|paint| paint.samples() != samples) {
            self.paint = Some(Paint::new(gpu, &self.stage, samples));
        }
        if let Some(paint) = &self.paint {
            let skinned = match &self.mover {
                Mover::Host(host) => host.seen(),
                Mover::Card(_) => None,
            };
            paint.draw(gpu, target, (&self.scene, &self.stage), skinned, shot);
        }
    }
}

/// What a frame takes, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// To find the wind at all copies once.
    pub wind: f64,
    /// Steps of all modes, with the winds of these.
    pub modes: f64,
    /// What is seen, and where its nodes are.
    pub pose: f64,
    /// The picture, and to read it.
    pub draw: f64,
}

impl ForestPicture {
    /// Draws and reads, and waits for each part by itself.
    ///
    /// # Errors
    /// As [`draw`](Picture::draw).
    pub fn timed(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<Times> {
        let mut last = Instant::now();
        let mut took = || std::mem::replace(&mut last, Instant::now()).elapsed().as_secs_f64();
        self.feel();
        let wind = took();
        self.go_on(gpu, shot.time)?;
        gpu.wait()?;
        let modes = took();
        self.put(gpu, target, shot)?;
        gpu.wait()?;
        let pose = took();
        self.paint(gpu, target, shot);
        target.read(gpu)?;
        Ok(Times { wind, modes, pose, draw: took() })
    }

    fn feel(&mut self) {
        let blowing = |copy| self.mover.blowing(copy);
        std::hint::black_box((0..self.scene.places.len()).map(blowing).sum::<Vector>());
    }
}

/// The size of a picture by which levels are chosen: without a card a plant has less of everything from nearer on.
fn of_levels(gpu: &Gpu, target: &Target) -> [u32; 2] {
    let less = if gpu.is_software() { LESS } else { 1 };
    [target.size().width, target.size().height].map(|side| side.div_ceil(less))
}

impl Picture for ForestPicture {
    fn orbit(&self) -> Orbit {
        self.scene.orbit
    }

    fn filmed(&self) -> Option<(f64, u32)> {
        None
    }

    fn draw(&mut self, gpu: &Gpu, target: &Target, shot: &Shot) -> anyhow::Result<()> {
        ensure!(shot.time.is_finite(), "a time is a number of seconds");
        self.go_on(gpu, shot.time)?;
        self.put(gpu, target, shot)?;
        self.paint(gpu, target, shot);
        Ok(gpu.check()?)
    }
}
