//! Structure builders: a draft, not part of ABI 1.1. Metres, z up, right-handed.

use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Handle, Request};
use crate::reply::{self, Reply};
use crate::types::{Node, Tracks};

/// A structure builder at work.
#[derive(Debug)]
pub struct Structure {
    pub(crate) handle: Handle,
}

impl Structure {
    /// Grows a skeleton from tracks. The nodes are one tree, parents before their children.
    ///
    /// # Errors
    /// [`HostError`], when the plugin cannot do it or its skeleton is none.
    pub fn grow(&mut self, tracks: &Tracks, cx: &CallContext<'_>) -> Result<Vec<Node>, HostError> {
        if let Some(fault) = tracks.fault() {
            return Err(self.handle.usage(fault));
        }
        let mut reply = Reply::default();
        self.handle.ask(&Request::Grow(tracks), cx, &mut reply)?;
        read_skeleton(&reply, tracks.len()).map_err(|what| self.handle.misbehaved("run", what))
    }
}

fn read_skeleton(reply: &Reply, n_tracks: usize) -> Result<Vec<Node>, String> {
    let table = reply.table(&reply::SKELETON).ok_or("returned without committing honami.skeleton/1")?;
    let [x, y, z, radii] = ["x", "y", "z", "radius"].map(|name| table.required::<f32>(name));
    let parents = table.required::<i32>("parent");
    let sources = table.column::<i32>("track");
    let mut nodes = Vec::with_capacity(table.rows());
    for k in 0..table.rows() {
        let (position, radius) = ([x[k], y[k], z[k]], radii[k]);
        let (parent, track) =
            (u32::try_from(parents[k]).ok(), sources.and_then(|rows| u32::try_from(rows[k]).ok()));
        if parent.is_none() != (k == 0) || parent.is_some_and(|p| p as usize >= k) {
            return Err(format!("node {k} has parent {parent:?}, which does not come before it"));
        }
        if !position.iter().chain([&radius]).all(|v| v.is_finite()) || radius < 0.0 {
            return Err(format!("node {k} lies at {position:?} with radius {radius}"));
        }
        if track.is_some_and(|track| track as usize >= n_tracks) {
            return Err(format!("node {k} comes from track {track:?} of {n_tracks}"));
        }
        nodes.push(Node { parent, position, radius, track });
    }
    Ok(nodes)
}
