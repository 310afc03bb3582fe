//! Two runs beside each other: how they disagree in all, and on each track, the farthest apart first.

use std::ops::Range;

use ratatui::text::{Line, Span};

use honami_model::track::TrackId;
use honami_workbench::versus::{AtKeys, Compared, LIMITS_PX, Paired, Row, Summary};

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

impl VersusList<'_> {
    /// Which of the two a track shows, in stretches of frames.
    fn followed(&self, track: TrackId) -> Option<Vec<(Follows, Range<u32>)>> {
        Some(follows(&self.state.row(track)?.span, self.compared?.track(track)?))
    }

    /// The letters of those that a track shows, if only in part; `=` where they are the same, `·` for neither.
    fn letters(&self, track: TrackId) -> String {
        let stretches = match self.followed(track) {
            Some(stretches) if stretches.is_empty() => return "=".to_owned(),
            stretches => stretches.unwrap_or_default(),
        };
        let shows = |side: &usize| stretches.iter().any(|(of, _)| *of == Follows::One(*side));
        let letters: String = [0, 1].into_iter().filter(shows).map(|side| LETTERS[side]).collect();
        if letters.is_empty() { "·".to_owned() } else { letters }
    }

    /// What the selected track shows: `track 7 shows B, A in 31-49`.
    fn shown_words(&self) -> Option<String> {
        let track = self.state.selected?;
        let stretches = self.followed(track)?;
        let n_frames = |of: Follows| -> u32 {
            stretches.iter().filter(|(one, _)| *one == of).map(|(_, frames)| frames.end - frames.start).sum()
        };
        let all = [Follows::One(0), Follows::One(1), Follows::Neither];
        if stretches.is_empty() {
            return Some(format!("track {track} shows both: they are the same"));
        }
        let mostly = all.into_iter().rev().max_by_key(|of| n_frames(*of))?;
        let mut words = format!("track {track} shows {}", mostly.word());
        for of in all.into_iter().filter(|of| *of != mostly && n_frames(*of) > 0) {
            let mut places = stretches.iter().filter(|(one, _)| *one == of).map(|(_, frames)| frames);
            words += &match (places.next(), places.next()) {
                (Some(frames), None) => format!(", {} in {}-{}", of.word(), frames.start, frames.end - 1),
                _ => format!(", {} in {} frames", of.word(), n_frames(of)),
            };
        }
        Some(words)
    }
}

/// Whose sample a track shows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Follows {
    /// That of A (0) or B (1).
    One(usize),
    /// One that is neither's: a person's, or another run's.
    Neither,
}

impl Follows {
    fn word(self) -> String {
        match self {
            Self::One(side) => LETTERS[side].to_string(),
            Self::Neither => "others".to_owned(),
        }
    }
}

/// Whose samples are shown, frame by frame, in stretches; frames in which A and B are the same go with those
/// before, at the beginning with those after. None where they are the same throughout.
fn follows(shown: &honami_model::track::Span, paired: &Paired) -> Vec<(Follows, Range<u32>)> {
    let mut stretches: Vec<(Follows, Range<u32>)> = Vec::new();
    for (frame, sample) in shown.frames().zip(&shown.samples) {
        let is_its = |span: &honami_model::track::Span| {
            span.get(frame).is_some_and(|one| {
                one.status == sample.status
                    && [one.x, one.y].map(f32::to_bits) == [sample.x, sample.y].map(f32::to_bits)
            })
        };
        let of = match paired.spans.each_ref().map(is_its) {
            [true, true] => match stretches.last() {
                Some((of, _)) => *of,
                None => continue,
            },
            [true, false] => Follows::One(0),
            [false, true] => Follows::One(1),
            [false, false] => Follows::Neither,
        };
        match stretches.last_mut() {
            Some((last, frames)) if *last == of => frames.end = frame + 1,
            Some(_) => stretches.push((of, frame..frame + 1)),
            None => stretches.push((of, shown.first_frame..frame + 1)),
        }
    }
    stretches
}

impl List for VersusList<'_> {
    fn above(&self, _columns: u16, _rows: u16) -> Vec<Line<'static>> {
        let Some(versus) = self.versus else { return Vec::new() };
        let named = |(letter, run): (char, &honami_workbench::versus::Entrant)| {
            Line::from(vec![Span::styled(format!("{letter} "), style::BOLD), Span::raw(run.name())])
        };
        let mut lines: Vec<Line<'static>> = LETTERS.into_iter().zip(&versus.runs).map(named).collect();
        lines.extend(self.shown_words().map(|words| Line::styled(words, style::DIM)));
        if let Some(compared) = self.compared {
            let mut words = summary_words(&compared.found.summary);
            words.extend(key_words(&versus.at_keys));
            lines.extend(words.into_iter().map(|words| Line::styled(words, style::DIM)));
        }
        lines
    }

    fn heading(&self) -> String {
        format!("{:>7}{:>3}{:>6}{:>5}{:>5}{:>6}{:>4}", "track", "is", "apart", "at", "2+", "-A", "-B")
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

    fn middle(&self) -> Option<usize> {
        let selected = self.state.selected?;
        self.current().filter(|_| self.versus.is_some_and(|versus| versus.was_chosen(selected)))
    }

    fn row(&self, i: usize) -> Line<'static> {
        let row = &self.rows()[i];
        let share = |n: u32| format!("{:.0}%", 100.0 * f64::from(n) / f64::from(row.n_both.max(1)));
        let [a, b] = row.n_unseen;
        let (colour, px, at) = match row.farthest {
            Some((px, at)) if px < 99.995 => (text(px), format!("{px:.2}"), at.to_string()),
            Some((px, at)) => (text(px), format!("{px:.0}"), at.to_string()),
            None => (style::DIM, "—".to_owned(), "—".to_owned()),
        };
        Line::from(vec![
            Span::styled("●", colour),
            Span::raw(format!("{:>5}", row.track.0)),
            Span::raw(format!("{:>3}{px:>6}{at:>5}{:>5}", self.letters(row.track), share(row.n_far))),
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
        format!("not seen (-)  A {a}  B {b}"),
        format!("FB median  A {}  B {} px", fb(&fb_px[0]), fb(&fb_px[1])),
    ]
}

/// How far both are from the key-frames: those that one of them was given say nothing.
fn key_words(keys: &AtKeys) -> Vec<String> {
    let AtKeys { n_new, median_px, n_given: [a, b] } = keys;
    let px = |px: &Option<f64>| px.map_or_else(|| "unseen".to_owned(), |px| format!("{px:.1} px"));
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

#[cfg(test)]
mod tests;
