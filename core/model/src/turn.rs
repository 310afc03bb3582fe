//! Turns in space, as rotation matrices and as quaternions.

#[cfg(test)]
mod tests;

/// Shorter than this, of vectors of length 1, is no direction.
const NOTHING: f64 = 1e-12;

/// A turn: a rotation matrix, its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn([[f64; 3]; 3]);

impl Turn {
    /// The turn by nothing.
    pub const NONE: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// About an axis of length 1, counterclockwise where it points at the eye (Rodrigues).
    #[must_use]
    pub fn about(axis: [f64; 3], angle_rad: f64) -> Self {
        let (s, c) = angle_rad.sin_cos();
        let [x, y, z] = axis;
        let skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let same = if i == j { c } else { 0.0 };
                same + s * skew[i][j] + (1.0 - c) * axis[i] * axis[j]
            })
        }))
    }

    /// The shortest from one direction to another, both of length 1; half a turn goes about the line of sight, less what of
    /// it is along the direction.
    #[must_use]
    pub fn between(from: [f64; 3], to: [f64; 3]) -> Self {
        Self::about(axis(from, to), angle(from, to))
    }

    /// Where it turns a vector.
    #[must_use]
    pub fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| dot(row, v))
    }

    /// This one after another.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let column = |j: usize| first.0.map(|row| row[j]);
        Self(self.0.map(|row| std::array::from_fn(|j| dot(row, column(j)))))
    }

    /// What undoes it.
    #[must_use]
    pub fn back(&self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[j][i])))
    }

    /// Its matrix, row by row.
    #[must_use]
    pub fn rows(&self) -> [[f64; 3]; 3] {
        self.0
    }

    /// As a quaternion of length 1: along x, y and z, and what is real, which is 0 or more (Shepperd, J. Guidance and
    /// Control 1, 1978: from the largest of the four, so that nothing small is divided by).
    #[must_use]
    pub fn quaternion(&self) -> [f64; 4] {
        let m = &self.0;
        let diagonal = [m[0][0], m[1][1], m[2][2]];
        let trace: f64 = diagonal.iter().sum();
        let mut q = [0.0; 4];
        match (0..3).max_by(|a, b| diagonal[*a].total_cmp(&diagonal[*b])) {
            Some(i) if diagonal[i] > trace => {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                q[i] = 1.0 + diagonal[i] - diagonal[j] - diagonal[k];
                (q[j], q[k], q[3]) = (m[j][i] + m[i][j], m[k][i] + m[i][k], m[k][j] - m[j][k]);
            }
            _ => q = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1.0 + trace],
        }
        let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
        q.map(|v| if q[3] < 0.0 { -v / length } else { v / length })
    }
}

/// From one direction to another, both of length 1: 0 to π, exact also where it is small.
#[must_use]
pub fn angle(from: [f64; 3], to: [f64; 3]) -> f64 {
    norm(cross(from, to)).atan2(dot(from, to))
}

/// What is turned about to get from one direction to another, of length 1. Where any would do, it is the line of sight; and
/// where that is the direction itself, the horizontal.
#[must_use]
pub fn axis(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let upright = |v: [f64; 3]| {
        let along = dot(v, from);
        std::array::from_fn(|k| v[k] - along * from[k])
    };
    let choices = [cross(from, to), upright([0.0, 1.0, 0.0]), upright([1.0, 0.0, 0.0])];
    let found = choices.into_iter().find(|v| norm(*v) > NOTHING).unwrap_or([0.0, 1.0, 0.0]);
    found.map(|v| v / norm(found))
}

/// The inner product.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// What is at right angles to both.
#[must_use]
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The length.
#[must_use]
pub fn norm(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}
