//! SIFT: a point is carried by the key-point nearest to it, which is found again by its descriptor.

use std::collections::BTreeMap;

use honami_plugin::{Cx, Info, Result};
use honami_vision::Point;
use opencv::core::{KeyPoint, Mat, Ptr, Vector, no_array};
use opencv::features2d::SIFT;
use opencv::prelude::*;

use crate::follow::{Method, Step};
use crate::settings::{SiftSettings, Template};

/// Numbers of a descriptor.
const WIDTH: usize = 128;
/// Length that OpenCV gives to descriptors.
const LENGTH: f32 = 512.0;
/// Key-points no farther apart than this are the same place, seen at another scale or angle, pixels.
const SAME_PX: f32 = 2.0;
/// Points that are looked for between two looks for a cancel.
const POINTS_A_LOOK: usize = 500;

/// Follows key-points by their descriptors.
pub(crate) struct Sift {
    settings: SiftSettings,
    engine: Ptr<SIFT>,
    /// Of the frame before, where it was pushed here.
    last: Option<Keypoints>,
    carriers: BTreeMap<u32, Carrier>,
}

/// The key-point that carries a point.
struct Carrier {
    /// As it was described.
    key: Key,
    descriptor: Vec<f32>,
    /// From the key-point to the point when it was described, pixels.
    offset: [f32; 2],
    /// Where it was last found.
    at: Point,
}

#[derive(Clone, Copy)]
struct Key {
    at: Point,
    size_px: f32,
    /// From x towards y, radians.
    angle: f32,
}

/// The key-points of a frame, from the top down, with their descriptors in the same order.
struct Keypoints {
    keys: Vec<Key>,
    descriptors: Vec<f32>,
}

impl Method for Sift {
    type Params = SiftSettings;
    const INFO: Info = Info {
        id: "org.honami.opencv-sift",
        name: "OpenCV SIFT",
        doc: "OpenCV's `SIFT`: a point is carried by the key-point nearest to it where it was seeded. In every frame the key-point with \
              the most similar descriptor near where it was last found carries it on, turned and scaled as the key-point is. A point \
              whose key-point is not found is lost, and comes back when it is.",
        cite: &["Lowe 2004", "opencv.org"],
        ..Info::NEW
    };
    const RETURNS: bool = true;
    // The order of key-points, and with it which of two equal ones is taken, depends on the threads.
    const SCALES: bool = false;

    fn begin(settings: &SiftSettings) -> Result<Self> {
        // OpenCV divides the contrast by the layers of an octave.
        let (all, layers, sigma) = (0, 3, 1.6);
        let contrast = settings.contrast * f64::from(layers);
        let engine = SIFT::create(all, layers, contrast, settings.edge, sigma)?;
        Ok(Self { settings: settings.clone(), engine, last: None, carriers: BTreeMap::new() })
    }

    fn follow(&mut self, before: &Mat, now: &Mat, from: &[(u32, Point)], cx: &Cx<'_>) -> Result<Vec<Step>> {
        let before = match self.last.take() {
            _ if from.is_empty() => return Ok(Vec::new()),
            Some(keypoints) => keypoints,
            None => self.keypoints(before)?,
        };
        cx.progress(0.2, "finding key-points")?;
        let now = self.keypoints(now)?;
        let mut steps = Vec::with_capacity(from.len());
        for (k, &(id, at)) in from.iter().enumerate() {
            if k % POINTS_A_LOOK == 0 {
                cx.progress(0.5 + 0.5 * k as f64 / from.len() as f64, "matching")?;
            }
            steps.push(self.step(&before, &now, id, at));
        }
        self.last = Some(now);
        Ok(steps)
    }

    fn forget(&mut self, id: u32) {
        self.carriers.remove(&id);
    }
}

impl Sift {
    fn step(&mut self, before: &Keypoints, now: &Keypoints, id: u32, at: Point) -> Step {
        let carrier = match self.carriers.entry(id) {
            std::collections::btree_map::Entry::Occupied(entry) => entry.into_mut(),
            std::collections::btree_map::Entry::Vacant(entry) => {
                let reach = self.settings.reach as f32;
                let Some(carrier) = before.nearest(at, reach).map(|k| before.carrier(k, at)) else {
                    return Step::LOST;
                };
                entry.insert(carrier)
            }
        };
        let Some(k) = now.matching(carrier, &self.settings) else { return Step::LOST };
        let key = now.keys[k];
        let to = carrier.carried(key);
        carrier.at = key.at;
        if self.settings.template == Template::Last {
            *carrier = now.carrier(k, to);
        }
        Step { to, is_found: true, fb: None }
    }

