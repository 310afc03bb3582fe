//! Grouping by bi-orthogonal decomposition as a honami plugin; the algorithm is `honami_motion`.

#[cfg(test)]
mod tests;

use honami_grouping::{heard, merges, positions};
use honami_motion::likeness::{self, Grouped, Making, grouped};
use honami_motion::{Criterion, ncut};
use honami_plugin::{Clusterer, Clustering, Cx, Info, Result, Tracks, choice, export, params};

choice! {
    /// What makes two tracks alike.
    pub(crate) enum Likeness {
        /// They go as far with each component, and the same way.
        Loadings = "loadings" => "Loadings",
        /// The same, whichever way each of them goes.
        Turned = "turned" => "Loadings, turned",
        /// Their steps from frame to frame are correlated (Zeng's similarity), without noise.
        Steps = "steps" => "Correlation of steps",
    }
}

choice! {
    /// What is done about leaves that flutter.
    pub(crate) enum Flutter {
        /// Taken down where tracks look like it, else kept.
        Auto = "auto" => "Where there is some",
        /// Tracks are taken as they are.
        Keep = "keep" => "Keep",
        /// Frequencies at which leaves flutter each for itself count less.
        TakeDown = "down" => "Take down",
    }
}

choice! {
    /// How the hierarchy is made.
    pub(crate) enum Hierarchy {
        /// From above: the whole is cut in two where that costs least, and again what falls apart most clearly for its size.
        Cuts = "cuts" => "Normalised cuts",
        /// From below: what increases inertia least is merged.
        Ward = "ward" => "Ward",
        /// From below: what has the least mean distance is merged.
        Average = "average" => "Average",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// What makes two tracks alike.
        likeness: Likeness = "steps" => { label: "Likeness" },
        /// Nearest others that each track is averaged with before it is compared, no more than one in 12 of the tracks that
        /// move; 0: none.
        smooth: i64 = 8 => { label: "Smoothing neighbours", min: 0, max: 1000, soft_max: 20 },
        /// What is done about leaves that flutter each for itself.
        flutter: Flutter = "auto" => { label: "Flutter" },
        /// How the hierarchy is made.
        hierarchy: Hierarchy = "cuts" => { label: "Hierarchy" },
        /// Weight of the distance between mean positions.
        position: f64 = 0.6 => { label: "Weight of position", min: 0, max: 100, soft_max: 4 },
        /// The most components that are used; fewer where noise hides the rest.
        components: i64 = 30 => { label: "Most components", min: 1, max: 1000, soft_max: 60 },
    }
}

/// Groups tracks that move with the same components.
struct Components;

impl Clusterer for Components {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.bod",
        name: "Components of motion",
        doc: "Takes tracks apart into what moves together (bi-orthogonal decomposition), leaves out what noise alone could \
              be, averages each track with its neighbours, and divides what moves least alike and is far apart. Gaps are filled \
              from the other tracks.",
        cite: &[
            "Aubry, Guyonnet and Lima 1991",
            "Gavish and Donoho 2014",
            "Zeng 2015, 5.1",
            "Shi and Malik 2000",
            "Ward 1963",
        ],
        ..Info::NEW
    };

    fn cluster(settings: &Settings, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering> {
        let positions = positions(tracks).1;
        let found = heard(cx, 1.0, "components", |keep_going| {
            grouped(&positions, &options(settings, tracks), keep_going)
        })?;
        tell(&found, positions.n_tracks(), settings, cx);
        Ok(Clustering { merges: merges(&found.tree), frames: Vec::new() })
    }
}

fn options(settings: &Settings, tracks: &Tracks<'_>) -> likeness::Options {
    likeness::Options {
        likeness: match settings.likeness {
            Likeness::Loadings => likeness::Likeness::Loadings,
            Likeness::Turned => likeness::Likeness::Turned,
            Likeness::Steps => likeness::Likeness::Steps,
        },
        n_neighbours: usize::try_from(settings.smooth).unwrap_or(0),
        making: match settings.hierarchy {
            Hierarchy::Cuts => Making::Cuts,
            Hierarchy::Ward => Making::Merges(Criterion::Ward),
            Hierarchy::Average => Making::Merges(Criterion::Average),
        },
        position_weight: settings.position,
        most: usize::try_from(settings.components).unwrap_or(1),
        flutter: match settings.flutter {
            Flutter::Auto => likeness::Flutter::Auto,
            Flutter::Keep => likeness::Flutter::Keep,
            Flutter::TakeDown => likeness::Flutter::TakeDown,
        },
        seed: tracks.seed,
        n_threads: tracks.max_threads as usize,
    }
}

/// What a user should know of the grouping.
fn tell(found: &Grouped, n_tracks: usize, settings: &Settings, cx: &Cx<'_>) {
    let Grouped { n_above, n_used, n_filled, n_unseen, residual, .. } = *found;
    cx.info(&format!("{n_above} components stand out of the noise, {n_used} are used"));
    if n_used == 0 {
        cx.warn(&format!(
            "nothing stands out of the noise: {n_tracks} tracks are grouped by their places alone"
        ));
    }
    match (found.is_whitened, settings.flutter) {
        (true, Flutter::Auto) => cx
            .warn("leaves flutter each for itself: their frequencies count less (flutter=keep: as they are)"),
        (false, Flutter::TakeDown) => {
            cx.warn("too few tracks or frames to tell flutter from motion: nothing was taken down")
        }
        (false, Flutter::Keep) if found.flutters => {
            cx.warn("leaves flutter each for itself: flutter=down makes their frequencies count less");
        }
        _ => {}
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
    library: { id: "org.honami.bod", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Components]
}
