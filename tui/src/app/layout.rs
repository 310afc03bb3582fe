//! Where things are on the screen, and which part of the picture is seen. Shared by drawing and by the mouse.

use ratatui::layout::Rect;

use super::panel::Panel;
use super::state::State;

/// Width of the column, cells.
const COLUMN: u16 = 36;
/// Width of the queue on a screen narrower than [`NARROW`]: what its rows need.
const NARROW_QUEUE: u16 = 32;
/// On a screen of fewer columns the picture needs what lists can spare.
const NARROW: u16 = 100;
/// With so much left beside it, cells, the picture stands there, smaller.
const BESIDE_COLUMN: u16 = 40;
/// With so much left, cells, a part of the picture is still worth seeing.
const OVER_COLUMN: u16 = 12;

/// Most steps of magnification that any clip on any screen can need.
pub const ZOOM_MAX: u8 = 16;

/// The parts of the screen; a part without room is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Clip, tracks, link.
    pub title: Rect,
    /// The picture: what the rest leaves.
    pub picture: Rect,
    /// The panel, its edge included.
    pub column: Rect,
    /// The selected track.
    pub track: Rect,
    /// The whole clip.
    pub time: Rect,
    /// Where we are and what keys do.
    pub hints: Rect,
}

impl Layout {
    /// The parts of a screen.
    #[must_use]
    pub fn of(state: &State) -> Self {
        let (columns, rows) = state.size;
        let line = |row: u16| Rect::new(0, row.min(rows), columns, u16::from(row < rows));
        // On low screens the picture gives way last but one: the hints stay.
        let n_lines = if rows >= 8 { 3 } else { 1 };
        let below = rows.saturating_sub(n_lines).max(1);
        // Beside the picture where both have room, else over its right part; on the narrowest screens over all of it.
        let column = match state.panel {
            Some(Panel::Queue) if columns < NARROW => NARROW_QUEUE,
            _ => COLUMN,
        };
        let taken = match state.panel {
            None => 0,
            Some(_) if columns > COLUMN + OVER_COLUMN && !state.panel_is_wide => column + 1,
            Some(_) => columns,
        };
        let is_beside = columns >= taken + BESIDE_COLUMN;
        let width = if is_beside { columns - taken } else { columns };
        let height = below.saturating_sub(1);
        let nothing = Rect::new(0, 0, 0, 0);
        Self {
            title: line(0),
            picture: Rect::new(0, 1.min(rows), width, height),
            column: Rect { x: columns - taken, width: taken, ..Rect::new(0, 1.min(rows), columns, height) },
            track: if n_lines == 3 { line(below) } else { nothing },
            time: if n_lines == 3 { line(below + 1) } else { nothing },
            hints: line(rows.saturating_sub(1)),
        }
    }
}

/// The part of the picture that is seen, and the cells that show it, each of so many pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Left edge in the image, pixels; the centre of the first pixel is 0, its edge -0.5.
    pub x: f64,
    /// Upper edge in the image, pixels.
    pub y: f64,
    /// Width in the image, pixels.
    pub width: f64,
    /// Height in the image, pixels.
    pub height: f64,
    /// The cells.
    pub area: Rect,
    /// Pixels of a cell, across and down.
    pub grid: (u32, u32),
}

/// Image pixels of a cell, across, at the deepest magnification.
const SMALLEST: f64 = 1.0 / 8.0;

/// Image pixels of a cell, across: half as many with each step, and from one on whole cells for each pixel.
fn scale(whole: f64, zoom: u8) -> f64 {
    let scale = whole * 0.5_f64.powi(zoom.into());
    if zoom == 0 || scale > 1.0 { scale } else { scale.log2().ceil().exp2().max(SMALLEST) }
}

impl Lens {
    /// The lens of the picture on screen.
    #[must_use]
    pub fn shown(state: &State) -> Self {
        Self::of(state, Layout::of(state).picture)
    }

    /// The lens of a state in an area: all of the picture, or a part as large as the zoom says.
    #[must_use]
    pub fn of(state: &State, area: Rect) -> Self {
        let (clip_width, clip_height) = (f64::from(state.clip.width), f64::from(state.clip.height));
        let (columns, rows) = (f64::from(area.width), f64::from(2 * area.height));
        let whole = Self::whole(state, area);
        let scale = scale(whole, state.zoom);
        let n_columns = (clip_width / scale).round().min(columns).max(1.0);
        let n_rows = ((clip_height / scale / 2.0).round() * 2.0).min(rows).max(2.0);
        let (width, height) = if state.zoom == 0 {
            (clip_width, clip_height)
        } else {
            ((n_columns * scale).min(clip_width), (n_rows * scale).min(clip_height))
        };
        let [cx, cy] = state.centre.map(f64::from);
        let (n_columns, n_rows) = (n_columns as u16, n_rows as u16 / 2);
        // In whole steps of the screen's pixels: what stands still keeps its pixels when the view moves, and what is
        // magnified keeps its edges.
        let edge = |centre: f64, extent: f64, limit: f64| {
            let steps = ((centre + 0.5 - extent / 2.0) / scale).round();
            (steps * scale).clamp(0.0, limit - extent) - 0.5
        };
        Self {
            x: edge(cx, width, clip_width),
            y: edge(cy, height, clip_height),
            width,
            height,
            area: Rect {
                x: area.x + (area.width.saturating_sub(n_columns)) / 2,
                y: area.y + (area.height.saturating_sub(n_rows)) / 2,
                width: n_columns.min(area.width),
                height: n_rows.min(area.height),
            },
            grid: state.shown_glyphs().grid(),
        }
    }

