//! The tracker against OpenCV's `calcOpticalFlowPyrLK`: same frames, same points, turn by turn, one thread.
//!
//! `klt_bench [DIR] [--pairs N] [--points N] [--repeats N] [--radius R] [--levels L] [--python PYTHON]`
//!
//! DIR holds frames of your own (binary PGM, in order of their names); without it, a texture that turns, grows
//! and drifts is made, whose motion is known. Prints one JSON object. Without Python or OpenCV, `peer` is null.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "klt_bench/frames.rs"]
mod frames;
#[path = "klt_bench/peer.rs"]
mod peer;
#[path = "klt_bench/two_way.rs"]
mod two_way;

use std::time::Instant;

use frames::Frames;
use honami_vision::klt::{self, State};
use honami_vision::pyramid::Pyramid;
use honami_vision::{Point, detect, simd};
use peer::{Peer, PeerTimes};
use serde_json::{Value, json};

/// What the command line asks for.
struct Options {
    frames: Option<std::path::PathBuf>,
    n_pairs: usize,
    n_points: usize,
    repeats: usize,
    python: String,
    params: klt::Params,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let options = options(std::env::args().skip(1))?;
    let frames = match &options.frames {
        Some(folder) => Frames::read(folder, options.n_pairs + 1)?,
        None => Frames::made(960, 720, options.n_pairs + 1),
    };
    let points = starts(&frames, options.n_points);
    let mut peer = match Peer::start(&options.python, &frames, &points, &options.params) {
        Ok(peer) => Some(peer),
        Err(why) => {
            println!("{}", json!({ "peer_missing": why.to_string() }));
            None
        }
    };
    let mut bench = Bench::new(&frames, &points, options.params);
    let mut turns = Vec::new();
    for _ in 0..options.repeats {
        let ours = bench.time(simd::best());
        let theirs = peer.as_mut().map(Peer::time).transpose()?;
        turns.push((ours, theirs));
    }
    let by_set: serde_json::Map<String, Value> = simd::available()
        .map(|level| (level.name().into(), rounded(median(bench.search(level, 1))).into()))
        .collect();
    let by_threads: serde_json::Map<String, Value> = [1, 2]
        .map(|n| (n.to_string(), rounded(median(bench.search(simd::best(), n))).into()))
        .into_iter()
        .collect();
    let mut report = json!({
        "peer": peer.as_ref().map(Peer::name), "picture": format!("{}x{}", frames.width, frames.height),
        "points": points.iter().map(Vec::len).max(), "pairs": points.len(), "repeats": options.repeats, "threads": 1,
        "radius_px": options.params.radius_px, "levels": options.params.levels, "simd": simd::level(),
        "search_ms_by_simd": by_set, "search_ms_by_threads": by_threads, "times": times(&turns),
    });
    let ours = bench.positions();
    let theirs = peer.as_mut().map(Peer::positions).transpose()?;
    report["positions"] = positions(&frames, &points, &ours, theirs.as_deref());
    report["there_and_back"] = two_way::two_way(&options.params, options.repeats);
    println!("{report:#}");
    Ok(())
}

fn options(mut args: impl Iterator<Item = String>) -> Result<Options, Failure> {
    let params = klt::Params::default();
    let mut options =
        Options { frames: None, n_pairs: 8, n_points: 1500, repeats: 15, python: "python3".into(), params };
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(format!("{arg} needs a value"));
        match arg.as_str() {
            "--pairs" => options.n_pairs = value()?.parse()?,
            "--points" => options.n_points = value()?.parse()?,
            "--repeats" => options.repeats = value()?.parse()?,
            "--radius" => options.params.radius_px = value()?.parse()?,
            "--levels" => options.params.levels = value()?.parse()?,
            "--python" => options.python = value()?,
            flag if flag.starts_with('-') => return Err(format!("unknown option {flag}").into()),
            folder => options.frames = Some(folder.into()),
        }
    }
    Ok(options)
}

/// The points to follow from each frame: its strongest corners.
fn starts(frames: &Frames, n_points: usize) -> Vec<Vec<Point>> {
    let params =
        detect::Params { max_corners: n_points, quality: 1e-4, min_distance_px: 4.0, ..Default::default() };
    let corners = |i| detect::corners(&frames.gray(i), None, &[], &params).iter().map(|c| c.at).collect();
    let mut points: Vec<Vec<Point>> = (0..frames.len() - 1).map(corners).collect();
    // One table for the peer: as many in each frame.
    let n = points.iter().map(Vec::len).min().unwrap_or(0);
    points.iter_mut().for_each(|p| p.truncate(n));
    points
}

/// Our side: two pyramids, kept from frame to frame.
struct Bench<'a> {
    frames: &'a Frames,
    points: &'a [Vec<Point>],
    params: klt::Params,
    pyramids: [Pyramid; 2],
}

/// Milliseconds of every pair.
struct Times {
    /// Pyramid of the earlier frame, which a tracker has already.
    first: Vec<f64>,
    /// Pyramid of the later frame.
    second: Vec<f64>,
    search: Vec<f64>,
}

impl<'a> Bench<'a> {
    fn new(frames: &'a Frames, points: &'a [Vec<Point>], params: klt::Params) -> Self {
        let pyramid = Pyramid::new(&frames.gray(0), params.levels, params.radius_px);
        Self { frames, points, params, pyramids: [pyramid.clone(), pyramid] }
    }

    fn time(&mut self, level: simd::Level) -> Times {
        let mut times = Times { first: Vec::new(), second: Vec::new(), search: Vec::new() };
        for (i, points) in self.points.iter().enumerate() {
            let [first, second] = &mut self.pyramids;
            let params = &self.params;
            times.first.push(milliseconds(|| first.fill(&self.frames.gray(i))));
            times.second.push(milliseconds(|| second.fill(&self.frames.gray(i + 1))));
            times.search.push(milliseconds(|| klt::track_at(level, first, second, points, None, params, 1)));
        }
        times
    }

