//! A track that is being drawn while the clip plays, or put down frame by frame (Diener 2009, 3.4.2).
//!
//! A point is led by the mouse or by keys; where it goes while the clip plays is a stroke. How late the hand is behind
//! the pictures is measured while it is drawn: from when the clock comes to a picture until the terminal has said that
//! it is on screen. What the terminal says takes the same way back as what the mouse does, so this is what the eye and
//! both ways of the link make of it, however the pictures are paced.

use std::sync::Arc;
use std::time::Duration;

use honami_model::clip::FrameTimes;
use honami_model::correct::{self, Correction, Drawn, Layers, Played, Stroke};
use honami_model::track::{Source, TrackId};

use super::clock::Play;

/// Finest and coarsest step of the keys that lead the point, nudges.
const STEPS: (f32, f32) = (0.25, 64.0);

/// What is being drawn.
#[derive(Clone, Debug)]
pub struct Sketching {
    /// Its track.
    pub track: TrackId,
    /// The point that is led, image pixels.
    pub point: [f32; 2],
    /// Keys lead it by so many nudges.
    pub step: f32,
    /// The strokes so far; later ones lie over earlier ones.
    pub strokes: Vec<Stroke>,
    /// The stroke that is being drawn.
    open: Option<Open>,
    /// Whether the button of the mouse is down.
    is_held: bool,
    /// The frame that was stepped to after the point was put down: there the same stroke goes on.
    next: Option<u32>,
    /// The track and what lies below, once known.
    pub layers: Option<Arc<Layers>>,
    /// What would be kept, or why it cannot be.
    pub ghost: Option<Result<Arc<Correction>, String>>,
}

/// A stroke that is being drawn.
#[derive(Clone, Debug)]
struct Open {
    play: Play,
    from_s: f64,
    /// What the link is taken to delay as long as no picture was acknowledged, seconds.
    link_s: f64,
    /// How late each picture was on screen, seconds.
    late_s: Vec<f64>,
    hand: Hand,
    drawn: Vec<Drawn>,
}

/// What leads the point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hand {
    /// Nothing yet: somebody only looks on.
    None,
    Keys,
    Mouse,
}

impl Open {
    fn draw(&mut self, now: Duration, at: [f32; 2]) {
        let elapsed_s = now.saturating_sub(self.play.since).as_secs_f64();
        self.drawn.push(Drawn { elapsed_s, at: at.map(f64::from) });
    }

    /// The stroke as it is when it ends here and now; none without a hand.
    fn ended(&self, now: Duration, at: [f32; 2]) -> Option<Stroke> {
        if self.hand == Hand::None {
            return None;
        }
        let mut whole = self.clone();
        whole.draw(now, at);
        let mut late_s = whole.late_s;
        late_s.sort_by(f64::total_cmp);
        // The middle one: a single stall of the link does not shift the stroke.
        let link_s = late_s.get(late_s.len() / 2).copied().unwrap_or(self.link_s);
        let played = Played::under_hand(self.from_s, self.play.rate, link_s);
        straighten(&mut whole.drawn);
        Some(Stroke { played, drawn: whole.drawn })
    }
}

impl Sketching {
    /// A track about to be drawn from a point.
    #[must_use]
    pub fn new(track: TrackId, point: [f32; 2]) -> Self {
        let (strokes, open, is_held, next, layers, ghost) = Default::default();
        Self { track, point, step: 1.0, strokes, open, is_held, next, layers, ghost }
    }

    /// The clip begins to play. The stroke begins where the point is, once a hand is seen.
    pub(super) fn begin(&mut self, play: Play, from_s: f64, link_s: f64) {
        self.end(play.since);
        let hand = if self.is_held { Hand::Mouse } else { Hand::None };
        let mut open = Open { play, from_s, link_s, late_s: Vec::new(), hand, drawn: Vec::new() };
        open.draw(play.since, self.point);
        self.open = Some(open);
    }

    /// The stroke that is being drawn ends.
    pub(super) fn end(&mut self, now: Duration) {
        let point = self.point;
        if let Some(open) = self.open.take() {
            self.strokes.extend(open.ended(now, point));
            self.next = None;
        }
    }

    /// All strokes, as if the last one ended now.
    #[must_use]
    pub fn ended(&self, now: Duration) -> Vec<Stroke> {
        let open = self.open.as_ref().and_then(|open| open.ended(now, self.point));
        self.strokes.iter().cloned().chain(open).collect()
    }

    /// These strokes instead of all that was drawn.
    pub(super) fn take(&mut self, strokes: Vec<Stroke>) {
        self.open = None;
        self.strokes = strokes;
    }

    /// Whether a stroke is being drawn, or would be if a hand was seen.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// A picture was on screen so late after the clock had come to it.
    pub(super) fn late(&mut self, by: Duration) {
        self.open.iter_mut().for_each(|open| open.late_s.push(by.as_secs_f64()));
    }

    /// Keys lead the point. The hand meant to pass the middle of a step when it made it.
    pub(super) fn steer(&mut self, to: [f32; 2], now: Duration) {
        let middle = [0, 1].map(|axis| self.point[axis].midpoint(to[axis]));
        if let Some(open) = &mut self.open {
            open.draw(now, middle);
            open.hand = if open.hand == Hand::None { Hand::Keys } else { open.hand };
        }
        self.point = to;
    }

    /// The button goes down at a point: there a stroke begins, if the clip plays.
    pub(super) fn press(&mut self, at: [f32; 2], now: Duration) {
        (self.is_held, self.point) = (true, at);
        if let Some(mut open) = self.open.clone() {
            self.end(now);
            open.drawn.clear();
            open.hand = Hand::Mouse;
            open.draw(now, at);
            self.open = Some(open);
        }
    }

