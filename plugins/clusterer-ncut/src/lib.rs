//! Zeng's grouping by normalised cuts as a honami plugin; the algorithm is `honami_motion`.

#[cfg(test)]
mod tests;

use honami_grouping::{heard, merges, positions};
use honami_motion::ncut::{self, Ncut};
use honami_plugin::{Clusterer, Clustering, Cx, Info, Result, Tracks, choice, export, params};

choice! {
    /// Which group is opened next.
    pub(crate) enum Order {
        /// The one that falls apart most clearly.
        Cuts = "cuts" => "Clearest first",
        /// All of a level before any of the next, as in print: halves, quarters, eighths.
        Levels = "levels" => "Level by level",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Which group is opened next.
        order: Order = "cuts" => { label: "Order" },
        /// How often groups are halved at most. Within the last ones tracks are joined along their largest affinities.
        levels: i64 = 12 => { label: "Levels", min: 1, max: 16 },
        /// Weight of the distance between mean positions; 0: movement alone.
        position: f64 = 1.0 => { label: "Weight of position", min: 0, max: 100, soft_max: 4 },
        /// Others that each track is joined to at least: those most alike. With as many as there are tracks the graph is
        /// whole, as in print.
        neighbours: i64 = 50 => { label: "Neighbours", min: 1, max: 100000, soft_max: 500 },
        /// Takes off the tracks what noise alone could be, before they are compared: they are made anew from the components
        /// of their bi-orthogonal decomposition that stand out of it. Not in the thesis, and worth it unless tracks are very
        /// good.
        denoise: bool = false => { label: "Denoise tracks" },
    }
}

/// Groups tracks by normalised cuts.
struct Cuts;

impl Clusterer for Cuts {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.ncut",
        name: "Normalised cuts",
        doc: "Joins tracks by the correlation of their steps and by how near they are, `|rho| exp(-(d / s)^2 / 2)`, and halves \
              that graph again and again where it costs least. Noise of a third of the displacement per frame drowns the \
              correlation: denoise then.",
        cite: &["Zeng 2015, 5.4.1", "Shi and Malik 2000", "Liu et al. 2005"],
        ..Info::NEW
    };

    fn cluster(settings: &Settings, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering> {
        let positions = positions(tracks).1;
        let options = ncut::Options {
            position_weight: settings.position,
            n_levels: u32::try_from(settings.levels).unwrap_or(1),
            order: match settings.order {
                Order::Levels => ncut::Order::Levels,
                Order::Cuts => ncut::Order::Cuts,
            },
            n_neighbours: usize::try_from(settings.neighbours).unwrap_or(1),
            denoises: settings.denoise,
            seed: tracks.seed,
            n_threads: tracks.max_threads as usize,
        };
        let found = heard(cx, 1.0, "cuts", |keep_going| ncut::ncut(&positions, &options, keep_going))?;
        tell(&found, cx);
        Ok(Clustering { merges: merges(&found.tree), frames: Vec::new() })
    }
}

/// What a user should know of the grouping.
fn tell(found: &Ncut, cx: &Cx<'_>) {
    let Ncut { n_groups, n_components, residual, n_filled, n_unseen, .. } = *found;
    cx.info(&format!("{n_groups} groups were divided no further"));
    if let Some(n) = n_components {
        cx.info(&format!("denoised tracks are made of {n} components"));
    }
    if residual > ncut::RESIDUAL {
        cx.warn(&format!("a cut may not be the best there is: its eigenvector is off by {residual:.0e}"));
    }
    if n_filled > 0 {
        cx.info(&format!("{n_filled} positions that were not seen are filled from the other tracks"));
    }
    if n_unseen > 0 {
        cx.warn(&format!("{n_unseen} tracks are never seen together with others: they stay apart from all"));
    }
}

export! {
    library: { id: "org.honami.ncut", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Cuts]
}
