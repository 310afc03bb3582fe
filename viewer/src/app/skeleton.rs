//! What is shown of a skeleton and what is done to it: its parts, its bones, the bone that is shaped, its root, its cut.

use eframe::egui::{self, Button, Slider, Ui};
use honami_model::shape::{MOST_GAIN, Shape};
use honami_scene::SkeletonScene;
use honami_scene::control::{Chosen, Event};

use crate::skeleton::{Part, SkeletonPicture};

/// More groups than this nobody cuts by a slider.
const MOST_GROUPS: u32 = 64;

/// A skeleton that is worked on, and the panel beside it.
pub(super) struct SkeletonPanel {
    /// As it is drawn: with what is being done.
    pub(super) picture: SkeletonPicture,
    /// As it was told.
    kept: SkeletonScene,
    /// The bone that is being shaped, and how it is to be.
    pub(super) shaping: Option<(u32, Shape)>,
    /// Whether the next click places the root.
    pub(super) is_rooting: bool,
    /// The cut that the slider shows.
    cut: u32,
}

impl SkeletonPanel {
    pub(super) fn new(picture: SkeletonPicture) -> Self {
        let kept = picture.scene.clone();
        let cut = kept.n_groups;
        Self { picture, kept, shaping: None, is_rooting: false, cut }
    }

    /// Another skeleton takes its place.
    pub(super) fn take(&mut self, scene: SkeletonScene) {
        self.kept = scene.clone();
        self.cut = scene.n_groups;
        self.shaping = None;
        self.picture.take(scene);
    }

    /// What was begun is not done.
    pub(super) fn let_be(&mut self) {
        if self.shaping.take().is_some() {
            self.picture.take(self.kept.clone());
        }
        self.is_rooting = false;
        self.cut = self.kept.n_groups;
    }

    /// Chooses something; what was being shaped is as it was.
    pub(super) fn choose(&mut self, chosen: Option<Chosen>) {
        if self.picture.chosen != chosen {
            self.let_be();
            self.picture.chosen = chosen;
        }
    }

    /// What keeps what is being shaped, if anything is.
    pub(super) fn keep(&mut self) -> Option<Event> {
        let (node, shape) = self.shaping?;
        Some(Event::Shape {
            node,
            plane_deg: shape.plane_rad.to_degrees(),
            lean_deg: shape.lean_rad.to_degrees(),
            gain: shape.gain,
        })
    }

    /// Whether what hands do here is taken.
    pub(super) fn is_open(&self) -> bool {
        self.kept.shut.is_none()
    }

    /// The panel beside the picture; returns what is to be told.
    pub(super) fn show(&mut self, ui: &mut Ui) -> Vec<Event> {
        let mut events = Vec::new();
        ui.heading(&self.kept.name);
        for why in self.picture.without_clip.iter().chain(&self.picture.why_empty()) {
            ui.label(why);
        }
        ui.separator();
        self.parts(ui);
        ui.separator();
        if let Some(why) = &self.kept.shut {
            ui.label(format!("It is only looked at: {why}."));
        }
        let is_open = self.is_open();
        ui.add_enabled_ui(is_open, |ui| self.whole(ui, &mut events));
        ui.separator();
        self.bones(ui, &mut events);
        events
    }

    fn parts(&mut self, ui: &mut Ui) {
        egui::Grid::new("parts").num_columns(2).show(ui, |ui| {
            for (k, part) in Part::ALL.into_iter().enumerate() {
                let mut is_shown = self.picture.parts.contains(&part);
                if ui.checkbox(&mut is_shown, part.name()).changed() {
                    match is_shown {
                        true => self.picture.parts.insert(part),
                        false => self.picture.parts.remove(&part),
                    };
                }
                if k % 2 == 1 {
                    ui.end_row();
                }
            }
        });
    }

