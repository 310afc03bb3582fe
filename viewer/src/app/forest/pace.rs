//! How long pictures take: the last of them as a curve.

use std::collections::VecDeque;

use eframe::egui::{self, Color32, Sense, Stroke, Ui, pos2, vec2};

/// So many pictures.
const N: usize = 240;
/// A frame of a screen of 60 hertz, seconds: drawn as a line.
const OF_SCREEN: f64 = 1.0 / 60.0;

/// Times between pictures, seconds.
#[derive(Debug, Default)]
pub(super) struct Pace(VecDeque<f64>);

impl Pace {
    /// Another picture came after so many seconds.
    pub(super) fn took(&mut self, seconds: f64) {
        if self.0.len() == N {
            self.0.pop_front();
        }
        self.0.push_back(seconds);
    }

    /// Median and longest; none before the first.
    fn summary(&self) -> Option<[f64; 2]> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        Some([*sorted.get(sorted.len() / 2)?, *sorted.last()?])
    }

    pub(super) fn show(&self, ui: &mut Ui) {
        let Some([median, longest]) = self.summary() else { return };
        ui.label(format!(
            "{:.1} ms a picture, {:.0} a second; {:.0} ms at most",
            median * 1e3,
            1.0 / median.max(1e-6),
            longest * 1e3
        ));
        let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), 48.0), Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 2.0, Color32::from_gray(24));
        let most = (1.2 * longest).max(2.0 * OF_SCREEN);
        let height = |seconds: f64| area.bottom() - (seconds / most) as f32 * area.height();
        let line = [pos2(area.left(), height(OF_SCREEN)), pos2(area.right(), height(OF_SCREEN))];
        painter.line_segment(line, Stroke::new(1.0, Color32::from_gray(80)));
        let across = |k: usize| area.left() + area.width() * k as f32 / (N - 1) as f32;
        let points: Vec<egui::Pos2> =
            self.0.iter().enumerate().map(|(k, seconds)| pos2(across(k), height(*seconds))).collect();
        painter.line(points, Stroke::new(1.5, Color32::from_rgb(130, 200, 120)));
    }
}

#[cfg(test)]
mod tests {
    use super::{N, Pace};

    #[test]
    fn the_last_pictures_are_told() {
        let mut pace = Pace::default();
        assert_eq!(pace.summary(), None);
        pace.took(9.0);
        (0..N).for_each(|k| pace.took(if k % 2 == 0 { 0.25 } else { 0.5 }));
        assert_eq!(pace.summary(), Some([0.5, 0.5]), "the first has gone");
    }
}
