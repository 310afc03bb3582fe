//! 2x2 matrices: how a window is turned, stretched and sheared.

/// Row-major: from offsets in a template to offsets in a picture.
pub(super) type Warp = [f32; 4];

/// Neither turned nor stretched.
pub(super) const STILL: Warp = [1.0, 0.0, 0.0, 1.0];

/// First `b`, then `a`.
pub(super) fn product(a: Warp, b: Warp) -> Warp {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    ]
}

/// Back again; `None` where the matrix flattens.
pub(super) fn inverse(a: Warp) -> Option<Warp> {
    let determinant = determinant(a);
    (determinant.abs() > 1e-3).then(|| [a[3], -a[1], -a[2], a[0]].map(|c| c / determinant))
}

/// By how much areas grow.
pub(super) fn determinant(a: Warp) -> f32 {
    a[0] * a[3] - a[1] * a[2]
}

/// Where an offset goes.
pub(super) fn apply(a: Warp, [x, y]: [f32; 2]) -> [f32; 2] {
    [a[0] * x + a[1] * y, a[2] * x + a[3] * y]
}