    /// The mouse has come into a cell, from one corner to the other in image pixels, with its button down: just now it
    /// passed the point of it that is nearest to where it was.
    pub(super) fn drag(&mut self, corners: [[f32; 2]; 2], now: Duration) {
        let [least, most] = corners;
        self.point = [0, 1].map(|axis| self.point[axis].max(least[axis]).min(most[axis]));
        if let Some(open) = self.open.as_mut().filter(|_| self.is_held) {
            open.draw(now, self.point);
        }
    }

    /// The button goes up; returns whether that ends a stroke.
    pub(super) fn release(&mut self, now: Duration) -> bool {
        self.is_held = false;
        let is_end = self.open.as_ref().is_some_and(|open| open.hand == Hand::Mouse);
        if is_end {
            self.end(now);
        }
        is_end
    }

    /// Puts the point down in a frame at a time, before another one is stepped to; the point goes on as it went.
    pub(super) fn put(&mut self, (frame, t_s): (u32, f64), (next, next_s): (u32, f64)) {
        let here = Drawn { elapsed_s: t_s, at: self.point.map(f64::from) };
        match self.strokes.last_mut() {
            Some(stroke) if self.next == Some(frame) && stroke.played == Played::STEPWISE => {
                let last = stroke.drawn.last().copied().filter(|last| last.elapsed_s < t_s);
                if let Some(last) = last {
                    let part = (next_s - t_s) / (t_s - last.elapsed_s);
                    self.point = [0, 1].map(|i| (here.at[i] + part * (here.at[i] - last.at[i])) as f32);
                }
                stroke.drawn.push(here);
            }
            _ => self.strokes.push(Stroke { played: Played::STEPWISE, drawn: vec![here] }),
        }
        self.next = Some(next);
    }

    /// Takes the stroke back that is being drawn, else the last one: of one put down frame by frame, the last point.
    pub(super) fn take_back(&mut self) {
        self.next = None;
        if self.open.take().is_some_and(|open| open.hand != Hand::None) {
            return;
        }
        if let Some(stroke) = self.strokes.last_mut() {
            stroke.drawn.pop();
            if stroke.played != Played::STEPWISE || stroke.drawn.is_empty() {
                self.strokes.pop();
            }
        }
    }

    /// The point goes where a frame was drawn, or is a key-frame.
    pub(super) fn arrive(&mut self, frame: u32, times: &FrameTimes) {
        let sample = match (self.correction(), &self.layers) {
            (Some(ghost), _) => ghost.span.get(frame).copied(),
            (None, Some(layers)) => layers.shown(times).span().get(frame).copied(),
            (None, None) => None,
        };
        if let Some(sample) = sample.filter(|s| matches!(s.source, Source::Sketch | Source::Key)) {
            self.point = [sample.x, sample.y];
        }
    }

    /// Another step of the keys, so many times twice as large.
    pub(super) fn scale_step(&mut self, times: i64) {
        let times = i32::try_from(times.clamp(-16, 16)).unwrap_or(0);
        self.step = (self.step * 2.0_f32.powi(times)).clamp(STEPS.0, STEPS.1);
    }

    /// Makes the preview anew.
    pub(super) fn preview(&mut self, times: &FrameTimes) {
        let Some(layers) = self.layers.clone().filter(|_| !self.strokes.is_empty()) else {
            self.ghost = None;
            return;
        };
        let ghost = correct::sketch(&layers.shown(times), &self.strokes);
        self.ghost = Some(ghost.map(Arc::new).map_err(|why| why.to_string()));
    }

    /// What would be kept, where it can be.
    #[must_use]
    pub fn correction(&self) -> Option<&Correction> {
        self.ghost.as_ref()?.as_ref().ok().map(AsRef::as_ref)
    }

    /// The points of the stroke that is being drawn, image pixels.
    pub fn trail(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        let open = self.open.as_ref().filter(|open| open.hand != Hand::None);
        open.into_iter().flat_map(|open| open.drawn.iter().map(|drawn| drawn.at.map(|x| x as f32)))
    }

    /// How late the last stroke was taken to be, milliseconds of the hand and of the link; none when put down frame by
    /// frame.
    #[must_use]
    pub fn late_ms(&self) -> Option<[u32; 2]> {
        let played = self.strokes.last()?.played;
        let ms = |s: f64| (s * 1e3).round() as u32;
        let link_s = played.delay_s - correct::HUMAN_DELAY_S;
        (played != Played::STEPWISE).then(|| [ms(correct::HUMAN_DELAY_S), ms(link_s)])
    }
}

/// Cells and steps tell of one axis at a time: where another one is crossed, a coordinate that has not changed since is
/// on its way between the two places where it did.
fn straighten(drawn: &mut [Drawn]) {
    let given = drawn.to_vec();
    for axis in [0, 1] {
        let raw = |at: usize| given[at].at[axis];
        let mut known = 0;
        let n = drawn.len();
        for at in (1..n).filter(|at| at + 1 == n || (raw(*at) - raw(*at - 1)).abs() > 0.0) {
            let (a, b) = (drawn[known], drawn[at]);
            for point in &mut drawn[known + 1..at] {
                let part =
                    (point.elapsed_s - a.elapsed_s) / (b.elapsed_s - a.elapsed_s).max(f64::MIN_POSITIVE);
                point.at[axis] = a.at[axis] + part.min(1.0) * (b.at[axis] - a.at[axis]);
            }
            known = at;
        }
    }
}

#[cfg(test)]
mod tests;
