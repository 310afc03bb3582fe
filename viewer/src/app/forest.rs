//! The window of a forest: the wind, damping and mass are turned while it sways, and winds are put into it by clicks.

mod knobs;
mod pace;

use std::path::Path;

use anyhow::{bail, ensure};
use eframe::egui::{self, Context, Key, Pos2, Rect, Ui};
use honami_scene::control::{Command, Event, PROTOCOL};
use honami_scene::{Camera, ForestScene, Orbit, Scene};

use self::knobs::{Knobs, Turned};
use self::pace::Pace;
use super::canvas::Canvas;
use super::pipe::Pipe;
use super::{Fault, PANEL, fail};
use crate::args::Args;
use crate::forest::{By, ForestPicture};
use crate::offscreen::{Picture as _, Shot};

/// A forest that cannot keep pace goes on more slowly: by so many seconds a picture at most.
const MOST_S: f64 = 0.1;

/// A forest in a window.
pub(super) struct ForestWindow {
    pipe: Pipe,
    fault: Fault,
    canvas: Canvas,
    picture: ForestPicture,
    knobs: Knobs,
    pace: Pace,
    is_cpu: bool,
    /// From where it was seen at first.
    begun: Orbit,
    is_playing: bool,
    /// Seconds since it was first shown.
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
        pipe.tell(&Event::Ready { protocol: PROTOCOL, adapter: canvas.gpu.name() });
        let (pace, is_playing, time, line) = (Pace::default(), true, 0.0, String::new());
        let is_cpu = args.cpu;
        Ok(Self {
            pipe,
            fault,
            canvas,
            picture,
            knobs,
            pace,
            is_cpu,
            begun,
            is_playing,
            time,
            step,
            told,
            line,
        })
    }

    /// Does what was told by the pipe.
    fn obey(&mut self, context: &Context) {
        let bare = |what: &str| Event::Failed(format!("a forest has no {what}"));
        while let Some(command) = self.pipe.next() {
            match command {
                Command::Play => self.is_playing = true,
                Command::Pause => self.is_playing = false,
                Command::Frame(frame) => self.time = f64::from(frame) * self.step,
                Command::Scene { protocol, path } => {
                    if let Err(why) = self.take(protocol, &path) {
                        self.pipe.tell(&Event::Failed(format!("{why:#}")));
                    }
                }
                Command::Cut(_) => self.pipe.tell(&bare("groups")),
                Command::Select(_) => self.pipe.tell(&bare("bones or tracks to choose")),
                Command::Wind(words) => {
                    self.knobs.type_wind(&words);
                    self.turn(Turned { wind: true, ..Turned::default() });
                }
                Command::Camera(seat) => self.canvas.sit(seat),
                Command::Say(line) => self.line = line,
                Command::Capture(path) => self.pipe.capture(context, path),
                Command::Quit => context.send_viewport_cmd(egui::ViewportCommand::Close),
            }
        }
    }

    /// Another forest takes its place.
    fn take(&mut self, protocol: u32, path: &Path) -> anyhow::Result<()> {
        ensure!(protocol == PROTOCOL, "protocol {protocol} came, and {PROTOCOL} was wanted");
        let Scene::Forest(scene) = honami_scene::file::read(path)? else {
            bail!("{} is a skeleton, and a forest is shown", path.display())
        };
        (self.told, self.step, self.begun) = (told(&scene), scene.pace.step, scene.orbit);
        self.knobs = Knobs::new(&scene);
        self.picture = picture(&self.canvas, *scene, self.is_cpu)?;
        self.time = 0.0;
        Ok(())
    }

    /// What was turned holds from now on; what cannot be is said, and what was before goes on.
    fn turn(&mut self, turned: Turned) {
        let blown = turned.wind.then(|| self.picture.blow(&self.knobs.words()));
        let damped = turned.damping.then(|| self.picture.damp(&self.canvas.gpu, self.knobs.damping));
        let mut said = String::new();
        for why in blown.into_iter().chain(damped).filter_map(Result::err) {
            said = format!("{why:#}");
            self.pipe.tell(&Event::Failed(said.clone()));
        }
        if turned.wind || turned.damping {
            self.line = said;
        }
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
            self.knobs.planting = None;
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
            ui.label(format!("{:.1} s", self.time));
            if ui.button("as at first (f)").clicked() {
                self.canvas.orbit = self.begun;
            }
            ui.label(&self.line);
        });
    }

    fn panel(&mut self, ui: &mut Ui) -> Turned {
        ui.label(&self.told);
        ui.label(format!("drawn by {}", self.canvas.gpu.name()));
        self.pace.show(ui);
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
        let shot = Shot { time: self.time, camera };
        let Some(target) = self.canvas.target() else { return Ok(()) };
        self.picture.draw(&self.canvas.gpu, target, &shot)?;
        self.canvas.show(ui, area);
        Ok(self.canvas.gpu.check()?)
    }
}

fn picture(canvas: &Canvas, scene: ForestScene, is_cpu: bool) -> anyhow::Result<ForestPicture> {
    let by = if is_cpu { By::Processor } else { By::best(&canvas.gpu, &scene) };
    ForestPicture::new(&canvas.gpu, scene, by)
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
        self.obey(&context);
        self.keys(ui);
        let seconds = f64::from(ui.input(|input| input.unstable_dt));
        if self.is_playing {
            self.pace.took(seconds);
            self.time += seconds.min(MOST_S);
        }
        egui::Panel::bottom("time").show(ui, |ui| self.transport(ui));
        let turned = egui::Panel::right("beside").exact_size(PANEL).show(ui, |ui| self.panel(ui)).inner;
        self.turn(turned);
        let drawn = egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.draw(ui)).inner;
        if let Err(why) = drawn {
            fail(&self.fault, &context, why);
        }
        if self.is_playing {
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
