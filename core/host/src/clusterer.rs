//! A clusterer at work, and the check of what it returns.

use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Handle, Request};
use crate::reply::{self, Reply};
use crate::types::{Clustering, FrameNote, Tracks};

use honami_model::hierarchy::{Dendrogram, Merge};

/// A clusterer at work. Made by [`Host`](crate::Host).
#[derive(Debug)]
pub struct Clusterer {
    pub(crate) handle: Handle,
}

impl Clusterer {
    /// Groups tracks; leaf k is track k.
    ///
    /// # Errors
    /// [`HostError`], when the plugin cannot do it, is stopped, or returns no well-formed hierarchy.
    pub fn run(&mut self, tracks: &Tracks, cx: &CallContext<'_>) -> Result<Clustering, HostError> {
        if let Some(fault) = tracks.fault() {
            return Err(self.handle.usage(fault));
        }
        let mut reply = Reply::default();
        self.handle.ask(&Request::Cluster(tracks), cx, &mut reply)?;
        let clustering = read_dendrogram(&reply, tracks.len())
            .and_then(|dendrogram| Ok(Clustering { dendrogram, frames: read_frames(&reply, tracks)? }));
        clustering.map_err(|what| self.handle.misbehaved("run", what))
    }
}

fn read_dendrogram(reply: &Reply, n: usize) -> Result<Dendrogram, String> {
    let table = reply.table(&reply::DENDROGRAM).ok_or("returned without committing honami.dendrogram/1")?;
    let (a, b) = (table.required("a"), table.required("b"));
    let (heights, sizes) = (table.required("height"), table.required("size"));
    let merge = |k: usize| Merge { a: a[k], b: b[k], height: heights[k], size: sizes[k] };
    let n_leaves = u32::try_from(n).map_err(|_too_many| "was given too many tracks".to_owned())?;
    Dendrogram::new(n_leaves, (0..table.rows()).map(merge).collect()).map_err(|e| format!("committed {e}"))
}

fn read_frames(reply: &Reply, tracks: &Tracks) -> Result<Vec<FrameNote>, String> {
    let Some(table) = reply.table(&reply::FRAMES) else { return Ok(Vec::new()) };
    let (frames, outliers) = (table.required::<i64>("frame"), table.required::<u8>("outlier"));
    let distances = table.required::<f64>("distance");
    let mut told = std::collections::BTreeSet::new();
    let note = |k: usize| {
        let (frame, outlier, distance) = (frames[k], outliers[k], distances[k]);
        if tracks.frames.binary_search(&frame).is_err() || !told.insert(frame) {
            return Err(format!(
                "committed a note on frame {frame}, which is none of the tracks' or has one"
            ));
        }
        if outlier > 1 || !distance.is_finite() || distance < 0.0 {
            return Err(format!("frame {frame} has outlier {outlier}, distance {distance}"));
        }
        Ok(FrameNote { frame, outlier: outlier == 1, distance })
    };
    (0..table.rows()).map(note).collect()
}
