//! Dense Lucas-Kanade as a honami plugin; the algorithm is `honami_vision::lucas_kanade`.

#[cfg(test)]
mod tests;

use honami_follow::{Detection, Follower, Losing, Motion, Trust};
use honami_plugin::{Info, export, params};
use honami_vision::Gray;
use honami_vision::field::Field;
use honami_vision::lucas_kanade::{self, Params};
use honami_vision::plane::Scales;

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Radius of the window, whose weights are Gaussian with half of it as standard deviation.
        radius: i64 = 7 => {
            label: "Window radius", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 31,
        },
        /// Levels of the pyramid; each doubles the displacement that can be measured.
        levels: i64 = 5 => { label: "Levels", group: "Tracking", min: 1, max: 10, soft_max: 6 },
        /// Steps on each level, each with the new frame warped by the motion so far.
        iterations: i64 = 4 => { label: "Iterations", group: "Tracking", min: 1, max: 100, soft_max: 10 },
        /// From a node of the field to the next.
        step: i64 = 2 => { label: "Grid step", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 16 },
        /// Standard deviation of the Gaussian that frames are smoothed by first; 0: not at all.
        smoothing: f64 = 0.8 => {
            label: "Smoothing", group: "Tracking", unit: "px", min: 0, max: 10, soft_max: 3, advanced: true,
        },
        /// The motion of a window whose gradient matrix has a smaller eigenvalue is not known (OpenCV's measure).
        min_eigenvalue: f64 = 1e-4 => {
            label: "Minimum eigenvalue", group: "Tracking", min: 0, max: 1, advanced: true,
        },
        /// Whether motion is measured back, too: the forward-backward error of samples, at twice the time.
        backward: bool = true => { label: "There and back", group: "Tracking" },
        ..losing: Losing,
        ..detection: Detection,
    }
}

impl Motion for Settings {
    const INFO: Info = Info {
        id: "org.honami.lucas-kanade",
        name: "Lucas-Kanade, dense",
        doc: "Measures the motion of every pixel by least squares over the window around it: \
              `(Σ k g gᵀ) w = Σ k (g gᵀ w(q) - g δ)` (equation 2.9), \
              from the coarsest level of a pyramid to the finest; points follow that motion. Brightness must stay; \
              where a window shows no texture, or one edge only, motion is not known and a point is lost.",
        cite: &["Lucas, Kanade 1981", "Diener 2009, 2.4.3 and 2.4.4"],
        ..Info::NEW
    };
    type Kept = Scales;

    fn keep(&self, picture: &Gray<'_>, n_threads: usize) -> Scales {
        Scales::new(picture, self.levels as u32, self.smoothing as f32, n_threads)
    }

    fn kept(kept: &Scales) -> Gray<'_> {
        kept.picture()
    }

    fn measure(
        &self,
        from: &Scales,
        to: &Scales,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<Field> {
        let params = Params {
            radius_px: self.radius as u32,
            levels: self.levels as u32,
            iterations: self.iterations as u32,
            step_px: self.step as u32,
            min_eigenvalue: self.min_eigenvalue as f32,
        };
        lucas_kanade::measure(from, to, &params, n_threads, go_on)
    }

    fn is_backward(&self) -> bool {
        self.backward
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: self.radius as u32, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

/// Points that follow the motion of their windows.
type LucasKanade = Follower<Settings>;

export! {
    library: { id: "org.honami.lucas-kanade", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker LucasKanade],
}
