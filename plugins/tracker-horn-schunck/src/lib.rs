//! Horn and Schunck's optical flow as a honami plugin; the algorithm is `honami_vision::horn_schunck`.

#[cfg(test)]
mod tests;

use honami_follow::{Detection, Follower, Losing, Motion, Trust};
use honami_plugin::{Info, export, params};
use honami_vision::Gray;
use honami_vision::field::Field;
use honami_vision::horn_schunck::{self, Params};
use honami_vision::plane::Scales;

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Weight of the smoothness: motion that differs by 1 px from a pixel to the next costs as much as a brightness
        /// that is off by so many gray levels.
        alpha: f64 = 10.0 => {
            label: "Smoothness", group: "Tracking", unit: "gray levels", min: 0.01, max: 1000, soft_max: 50, scale: "log",
        },
        /// Levels of the pyramid; each doubles the displacement that can be measured.
        levels: i64 = 6 => { label: "Levels", group: "Tracking", min: 1, max: 10 },
        /// How often the new frame is warped by the motion so far, on each level.
        warps: i64 = 3 => { label: "Warps", group: "Tracking", min: 1, max: 100, soft_max: 10 },
        /// A brightness that is off by more counts ever less than its square, so that what hides or appears pulls
        /// less; 0: Horn and Schunck's own square.
        robust: f64 = 5.0 => {
            label: "Robust from", group: "Tracking", unit: "gray levels", min: 0, max: 255, soft_max: 20,
        },
        /// Whether motion goes through a 3x3 median after each warp, which keeps edges of motion sharp.
        median: bool = true => { label: "Median", group: "Tracking" },
        /// From a node of the field to the next.
        step: i64 = 2 => { label: "Grid step", group: "Tracking", unit: "px", min: 1, max: 100, soft_max: 16 },
        /// Standard deviation of the Gaussian that frames are smoothed by first; 0: not at all.
        smoothing: f64 = 0.8 => {
            label: "Smoothing", group: "Tracking", unit: "px", min: 0, max: 10, soft_max: 3, advanced: true,
        },
        /// Sweeps over all pixels after each warp, at most.
        sweeps: i64 = 40 => {
            label: "Sweeps", group: "Tracking", min: 1, max: 100000, soft_max: 200, advanced: true,
        },
        /// Sweeps end when pixels are off what their neighbours and their brightness ask for by less.
        tolerance: f64 = 1e-3 => {
            label: "Tolerance", group: "Tracking", unit: "px", min: 0, max: 1, advanced: true,
        },
        /// Whether motion is measured back, too: the forward-backward error of samples, at twice the time.
        backward: bool = true => { label: "There and back", group: "Tracking" },
        ..losing: Losing,
        ..detection: Detection,
    }
}

/// Radius of the windows whose correlation is a sample's quality, pixels: the default of other trackers.
const QUALITY_RADIUS_PX: u32 = 10;

impl Motion for Settings {
    const INFO: Info = Info {
        id: "org.honami.horn-schunck",
        name: "Horn-Schunck",
        doc: "Measures the motion of every pixel as that which keeps brightness and is smooth: it makes \
              `∬ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²)` least, from the coarsest level of a pyramid to the finest; \
              points follow that motion. It is known everywhere, also where there is no texture: there it is what \
              lies around.",
        cite: &["Horn, Schunck 1981", "Diener 2009, 2.4.3 and 2.4.4"],
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
            alpha_gray: self.alpha as f32,
            levels: self.levels as u32,
            warps: self.warps as u32,
            max_sweeps: self.sweeps as u32,
            tolerance_px: self.tolerance as f32,
            robust_gray: self.robust as f32,
            median: self.median,
            step_px: self.step as u32,
        };
        horn_schunck::measure(from, to, &params, n_threads, go_on)
    }

    fn is_backward(&self) -> bool {
        self.backward
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: QUALITY_RADIUS_PX, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

/// Points that follow the smoothest motion.
type HornSchunck = Follower<Settings>;

export! {
    library: { id: "org.honami.horn-schunck", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker HornSchunck],
}
