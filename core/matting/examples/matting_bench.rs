//! How long a matte takes, in how much memory, and how far it is from the truth, beside PyMatting on the same marks in turns.
//!
//! `matting_bench [--threads N] [--repeats N] [--python PYTHON] [--out ALPHA.png] [WxH… | PICTURE SCRIBBLES]`
//!
//! A row a size: a crown of leaves before leaves out of focus, drawn here, so that its opacities are known, with some
//! strokes; or a picture with scribbles, whose truth nobody knows. Seconds are the median of the repeats, the ratio is
//! that of the medians with the least and the most of all turns. Memory is the most that a process has had so far (Linux).
//! PyMatting is as it comes: Levin's Laplacian with the same numbers, conjugate gradients with incomplete Cholesky, and
//! it has been warmed up on a small picture. Without Python or PyMatting its columns are empty.
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

#[path = "matting_bench/crown.rs"]
mod crown;
#[path = "matting_bench/peer.rs"]
mod peer;

use std::time::Instant;

use crown::Crown;
use honami_matting::{Mark, Matte, Options, Picture, from_scribbles, matte};
use peer::Peer;

type Failure = Box<dyn std::error::Error>;

struct Wanted {
    n_repeats: usize,
    python: String,
    out: Option<String>,
    /// Sizes, or a picture and scribbles.
    words: Vec<String>,
}

/// What is asked: a picture, its marks, and its opacities where they are known.
struct Case<'a> {
    picture: Picture<'a>,
    rgb: &'a [[u8; 3]],
    marks: &'a [Mark],
    truth: Option<&'a [f64]>,
}

/// Of one matte.
struct Turn {
    seconds: f64,
    /// From the truth: mean, root of the mean square.
    off: Option<[f64; 2]>,
}

fn main() -> Result<(), Failure> {
    let wanted = wanted()?;
    let mut peer = Peer::start(&wanted.python).inspect_err(|why| println!("no peer: {why}")).ok();
    let name = peer.as_ref().map_or("peer", |peer| &peer.name);
    println!("{:>11} | honami {:>42} | {name}", "", "");
    println!("{:>11} | {HEAD} {:>6} | {HEAD} | {:>6}", "size", "steps", "ratio");
    if let [picture, scribbles] = &wanted.words[..]
        && std::path::Path::new(picture).is_file()
    {
        let [picture, scribbles] =
            [picture, scribbles].map(|path| image::open(path).map(|image| image.to_rgb8()));
        let (picture, scribbles) = (picture?, scribbles?);
        let pixels = |image: &image::RgbImage| image.as_raw().as_chunks().0.to_vec();
        let (rgb, scribbled) = (pixels(&picture), pixels(&scribbles));
        let view = Picture::new(picture.width(), picture.height(), &rgb)?;
        let marks = from_scribbles(&view, &Picture::new(scribbles.width(), scribbles.height(), &scribbled)?)?;
        let case = Case { picture: view, rgb: &rgb, marks: &marks, truth: None };
        return row(&case, &wanted, peer.as_mut());
    }
    for size in &wanted.words {
        let (width, height) = size.split_once('x').ok_or("a size is WIDTHxHEIGHT")?;
        let crown = Crown::new(width.parse()?, height.parse()?);
        let picture = Picture::new(crown.width, crown.height, &crown.rgb)?;
        let case = Case { picture, rgb: &crown.rgb, marks: &crown.marks, truth: Some(&crown.alpha) };
        row(&case, &wanted, peer.as_mut())?;
    }
    Ok(())
}

const HEAD: &str = " seconds   peak MB  mean off   RMS off";

fn wanted() -> Result<Wanted, Failure> {
    let mut wanted = Wanted { n_repeats: 3, python: "python3".into(), out: None, words: Vec::new() };
    if let Ok(python) = std::env::var("HONAMI_PYTHON") {
        wanted.python = python;
    }
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(format!("{arg} needs a value"));
        match arg.as_str() {
            "--threads" => rayon::ThreadPoolBuilder::new().num_threads(value()?.parse()?).build_global()?,
            "--repeats" => wanted.n_repeats = value()?.parse::<usize>()?.max(1),
            "--python" => wanted.python = value()?,
            "--out" => wanted.out = Some(value()?),
            _ => wanted.words.push(arg),
        }
    }
    if wanted.words.is_empty() {
        wanted.words = ["235x189", "960x540", "1920x1080"].map(str::to_owned).to_vec();
    }
    Ok(wanted)
}

/// Finds the mattes of one picture in turns, and prints what they took.
fn row(case: &Case<'_>, wanted: &Wanted, mut peer: Option<&mut Peer>) -> Result<(), Failure> {
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    let mut found = None;
    for _ in 0..wanted.n_repeats {
        let since = Instant::now();
        let matte = matte(&case.picture, case.marks, &Options::default(), &mut |_| true)?;
        ours.push(Turn { seconds: since.elapsed().as_secs_f64(), off: off(&matte.alpha, case.truth) });
        found = Some(matte);
        if let Some(peer) = &mut peer {
            let (seconds, alpha) = peer.matte(case.picture.size(), case.rgb, case.marks)?;
            theirs.push(Turn { seconds, off: off(&alpha, case.truth) });
        }
    }
    let matte: Matte = found.ok_or("a repeat at least")?;
    let [width, height] = case.picture.size();
    let us = figures(&ours, peer::peak_megabytes("self"));
    let them = peer.map(|peer| figures(&theirs, peak_of(peer))).unwrap_or_default();
    println!(
        "{:>11} | {us} {:>6} | {them} | {}",
        format!("{width}x{height}"),
        matte.n_steps,
        ratio(&ours, &theirs)
    );
    if let Some(path) = &wanted.out {
        image::GrayImage::from_raw(width, height, matte.gray()).ok_or("a byte a pixel")?.save(path)?;
    }
    Ok(())
}

fn peak_of(peer: &Peer) -> Option<f64> {
    peer::peak_megabytes(&peer.id().to_string())
}

fn off(alpha: &[f32], truth: Option<&[f64]>) -> Option<[f64; 2]> {
    let truth = truth?;
    let off = || alpha.iter().zip(truth).map(|(found, truth)| (f64::from(*found) - truth).abs());
    let n = truth.len() as f64;
    Some([off().sum::<f64>() / n, (off().map(|off| off * off).sum::<f64>() / n).sqrt()])
}

fn seconds(turns: &[Turn]) -> Vec<f64> {
    let mut seconds: Vec<f64> = turns.iter().map(|turn| turn.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    seconds
}

fn figures(turns: &[Turn], peak: Option<f64>) -> String {
    let peak = peak.map_or_else(String::new, |peak| format!("{peak:.0}"));
    let off = turns.first().and_then(|turn| turn.off);
    let [mean, rms] = off.map_or_else(Default::default, |off| off.map(|off| format!("{off:.4}")));
    format!("{:>8.2} {peak:>9} {mean:>9} {rms:>9}", seconds(turns)[turns.len() / 2])
}

/// How often the peer's seconds are ours.
fn ratio(ours: &[Turn], theirs: &[Turn]) -> String {
    if theirs.is_empty() {
        return String::new();
    }
    let (ours, theirs) = (seconds(ours), seconds(theirs));
    let (last, middle) = (ours.len() - 1, ours.len() / 2);
    let [least, most] = [theirs[0] / ours[last], theirs[last] / ours[0]];
    format!("{:.1}x ({least:.1} to {most:.1})", theirs[middle] / ours[middle])
}
