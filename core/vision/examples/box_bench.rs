//! Box matching against OpenCV's `matchTemplate`: same frames, same features, turn by turn, one thread.
//!
//! `box_bench [CLIP…] [--pairs N] [--points N] [--repeats N] [--radius R] [--search S] [--python PYTHON]`
//!
//! A row a clip: how often the pyramid's whole-pixel answer is as good as that of the exhaustive search, how often the
//! exhaustive one's is OpenCV's, microseconds a feature (pictures' pyramids and all), and how much faster that is.
//! Then curves over all clips together: agreement and cost against the share carried down, the number of levels, and
//! the size of the template. Without a CLIP, a texture that turns, grows and drifts is made; without Python or OpenCV
//! the peer's columns are empty, and clips cannot be read.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "klt_bench/frames.rs"]
mod frames;
#[path = "box_bench/peer.rs"]
mod peer;

use std::path::PathBuf;
use std::time::Instant;

use frames::Frames;
use honami_vision::boxes::{self, Boxes, Match, Method, Params};
use honami_vision::{Point, detect, simd};
use peer::{Peer, PeerTimes};

type Failure = Box<dyn std::error::Error>;

/// What the command line asks for.
struct Options {
    clips: Vec<PathBuf>,
    n_pairs: usize,
    n_points: usize,
    repeats: usize,
    python: String,
    params: Params,
}

/// Milliseconds of a turn: pyramidal, exhaustive, the peer.
type Turn = (f64, f64, Option<PeerTimes>);

/// A clip's pairs of frames and what is looked for in them.
struct Clip {
    name: String,
    frames: Frames,
    points: Vec<Vec<Point>>,
}

fn main() -> Result<(), Failure> {
    let options = options(std::env::args().skip(1))?;
    let mut clips = Vec::new();
    for path in &options.clips {
        let name = path.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        clips.push(Clip::new(name, peer::frames(&options.python, path, options.n_pairs)?, &options));
    }
    if clips.is_empty() {
        clips.push(Clip::new("made".into(), Frames::made(960, 720, 2 * options.n_pairs), &options));
    }
    println!(
        "simd {}, one thread, µs a feature: median (least-most of {} turns)",
        simd::level(),
        options.repeats
    );
    println!(
        "{:22} {:>8} {:>9} {:>9} {:>9} {:>22} {:>22} {:>20} {:>20} {:>20} {:>9}",
        "clip",
        "features",
        "agrees %",
        "within 1",
        "is cv2's",
        "exhaustive",
        "pyramidal",
        "cv2",
        "times cv2",
        "less its calls",
        "error px"
    );
    for clip in &clips {
        clip.row(&options)?;
    }
    curves(&clips, &options);
    Ok(())
}

fn options(mut args: impl Iterator<Item = String>) -> Result<Options, Failure> {
    let params = Params { min_contrast: 0.0, ..Params::default() };
    let (clips, python) = (Vec::new(), "python3".into());
    let mut options = Options { clips, n_pairs: 6, n_points: 400, repeats: 5, python, params };
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(format!("{arg} needs a value"));
        match arg.as_str() {
            "--pairs" => options.n_pairs = value()?.parse()?,
            "--points" => options.n_points = value()?.parse()?,
            "--repeats" => options.repeats = value()?.parse()?,
            "--radius" => options.params.radius_px = value()?.parse()?,
            "--search" => options.params.search_px = value()?.parse()?,
            "--python" => options.python = value()?,
            flag if flag.starts_with('-') => return Err(format!("unknown option {flag}").into()),
            clip => options.clips.push(clip.into()),
        }
    }
    Ok(options)
}

impl Clip {
    /// Features are the strongest corners of each pair's first frame, as many as asked for.
    fn new(name: String, frames: Frames, options: &Options) -> Self {
        let params =
            detect::Params { max_corners: options.n_points, min_distance_px: 5.0, ..Default::default() };
        let corners = |i: usize| detect::corners(&frames.gray(i), None, &[], &params);
        let firsts = (0..frames.len() / 2).map(|pair| 2 * pair);
        let points = firsts.map(|i| corners(i).iter().map(|c| c.at).collect()).collect();
        Self { name, frames, points }
    }

