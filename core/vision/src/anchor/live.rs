//! One point: what it looks like, where it is, and what is made of that frame by frame.

use serde::{Deserialize, Serialize};

use super::neighbours::{self, Neighbour, Seen, Word};
use super::search::Ring;
use super::template::{Desk, Fit, Template};
use super::warp::{STILL, Warp};
use super::{Params, Row, State};
use crate::{Gray, Point, klt};

/// Ids from here on are the tracker's own.
pub(super) const OWN: u64 = 1 << 32;
/// How far a leaf is expected to flutter about its branch until it has been seen to, and at most: what went farther
/// was likely another leaf. Pixels.
const FLUTTER_PX: f32 = 3.0;
/// How slowly its flutter is forgotten: frames.
const MEMORY_FRAMES: f32 = 20.0;

/// A point that has not been retired.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Live {
    /// The seed's, or [`OWN`] and more for a companion.
    pub(super) id: u64,
    /// Which of all seedings it is from.
    pub(super) stamp: u32,
    pub(super) at: Point,
    /// Position in the frame before.
    pub(super) before: Point,
    state: State,
    /// Found so well that it may carry others; in this frame, and in the one before.
    pub(super) is_sure: bool,
    was_sure: bool,
    was_tracked: bool,
    /// Newest last.
    pub(super) templates: Vec<Template>,
    /// The template that was found last.
    current: usize,
    warp: Warp,
    speed: Point,
    /// Frames in a row that it has not been found.
    n_hidden: u32,
    /// From where its neighbours say to where it was found.
    aside: Point,
    /// Mean square of that, pixels², and in how many frames.
    flutter_px2: f32,
    n_flutter: u32,
    /// Whether it was seen to that it has neighbours.
    pub(super) has_company: bool,
    /// Position when it was related to its neighbours.
    pub(super) base: Point,
    pub(super) near: Vec<Neighbour>,
    /// Where Lucas-Kanade leads in this frame.
    #[serde(skip)]
    pub(super) flow: Option<klt::Flow>,
    /// The best fit in this frame.
    #[serde(skip)]
    fit: Option<Fit>,
    #[serde(skip)]
    fb: Option<f32>,
}

impl Live {
    /// A new point, with its template where there is a picture to cut it from.
    pub(super) fn new(id: u64, at: Point, stamp: u32, picture: Option<&Gray<'_>>, desk: &Desk<'_>) -> Self {
        let at = if at.iter().all(|c| c.is_finite()) { at } else { [-1.0; 2] };
        let mut point = Self {
            id,
            stamp,
            at,
            before: at,
            state: State::Tracked,
            is_sure: true,
            was_sure: true,
            was_tracked: true,
            templates: Vec::new(),
            current: 0,
            warp: STILL,
            speed: [0.0; 2],
            n_hidden: 0,
            aside: [0.0; 2],
            flutter_px2: FLUTTER_PX * FLUTTER_PX,
            n_flutter: 2,
            has_company: false,
            base: at,
            near: Vec::new(),
            flow: None,
            fit: None,
            fb: None,
        };
        if let Some(picture) = picture {
            point.begin(picture, desk);
        }
        point
    }

    /// Cuts the template of a point that has none.
    pub(super) fn begin(&mut self, picture: &Gray<'_>, desk: &Desk<'_>) {
        if holds(picture, self.at) {
            self.templates = vec![Template::cut(picture, self.at, desk.params)];
        } else {
            (self.state, self.is_sure) = (State::Outside, false);
        }
    }

