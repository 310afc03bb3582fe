//! How long a matte takes, in how many steps and how much memory, and how far it is from the truth.
//!
//! `matting_bench [--threads N] [--out ALPHA.png] [WxH… | PICTURE SCRIBBLES]`
//!
//! A row a size: a crown of leaves before leaves out of focus, drawn here, so that its opacities are known, with some
//! strokes; or a picture with scribbles, whose truth nobody knows. Memory is the most that this process has had (Linux).
#![allow(clippy::print_stdout, reason = "a benchmark prints its result")]

use std::time::Instant;

use honami_matting::{Mark, Options, Picture, from_scribbles, matte};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut out = None;
    let mut words = Vec::new();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut value = || args.next().ok_or(format!("{arg} needs a value"));
        match arg.as_str() {
            "--threads" => rayon::ThreadPoolBuilder::new().num_threads(value()?.parse()?).build_global()?,
            "--out" => out = Some(value()?),
            _ => words.push(arg),
        }
    }
    println!(
        "{:>11} {:>8} {:>6} {:>9} {:>9} {:>11}",
        "size", "seconds", "steps", "peak MB", "mean off", "RMS off"
    );
    if let [picture, scribbles] = &words[..]
        && std::path::Path::new(picture).is_file()
    {
        let [picture, scribbles] =
            [picture, scribbles].map(|path| image::open(path).map(|image| image.to_rgb8()));
        let (picture, scribbles) = (picture?, scribbles?);
        let rgb = |image: &image::RgbImage| image.as_raw().as_chunks().0.to_vec();
        let (pixels, scribbled) = (rgb(&picture), rgb(&scribbles));
        let view = Picture::new(picture.width(), picture.height(), &pixels)?;
        let marks = from_scribbles(&view, &Picture::new(scribbles.width(), scribbles.height(), &scribbled)?)?;
        return row(&view, &marks, None, out.as_deref());
    }
    if words.is_empty() {
        words = ["235x189", "960x540", "1920x1080"].map(str::to_owned).to_vec();
    }
    for size in &words {
        let (width, height) = size.split_once('x').ok_or("a size is WIDTHxHEIGHT")?;
        let crown = Crown::new(width.parse()?, height.parse()?);
        let view = Picture::new(crown.width, crown.height, &crown.rgb)?;
        row(&view, &crown.marks, Some(&crown.alpha), out.as_deref())?;
    }
    Ok(())
}

/// Finds one matte, and prints what it took.
fn row(
    picture: &Picture<'_>,
    marks: &[Mark],
    truth: Option<&[f64]>,
    out: Option<&str>,
) -> Result<(), Failure> {
    let since = Instant::now();
    let matte = matte(picture, marks, &Options::default(), &mut |_| true)?;
    let seconds = since.elapsed().as_secs_f64();
    let off = truth.map(|truth| {
        let off = || matte.alpha.iter().zip(truth).map(|(found, truth)| (f64::from(*found) - truth).abs());
        let n = truth.len() as f64;
        (off().sum::<f64>() / n, (off().map(|off| off * off).sum::<f64>() / n).sqrt())
    });
    let [width, height] = picture.size();
    let peak = peak_megabytes().map_or_else(String::new, |peak| format!("{peak:.0}"));
    print!("{:>11} {seconds:>8.2} {:>6} {peak:>9}", format!("{width}x{height}"), matte.n_steps);
    println!("{}", off.map_or_else(String::new, |(mean, rms)| format!(" {mean:>9.4} {rms:>11.4}")));
    if let Some(path) = out {
        image::GrayImage::from_raw(width, height, matte.gray()).ok_or("a byte a pixel")?.save(path)?;
    }
    Ok(())
}

fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0)
}

/// A picture whose opacities are known, and strokes on it.
struct Crown {
    width: u32,
    height: u32,
    rgb: Vec<[u8; 3]>,
    alpha: Vec<f64>,
    marks: Vec<Mark>,
}

