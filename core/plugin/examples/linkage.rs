//! A clusterer: average linkage of how much the distance between two tracks changes.

use honami_plugin::{Clusterer, Clustering, Cx, Info, Merge, Result, Track, Tracks, export, params};

params! {
    /// What the user may choose.
    pub struct Choice {
        /// How far apart tracks count that were never seen together.
        unknown: f64 = 50.0 => { label: "Never together", unit: "px", min: 0, max: 1000 },
    }
}

struct Linkage;

impl Clusterer for Linkage {
    type Params = Choice;
    const INFO: Info = Info {
        id: "org.honami.linkage",
        name: "Average linkage",
        doc: "Groups tracks by how much the distance between them changes.",
        ..Info::NEW
    };

    fn cluster(params: &Choice, tracks: &Tracks<'_>, cx: &Cx<'_>) -> Result<Clustering> {
        let all: Vec<Track<'_>> = tracks.iter().collect();
        // Clusters that are left: number, leaves.
        let mut left: Vec<(u32, Vec<usize>)> = (0..all.len()).map(|k| (k as u32, vec![k])).collect();
        let mut apart = vec![vec![0.0; all.len()]; all.len()];
        for a in 0..all.len() {
            cx.progress(0.5 * a as f64 / all.len() as f64, "comparing tracks")?;
            for b in 0..a {
                apart[a][b] = sway(&all[a], &all[b]).unwrap_or(params.unknown);
                apart[b][a] = apart[a][b];
            }
        }
        let mut merges = Vec::new();
        while left.len() > 1 {
            cx.progress(1.0 - 0.5 * left.len() as f64 / all.len() as f64, "merging")?;
            let n_left = left.len();
            let pairs = (0..n_left).flat_map(|i| (i + 1..n_left).map(move |j| (i, j)));
            let closest = pairs.min_by(|&(i, j), &(k, l)| apart[i][j].total_cmp(&apart[k][l]));
            let Some((i, j)) = closest else { break };
            let height = apart[i][j];
            let (b, leaves) = left.remove(j);
            let (n, m) = (left[i].1.len() as f64, leaves.len() as f64);
            let gone = apart.remove(j);
            for (k, row) in apart.iter_mut().enumerate() {
                row.remove(j);
                let other = if k < j { gone[k] } else { gone[k + 1] };
                row[i] = (n * row[i] + m * other) / (n + m);
            }
            apart[i] = apart.iter().map(|row| row[i]).collect();
            left[i].1.extend(leaves);
            let size = left[i].1.len() as u32;
            merges.push(Merge { a: left[i].0, b, height, size });
            left[i].0 = (all.len() + merges.len() - 1) as u32;
        }
        Ok(Clustering { merges, frames: Vec::new() })
    }
}

/// Standard deviation of what lies between two tracks, over the frames in which both are seen; `None` without any.
fn sway(a: &Track<'_>, b: &Track<'_>) -> Option<f64> {
    let both = a.first_frame.max(b.first_frame)
        ..(a.first_frame + a.x.len() as i64).min(b.first_frame + b.x.len() as i64);
    let (mut n, mut sum, mut squares) = (0.0, [0.0; 2], 0.0);
    for frame in both {
        let (k, l) = ((frame - a.first_frame) as usize, (frame - b.first_frame) as usize);
        if a.seen(k) && b.seen(l) {
            let d = [f64::from(a.x[k]) - f64::from(b.x[l]), f64::from(a.y[k]) - f64::from(b.y[l])];
            (n, sum, squares) =
                (n + 1.0, [sum[0] + d[0], sum[1] + d[1]], squares + d[0] * d[0] + d[1] * d[1]);
        }
    }
    (n > 0.0).then(|| (squares / n - (sum[0] * sum[0] + sum[1] * sum[1]) / (n * n)).max(0.0).sqrt())
}

export! {
    library: { id: "org.honami.linkage", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [clusterer Linkage],
}