    /// Another key-frame of the point: templates of older ones stay if they are found where it is now.
    pub(super) fn reseed(&mut self, at: Point, stamp: u32, picture: Option<&Gray<'_>>, desk: &mut Desk<'_>) {
        /// An older template that is found farther from the key-frame contradicts it, pixels.
        const APART_PX: f32 = 2.0;
        let mut point = Self::new(self.id, at, stamp, picture, desk);
        if let Some(picture) = picture.filter(|_| !point.templates.is_empty()) {
            let mut is_found = |template: &mut Template| {
                desk.lay(template);
                let fit = [self.warp, STILL]
                    .map(|warp| desk.refine(picture, at, warp))
                    .into_iter()
                    .max_by(|a, b| a.ncc.total_cmp(&b.ncc))?;
                let off = [at[0] - fit.at[0], at[1] - fit.at[1]];
                // From now on it, too, is about the place that was shown.
                let off = super::warp::apply(super::warp::inverse(fit.warp)?, off);
                template.shift = [template.shift[0] + off[0], template.shift[1] + off[1]];
                (fit.ncc >= desk.params.sure && off[0].hypot(off[1]) <= APART_PX).then_some(())
            };
            let mut older = std::mem::take(&mut self.templates);
            older.retain_mut(|template| is_found(template).is_some());
            let room = (desk.params.max_templates.max(1) - 1) as usize;
            older.drain(..older.len().saturating_sub(room));
            older.append(&mut point.templates);
            (point.current, point.templates) = (older.len() - 1, older);
        }
        *self = point;
    }

    /// Whether the tracker follows it for itself.
    pub(super) fn is_companion(&self) -> bool {
        self.id >= OWN
    }

    /// Whether it can be worked with: what another tracker says that it was.
    pub(super) fn is_sound(&self, params: &Params, n_slots: usize) -> bool {
        let places = [self.at, self.before, self.base, self.speed, self.aside];
        (self.current < self.templates.len() || self.templates.is_empty())
            && self.templates.iter().all(|template| template.is_of(params))
            && self.near.iter().all(|other| (other.slot as usize) < n_slots)
            && places.iter().chain(self.warp.as_chunks::<2>().0).flatten().all(|c| c.is_finite())
    }

    /// Whether a companion is of no use any more.
    pub(super) fn is_spent(&self) -> bool {
        /// Hidden for so many frames, it has likely turned into something else.
        const USELESS_FRAMES: u32 = 50;
        self.is_companion() && (self.n_hidden > USELESS_FRAMES || self.state == State::Outside)
    }

    pub(super) fn row(&self) -> Row {
        let ncc = self.fit.filter(|_| self.state == State::Tracked).map(|fit| fit.ncc);
        Row { id: self.id as u32, at: self.at, state: self.state, fb: self.fb, ncc }
    }

    pub(super) fn seen(&self) -> Seen {
        Seen { at: self.at, is_sure: self.is_sure, before: self.before, was_sure: self.was_sure }
    }

    /// Whether there is anything to look for.
    pub(super) fn is_sought(&self) -> bool {
        self.state != State::Lost && !self.templates.is_empty()
    }

    /// Whether it was found in this frame and in the one before.
    pub(super) fn is_found_twice(&self) -> bool {
        self.state == State::Tracked && self.was_tracked && self.is_sought()
    }

    /// Takes the way back into the frame before.
    pub(super) fn note_back(&mut self, back: &klt::Flow) {
        let off = (back.to[0] - self.before[0]).hypot(back.to[1] - self.before[1]);
        self.fb = (back.state == klt::State::Tracked).then_some(off);
    }

    /// Fits the template where Lucas-Kanade and its own speed lead; `last` is the picture before.
    pub(super) fn predict(&mut self, last: &Gray<'_>, picture: &Gray<'_>, desk: &mut Desk<'_>) {
        (self.before, self.was_sure, self.was_tracked) =
            (self.at, self.is_sure, self.state == State::Tracked);
        (self.fit, self.fb, self.is_sure) = (None, None, false);
        if !self.is_sought() {
            return;
        }
        let onward = [self.at[0] + self.speed[0], self.at[1] + self.speed[1]];
        let flow = self.flow.map_or(onward, |flow| flow.to);
        let template = &mut self.templates[self.current];
        desk.lay(template);
        // A new one was cut from the picture before, which is at hand now.
        template.alike.get_or_insert_with(|| desk.alike(last, self.at));
        let from = best(desk, picture, &[(flow, self.warp), (onward, self.warp)]);
        let fit = desk.refine(picture, from.0, from.1);
        self.is_sure = fit.ncc >= self.sure(desk.params) && holds(picture, fit.at);
        if self.is_sure {
            self.at = fit.at;
        }
        self.fit = Some(fit);
    }

