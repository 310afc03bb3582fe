//! The picture, with the tracks on it: in characters, and in pixels for stills.

mod ghost;
pub(super) mod motion;
mod paint;
mod path;
mod scale;
mod skeleton;
mod sketch;
pub(super) mod versus;

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::text::Line;

use honami_model::track::Status;
use honami_workbench::palette::{self, DARK, KEY, UNSEEN};

use super::{put, style};
use crate::app::layout::{Layout, Lens};
use crate::app::skeleton::Skeletal;
use crate::app::state::{Mode, State};
use crate::app::tracks::TrackRow;
use crate::braille::{DOTS, braille};
use crate::term::encode::Frame;
use crate::term::glyph::Glyphs;

/// A frame of the clip, scaled for a lens.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Which frame.
    pub frame: u32,
    /// Which part of it, and for which cells.
    pub lens: Lens,
    /// Its pixels, as many as the lens has, row-major.
    pub pixels: Vec<[u8; 3]>,
}

/// A mark for so many cells, at most: more would hide the picture.
const CELLS_PER_MARK: usize = 6;

/// How much a wrong cell matters: of the picture, and of a mark on it.
const PICTURE: u8 = 1;
const MARK: u8 = 8;

const WHITE: [u8; 3] = [255, 255, 255];
/// Round the tracks that are picked.
const PICKED: [u8; 3] = [80, 255, 120];
const CURSOR: [u8; 3] = [255, 60, 255];

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

/// Pixels of what is hidden: hollow. And of what is lost: crossed out.
const HOLLOW: [(i64, i64); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
const CROSSED: [(i64, i64); 5] = [(0, 0), (-1, -1), (1, -1), (-1, 1), (1, 1)];

/// Pixels to be drawn on.
struct Canvas<'a> {
    lens: &'a Lens,
    pixels: Vec<[u8; 3]>,
    weights: Vec<u8>,
    /// Marks, where there are no colours.
    letters: Option<Letters>,
    /// All that was drawn, and on what: finer than the pixels.
    scene: DefaultHasher,
}

/// Marks where there are no colours: cells, counted row by row, and what stands in them.
#[derive(Default)]
struct Letters {
    dots: BTreeMap<usize, u8>,
    letters: Vec<(usize, char)>,
}

/// Every so many-th track is marked, a power of two: few enough marks that the picture is seen between them.
/// From frame to frame it is mostly the same, and fewer marks are some of the more.
pub(super) fn marks_nth(state: &State, lens: &Lens, frame: u32) -> usize {
    let is_there = |row: &&TrackRow| row.at(frame).is_some_and(|at| lens.pixel_of(at).is_some());
    let n_marks = state.tracks.iter().filter(is_there).count();
    let room = usize::from(lens.area.width) * usize::from(lens.area.height) / CELLS_PER_MARK;
    n_marks.div_ceil(room.max(1)).next_power_of_two()
}

/// Draws a shot, where there is one that fits, with every so many-th track marked.
pub(super) fn draw(state: &State, layout: &Layout, shot: Option<&Shot>, nth: usize, frame: &mut Frame) {
    let here = Lens::of(state, layout.picture);
    let fits = |shot: &&Shot| shot.lens.area == here.area;
    let Some(shot) = shot.filter(fits) else {
        let line = format!("decoding frame {} …", state.shown_frame());
        put(frame, layout.picture, layout.picture.height / 2, &Line::styled(line, style::DIM).centered());
        return;
    };
    Canvas::of(state, shot, nth).paint(frame);
}

/// The pixels of a shot with what lies on them.
#[must_use]
pub fn compose(state: &State, shot: &Shot) -> Vec<[u8; 3]> {
    Canvas::of(state, shot, marks_nth(state, &shot.lens, shot.frame)).pixels
}

