//! The window: the picture, time below it, and beside it what is shown and what is done to it.

mod pipe;
mod player;
mod skeleton;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{anyhow, bail, ensure};
use eframe::egui::{self, Color32, Context, Key, Modifiers, PointerButton, Rect, Response, Sense, Ui, Vec2};
use eframe::egui_wgpu::{RenderState, WgpuSetup};
use eframe::wgpu;
use honami_scene::control::{Chosen, Command, Event, PROTOCOL, Seat};
use honami_scene::{Orbit, Scene};

use self::pipe::Pipe;
use self::player::Player;
use self::skeleton::Workbench;
use crate::args::Args;
use crate::gpu::{Gpu, GpuError};
use crate::offscreen::{Picture as _, Shot};
use crate::skeleton::{Part, SkeletonPicture};
use crate::target::{Size, Target};

/// A drag over so many points goes once round.
const ROUND_POINTS: f32 = 900.0;
/// As much of the wheel as doubles the distance, points.
const DOUBLE_POINTS: f32 = 400.0;
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
    let Scene::Skeleton(scene) = scene else {
        bail!("this window shows skeletons: `--offscreen` draws the scene")
    };
    let picture = SkeletonPicture::new(*scene, Part::these(&args.parts));
    let fault = Fault::default();
    let (kept, args) = (Arc::clone(&fault), args.clone());
    let size = args.size;
    let make = move |creation: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        Ok(Box::new(App::new(creation, picture, &args, kept)?))
    };
    let shown = eframe::run_native("honami", options(size), Box::new(make));
    if let Some(fault) = fault.lock().unwrap_or_else(PoisonError::into_inner).take() {
        return Err(fault);
    }
    shown.map_err(|why| match why {
        eframe::Error::AppCreation(why) => anyhow!("{why}"),
        eframe::Error::Wgpu(why) => anyhow!("{}: {why}", GpuError::None),
        why => anyhow!("the window does not open: {why}"),
    })
}

