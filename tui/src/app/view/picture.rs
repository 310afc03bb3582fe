//! The picture in half blocks, with the tracks on it.

use ratatui::style::{Color, Style};
use ratatui::text::Line;

use honami_model::track::Status;

use super::{put, style};
use crate::app::layout::{Layout, Lens};
use crate::app::state::{Mode, State};
use crate::app::tracks::TrackRow;
use crate::term::encode::{Frame, HALF_BLOCK};

/// A frame of the clip, scaled for a lens.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Which frame.
    pub frame: u32,
    /// Which part of it, and for which cells.
    pub lens: Lens,
    /// Its pixels, `(lens rows * 2, lens columns)`, row-major.
    pub pixels: Vec<[u8; 3]>,
}

/// A mark for so many cells, at most: more would hide the picture.
const CELLS_PER_MARK: usize = 6;

/// How much a wrong cell matters: of the picture, and of a mark on it.
const PICTURE: u8 = 1;
const MARK: u8 = 8;

/// The selected track's path is drawn this many frames to both sides.
const PATH_FRAMES: u32 = 12;

const WHITE: [u8; 3] = [255, 255, 255];
/// Round rings and in crosses: they must be seen on petals and on sky.
const DARK: [u8; 3] = [20, 20, 20];
const KEY: [u8; 3] = [255, 215, 95];
const PATH: [u8; 3] = [255, 235, 160];
const CURSOR: [u8; 3] = [255, 60, 255];
const UNSEEN: [u8; 3] = [130, 130, 130];

/// Pixels of a ring of radius 2.
const RING: [(i64, i64); 12] = [
    (-1, -2),
    (0, -2),
    (1, -2),
    (2, -1),
    (2, 0),
    (2, 1),
    (1, 2),
    (0, 2),
    (-1, 2),
    (-2, 1),
    (-2, 0),
    (-2, -1),
];
/// Pixels round that ring.
const HALO: [(i64, i64); 16] = [
    (-1, -3),
    (0, -3),
    (1, -3),
    (2, -2),
    (3, -1),
    (3, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 3),
    (-1, 3),
    (-2, 2),
    (-3, 1),
    (-3, 0),
    (-3, -1),
    (-2, -2),
];
/// Inner pixels of a cross whose middle stays open.
const CROSS: [(i64, i64); 4] = [(-2, 0), (2, 0), (0, -2), (0, 2)];
/// Its outer pixels.
const CROSS_ENDS: [(i64, i64); 4] = [(-3, 0), (3, 0), (0, -3), (0, 3)];

/// Pixels to be drawn on.
struct Canvas<'a> {
    lens: &'a Lens,
    pixels: Vec<[u8; 3]>,
    weights: Vec<u8>,
    /// Marks as letters, where there are no colours: pixel and letter.
    letters: Option<Vec<(usize, char)>>,
}

/// Every so many-th track is marked, a power of two: few enough marks that the picture is seen between them.
/// From frame to frame it is mostly the same, and fewer marks are some of the more.
pub(super) fn marks_nth(state: &State, lens: &Lens, frame: u32) -> usize {
    let is_there = |row: &&TrackRow| row.at(frame).is_some_and(|at| lens.pixel_of(at).is_some());
    let n_marks = state.tracks.iter().filter(is_there).count();
    let room = usize::from(lens.area.width) * usize::from(lens.area.height) / CELLS_PER_MARK;
    n_marks.div_ceil(room.max(1)).next_power_of_two()
}

pub(super) fn draw(state: &State, layout: &Layout, shot: Option<&Shot>, frame: &mut Frame) {
    let here = Lens::of(state, layout.picture);
    let fits = |shot: &&Shot| shot.lens.area == here.area;
    let Some(shot) = shot.filter(fits) else {
        let line = format!("decoding frame {} …", state.shown_frame());
        put(frame, layout.picture, layout.picture.height / 2, &Line::styled(line, style::DIM).centered());
        return;
    };
    let mut canvas = Canvas {
        lens: &shot.lens,
        pixels: shot.pixels.clone(),
        weights: vec![PICTURE; shot.pixels.len()],
        letters: state.mono.then(Vec::new),
    };
    // Marks belong to the frame that is shown, which may be a moment behind.
    canvas.tracks(state, shot.frame);
    canvas.cursor(state);
    canvas.paint(frame);
}

