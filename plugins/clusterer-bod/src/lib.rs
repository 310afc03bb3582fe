//! Grouping by bi-orthogonal decomposition as a honami plugin; the algorithm is `honami_motion`.

#[cfg(test)]
mod tests;

use honami_motion::likeness::{self, Likenesses};
use honami_motion::{Criterion, MotionError, Positions, likenesses, linkage};
use honami_plugin::{
    Clusterer, Clustering, Cx, Error, Info, Merge, Result, Track, Tracks, choice, export, params,
};

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
    /// What makes two groups close.
    pub(crate) enum Linkage {
        /// The least increase of inertia: groups of similar size.
        Ward = "ward" => "Ward",
        /// The mean distance between their tracks: groups as uneven as they come.
        Average = "average" => "Average",
    }
}

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// What makes two tracks alike.
        likeness: Likeness = "loadings" => { label: "Likeness" },
        /// What is done about leaves that flutter each for itself.
        flutter: Flutter = "auto" => { label: "Flutter" },
        /// What makes two groups close.
        linkage: Linkage = "ward" => { label: "Linkage" },
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
              be, and merges tracks that move alike with what is left and are near each other. Gaps are filled from the other \
              tracks.",
        cite: &["Aubry, Guyonnet and Lima 1991", "Gavish and Donoho 2014", "Ward 1963"],
        ..Info::NEW
    };

    fn cluster(settings: &Settings, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering> {
        let mut heard = Ok(());
        let found = likenesses(&positions(tracks), &options(settings, tracks), &mut |done| {
            heard = cx.progress(0.95 * done, "components");
            heard.is_ok()
        });
        heard?;
        let found = found.map_err(error)?;
        tell(&found, settings, cx);
        cx.progress(0.95, "linkage")?;
        let criterion = match settings.linkage {
            Linkage::Ward => Criterion::Ward,
            Linkage::Average => Criterion::Average,
        };
        let tree = linkage(found.condensed, found.n_tracks, criterion).map_err(error)?;
        let merges = tree.merges().iter().map(|m| Merge { a: m.a, b: m.b, height: m.height, size: m.size });
        Ok(Clustering { merges: merges.collect(), frames: Vec::new() })
    }
}

fn options(settings: &Settings, tracks: &Tracks<'_>) -> likeness::Options {
    likeness::Options {
        likeness: match settings.likeness {
            Likeness::Loadings => likeness::Likeness::Loadings,
            Likeness::Turned => likeness::Likeness::Turned,
            Likeness::Steps => likeness::Likeness::Steps,
        },
        position_weight: settings.position,
        most: usize::try_from(settings.components).unwrap_or(1),
        flutter: match settings.flutter {
            Flutter::Auto => likeness::Flutter::Auto,
            Flutter::Keep => likeness::Flutter::Keep,
            Flutter::TakeDown => likeness::Flutter::TakeDown,
        },
        n_threads: tracks.max_threads as usize,
    }
}

fn positions(tracks: &Tracks<'_>) -> Positions {
    let samples = |track: Track<'_>| {
        let sample = |k: usize| track.seen(k).then(|| [track.x[k], track.y[k]]);
        (track.first_frame, (0..track.x.len()).map(sample).collect())
    };
    Positions::of_samples(&tracks.iter().map(samples).collect::<Vec<_>>()).1
}

/// What a user should know of the grouping.
fn tell(found: &Likenesses, settings: &Settings, cx: &Cx<'_>) {
    let Likenesses { n_above, n_used, n_filled, n_unseen, n_tracks, .. } = *found;
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
    if n_filled > 0 {
        cx.info(&format!("{n_filled} positions that were not seen are filled from the other tracks"));
    }
    if n_unseen > 0 {
        cx.warn(&format!(
            "{n_unseen} tracks are never seen together with others: they count as farthest from all"
        ));
    }
}

fn error(error: MotionError) -> Error {
    match error {
        MotionError::TooFewTracks(_) | MotionError::TooFewFrames(_) | MotionError::NeverTogether => {
            Error::data(error.to_string())
        }
        _ => error.into(),
    }
}

export! {
    library: { id: "org.honami.bod", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Components]
}
