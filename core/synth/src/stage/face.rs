//! What the targets look like, and how they are carried.

use honami_cameras::{Place, Pose};
use nalgebra::{Rotation3, Vector2, Vector3};

use super::{Carried, carried};

const COLUMNS: usize = 9;
const ROWS: usize = 6;
/// Side of a square of the board, metres.
const SQUARE_M: f64 = 0.03;
/// White about the board, metres.
const MARGIN_M: f64 = 0.02;
/// Targets on the bars, metres along the first and the second one.
const TARGETS: [[f64; 2]; 6] = [[0.0, 0.0], [-2.5, 0.0], [1.2, 0.0], [2.5, 0.0], [0.0, -0.5], [0.0, 0.5]];
/// A target is a white disc on a dark one, metres.
pub(super) const WHITE_M: f64 = 0.08;
const DARK_M: f64 = 0.15;
/// Half the width of a bar, metres.
const BAR_M: f64 = 0.03;

const PAPER: [f32; 3] = [228.0, 228.0, 222.0];
const INK: [f32; 3] = [24.0, 24.0, 28.0];
const WOOD: [f32; 3] = [150.0, 118.0, 78.0];

/// A flat thing whose places have colours; x and y on its plane, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face(Carried);

impl Face {
    pub(super) fn of(carried: Carried) -> Self {
        Self(carried)
    }

    pub(super) fn points(self) -> Vec<[f64; 2]> {
        match self.0 {
            Carried::Bars => TARGETS.to_vec(),
            Carried::Board => {
                let at = |i: usize| [(i % COLUMNS) as f64 * SQUARE_M, (i / COLUMNS) as f64 * SQUARE_M];
                (0..COLUMNS * ROWS).map(at).collect()
            }
        }
    }

    /// How it stands before the left camera, `t` from 0 to 1.
    pub(super) fn pose(self, t: f64) -> Pose {
        match self.0 {
            Carried::Board => {
                let pose = carried(t, [0.42, 0.16], 0.2, [0.07, 0.035], [0.5, 0.06]);
                // It turns about its middle, and between both cameras.
                let middle = Place::new((COLUMNS - 1) as f64, (ROWS - 1) as f64, 0.0) * (SQUARE_M / 2.0);
                let aside = Vector3::new(0.04, 0.0, 0.0);
                Pose { translation: pose.translation + aside - pose.rotation * middle, ..pose }
            }
            Carried::Bars => carried(t, [0.45, 0.1], 0.5, [1.6, 1.2], [14.0, 2.5]),
        }
    }

    /// Whether a ray may meet it, or one a pixel beside.
    pub(super) fn may_lie(self, origin: &Place, turn: &Rotation3<f64>, ray: Vector2<f32>) -> bool {
        let Some([x, y]) = meets(origin, turn, ray) else { return false };
        let ([left, right], [top, bottom]) = self.bounds();
        let about = match self.0 {
            Carried::Board => 0.03,
            Carried::Bars => 0.4,
        };
        (left - about..right + about).contains(&x) && (top - about..bottom + about).contains(&y)
    }

    fn bounds(self) -> ([f64; 2], [f64; 2]) {
        match self.0 {
            Carried::Board => {
                let edge = SQUARE_M + MARGIN_M;
                let far = |n: usize| (n - 1) as f64 * SQUARE_M + edge;
                ([-edge, far(COLUMNS)], [-edge, far(ROWS)])
            }
            Carried::Bars => ([-2.5 - DARK_M, 2.5 + DARK_M], [-0.5 - DARK_M, 0.5 + DARK_M]),
        }
    }

    /// What a ray meets; none where that is the background.
    pub(super) fn light(self, origin: &Place, turn: &Rotation3<f64>, ray: Vector2<f32>) -> Option<[f32; 3]> {
        let [x, y] = meets(origin, turn, ray)?;
        match self.0 {
            Carried::Board => {
                let ([left, right], [top, bottom]) = self.bounds();
                if !(left..right).contains(&x) || !(top..bottom).contains(&y) {
                    return None;
                }
                let (column, row) = ((x / SQUARE_M).floor() as i64 + 1, (y / SQUARE_M).floor() as i64 + 1);
                let inside = (0..=COLUMNS as i64).contains(&column) && (0..=ROWS as i64).contains(&row);
                Some(if inside && (column + row) % 2 == 0 { INK } else { PAPER })
            }
            Carried::Bars => {
                let near = TARGETS.iter().map(|[u, v]| (x - u).hypot(y - v)).fold(f64::INFINITY, f64::min);
                let is_bar = (y.abs() < BAR_M && x.abs() < 2.6) || (x.abs() < BAR_M && y.abs() < 0.6);
                match near {
                    ..WHITE_M => Some(PAPER),
                    ..DARK_M => Some(INK),
                    _ => is_bar.then_some(WOOD),
                }
            }
        }
    }
}

/// Where a ray of a camera meets the plane; the camera stands at `origin` in the plane's axes, turned by `turn`.
fn meets(origin: &Place, turn: &Rotation3<f64>, ray: Vector2<f32>) -> Option<[f64; 2]> {
    let along = turn * Vector3::new(f64::from(ray.x), f64::from(ray.y), 1.0);
    let depth = -origin.z / along.z;
    (depth.is_finite() && depth > 0.0).then(|| [origin.x + depth * along.x, origin.y + depth * along.y])
}
