//! How long it is from picture to picture: the last of them as a curve.

use std::collections::VecDeque;

use eframe::egui::{self, Color32, Sense, Stroke, Ui, pos2, vec2};

/// So many pictures.
const N: usize = 240;
/// A frame of a screen of 60 hertz, seconds: drawn as a line.
const OF_SCREEN: f64 = 1.0 / 60.0;

/// Times between pictures while it plays, seconds.
#[derive(Debug, Default)]
pub(super) struct Stopwatch {
    times: VecDeque<f64>,
    /// Whether it played when the last picture came.
    is_running: bool,
}

impl Stopwatch {
    /// Another picture came after so many seconds. Returns how many of them it played: none before the first picture after a
    /// pause, whose time it was.
    pub(super) fn tick(&mut self, is_playing: bool, seconds: f64) -> f64 {
        if !std::mem::replace(&mut self.is_running, is_playing) || !is_playing {
            return 0.0;
        }
        if self.times.len() == N {
            self.times.pop_front();
        }
        self.times.push_back(seconds);
        seconds
    }

    /// Median and longest; none before the first.
    fn summary(&self) -> Option<[f64; 2]> {
        let mut sorted: Vec<f64> = self.times.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        Some([*sorted.get(sorted.len() / 2)?, *sorted.last()?])
    }

    pub(super) fn show(&self, ui: &mut Ui) {
        let Some([median, longest]) = self.summary() else { return };
        ui.label(format!(
            "{:.1} ms to the next picture, {:.0} a second; {:.0} ms at most",
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
            self.times.iter().enumerate().map(|(k, seconds)| pos2(across(k), height(*seconds))).collect();
        painter.line(points, Stroke::new(1.5, Color32::from_rgb(130, 200, 120)));
    }
}

#[cfg(test)]
mod tests {
    use super::{N, Stopwatch};

    #[test]
    fn the_last_pictures_are_told() {
        let mut stopwatch = Stopwatch::default();
        assert_eq!((stopwatch.tick(true, 3.0), stopwatch.summary()), (0.0, None), "nothing was before");
        stopwatch.tick(true, 9.0);
        for k in 0..N {
            stopwatch.tick(true, if k % 2 == 0 { 0.25 } else { 0.5 });
        }
        assert_eq!(stopwatch.summary(), Some([0.5, 0.5]), "the first has gone");
    }

    /// Whether it plays, seconds since the last picture, and how many of them it played.
    #[test]
    fn a_pause_is_no_time_between_pictures() {
        let mut stopwatch = Stopwatch::default();
        for (is_playing, seconds, played) in [
            (true, 1.0, 0.0),
            (true, 0.02, 0.02),
            (false, 0.02, 0.0),
            (false, 5.0, 0.0),
            (true, 30.0, 0.0),
            (true, 0.03, 0.03),
        ] {
            assert!((stopwatch.tick(is_playing, seconds) - played).abs() < 1e-12, "{is_playing} {seconds}");
        }
        assert_eq!(stopwatch.summary(), Some([0.03, 0.03]));
    }
}
