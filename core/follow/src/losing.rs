//! When a point that was found counts as lost all the same.

use honami_plugin::params;

params! {
    /// Limits of quality beyond which a point is lost.
    pub struct Losing {
        /// A point whose way there and back ends farther than this from its start is lost; 0: never, the quality says it.
        lose_fb: f64 = 0.0 => {
            label: "Lose at forward-backward error", group: "Losing", unit: "px", min: 0, max: 100, soft_max: 5,
        },
        /// A point whose template correlates less with the new window is lost; 0: never.
        lose_ncc: f64 = 0.0 => { label: "Lose below correlation", group: "Losing", min: 0, max: 1 },
    }
}

impl Losing {
    /// Whether a sample of this quality is lost. What could not be measured is worse than any limit.
    #[must_use]
    pub fn loses(&self, fb: Option<f32>, ncc: Option<f32>) -> bool {
        let astray = self.lose_fb > 0.0 && fb.is_none_or(|fb| f64::from(fb) > self.lose_fb);
        let changed = self.lose_ncc > 0.0 && ncc.is_none_or(|ncc| f64::from(ncc) < self.lose_ncc);
        astray || changed
    }
}
