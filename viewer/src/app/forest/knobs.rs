//! What is turned of a forest: its wind, by its words, winds put into it, damping and mass.

#[cfg(test)]
mod tests;

use eframe::egui::{Slider, SliderClamping, Ui};
use honami_mechanics::Damping;
use honami_scene::ForestScene;
use honami_scene::weather::{Typed, WeatherError, read, value, with_value};

/// A direction: whole turns of it are the same.
const TOWARDS: &str = "towards";
/// What of a wind has a slider: its name, what it is, and from where to where.
const VALUES: [(&str, &str, std::ops::RangeInclusive<f64>); 3] = [
    ("speed", "speed, m/s", 0.5..=40.0),
    (TOWARDS, "towards, °", -180.0..=180.0),
    ("deviation", "gusts, m/s", 0.0..=10.0),
];
/// Width of a slider, points: with its number and its word it goes into the panel.
const SLIDER: f32 = 84.0;
/// Winds about an upright axis that can be put where somebody clicks.
const KINDS: [&str; 3] = ["vortex", "source", "sink"];
/// Their strength at first, square metres per second.
const STRENGTH: f64 = 200.0;

/// A wind about an axis.
#[derive(Clone, Debug, PartialEq)]
struct Put {
    kind: &'static str,
    at: [f32; 2],
    strength: f64,
}

/// All that blows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Winds {
    /// As it is typed.
    words: String,
    /// By clicks.
    put: Vec<Put>,
}

impl Winds {
    pub(super) fn typed(words: &str) -> Self {
        Self { words: words.to_owned(), put: Vec::new() }
    }

    /// What was put stands before what was typed, which may carry what follows it: a vortex stays where it was put.
    ///
    /// # Errors
    /// [`WeatherError`].
    pub(super) fn read(&self) -> Result<Typed, WeatherError> {
        let typed = read(&self.words)?;
        let words = |Put { kind, at: [x, y], strength }: &Put| {
            format!("{kind}:strength={strength:.1},x={x:.2},y={y:.2}")
        };
        let put: Vec<String> = self.put.iter().map(words).collect();
        if put.is_empty() { Ok(typed) } else { Ok(read(&put.join("+"))?.and(typed)) }
    }
}

/// What was turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Turned {
    /// Another wind was typed, which begins now,
    pub(super) typed: bool,
    /// or values of the one that blows were turned, or winds were put.
    pub(super) wind: bool,
    pub(super) damping: bool,
}

/// All knobs.
#[derive(Clone, Debug)]
pub(super) struct Knobs {
    pub(super) winds: Winds,
    pub(super) damping: Damping,
    /// What blows, and how it is damped: what is refused goes back to it.
    held: (Winds, Damping),
    /// What is being typed.
    field: String,
    /// What the next click puts.
    pub(super) putting: Option<&'static str>,
}

impl Knobs {
    pub(super) fn new(scene: &ForestScene) -> Self {
        let (winds, damping) = (Winds::typed(&scene.wind), scene.pace.damping);
        let held = (winds.clone(), damping);
        Self { winds, damping, held, field: scene.wind.clone(), putting: None }
    }

    /// Another wind, as it is typed.
    pub(super) fn type_wind(&mut self, words: &str) {
        words.clone_into(&mut self.winds.words);
        words.clone_into(&mut self.field);
    }

    /// These winds blow.
    pub(super) fn hold(&mut self, winds: Winds) {
        self.held.0 = winds;
    }

    /// It is damped so.
    pub(super) fn hold_damping(&mut self) {
        self.held.1 = self.damping;
    }

    /// Back to the winds that blow: what was refused stays in the field alone.
    pub(super) fn refuse(&mut self) {
        self.winds = self.held.0.clone();
    }

    /// Back to the damping that holds.
    pub(super) fn refuse_damping(&mut self) {
        self.damping = self.held.1;
    }

    /// Puts what was chosen where somebody has clicked; whether anything was.
    pub(super) fn put(&mut self, at: [f32; 2]) -> bool {
        let Some(kind) = self.putting.take() else { return false };
        self.winds.put.push(Put { kind, at, strength: STRENGTH });
        true
    }

    /// Returns what was turned.
    pub(super) fn show(&mut self, ui: &mut Ui) -> Turned {
        let mut turned = Turned::default();
        ui.spacing_mut().slider_width = SLIDER;
        ui.strong("wind");
        let field = ui.text_edit_singleline(&mut self.field);
        if field.lost_focus() && self.field.trim() != self.winds.words {
            self.winds.words = self.field.trim().to_owned();
            turned.typed = true;
        }
        for (name, told, range) in VALUES {
            let Some(mut now) = value(&self.winds.words, name) else { continue };
            if name == TOWARDS {
                now = half_turns(now);
            }
            if ui.add(slider(&mut now, range).text(told)).changed()
                && let Some(words) = with_value(&self.winds.words, name, now)
            {
                self.type_wind(&words);
                turned.wind = true;
            }
        }
        turned.wind |= self.puts(ui);
        ui.separator();
        ui.strong("plants");
        let Damping { alpha, beta, mass, air } = &mut self.damping;
        let sliders = [
            slider(alpha, 0.0..=5.0).text("α, by mass, 1/s"),
            slider(beta, 0.0..=0.1).text("β, by stiffness"),
            slider(mass, 0.2..=10.0).text("m, times").logarithmic(true),
            slider(air, 0.0..=5.0).text("air, times"),
        ];
        for slider in sliders {
            turned.damping |= ui.add(slider).changed();
        }
        turned
    }

    /// Winds that are put by clicks; whether any was changed.
    fn puts(&mut self, ui: &mut Ui) -> bool {
        ui.horizontal(|ui| {
            for kind in KINDS {
                let is_chosen = self.putting == Some(kind);
                if ui.selectable_label(is_chosen, kind).clicked() {
                    self.putting = (!is_chosen).then_some(kind);
                }
            }
            ui.label(if self.putting.is_some() { "click on the ground" } else { "to be put" });
        });
        let (mut is_changed, mut gone) = (false, None);
        for (row, Put { kind, at: [x, y], strength }) in self.winds.put.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                if ui.small_button("×").clicked() {
                    gone = Some(row);
                }
                let slider = slider(strength, 0.0..=2000.0).text(format!("{kind} {x:.0}, {y:.0}"));
                is_changed |= ui.add(slider).changed();
            });
        }
        if let Some(row) = gone {
            self.winds.put.remove(row);
        }
        is_changed || gone.is_some()
    }
}

/// A slider that leaves what lies beyond it as it is until it is touched.
fn slider(value: &mut f64, range: std::ops::RangeInclusive<f64>) -> Slider<'_> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
}

/// The same direction from -180° to 180°.
fn half_turns(degrees: f64) -> f64 {
    if degrees.abs() <= 180.0 { degrees } else { (degrees + 180.0).rem_euclid(360.0) - 180.0 }
}
