//! From places to pictures.

use honami_scene::Camera;

/// The nearest that is seen, of the way from the eye to what it looks at.
const NEAREST: f32 = 1e-3;

/// Columns of the matrix from places to what pipelines clip and divide: right and up from -1 to 1, and nearness, which is 1 at
/// a thousandth of the way to the target and 0 without end.
#[must_use]
pub fn matrix(camera: &Camera, aspect: f32) -> [[f32; 4]; 4] {
    let [right, up, forward] = camera.axes();
    let half = (camera.angle / 2.0).tan();
    let (eye, target) = (camera.eye, camera.target);
    let distance = (0..3).map(|axis| (target[axis] - eye[axis]).powi(2)).sum::<f32>().sqrt();
    // Each row but for what the eye adds.
    let rows = [right.map(|v| v / (half * aspect)), up.map(|v| v / half), [0.0; 3], forward];
    let from_eye = |row: &[f32; 3]| -(0..3).map(|axis| row[axis] * eye[axis]).sum::<f32>();
    let mut columns = [[0.0; 4]; 4];
    for (k, row) in rows.iter().enumerate() {
        for (column, v) in columns.iter_mut().zip(row) {
            column[k] = *v;
        }
        columns[3][k] = from_eye(row);
    }
    columns[3][2] = NEAREST * distance;
    columns
}

#[cfg(test)]
mod tests {
    use super::matrix;
    use honami_scene::Camera;

    /// Where the camera itself says that a place is seen.
    #[test]
    fn places_are_drawn_where_the_camera_sees_them() {
        let camera = Camera { eye: [3.0, -9.0, 4.0], target: [0.5, 1.0, 2.0], angle: 0.7 };
        let (aspect, columns) = (16.0 / 9.0, matrix(&camera, 16.0 / 9.0));
        for place in [[0.5, 1.0, 2.0], [0.0, 0.0, 0.0], [-2.0, 7.0, 5.0], [4.0, 3.0, -1.0]] {
            let ([right, up], depth) = camera.seen(place);
            let sum =
                |k: usize| columns[3][k] + (0..3).map(|axis| columns[axis][k] * place[axis]).sum::<f32>();
            let [x, y, z, w] = [0, 1, 2, 3].map(sum);
            let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{place:?}: {a} {b}");
            near(w, depth);
            near(x / w, right / aspect);
            near(y / w, up);
            let distance = camera.seen(camera.target).1;
            near(z / w, distance / 1000.0 / depth);
        }
    }
}
