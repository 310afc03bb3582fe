//! Follows points without drift: each is looked for as its key-frame shows it, where its neighbours say it is.
//!
//! A tracker that compares each frame with the one before adds up its errors, and once it has slid onto something
//! else it stays there. Here a point keeps a template from its key-frame (its seed), and in every frame
//!
//! 1. pyramidal Lucas-Kanade from the frame before, and the point's own speed, predict where it is;
//! 2. the template is fitted there: position, turn, stretch, shear, gain and offset together (`anchor/refine.rs`);
//! 3. points that were found well carry the others: those that have kept their distance since they were related most
//!    likely ride on the same branch, and a turn and a shift fitted to them says where the rest is, seen or not
//!    (`anchor/neighbours.rs`);
//! 4. a point that was not found well is looked for around that place, by correlation on every pixel
//!    (`anchor/search.rs`), and fitted again;
//! 5. what correlates too little, or is too far from where the neighbours say, is hidden: it is carried along by its
//!    neighbours, and found again when it can be seen again. The more a template looks like what is around it, the
//!    less its correlation says, and the more the neighbours do.
//!
//! A point that has few neighbours is given companions: corners around it, followed like the rest and not reported.
//! Each template learns which of its pixels move with the point and which belong to something before or behind it.
//! Results of a point therefore depend on which others are followed: the tracker is *joint*.
//!
//! Thesis 2.4.1 (correlation) and 2.4.3 (Lucas-Kanade); the combination is this project's.

#![expect(clippy::needless_range_loop, reason = "lanes and coefficients run through several arrays at once")]

mod companions;
mod kernel;
mod live;
mod neighbours;
mod refine;
mod saved;
mod search;
mod template;
#[cfg(test)]
mod tests;
mod warp;

pub use saved::Saved;

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::pyramid::Pyramid;
use crate::{Gray, Point, klt, simd};
use live::Live;
use neighbours::Seen;
use template::Desk;

/// How to track.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Radius of the template, pixels, at least 2; its side is `2r + 1`.
    pub radius_px: u32,
    /// Standard deviation of the bell that weighs the template's pixels, pixels.
    pub spread_px: f32,
    /// How far from where it is expected a point is looked for, pixels on each axis.
    pub search_px: u32,
    /// The prediction from the frame before.
    pub klt: klt::Params,
    /// A point that correlates less, after what [`stray_cost`](Self::stray_cost) takes off, is hidden.
    pub accept: f32,
    /// A point that correlates as much, and better than its template did anywhere else around it, carries its
    /// neighbours, and teaches its template.
    pub sure: f32,
    /// A fit that correlates as much is not searched for elsewhere.
    pub good: f32,
    /// Steps of a fit, at most.
    pub max_steps: u32,
    /// A shorter step ends a fit, pixels.
    pub epsilon_px: f32,
    /// A pixel that is off by as much counts a quarter in a fit, gray levels.
    pub outlier_gray: f32,
    /// What turning, growing and shearing cost in a fit, in units of the template's own evidence.
    pub stiffness: [f32; 3],
    /// How fast a template learns which pixels are its own, 0..=1 a frame.
    pub learning: f32,
    /// A pixel that is usually off by as much counts half, gray levels.
    pub doubt_gray: f32,
    /// Neighbours that a point is related to, at most; 0: each point by itself.
    pub neighbours: u32,
    /// Corners around it that are followed for the sake of a point with fewer neighbours; 0: none.
    pub companions: u32,
    /// Neighbours whose distance changes by as much count a quarter, pixels.
    pub kin_px: f32,
    /// What correlation a point loses for each squared standard deviation off its neighbours' word, if nothing around
    /// looked like it in its key-frame; where something correlated `c`, `1 / (1 - c)` times as much.
    pub stray_cost: f32,
    /// What correlation a point loses for the squared logarithm of its contrast over the template's.
    pub contrast_cost: f32,
    /// A point that was hidden must correlate by as much more to be found again.
    pub return_cost: f32,
    /// A point that has been hidden for more frames in a row is lost.
    pub patience: u32,
    /// Key-frames whose templates a point keeps, at least 1.
    pub max_templates: u32,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            radius_px: 7,
            spread_px: 5.0,
            search_px: 4,
            klt: klt::Params { radius_px: 7, max_iterations: 10, epsilon_px: 0.03, ..klt::Params::default() },
            accept: 0.4,
            sure: 0.7,
            good: 0.85,
            max_steps: 5,
            epsilon_px: 0.03,
            outlier_gray: 10.0,
            stiffness: [0.005, 0.05, 0.05],
            learning: 0.1,
            doubt_gray: 10.0,
            neighbours: 32,
            companions: 24,
            kin_px: 3.0,
            stray_cost: 0.015,
            contrast_cost: 0.1,
            return_cost: 0.1,
            patience: 250,
            max_templates: 3,
        }
    }
}

