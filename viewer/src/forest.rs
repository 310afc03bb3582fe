//! A forest in the wind: copies of a plant, each with what its modes do (thesis 6.4, 6.5).
//!
//! The buffers are those of figure 6.6: T and P, what turns the segments and what wind does to modes; Q, amplitudes and
//! speeds of all copies; U, the displacements of the nodes that are drawn. The [`host`] fills Q and U on the processor's
//! cores, the [`card`] in shaders, by the same numbers: what is drawn is the same. Wind is felt at each copy's crown.
//!
//! That leaves flutter is for the eye alone: nothing else moves by it, and nobody measures it.

mod body;
mod card;
mod chains;
mod host;
mod paint;
mod stage;
#[cfg(test)]
mod tests;

use std::thread::available_parallelism;

use anyhow::ensure;
use honami_mechanics::wind::Wind;
use honami_mechanics::{Following, Forest, Threads, Vector, View};
use honami_scene::grove::Grove;
use honami_scene::{Camera, ForestScene, Orbit, weather};

use crate::gpu::Gpu;
use crate::offscreen::{Picture, Shot};
use crate::target::Target;
use card::Card;
use host::Host;
use paint::Paint;
use stage::Stage;

/// Seconds after the run-in for which air that flows by itself is worked out, and the memory that it may take.
const SECONDS: f64 = 600.0;
const MOST_BYTES: usize = 256 << 20;
/// Nothing is seen from farther than so many heights of the plant.
const FAR: f64 = 4000.0;

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
    scene: ForestScene,
    grove: Grove,
    wind: Box<dyn Wind>,
    mover: Mover,
    stage: Stage,
    paint: Option<Paint>,
    /// Steps since the run-in began.
    n_steps: u64,
}

enum Mover {
    Host(Box<Host>),
    Card(Box<Card>),
}

impl ForestPicture {
    /// At the beginning of its run-in.
    ///
    /// # Errors
    /// A wind that there is not, more than the system or the card gives, or modes that a card has no way to add up.
    pub fn new(gpu: &Gpu, scene: ForestScene, by: By) -> anyhow::Result<Self> {
        let typed = weather::read(&scene.wind)?;
        let wind = typed.over(&scene.ground(scene.run_in + SECONDS, MOST_BYTES))?;
        let forest = Forest::new(&scene.stirring, &scene.body.order, &scene.stands, &scene.pace)?;
        let stage = Stage::new(gpu, &scene)?;
        let mover = match by {
            By::Processor => {
                let threads = Threads::new(available_parallelism().map_or(1, usize::from))?;
                Mover::Host(Box::new(Host::new(&scene, forest, threads)?))
            }
            By::Card => Mover::Card(Box::new(Card::new(gpu, &scene, forest, &stage)?)),
        };
        let grove = scene.grove();
        gpu.check()?;
        Ok(Self { scene, grove, wind, mover, stage, paint: None, n_steps: 0 })
    }

    /// Steps until so many seconds after the run-in; what was before, from the beginning.
    fn go_on(&mut self, gpu: &Gpu, time: f64) -> anyhow::Result<()> {
        let step = self.scene.pace.step;
        let wanted = ((self.scene.run_in + time) / step).round().max(0.0) as u64;
        if wanted < self.n_steps {
            self.n_steps = 0;
            match &mut self.mover {
                Mover::Host(host) => host.reset(),
                Mover::Card(card) => card.reset(gpu),
            }
        }
        while self.n_steps < wanted {
            let now = self.n_steps as f64 * step;
            let (grove, wind) = (&self.grove, &self.wind);
            let blowing = |copy: usize| grove.blowing(wind, copy, now);
            match &mut self.mover {
                Mover::Host(host) => host.step(&blowing)?,
                Mover::Card(card) => card.step(gpu, &blowing, now)?,
            }
            self.n_steps += 1;
        }
        Ok(())
    }
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
        let view = view(&shot.camera, target.aspect(), FAR * self.scene.stirring.height());
        let now = self.n_steps as f64 * self.scene.pace.step;
        let speed = |copy: usize| self.grove.blowing(&self.wind, copy, now).norm() as f32;
        self.stage.feel(gpu, (0..self.scene.places.len()).map(speed));
        match &mut self.mover {
            Mover::Host(host) => host.put(gpu, &self.scene, &self.grove, &view, &self.stage)?,
            Mover::Card(card) => card.put(gpu, &view, &self.stage),
        }
        let samples = target.size().samples;
        if self.paint.as_ref().is_none_or(|paint| paint.samples() != samples) {
            self.paint = Some(Paint::new(gpu, &self.stage, samples));
        }
        if let Some(paint) = &self.paint {
            paint.draw(gpu, target, &self.scene, &self.stage, shot);
        }
        Ok(gpu.check()?)
    }
}

/// What a camera sees of copies.
fn view(camera: &Camera, aspect: f32, far: f64) -> View {
    let place = |at: [f32; 3]| Vector::from(at.map(f64::from));
    View {
        eye: place(camera.eye),
        towards: place(camera.target) - place(camera.eye),
        angle: camera.angle.into(),
        aspect: aspect.into(),
        far,
    }
}