    /// Prints how the search does on this clip, beside its peer.
    fn row(&self, options: &Options) -> Result<(), Failure> {
        let params = options.params;
        let all = Params { method: Method::Exhaustive, ..params };
        let (found, least) = (self.search(&params, &self.points).0, self.search(&all, &self.points).0);
        let n = least.len();
        let agree = found.iter().zip(&least).filter(|(a, b)| a.cost == b.cost).count();
        let within = |(a, b): &(&Match, &Match)| (0..2).all(|i| a.step[i].abs_diff(b.step[i]) <= 1);
        let near = found.iter().zip(&least).filter(within).count();

        // OpenCV looks at whole windows only: features that have them.
        let reach = (params.radius_px + params.search_px) as f32 + 1.0;
        let far = [self.frames.width, self.frames.height].map(|size| size as f32 - 1.0 - reach);
        let inner = |p: &&Point| (0..2).all(|i| p[i] >= reach && p[i] <= far[i]);
        let inner: Vec<Vec<Point>> =
            self.points.iter().map(|p| p.iter().filter(inner).copied().collect()).collect();
        let n_inner = inner.iter().map(Vec::len).sum::<usize>().max(1);
        let pixels: Vec<Vec<[i32; 2]>> =
            inner.iter().map(|p| p.iter().map(|p| p.map(|c| c.round() as i32)).collect()).collect();
        let peer = Peer::start(&options.python, &self.frames, &pixels, params.radius_px, params.search_px);
        let mut peer = peer.inspect_err(|why| println!("no peer: {why}")).ok();
        let mut turns: Vec<Turn> = Vec::new();
        for _ in 0..options.repeats {
            let theirs = peer.as_mut().map(Peer::time).transpose()?;
            turns.push((self.search(&params, &inner).1, self.search(&all, &inner).1, theirs));
        }
        let same = peer.as_mut().map(|peer| self.same(peer, &all, &inner)).transpose()?;
        let each = |f: &dyn Fn(&Turn) -> Option<f64>| spread(turns.iter().filter_map(f));
        let a_feature = |ms: f64| 1e3 * ms / n_inner as f64;
        println!(
            "{:22} {:>8} {:>9.2} {:>9.2} {:>9} {:>22} {:>22} {:>20} {:>20} {:>20} {:>9}",
            self.name,
            n,
            100.0 * agree as f64 / n as f64,
            100.0 * near as f64 / n as f64,
            same.map_or_else(String::new, |same| format!("{same:.2}")),
            each(&|t| Some(a_feature(t.1))),
            each(&|t| Some(a_feature(t.0))),
            each(&|t| t.2.map(|p| a_feature(p.full))),
            each(&|t| t.2.map(|p| p.full / t.0)),
            each(&|t| t.2.map(|p| (p.full - p.calls) / t.0)),
            self.error(&found),
        );
        Ok(())
    }

    /// Median distance from the truth, pixels, where it is known.
    fn error(&self, found: &[Match]) -> String {
        let starts =
            self.points.iter().enumerate().flat_map(|(pair, points)| points.iter().map(move |&p| (pair, p)));
        let error = |((pair, from), found): ((usize, Point), &Match)| {
            let truth = self.frames.truth(2 * pair, from)?;
            Some(f64::from(found.to[0] - truth[0]).hypot(f64::from(found.to[1] - truth[1])))
        };
        let mut errors: Vec<f64> = starts.zip(found).filter_map(error).collect();
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() / 2).map_or_else(String::new, |error| format!("{error:.3}"))
    }

    /// Share in % of the features whose displacement is OpenCV's.
    fn same(&self, peer: &mut Peer, all: &Params, inner: &[Vec<Point>]) -> Result<f64, Failure> {
        let theirs = peer.steps()?;
        let (ours, _) = self.search(all, inner);
        let same = ours.iter().zip(theirs.iter().flatten()).filter(|(a, b)| a.step == **b).count();
        Ok(100.0 * same as f64 / ours.len().max(1) as f64)
    }

    /// Where points went, and milliseconds: of a pyramid a pair, as in a stream, and of the search.
    fn search(&self, params: &Params, points: &[Vec<Point>]) -> (Vec<Match>, f64) {
        let gray = |i: usize| self.frames.gray(i);
        let mut pyramids = [0, 1].map(|i| Boxes::new(&gray(i), params.levels(), params.radius_px));
        let (mut found, mut ms) = (Vec::new(), 0.0);
        for (pair, points) in points.iter().enumerate() {
            let [first, second] = &mut pyramids;
            first.fill(&gray(2 * pair));
            let start = Instant::now();
            second.fill(&gray(2 * pair + 1));
            found.extend(boxes::track(first, second, points, None, params, 1));
            ms += 1e3 * start.elapsed().as_secs_f64();
        }
        (found, ms)
    }
}

/// Agreement and cost over all clips together.
fn curves(clips: &[Clip], options: &Options) {
    let point = |params: Params| {
        let all = Params { method: Method::Exhaustive, ..params };
        let (mut n, mut agree, mut ms, mut worst) = (0, 0, 0.0, 100.0_f64);
        for clip in clips {
            let ((found, time), (least, _)) =
                (clip.search(&params, &clip.points), clip.search(&all, &clip.points));
            let same = found.iter().zip(&least).filter(|(a, b)| a.cost == b.cost).count();
            worst = worst.min(100.0 * same as f64 / least.len().max(1) as f64);
            (n, agree, ms) = (n + least.len(), agree + same, ms + time);
        }
        println!(
            "{:>8.2} {:>10.2} {:>12.2}",
            100.0 * agree as f64 / n.max(1) as f64,
            worst,
            1e3 * ms / n.max(1) as f64
        );
    };
    println!("\n{:24} {:>8} {:>10} {:>12}", "all clips", "agrees %", "worst clip", "µs a feature");
    let (radius_px, search_px) = (options.params.radius_px, options.params.search_px);
    for share in [0.003, 0.005, 0.007, 0.01, 0.02, 0.05, 0.1] {
        for levels in [2, 3] {
            print!("{:24} ", format!("share {share}, k {}", levels - 1));
            point(Params { method: Method::Pyramidal { levels, share }, ..options.params });
        }
    }
    for radius_px in [5, radius_px, 15, 20] {
        for levels in 1..=4 {
            print!("{:24} ", format!("n {:>2}, ±{search_px}, k {}", 2 * radius_px + 1, levels - 1));
            let mut params = Params { radius_px, ..options.params };
            if let Method::Pyramidal { share, .. } = params.method {
                params.method = Method::Pyramidal { levels, share };
            }
            point(params);
        }
    }
}

/// Median, least and most.
fn spread(values: impl Iterator<Item = f64>) -> String {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let [Some(least), Some(median), Some(most)] =
        [values.first(), values.get(values.len() / 2), values.last()]
    else {
        return String::new();
    };
    format!("{median:.2} ({least:.2}-{most:.2})")
}