impl Canvas<'_> {
    fn tracks(&mut self, state: &State, frame: u32) {
        let selected = state.selected_row();
        if let Some(row) = selected {
            self.path(row, frame);
        }
        let nth = marks_nth(state, self.lens, frame);
        let is_marked = |i: usize, row: &TrackRow| {
            state.selected == Some(row.id) || (state.marks_all && i.is_multiple_of(nth))
        };
        for (_, row) in state.tracks.iter().enumerate().filter(|(i, row)| is_marked(*i, row)) {
            let Some(sample) = row.span.get(frame) else { continue };
            let colour = match sample.status {
                Status::Tracked | Status::Newborn => {
                    style::group(state.groups.as_ref().and_then(|g| g.of(row.id)))
                }
                Status::Outside | Status::Rejected => continue,
                Status::Lost | Status::Occluded => UNSEEN,
            };
            self.mark([sample.x, sample.y], &[], colour, 'o');
            self.tint([sample.x, sample.y], colour);
        }
        let moving = matches!(state.mode, Mode::Move { .. });
        if let Some(row) = selected.filter(|_| !moving)
            && let Some(at) = row.at(frame)
        {
            let ring = if row.keys.binary_search(&frame).is_ok() { KEY } else { WHITE };
            self.mark(at, &HALO, DARK, ' ');
            self.mark(at, &RING, ring, '@');
        }
    }

    fn path(&mut self, row: &TrackRow, frame: u32) {
        for f in frame.saturating_sub(PATH_FRAMES)..=frame + PATH_FRAMES {
            let is_key = row.keys.binary_search(&f).is_ok();
            if let Some(at) = row.at(f) {
                self.mark(at, &[(0, 0)], if is_key { KEY } else { PATH }, if is_key { '*' } else { '.' });
            }
        }
    }

    fn cursor(&mut self, state: &State) {
        match state.mode {
            Mode::Place(at) => self.cross(at),
            Mode::Move { from, to } => {
                self.mark(from, &[(0, 0)], UNSEEN, 'o');
                self.cross(to);
            }
            _ => {}
        }
    }

    fn cross(&mut self, at: [f32; 2]) {
        self.mark(at, &CROSS_ENDS, DARK, ' ');
        self.mark(at, &CROSS, CURSOR, '+');
    }

    /// Colours one pixel, letting the picture through a little: marks by the hundred must not hide it.
    fn tint(&mut self, at: [f32; 2], colour: [u8; 3]) {
        let Some((x, y)) = self.lens.pixel_of(at) else { return };
        let i = (y * self.lens.size().0 + x) as usize;
        let mix = |a: u8, b: u8| ((u16::from(a) + 2 * u16::from(b)) / 3) as u8;
        let [r, g, b] = self.pixels[i];
        // A second mark on the same pixel changes nothing more.
        if self.weights[i] == PICTURE {
            self.pixels[i] = [mix(r, colour[0]), mix(g, colour[1]), mix(b, colour[2])];
            self.weights[i] = MARK;
        }
    }

    /// Draws pixels about an image point; in letters, one letter at it.
    fn mark(&mut self, at: [f32; 2], shape: &[(i64, i64)], colour: [u8; 3], letter: char) {
        let Some((x, y)) = self.lens.pixel_of(at) else { return };
        let (columns, rows) = self.lens.size();
        if let Some(letters) = &mut self.letters {
            if letter != ' ' {
                letters.push(((y * columns + x) as usize, letter));
            }
            return;
        }
        for &(dx, dy) in shape {
            let (x, y) = (i64::from(x) + dx, i64::from(y) + dy);
            if (0..i64::from(columns)).contains(&x) && (0..i64::from(rows)).contains(&y) {
                let i = (y * i64::from(columns) + x) as usize;
                self.pixels[i] = colour;
                self.weights[i] = MARK;
            }
        }
    }

    /// Puts the pixels into cells, two each.
    fn paint(&self, frame: &mut Frame) {
        let area = self.lens.area;
        let columns = usize::from(area.width);
        let rgb = |[r, g, b]: [u8; 3]| Color::Rgb(r, g, b);
        for row in 0..area.height {
            for column in 0..area.width {
                let above = 2 * usize::from(row) * columns + usize::from(column);
                let below = above + columns;
                let i = frame.cells.index_of(area.x + column, area.y + row);
                let colours = Style::new().fg(rgb(self.pixels[above])).bg(rgb(self.pixels[below]));
                frame.cells.content[i].set_symbol(HALF_BLOCK).set_style(colours);
                frame.softness[i] = self.weights[above].max(self.weights[below]);
            }
        }
        for &(pixel, letter) in self.letters.iter().flatten() {
            let (column, row) = (pixel % columns, pixel / columns / 2);
            let i = frame.cells.index_of(area.x + column as u16, area.y + row as u16);
            frame.cells.content[i].reset();
            frame.cells.content[i].set_char(letter).set_style(style::BOLD);
            frame.softness[i] = 0;
        }
    }
}