    /// Milliseconds of the search alone in every pair, on so many threads.
    fn search(&mut self, level: simd::Level, n_threads: usize) -> Vec<f64> {
        let pairs = self.points.iter().enumerate().map(|(i, points)| {
            let [first, second] = &mut self.pyramids;
            first.fill(&self.frames.gray(i));
            second.fill(&self.frames.gray(i + 1));
            milliseconds(|| klt::track_at(level, first, second, points, None, &self.params, n_threads))
        });
        pairs.collect()
    }

    fn positions(&mut self) -> Vec<Vec<klt::Flow>> {
        let pairs = self.points.iter().enumerate().map(|(i, points)| {
            let [first, second] = &mut self.pyramids;
            first.fill(&self.frames.gray(i));
            second.fill(&self.frames.gray(i + 1));
            klt::track(first, second, points, None, &self.params, 1)
        });
        pairs.collect()
    }
}

fn milliseconds<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    1e3 * start.elapsed().as_secs_f64()
}

/// Medians over the pairs of each turn; ratios are taken turn by turn, then summarised.
fn times(turns: &[(Times, Option<PeerTimes>)]) -> Value {
    let sequence = |t: &Times| median(t.search.iter().zip(&t.second).map(|(s, b)| s + b).collect());
    let search = |t: &Times| median(t.search.clone());
    let both = |t: &Times| sequence(t) + median(t.first.clone());
    let over = |f: &dyn Fn(&Times) -> f64| turns.iter().map(|(ours, _)| f(ours)).collect::<Vec<_>>();
    let peer = |f: &dyn Fn(&PeerTimes) -> f64| {
        turns.iter().filter_map(|(_, theirs)| theirs.as_ref().map(f)).collect::<Vec<_>>()
    };
    let full = peer(&|t| median(t.full.clone()));
    let bare = peer(&|t| median(t.full.iter().zip(&t.pyramids).map(|(f, p)| f - p).collect()));
    let [sequence, both, search] = [over(&sequence), over(&both), over(&search)];
    let ratio = |a: &[f64], b: &[f64]| spread(a.iter().zip(b).map(|(a, b)| a / b).collect());
    json!({
        "ms_per_frame": {
            "ours_in_sequence": spread(sequence.clone()),
            "ours_both_pyramids": spread(both.clone()),
            "ours_search_only": spread(search.clone()),
            "opencv": spread(full.clone()),
            "opencv_less_its_pyramids": spread(bare.clone()),
        },
        "ratio": {
            "in_sequence_to_opencv": ratio(&sequence, &full),
            "both_pyramids_to_opencv": ratio(&both, &full),
            "search_only_to_opencv_less_its_pyramids": ratio(&search, &bare),
        },
    })
}

/// Distances between the two trackers on points both keep, and of each to the truth where it is known.
fn positions(
    frames: &Frames,
    points: &[Vec<Point>],
    ours: &[Vec<klt::Flow>],
    theirs: Option<&[Vec<Option<Point>>]>,
) -> Value {
    let (mut apart, mut our_error, mut their_error) = (Vec::new(), Vec::new(), Vec::new());
    let (mut both, mut only_ours, mut only_theirs, mut beyond) = (0, 0, 0, 0);
    let on_picture = |[x, y]: Point| {
        (-0.5..=frames.width as f32 - 0.5).contains(&x) && (-0.5..=frames.height as f32 - 0.5).contains(&y)
    };
    for (i, (points, flows)) in points.iter().zip(ours).enumerate() {
        for (k, (&from, flow)) in points.iter().zip(flows).enumerate() {
            let our = (flow.state == State::Tracked).then_some(flow.to);
            let their = theirs.and_then(|t| t[i][k]);
            let truth = frames.truth(i, from);
            match (our, their) {
                (Some(a), Some(b)) => {
                    both += 1;
                    apart.push(distance(a, b));
                    our_error.extend(truth.map(|t| distance(a, t)));
                    their_error.extend(truth.map(|t| distance(b, t)));
                }
                (Some(_), None) => only_ours += 1,
                (None, Some(b)) => {
                    only_theirs += 1;
                    beyond += usize::from(!on_picture(b));
                }
                (None, None) => {}
            }
        }
    }
    json!({
        "both_keep": both, "only_ours": only_ours, "only_opencv": only_theirs,
        "only_opencv_and_beyond_the_picture": beyond,
        "difference_px": quantiles(apart),
        "error_px": { "ours": quantiles(our_error), "opencv": quantiles(their_error) },
    })
}

fn distance(a: Point, b: Point) -> f64 {
    f64::from(a[0] - b[0]).hypot(f64::from(a[1] - b[1]))
}

fn median(values: Vec<f64>) -> f64 {
    quantile(values, 0.5).unwrap_or(f64::NAN)
}

fn quantile(mut values: Vec<f64>, q: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get((q * values.len().saturating_sub(1) as f64).round() as usize).copied()
}

fn spread(values: Vec<f64>) -> Value {
    let [low, middle, high] = [0.0, 0.5, 1.0].map(|q| quantile(values.clone(), q).map(rounded));
    json!({ "median": middle, "min": low, "max": high })
}

fn quantiles(values: Vec<f64>) -> Value {
    let [median, p95, max] = [0.5, 0.95, 1.0].map(|q| quantile(values.clone(), q).map(rounded));
    json!({ "median": median, "p95": p95, "max": max })
}

fn rounded(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}