impl<'a> Canvas<'a> {
    /// A shot with everything drawn on it, every so many-th track marked.
    fn of(state: &State, shot: &'a Shot, nth: usize) -> Self {
        let lens = &shot.lens;
        let mut scene = DefaultHasher::new();
        [lens.x, lens.y, lens.width, lens.height].map(f64::to_bits).hash(&mut scene);
        (shot.frame, lens.area).hash(&mut scene);
        let mut canvas = Self {
            lens,
            pixels: shot.pixels.clone(),
            weights: vec![PICTURE; shot.pixels.len()],
            letters: state.mono.then(Letters::default),
            scene,
        };
        if Skeletal::azimuth(state) != 0 {
            canvas.clear();
            canvas.skeleton(state, shot.frame);
            return canvas;
        }
        if let Mode::Paint(painting) = &state.mode {
            canvas.painting(painting);
            return canvas;
        }
        let kept = state.scale.as_ref().filter(|bar| bar.frame == shot.frame);
        kept.into_iter().for_each(|bar| canvas.scale_bar(bar));
        if let Mode::Scale(scaling) = &state.mode {
            canvas.scaling(scaling);
            return canvas;
        }
        // Marks belong to the frame that is shown, which may be a moment behind.
        canvas.motion(state, shot.frame);
        canvas.skeleton(state, shot.frame);
        match state.versus.as_deref().and_then(|versus| Some((versus.sides, versus.compared.as_deref()?))) {
            Some(of) => canvas.versus(state, of, shot.frame, nth),
            None => canvas.tracks(state, shot.frame, nth),
        }
        canvas.cursor(state, shot.frame);
        canvas
    }

    fn tracks(&mut self, state: &State, frame: u32, nth: usize) {
        let selected = state.selected_row();
        if let Some(row) = selected {
            self.path(row, frame);
        }
        let is_marked = |i: usize, row: &TrackRow| {
            let is_meant = state.selected == Some(row.id) || state.picked.contains(&row.id);
            is_meant || (state.marks_all && i.is_multiple_of(nth))
        };
        for (_, row) in state.tracks.iter().enumerate().filter(|(i, row)| is_marked(*i, row)) {
            let Some(sample) = row.span.get(frame) else { continue };
            let at = [sample.x, sample.y];
            match sample.status {
                Status::Tracked | Status::Newborn => {
                    let colour = palette::group(state.groups.as_ref().and_then(|g| g.of(row.id)));
                    self.mark(at, &[], colour, 'o');
                    self.tint(at, colour);
                }
                Status::Outside | Status::Rejected => continue,
                // Shapes of several pixels by the hundred would hide the picture.
                Status::Lost => self.mark(at, if nth > 1 { &CROSSED[..1] } else { &CROSSED }, UNSEEN, 'x'),
                Status::Occluded => self.mark(at, if nth > 1 { &[(0, 0)] } else { &HOLLOW }, UNSEEN, '?'),
            }
            if state.picked.contains(&row.id) {
                self.mark([sample.x, sample.y], &RING, PICKED, '#');
            }
        }
        let moving = matches!(state.mode, Mode::Move(_) | Mode::Sketch(_));
        if let Some(row) = selected.filter(|_| !moving)
            && let Some(at) = row.at(frame)
        {
            let ring = if row.keys.binary_search(&frame).is_ok() { KEY } else { WHITE };
            let halo = if state.picked.contains(&row.id) { PICKED } else { DARK };
            self.mark(at, &HALO, halo, ' ');
            self.mark(at, &RING, ring, '@');
        }
    }

    fn cursor(&mut self, state: &State, frame: u32) {
        match state.mode {
            Mode::Place(at) | Mode::Root(at) => self.cross(at),
            Mode::Move(ref moving) => self.ghost(moving, state.selected_row(), frame),
            Mode::Sketch(ref sketching) => self.sketch(sketching, state.selected_row(), frame),
            _ => {}
        }
    }

    fn cross(&mut self, at: [f32; 2]) {
        self.mark(at, &CROSS_ENDS, DARK, ' ');
        self.mark(at, &CROSS, CURSOR, '+');
    }

    /// Colours one pixel, letting the picture through a little: marks by the hundred must not hide it.
    fn tint(&mut self, at: [f32; 2], colour: [u8; 3]) {
        self.note(at, colour);
        let Some(place) = self.lens.pixel_of(at) else { return };
        let mix = |a: u8, b: u8| ((u16::from(a) + 2 * u16::from(b)) / 3) as u8;
        self.stamp(place, (0, 0), |[r, g, b], weight| {
            // A second mark on the same pixel changes nothing more.
            (weight == PICTURE).then(|| [mix(r, colour[0]), mix(g, colour[1]), mix(b, colour[2])])
        });
    }

    /// Draws pixels about an image point; in letters, one letter at it.
    fn mark(&mut self, at: [f32; 2], shape: &[(i64, i64)], colour: [u8; 3], letter: char) {
        self.note(at, colour);
        if let Some(letters) = &mut self.letters {
            if let Some((x, y)) = self.lens.place_of(at, (1, 1)).filter(|_| letter != ' ') {
                letters.letters.push(((y * u32::from(self.lens.area.width) + x) as usize, letter));
            }
            return;
        }
        let Some(place) = self.lens.pixel_of(at) else { return };
        for &offset in shape {
            self.stamp(place, offset, |_, _| Some(colour));
        }
    }

