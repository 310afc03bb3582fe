//! The window: the picture, time below it, and beside it what is shown and what is done to it.

mod canvas;
mod forest;
pub(crate) mod pipe;
mod player;
mod skeleton;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{anyhow, bail, ensure};
use eframe::egui::{self, Context, Key, Modifiers, Ui};
use eframe::egui_wgpu::{NativeAdapterSelectorMethod, WgpuSetup};
use eframe::wgpu;
use honami_scene::control::{Chosen, Command, Event, PROTOCOL};
use honami_scene::{Orbit, Scene};

use self::canvas::Canvas;
use self::forest::ForestWindow;
use self::pipe::Pipe;
use self::player::Player;
use self::skeleton::SkeletonPanel;
use crate::args::Args;
use crate::gpu;
use crate::offscreen::{Picture as _, Shot};
use crate::skeleton::{Part, SkeletonPicture};

/// A click so near to a joint chooses its bone, points.
const NEAR_POINTS: f32 = 14.0;
/// Width of the panel beside the picture, points.
const PANEL: f32 = 290.0;

/// Why the window ended, where that was not as it should.
type Fault = Arc<Mutex<Option<anyhow::Error>>>;

/// Shows a scene in a window until it is closed.
///
/// # Errors
/// No display, nothing to draw with, what drew was lost: in one line.
pub fn run(path: &Path, args: &Args) -> anyhow::Result<()> {
    let scene = honami_scene::file::read(path)?;
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    ensure!(
        is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"),
        "there is no display for a window (neither DISPLAY nor WAYLAND_DISPLAY is set): `--offscreen OUT.png` draws without one"
    );
    let fault = Fault::default();
    let (kept, args) = (Arc::clone(&fault), args.clone());
    let (size, adapter) = (args.size, args.adapter.clone());
    let make = move |creation: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(match scene {
            Scene::Skeleton(scene) => {
                let picture = SkeletonPicture::new(*scene, Part::these(&args.parts));
                Box::new(App::new(creation, picture, &args, kept)?)
            }
            Scene::Forest(scene) => Box::new(ForestWindow::new(creation, *scene, &args, kept)?),
        })
    };
    let shown = eframe::run_native("honami", options(size, adapter), Box::new(make));
    if let Some(fault) = fault.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(fault);
    }
    shown.map_err(|why| match why {
        eframe::Error::AppCreation(why) => anyhow!("{why}"),
        eframe::Error::Wgpu(why) => anyhow!("nothing draws the window: {why}"),
        why => anyhow!("the window does not open: {why}"),
    })
}

/// Ends the window with what went wrong.
fn fail(fault: &Fault, context: &Context, why: anyhow::Error) {
    fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
    context.send_viewport_cmd(egui::ViewportCommand::Close);
}

/// With the adapter that has this in its name, where that is wanted.
fn options([width, height]: [u32; 2], adapter: Option<String>) -> eframe::NativeOptions {
    let mut options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("honami")
            .with_inner_size([width as f32 + PANEL, height as f32 + 40.0]),
        persist_window: false,
        ..Default::default()
    };
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.native_adapter_selector = adapter.map(|wanted| -> NativeAdapterSelectorMethod {
            Arc::new(move |there, surface| gpu::pick(there, surface, &wanted).map_err(|why| why.to_string()))
        });
        setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
            label: Some("honami"),
            required_limits: adapter.limits(),
            ..Default::default()
        });
    }
    options
}

/// The window and what is in it.
struct App {
    pipe: Pipe,
    fault: Fault,
    canvas: Canvas,
    panel: SkeletonPanel,
    player: Player,
    /// What was said last.
    line: String,
}

impl App {
    fn new(
        creation: &eframe::CreationContext<'_>,
        picture: SkeletonPicture,
        args: &Args,
        fault: Fault,
    ) -> anyhow::Result<Self> {
        let mut canvas = Canvas::new(creation, args, false)?;
        let pipe = Pipe::new(&creation.egui_ctx, args.control)?;
        canvas.begin(picture.orbit(), args);
        pipe.tell(&Event::Ready { protocol: PROTOCOL, adapter: canvas.gpu.name() });
        let player = Player::new(picture.scene.times.clone());
        Ok(Self { pipe, fault, canvas, panel: SkeletonPanel::new(picture), player, line: String::new() })
    }

    /// Does what was told by the pipe.
    fn obey(&mut self, context: &Context) {
        let mut told: Vec<Command> = std::iter::from_fn(|| self.pipe.next()).collect();
        let last = told.iter().rposition(|command| matches!(command, Command::Scene { .. }));
        let mut at = 0;
        // Of several scenes the last is the one to see, and the others may be gone.
        told.retain(|command| {
            at += 1;
            !matches!(command, Command::Scene { .. }) || Some(at - 1) == last
        });
        for command in told {
            match command {
                Command::Play => self.player.is_playing = true,
                Command::Pause => self.player.is_playing = false,
                Command::Frame(frame) => self.go(frame.saturating_sub(self.first()) as usize),
                Command::Scene { protocol, path } => self.show(protocol, &path),
                Command::Cut(k) => self.pipe.tell(&Event::Cut(k)),
                Command::Wind(_) => self.pipe.tell(&Event::Failed("no wind blows in a skeleton".to_owned())),
                Command::Camera(seat) => self.canvas.sit(seat),
                Command::Select(chosen) => self.panel.choose(chosen),
                Command::Say(line) => {
                    self.line = line;
                    self.panel.let_be();
                }
                Command::Capture(path) => self.pipe.capture(context, path),
                Command::Quit => context.send_viewport_cmd(egui::ViewportCommand::Close),
            }
        }
    }

