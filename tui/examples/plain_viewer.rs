//! The peer of `cargo xtask wan`: the same picture drawn by ratatui's own backend, every key one draw.
//!
//! `plain_viewer CLIP`: `.` and `,` step, `q` quits.

use std::path::PathBuf;

use anyhow::Context as _;
use honami_workbench::media::{self, FrameRef, OpenOptions, Rect};
use ratatui::crossterm::event::{self, Event, KeyCode};
use ratatui::style::Color;
use ratatui::text::Line;

fn main() -> anyhow::Result<()> {
    let clip = std::env::args_os().nth(1).map(PathBuf::from).context("a clip is wanted")?;
    let media = media::open(&clip, &OpenOptions::default())?;
    let (clip, mut n) = (media.clip(), 0);
    let last = clip.n_frames() - 1;
    let mut terminal = ratatui::init();
    loop {
        let picture = media.frame(n)?;
        terminal.draw(|frame| {
            let area = frame.area();
            frame.buffer_mut().set_line(0, 0, &Line::raw("plain"), area.width);
            draw(&picture, (clip.width, clip.height), frame.buffer_mut());
            let line = Line::raw(format!("{n}/{last}  {:.2} s", clip.times.get(n).unwrap_or_default()));
            frame.buffer_mut().set_line(0, area.height - 1, &line, area.width);
        })?;
        n = loop {
            match event::read()? {
                Event::Key(key) if key.code == KeyCode::Char('.') => break (n + 1).min(last),
                Event::Key(key) if key.code == KeyCode::Char(',') => break n.saturating_sub(1),
                Event::Key(key) if key.code == KeyCode::Char('q') => {
                    ratatui::restore();
                    return Ok(());
                }
                Event::Resize(..) => break n,
                _ => {}
            }
        };
    }
}

/// All of the picture in half blocks, where honami has it: below one line and above three.
fn draw(picture: &FrameRef, (width, height): (u32, u32), cells: &mut ratatui::buffer::Buffer) {
    let (room_x, room_y) = (cells.area.width, cells.area.height.saturating_sub(4));
    let (width_px, height_px) = (f64::from(width), f64::from(height));
    let scale = (width_px / f64::from(room_x)).max(height_px / f64::from(2 * room_y));
    let columns = ((width_px / scale).round() as u16).min(room_x);
    let rows = ((height_px / scale / 2.0).round() as u16).min(room_y);
    let pixels = picture.rgb_area(Rect::whole(width, height), columns.into(), (2 * rows).into());
    let rgb = |[r, g, b]: [u8; 3]| Color::Rgb(r, g, b);
    let (left, top) = ((room_x - columns) / 2, 1 + (room_y - rows) / 2);
    for y in 0..rows {
        for x in 0..columns {
            let above = 2 * usize::from(y) * usize::from(columns) + usize::from(x);
            let cell = &mut cells[(left + x, top + y)];
            cell.set_symbol("▀").set_fg(rgb(pixels[above])).set_bg(rgb(pixels[above + usize::from(columns)]));
        }
    }
}
