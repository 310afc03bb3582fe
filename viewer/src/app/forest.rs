//! The window of a forest: the wind, damping and mass are turned while it sways, and winds are put into it by clicks.

mod knobs;
mod making;
mod stopwatch;

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context as _, bail, ensure};
use eframe::egui::{self, Context, Key, Pos2, Rect, Ui};
use honami_scene::control::{Command, Event, PROTOCOL};
use honami_scene::{Camera, ForestScene, Orbit, Scene};

use self::knobs::{Knobs, Turned};
use self::making::{Asked, Making};
use self::stopwatch::Stopwatch;
use super::canvas::Canvas;
use super::pipe::Pipe;
use super::{Fault, PANEL, fail};
use crate::args::Args;
use crate::forest::{By, ForestPicture};
use crate::offscreen::{Picture as _, Shot};

/// A forest that cannot keep pace goes on more slowly: by so many seconds a picture at most.
const MOST_S: f64 = 0.1;
/// Where it is to jump far, so many steps a picture at most: the window lives on meanwhile.
const MOST_STEPS: u64 = 32;
/// And no farther than so many steps.
const LAST_FRAME: u32 = 1_000_000;

/// A forest in a window.
pub(super) struct ForestWindow {
    pipe: Pipe,
    fault: Fault,
    canvas: Canvas,
    picture: ForestPicture,
    knobs: Knobs,
    /// Winds that do not blow yet.
    making: Making,
    /// What was told by the pipe and waits for what was told before it.
    waiting: Option<Command>,
    stopwatch: Stopwatch,
    is_cpu: bool,
    /// From where it was seen at first.
    begun: Orbit,
    is_playing: bool,
    /// Seconds since it was first shown, to which it is to come.
    time: f64,
    /// Seconds of a step.
    step: f64,
    /// What there is: `12 plants of 3437 nodes, 25 modes`.
    told: String,
    /// What was said last.
    line: String,
}

/// In words, what there is.
fn told(scene: &ForestScene) -> String {
    let n = scene.places.len();
    let plants = if n == 1 { "1 plant".to_owned() } else { format!("{n} plants") };
    format!(
        "{}: {plants} of {} nodes, {} modes",
        scene.name,
        scene.stirring.n_nodes(),
        scene.stirring.n_modes()
    )
}

impl ForestWindow {
    pub(super) fn new(
        creation: &eframe::CreationContext<'_>,
        scene: ForestScene,
        args: &Args,
        fault: Fault,
    ) -> anyhow::Result<Self> {
        let mut canvas = Canvas::new(creation, args, true)?;
        let pipe = Pipe::new(&creation.egui_ctx, args.control)?;
        canvas.begin(scene.orbit, args);
        let (begun, told, step) = (scene.orbit, told(&scene), scene.pace.step);
        let knobs = Knobs::new(&scene);
        let picture = picture(&canvas, scene, args.cpu)?;
        let making = making(&picture, &creation.egui_ctx);
        pipe.tell(&Event::Ready { protocol: PROTOCOL, adapter: canvas.gpu.name() });
        let (stopwatch, waiting, line) = (Stopwatch::default(), None, String::new());
        let (is_cpu, is_playing, time) = (args.cpu, true, 0.0);
        Ok(Self {
            pipe,
            fault,
            canvas,
            picture,
            knobs,
            making,
            waiting,
            stopwatch,
            is_cpu,
            begun,
            is_playing,
            time,
            step,
            told,
            line,
        })
    }

    /// Whether it is still on its way to where it was told to be.
    fn is_behind(&self) -> bool {
        !self.picture.is_at(self.time)
    }

    /// Whether a command is to wait until a wind is worked out, and a moment come to, that were told before it.
    fn waits(&self, command: &Command) -> bool {
        match command {
            Command::Quit => false,
            Command::Frame(_) => self.making.is_busy(),
            _ => self.making.is_busy() || self.is_behind(),
        }
    }