    fn show(&mut self, protocol: u32, path: &Path) {
        let read = || -> anyhow::Result<_> {
            ensure!(protocol == PROTOCOL, "protocol {protocol} came, and {PROTOCOL} was wanted");
            match honami_scene::file::read(path)? {
                Scene::Skeleton(scene) => Ok(scene),
                Scene::Forest(_) => bail!("{} is a forest, and a skeleton is shown", path.display()),
            }
        };
        match read() {
            Ok(scene) => {
                let frame = self.first() + self.player.row() as u32;
                self.player.take(scene.times.clone());
                self.panel.take(*scene);
                if !self.player.is_playing {
                    self.go(frame.saturating_sub(self.first()) as usize);
                }
            }
            Err(why) => self.pipe.tell(&Event::Failed(format!("{why:#}"))),
        }
    }

    /// The clip's frame that is the first of the skeleton's.
    fn first(&self) -> u32 {
        self.panel.picture.scene.first_frame
    }

    fn go(&mut self, row: usize) {
        self.player.go(row);
    }

    /// Goes to a frame because somebody here wants to.
    fn step_to(&mut self, row: usize) {
        self.go(row);
        let row = u32::try_from(self.player.row()).unwrap_or(u32::MAX);
        self.pipe.tell(&Event::Frame(self.first().saturating_add(row)));
    }

    fn play(&mut self, is_playing: bool) {
        self.player.is_playing = is_playing;
        self.pipe.tell(&Event::Playing(is_playing));
        if !is_playing {
            self.step_to(self.player.row());
        }
    }

    /// So many seconds have gone; whoever steers is told which frame has come.
    fn tick(&mut self, seconds: f64) {
        let before = self.player.row();
        self.player.tick(seconds);
        if self.player.row() != before {
            self.pipe.tell(&Event::Passing(self.first() + self.player.row() as u32));
        }
    }

    fn front(&mut self) {
        self.canvas.orbit = self.panel.picture.orbit();
    }

    /// Keys, as the terminal has them.
    fn keys(&mut self, ui: &Ui) {
        // What is typed into a field is no key.
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key| ui.input(|input| input.key_pressed(key) && input.modifiers.is_none());
        let row = self.player.row();
        if pressed(Key::Space) {
            self.play(!self.player.is_playing);
        }
        if pressed(Key::Period) {
            self.step_to(row + 1);
        }
        if pressed(Key::Comma) {
            self.step_to(row.saturating_sub(1));
        }
        if pressed(Key::F) {
            self.front();
        }
        if self.panel.is_open() {
            if pressed(Key::U) {
                self.pipe.tell(&Event::Undo);
            }
            if ui.input_mut(|input| input.consume_key(Modifiers::CTRL, Key::R)) {
                self.pipe.tell(&Event::Redo);
            }
        }
        if pressed(Key::Enter)
            && let Some(event) = self.panel.keep()
        {
            self.pipe.tell(&event);
        }
        if pressed(Key::Escape) {
            self.panel.let_be();
        }
    }

    /// Time.
    fn transport(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let word = if self.player.is_playing { "pause" } else { "play" };
            if ui.button(word).clicked() {
                self.play(!self.player.is_playing);
            }
            let (first, last) = (self.first(), self.player.n_frames().saturating_sub(1) as u32);
            let mut frame = first + self.player.row() as u32;
            ui.spacing_mut().slider_width = (ui.available_width() - 330.0).max(100.0);
            let slider = egui::Slider::new(&mut frame, first..=first + last).text("frame");
            if ui.add(slider).changed() {
                self.step_to((frame - first) as usize);
            }
            ui.label(format!("{:.2} s", self.player.now()));
            if ui.button("front (f)").clicked() {
                self.front();
            }
            ui.label(&self.line);
        });
    }

    /// The picture, as large as there is room, and what a mouse does in it.
    fn picture(&mut self, ui: &mut Ui) -> anyhow::Result<()> {
        let (response, area) = self.canvas.place(ui)?;
        if self.panel.is_rooting {
            self.canvas.orbit = Orbit { azimuth: 0.0, elevation: 0.0, ..self.canvas.orbit };
        }
        self.canvas.look(ui, &response, area, !self.panel.is_rooting);
        let scale = ui.pixels_per_point();
        let shot = Shot { time: self.player.now(), camera: self.canvas.orbit.camera() };
        let Some(target) = self.canvas.target() else { return Ok(()) };
        let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
        if let Some(at) = clicked.map(|at| (at - area.min) * scale) {
            let picture = &self.panel.picture;
            if self.panel.is_rooting {
                let root = picture.placed(&shot, target, [at.x, at.y]);
                self.pipe.tell(&Event::Root(Some(root)));
                self.panel.is_rooting = false;
            } else {
                let chosen =
                    picture.nearest(&shot, target, [at.x, at.y], NEAR_POINTS * scale).map(Chosen::Bone);
                self.panel.choose(chosen);
                self.pipe.tell(&Event::Selected(chosen));
            }
        }
        self.panel.picture.draw(&self.canvas.gpu, target, &shot)?;
        self.canvas.show(ui, area);
        Ok(())
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.obey(&context);
        self.keys(ui);
        self.tick(f64::from(ui.input(|input| input.stable_dt)));
        egui::Panel::bottom("time").show(ui, |ui| self.transport(ui));
        let events = egui::Panel::right("beside").exact_size(PANEL).show(ui, |ui| self.panel.show(ui)).inner;
        events.iter().for_each(|event| self.pipe.tell(event));
        let drawn =
            egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.picture(ui)).inner;
        if let Err(why) = drawn.and_then(|()| Ok(self.canvas.gpu.check()?)) {
            fail(&self.fault, &context, why);
        }
        if self.player.is_playing {
            context.request_repaint();
        }
    }

    fn on_exit(&mut self) {
        self.pipe.tell(&Event::Closed);
    }
}
