//! The form of a plugin, over the lower part of the picture.

use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};

use honami_workbench::plugins::{Hosting, Numeric, Param, ParamKind, Prospect, Value};

use super::lines::wrapped;
use super::{padded, panel, put, style, width};
use crate::app::form::{Form, Row, Task, slider};
use crate::term::encode::Frame;

/// Cells of the panel, at most.
const WIDTH: u16 = 78;
/// Cells of a slider.
const SLIDER: usize = 14;
/// Cells of the labels, least and most.
const LABEL: (usize, usize) = (16, 32);

pub(super) fn draw(form: &Form, area: Rect, frame: &mut Frame) {
    let rows = form.rows();
    let room = usize::from(area.width.min(WIDTH).saturating_sub(2));
    let docs = rows.get(form.at).and_then(doc).map_or_else(Vec::new, |doc| wrapped(&doc, room));
    let n_docs = u16::try_from(docs.len().max(1)).unwrap_or(u16::MAX);
    // Blank, rows, blank, doc of the row.
    let wanted = u16::try_from(rows.len() + 2).unwrap_or(u16::MAX).saturating_add(n_docs);
    let inside = panel(frame, area, WIDTH, wanted);
    let n_listed = usize::from(inside.height.saturating_sub(2 + n_docs)).max(1);
    let first = form.at.saturating_sub(n_listed - 1);
    let labels = rows
        .iter()
        .filter_map(|row| if let Row::Param(param, _) = row { Some(label_of(param)) } else { None });
    let label_width = labels.map(width).max().unwrap_or(0).clamp(LABEL.0, LABEL.1);
    for (y, (i, row)) in (1..).zip(rows.iter().enumerate().skip(first).take(n_listed)) {
        let mut line = row_line(form, row, i == form.at, label_width);
        // A slider is seen whole or not at all, and so is what is said of a plugin.
        while line.width() > usize::from(inside.width) && line.spans.len() > 2 {
            line.spans.pop();
        }
        put(frame, inside, y, &line);
    }
    for (y, doc) in (inside.height.saturating_sub(n_docs)..).zip(docs) {
        put(frame, inside, y, &Line::styled(doc, style::DIM));
    }
}

fn doc(row: &Row<'_>) -> Option<String> {
    match row {
        Row::Param(param, _) if param.doc.is_empty() => Some(param.wanted()),
        Row::Param(param, _) => Some(format!("{} ({})", param.doc.trim_end_matches('.'), param.wanted())),
        Row::Plugin(plugin) => Some(of_plugin(&plugin.apart)),
        Row::Fold(_) => Some("h l unfold and fold".to_owned()),
    }
}

fn of_plugin(apart: &Prospect) -> String {
    let choose = "h l choose another plugin";
    match apart.hosting {
        Hosting::InProcess if apart.is_bare => format!("⚠ in-process: {} · {choose}", apart.why),
        Hosting::Isolated if !apart.why.is_empty() => {
            format!("sandbox {}: {} · {choose}", apart.sandbox, apart.why)
        }
        _ => choose.to_owned(),
    }
}

fn label_of(param: &Param) -> &str {
    if param.label.is_empty() { &param.id } else { &param.label }
}

fn row_line(form: &Form, row: &Row<'_>, is_here: bool, label_width: usize) -> Line<'static> {
    let sign = if is_here { "▸ " } else { "  " };
    let label_style = if is_here { style::ACCENT } else { Style::new() };
    let label = |text: &str| Span::styled(format!("{sign}{} ", padded(text, label_width)), label_style);
    match row {
        Row::Plugin(plugin) => {
            let task = match form.task {
                Task::Track => "track with",
                Task::Cluster => "group with",
            };
            let others = if form.plugins.len() > 1 {
                format!("   {} of {}", form.which + 1, form.plugins.len())
            } else {
                String::new()
            };
            let mut spans =
                vec![label(task), Span::styled(format!("{} {}", plugin.name, plugin.version), style::BOLD)];
            match plugin.apart.hosting {
                Hosting::InProcess if plugin.apart.is_bare => {
                    spans.extend([" ⚠", " in-process"].map(|part| Span::styled(part, style::ERROR)));
                }
                Hosting::InProcess => {}
                Hosting::Isolated => {
                    spans.push(Span::styled(format!("   sandbox {}", plugin.apart.sandbox), style::DIM));
                }
            }
            spans.push(Span::styled(others, style::DIM));
            Line::from(spans)
        }
        Row::Fold(n) => {
            Line::from(vec![label(&format!("advanced {} {n}", if form.unfolded { "▾" } else { "▸" }))])
        }
        Row::Param(param, value) => {
            let mut spans = vec![label(label_of(param))];
            match &form.typed {
                Some(typed) if is_here => {
                    spans.push(Span::styled(format!("{typed}▏ {}", param.unit), style::BOLD))
                }
                _ => spans.extend(value_spans(param, value)),
            }
            Line::from(spans)
        }
    }
}

fn value_spans(param: &Param, value: &Value) -> Vec<Span<'static>> {
    let text = match (&param.kind, value) {
        (ParamKind::Bool { .. }, Value::Bool(b)) => if *b { "yes" } else { "no" }.to_owned(),
        (ParamKind::Enum { entries, .. }, Value::Text(id)) => {
            let entry = entries.iter().find(|e| e.id == *id);
            let label = entry.filter(|e| !e.label.is_empty()).map_or(id, |e| &e.label);
            format!("{label}{}", if entries.len() > 1 { " ▾" } else { "" })
        }
        _ if param.unit.is_empty() => value.to_string(),
        _ => format!("{value} {}", param.unit),
    };
    let slider = match (&param.kind, value) {
        (ParamKind::Int(range), Value::Int(i)) => slide(range, *i, |i| i as f64),
        (ParamKind::Float(range), Value::Float(x)) => slide(range, *x, |x| x),
        _ => String::new(),
    };
    vec![Span::raw(format!("{text:<12} ")), Span::styled(slider, style::DIM)]
}

/// `1 ────●──── 40`, where the number has two ends.
fn slide<T>(range: &Numeric<T>, value: T, number: impl Fn(T) -> f64) -> String
where
    T: Copy + PartialOrd + std::fmt::Display,
{
    let Some((low, high)) = slider(range) else { return String::new() };
    let (a, b, x) = (number(low), number(high), number(value));
    let part = if range.scale == "log" && a > 0.0 { (x / a).ln() / (b / a).ln() } else { (x - a) / (b - a) };
    let at = (part.clamp(0.0, 1.0) * (SLIDER - 1) as f64).round() as usize;
    format!("{low:>5} {}●{} {high}", "─".repeat(at), "─".repeat(SLIDER - 1 - at))
}
