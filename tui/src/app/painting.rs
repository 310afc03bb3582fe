//! Marks painted over a frame: strokes of the plant and of what lies behind it, of which a matte is found.

use std::sync::Arc;

use honami_workbench::matting::{Mark, Part, Parts};

/// Widest brush, image pixels from its middle to its border.
const WIDEST_PX: u32 = 100;
/// A brush to begin with is this part of the picture's width.
const USUAL: u32 = 160;

/// What is being painted.
#[derive(Clone, Debug)]
pub struct Painting {
    /// The frame that is painted on.
    pub frame: u32,
    /// Where the pen is, image pixels.
    pub at: [f32; 2],
    /// What it marks; `Unknown` is the eraser.
    pub brush: Mark,
    /// From its middle to its border, image pixels; 0 is a single one.
    pub radius_px: u32,
    /// Whether it paints where keys lead it.
    pub is_down: bool,
    /// The strokes, in order.
    pub strokes: Vec<Stroke>,
    /// What has become of all that was painted.
    pub marks: Plane,
    /// What there was before the first stroke.
    before: Plane,
    /// The parts of the matte, and of how many strokes it was found; none where it was found before.
    pub found: Option<(Option<usize>, Arc<Parts>)>,
}

/// A line painted without lifting the pen.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    brush: Mark,
    radius_px: u32,
    points: Vec<[f32; 2]>,
}

/// A mark for every pixel of a picture.
#[derive(Clone, PartialEq, Eq)]
pub struct Plane {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Row by row.
    pub marks: Arc<Vec<Mark>>,
    /// Changes so far.
    pub n_changes: u64,
}

/// Pixels by the hundred thousand tell nobody anything.
impl std::fmt::Debug for Plane {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let n_marked = self.marks.iter().filter(|mark| **mark != Mark::Unknown).count();
        write!(f, "{:?}: {n_marked} marked, {} changes", self.size, self.n_changes)
    }
}

impl Plane {
    fn new(size: [u32; 2]) -> Self {
        let n_pixels = size[0] as usize * size[1] as usize;
        Self { size, marks: Arc::new(vec![Mark::Unknown; n_pixels]), n_changes: 0 }
    }

    /// The mark that is seen of a part of the picture: the first that is none of unknown; `None` where all are.
    #[must_use]
    pub fn seen(&self, from: [f64; 2], to: [f64; 2]) -> Option<Mark> {
        let edge = |v: f64, size: u32| v.round().clamp(0.0, f64::from(size.saturating_sub(1))) as usize;
        let [left, right] = [from[0], to[0]].map(|x| edge(x, self.size[0]));
        let [top, foot] = [from[1], to[1]].map(|y| edge(y, self.size[1]));
        let row = |y: usize| &self.marks[y * self.size[0] as usize..][left..=right.max(left)];
        (top..=foot.max(top)).flat_map(row).copied().find(|mark| *mark != Mark::Unknown)
    }

    /// Marks what is no farther than the brush from the line between two points.
    fn paint(&mut self, stroke: &Stroke, [from, to]: [[f32; 2]; 2]) {
        self.n_changes += 1;
        let reach = stroke.radius_px as f32 + 0.5;
        let span = |axis: usize| {
            let (least, most) = (from[axis].min(to[axis]) - reach, from[axis].max(to[axis]) + reach);
            least.max(0.0) as u32..(most.max(-1.0) + 1.0).min(self.size[axis] as f32) as u32
        };
        let (columns, rows, width) = (span(0), span(1), self.size[0]);
        let marks = Arc::make_mut(&mut self.marks);
        for y in rows {
            for x in columns.clone() {
                if apart([x as f32, y as f32], from, to) <= reach {
                    marks[(y * width + x) as usize] = stroke.brush;
                }
            }
        }
    }
}

/// How far a point is from a line between two others.
fn apart(at: [f32; 2], from: [f32; 2], to: [f32; 2]) -> f32 {
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = way[0] * way[0] + way[1] * way[1];
    let along = (at[0] - from[0]) * way[0] + (at[1] - from[1]) * way[1];
    let share = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
    (at[0] - from[0] - share * way[0]).hypot(at[1] - from[1] - share * way[1])
}

