//! What is turned of a forest: its wind, by its words, winds put into it, damping and mass.

use eframe::egui::{Slider, Ui};
use honami_mechanics::Damping;
use honami_scene::ForestScene;
use honami_scene::weather::{value, with_value};

/// What of a wind has a slider: its name, what it is, and from where to where.
const VALUES: [(&str, &str, std::ops::RangeInclusive<f64>); 3] = [
    ("speed", "speed, m/s", 0.5..=40.0),
    ("towards", "towards, °", -180.0..=180.0),
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
struct Planted {
    kind: &'static str,
    at: [f32; 2],
    strength: f64,
}

/// What was turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Turned {
    pub(super) wind: bool,
    pub(super) damping: bool,
}

/// All knobs.
#[derive(Clone, Debug)]
pub(super) struct Knobs {
    /// The wind, as it is typed.
    wind: String,
    /// What is being typed.
    typed: String,
    planted: Vec<Planted>,
    /// What the next click puts.
    pub(super) planting: Option<&'static str>,
    pub(super) damping: Damping,
}

impl Knobs {
    pub(super) fn new(scene: &ForestScene) -> Self {
        let (wind, damping) = (scene.wind.clone(), scene.pace.damping);
        Self { typed: wind.clone(), wind, planted: Vec::new(), planting: None, damping }
    }

    /// Another wind, as it is typed.
    pub(super) fn type_wind(&mut self, words: &str) {
        words.clone_into(&mut self.wind);
        words.clone_into(&mut self.typed);
    }

    /// All that blows, as it is typed.
    pub(super) fn words(&self) -> String {
        let planted = self.planted.iter().map(|Planted { kind, at: [x, y], strength }| {
            format!("{kind}:strength={strength:.1},x={x:.2},y={y:.2}")
        });
        std::iter::once(self.wind.clone()).chain(planted).collect::<Vec<_>>().join("+")
    }

    /// Puts what was chosen where somebody has clicked; whether anything was.
    pub(super) fn put(&mut self, at: [f32; 2]) -> bool {
        let Some(kind) = self.planting.take() else { return false };
        self.planted.push(Planted { kind, at, strength: STRENGTH });
        true
    }

    /// Returns what was turned.
    pub(super) fn show(&mut self, ui: &mut Ui) -> Turned {
        let mut turned = Turned::default();
        ui.spacing_mut().slider_width = SLIDER;
        ui.strong("wind");
        let field = ui.text_edit_singleline(&mut self.typed);
        if field.lost_focus() && self.typed.trim() != self.wind {
            self.wind = self.typed.trim().to_owned();
            turned.wind = true;
        }
        for (name, told, range) in VALUES {
            let Some(mut now) = value(&self.wind, name) else { continue };
            if ui.add(Slider::new(&mut now, range).text(told)).changed()
                && let Some(words) = with_value(&self.wind, name, now)
            {
                self.type_wind(&words);
                turned.wind = true;
            }
        }
        turned.wind |= self.plant(ui);
        ui.separator();
        ui.strong("plants");
        let Damping { alpha, beta, mass, air } = &mut self.damping;
        let sliders = [
            Slider::new(alpha, 0.0..=5.0).text("α, by mass, 1/s"),
            Slider::new(beta, 0.0..=0.1).text("β, by stiffness"),
            Slider::new(mass, 0.2..=10.0).text("m, times").logarithmic(true),
            Slider::new(air, 0.0..=5.0).text("air, times"),
        ];
        for slider in sliders {
            turned.damping |= ui.add(slider).changed();
        }
        turned
    }

    /// Winds that are put by clicks; whether any was changed.
    fn plant(&mut self, ui: &mut Ui) -> bool {
        ui.horizontal(|ui| {
            for kind in KINDS {
                let is_chosen = self.planting == Some(kind);
                if ui.selectable_label(is_chosen, kind).clicked() {
                    self.planting = (!is_chosen).then_some(kind);
                }
            }
            ui.label(if self.planting.is_some() { "click on the ground" } else { "to be put" });
        });
        let (mut is_changed, mut gone) = (false, None);
        for (row, planted) in self.planted.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                if ui.small_button("×").clicked() {
                    gone = Some(row);
                }
                let [x, y] = planted.at;
                let slider = Slider::new(&mut planted.strength, 0.0..=2000.0);
                is_changed |= ui.add(slider.text(format!("{} {x:.0}, {y:.0}", planted.kind))).changed();
            });
        }
        if let Some(row) = gone {
            self.planted.remove(row);
        }
        is_changed || gone.is_some()
    }
}

#[cfg(test)]
mod tests {
    //! Words of knobs, which the wind reads.

    use super::{Knobs, STRENGTH};
    use honami_scene::weather::{Ground, read};

    #[test]
    fn what_is_put_blows_beside_the_wind() {
        let damping = honami_mechanics::Damping::default();
        let mut knobs = Knobs {
            wind: "storm".to_owned(),
            typed: String::new(),
            planted: vec![],
            planting: None,
            damping,
        };
        assert!(!knobs.put([1.0, 2.0]), "nothing was chosen");
        knobs.planting = Some("vortex");
        assert!(knobs.put([1.0, -2.5]) && knobs.planting.is_none());
        assert_eq!(knobs.words(), format!("storm+vortex:strength={STRENGTH:.1},x=1.00,y=-2.50"));
        read(&knobs.words()).unwrap().over(&Ground::new(vec![], 1.0, 1 << 20)).unwrap();
        knobs.type_wind("steady:speed=3");
        assert!(knobs.words().starts_with("steady:speed=3+vortex:"));
    }
}