impl Params {
    /// What a point costs, the usual one's being 1: by the areas of its window and of its search.
    fn effort(&self) -> f64 {
        /// Looks at a window in a fit and in predictions, beside those of a search.
        const LOOKS: f64 = 200.0;
        let area = |radius: u32| (2.0 * f64::from(radius) + 1.0).powi(2);
        let of = |params: &Self| area(params.radius_px) * (LOOKS + area(params.search_px));
        of(self) / of(&Self::default())
    }
}

/// What is known of a point in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// Found.
    Tracked,
    /// Hidden; the position is where its neighbours, or its last motion, carry it.
    Occluded,
    /// Beyond the picture.
    Outside,
    /// Hidden for too long: no longer looked for until it is seeded again.
    Lost,
}

/// A point in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The seed's id.
    pub id: u32,
    /// Position, always finite.
    pub at: Point,
    /// What is known of it.
    pub state: State,
    /// How far from the position before Lucas-Kanade leads back from this one, pixels; of points found in both frames.
    pub fb: Option<f32>,
    /// Correlation with the key-frame's template, -1..=1; of points that were found.
    pub ncc: Option<f32>,
}

/// Points of the usual window that a thread works on between two looks at whether to go on: some ten milliseconds.
const POINTS_A_LOOK: usize = 512;
/// Fewer points of the usual window than this are not worth a thread.
const POINTS_A_THREAD: usize = 32;

/// Points and their templates, frame after frame.
#[derive(Debug)]
pub struct Tracker {
    params: Params,
    simd: simd::Level,
    n_threads: usize,
    /// Of the picture pushed last, and of the one before it (whose memory the next picture takes).
    pyramids: Option<[Pyramid; 2]>,
    /// In the order of their ids.
    live: Vec<Live>,
    /// Seedings so far.
    n_seeds: u32,
    /// Whether points have come or gone since they were related.
    is_changed: bool,
}

impl Tracker {
    /// A tracker of no points, that works on up to `max_threads` threads.
    #[must_use]
    pub fn new(params: Params, max_threads: usize) -> Self {
        Self::at_level(simd::best(), params, max_threads)
    }

    /// [`new`](Self::new) with the kernels of a chosen level; the answer is the same, only the time differs.
    #[must_use]
    pub fn at_level(simd: simd::Level, params: Params, max_threads: usize) -> Self {
        let params = Params { radius_px: params.radius_px.max(2), ..params };
        let n_threads = max_threads.max(1);
        Self { params, simd, n_threads, pyramids: None, live: Vec::new(), n_seeds: 0, is_changed: false }
    }