impl Painting {
    /// Nothing painted on a frame yet, the pen at a place.
    #[must_use]
    pub fn new(frame: u32, at: [f32; 2], size: [u32; 2]) -> Self {
        let before = Plane::new(size);
        Self {
            frame,
            at,
            brush: Mark::Foreground,
            radius_px: (size[0] / USUAL).max(1),
            is_down: false,
            strokes: Vec::new(),
            marks: before.clone(),
            before,
            found: None,
        }
    }

    /// The matte that the project keeps of this frame, and its marks, are gone on from.
    pub fn go_on_from(&mut self, marks: Arc<Vec<Mark>>, parts: Arc<Parts>) {
        if marks.len() == self.marks.marks.len() && self.strokes.is_empty() {
            self.before.marks = marks;
            self.found = Some((None, parts));
            self.repaint();
        }
    }

    /// What the brush is called.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self.brush {
            Mark::Foreground => "plant",
            Mark::Background => "background",
            Mark::Unknown => "eraser",
        }
    }

    /// Lifts the pen and takes the next brush: plant, background, eraser.
    pub fn next_brush(&mut self) {
        self.brush = match self.brush {
            Mark::Foreground => Mark::Background,
            Mark::Background => Mark::Unknown,
            Mark::Unknown => Mark::Foreground,
        };
        // Where it was put down with one brush, nobody wants the other.
        self.is_down = false;
    }

    /// A brush wider by so many pixels.
    pub fn widen(&mut self, by: i64) {
        let wider = i64::from(self.radius_px).saturating_add(by).clamp(0, WIDEST_PX.into());
        self.radius_px = u32::try_from(wider).unwrap_or(WIDEST_PX);
        self.set_pen(self.is_down);
    }

    /// Puts the pen down here, or lifts it.
    pub fn set_pen(&mut self, is_down: bool) {
        self.is_down = is_down;
        if is_down {
            self.begin(self.at);
        }
    }

    /// A stroke begins.
    pub fn begin(&mut self, at: [f32; 2]) {
        self.at = at;
        let stroke = Stroke { brush: self.brush, radius_px: self.radius_px, points: vec![at] };
        self.marks.paint(&stroke, [at, at]);
        self.strokes.push(stroke);
    }

    /// The pen goes to a place; what it passes is painted where it is down.
    pub fn lead(&mut self, to: [f32; 2], is_down: bool) {
        let from = std::mem::replace(&mut self.at, to);
        match self.strokes.last_mut().filter(|_| is_down) {
            Some(stroke) => {
                stroke.points.push(to);
                self.marks.paint(stroke, [from, to]);
            }
            None if is_down => self.begin(to),
            None => {}
        }
    }

    /// Takes back the stroke that was painted last; whether there was one.
    pub fn take_back(&mut self) -> bool {
        self.is_down = false;
        let there_was = self.strokes.pop().is_some();
        self.repaint();
        there_was
    }

    fn repaint(&mut self) {
        let n_changes = self.marks.n_changes + 1;
        self.marks = self.before.clone();
        for stroke in &self.strokes {
            let first = stroke.points.first().map(|at| [*at; 2]);
            let lines = stroke.points.windows(2).map(|two| [two[0], two[1]]);
            first.into_iter().chain(lines).for_each(|line| self.marks.paint(stroke, line));
        }
        self.marks.n_changes = n_changes;
    }

    /// Whether the matte was found of all that is painted, and is not kept yet.
    #[must_use]
    pub fn can_keep(&self) -> bool {
        self.found.as_ref().is_some_and(|(of, _)| *of == Some(self.strokes.len()))
    }

    /// The part of the matte at a place of the picture.
    #[must_use]
    pub fn part_at(&self, [x, y]: [f64; 2]) -> Option<Part> {
        let (_, parts) = self.found.as_ref()?;
        let [x, y] = [x, y].map(|v| v.round().max(0.0) as usize);
        let inside = x < parts.width as usize && y < parts.height as usize;
        inside.then(|| parts.parts[y * parts.width as usize + x])
    }
}

#[cfg(test)]
mod tests;
