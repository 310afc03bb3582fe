//! The start screen as cells.

use ratatui::layout::Rect;
use ratatui::text::{Line, Span};

use super::{lines, menu, padded, put, style};
use crate::app::start::Start;
use crate::term::encode::Frame;

/// Cells of the names, where there is room.
const NAME: usize = 24;
/// First row of the list.
const TOP: u16 = 2;

/// The whole screen.
#[must_use]
pub fn draw(start: &Start) -> Frame {
    let (columns, rows) = start.size;
    let mut frame = Frame::new(columns, rows);
    let all = Rect::new(0, 0, columns, rows);
    let about = "  measures how plants move";
    let title = vec![Span::styled("honami", style::BOLD), Span::styled(about, style::DIM)];
    put(&mut frame, all, 0, &Line::from(title));
    let list = list(start);
    match (&start.menu, &start.page) {
        (Some(open), _) => menu::draw(open, list, &mut frame),
        (None, Some((title, lines, first))) => page(title, &lines[*first..], all, list, &mut frame),
        (None, None) => entries(start, list, &mut frame),
    }
    for (y, line) in (list.bottom() + 1..rows.saturating_sub(1)).zip(said(start)) {
        put(&mut frame, Rect { y, height: 1, ..list }, 0, &line);
    }
    if rows > 0 {
        let room = usize::from(columns).saturating_sub(2);
        let hints = lines::own_hints(&start.keys, start.context(), &[], room);
        lines::put_right(&mut frame, Rect { y: rows - 1, height: 1, ..all }, &hints, 0);
    }
    if let Some(theme) = &start.theme {
        theme.paint(&mut frame);
    }
    frame
}

/// The row of the list that lies in a row of the screen.
#[must_use]
pub fn row_at(start: &Start, row: u16) -> Option<usize> {
    let list = list(start);
    match (&start.menu, &start.page) {
        (Some(open), _) => menu::row_at(open, list, row),
        (None, Some(_)) => None,
        (None, None) => {
            let at = first(start, list) + usize::from(row.checked_sub(list.y)?);
            (row < list.bottom() && at < start.n_rows()).then_some(at)
        }
    }
}

/// Where the list is.
fn list(start: &Start) -> Rect {
    let (columns, rows) = start.size;
    let indent = 2.min(columns);
    let n_said = u16::try_from(said(start).len()).unwrap_or(0).min(rows / 4);
    Rect::new(indent, TOP.min(rows), columns - indent, rows.saturating_sub(TOP + 2 + n_said))
}

/// What went wrong, or what there is.
fn said(start: &Start) -> Vec<Line<'static>> {
    let (text, style) = match &start.complaint {
        Some(line) => (line, style::ERROR),
        None => (&start.about, style::DIM),
    };
    let room = usize::from(start.size.0.saturating_sub(3));
    lines::wrapped(text, room).into_iter().map(|row| Line::styled(row, style)).collect()
}

/// The first row of the list that is shown, so that the chosen one is.
fn first(start: &Start, list: Rect) -> usize {
    (start.at + 1).saturating_sub(usize::from(list.height.max(1)))
}

fn entries(start: &Start, list: Rect, frame: &mut Frame) {
    let recent = start.recent.iter().map(|recent| {
        let name = recent.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let folder = recent.path.parent().map_or_else(String::new, |folder| folder.display().to_string());
        let tracks = if recent.n_tracks == 1 { "track" } else { "tracks" };
        let tracks = format!("{:>4} {tracks:<6}", recent.n_tracks);
        let open = recent.n_open.map_or_else(String::new, |n| format!("· {n} to review"));
        (name, vec![tracks, format!("{open:<14}"), format!("· {:<13}", recent.ago(start.now_s)), folder])
    });
    let others = start.rows.iter().map(|(name, doc)| (name.clone(), vec![doc.clone()]));
    let room = usize::from(list.width);
    let name_width = if room < 2 * NAME + 20 { NAME - 6 } else { NAME };
    let rows = recent.chain(others).enumerate().skip(first(start, list)).take(usize::from(list.height));
    for (y, (at, (name, details))) in (0..).zip(rows) {
        let style = if at < start.recent.len() { style::BOLD } else { style::ACCENT };
        let mut line = Line::from(Span::styled(padded(&name, name_width), style));
        // What does not fit whole is left out.
        for detail in details {
            if line.width() + 1 + Line::raw(detail.trim_end()).width() > room {
                break;
            }
            line.push_span(Span::styled(format!(" {detail}"), style::DIM));
        }
        put(frame, list, y, &line);
        if at == start.at {
            frame.cells.set_style(Rect { y: list.y + y, height: 1, ..list }, style::CHOSEN);
        }
    }
}

/// A text to read.
fn page(title: &str, lines: &[String], all: Rect, list: Rect, frame: &mut Frame) {
    put(frame, all, 1, &Line::styled(format!("  {title}"), style::ACCENT));
    for (y, line) in (0..list.height).zip(lines) {
        put(frame, list, y, &Line::raw(line.as_str()));
    }
}