    /// Adds points, or moves those that are there, `(id, position)` in the picture pushed last (or in the first).
    ///
    /// This is a key-frame of the point: it is looked for as it looks here from now on. Templates of its older
    /// key-frames are kept as long as they, too, are found here.
    pub fn seed(&mut self, seeds: impl IntoIterator<Item = (u32, Point)>) {
        let mut fresh = Vec::new();
        let mut desk = Desk::new(&self.params, self.simd);
        let picture = self.pyramids.as_ref().map(|[last, _]| last.picture());
        for (id, at) in seeds {
            self.n_seeds += 1;
            let id = u64::from(id);
            match self.live.binary_search_by_key(&id, |point| point.id) {
                Ok(slot) => self.live[slot].reseed(at, self.n_seeds, picture.as_ref(), &mut desk),
                Err(_) => fresh.push(Live::new(id, at, self.n_seeds, picture.as_ref(), &desk)),
            }
        }
        self.live.extend(fresh);
        // The last of several seeds of one id counts.
        self.live.sort_by_key(|point| (point.id, std::cmp::Reverse(point.stamp)));
        self.live.dedup_by_key(|point| point.id);
        self.is_changed = true;
    }

    /// Forgets points; what is not followed is left out.
    pub fn retire(&mut self, ids: impl IntoIterator<Item = u32>) {
        let ids: BTreeSet<u64> = ids.into_iter().map(u64::from).collect();
        let n_before = self.live.len();
        self.live.retain(|point| !ids.contains(&point.id));
        self.is_changed |= self.live.len() < n_before;
    }

    /// Width and height of the pictures, once there was one.
    #[must_use]
    pub fn size(&self) -> Option<(u32, u32)> {
        self.pyramids.as_ref().map(|[last, _]| (last.picture().width, last.picture().height))
    }

    /// Follows all points into the next picture; what is known of them then is in [`rows`](Self::rows).
    ///
    /// `go_on` is asked with the share of the work that is done, every ten milliseconds or so.
    ///
    /// # Errors
    /// What `go_on` says; the tracker cannot be used after that.
    ///
    /// # Panics
    /// When the picture has no pixels, or is of another size than those before.
    #[track_caller]
    pub fn push<E>(
        &mut self,
        picture: &Gray<'_>,
        mut go_on: impl FnMut(f64) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.pyramids.is_some() && std::mem::take(&mut self.is_changed) {
            self.relate(&mut |share| go_on(0.2 * share))?;
        }
        let Self { params, pyramids, live, .. } = self;
        let Some([last, spare]) = pyramids else {
            let first = Pyramid::new(picture, params.klt.levels, params.klt.radius_px);
            let desk = Desk::new(params, self.simd);
            live.iter_mut().for_each(|point| point.begin(picture, &desk));
            *pyramids = Some([first.clone(), first]);
            return Ok(());
        };
        std::mem::swap(last, spare);
        last.fill(picture);
        self.predict(&mut |share| go_on(0.2 + 0.4 * share))?;
        self.settle(&mut |share| go_on(0.6 + 0.25 * share))?;
        self.measure_back(&mut |share| go_on(0.85 + 0.15 * share))
    }

