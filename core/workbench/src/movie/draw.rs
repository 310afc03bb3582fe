//! What is drawn over a frame.
//!
//! What was measured is filled; what was predicted or put between is hollow, what is lost is crossed out, and what has left
//! the picture or was rejected is not drawn. Nothing is decided by what a frame looks like, so that nothing flickers.

use std::ops::Range;
use std::sync::Arc;

use honami_model::clip::FrameTimes;
use honami_model::skeleton::seen;
use honami_model::track::{Sample, Source, Span, Status};
use honami_motion::overlay::{Dial, Disc, Mapping, disc_radius, paint_discs, usual_speed, velocity};
use honami_scene::paint::{Canvas, Ink, Point};
use honami_scene::palette::{self, DARK, FORK, KEY, UNSEEN};
use honami_structure::ellipse::Ellipse;

use super::lens::Lens;
use super::words::{Label, labels, stamp, wheel};
use super::{Drawn, Layer};

/// Radius of a mark, in units of the lens; and no more than this share of the usual distance between tracks.
const MARK: f64 = 2.6;
const CROWDED: f64 = 0.2;
/// Widths, in units.
const TRAIL: f64 = 1.5;
const BONE: f64 = 2.6;
const OUTLINE: f64 = 1.6;
const ARROW: f64 = 1.5;
/// How far dark reaches beyond what must be seen on light ground.
const HALO: f64 = 0.9;
/// An arrow of the usual speed is this share of the smaller side long.
const ARROW_LENGTH: f64 = 0.06;
/// Pixels of a terminal's picture, down: discs of motion are as large beside the picture as there.
const TERMINAL: f64 = 160.0;
/// Fewer tracks say nothing of where a group ends.
const FEWEST: usize = 3;

/// A track, and its group.
pub(super) struct Shown {
    pub(super) group: Option<u32>,
    pub(super) span: Arc<Span>,
}