    fn keypoints(&mut self, picture: &Mat) -> opencv::Result<Keypoints> {
        let (mut found, mut descriptors) = (Vector::<KeyPoint>::new(), Mat::default());
        self.engine.detect_and_compute(picture, &no_array(), &mut found, &mut descriptors, false)?;
        if found.is_empty() {
            return Ok(Keypoints { keys: Vec::new(), descriptors: Vec::new() });
        }
        let rows = descriptors.data_typed::<f32>()?;
        let mut order: Vec<(Key, &[f32])> =
            found.iter().map(Key::new).zip(rows.chunks_exact(WIDTH)).collect();
        let of = |key: &Key| [key.at[1], key.at[0], key.size_px, key.angle];
        order.sort_by(|(a, _), (b, _)| {
            of(a)
                .iter()
                .zip(of(b))
                .map(|(a, b)| a.total_cmp(&b))
                .find(|o| o.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let keys = order.iter().map(|&(key, _)| key).collect();
        Ok(Keypoints { keys, descriptors: order.iter().flat_map(|&(_, row)| row).copied().collect() })
    }
}

impl Key {
    fn new(found: KeyPoint) -> Self {
        let at = found.pt();
        Self { at: [at.x, at.y], size_px: found.size(), angle: found.angle().to_radians() }
    }
}

impl Carrier {
    /// Where the point is, if this key-point is the one that carries it.
    fn carried(&self, key: Key) -> Point {
        let scale = key.size_px / self.key.size_px;
        let (sin, cos) = (key.angle - self.key.angle).sin_cos();
        let [x, y] = self.offset;
        [key.at[0] + scale * (cos * x - sin * y), key.at[1] + scale * (sin * x + cos * y)]
    }
}

impl Keypoints {
    fn descriptor(&self, k: usize) -> &[f32] {
        &self.descriptors[k * WIDTH..][..WIDTH]
    }

    fn carrier(&self, k: usize, point: Point) -> Carrier {
        let key = self.keys[k];
        let offset = [point[0] - key.at[0], point[1] - key.at[1]];
        Carrier { key, descriptor: self.descriptor(k).to_vec(), offset, at: key.at }
    }

    /// Those at most `radius` away, with their distances.
    fn near(&self, at: Point, radius: f32) -> impl Iterator<Item = (usize, f32)> {
        let first = self.keys.partition_point(|key| key.at[1] < at[1] - radius);
        let rows = self.keys[first..].iter().take_while(move |key| key.at[1] <= at[1] + radius);
        let with_distance = rows.enumerate().map(move |(k, key)| (first + k, distance(key.at, at)));
        with_distance.filter(move |&(_, distance)| distance <= radius)
    }

    fn nearest(&self, at: Point, reach: f32) -> Option<usize> {
        self.near(at, reach).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// The key-point with the most similar descriptor, if it is similar, and no other place has one nearly as similar.
    fn matching(&self, carrier: &Carrier, settings: &SiftSettings) -> Option<usize> {
        let differ = |k: usize| {
            let pairs = self.descriptor(k).iter().zip(&carrier.descriptor);
            pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt() / LENGTH
        };
        let near = self.near(carrier.at, settings.search as f32);
        let candidates: Vec<_> = near.map(|(k, _)| (k, differ(k))).collect();
        let &(best, least) = candidates.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let elsewhere = |k: usize| distance(self.keys[k].at, self.keys[best].at) > SAME_PX;
        let second =
            candidates.iter().filter(|&&(k, _)| elsewhere(k)).map(|&(_, d)| d).min_by(f32::total_cmp);
        let is_alone = second.is_none_or(|second| least <= settings.ratio as f32 * second);
        (least <= settings.difference as f32 && is_alone).then_some(best)
    }
}

fn distance(a: Point, b: Point) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
