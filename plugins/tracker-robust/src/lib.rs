//! Robust tracking of regions as a honami plugin; the algorithm is `honami_vision::robust`.

mod settings;
#[cfg(test)]
mod tests;

use honami_follow::{Detection, Follower, Method, Step, Trust, pyramid};
use honami_plugin::{Cx, Error, Info, Result, export};
use honami_vision::field::Drift;
use honami_vision::pyramid::Pyramid;
use honami_vision::robust::{self, Moved, State};
use honami_vision::{Gray, Point};
use settings::Settings;

impl Method for Settings {
    const INFO: Info = Info {
        id: "org.honami.robust",
        name: "Robust regions",
        doc: "Follows a grid of nodes by KLT, and moves each point to where most of the displacements of its region \
              agree: mean shift `x ← Σ k x_i / Σ k`, `k = exp(-½ (x_i - x)ᵀ Σ⁻¹ (x_i - x))`, with the weighted \
              covariance `Σ` narrowed at each step, but not below the noise of a node. Leaves that pass through the region \
              are outliers and do not count. A region that is smaller than what moves over it follows that instead.",
        cite: &["Diener 2009, 2.5.2", "Fukunaga, Hostetler 1975", "Parzen 1962", "Bouguet 2000"],
        ..Info::NEW
    };
    type Kept = Pyramid;

    fn keep(&self, picture: &Gray<'_>, spare: Option<Pyramid>, _: usize) -> Pyramid {
        pyramid(picture, spare, &self.region().klt)
    }

    fn kept(kept: &Pyramid) -> Gray<'_> {
        kept.picture()
    }

    fn follow(
        &self,
        [before, now]: [&Pyramid; 2],
        from: &[Point],
        n_threads: usize,
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>> {
        let region = self.region();
        let pass = |pictures, from: &[Point], what| {
            let mut go_on = |share: f64| cx.progress(share, what).is_ok();
            robust::follow(pictures, from, &region, n_threads, &mut go_on).ok_or_else(Error::cancelled)
        };
        let there = pass([before, now], from, "following regions")?;
        let back = if self.is_backward() {
            let ends: Vec<_> = there.iter().map(|moved| moved.to).collect();
            pass([now, before], &ends, "following regions back")?
        } else {
            Vec::new()
        };
        let step = |(k, moved): (usize, &Moved)| {
            let home = back.get(k).filter(|home| home.state == State::Tracked);
            Step { to: self.judge(moved), home: home.map(|home| home.to) }
        };
        Ok(there.iter().enumerate().map(step).collect())
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: self.region as u32, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

impl Settings {
    /// Where the region of a point went, if enough of it agrees.
    fn judge(&self, moved: &Moved) -> Drift {
        match moved.state {
            State::Tracked if moved.share >= self.lose_share => Drift::To(moved.to),
            State::Outside => Drift::Outside,
            State::Tracked | State::Lost(_) => Drift::Unknown,
        }
    }
}

/// Moves each point as most of the nodes around it move.
type Robust = Follower<Settings>;

export! {
    library: { id: "org.honami.robust", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Robust],
}