    /// Does what was told by the pipe.
    fn obey(&mut self, context: &Context) {
        let bare = |what: &str| Event::Failed(format!("a forest has no {what}"));
        while let Some(command) = self.waiting.take().or_else(|| self.pipe.next()) {
            if self.waits(&command) {
                self.waiting = Some(command);
                return;
            }
            match command {
                Command::Play => self.is_playing = true,
                Command::Pause => self.is_playing = false,
                Command::Frame(frame) if frame > LAST_FRAME => {
                    let why = format!("frame {frame} is too far: {LAST_FRAME} is the last that is gone to");
                    self.pipe.tell(&Event::Failed(why));
                }
                Command::Frame(frame) => self.time = f64::from(frame) * self.step,
                Command::Scene { protocol, path } => {
                    if let Err(why) = self.take(context, protocol, &path) {
                        self.pipe.tell(&Event::Failed(format!("{why:#}")));
                    }
                }
                Command::Cut(_) => self.pipe.tell(&bare("groups")),
                Command::Select(_) => self.pipe.tell(&bare("bones or tracks to choose")),
                Command::Wind(words) => {
                    self.knobs.type_wind(&words);
                    self.turn(Turned { typed: true, ..Turned::default() });
                }
                Command::Camera(seat) => self.canvas.sit(seat),
                Command::Say(line) => self.line = line,
                Command::Capture(path) => self.pipe.capture(context, path),
                Command::Quit => context.send_viewport_cmd(egui::ViewportCommand::Close),
            }
        }
    }

    /// Another forest takes its place; where it cannot, all stays as it was.
    fn take(&mut self, context: &Context, protocol: u32, path: &Path) -> anyhow::Result<()> {
        ensure!(protocol == PROTOCOL, "protocol {protocol} came, and {PROTOCOL} was wanted");
        let Scene::Forest(scene) = honami_scene::file::read(path)? else {
            bail!("{} is a skeleton, and a forest is shown", path.display())
        };
        let picture = picture(&self.canvas, *scene, self.is_cpu)?;
        let scene = picture.scene();
        (self.told, self.step, self.begun) = (told(scene), scene.pace.step, scene.orbit);
        (self.knobs, self.making) = (Knobs::new(scene), making(&picture, context));
        (self.picture, self.time) = (picture, 0.0);
        Ok(())
    }

    /// What was turned holds as soon as it is worked out; what cannot be is said, and what was before goes on.
    fn turn(&mut self, turned: Turned) {
        if turned == Turned::default() {
            return;
        }
        self.line.clear();
        if (turned.typed || turned.wind)
            && let Err(why) = self.ask(turned.typed)
        {
            self.knobs.refuse();
            self.refused(&why);
        }
        if turned.damping {
            match self.picture.damp(&self.canvas.gpu, self.knobs.damping) {
                Ok(()) => self.knobs.hold_damping(),
                Err(why) => {
                    self.knobs.refuse_damping();
                    self.refused(&why);
                }
            }
        }
    }

    fn ask(&mut self, begins: bool) -> anyhow::Result<()> {
        let winds = self.knobs.winds.clone();
        let typed = winds.read()?;
        self.making.ask(Asked { winds, typed, begins }).context("no thread for a wind")
    }

    /// Winds that have been worked out blow from now on.
    fn blow(&mut self) -> anyhow::Result<()> {
        while let Some(made) = self.making.news().context("no thread for a wind")? {
            match made.wind {
                Ok(wind) => {
                    if made.begins {
                        self.picture.begin(wind);
                    } else {
                        self.picture.turn(wind);
                    }
                    self.knobs.hold(made.winds);
                }
                Err(why) => {
                    if !self.making.is_busy() {
                        self.knobs.refuse();
                    }
                    self.refused(&why);
                }
            }
        }
        Ok(())
    }

    fn refused(&mut self, why: &anyhow::Error) {
        self.line = format!("{why:#}");
        self.pipe.tell(&Event::Failed(self.line.clone()));
    }

    fn keys(&mut self, ui: &Ui) {
        // What is typed into a field is no key.
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        if pressed(Key::Space) {
            self.play(!self.is_playing);
        }
        if pressed(Key::Period) {
            self.play(false);
            self.time += self.step;
        }
        if pressed(Key::F) {
            self.canvas.orbit = self.begun;
        }
        if pressed(Key::Escape) {
            self.knobs.putting = None;
        }
    }

    fn play(&mut self, is_playing: bool) {
        self.is_playing = is_playing;
        self.pipe.tell(&Event::Playing(is_playing));
    }