    /// What is known of every point, in the order of their ids.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row> {
        let n = self.live.partition_point(|point| !point.is_companion());
        self.live[..n].iter().map(Live::row)
    }

    /// Finds out who is near whom, in the picture pushed last, and gives company to those who are alone.
    fn relate<E>(&mut self, go_on: &mut dyn FnMut(f64) -> Result<(), E>) -> Result<(), E> {
        let Self { params, simd, pyramids, live, n_seeds, .. } = self;
        let Some([last, _]) = pyramids else { return Ok(()) };
        let is_idle = live.first().is_none_or(Live::is_companion);
        live.retain(|point| !is_idle && !point.is_spent());
        neighbours::relate(live, params, &mut |share| go_on(0.4 * share))?;
        let joined = companions::join(live, &last.picture(), params, *simd, n_seeds, &mut |share| {
            go_on(0.4 + 0.2 * share)
        });
        if joined? {
            neighbours::relate(live, params, &mut |share| go_on(0.6 + 0.4 * share))?;
        }
        Ok(())
    }

    /// Points that are worked on between two looks at whether to go on: the fewer, the more work each is.
    fn points_a_look(&self) -> usize {
        (POINTS_A_LOOK as f64 / self.params.effort()).ceil() as usize * self.n_threads
    }

    /// Looks for every point by itself: where Lucas-Kanade and its own speed lead.
    fn predict<E>(&mut self, go_on: &mut dyn FnMut(f64) -> Result<(), E>) -> Result<(), E> {
        let Some([now, before]) = &self.pyramids else { return Ok(()) };
        let (picture, last) = (now.picture(), before.picture());
        let (n, n_look) = (self.live.len(), self.points_a_look());
        for (k, part) in self.live.chunks_mut(n_look).enumerate() {
            go_on((k * n_look) as f64 / n as f64)?;
            let from: Vec<Point> = part.iter().filter(|p| p.is_sought()).map(|p| p.at).collect();
            let flows = klt::track_at(self.simd, before, now, &from, None, &self.params.klt, self.n_threads);
            let mut flows = flows.into_iter();
            for point in part.iter_mut() {
                point.flow = if point.is_sought() { flows.next() } else { None };
            }
            each(part, &self.params, self.simd, self.n_threads, |desk, point| {
                point.predict(&last, &picture, desk)
            });
        }
        Ok(())
    }

    /// Looks again for those that are not sure, where their neighbours say; then notes who goes with whom.
    fn settle<E>(&mut self, go_on: &mut dyn FnMut(f64) -> Result<(), E>) -> Result<(), E> {
        let Some([now, _]) = &self.pyramids else { return Ok(()) };
        let picture = now.picture();
        let (n, n_look) = (self.live.len(), self.points_a_look());
        let seen: Vec<Seen> = self.live.iter().map(Live::seen).collect();
        for (k, part) in self.live.chunks_mut(n_look).enumerate() {
            go_on((k * n_look) as f64 / n as f64)?;
            each(part, &self.params, self.simd, self.n_threads, |desk, point| {
                point.settle(&picture, &seen, desk);
            });
        }
        let seen: Vec<Seen> = self.live.iter().map(Live::seen).collect();
        for part in self.live.chunks_mut(n_look) {
            go_on(1.0)?;
            each(part, &self.params, self.simd, self.n_threads, |_, point| neighbours::note(point, &seen));
        }
        Ok(())
    }

    /// Follows the points that were found back into the picture before.
    fn measure_back<E>(&mut self, go_on: &mut dyn FnMut(f64) -> Result<(), E>) -> Result<(), E> {
        let Some([now, before]) = &self.pyramids else { return Ok(()) };
        let (n, n_look) = (self.live.len(), self.points_a_look());
        for (k, part) in self.live.chunks_mut(n_look).enumerate() {
            go_on((k * n_look) as f64 / n as f64)?;
            let from: Vec<Point> = part.iter().filter(|p| p.is_found_twice()).map(|p| p.at).collect();
            let back = klt::track_at(self.simd, now, before, &from, None, &self.params.klt, self.n_threads);
            for (point, back) in part.iter_mut().filter(|p| p.is_found_twice()).zip(back) {
                point.note_back(&back);
            }
        }
        Ok(())
    }
}

/// Does the same with every point, on up to so many threads, each with a desk of its own.
fn each(
    live: &mut [Live],
    params: &Params,
    simd: simd::Level,
    max_threads: usize,
    work: impl Fn(&mut Desk<'_>, &mut Live) + Sync,
) {
    let n_worth = (live.len() as f64 * params.effort()) as usize / POINTS_A_THREAD;
    let n_threads = max_threads.min(n_worth).min(live.len()).max(1);
    let chunk = live.len().div_ceil(n_threads).max(1);
    let run = |part: &mut [Live]| {
        let mut desk = Desk::new(params, simd);
        part.iter_mut().for_each(|point| work(&mut desk, point));
    };
    std::thread::scope(|scope| {
        let mut parts = live.chunks_mut(chunk);
        let first = parts.next();
        for part in parts {
            scope.spawn(|| run(part));
        }
        if let Some(part) = first {
            run(part);
        }
    });
}
