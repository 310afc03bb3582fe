//! A structure builder at work, and the check of what it returns.

use std::collections::BTreeSet;

use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Handle, Request};
use crate::reply::{self, Reply, Table};
use crate::types::{Filmed, GroupTree, Tracks};

use honami_model::clip::FrameTimes;
use honami_model::skeleton::{Joint, Leaf, Skeleton};
use honami_model::track::TrackId;

/// A structure builder at work. Made by [`Host`](crate::Host).
#[derive(Debug)]
pub struct Structure {
    pub(crate) handle: Handle,
}

/// What a structure builder has grown, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The skeleton; its joints have the numbers of their groups, and the ids of these groups' tracks.
    pub skeleton: Skeleton,
    /// Rows of a joint and of a group that it has become, each pair once, those with parts as far as they were told of.
    pub bears: Vec<(u32, u32)>,
}

impl Structure {
    /// Grows a skeleton from tracks and their groups.
    ///
    /// # Errors
    /// [`HostError`], when the plugin cannot do it, is stopped, or its skeleton is none.
    pub fn run(&mut self, filmed: &Filmed<'_>, cx: &CallContext<'_>) -> Result<Grown, HostError> {
        if let Some(fault) = filmed.fault() {
            return Err(self.handle.usage(fault));
        }
        let times = FrameTimes::new(filmed.tracks.times_s.clone());
        let times = times.map_err(|error| self.handle.usage(format!("was given no times: {error}")))?;
        let mut reply = Reply::default();
        self.handle.ask(&Request::Grow(filmed), cx, &mut reply)?;
        read(&reply, filmed, times).map_err(|what| self.handle.misbehaved("run", what))
    }
}

fn read(reply: &Reply, filmed: &Filmed<'_>, times: FrameTimes) -> Result<Grown, String> {
    let said = |schema: &'static reply::Schema| {
        let missing = || format!("returned without committing {}", schema.id.to_string_lossy());
        reply.table(schema).ok_or_else(missing)
    };
    let mut joints = read_joints(said(&reply::JOINTS)?)?;
    let root = read_root(said(&reply::ROOT)?)?;
    let pose = said(&reply::POSE)?.required::<f64>("d").as_chunks().0.to_vec();
    let bears = read_bears(said(&reply::BEARS)?, joints.len(), filmed.groups)?;
    bear(&mut joints, &bears, filmed);
    let n_frames = times.len() as usize;
    let skeleton =
        Skeleton::again(root, joints, pose, times).map_err(|error| format!("committed {error}"))?;
    let leaves = match (reply.table(&reply::LEAVES), reply.table(&reply::OFFSETS)) {
        (None, None) => Vec::new(),
        (Some(leaves), Some(offsets)) => read_leaves(leaves, offsets, filmed.tracks, n_frames)?,
        _ => return Err("committed one of honami.leaves/1 and honami.offsets/1, and not the other".into()),
    };
    let skeleton = skeleton.with_leaves(leaves).map_err(|error| format!("committed {error}"))?;
    Ok(Grown { skeleton, bears })
}

/// Joints that bear nothing yet. Their order, and lengths above 0, are for the skeleton to check.
fn read_joints(table: &Table) -> Result<Vec<Joint>, String> {
    let (parents, lengths) = (table.required::<i32>("parent"), table.required::<f64>("length"));
    if let Some(length) = lengths.first().filter(|length| length.abs() > 0.0) {
        return Err(format!("gave the root, which has no bone, one of {length} px"));
    }
    let joint = |(&parent, &length): (&i32, &f64)| match parent {
        ..-1 => Err(format!("committed a joint with parent {parent}: a row or -1 was wanted")),
        parent => Ok(Joint { parent: u32::try_from(parent).ok(), length, ..Joint::default() }),
    };
    parents.iter().zip(lengths).map(joint).collect()
}

fn read_root(table: &Table) -> Result<[f64; 3], String> {
    match ["x", "y", "z"].map(|axis| table.required::<f64>(axis)) {
        [[x], [y], [z]] => Ok([*x, *y, *z]),
        [rows, ..] => Err(format!("committed {} roots, wanted one", rows.len())),
    }
}

fn read_bears(table: &Table, n_joints: usize, groups: &GroupTree) -> Result<Vec<(u32, u32)>, String> {
    let pairs = table.required::<u32>("joint").iter().zip(table.required::<u32>("group"));
    let mut told = BTreeSet::new();
    let pair = |(&joint, &group): (&u32, &u32)| {
        if joint as usize >= n_joints || group as usize >= groups.len() {
            let n_groups = groups.len();
            return Err(format!("let joint {joint} of {n_joints} bear group {group} of {n_groups}"));
        }
        if !told.insert((joint, group)) {
            return Err(format!("let joint {joint} bear group {group} twice"));
        }
        Ok((joint, group))
    };
    pairs.map(pair).collect()
}

/// Joints know the groups that they have become, and the tracks of these.
fn bear(joints: &mut [Joint], bears: &[(u32, u32)], filmed: &Filmed<'_>) {
    let mut tracks_of = vec![Vec::new(); filmed.groups.len()];
    for (&group, &id) in filmed.groups.of.iter().zip(filmed.tracks.ids()) {
        if let Ok(group) = usize::try_from(group) {
            tracks_of[group].push(TrackId(id));
        }
    }
    for &(joint, group) in bears {
        let tracks = &tracks_of[group as usize];
        if !tracks.is_empty() {
            let joint = &mut joints[joint as usize];
            joint.groups.push(filmed.groups.numbers.get(group as usize).copied().unwrap_or(group));
            joint.tracks.extend(tracks);
        }
    }
}

fn read_leaves(
    leaves: &Table,
    offsets: &Table,
    tracks: &Tracks,
    n_frames: usize,
) -> Result<Vec<Leaf>, String> {
    let all = offsets.required::<f64>("d").as_chunks().0;
    let (joints, rows) = (leaves.required::<u32>("joint"), leaves.required::<u32>("track"));
    if all.len() != rows.len() * n_frames {
        let (came, n) = (all.len(), rows.len());
        return Err(format!(
            "committed {came} offsets of {n} leaves, wanted one in each of {n_frames} frames"
        ));
    }
    let leaf = |((&joint, &row), offsets): ((&u32, &u32), &[[f64; 3]])| match tracks.ids().get(row as usize) {
        Some(&track) => Ok(Leaf { track: TrackId(track), joint, offsets: offsets.to_vec() }),
        None => Err(format!("committed a leaf of track {row} of {}", tracks.len())),
    };
    joints.iter().zip(rows).zip(all.chunks_exact(n_frames)).map(leaf).collect()
}