    /// The last step of magnification that brings one closer.
    #[must_use]
    pub fn deepest(state: &State, area: Rect) -> u8 {
        let whole = Self::whole(state, area);
        (0..ZOOM_MAX).find(|&zoom| scale(whole, zoom) <= SMALLEST).unwrap_or(ZOOM_MAX)
    }

    /// Image pixels of a cell, across, that show everything.
    fn whole(state: &State, area: Rect) -> f64 {
        let (columns, rows) = (f64::from(area.width), f64::from(2 * area.height));
        (f64::from(state.clip.width) / columns.max(1.0)).max(f64::from(state.clip.height) / rows.max(1.0))
    }

    /// The image point in its middle.
    #[must_use]
    pub fn middle(&self) -> [f32; 2] {
        [(self.x + self.width / 2.0) as f32, (self.y + self.height / 2.0) as f32]
    }

    /// Cells that an image pixel is wide: 1 and above it is seen as it is.
    #[must_use]
    pub fn magnification(&self) -> f64 {
        f64::from(self.area.width) / self.width
    }

    /// Screen pixels across and down.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        (self.grid.0 * u32::from(self.area.width), self.grid.1 * u32::from(self.area.height))
    }

    /// The screen pixel that shows an image point, from the lens's upper left; `None` outside.
    #[must_use]
    pub fn pixel_of(&self, at: [f32; 2]) -> Option<(u32, u32)> {
        self.place_of(at, self.grid)
    }

    /// Where an image point is shown when a cell has so many places, across and down; `None` outside.
    #[must_use]
    pub fn place_of(&self, [x, y]: [f32; 2], grid: (u32, u32)) -> Option<(u32, u32)> {
        let columns = f64::from(grid.0) * f64::from(self.area.width);
        let rows = f64::from(grid.1) * f64::from(self.area.height);
        let across = (f64::from(x) - self.x) / self.width * columns;
        let down = (f64::from(y) - self.y) / self.height * rows;
        let inside = (0.0..columns).contains(&across) && (0.0..rows).contains(&down);
        inside.then_some((across as u32, down as u32))
    }

    /// The image point in the middle of a cell of the screen; `None` outside.
    #[must_use]
    pub fn point_of(&self, column: u16, row: u16) -> Option<[f32; 2]> {
        let inside = self.area.contains((column, row).into());
        let across = (f64::from(column) - f64::from(self.area.x) + 0.5) / f64::from(self.area.width);
        let down = (f64::from(row) - f64::from(self.area.y) + 0.5) / f64::from(self.area.height);
        inside.then_some([(self.x + across * self.width) as f32, (self.y + down * self.height) as f32])
    }

    /// Image pixels that a cell is wide and high.
    #[must_use]
    pub fn cell_sides_px(&self) -> (f64, f64) {
        let sides = (f64::from(self.area.width.max(1)), f64::from(self.area.height.max(1)));
        (self.width / sides.0, self.height / sides.1)
    }

    /// Image pixels that a cell is wide.
    #[must_use]
    pub fn cell_px(&self) -> f32 {
        (self.width / f64::from(self.area.width.max(1))) as f32
    }
}

/// The bar of the time line, between the numbers of the first and the last frame.
#[must_use]
pub fn bar(line: Rect, n_frames: u32) -> Rect {
    let digits = u16::try_from(n_frames.saturating_sub(1).to_string().len()).unwrap_or(u16::MAX);
    Rect { x: line.x + 1.min(line.width), width: line.width.saturating_sub(1 + digits), ..line }
}

/// The frame that a column of the bar stands for.
#[must_use]
pub fn frame_at(bar: Rect, n_frames: u32, column: u16) -> u32 {
    let last = u64::from(n_frames.saturating_sub(1));
    let ends = u64::from(bar.width.saturating_sub(1).max(1));
    let at = u64::from(column.saturating_sub(bar.x)).min(ends);
    u32::try_from((last * at + ends / 2) / ends).unwrap_or(u32::MAX)
}

/// The column of the bar that stands for a frame.
#[must_use]
pub fn column_of(bar: Rect, n_frames: u32, frame: u32) -> u16 {
    let last = u64::from(n_frames.saturating_sub(1).max(1));
    let ends = u64::from(bar.width.saturating_sub(1));
    bar.x + u16::try_from((u64::from(frame).min(last) * ends + last / 2) / last).unwrap_or(0)
}
