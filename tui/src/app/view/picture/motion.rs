//! Colours of motion on the picture, and the wheel that explains them: legend and dial in one.

use std::hash::Hash as _;

use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::Line;

use honami_workbench::overlay::{
    Dial, Disc, VelocityField, disc_radius, over, paint_discs, paint_field, velocity,
};

use super::Canvas;
use crate::app::state::{Mode, State};
use crate::app::view::{fill, put, style};
use crate::term::encode::{Frame, HALF_BLOCK};

/// Cells of the wheel, across and down; its pixels are half as high.
const WHEEL: (u16, u16) = (13, 7);
/// What the wheel lies on.
const GROUND: [u8; 3] = [38, 38, 38];
/// Directions that the dial leaves out.
const OFF: [u8; 3] = [70, 70, 70];

impl Canvas<'_> {
    /// Colours the surroundings of every track by its velocity, or every pixel where that is known.
    pub(super) fn motion(&mut self, state: &State, frame: u32) {
        if !state.motion.is_on || self.letters.is_some() {
            return;
        }
        if let Some(dense) = &state.dense {
            return dense.field.iter().for_each(|(of, field)| self.dense(state, *of, field));
        }
        let (columns, rows) = self.lens.size();
        let across = f64::from(columns) / self.lens.width;
        let down = f64::from(rows) / self.lens.height;
        let mapping = state.motion.mapping();
        let disc = |row: &crate::app::tracks::TrackRow| {
            let [x, y] = row.at(frame)?.map(f64::from);
            let at = [(x - self.lens.x) * across - 0.5, (y - self.lens.y) * down - 0.5];
            let tint = mapping.tint(velocity(&row.span, &state.clip.times, frame)?)?;
            Some(Disc { at, tint })
        };
        let discs: Vec<Disc> = state.tracks.iter().filter_map(disc).collect();
        for disc in &discs {
            (disc.at.map(f64::to_bits), disc.tint.rgb).hash(&mut self.scene);
        }
        let is_seen = |row: &&crate::app::tracks::TrackRow| {
            row.at(frame).is_some_and(|at| self.lens.pixel_of(at).is_some())
        };
        // As dense as the tracks are, moving or not; half blocks are about square.
        let n_seen = state.tracks.iter().filter(is_seen).count();
        let area = usize::from(self.lens.area.width) * 2 * usize::from(self.lens.area.height);
        let radius = disc_radius(n_seen, area);
        let (x, y) = self.lens.grid;
        let radius = [radius * f64::from(x), radius * f64::from(y) / 2.0];
        paint_discs(&mut self.pixels, columns as usize, &discs, radius);
    }

    fn dense(&mut self, state: &State, of: u32, field: &VelocityField) {
        let mapping = state.motion.mapping();
        let Dial { centre_rad, half_width_rad } = mapping.dial;
        (of, [mapping.gain_s_px, centre_rad, half_width_rad].map(f64::to_bits)).hash(&mut self.scene);
        let (columns, rows) = self.lens.size();
        let lens = self.lens;
        let side = [lens.width / f64::from(columns), lens.height / f64::from(rows)];
        let image_of = |[x, y]: [f64; 2]| [lens.x + (x + 0.5) * side[0], lens.y + (y + 0.5) * side[1]];
        paint_field(&mut self.pixels, columns as usize, field, &mapping, image_of);
    }
}

/// The wheel in the upper right corner: each direction in its colour, brighter with speed; below it the speed of its
/// rim, and the directions that are shown.
pub(in crate::app::view) fn legend(state: &State, area: Rect, frame: &mut Frame) {
    let speed = state.motion.full_px_s();
    let fps = state.clip.times.nominal_fps();
    let digits = |x: f64| if x < 10.0 { 1 } else { 0 };
    let mut lines = vec![format!("rim {speed:.*} px/s", digits(speed))];
    lines.extend(fps.map(|fps| format!("= {:.*} px/frame", digits(speed / fps), speed / fps)));
    lines.extend(state.dense.as_ref().map(|dense| match dense.field {
        Some(_) => format!("dense by {}", dense.plugin),
        None => "measuring …".to_owned(),
    }));
    lines.extend(state.motion.dial_words());
    let (width, height) = (WHEEL.0 + 4, WHEEL.1 + lines.len() as u16);
    if !state.motion.is_on || state.mono || area.width < 2 * width || area.height < height + 2 {
        return;
    }
    let corner = Rect { x: area.right() - width, y: area.y, width, height };
    fill(frame, corner, style::PANEL);
    for row in 0..WHEEL.1 {
        for column in 0..WHEEL.0 {
            let colour = |y: u16| {
                let [r, g, b] = wheel_pixel(state, column, y);
                Color::Rgb(r, g, b)
            };
            let i = frame.cells.index_of(corner.x + 2 + column, corner.y + row);
            let style = Style::new().fg(colour(2 * row)).bg(colour(2 * row + 1));
            frame.cells.content[i].set_symbol(HALF_BLOCK).set_style(style);
        }
    }
    for (row, line) in (WHEEL.1..).zip(lines) {
        let is_dial = row == height - 1 && matches!(state.mode, Mode::Dial(_));
        let style = if is_dial { style::ACCENT } else { style::DIM };
        put(frame, Rect { x: corner.x + 1, ..corner }, row, &Line::styled(line, style));
    }
}

/// A pixel of the wheel: the colour of the velocity that points there from the middle.
fn wheel_pixel(state: &State, column: u16, row: u16) -> [u8; 3] {
    let radius = f64::from(WHEEL.0) / 2.0;
    let middle = [f64::from(WHEEL.0 - 1) / 2.0, f64::from(2 * WHEEL.1 - 1) / 2.0];
    let apart = [(f64::from(column) - middle[0]) / radius, (f64::from(row) - middle[1]) / radius];
    let part = apart[0].hypot(apart[1]);
    if part > 1.0 {
        return GROUND;
    }
    let velocity = apart.map(|a| a * state.motion.full_px_s());
    match state.motion.mapping().tint(velocity) {
        Some(tint) => over(GROUND, tint),
        None if part > 0.0 => OFF,
        None => GROUND,
    }
}
