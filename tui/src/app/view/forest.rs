//! A forest as cells: the picture, what blows, and what keys do.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{lines, menu, picture as pictures, put, style};
use crate::app::forest::{Forest, Shot};
use crate::term::encode::Frame;

/// Hints that give way first.
const LATER: [&str; 3] = ["step", "front", "finer"];

/// The whole screen.
#[must_use]
pub fn draw(forest: &Forest, is_mono: bool) -> Frame {
    let (columns, rows) = forest.size;
    let mut frame = Frame::new(columns, rows);
    let all = Rect::new(0, 0, columns, rows);
    let area = picture(forest);
    let grid = forest.shown_glyphs(is_mono).grid();
    let size = [grid.0 * u32::from(area.width), grid.1 * u32::from(area.height)];
    match forest.shot.as_ref().filter(|shot| shot.size == size) {
        Some(shot) => pictures::paint_pixels(area, grid, &shot.pixels, None, &mut frame),
        None => put(
            &mut frame,
            area,
            area.height / 2,
            &Line::styled("going on for a while …", style::DIM).centered(),
        ),
    }
    match &forest.menu {
        Some(open) => menu::draw(open, area, &mut frame),
        None if forest.pending.is_empty() => {}
        None => menu::which_key((&forest.keys, forest.context()), &forest.pending, area, &mut frame),
    }
    let title = vec![
        Span::styled(forest.name.clone(), style::BOLD),
        Span::styled(format!("  {}", forest.told), style::DIM),
    ];
    put(&mut frame, all, 0, &Line::from(title));
    if let Some(shot) = &forest.shot {
        let clock = match forest.is_playing {
            true => format!("{:.1} s", shot.time),
            false => format!("paused at {:.2} s", shot.time),
        };
        put(&mut frame, all, 0, &Line::styled(clock, style::DIM).right_aligned());
    }
    if rows > 2 {
        let line = match (&forest.typed, &forest.complaint) {
            (Some(typed), _) => Line::from(vec![
                Span::styled("other wind: ", style::ACCENT),
                Span::raw(typed.clone()),
                Span::styled("▏", style::ACCENT),
                Span::styled(format!("  now {}", forest.wind), style::DIM),
            ]),
            (None, Some(complaint)) => Line::styled(complaint.clone(), style::ERROR),
            (None, None) => Line::from(blowing(forest)),
        };
        put(&mut frame, Rect { y: rows - 2, height: 1, ..all }, 0, &line);
    }
    if rows > 1 {
        let room = usize::from(columns).saturating_sub(2);
        let hints = lines::own_hints(&forest.keys, forest.context(), &LATER, room);
        lines::put_right(&mut frame, Rect { y: rows - 1, height: 1, ..all }, &hints, 0);
    }
    if let Some(theme) = &forest.theme {
        theme.paint(&mut frame);
    }
    frame
}

/// The row of the open list that lies in a row of the screen.
#[must_use]
pub fn row_at(forest: &Forest, row: u16) -> Option<usize> {
    menu::row_at(forest.menu.as_ref()?, picture(forest), row)
}

/// Where the picture is.
#[must_use]
pub fn picture(forest: &Forest) -> Rect {
    let (columns, rows) = forest.size;
    Rect::new(0, 1.min(rows), columns, rows.saturating_sub(3))
}

/// The wind as typed, and how it blows where the first plant stands: which way, as on a compass whose north is up the screen.
fn blowing(forest: &Forest) -> Vec<Span<'static>> {
    let mut spans = vec![Span::styled(forest.wind.clone(), style::ACCENT)];
    let Some(Shot { wind: [x, y, _], .. }) = forest.shot else { return spans };
    let speed = x.hypot(y);
    let arrows = ["→", "↗", "↑", "↖", "←", "↙", "↓", "↘"];
    let seen = y.atan2(x) - f64::from(forest.orbit.azimuth);
    let eighth = (seen / std::f64::consts::FRAC_PI_4).round().rem_euclid(8.0) as usize;
    let arrow = if speed < 0.05 { "·" } else { arrows[eighth % 8] };
    let told = format!("  {arrow} {speed:4.1} m/s, seen from {:.0}°", forest.orbit.azimuth.to_degrees());
    spans.push(Span::styled(told, style::DIM));
    spans
}