impl Crown {
    /// Leaves, more and more of them with the picture, lie about its middle.
    fn new(width: u32, height: u32) -> Self {
        let unit = f64::from(height) / 540.0;
        let leaves: Vec<Leaf> =
            (0..400).map(|k| Leaf::new(k, f64::from(width), f64::from(height), unit)).collect();
        let mut crown = Self { width, height, rgb: Vec::new(), alpha: Vec::new(), marks: Vec::new() };
        for y in 0..height {
            // Only leaves near the row are asked.
            let near: Vec<&Leaf> =
                leaves.iter().filter(|leaf| (leaf.y - f64::from(y)).abs() < leaf.length + 2.0).collect();
            for x in 0..width {
                crown.draw(f64::from(x), f64::from(y), &near, unit);
            }
        }
        crown
    }

    fn draw(&mut self, x: f64, y: f64, leaves: &[&Leaf], unit: f64) {
        let soft = |k: f64| (x / (60.0 * unit) + k).sin() * (y / (45.0 * unit) + 2.0 * k).cos();
        let mut colour = [0.35 + 0.2 * soft(0.3), 0.42 + 0.2 * soft(1.7), 0.75 + 0.15 * soft(2.9)];
        let mut alpha = 0.0;
        for leaf in leaves {
            let (cover, light) = leaf.at(x, y);
            let green = [0.25 * light, 0.55 * light, 0.12 * light];
            colour.iter_mut().zip(green).for_each(|(colour, green)| *colour += cover * (green - *colour));
            alpha += cover * (1.0 - alpha);
        }
        self.rgb.push(colour.map(|value| (value * 255.0).round().clamp(0.0, 255.0) as u8));
        self.alpha.push(alpha);
        // Strokes: along the border, and where every tenth leaf is.
        let edge = 6.0 * unit;
        let is_edge = x < edge || y < edge || x >= f64::from(self.width) - edge;
        let is_leaf =
            leaves.iter().any(|leaf| leaf.k % 10 == 0 && leaf.at(x, y).0 >= 1.0 && leaf.is_near(x, y));
        self.marks.push(if is_leaf {
            Mark::Foreground
        } else if is_edge && alpha == 0.0 {
            Mark::Background
        } else {
            Mark::Unknown
        });
    }
}

/// An ellipse with a vein.
struct Leaf {
    k: u32,
    x: f64,
    y: f64,
    turn: f64,
    length: f64,
    light: f64,
}

impl Leaf {
    fn new(k: u32, width: f64, height: f64, unit: f64) -> Self {
        // Digits of irrational numbers: spread evenly, the same in every run.
        let digit = |of: f64| (f64::from(k + 1) * of).fract();
        let (far, about) = (digit(0.618_034).sqrt(), digit(0.754_878) * std::f64::consts::TAU);
        Self {
            k,
            x: width / 2.0 + 0.36 * height * far * about.cos(),
            y: height / 2.0 + 0.4 * height * far * about.sin(),
            turn: digit(0.569_84) * std::f64::consts::PI,
            length: unit * (9.0 + 12.0 * digit(0.324_718)),
            light: 0.7 + 0.6 * digit(0.414_214),
        }
    }

    fn across(&self, x: f64, y: f64) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let [dx, dy] = [x - self.x, y - self.y];
        [dx * cos + dy * sin, dy * cos - dx * sin]
    }

    fn is_near(&self, x: f64, y: f64) -> bool {
        let [along, across] = self.across(x, y);
        along.hypot(across) < self.length / 4.0
    }

    /// How much of the pixel it covers, and how bright it is there.
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let [along, across] = self.across(x, y);
        let wide = 0.45 * self.length;
        let inside = 1.0 - (along / self.length).hypot(across / wide);
        let vein = 0.8 + 0.2 * (across.abs() / wide).min(1.0);
        ((0.5 + inside * wide).clamp(0.0, 1.0), self.light * vein)
    }
}