fn options([width, height]: [u32; 2]) -> eframe::NativeOptions {
    let mut options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("honami")
            .with_inner_size([width as f32 + PANEL, height as f32 + 40.0]),
        persist_window: false,
        ..Default::default()
    };
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
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
    screen: RenderState,
    gpu: Gpu,
    target: Option<(Target, egui::TextureId)>,
    workbench: Workbench,
    player: Player,
    orbit: Orbit,
    /// Of a pixel.
    samples: u32,
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
        let Some(screen) = creation.wgpu_render_state.clone() else { bail!(GpuError::None) };
        let gpu = Gpu::adopt(screen.device.clone(), screen.queue.clone(), screen.adapter.get_info());
        let pipe = Pipe::new(&creation.egui_ctx, args.control)?;
        let mut orbit = picture.orbit();
        orbit.azimuth = args.azimuth.map_or(orbit.azimuth, f32::to_radians);
        orbit.elevation = args.elevation.map_or(orbit.elevation, f32::to_radians);
        orbit.zoom(args.distance as f32);
        pipe.tell(&Event::Ready { protocol: PROTOCOL, adapter: gpu.name() });
        let player = Player::new(picture.scene.times.clone());
        let workbench = Workbench::new(picture);
        let (target, samples, line) = (None, args.samples, String::new());
        Ok(Self { pipe, fault, screen, gpu, target, workbench, player, orbit, samples, line })
    }

    /// Ends the window with what went wrong.
    fn fail(&self, context: &Context, why: anyhow::Error) {
        self.fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }

    /// Does what was told by the pipe.
    fn obey(&mut self, context: &Context) {
        while let Some(command) = self.pipe.next() {
            match command {
                Command::Play => self.player.is_playing = true,
                Command::Pause => self.player.is_playing = false,
                Command::Frame(frame) => self.go(frame.saturating_sub(self.first()) as usize),
                Command::Scene { protocol, path } => self.show(protocol, &path),
                Command::Cut(k) => self.pipe.tell(&Event::Cut(k)),
                Command::Wind(_) => self.pipe.tell(&Event::Failed("no wind blows in a skeleton".to_owned())),
                Command::Camera(seat) => self.sit(seat),
                Command::Select(chosen) => self.workbench.choose(chosen),
                Command::Say(line) => {
                    self.line = line;
                    self.workbench.let_be();
                }
                Command::Capture(path) => self.capture(context, path),
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
                self.workbench.take(*scene);
                if !self.player.is_playing {
                    self.go(frame.saturating_sub(self.first()) as usize);
                }
            }
            Err(why) => self.pipe.tell(&Event::Failed(format!("{why:#}"))),
        }
    }

    /// Writes what the window shows into a file, and tells when it is there.
    fn capture(&self, context: &Context, path: std::path::PathBuf) {
        let is_steered = self.pipe.is_steered();
        context.request_screenshot(move |picture| {
            let [width, height] = picture.size.map(|side| u32::try_from(side).unwrap_or_default());
            let pixels: Vec<[u8; 3]> = picture.pixels.iter().map(|at| [at.r(), at.g(), at.b()]).collect();
            let event = match honami_media::write::still(&path, &pixels, width, height) {
                Ok(()) => Event::Captured(path),
                Err(why) => Event::Failed(why.to_string()),
            };
            if is_steered {
                pipe::tell(&event);
            }
        });
    }

    fn sit(&mut self, seat: Seat) {
        let is_good = |v: &f32| v.is_finite();
        let angle = |v: Option<f32>, was: f32| v.filter(is_good).map_or(was, f32::to_radians);
        self.orbit.azimuth = angle(seat.azimuth_deg, self.orbit.azimuth);
        self.orbit.elevation = angle(seat.elevation_deg, self.orbit.elevation);
        if let Some(distance) = seat.distance.filter(|v| is_good(v) && *v > 0.0) {
            self.orbit.distance = distance;
            self.orbit.zoom(1.0);
        }
    }

    /// The clip's frame that is the first of the skeleton's.
    fn first(&self) -> u32 {
        self.workbench.picture.scene.first_frame
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

    fn front(&mut self) {
        self.orbit = self.workbench.picture.orbit();
    }

    /// Keys, as the terminal has them.
    fn keys(&mut self, ui: &Ui) {
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
        if pressed(Key::U) {
            self.pipe.tell(&Event::Undo);
        }
        if ui.input_mut(|input| input.consume_key(Modifiers::CTRL, Key::R)) {
            self.pipe.tell(&Event::Redo);
        }
        if pressed(Key::Enter)
            && let Some(event) = self.workbench.keep()
        {
            self.pipe.tell(&event);
        }
        if pressed(Key::Escape) {
            self.workbench.let_be();
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
        let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let scale = ui.pixels_per_point();
        let side = |points: f32| (points * scale).round().clamp(1.0, 8192.0) as u32;
        self.fit(Size { width: side(area.width()), height: side(area.height()), samples: self.samples })?;
        if self.workbench.is_rooting {
            self.orbit = Orbit { azimuth: 0.0, elevation: 0.0, ..self.orbit };
        }
        self.look(ui, &response, area);
        let shot = Shot { time: self.player.now(), camera: self.orbit.camera() };
        let Some((target, id)) = &self.target else { return Ok(()) };
        let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
        if let Some(at) = clicked.map(|at| (at - area.min) * scale) {
            let picture = &self.workbench.picture;
            if self.workbench.is_rooting {
                let root = picture.placed(&shot, target, [at.x, at.y]);
                self.pipe.tell(&Event::Root(Some(root)));
                self.workbench.is_rooting = false;
            } else {
                let chosen =
                    picture.nearest(&shot, target, [at.x, at.y], NEAR_POINTS * scale).map(Chosen::Bone);
                self.workbench.choose(chosen);
                self.pipe.tell(&Event::Selected(chosen));
            }
        }
        self.workbench.picture.draw(&self.gpu, target, &shot)?;
        let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        ui.painter().image(*id, area, whole, Color32::WHITE);
        Ok(())
    }

    /// A target of this size.
    fn fit(&mut self, size: Size) -> Result<(), GpuError> {
        if self.target.as_ref().is_some_and(|(target, _)| target.size() == size) {
            return Ok(());
        }
        let target = Target::new(&self.gpu, size)?;
        let mut renderer = self.screen.renderer.write();
        if let Some((_, id)) = self.target.take() {
            renderer.free_texture(&id);
        }
        let id = renderer.register_native_texture(&self.gpu.device, target.shown(), wgpu::FilterMode::Linear);
        drop(renderer);
        self.target = Some((target, id));
        Ok(())
    }

    /// A drag goes round, one with the other button or with shift moves, the wheel goes nearer and farther.
    fn look(&mut self, ui: &Ui, response: &Response, area: Rect) {
        let (drag, wheel, is_shift) =
            ui.input(|input| (response.drag_delta(), input.smooth_scroll_delta().y, input.modifiers.shift));
        let is_moved = response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Middle)
            || (response.dragged_by(PointerButton::Primary) && is_shift);
        if is_moved {
            self.shift(drag, area);
        } else if response.dragged_by(PointerButton::Primary) && !self.workbench.is_rooting {
            self.orbit.azimuth -= drag.x / ROUND_POINTS * std::f32::consts::TAU;
            let steep = self.orbit.elevation + drag.y / ROUND_POINTS * std::f32::consts::TAU;
            self.orbit.elevation = steep.clamp(-1.5, 1.5);
        }
        if response.hovered() && wheel.abs() > 0.0 {
            self.orbit.zoom((-wheel / DOUBLE_POINTS).exp2());
        }
    }

    /// What is looked at goes with the mouse.
    fn shift(&mut self, drag: Vec2, area: Rect) {
        let a_point = 2.0 * self.orbit.distance * (self.orbit.angle / 2.0).tan() / area.height().max(1.0);
        let [right, up, _] = self.orbit.camera().axes();
        for axis in 0..3 {
            self.orbit.target[axis] += a_point * (drag.y * up[axis] - drag.x * right[axis]);
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.obey(&context);
        self.keys(ui);
        self.player.tick(f64::from(ui.input(|input| input.stable_dt)));
        egui::Panel::bottom("time").show(ui, |ui| self.transport(ui));
        let events =
            egui::Panel::right("beside").exact_size(PANEL).show(ui, |ui| self.workbench.panel(ui)).inner;
        events.iter().for_each(|event| self.pipe.tell(event));
        let drawn =
            egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.picture(ui)).inner;
        if let Err(why) = drawn.and_then(|()| Ok(self.gpu.check()?)) {
            self.fail(&context, why);
        }
        if self.player.is_playing {
            context.request_repaint();
        }
    }

    fn on_exit(&mut self) {
        self.pipe.tell(&Event::Closed);
    }
}
