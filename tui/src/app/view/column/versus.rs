//! Two runs beside each other: how they disagree in all, and on each track, the farthest apart first.

use ratatui::text::{Line, Span};

use honami_workbench::versus::{AtKeys, Compared, LIMITS_PX, Row, Summary};

use super::{List, Pick, style};
use crate::app::state::State;
use crate::app::versus::{LETTERS, Versus};
use crate::app::view::picture::versus::text;

pub(super) struct VersusList<'a> {
    state: &'a State,
    versus: Option<&'a Versus>,
    compared: Option<&'a Compared>,
}

impl<'a> VersusList<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        let versus = state.versus.as_deref();
        let compared = versus.and_then(|versus| versus.compared.as_deref());
        Self { state, versus, compared }
    }

    fn rows(&self) -> &'a [Row] {
        self.compared.map_or(&[], |compared| &compared.found.rows)
    }
}

impl List for VersusList<'_> {
    fn above(&self) -> Vec<Line<'static>> {
        let Some(versus) = self.versus else { return Vec::new() };
        let named = |(letter, run): (char, &honami_workbench::versus::Entrant)| {
            Line::from(vec![Span::styled(format!("{letter} "), style::BOLD), Span::raw(run.name())])
        };
        let mut lines: Vec<Line<'static>> = LETTERS.into_iter().zip(&versus.runs).map(named).collect();
        if let Some(compared) = self.compared {
            let mut words = summary_words(&compared.found.summary);
            words.extend(key_words(&versus.at_keys));
            lines.extend(words.into_iter().map(|words| Line::styled(words, style::DIM)));
        }
        lines
    }

    fn heading(&self) -> String {
        format!("{:>7}{:>8}{:>6}{:>5}{:>6}{:>4}", "track", "apart", "at", "2+", "-A", "-B")
    }

    fn nothing(&self) -> &'static str {
        match (self.versus, self.compared) {
            (None, _) => "A shows two runs over the picture",
            (Some(_), None) => "comparing …",
            (Some(_), Some(_)) => "they have no track together",
        }
    }

    fn len(&self) -> usize {
        self.rows().len()
    }

    fn current(&self) -> Option<usize> {
        let selected = self.state.selected?;
        self.rows().iter().position(|row| row.track == selected)
    }

    fn row(&self, i: usize) -> Line<'static> {
        let row = &self.rows()[i];
        let share = |n: u32| format!("{:.0}%", 100.0 * f64::from(n) / f64::from(row.n_both.max(1)));
        let [a, b] = row.n_unseen;
        let (colour, px, at) = match row.farthest {
            Some((px, at)) => (text(px), format!("{px:.2}"), at.to_string()),
            None => (style::DIM, "—".to_owned(), "—".to_owned()),
        };
        Line::from(vec![
            Span::styled("●", colour),
            Span::raw(format!("{:>5}", row.track.0)),
            Span::raw(format!("{px:>8}{at:>6}{:>5}", share(row.n_far))),
            Span::styled(format!("{a:>6}{b:>4}"), style::DIM),
        ])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        let row = &self.rows()[i];
        let at = row.farthest.map_or(self.state.frame, |(_, frame)| frame);
        Some(Pick::At(row.track, at))
    }
}

/// How they disagree in all.
fn summary_words(summary: &Summary) -> Vec<String> {
    let Summary { n_both, median_px, within, n_unseen: [a, b], fb_px, .. } = summary;
    let median = median_px.map_or_else(|| "never both seen".to_owned(), |px| format!("median {px:.2} px"));
    let shares = LIMITS_PX.iter().zip(within).map(|(px, share)| format!("<{px} {:.0}%", 100.0 * share));
    let fb = |px: &Option<f64>| px.map_or_else(|| "—".to_owned(), |px| format!("{px:.3}"));
    vec![
        format!("{median}, {n_both} samples"),
        shares.collect::<Vec<_>>().join("  "),
        format!("lost (-)   A {a}  B {b}"),
        format!("FB median  A {}  B {} px", fb(&fb_px[0]), fb(&fb_px[1])),
    ]
}

/// How far both are from the key-frames: those that one of them was given say nothing.
fn key_words(keys: &AtKeys) -> Vec<String> {
    let AtKeys { n_new, median_px, n_given: [a, b] } = keys;
    let px = |px: &Option<f64>| px.map_or_else(|| "lost".to_owned(), |px| format!("{px:.1} px"));
    let [of_a, of_b] = median_px.each_ref().map(px);
    let mut words = Vec::new();
    if *n_new > 0 {
        let frames = if *n_new == 1 { "key-frame" } else { "key-frames" };
        words.push(format!("off at {n_new} {frames}  A {of_a}  B {of_b}"));
    }
    if a + b > 0 {
        words.push(format!("given (no test)  A {a}  B {b}"));
    }
    words
}
