//! What a window draws on, and from where it is looked at.

use eframe::egui::{self, Color32, PointerButton, Rect, Response, Sense, Ui, Vec2};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;
use honami_scene::Orbit;
use honami_scene::control::Seat;

use crate::args::Args;
use crate::gpu::{Gpu, GpuError};
use crate::target::{Size, Target};

/// A drag over so many points goes once round.
const ROUND_POINTS: f32 = 900.0;
/// As much of the wheel as doubles the distance, points.
const DOUBLE_POINTS: f32 = 400.0;

/// A picture in a window.
pub(super) struct Canvas {
    pub(super) gpu: Gpu,
    /// From where it is seen.
    pub(super) orbit: Orbit,
    /// Whether what is shown stands on ground, below which nobody looks.
    has_ground: bool,
    screen: RenderState,
    target: Option<(Target, egui::TextureId)>,
    /// Of a pixel.
    samples: u32,
}

impl Canvas {
    /// One that draws as the window does.
    ///
    /// # Errors
    /// [`GpuError::None`].
    pub(super) fn new(
        creation: &eframe::CreationContext<'_>,
        args: &Args,
        has_ground: bool,
    ) -> Result<Self, GpuError> {
        let screen = creation.wgpu_render_state.clone().ok_or(GpuError::None)?;
        let gpu = Gpu::adopt(screen.device.clone(), screen.queue.clone(), screen.adapter.get_info());
        let orbit = Orbit { target: [0.0; 3], distance: 1.0, azimuth: 0.0, elevation: 0.0, angle: 0.5 };
        Ok(Self { gpu, orbit, has_ground, screen, target: None, samples: args.samples })
    }

    /// It is seen from here, as the command line has it.
    pub(super) fn begin(&mut self, orbit: Orbit, args: &Args) {
        self.orbit = orbit;
        self.orbit.azimuth = args.azimuth.map_or(orbit.azimuth, f32::to_radians);
        self.orbit.elevation = args.elevation.map_or(orbit.elevation, f32::to_radians);
        self.orbit.zoom(args.distance as f32);
        self.settle();
    }

    fn settle(&mut self) {
        if self.has_ground {
            self.orbit.stay_above();
        }
    }

    /// It is seen from where somebody says.
    pub(super) fn sit(&mut self, seat: Seat) {
        let is_good = |v: &f32| v.is_finite();
        let angle = |v: Option<f32>, was: f32| v.filter(is_good).map_or(was, f32::to_radians);
        self.orbit.azimuth = angle(seat.azimuth_deg, self.orbit.azimuth);
        self.orbit.elevation = angle(seat.elevation_deg, self.orbit.elevation);
        if let Some(distance) = seat.distance.filter(|v| is_good(v) && *v > 0.0) {
            self.orbit.distance = distance;
            self.orbit.zoom(1.0);
        }
        self.settle();
    }

    /// Room for a picture, as large as there is; where it is, and what a mouse does there.
    ///
    /// # Errors
    /// [`GpuError`].
    pub(super) fn place(&mut self, ui: &mut Ui) -> Result<(Response, Rect), GpuError> {
        let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let scale = ui.pixels_per_point();
        let side = |points: f32| (points * scale).round().clamp(1.0, 8192.0) as u32;
        self.fit(Size { width: side(area.width()), height: side(area.height()), samples: self.samples })?;
        Ok((response, area))
    }

    /// What is drawn on, once there was room for it.
    pub(super) fn target(&self) -> Option<&Target> {
        self.target.as_ref().map(|(target, _)| target)
    }

    /// Shows what was drawn.
    pub(super) fn show(&self, ui: &Ui, area: Rect) {
        let Some((_, id)) = &self.target else { return };
        let whole = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        ui.painter().image(*id, area, whole, Color32::WHITE);
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
    pub(super) fn look(&mut self, ui: &Ui, response: &Response, area: Rect, can_go_round: bool) {
        let (drag, wheel, is_shift) =
            ui.input(|input| (response.drag_delta(), input.smooth_scroll_delta().y, input.modifiers.shift));
        let is_moved = response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Middle)
            || (response.dragged_by(PointerButton::Primary) && is_shift);
        if is_moved {
            self.shift(drag, area);
        } else if response.dragged_by(PointerButton::Primary) && can_go_round {
            self.orbit.azimuth -= drag.x / ROUND_POINTS * std::f32::consts::TAU;
            let steep = self.orbit.elevation + drag.y / ROUND_POINTS * std::f32::consts::TAU;
            self.orbit.elevation = steep.clamp(-1.5, 1.5);
        }
        if response.hovered() && wheel.abs() > 0.0 {
            self.orbit.zoom((-wheel / DOUBLE_POINTS).exp2());
        }
        self.settle();
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
