//! The models that are offered for a sample that is moved, each with its error, the one in use first.

use honami_workbench::offer::Model;
use ratatui::text::{Line, Span};

use super::style;
use crate::app::correcting::Moving;

/// As many as there is room for, in the order in which Tab takes them. Where room is short, those of which nothing is
/// known are left out first.
pub(super) fn offers(moving: &Moving, room: usize) -> Line<'static> {
    let mut models: Vec<Model> = moving.models().collect();
    let at = models.iter().position(|model| Some(*model) == moving.model()).unwrap_or(0);
    models.rotate_left(at);
    let all = line(moving, &models, usize::MAX);
    if all.width() <= room {
        return all;
    }
    let is_known =
        |model: &Model| moving.offer.errors.as_ref().is_some_and(|errors| errors.px(*model).is_some());
    if models.iter().any(is_known) {
        models.retain(|model| is_known(model) || Some(*model) == moving.model());
    }
    line(moving, &models, room)
}

fn line(moving: &Moving, models: &[Model], room: usize) -> Line<'static> {
    let mut line = Line::default();
    for (nth, model) in models.iter().enumerate() {
        let error = match &moving.offer.errors {
            _ if *model == Model::KeyOnly => String::new(),
            None => " …".to_owned(),
            Some(errors) => match errors.px(*model) {
                None => " –".to_owned(),
                Some(px) if nth == 0 => format!(" {px:.2} px"),
                Some(px) => format!(" {px:.2}"),
            },
        };
        let (between, style) = if nth == 0 { ("", style::ACCENT) } else { (" · ", style::DIM) };
        let words = format!("{between}{}{error}", model.word());
        if line.width() + Line::raw(words.as_str()).width() > room {
            break;
        }
        line.push_span(Span::styled(words, style));
    }
    line
}