    /// What is done to all of it.
    fn whole(&mut self, ui: &mut Ui, events: &mut Vec<Event>) {
        ui.horizontal(|ui| {
            let word = if self.is_rooting { "click where it leaves the ground" } else { "place the root" };
            if ui.add(Button::new(word).selected(self.is_rooting)).clicked() {
                self.is_rooting = !self.is_rooting;
            }
            if self.kept.is_placed && ui.button("as it grows").clicked() {
                events.push(Event::Root(None));
            }
        });
        let most = self.kept.most_groups.min(MOST_GROUPS).max(self.cut);
        let cut = ui.add(Slider::new(&mut self.cut, 1..=most.max(1)).text("groups"));
        if (cut.drag_stopped() || cut.lost_focus()) && self.cut != self.kept.n_groups {
            events.push(Event::Cut(self.cut));
        }
        ui.horizontal(|ui| {
            if ui.button("undo (u)").clicked() {
                events.push(Event::Undo);
            }
            if ui.button("redo (Ctrl-R)").clicked() {
                events.push(Event::Redo);
            }
        });
    }

    fn bones(&mut self, ui: &mut Ui, events: &mut Vec<Event>) {
        let chosen = self.node();
        if let Some(node) = chosen {
            self.shape(ui, node, events);
            ui.separator();
        }
        let mut clicked = None;
        egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            let mut levels: Vec<usize> = Vec::with_capacity(self.kept.joints.len());
            for joint in &self.kept.joints {
                let level = joint.parent.map_or(0, |parent| levels[parent as usize] + 1);
                levels.push(level);
                let Some(bone) = joint.bone.filter(|_| joint.copy_of.is_none()) else { continue };
                let shape = bone.shape().to_string();
                let text = format!("{}{}  {shape}", "  ".repeat(level.saturating_sub(1)), joint.name);
                if ui.selectable_label(chosen == Some(bone.node), text).clicked() {
                    clicked = Some(bone.node);
                }
            }
        });
        if let Some(node) = clicked {
            self.choose(Some(Chosen::Bone(node)));
            events.push(Event::Selected(self.picture.chosen));
        }
    }

    /// The node of the chosen bone, where there is such a bone.
    pub(super) fn node(&self) -> Option<u32> {
        match self.picture.chosen {
            Some(Chosen::Bone(node)) if self.kept.row_of(node).is_some() => Some(node),
            _ => None,
        }
    }

    fn shape(&mut self, ui: &mut Ui, node: u32, events: &mut Vec<Event>) {
        let Some(row) = self.kept.row_of(node) else { return };
        let joint = &self.kept.joints[row];
        let kept = joint.bone.map_or_else(Shape::default, |bone| bone.shape());
        ui.strong(&joint.name);
        let mut shape = self.shaping.filter(|(of, _)| *of == node).map_or(kept, |(_, shape)| shape);
        let before = shape;
        let is_open = self.is_open();
        ui.add_enabled_ui(is_open, |ui| {
            // Sliders round what they show: what nobody moves stays as it is.
            let (mut plane, mut lean) = (shape.plane_rad.to_degrees(), shape.lean_rad.to_degrees());
            let mut gain = shape.gain;
            if ui.add(degrees(&mut plane).text("plane")).changed() {
                shape.plane_rad = plane.to_radians();
            }
            if ui.add(degrees(&mut lean).text("lean")).changed() {
                shape.lean_rad = lean.to_radians();
            }
            if ui.add(Slider::new(&mut gain, 0.0..=MOST_GAIN).text("gain").fixed_decimals(2)).changed() {
                shape.gain = gain;
            }
            ui.horizontal(|ui| {
                if ui.add_enabled(self.shaping.is_some(), Button::new("keep (Enter)")).clicked() {
                    events.extend(self.keep());
                }
                if ui.add_enabled(self.shaping.is_some(), Button::new("let be (Esc)")).clicked() {
                    shape = kept;
                }
                if ui.add_enabled(!shape.is_grown(), Button::new("as it grows")).clicked() {
                    shape = Shape::default();
                }
            });
        });
        if shape != before {
            self.preview(node, shape, kept, events);
        }
    }

    /// Shows a bone as it would be.
    fn preview(&mut self, node: u32, shape: Shape, kept: Shape, events: &mut Vec<Event>) {
        let mut scene = self.kept.clone();
        match scene.reshape(&[(node, shape)]) {
            Ok(()) => {
                self.picture.take(scene);
                self.shaping = (shape != kept).then_some((node, shape));
            }
            Err(why) => events.push(Event::Failed(why.to_string())),
        }
    }
}

/// A turn.
fn degrees(value: &mut f64) -> Slider<'_> {
    Slider::new(value, -180.0..=180.0).suffix("°").fixed_decimals(1)
}
