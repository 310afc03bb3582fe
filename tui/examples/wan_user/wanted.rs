//! The pictures that should be on screen, computed from the clip alone, and how near the screen comes to one.

use std::sync::OnceLock;

use anyhow::Context as _;
use honami_workbench::media::{Media, Rect};

/// Lines above and below the picture, and the cells that a column beside it takes.
const ABOVE: u16 = 1;
const BELOW: u16 = 3;
const COLUMN: u16 = 37;
const BESIDE: u16 = 76;

/// The picture's place on screen, cells, and the clip's frames at that size.
struct Place {
    left: u16,
    top: u16,
    columns: u16,
    rows: u16,
    /// Two pixels a cell, row-major.
    frames: Vec<Vec<[u8; 3]>>,
}

pub(crate) struct Wanted {
    /// With nothing beside the picture, and with a column.
    places: Vec<Place>,
    /// Which of them it is: the first that fits.
    place: OnceLock<usize>,
    last_frame: u32,
}

impl Wanted {
    /// All frames of a clip for a screen of this size.
    pub(crate) fn of(media: &Media, (columns, rows): (u16, u16)) -> anyhow::Result<Self> {
        let clip = media.clip();
        let mut places = Vec::new();
        let height = rows.checked_sub(ABOVE + BELOW).context("the screen is too low")?;
        for room in std::iter::once(columns).chain((columns >= BESIDE).then(|| columns - COLUMN)) {
            let (width_px, height_px) = (f64::from(clip.width), f64::from(clip.height));
            let scale = (width_px / f64::from(room)).max(height_px / f64::from(2 * height));
            let n_columns = ((width_px / scale).round() as u16).min(room);
            let n_rows = ((height_px / scale / 2.0).round() as u16).min(height);
            let frames = (0..clip.n_frames())
                .map(|n| {
                    let whole = Rect::whole(clip.width, clip.height);
                    media.rgb_area(n, whole, n_columns.into(), (2 * n_rows).into())
                })
                .collect::<Result<_, _>>()?;
            places.push(Place {
                left: (room - n_columns) / 2,
                top: ABOVE + (height - n_rows) / 2,
                columns: n_columns,
                rows: n_rows,
                frames,
            });
        }
        Ok(Self { places, place: OnceLock::new(), last_frame: clip.n_frames() - 1 })
    }

    pub(crate) fn last_frame(&self) -> u32 {
        self.last_frame
    }

    /// The frame number in the lowest line, `n/last`.
    pub(crate) fn number_on(&self, screen: &vt100::Screen) -> Option<u32> {
        let (rows, columns) = (screen.size().0.get(), screen.size().1.get());
        let line = screen.contents_between(rows - 1, 0, rows - 1, columns);
        let (number, rest) = line.split_once('/')?;
        let last = self.last_frame.to_string();
        rest.strip_prefix(&last).filter(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()))?;
        number.trim().parse().ok().filter(|n| *n <= self.last_frame)
    }

    /// Peak signal to noise ratio of the picture on screen, dB.
    pub(crate) fn psnr(&self, screen: &vt100::Screen, frame: u32) -> f64 {
        if let Some(&i) = self.place.get() {
            return self.places[i].psnr(screen, frame);
        }
        // The right place is known once the picture is nearly right in it.
        let found = self.places.iter().enumerate().map(|(i, place)| (i, place.psnr(screen, frame)));
        let (best, psnr) = found.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        if psnr > 40.0 {
            self.place.get_or_init(|| best);
        }
        psnr
    }
}

impl Place {
    fn psnr(&self, screen: &vt100::Screen, frame: u32) -> f64 {
        let wanted = &self.frames[frame as usize];
        let columns = usize::from(self.columns);
        let mut squares = 0_u64;
        for row in 0..self.rows {
            for column in 0..self.columns {
                let above = 2 * usize::from(row) * columns + usize::from(column);
                let shown = pixels_of(screen, self.top + row, self.left + column);
                squares += distance(shown[0], wanted[above]) + distance(shown[1], wanted[above + columns]);
            }
        }
        let mean = squares as f64 / (3 * wanted.len()) as f64;
        10.0 * (255.0_f64.powi(2) / mean).log10()
    }
}

/// The two pixels that a cell shows; text shows none of the picture.
fn pixels_of(screen: &vt100::Screen, row: u16, column: u16) -> [[u8; 3]; 2] {
    let rgb = |colour| match colour {
        vt100::Color::Rgb(r, g, b) => [r, g, b],
        _ => [0; 3],
    };
    let Some(cell) = screen.cell(row, column) else { return [[0; 3]; 2] };
    let (fg, bg) = (rgb(cell.fgcolor()), rgb(cell.bgcolor()));
    match cell.contents() {
        "▀" => [fg, bg],
        "▄" => [bg, fg],
        "█" => [fg; 2],
        _ => [bg; 2],
    }
}

fn distance(a: [u8; 3], b: [u8; 3]) -> u64 {
    a.iter().zip(b).map(|(&x, y)| u64::from(x.abs_diff(y)).pow(2)).sum()
}
