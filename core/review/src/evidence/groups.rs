//! Disagreement with the group: what was found to move together goes on to.

use std::collections::{BTreeMap, BTreeSet};

use honami_model::track::{Span, TrackId};
use nalgebra::Complex;

use super::Evidence;
use super::anchors::{Anchor, Anchors};
use super::neighbours::{geometric_mean, seen};
use super::steps::median;

/// With fewer members that are seen, nothing is said.
const FEWEST: usize = 5;
/// A course that moves less, pixels squared, leads nobody.
const STILL_PX2: f64 = 0.05;
/// Distances below are noise, pixels.
const NOISE_PX: f64 = 0.25;
/// Rounds, at most, in which a gain comes to heed only what agrees with it.
const N_ROUNDS: usize = 8;
/// A gain that a round changes by less is kept.
const SETTLED: f64 = 1e-3;

impl Evidence {
    /// Says what group each track is in, of those that are in one. Returns the tracks whose evidence has changed.
    pub fn group(&mut self, groups: BTreeMap<TrackId, u32>) -> BTreeSet<TrackId> {
        let old = std::mem::replace(&mut self.groups, groups);
        let left = old.keys().filter(|track| !self.groups.contains_key(track));
        let mut touched: BTreeSet<TrackId> = left.copied().collect();
        for track in &touched {
            self.rows.get_mut(track).into_iter().for_each(|row| row.strays_px.clear());
        }
        let groups: BTreeSet<u32> = self.groups.values().copied().collect();
        groups.into_iter().for_each(|group| touched.extend(self.follow(group)));
        touched
    }

    /// Measures anew how a group moves and how far its members stray from it. Returns those for whom that has changed.
    pub(super) fn follow(&mut self, group: u32) -> Vec<TrackId> {
        let groups = &self.groups;
        let is_member = |track: &TrackId| groups.get(track) == Some(&group);
        let members = self.rows.values().filter(|row| is_member(&row.subject.track));
        let course = Course::of(&members.map(|row| row.subject.span.as_ref()).collect::<Vec<_>>());
        let mut changed = Vec::new();
        for (&track, row) in self.rows.iter_mut().filter(|(track, _)| is_member(track)) {
            let strays_px = course.strays_px(&row.subject.span, &row.anchors);
            if !strays_px.iter().map(|px| px.to_bits()).eq(row.strays_px.iter().map(|px| px.to_bits())) {
                row.strays_px = strays_px;
                changed.push(track);
            }
        }
        changed
    }
}

/// How a group moves: in every frame the median of its members' displacements, each from its own median place.
struct Course {
    first_frame: u32,
    /// Pixels; `None` where too few are seen.
    displacements: Vec<Option<[f32; 2]>>,
}

impl Course {
    fn of(members: &[&Span]) -> Self {
        let homes: Vec<Option<[f32; 2]>> = members.iter().map(|span| home(span)).collect();
        let first_frame = members.iter().map(|span| span.first_frame).min().unwrap_or(0);
        let end = members.iter().map(|span| span.frames().end).max().unwrap_or(0);
        let mut moved = Vec::with_capacity(members.len());
        let displacement = |frame| {
            moved.clear();
            moved.extend(members.iter().zip(&homes).filter_map(|(span, home)| {
                let (at, home) = (seen(span, frame)?, (*home)?);
                Some([at[0] - home[0], at[1] - home[1]])
            }));
            let middle = |axis: usize| median(moved.iter().map(|by| by[axis]));
            if moved.len() < FEWEST { None } else { Some([middle(0)?, middle(1)?]) }
        };
        Self { first_frame, displacements: (first_frame..end).map(displacement).collect() }
    }

    fn at(&self, frame: u32) -> Option<Complex<f64>> {
        let known = self.displacements.get(frame.checked_sub(self.first_frame)? as usize)?;
        known.map(complex)
    }

    /// How far each sample is from where the course leads from the anchors around it, pixels, as the geometric mean
    /// over both; NaN where nothing is said. A member follows the course with a gain of its own, which turns and
    /// stretches: a twig's tip moves farther than its foot.
    fn strays_px(&self, span: &Span, anchors: &Anchors) -> Vec<f32> {
        let known = |frame: u32| Some((complex(seen(span, frame)?), self.at(frame)?));
        let gain = gain(&span.frames().filter_map(known).collect::<Vec<_>>());
        let stray = |frame: u32| {
            let (place, course) = known(frame)?;
            let (before, after) = anchors.around(frame);
            let far = |(frame, from): Anchor| {
                let led = complex(from) + gain * (course - self.at(frame)?);
                Some((place - led).norm() as f32)
            };
            geometric_mean([before, after].into_iter().flatten().filter_map(far))
        };
        span.frames().map(|frame| stray(frame).unwrap_or(f32::NAN)).collect()
    }
}

/// The median place.
fn home(span: &Span) -> Option<[f32; 2]> {
    let seen = || span.frames().filter_map(|frame| seen(span, frame));
    Some([median(seen().map(|at| at[0]))?, median(seen().map(|at| at[1]))?])
}

/// The factor that makes the course's displacements those of the track, given its place and the course's in the frames
/// in which both are known: least squares, weighted anew in each round so that what is far off counts little.
fn gain(known: &[(Complex<f64>, Complex<f64>)]) -> Complex<f64> {
    let mut weights = vec![1.0; known.len()];
    let mut gain = Complex::ZERO;
    for _ in 0..N_ROUNDS {
        let weighted = || weights.iter().zip(known);
        let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let place = weighted().map(|(w, (place, _))| place * w).sum::<Complex<f64>>() / total;
        let course = weighted().map(|(w, (_, course))| course * w).sum::<Complex<f64>>() / total;
        let moved = |(at, by): &(Complex<f64>, Complex<f64>)| (at - place, by - course);
        let (mut both, mut power) = (Complex::ZERO, total * STILL_PX2);
        for (w, pair) in weighted() {
            let (at, by) = moved(pair);
            both += at * by.conj() * w;
            power += by.norm_sqr() * w;
        }
        let before = std::mem::replace(&mut gain, both / power);
        if (gain - before).norm() < SETTLED {
            break;
        }
        let off: Vec<f64> =
            known.iter().map(moved).map(|(at, by)| (at - gain * by).norm_sqr().sqrt()).collect();
        let usual = median(off.iter().map(|px| *px as f32)).map_or(NOISE_PX, f64::from).max(NOISE_PX);
        weights.iter_mut().zip(off).for_each(|(w, px)| *w = (usual / px).min(1.0).powi(2));
    }
    gain
}

fn complex([x, y]: [f32; 2]) -> Complex<f64> {
    Complex::new(x.into(), y.into())
}