    fn transport(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if ui.button(if self.is_playing { "pause" } else { "play" }).clicked() {
                self.play(!self.is_playing);
            }
            ui.label(format!("{:.1} s", self.picture.time()));
            if ui.button("as at first (f)").clicked() {
                self.canvas.orbit = self.begun;
            }
            if self.making.is_busy() {
                ui.label("the wind is being worked out");
            } else if self.is_behind() {
                ui.label(format!("goes on to {:.1} s", self.time));
            }
            ui.label(&self.line);
        });
    }

    fn panel(&mut self, ui: &mut Ui) -> Turned {
        ui.label(&self.told);
        ui.label(format!("drawn by {}", self.canvas.gpu.name()));
        self.stopwatch.show(ui);
        ui.separator();
        self.knobs.show(ui)
    }

    fn draw(&mut self, ui: &mut Ui) -> anyhow::Result<()> {
        let (response, area) = self.canvas.place(ui)?;
        self.canvas.look(ui, &response, area, true);
        let camera = self.canvas.orbit.camera();
        let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
        if let Some(at) = clicked.and_then(|at| on_ground(&camera, area, at))
            && self.knobs.put(at)
        {
            self.turn(Turned { wind: true, ..Turned::default() });
        }
        let Some(target) = self.canvas.target() else { return Ok(()) };
        // What is told to be seen is seen in the wind that was told before it.
        if self.is_playing || !self.making.is_busy() {
            self.picture.go_towards(&self.canvas.gpu, self.time, MOST_STEPS)?;
        }
        let time = if self.is_behind() { self.picture.time() } else { self.time };
        let shot = Shot { time, camera };
        self.picture.draw(&self.canvas.gpu, target, &shot)?;
        self.canvas.show(ui, area);
        Ok(self.canvas.gpu.check()?)
    }
}

fn picture(canvas: &Canvas, scene: ForestScene, is_cpu: bool) -> anyhow::Result<ForestPicture> {
    let by = if is_cpu { By::Processor } else { By::best(&canvas.gpu, &scene) };
    ForestPicture::new(&canvas.gpu, scene, by)
}

/// Winds over what is shown; a window is drawn anew when one is there.
fn making(picture: &ForestPicture, context: &Context) -> Making {
    let context = context.clone();
    Making::new(Arc::clone(picture.scene()), Arc::new(move || context.request_repaint()))
}

/// The place on the ground that is seen at a point of a picture; `None` in the sky.
fn on_ground(camera: &Camera, area: Rect, at: Pos2) -> Option<[f32; 2]> {
    let half = (camera.angle / 2.0).tan() / (area.height() / 2.0).max(1.0);
    let (right, up) = ((at.x - area.center().x) * half, (area.center().y - at.y) * half);
    let [across, above, forward] = camera.axes();
    let way: [f32; 3] = std::array::from_fn(|k| forward[k] + right * across[k] + up * above[k]);
    let times = -camera.eye[2] / way[2];
    (times.is_finite() && times > 0.0).then(|| [0, 1].map(|k| camera.eye[k] + times * way[k]))
}

impl eframe::App for ForestWindow {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if let Err(why) = self.blow() {
            fail(&self.fault, &context, why);
        }
        self.obey(&context);
        self.keys(ui);
        let seconds = self.stopwatch.tick(self.is_playing, f64::from(ui.input(|input| input.unstable_dt)));
        if !self.is_behind() {
            self.time += seconds.min(MOST_S);
        }
        egui::Panel::bottom("time").show(ui, |ui| self.transport(ui));
        let turned = egui::Panel::right("beside").exact_size(PANEL).show(ui, |ui| self.panel(ui)).inner;
        self.turn(turned);
        let drawn = egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.draw(ui)).inner;
        if let Err(why) = drawn {
            fail(&self.fault, &context, why);
        }
        let is_stuck = self.making.is_busy() && !self.is_playing;
        if !is_stuck && (self.is_playing || self.is_behind() || self.waiting.is_some()) {
            context.request_repaint();
        }
    }

    fn on_exit(&mut self) {
        self.pipe.tell(&Event::Closed);
    }
}

#[cfg(test)]
mod tests {
    //! Where clicks are on the ground.

    use super::on_ground;
    use eframe::egui::{Rect, pos2};
    use honami_scene::Camera;

    #[test]
    fn clicks_are_where_they_are_seen() {
        let camera = Camera { eye: [0.0, -10.0, 5.0], target: [0.0, 0.0, 0.0], angle: 0.8 };
        let area = Rect::from_min_max(pos2(100.0, 50.0), pos2(500.0, 350.0));
        for place in [[0.0, 0.0], [2.0, 3.0], [-4.0, -2.0]] {
            let ([right, up], _) = camera.seen([place[0], place[1], 0.0]);
            let at = area.center() + eframe::egui::vec2(right, -up) * area.height() / 2.0;
            let found = on_ground(&camera, area, at).unwrap();
            assert!((0..2).all(|k| (found[k] - place[k]).abs() < 1e-3), "{place:?} {found:?}");
        }
        let level = Camera { target: [0.0, 0.0, 5.0], ..camera };
        assert_eq!(on_ground(&level, area, area.center_top()), None, "the sky");
    }
}
