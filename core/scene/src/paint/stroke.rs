//! Lines: single, joined, fading, and with a head.

use std::ops::Range;

use super::{Canvas, Ink, Point, covered, covered_line};

/// A head is so many widths of its shaft long, and as wide.
const HEAD: f64 = 4.5;

/// How much of what pixels are covered, in a part of a picture.
struct Mask {
    columns: Range<usize>,
    rows: Range<usize>,
    parts: Vec<f32>,
}

impl Canvas {
    /// A line with round ends.
    pub fn line(&mut self, from: Point, to: Point, width: f64, ink: Ink) {
        let size = [self.width, self.height()];
        touch(size, [from, to], width, |row, column, part, _| {
            self.blend(row * size[0] + column, ink.rgb, part * ink.alpha);
        });
    }

    /// Lines from each point to the next, with round ends and joints.
    pub fn polyline(&mut self, points: &[Point], width: f64, ink: Ink) {
        self.joined(points, width, ink, |_| 1.0);
    }

    /// The same, fading: so much of the ink at the first point, and so much at the last, 0 to 1.
    pub fn trail(&mut self, points: &[Point], width: f64, ink: Ink, [first, last]: [f64; 2]) {
        let steps = points.len().saturating_sub(1).max(1) as f64;
        self.joined(points, width, ink, |place| first + (last - first) * place / steps);
    }

    /// A line to where something goes, with a head; of a way that is shorter than the head, a smaller head alone.
    pub fn arrow(&mut self, from: Point, to: Point, width: f64, ink: Ink) {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        let head = (HEAD * width).min(length);
        if !(head > 0.0 && length.is_finite()) {
            return;
        }
        let unit = way.map(|v| v / length);
        let neck = [0, 1].map(|axis| to[axis] - head * unit[axis]);
        let half = head / 2.0;
        let corners = [
            to,
            [neck[0] - half * unit[1], neck[1] + half * unit[0]],
            [neck[0] + half * unit[1], neck[1] - half * unit[0]],
        ];
        let mut mask = self.mask(&[from, corners[0], corners[1], corners[2]], width);
        let size = [self.width, self.height()];
        if length > head {
            touch(size, [from, neck], width, |row, column, part, _| mask.raise(row, column, part));
        }
        for row in mask.rows.clone() {
            for column in mask.columns.clone() {
                mask.raise(row, column, covered(beyond(corners, [column as f64, row as f64])));
            }
        }
        self.lay(&mask, ink);
    }

    /// Lines from each point to the next, each place of them as strong as `strength` says: 0 the first point, 1 the next.
    fn joined(&mut self, points: &[Point], width: f64, ink: Ink, strength: impl Fn(f64) -> f64) {
        let mut mask = self.mask(points, width);
        let size = [self.width, self.height()];
        for (k, pair) in points.windows(2).enumerate() {
            touch(size, [pair[0], pair[1]], width, |row, column, part, t| {
                mask.raise(row, column, part * strength(k as f64 + t));
            });
        }
        self.lay(&mask, ink);
    }

    /// Nothing yet about these points and as far as a line so wide reaches.
    fn mask(&self, points: &[Point], width: f64) -> Mask {
        let finite = || points.iter().filter(|point| point.iter().all(|v| v.is_finite()));
        let low = [0, 1].map(|axis| finite().map(|point| point[axis]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|axis| finite().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max));
        let centre = [0, 1].map(|axis| f64::midpoint(low[axis], high[axis]));
        let reach = [0, 1].map(|axis| (high[axis] - low[axis]) / 2.0 + width / 2.0 + 1.5);
        let patch = self.patch(centre, reach);
        let n_pixels = patch.columns.len() * patch.rows.len();
        Mask { columns: patch.columns, rows: patch.rows, parts: vec![0.0; n_pixels] }
    }

    fn lay(&mut self, mask: &Mask, ink: Ink) {
        let lines = mask.parts.chunks_exact(mask.columns.len().max(1));
        for (row, parts) in mask.rows.clone().zip(lines) {
            for (column, &part) in mask.columns.clone().zip(parts) {
                if part > 0.0 {
                    self.blend(row * self.width + column, ink.rgb, f64::from(part) * ink.alpha);
                }
            }
        }
    }
}

impl Mask {
    /// A pixel is covered at least so much: what goes over itself covers once.
    fn raise(&mut self, row: usize, column: usize, part: f64) {
        if self.rows.contains(&row) && self.columns.contains(&column) {
            let at = (row - self.rows.start) * self.columns.len() + column - self.columns.start;
            self.parts[at] = self.parts[at].max(part as f32);
        }
    }
}

/// Every pixel that a line with round ends covers: its row and column, how much of it, and how far along the line, 0 to 1.
fn touch(
    [n_columns, n_rows]: [usize; 2],
    [from, to]: [Point; 2],
    width: f64,
    mut each: impl FnMut(usize, usize, f64, f64),
) {
    let way = [to[0] - from[0], to[1] - from[1]];
    let square = way[0].powi(2) + way[1].powi(2);
    if !(width > 0.0 && square.is_finite() && from.iter().chain(&to).all(|v| v.is_finite())) {
        return;
    }
    let reach = width / 2.0 + 0.5;
    let span = |low: f64, high: f64, n: usize| {
        let first = (low - reach).ceil().max(0.0) as usize;
        first..(((high + reach).floor() + 1.0).max(0.0) as usize).min(n)
    };
    for row in span(from[1].min(to[1]), from[1].max(to[1]), n_rows) {
        // The part of the line that is so near to this row, and no more columns than that reaches.
        let ends = [-reach, reach].map(|off| {
            let t = (row as f64 + off - from[1]) / way[1];
            if t.is_finite() { t.clamp(0.0, 1.0) } else { f64::NAN }
        });
        let [a, b] = if ends[0].is_nan() || ends[1].is_nan() { [0.0, 1.0] } else { ends };
        let columns = [a, b].map(|t| from[0] + t * way[0]);
        for column in span(columns[0].min(columns[1]), columns[0].max(columns[1]), n_columns) {
            let off = [column as f64 - from[0], row as f64 - from[1]];
            let t = if square > 0.0 {
                ((off[0] * way[0] + off[1] * way[1]) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let part = covered_line((off[0] - t * way[0]).hypot(off[1] - t * way[1]), width);
            if part > 0.0 {
                each(row, column, part, t);
            }
        }
    }
}

/// How far a place is beyond the nearest edge of a triangle, in the way it is beyond that edge's line.
fn beyond(corners: [Point; 3], at: Point) -> f64 {
    let edge = |a: Point, b: Point| {
        let way = [b[0] - a[0], b[1] - a[1]];
        (way[0] * (at[1] - a[1]) - way[1] * (at[0] - a[0])) / way[0].hypot(way[1])
    };
    let [a, b, c] = corners;
    let of = [edge(a, b), edge(b, c), edge(c, a)];
    // Corners go round one way or the other.
    let way = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    of.into_iter()
        .map(|distance| if way > 0.0 { -distance } else { distance })
        .fold(f64::NEG_INFINITY, f64::max)
}
