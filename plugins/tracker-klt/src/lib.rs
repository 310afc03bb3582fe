//! The pyramidal KLT tracker as a honami plugin; the algorithm is `honami_vision::klt`.

mod settings;
#[cfg(test)]
mod tests;

use honami_follow::{Detection, Follower, Method, Step, Trust, klt_field, pyramid, there_and_back};
use honami_plugin::{Cx, FieldFn, Info, Result, export};
use honami_vision::klt::{self, affine};
use honami_vision::pyramid::Pyramid;
use honami_vision::{Gray, Point};
use settings::{Model, Settings};

impl Method for Settings {
    const INFO: Info = Info {
        id: "org.honami.klt",
        name: "Pyramidal KLT",
        doc: "Moves a window until its brightness agrees with that of the frame before: \
              `(Σ g gᵀ) dv = -Σ δ g`, from the coarsest level of a pyramid to the finest, \
              then tracks back for the forward-backward error. Dense motion is the same search from the nodes of a grid, \
              one radius apart, and 0 where a node does not come back to within a pixel. Brightness must stay; displacements may reach \
              about `2^(levels-1)` radii.",
        cite: &["Lucas, Kanade 1981", "Bouguet 2000", "Shi, Tomasi 1994", "Kalal, Mikolajczyk, Matas 2010"],
        ..Info::NEW
    };
    const FIELD: Option<FieldFn<Self>> =
        Some(|settings, from, to, max_threads, cx| klt_field(&settings.klt(), from, to, max_threads, cx));
    type Kept = Pyramid;

    fn keep(&self, picture: &Gray<'_>, spare: Option<Pyramid>, _: usize) -> Pyramid {
        pyramid(picture, spare, &self.klt())
    }

    fn kept(kept: &Pyramid) -> Gray<'_> {
        kept.picture()
    }

    fn follow(
        &self,
        pyramids: [&Pyramid; 2],
        from: &[Point],
        n_threads: usize,
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>> {
        let params = self.klt();
        let is_affine = self.model == Model::Affine;
        let cost_ns = params.cost_ns() + if is_affine { affine::cost_ns(&params) } else { 0.0 };
        there_and_back(pyramids, from, cost_ns, cx, |prev, next, from| {
            let mut flows = klt::track(prev, next, from, None, &params, n_threads);
            if is_affine {
                affine::refine(prev, next, from, &mut flows, &params, n_threads);
            }
            flows
        })
    }

    fn trust(&self) -> Trust<'_> {
        Trust { radius_px: self.radius as u32, losing: &self.losing }
    }

    fn detection(&self) -> &Detection {
        &self.detection
    }
}

impl Settings {
    fn klt(&self) -> klt::Params {
        self.search.klt(self.radius)
    }
}

/// Follows each point from frame to frame, then back again to see whether it returns.
type Klt = Follower<Settings>;

export! {
    library: { id: "org.honami.klt", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Klt],
}
