//! What every tracker must bear: hard pictures, hard points, and a user who stops it.

mod state;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

use honami_abi::code;

use super::{Deaf, stream};
use crate::tracker::{Detect, Frame, Gray, Point, Points, Seed, Status, Stream, Tracker};
use crate::{Cx, Error, Listener, Result};

/// Runs a tracker over input that is as bad as a host may hand it, and holds every answer against the contract.
///
/// Pictures of 1x1 and 7x5 pixels, flat, saturated and noisy ones, a size that changes; points on borders, far outside,
/// in the same place, none at all and 100,000; seeding again, retiring, streams that run backward; one thread and four;
/// a user who stops it at once; what it saves, loaded whole, cut and damaged. A picture less than 8 pixels wide or high, or of another size than those before, may be
/// refused with [`Error::data`] and a reason; rows may not be doubled, unknown or not finite, nor missing in the first
/// frame; and a push of 100,000 points must ask whether to go on, and stop wherever the answer is no. Points that are
/// not finite never get so far: the host refuses them.
///
/// # Panics
/// Where the tracker breaks the contract, with the case and what it did.
#[track_caller]
pub fn suite<T: Tracker>(params: &T::Params) {
    type Case<P> = (&'static str, fn(&P) -> Result<()>);
    let all: [Case<T::Params>; 9] = [
        ("hard pictures", hard_pictures::<T>),
        ("hard points", hard_points::<T>),
        ("no points", no_points::<T>),
        ("seeding again and retiring", reseeding::<T>),
        ("a size that changes", other_size::<T>),
        ("one thread and four, twice", same_bits::<T>),
        ("100,000 points, and a user who stops", many_points::<T>),
        ("detection and dense motion", extras::<T>),
        ("what it saves", state::carried::<T>),
    ];
    for (name, case) in all {
        if let Err(error) = case(params) {
            panic!("{} in {name}: {error}", T::INFO.id);
        }
    }
}

/// A picture of its own memory.
struct Picture {
    width: u32,
    height: u32,
    data: Vec<u8>,
}

impl Picture {
    fn new(width: u32, height: u32, gray: impl Fn(u32, u32) -> f64) -> Self {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let data = pixels.map(|(x, y)| gray(x, y).round().clamp(0.0, 255.0) as u8).collect();
        Self { width, height, data }
    }

    /// A texture that has moved by (1.3, -0.6) px a frame.
    fn moving(width: u32, height: u32, frame: usize) -> Self {
        let t = frame as f64;
        Self::new(width, height, |x, y| {
            let (x, y) = (f64::from(x) - 1.3 * t, f64::from(y) + 0.6 * t);
            let waves = (0.9 * x + 0.4 * y).sin() + (0.35 * x - 0.8 * y).sin() + (0.21 * x + 0.17 * y).cos();
            128.0 + 40.0 * waves
        })
    }

    /// Noise, another in each frame.
    fn noise(width: u32, height: u32, frame: usize) -> Self {
        Self::new(width, height, |x, y| {
            let mut bits = (u64::from(x) << 40) ^ (u64::from(y) << 20) ^ frame as u64;
            bits = (bits ^ (bits >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
            bits = (bits ^ (bits >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
            ((bits >> 40) & 255) as f64
        })
    }

    fn frame(&self, index: usize) -> Frame<'_> {
        let gray = Gray::packed(&self.data, self.width, self.height);
        Frame::new(gray, index as i64, index as f64 / 25.0)
    }
}

/// A tracker under watch: every row is held against the points that are live.
struct Watched<T> {
    tracker: T,
    live: BTreeSet<u32>,
    births: std::ops::Range<u32>,
    born: BTreeSet<u32>,
    has_begun: bool,
}

impl<T: Tracker> Watched<T> {
    fn begin(params: &T::Params, stream: &Stream) -> Result<Self> {
        let tracker = T::begin(params, stream, &Cx::new(&Deaf))?;
        let births = stream.births.clone();
        Ok(Self { tracker, live: BTreeSet::new(), births, born: BTreeSet::new(), has_begun: false })
    }

    fn seed(&mut self, seeds: &[Seed]) -> Result<()> {
        self.live.extend(seeds.iter().map(|seed| seed.id));
        self.tracker.seed(seeds, &Cx::new(&Deaf))
    }

    fn retire(&mut self, ids: &[u32]) {
        self.tracker.retire(ids);
        ids.iter().for_each(|id| {
            self.live.remove(id);
        });
    }

    fn push(&mut self, frame: &Frame<'_>, listener: &dyn Listener) -> Result<Vec<Point>> {
        let mut out = Points::default();
        out.restart(frame.index);
        self.tracker.push(frame, &mut out, &Cx::new(listener))?;
        if T::LATENCY == 0 {
            self.check(frame.index, out.rows())?;
        }
        Ok(out.rows().to_vec())
    }

    /// The rows of a frame: known ids, each once, finite numbers. A live point without a row has ended.
    fn check(&mut self, frame: i64, rows: &[Point]) -> Result<()> {
        let mut reported = BTreeSet::new();
        for row in rows {
            // A fault is no refusal.
            let at = |what: &str| Err(Error::failed(format!("{what} in frame {frame}: {row:?}")));
            if !reported.insert(row.id) {
                return at("a point has two rows");
            }
            if !(row.x.is_finite() && row.y.is_finite()) {
                return at("a position is not finite");
            }
            if row.fb.is_some_and(|fb| !(0.0..=f32::MAX).contains(&fb))
                || row.ncc.is_some_and(|ncc| !(-1.001..=1.001).contains(&ncc))
            {
                return at("a quality is out of its range");
            }
            let is_birth = row.status == Status::Newborn;
            if is_birth && !(self.births.contains(&row.id) && self.born.insert(row.id)) {
                return at("a birth with an id that is not free");
            }
            if !is_birth && !self.live.contains(&row.id) {
                return at("a row of a point that is not live");
            }
        }
        // What was seeded before the first push holds there; later a tracker may end what it likes.
        if !std::mem::replace(&mut self.has_begun, true)
            && let Some(id) = self.live.difference(&reported).next()
        {
            return Err(Error::failed(format!("point {id} has no row in the first frame")));
        }
        self.live = reported;
        Ok(())
    }
}

fn hard_pictures<T: Tracker>(params: &T::Params) -> Result<()> {
    type Make = fn(u32, u32, usize) -> Picture;
    let kinds: [(&str, Make); 6] = [
        ("moving", Picture::moving),
        ("noise", Picture::noise),
        ("black", |w, h, _| Picture::new(w, h, |_, _| 0.0)),
        ("white", |w, h, _| Picture::new(w, h, |_, _| 255.0)),
        ("black, then white", |w, h, t| Picture::new(w, h, |_, _| if t == 0 { 0.0 } else { 255.0 })),
        ("one edge", |w, h, _| Picture::new(w, h, |x, _| if x < w / 2 { 10.0 } else { 240.0 })),
    ];
    for (kind, make) in kinds {
        for (width, height) in [(1, 1), (7, 5), (3, 90), (64, 48)] {
            let run = |reversed: bool| -> Result<()> {
                let stream = Stream { reversed, births: 1000..1400, ..stream(width, height) };
                let mut watched = Watched::<T>::begin(params, &stream)?;
                let (right, below) = (width as f32 - 0.5, height as f32 - 0.5);
                watched.seed(&[
                    Seed { id: 7, x: width as f32 / 2.0, y: height as f32 / 2.0 },
                    Seed { id: 3, x: -0.5, y: -0.5 },
                    Seed { id: 9, x: right, y: below },
                ])?;
                for t in 0..4 {
                    let index = if reversed { 3 - t } else { t };
                    watched.push(&make(width, height, t).frame(index), &Deaf)?;
                }
                Ok(())
            };
            for reversed in [false, true] {
                let refused = |e: &Error| (width < 8 || height < 8) && !e.to_string().is_empty();
                match run(reversed) {
                    Err(e) if e.code() != code::DATA || !refused(&e) => {
                        return Err(Error::data(format!("{kind}, {width}x{height}: {e}")));
                    }
                    _ => {}
                }
            }
        }
    }
    Ok(())
}

/// Outside, on borders, in one place.
fn places(width: f32, height: f32) -> Vec<Seed> {
    let xs = [-1e30, -5000.0, -9.0, -0.5, 0.0, width / 3.0, width - 1.0, width - 0.5, width + 9.0, 1e30];
    let ys = [-0.5, 0.0, height / 2.0, height - 1.0, height + 400.0];
    let places = xs.iter().flat_map(|&x| ys.iter().flat_map(move |&y| [[x, y], [x, y]]));
    places.zip(0..).map(|([x, y], id)| Seed { id: 3 * id + 1, x, y }).collect()
}

fn hard_points<T: Tracker>(params: &T::Params) -> Result<()> {
    let seeds = places(80.0, 60.0);
    let mut watched = Watched::<T>::begin(params, &stream(80, 60))?;
    watched.seed(&seeds)?;
    for t in 0..5 {
        let rows = watched.push(&Picture::moving(80, 60, t).frame(t), &Deaf)?;
        if t > 0 || T::LATENCY > 0 {
            continue;
        }
        for row in rows.iter().filter(|row| row.status == Status::Tracked) {
            let given = seeds.iter().find(|seed| seed.id == row.id);
            if given.is_some_and(|seed| (seed.x, seed.y) != (row.x, row.y)) {
                return Err(Error::data(format!("frame 0 reports {row:?}, seeded was {given:?}")));
            }
        }
    }
    Ok(())
}

fn no_points<T: Tracker>(params: &T::Params) -> Result<()> {
    let mut watched = Watched::<T>::begin(params, &stream(64, 48))?;
    watched.seed(&[])?;
    watched.retire(&[5]);
    for t in 0..3 {
        watched.push(&Picture::moving(64, 48, t).frame(t), &Deaf)?;
    }
    Ok(())
}

fn reseeding<T: Tracker>(params: &T::Params) -> Result<()> {
    let mut watched = Watched::<T>::begin(params, &stream(64, 48))?;
    let seeds: Vec<Seed> =
        (0..30).map(|id| Seed { id, x: 4.0 + 1.8 * id as f32, y: 40.0 - 1.1 * id as f32 }).collect();
    watched.seed(&seeds)?;
    for t in 0..9 {
        let rows = watched.push(&Picture::moving(64, 48, t).frame(t), &Deaf)?;
        if T::LATENCY == 0 && !(t == 5 || rows.iter().any(|row| row.id == 12)) {
            return Err(Error::data(format!("point 12, seeded or brought back, has no row in frame {t}")));
        }
        match t {
            2 => watched.seed(&[Seed { id: 12, x: 30.0, y: 20.0 }, Seed { id: 77, x: 9.0, y: 9.0 }])?,
            4 => watched.retire(&[12, 3, 3, 999]),
            5 => watched.seed(&[Seed { id: 12, x: 33.0, y: 21.0 }])?,
            _ => {}
        }
    }
    Ok(())
}

fn other_size<T: Tracker>(params: &T::Params) -> Result<()> {
    let mut watched = Watched::<T>::begin(params, &stream(64, 48))?;
    watched.seed(&[Seed { id: 1, x: 20.0, y: 20.0 }])?;
    watched.push(&Picture::moving(64, 48, 0).frame(0), &Deaf)?;
    match watched.push(&Picture::moving(48, 64, 1).frame(1), &Deaf) {
        Err(error) if error.to_string().is_empty() => Err(Error::data("it is refused without a reason")),
        _ => Ok(()),
    }
}

/// Enough points that work is worth sharing, over a few frames.
fn same_bits<T: Tracker>(params: &T::Params) -> Result<()> {
    let run = |max_threads: u32| -> Result<Vec<Vec<Point>>> {
        let stream = Stream { max_threads, births: 5000..6000, ..stream(160, 120) };
        let mut watched = Watched::<T>::begin(params, &stream)?;
        let grid = (0..400_u32).map(|id| {
            let (x, y) = ((id % 25) as f32 * 6.2 + 4.3, (id / 25) as f32 * 7.1 + 3.7);
            Seed { id, x, y }
        });
        watched.seed(&grid.collect::<Vec<_>>())?;
        (0..4).map(|t| watched.push(&Picture::moving(160, 120, t).frame(t), &Deaf)).collect()
    };
    let once = run(1)?;
    for (n_threads, what) in [(1, "a second run"), (4, "four threads")] {
        if run(n_threads)? != once {
            return Err(Error::data(format!("{what} gave other rows than one thread")));
        }
    }
    Ok(())
}

/// Says stop from the n-th question on, and counts them.
struct Stopper {
    asked: AtomicUsize,
    stop_at: usize,
}

impl Listener for Stopper {
    fn progress(&self, _: f64, _: &str) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.stop_at
    }
    fn log(&self, _: i32, _: &str) {}
}

fn many_points<T: Tracker>(params: &T::Params) -> Result<()> {
    const N: u32 = 100_000;
    let mut watched = Watched::<T>::begin(params, &stream(160, 120))?;
    let place = |id: u32| Seed { id, x: (id % 400) as f32 * 0.4, y: (id / 400) as f32 * 0.48 };
    watched.seed(&(0..N).map(place).collect::<Vec<_>>())?;
    watched.push(&Picture::moving(160, 120, 0).frame(0), &Deaf)?;
    let patient = Stopper { asked: AtomicUsize::new(0), stop_at: usize::MAX };
    watched.push(&Picture::moving(160, 120, 1).frame(1), &patient)?;
    let n_asked = patient.asked.load(Ordering::Relaxed);
    if n_asked == 0 {
        return Err(Error::data("nobody was asked whether to go on"));
    }
    // At the first question, half-way, and at the last one: each answer counts.
    for stop_at in [0, n_asked / 2, n_asked - 1] {
        let mut watched = Watched::<T>::begin(params, &stream(160, 120))?;
        watched.seed(&(0..N).map(place).collect::<Vec<_>>())?;
        watched.push(&Picture::moving(160, 120, 0).frame(0), &Deaf)?;
        let stopper = Stopper { asked: AtomicUsize::new(0), stop_at };
        match watched.push(&Picture::moving(160, 120, 1).frame(1), &stopper) {
            Err(error) if error == Error::cancelled() => {}
            Err(error) => return Err(Error::data(format!("told to stop it says: {error}"))),
            Ok(_) if T::LATENCY > 0 => {}
            Ok(_) => return Err(Error::data("told to stop it went on")),
        }
    }
    Ok(())
}

fn extras<T: Tracker>(params: &T::Params) -> Result<()> {
    let pictures = [
        Picture::moving(64, 48, 0),
        Picture::noise(64, 48, 1),
        Picture::new(64, 48, |_, _| 77.0),
        Picture::new(1, 1, |_, _| 9.0),
        Picture::new(7, 5, |x, y| f64::from(30 * x + y)),
    ];
    for picture in &pictures {
        let frame = picture.frame(0);
        let none = vec![0; picture.data.len()];
        let (width, height) = (picture.width, picture.height);
        for (mask, max_features) in [(None, 50), (None, 0), (Some(Gray::packed(&none, width, height)), 50)] {
            let Some(detect) = T::DETECT else { break };
            let points = &[Seed { id: 1, x: 3.0, y: 3.0 }];
            let wanted = Detect { frame, max_features, mask, points, max_threads: 2, seed: 0 };
            let found = detect(params, &wanted, &Cx::new(&Deaf))?;
            let inside = |v: f32, size: u32| (-0.5..size as f32 - 0.5).contains(&v);
            let strange =
                found.iter().find(|f| !(inside(f.x, width) && inside(f.y, height) && f.score.is_finite()));
            if strange.is_some()
                || found.len() > max_features as usize
                || (mask.is_some() && !found.is_empty())
            {
                let text = format!("asked for {max_features} features: {} came, {strange:?}", found.len());
                return Err(Error::data(text));
            }
        }
        let other = Picture::moving(width, height, 1);
        if let Some(field) = T::FIELD {
            let field = field(params, &frame, &other.frame(1), 2, &Cx::new(&Deaf))?;
            let n = field.nx as usize * field.ny as usize;
            let numbers = field.vectors.iter().flatten().flatten().chain(&field.origin);
            if !numbers.into_iter().all(|v| v.is_finite()) || field.vectors.len() != n || field.step <= 0.0 {
                return Err(Error::data(format!("a field of {width}x{height} is damaged")));
            }
        }
    }
    Ok(())
}
