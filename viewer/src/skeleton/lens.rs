//! From places to pictures of skeletons: from the front without perspective, so that every place is exactly where it was
//! filmed; from elsewhere with it, so that depth is seen. Between the two the picture changes smoothly.

use honami_scene::Camera;
use honami_scene::vector::dot;

/// From so far beside the front on perspective is whole, radians.
const WHOLE: f32 = 0.4;
/// The nearest and the farthest that is seen, of the distance to what is looked at.
const NEAREST: f32 = 0.02;
const FARTHEST: f32 = 20.0;

/// How places are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lens {
    /// Columns of the matrix to what pipelines clip and divide.
    pub(super) matrix: [[f32; 4]; 4],
    /// The camera's right, up and forward.
    pub(super) axes: [[f32; 3]; 3],
    /// How much perspective there is: 0 from the front, 1 from elsewhere.
    pub(super) depth: f32,
    /// From the middle of the picture to its upper edge at what is looked at.
    pub(super) half: f32,
}

impl Lens {
    /// Of a picture that is so many times as wide as high. All of a clip that is so many times as wide as high fits into it
    /// where the camera has it as high as the picture.
    pub(super) fn new(camera: &Camera, aspect: f32, clip_aspect: f32) -> Self {
        let axes = camera.axes();
        let [right, up, forward] = axes;
        let away = dot(camera.target, forward) - dot(camera.eye, forward);
        let depth = depth(forward);
        let [_, half] = edges(camera, aspect, clip_aspect);
        let eye = camera.eye;
        let row = |axis: [f32; 3], by: f32| [axis[0] * by, axis[1] * by, axis[2] * by, -dot(axis, eye) * by];
        let (near, far) = (NEAREST * away, FARTHEST * away);
        let width = |far: f32| away * (1.0 - depth) + depth * far;
        // From 1 at the nearest to 0 at the farthest.
        let steep = width(near) / (far - near);
        let mut w = row(forward, depth);
        w[3] += away * (1.0 - depth);
        let mut z = row(forward, -steep);
        z[3] += steep * far;
        let rows = [row(right, 1.0 / (half * aspect)), row(up, 1.0 / half), z, w];
        let matrix = std::array::from_fn(|column| rows.map(|row| row[column]));
        Self { matrix, axes, depth, half: half * away }
    }

    /// Pixels of a picture so high that a length has which is seen across, at what is looked at.
    pub(super) fn pixels(&self, length: f32, height: u32) -> f32 {
        length * height as f32 / (2.0 * self.half)
    }

    /// Where a place is seen, from -1 to 1 to the right and up; `None` behind the eye.
    pub(super) fn seen(&self, place: [f32; 3]) -> Option<[f32; 2]> {
        let sum = |row: usize| {
            self.matrix[3][row] + (0..3).map(|axis| self.matrix[axis][row] * place[axis]).sum::<f32>()
        };
        (sum(3) > 0.0).then(|| [sum(0) / sum(3), sum(1) / sum(3)])
    }
}

/// How much perspective there is where a camera looks this way: 0 from the front, 1 from elsewhere.
pub(super) fn depth(forward: [f32; 3]) -> f32 {
    // The front looks along y; where that is so to rounding, it is so.
    let aside = (forward[0].hypot(forward[2])).atan2(forward[1]);
    let share = ((aside - 1e-4) / WHOLE).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// From the middle of a picture to its right and its upper edge at what is looked at, of the distance to that.
pub(super) fn edges(camera: &Camera, aspect: f32, clip_aspect: f32) -> [f32; 2] {
    let half = (camera.angle / 2.0).tan() * (clip_aspect / aspect).max(1.0);
    [half * aspect, half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use honami_scene::Orbit;

    fn orbit() -> Orbit {
        Orbit {
            target: [159.5, 0.0, -89.5],
            distance: 90.0 / 0.25_f32.tan(),
            azimuth: 0.0,
            elevation: 0.0,
            angle: 0.5,
        }
    }

    /// A clip of 320x180 in a picture of its shape: pixel centres are pixel centres, however deep.
    #[test]
    fn from_the_front_everything_is_where_it_was_filmed() {
        let aspect = 320.0 / 180.0;
        let lens = Lens::new(&orbit().camera(), aspect, aspect);
        for (x, y) in [(0.0, 0.0), (319.0, 179.0), (160.0, 20.0)] {
            for depth in [-150.0, 0.0, 90.0] {
                let [right, up] = lens.seen([x, depth, -y]).unwrap();
                let (wanted_x, wanted_y) = ((x + 0.5) / 160.0 - 1.0, 1.0 - (y + 0.5) / 90.0);
                assert!((right - wanted_x).abs() < 1e-5 && (up - wanted_y).abs() < 1e-5, "{x},{y} {depth}");
            }
        }
        assert!((lens.pixels(10.0, 360) - 20.0).abs() < 1e-3);
        // In a picture that is higher than the clip all of its width is seen.
        let high = Lens::new(&orbit().camera(), 1.0, aspect);
        assert!((high.seen([319.5, 0.0, 0.0]).unwrap()[0] - 1.0).abs() < 1e-5);
    }

    #[test]
    fn from_elsewhere_what_is_near_is_large_and_before_what_is_far() {
        let camera = Orbit { azimuth: 0.9, elevation: 0.3, ..orbit() }.camera();
        let lens = Lens::new(&camera, 1.0, 1.0);
        assert!((lens.depth - 1.0).abs() < 1e-6);
        for place in [[100.0, 50.0, -20.0], [159.5, 0.0, -89.5], [300.0, -80.0, -150.0]] {
            let ([right, up], _) = camera.seen(place);
            let seen = lens.seen(place).unwrap();
            assert!((seen[0] - right).abs() < 1e-4 && (seen[1] - up).abs() < 1e-4, "{seen:?} {right} {up}");
        }
        for azimuth in [0.0_f32, 0.1, 0.9, 3.0] {
            let camera = Orbit { azimuth, ..orbit() }.camera();
            let lens = Lens::new(&camera, 1.0, 1.0);
            let nearness = |along: f32| {
                let at: [f32; 3] = std::array::from_fn(|k| camera.target[k] + along * lens.axes[2][k]);
                let sum = |row: usize| {
                    lens.matrix[3][row] + (0..3).map(|axis| lens.matrix[axis][row] * at[axis]).sum::<f32>()
                };
                sum(2) / sum(3)
            };
            let all: Vec<f32> = (-3..4).map(|k| nearness(60.0 * k as f32)).collect();
            assert!(all.is_sorted_by(|a, b| a > b) && all.iter().all(|v| (0.0..1.0).contains(v)), "{all:?}");
        }
    }
}