/// All that is drawn, frame by frame.
pub(super) struct Drawing<'a> {
    times: &'a FrameTimes,
    lens: &'a Lens,
    of: &'a Drawn,
    trail_s: f64,
    speed: f64,
    /// One past the last frame that is shown.
    end: u32,
    /// The usual speed, px/s.
    usual: Option<f64>,
    mark: f64,
    labels: Vec<Label>,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(
        times: &'a FrameTimes,
        lens: &'a Lens,
        of: &'a Drawn,
        frames: &Range<u32>,
        (trail_s, speed): (f64, f64),
    ) -> Self {
        let spans: Vec<&Span> = of.tracks.iter().map(|track| &*track.span).collect();
        let is_fast = [Layer::Motion, Layer::Arrows].iter().any(|layer| of.show.contains(layer));
        let pixels = f64::from(lens.size[0]) * f64::from(lens.size[1]);
        let crowded = CROWDED * (pixels / of.tracks.len().max(1) as f64).sqrt();
        Self {
            times,
            lens,
            of,
            trail_s,
            speed,
            end: frames.end,
            usual: if is_fast { usual_speed(&spans, times) } else { None },
            mark: (MARK * lens.unit).min(crowded.max(1.0)),
            labels: if of.show.contains(&Layer::Labels) { labels(of, lens) } else { Vec::new() },
        }
    }

    /// What of that which was asked for there is not.
    pub(super) fn note(&self) -> Option<String> {
        let wanted = [Layer::Motion, Layer::Arrows].into_iter().filter(|layer| self.of.show.contains(layer));
        let words: Vec<_> = wanted.map(Layer::word).collect();
        let is_still = !words.is_empty() && self.usual.is_none();
        is_still.then(|| format!("nothing moves: there is no {} to be seen", words.join(" and no ")))
    }

    /// Bones that are drawn: copies are seen where what they are copies of is.
    pub(super) fn n_bones(&self) -> usize {
        self.bones().count()
    }

    fn bones(&self) -> impl Iterator<Item = usize> {
        let growth = self.of.growth.iter();
        growth.flat_map(|growth| {
            let copy_of = |row: usize| growth.bones.copy_of.get(row).copied().flatten();
            (1..growth.skeleton.joints().len()).filter(move |row| copy_of(*row).is_none())
        })
    }

    /// A frame of the clip with everything drawn on it.
    pub(super) fn draw(&self, pixels: Vec<[u8; 3]>, frame: u32) -> Canvas {
        let [width, height] = self.lens.size;
        let mut canvas = Canvas::new(pixels, width, height);
        for layer in &self.of.show {
            match layer {
                Layer::Motion => self.motion(&mut canvas, frame),
                Layer::Trails => {
                    self.of.tracks.iter().for_each(|track| self.trail(&mut canvas, track, frame))
                }
                Layer::Groups => self.groups(&mut canvas, frame),
                Layer::Skeleton => self.skeleton(&mut canvas, frame),
                Layer::Tracks => self.tracks(&mut canvas, frame),
                Layer::Arrows => self.arrows(&mut canvas, frame),
                Layer::Labels => self.labels.iter().for_each(|label| label.draw(&mut canvas, self.lens.unit)),
                Layer::Time => {
                    let time_s = self.times.get(frame).unwrap_or_default();
                    stamp(&mut canvas, self.lens.unit, (frame, self.end), time_s, self.speed);
                }
            }
        }
        canvas
    }

    fn place(&self, sample: &Sample) -> Point {
        self.lens.at([sample.x, sample.y].map(f64::from))
    }

    fn motion(&self, canvas: &mut Canvas, frame: u32) {
        let Some(usual) = self.usual else { return };
        let mapping = Mapping { gain_s_px: 1.0 / usual, dial: Dial::ALL };
        let disc = |track: &Shown| {
            let at = self.place(track.span.get(frame)?);
            Some(Disc { at, tint: mapping.tint(velocity(&track.span, self.times, frame)?)? })
        };
        let discs: Vec<Disc> = self.of.tracks.iter().filter_map(disc).collect();
        let is_seen = |track: &&Shown| track.span.get(frame).is_some_and(|sample| sample.status.is_seen());
        let n_seen = self.of.tracks.iter().filter(is_seen).count();
        let coarse = (f64::from(self.lens.size[1]) / TERMINAL).max(1.0);
        let n_pixels = canvas.pixels().len() as f64 / (coarse * coarse);
        let radius = coarse * disc_radius(n_seen, n_pixels as usize);
        let columns = canvas.width();
        paint_discs(canvas.pixels_mut(), columns, &discs, [radius; 2]);
        wheel(canvas, self.lens.unit, &mapping, usual);
    }

    fn trail(&self, canvas: &mut Canvas, track: &Shown, frame: u32) {
        let time = |frame: u32| self.times.get(frame).unwrap_or_default();
        let now_s = time(frame);
        let left = |frame: u32| 1.0 - (now_s - time(frame)) / self.trail_s;
        let first = (0..=frame).rev().take_while(|&frame| left(frame) >= 0.0).last().unwrap_or(frame);
        let ink = Ink::opaque(palette::group(track.group)).times(0.9);
        let mut run: Vec<Point> = Vec::new();
        for of in first..=frame + 1 {
            let sample = track.span.get(of).filter(|sample| of <= frame && sample.status.is_seen());
            if let Some(sample) = sample {
                run.push(self.place(sample));
            } else if !run.is_empty() {
                // Where it was not seen there is a gap.
                let fade = [of - run.len() as u32, of - 1].map(left);
                canvas.trail(&run, TRAIL * self.lens.unit, ink, fade);
                run.clear();
            }
        }
    }

    fn groups(&self, canvas: &mut Canvas, frame: u32) {
        for &group in self.of.names.keys() {
            let of_it = self.of.tracks.iter().filter(|track| track.group == Some(group));
            let known = |sample: &&Sample| sample.status.is_seen() || sample.status == Status::Occluded;
            let places: Vec<Point> = of_it
                .filter_map(|track| track.span.get(frame).filter(known))
                .map(|sample| self.place(sample))
                .collect();
            let Some(ellipse) = Ellipse::of(&places).filter(|_| places.len() >= FEWEST) else { continue };
            let ([c, s], [long, short]) = (ellipse.axis, ellipse.reach);
            let half_axes = [[c * long, s * long], [-s * short, c * short]];
            let ink = Ink::opaque(palette::group(Some(group)));
            canvas.ellipse(ellipse.centre, half_axes, ink.times(0.12));
            let width = OUTLINE * self.lens.unit;
            canvas.ellipse_outline(ellipse.centre, half_axes, width, ink.times(0.9));
        }
    }

    fn skeleton(&self, canvas: &mut Canvas, frame: u32) {
        let Some(growth) = self.of.growth.as_ref().filter(|growth| growth.frames.contains(&frame)) else {
            return;
        };
        let skeleton = &growth.skeleton;
        let joints = skeleton.joints();
        let places = skeleton.places(skeleton.directions(frame - growth.frames.start));
        let at = |row: usize| self.lens.at(seen(places[row]));
        let (unit, halo) = (self.lens.unit, Ink::opaque(DARK).times(0.55));
        let bones: Vec<(Point, Point, Ink)> = self
            .bones()
            .filter_map(|row| {
                let parent = joints[row].parent? as usize;
                let colour = joints[row].groups.first().map_or(FORK, |group| palette::group(Some(*group)));
                Some((at(parent), at(row), Ink::opaque(colour)))
            })
            .collect();
        for (from, to, _) in &bones {
            canvas.line(*from, *to, (BONE + 2.0 * HALO) * unit, halo);
        }
        for (from, to, ink) in &bones {
            canvas.line(*from, *to, BONE * unit, *ink);
        }
        for (_, to, ink) in &bones {
            canvas.disc(*to, (BONE + HALO) * unit * 0.75, halo);
            canvas.disc(*to, BONE * unit * 0.75, *ink);
        }
        canvas.disc(at(0), (2.0 * BONE) * unit * 0.75, halo);
        canvas.disc(at(0), 1.6 * BONE * unit * 0.75, Ink::opaque([255; 3]));
    }

    fn tracks(&self, canvas: &mut Canvas, frame: u32) {
        let halo = (HALO * self.lens.unit).min(self.mark / 2.0);
        for track in &self.of.tracks {
            let Some(sample) = track.span.get(frame) else { continue };
            let (at, ink) = (self.place(sample), Ink::opaque(palette::group(track.group)));
            let dark = Ink::opaque(DARK).times(0.55);
            match sample.status {
                Status::Outside | Status::Rejected => continue,
                Status::Lost => {
                    let arm = self.mark * 0.8;
                    for way in [[arm, arm], [arm, -arm]] {
                        let [from, to] =
                            [-1.0, 1.0].map(|sign| [at[0] + sign * way[0], at[1] + sign * way[1]]);
                        canvas.line(from, to, self.mark * 0.45, Ink::opaque(UNSEEN).times(0.8));
                    }
                    continue;
                }
                Status::Occluded => hollow(canvas, at, self.mark, ink.times(0.8), dark),
                Status::Tracked | Status::Newborn if sample.source == Source::Interpolated => {
                    hollow(canvas, at, self.mark, ink, dark);
                }
                Status::Tracked | Status::Newborn => {
                    canvas.disc(at, self.mark + halo, dark);
                    canvas.disc(at, self.mark, ink);
                }
            }
            if sample.source == Source::Key {
                canvas.ring(at, self.mark * 2.0, self.mark * 0.6, Ink::opaque(KEY));
            }
        }
    }

    fn arrows(&self, canvas: &mut Canvas, frame: u32) {
        let Some(usual) = self.usual else { return };
        let [width, height] = self.lens.size;
        let px_per_px_s = ARROW_LENGTH * f64::from(width.min(height)) / usual;
        for track in &self.of.tracks {
            let Some(from) = track.span.get(frame).map(|sample| self.place(sample)) else { continue };
            let Some(velocity) = velocity(&track.span, self.times, frame) else { continue };
            let to = [0, 1].map(|axis| from[axis] + px_per_px_s * velocity[axis]);
            let ink = Ink::opaque(palette::group(track.group));
            canvas.arrow(from, to, (ARROW + HALO) * self.lens.unit, Ink::opaque(DARK).times(0.5));
            canvas.arrow(from, to, ARROW * self.lens.unit, ink);
        }
    }
}

/// A mark of what was not measured.
fn hollow(canvas: &mut Canvas, at: Point, radius: f64, ink: Ink, dark: Ink) {
    canvas.ring(at, radius, radius * 0.8, dark);
    canvas.ring(at, radius, radius * 0.45, ink);
}