    /// Looks again where the neighbours say, if need be, and makes up its mind.
    pub(super) fn settle(&mut self, picture: &Gray<'_>, seen: &[Seen], desk: &mut Desk<'_>) {
        let Some(mut fit) = self.fit.filter(|_| self.is_sought()) else { return };
        let word = neighbours::since_related(self, seen, desk.params);
        let onward = [self.before[0] + self.speed[0], self.before[1] + self.speed[1]];
        // Lucas-Kanade goes anywhere where it loses its hold.
        let far_px = desk.params.radius_px as f32;
        let is_near = |at: Point| (at[0] - onward[0]).hypot(at[1] - onward[1]) <= far_px;
        let flow = self.flow.filter(|flow| flow.state == klt::State::Tracked).map(|flow| flow.to);
        let mut carried = flow.filter(|&at| is_near(at)).unwrap_or(onward);
        if !self.is_sure {
            let step = neighbours::since_before(self, seen, desk.params);
            let places = self.places(&fit, flow, word.as_ref(), step.as_ref());
            carried = match (self.n_hidden, word, step) {
                (2.., Some(word), _) => word.at,
                (_, _, Some(step)) => step.at,
                (_, Some(word), None) => word.at,
                _ => carried,
            };
            fit = self.look_again(picture, desk, &places, fit);
        }
        let confidence = self.confidence(&fit, word.as_ref(), desk.params);
        let doubt = if self.n_hidden > 0 { desk.params.return_cost } else { 0.0 };
        let is_found = confidence >= desk.params.accept + doubt && holds(picture, fit.at);
        self.is_sure = is_found && confidence >= self.sure(desk.params);
        self.fit = Some(fit);
        if is_found {
            self.take(picture, desk, &fit, word.as_ref());
        } else {
            self.hide(picture, desk, carried);
        }
    }

    /// Where to look: by itself, as the flow, as its neighbours say, and as far aside from that as it was last.
    fn places(
        &self,
        fit: &Fit,
        flow: Option<Point>,
        word: Option<&Word>,
        step: Option<&Word>,
    ) -> Vec<(Point, Warp)> {
        /// After so many frames its own turn says less than its neighbours'.
        const STALE_FRAMES: u32 = 2;
        let mut places = vec![(fit.at, self.warp)];
        places.extend(flow.map(|at| (at, self.warp)));
        places.extend(step.map(|step| (step.at, self.warp)));
        if let Some(word) = word {
            let turned = [word.turn[0], -word.turn[1], word.turn[1], word.turn[0]];
            let aside = [word.at[0] + self.aside[0], word.at[1] + self.aside[1]];
            places.push((word.at, turned));
            places.push((aside, if self.n_hidden > STALE_FRAMES { turned } else { self.warp }));
        }
        places
    }

    /// Fits every template at the best of the places, then around it.
    fn look_again(
        &mut self,
        picture: &Gray<'_>,
        desk: &mut Desk<'_>,
        places: &[(Point, Warp)],
        first: Fit,
    ) -> Fit {
        /// A peak below this is not worth a fit.
        const LEAST_PEAK: f32 = 0.3;
        let mut found = first;
        let n = self.templates.len();
        let first_tried = self.current;
        for k in (0..n).map(|k| (first_tried + k) % n) {
            let mut keep = |fit: Fit, current: &mut usize| {
                if fit.ncc > found.ncc {
                    (found, *current) = (fit, k);
                }
            };
            desk.lay(&self.templates[k]);
            let (at, warp) = best(desk, picture, places);
            let fit = desk.refine(picture, at, warp);
            keep(fit, &mut self.current);
            if fit.ncc < desk.params.good
                && let Some((peak, ncc)) =
                    desk.search(picture, at, warp, Ring { from_px: 0.0, reach_px: desk.params.search_px })
                && ncc > LEAST_PEAK
            {
                keep(desk.refine(picture, peak, warp), &mut self.current);
            }
        }
        found
    }

    /// How well the template would correlate somewhere else at worst.
    fn alike(&self) -> f32 {
        self.templates[self.current].alike.unwrap_or(0.0)
    }

    /// The correlation from which on a fit is sure: better than anywhere around the key-frame.
    fn sure(&self, params: &Params) -> f32 {
        params.sure.max(self.alike())
    }