    /// A dot finer than letters.
    fn dot(&mut self, at: [f32; 2], colour: [u8; 3]) {
        self.note(at, colour);
        let Some((x, y)) = self.lens.place_of(at, (2, 4)) else { return };
        let cell = (y / 4 * u32::from(self.lens.area.width) + x / 2) as usize;
        if let Some(letters) = &mut self.letters {
            *letters.dots.entry(cell).or_default() |= DOTS[y as usize % 4][x as usize % 2];
        }
    }

    fn note(&mut self, at: [f32; 2], colour: [u8; 3]) {
        (at.map(f32::to_bits), colour).hash(&mut self.scene);
    }

    /// Colours the pixels of one point of a mark, so many points away from a pixel.
    fn stamp(
        &mut self,
        (x, y): (u32, u32),
        (dx, dy): (i64, i64),
        colour: impl Fn([u8; 3], u8) -> Option<[u8; 3]>,
    ) {
        let (columns, rows) = self.lens.size();
        let (width, height) = point(self.lens.grid);
        let left = i64::from(x) - width / 2 + dx * width;
        let top = i64::from(y) - height / 2 + dy * height;
        for y in top.max(0)..(top + height).min(rows.into()) {
            for x in left.max(0)..(left + width).min(columns.into()) {
                let i = (y * i64::from(columns) + x) as usize;
                if let Some(colour) = colour(self.pixels[i], self.weights[i]) {
                    self.pixels[i] = colour;
                    self.weights[i] = MARK;
                }
            }
        }
    }

    /// Puts the pixels into cells.
    fn paint(&self, frame: &mut Frame) {
        let area = self.lens.area;
        paint_pixels(area, self.lens.grid, &self.pixels, Some(&self.weights), frame);
        if let Some(letters) = &self.letters {
            letters.paint(area, frame);
        }
        frame.scene = self.scene.finish();
    }
}

/// Puts pixels into the cells of an area, so many into each, across and down; `weights` say how much each matters, all alike
/// where there are none.
pub(super) fn paint_pixels(
    area: Rect,
    grid: (u32, u32),
    pixels: &[[u8; 3]],
    weights: Option<&[u8]>,
    frame: &mut Frame,
) {
    let (across, down) = (grid.0 as usize, grid.1 as usize);
    let columns = across * usize::from(area.width);
    let glyphs = Glyphs::ALL.into_iter().find(|g| g.grid() == grid).unwrap_or_default();
    let rgb = |[r, g, b]: [u8; 3]| Color::Rgb(r, g, b);
    let mut own = Vec::with_capacity(across * down);
    for row in 0..area.height {
        for column in 0..area.width {
            let first = usize::from(row) * down * columns + usize::from(column) * across;
            own.clear();
            for y in 0..down {
                let pixel = |x: usize| {
                    let at = first + y * columns + x;
                    (pixels[at], weights.map_or(PICTURE, |weights| weights[at]))
                };
                own.extend((0..across).map(pixel));
            }
            let (symbol, fg, bg) = glyphs.fit(&own);
            let i = frame.cells.index_of(area.x + column, area.y + row);
            frame.cells.content[i].set_char(symbol).set_style(Style::new().fg(rgb(fg)).bg(rgb(bg)));
            frame.softness[i] = own.iter().map(|(_, weight)| *weight).max().unwrap_or(PICTURE);
        }
    }
}

impl Letters {
    fn paint(&self, area: Rect, frame: &mut Frame) {
        let columns = usize::from(area.width);
        let dots = self.dots.iter().map(|(cell, dots)| (*cell, braille(*dots)));
        for (cell, letter) in dots.chain(self.letters.iter().copied()) {
            let i = frame.cells.index_of(area.x + (cell % columns) as u16, area.y + (cell / columns) as u16);
            frame.cells.content[i].reset();
            frame.cells.content[i].set_char(letter).set_style(style::BOLD);
            frame.softness[i] = 0;
        }
    }
}

/// Pixels across and down of one point of a mark: marks have about the same size and shape on every grid.
fn point((across, down): (u32, u32)) -> (i64, i64) {
    match (across, down) {
        (2, 2) => (2, 1),
        _ => (i64::from(across / 3).max(1), i64::from(down / 6).max(1)),
    }
}
