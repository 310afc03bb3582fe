//! Structure builders and simulators: drafts, not part of ABI 1.0. Metres, z up, right-handed.

use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Handle, Request};
use crate::reply::{self, Reply};
use crate::types::Tracks;

/// A node of a skeleton at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Row of its parent, before its own; `None` for the root, row 0.
    pub parent: Option<u32>,
    /// Metres.
    pub position: [f32; 3],
    /// Metres.
    pub radius: f32,
    /// Row of the track it was grown from.
    pub track: Option<u32>,
}

/// Wind at a time, everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gust {
    /// Seconds.
    pub time_s: f64,
    /// Metres per second.
    pub wind: [f32; 3],
}

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
    let [parents, sources] = ["parent", "track"].map(|name| table.required::<i32>(name));
    let mut nodes = Vec::with_capacity(table.rows());
    for k in 0..table.rows() {
        let (position, radius) = ([x[k], y[k], z[k]], radii[k]);
        let (parent, track) = (u32::try_from(parents[k]).ok(), u32::try_from(sources[k]).ok());
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

/// A simulator at work.
#[derive(Debug)]
pub struct Simulator {
    pub(crate) handle: Handle,
    pub(crate) reply: Reply,
    pub(crate) n_rows: Option<usize>,
}

impl Simulator {
    /// Hands over a plant, at rest at time 0, in so many copies.
    ///
    /// # Errors
    /// [`HostError`], when the plugin cannot work on it.
    pub fn prepare(
        &mut self,
        nodes: &[Node],
        n_instances: u32,
        max_threads: u32,
        seed: u64,
        cx: &CallContext<'_>,
    ) -> Result<(), HostError> {
        self.n_rows = None;
        let request = Request::Prepare { nodes, n_instances, max_threads, seed };
        self.handle.ask(&request, cx, &mut self.reply)?;
        self.n_rows = Some(nodes.len() * n_instances as usize);
        Ok(())
    }

    /// Back to rest at time 0.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant or the plugin cannot do it.
    pub fn reset(&mut self, cx: &CallContext<'_>) -> Result<(), HostError> {
        self.prepared()?;
        self.handle.ask(&Request::Reset, cx, &mut self.reply).map(|_| ())
    }

    /// Goes `n_steps` steps of `dt` seconds; gives every node's displacement from rest, metres, `(n_instances, n_nodes)`
    /// row-major. No wind: still air.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant, or the plugin cannot do it or its motion is none.
    pub fn step(
        &mut self,
        dt: f64,
        n_steps: u32,
        wind: &[Gust],
        cx: &CallContext<'_>,
    ) -> Result<Vec<[f32; 3]>, HostError> {
        let wanted = self.prepared()?;
        self.handle.ask(&Request::Step { dt, n_steps, wind }, cx, &mut self.reply)?;
        let Some(table) = self.reply.table(&reply::MOTION) else {
            return Err(self.handle.misbehaved("step", "returned without committing honami.motion/1"));
        };
        if table.rows() != wanted {
            let what = format!("committed {} rows of motion for {wanted} nodes", table.rows());
            return Err(self.handle.misbehaved("step", what));
        }
        let numbers = table.required::<f32>("d");
        match numbers.iter().position(|v| !v.is_finite()) {
            Some(k) => {
                Err(self.handle.misbehaved("step", format!("row {} of the motion is not finite", k / 3)))
            }
            None => Ok(numbers.as_chunks().0.to_vec()),
        }
    }

    fn prepared(&self) -> Result<usize, HostError> {
        self.n_rows.ok_or_else(|| self.handle.usage("has no plant: prepare it first"))
    }
}