    /// A fit's correlation less what speaks against it: the less a correlation says, the more the neighbours do; and
    /// on plain ground some correlation is a matter of luck.
    fn confidence(&self, fit: &Fit, word: Option<&Word>, params: &Params) -> f32 {
        /// How unlike what is around it a template usually is: what a point that is alone is judged by.
        const USUAL: f32 = 0.4;
        let unlike = word.map_or(USUAL, |_| 1.0 - self.alike());
        let stray = params.stray_cost * self.stray(fit, word) / unlike;
        fit.ncc - stray - params.contrast_cost * fit.contrast.ln().powi(2)
    }

    /// Squared standard deviations that a fit is off what the neighbours say, or its own motion where they say nothing;
    /// as far off is as bad as any.
    fn stray(&self, fit: &Fit, word: Option<&Word>) -> f32 {
        /// Never as steady as that, pixels².
        const STEADY_PX2: f32 = 0.5;
        const MOST: f32 = 9.0;
        /// Nobody vouches for a point without neighbours.
        const ALONE: f32 = 4.0;
        /// Nor is its own motion a good witness, pixels.
        const JERK_PX: f32 = 4.0;
        let off_px2 = |at: Point| (fit.at[0] - at[0]).powi(2) + (fit.at[1] - at[1]).powi(2);
        if let Some(word) = word {
            let usual = word.spread_px.powi(2) + self.flutter_px2.min(FLUTTER_PX.powi(2)) + STEADY_PX2;
            return (off_px2(word.at) / usual).min(MOST);
        }
        let onward = [self.before[0] + self.speed[0], self.before[1] + self.speed[1]];
        let usual = JERK_PX + self.speed[0].hypot(self.speed[1]) / 2.0;
        ALONE + (off_px2(onward) / (usual * usual)).min(MOST)
    }

    /// It was found.
    fn take(&mut self, picture: &Gray<'_>, desk: &mut Desk<'_>, fit: &Fit, word: Option<&Word>) {
        (self.at, self.warp, self.n_hidden, self.state) = (fit.at, fit.warp, 0, State::Tracked);
        self.speed = [self.at[0] - self.before[0], self.at[1] - self.before[1]];
        if let Some(word) = word {
            self.aside = [self.at[0] - word.at[0], self.at[1] - word.at[1]];
            if self.is_sure {
                let off = self.aside[0].powi(2) + self.aside[1].powi(2);
                self.n_flutter += 1;
                self.flutter_px2 +=
                    (off - self.flutter_px2) * (1.0 / self.n_flutter as f32).max(1.0 / MEMORY_FRAMES);
            }
        }
        if self.is_sure && desk.params.learning > 0.0 {
            let template = &mut self.templates[self.current];
            desk.lay(template);
            desk.learn(template, picture, fit);
        }
    }

    /// It was not found: it is carried along.
    fn hide(&mut self, picture: &Gray<'_>, desk: &Desk<'_>, carried: Point) {
        /// What is kept of speed, and of the place aside from the neighbours' word, from frame to frame.
        const FADE: f32 = 0.75;
        self.n_hidden += 1;
        self.at = carried;
        self.speed = self.speed.map(|c| FADE * c);
        self.aside = self.aside.map(|c| FADE * c);
        self.state = if !holds(picture, self.at) {
            State::Outside
        } else if self.n_hidden > desk.params.patience {
            State::Lost
        } else {
            State::Occluded
        };
    }
}

/// The place where the template on the desk correlates best.
fn best(desk: &mut Desk<'_>, picture: &Gray<'_>, places: &[(Point, Warp)]) -> (Point, Warp) {
    let mut best = (places[0], f32::MIN);
    for &(at, warp) in places {
        let ncc = desk.compare(picture, at, warp);
        if ncc > best.1 {
            best = ((at, warp), ncc);
        }
    }
    best.0
}

/// Whether a position lies on the picture's pixels.
pub(super) fn holds(picture: &Gray<'_>, [x, y]: Point) -> bool {
    (-0.5..=picture.width as f32 - 0.5).contains(&x) && (-0.5..=picture.height as f32 - 0.5).contains(&y)
}
