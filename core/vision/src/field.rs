//! Dense motion: where every node of a grid over one picture went in the next, and points that follow it.
//!
//! A field is a displacement, not a speed, so a point that follows it moves by one step from picture to picture:
//! `x(t+1) = x(t) + f_t(x(t))` (J. Diener's thesis, 2.4.4). Each step's error stays in the point's position.

#[cfg(test)]
mod tests;

use crate::{Gray, Point};

/// Places in even rows and columns over a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Position of the first node, pixels.
    pub origin: Point,
    /// From a node to the next, right and down, pixels; positive.
    pub step_px: f32,
    /// Nodes in a row.
    pub nx: u32,
    /// Rows.
    pub ny: u32,
}

impl Grid {
    /// A grid over a picture, one node every `step_px` pixels, as far from one edge as from the other.
    ///
    /// With a step of 1 the nodes are the pixels. A step of 0 is taken as 1.
    #[must_use]
    pub fn over(width: u32, height: u32, step_px: u32) -> Self {
        let step = step_px.max(1);
        let [(nx, x), (ny, y)] = [width, height].map(|size| {
            let n = size.div_ceil(step).max(1);
            (n, (size.max(1) - 1 - (n - 1) * step) as f32 / 2.0)
        });
        Self { origin: [x, y], step_px: step as f32, nx, ny }
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nx as usize * self.ny as usize
    }

    /// Whether it has no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of a node, pixels.
    #[must_use]
    pub fn node(&self, column: u32, row: u32) -> Point {
        [self.origin[0] + column as f32 * self.step_px, self.origin[1] + row as f32 * self.step_px]
    }

    /// Positions of all nodes, row by row.
    pub fn nodes(&self) -> impl Iterator<Item = Point> + use<> {
        let grid = *self;
        (0..grid.ny).flat_map(move |row| (0..grid.nx).map(move |column| grid.node(column, row)))
    }
}

/// Displacements at the nodes of a grid, `(ny, nx)` row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Where the nodes are.
    pub grid: Grid,
    /// To the right, pixels; 0 where not known, always finite.
    pub u: Vec<f32>,
    /// Down, pixels; likewise.
    pub v: Vec<f32>,
    /// Whether the displacement was measured.
    pub known: Vec<bool>,
}

/// What became of a point that follows a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drift {
    /// It is there now.
    To(Point),
    /// It is, or went, beyond the picture.
    Outside,
    /// The motion around it is not known.
    Unknown,
}

impl Field {
    /// A field of one displacement a node, row by row; `None` and what is not finite are not known.
    ///
    /// # Panics
    /// When there is not one displacement a node.
    #[must_use]
    #[track_caller]
    pub fn new(grid: Grid, displacements: impl IntoIterator<Item = Option<[f32; 2]>>) -> Self {
        let mut field = Self { grid, u: Vec::new(), v: Vec::new(), known: Vec::new() };
        for displacement in displacements {
            let displacement = displacement.filter(|d| d.iter().all(|c| c.is_finite()));
            let [u, v] = displacement.unwrap_or_default();
            field.u.push(u);
            field.v.push(v);
            field.known.push(displacement.is_some());
        }
        assert_eq!(field.known.len(), grid.len(), "one displacement a node");
        field
    }

    /// The displacement at each node, row by row; `None` where it is not known.
    pub fn vectors(&self) -> impl Iterator<Item = Option<[f32; 2]>> + '_ {
        let vectors = self.u.iter().zip(&self.v).zip(&self.known);
        vectors.map(|((&u, &v), &is_known)| is_known.then_some([u, v]))
    }

    /// Displacement at a position, pixels: bilinear between the four nodes around it.
    ///
    /// Nodes that are not known leave their weight to the others; `None` where they have more than half of it, or
    /// for a position that is no number. Beyond the outermost nodes theirs goes on.
    #[must_use]
    pub fn at(&self, at: Point) -> Option<[f32; 2]> {
        let Grid { origin, step_px, nx, ny } = self.grid;
        let along = |axis: usize, n: u32| {
            let place = (at[axis] - origin[axis]) / step_px;
            let last = n.checked_sub(1)?;
            let place = place.is_finite().then(|| place.clamp(0.0, last as f32))?;
            let first = place as usize;
            Some((first, (first + 1).min(last as usize), place - first as f32))
        };
        let ((left, right, fx), (above, below, fy)) = (along(0, nx)?, along(1, ny)?);
        let node = |row: usize, column: usize| row * nx as usize + column;
        let (mut sum, mut known) = ([0.0; 2], 0.0);
        for (i, weight) in [
            (node(above, left), (1.0 - fx) * (1.0 - fy)),
            (node(above, right), fx * (1.0 - fy)),
            (node(below, left), (1.0 - fx) * fy),
            (node(below, right), fx * fy),
        ] {
            if self.known[i] {
                sum = [sum[0] + weight * self.u[i], sum[1] + weight * self.v[i]];
                known += weight;
            }
        }
        (known >= 0.5).then(|| sum.map(|c| c / known))
    }

    /// Where a point of the first picture is in the second, which is as large.
    #[must_use]
    pub fn follow(&self, at: Point, picture: &Gray<'_>) -> Drift {
        if !picture.holds(at) {
            return Drift::Outside;
        }
        let Some([u, v]) = self.at(at) else { return Drift::Unknown };
        let to = [at[0] + u, at[1] + v];
        if picture.holds(to) { Drift::To(to) } else { Drift::Outside }
    }
}
