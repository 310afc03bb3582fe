//! Frames to track through: made, with known motion, or read from binary PGM files.

use std::io::Write;
use std::path::Path;

use honami_model::picture::Gray;
use honami_vision::{Point, texture};

use super::Failure;

/// Gray frames of one size.
pub(super) struct Frames {
    pub(super) width: u32,
    pub(super) height: u32,
    data: Vec<Vec<u8>>,
    made: bool,
}

impl Frames {
    /// A texture that turns, grows and drifts, a little brighter from frame to frame, with noise.
    pub(super) fn made(width: u32, height: u32, n: usize) -> Self {
        let frame = |t: usize| {
            texture::render(width, height, |x, y| {
                let [u, v] = Motion::at(t).back([x, y]);
                let noise = 2.0 * texture::hash(t as u64 + 77, x as i64, y as i64);
                texture::value(1, u, v) * (1.0 + 0.003 * t as f64) + noise
            })
        };
        Self { width, height, data: (0..n).map(frame).collect(), made: true }
    }

    /// The first `n` frames of a folder.
    pub(super) fn read(folder: &Path, n: usize) -> Result<Self, Failure> {
        let mut names: Vec<_> = std::fs::read_dir(folder)?
            .map(|entry| entry.map(|e| e.path()))
            .filter(|path| path.as_ref().is_ok_and(|p| p.extension().is_some_and(|e| e == "pgm")))
            .collect::<Result<_, _>>()?;
        names.sort();
        names.truncate(n);
        if names.len() < 2 {
            return Err(format!(
                "two or more .pgm frames wanted, {} found in {}",
                names.len(),
                folder.display()
            )
            .into());
        }
        let mut frames = Self { width: 0, height: 0, data: Vec::new(), made: false };
        for name in names {
            let (width, height, data) =
                parse(&std::fs::read(&name)?).ok_or("a binary 8-bit PGM (P5) is wanted")?;
            if frames.data.is_empty() {
                (frames.width, frames.height) = (width, height);
            } else if (frames.width, frames.height) != (width, height) {
                return Err(format!("{} has another size than the frames before", name.display()).into());
            }
            frames.data.push(data);
        }
        Ok(frames)
    }

    pub(super) fn len(&self) -> usize {
        self.data.len()
    }

    pub(super) fn gray(&self, i: usize) -> Gray<'_> {
        Gray::packed(&self.data[i], self.width, self.height)
    }

    /// Where a point of frame `i` is in the next one, if the frames were made.
    pub(super) fn truth(&self, i: usize, from: Point) -> Option<Point> {
        let texture = Motion::at(i).back(from.map(f64::from));
        self.made.then(|| Motion::at(i + 1).forth(texture).map(|c| c as f32))
    }

    /// Writes the frames as `frame_0000.pgm` and so on.
    pub(super) fn write(&self, folder: &Path) -> Result<(), Failure> {
        for (i, data) in self.data.iter().enumerate() {
            let mut file = std::fs::File::create(folder.join(format!("frame_{i:04}.pgm")))?;
            write!(file, "P5\n{} {}\n255\n", self.width, self.height)?;
            file.write_all(data)?;
        }
        Ok(())
    }
}

/// Where the texture lies in a frame: turned and grown about a centre, then moved.
struct Motion {
    cos: f64,
    sin: f64,
    shift: [f64; 2],
}

const CENTRE: [f64; 2] = [480.0, 360.0];

impl Motion {
    fn at(t: usize) -> Self {
        let t = t as f64;
        let (angle, growth) = (0.004 * t, 1.0 + 0.002 * t);
        let shift = [9.0 * (0.45 * t).sin() + 0.3 * t, 6.0 * (0.6 * t).cos() - 6.0];
        Self { cos: growth * f64::cos(angle), sin: growth * f64::sin(angle), shift }
    }

    fn forth(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, y) = (x - CENTRE[0], y - CENTRE[1]);
        [
            self.cos * x - self.sin * y + CENTRE[0] + self.shift[0],
            self.sin * x + self.cos * y + CENTRE[1] + self.shift[1],
        ]
    }

    fn back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, y) = (x - CENTRE[0] - self.shift[0], y - CENTRE[1] - self.shift[1]);
        let square = self.cos * self.cos + self.sin * self.sin;
        [
            (self.cos * x + self.sin * y) / square + CENTRE[0],
            (self.cos * y - self.sin * x) / square + CENTRE[1],
        ]
    }
}

/// Size and pixels of a binary PGM without comments.
fn parse(file: &[u8]) -> Option<(u32, u32, Vec<u8>)> {
    let mut fields = file.splitn(5, |b| b.is_ascii_whitespace());
    let magic = fields.next()?;
    let mut number = || std::str::from_utf8(fields.next()?).ok()?.parse::<u32>().ok();
    let (width, height, most) = (number()?, number()?, number()?);
    let pixels = fields.next()?.to_vec();
    let whole = pixels.len() == width as usize * height as usize;
    (magic == b"P5" && most == 255 && whole).then_some((width, height, pixels))
}
