//! The distance of movement (thesis 4.3.1) as a honami plugin; the algorithm is `honami_motion`.

#[cfg(test)]
mod tests;

use honami_grouping::{BEFORE_LINKAGE, Linkage, heard, linked, positions};
use honami_motion::{Composite, Positions, composite, denoised};
use honami_plugin::{Clusterer, Clustering, Cx, FrameNote, Info, Result, Tracks, export, params};

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
        let distances =
            heard(cx, BEFORE_LINKAGE, "distances", |keep_going| composite(&positions, &options, keep_going))?;
        if distances.n_apart > 0 {
            let n = distances.n_apart;
            cx.warn(&format!("{n} pairs of tracks are never seen together: they count as farthest apart"));
        }
        let frames = notes(&distances, first_frame);
        let merges = linked(distances.condensed, distances.n_tracks, settings.linkage, cx)?;
        Ok(Clustering { merges, frames })
    }
}

/// The same without noise.
fn smooth(positions: &Positions, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Positions> {
    let n_threads = tracks.max_threads as usize;
    let (positions, n) = heard(cx, 0.0, "noise", |keep_going| denoised(positions, n_threads, keep_going))?;
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

export! {
    library: { id: "org.honami.movement", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Movement]
}
