//! The distance of movement (thesis 4.3.1) as a honami plugin; the algorithm is `honami_motion`.

#[cfg(test)]
mod tests;

use honami_motion::{Composite, Criterion, MotionError, Positions, composite, denoised, linkage};
use honami_plugin::{
    Clusterer, Clustering, Cx, Error, FrameNote, Info, Merge, Result, Track, Tracks, choice, export, params,
};

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
        /// What makes two groups close.
        linkage: Linkage = "ward" => { label: "Linkage" },
        /// Leaves out frames whose mean distance is unusual: hardly any motion, or all of it one gust.
        outliers: bool = true => { label: "Leave out outlier frames", group: "Frames" },
        /// How many standard deviations from the mean make a frame unusual.
        outlier_sd: f64 = 2.0 => { label: "Outlier factor", group: "Frames", unit: "sd", min: 0.1, max: 10, when: outliers == true },
        /// Weight of the distance between positions.
        position: f64 = 1.0 => { label: "Weight of position", group: "Distance", min: 0, max: 100, soft_max: 4 },
        /// Weight of the angle between velocities.
        movement: f64 = 1.0 => { label: "Weight of movement", group: "Distance", min: 0, max: 100, soft_max: 4 },
        /// Takes off the tracks what noise alone could be, before they are compared: they are made anew from the components
        /// of their bi-orthogonal decomposition that stand out of it. Not in the thesis, and worth it unless tracks are very
        /// good.
        denoise: bool = false => { label: "Denoise tracks" },
    }
}

/// Groups tracks that are near each other and go the same way.
struct Movement;

impl Clusterer for Movement {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.movement",
        name: "Distance of movement",
        doc: "Merges tracks by `|p1 - p2| / s_pos + angle(v1, v2) / s_mov`, averaged over the frames that are not \
              outliers. Needs tracks that share frames; noise of a third of the displacement per frame drowns the angles.",
        cite: &["Diener 2009, 4.3.1-4.3.2", "Ward 1963"],
        ..Info::NEW
    };

    fn cluster(settings: &Settings, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering> {
        let (first_frame, positions) = positions(tracks);
        let positions = if settings.denoise { smooth(&positions, tracks, cx)? } else { positions };
        let options = composite::Options {
            position_weight: settings.position,
            movement_weight: settings.movement,
            outlier_sd: settings.outliers.then_some(settings.outlier_sd),
            n_threads: tracks.max_threads as usize,
        };
        let criterion = match settings.linkage {
            Linkage::Ward => Criterion::Ward,
            Linkage::Average => Criterion::Average,
        };
        let mut heard = Ok(());
        let distances = composite(&positions, &options, &mut |done| {
            heard = cx.progress(0.95 * done, "distances");
            heard.is_ok()
        });
        heard?;
        let distances = distances.map_err(error)?;
        if distances.n_apart > 0 {
            let n = distances.n_apart;
            cx.warn(&format!("{n} pairs of tracks are never seen together: they count as farthest apart"));
        }
        let frames = notes(&distances, first_frame);
        cx.progress(0.95, "linkage")?;
        let tree = linkage(distances.condensed, distances.n_tracks, criterion).map_err(error)?;
        let merges = tree.merges().iter().map(|m| Merge { a: m.a, b: m.b, height: m.height, size: m.size });
        Ok(Clustering { merges: merges.collect(), frames })
    }
}

/// The seen samples, and the frame of the first.
fn positions(tracks: &Tracks<'_>) -> (i64, Positions) {
    let samples = |track: Track<'_>| {
        let sample = |k: usize| track.seen(k).then(|| [track.x[k], track.y[k]]);
        (track.first_frame, (0..track.x.len()).map(sample).collect())
    };
    Positions::of_samples(&tracks.iter().map(samples).collect::<Vec<_>>())
}

/// The same without noise.
fn smooth(positions: &Positions, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Positions> {
    let mut heard = Ok(());
    let smooth = denoised(positions, tracks.max_threads as usize, &mut |_| {
        heard = cx.progress(0.0, "noise");
        heard.is_ok()
    });
    heard?;
    let (positions, n) = smooth.map_err(error)?;
    cx.info(&format!("denoised tracks are made of {n} components"));
    Ok(positions)
}

fn notes(distances: &Composite, first_frame: i64) -> Vec<FrameNote> {
    let mut outliers = distances.outlier_frames.iter().map(|&frame| i64::from(frame)).peekable();
    let note = |(frame, mean): (i64, &Option<f64>)| {
        let outlier = outliers.next_if_eq(&frame).is_some();
        mean.map(|distance| FrameNote { frame: first_frame + frame, outlier, distance })
    };
    (0..).zip(&distances.frame_means).filter_map(note).collect()
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
    library: { id: "org.honami.movement", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Movement]
}
