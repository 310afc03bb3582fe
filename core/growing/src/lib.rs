//! What structure plugins share: tracks and groups as the algorithms take them, skeletons as the host does.

use std::collections::BTreeMap;

use honami_model::clip::FrameTimes;
use honami_model::track::TrackId;
use honami_plugin::{Cx, Error, Filmed, Joint, Leaf, Result, Skeleton, Track};
use honami_structure::follow::Path;
use honami_structure::tree::Group;
use honami_structure::{Grown, StructureError};

/// What the algorithms grow from.
#[derive(Debug)]
pub struct Seen {
    /// Where each track is seen.
    pub paths: Vec<Path>,
    /// The tree of their groups; each is known by its row.
    pub groups: Vec<Group>,
    /// Of the frames.
    pub times: FrameTimes,
}

/// Tracks and groups, as the algorithms take them.
///
/// # Errors
/// Where there are no frames.
pub fn seen(filmed: &Filmed<'_>) -> Result<Seen> {
    let tracks = &filmed.tracks;
    let times = FrameTimes::new(tracks.times_s.to_vec()).map_err(|error| Error::data(error.to_string()))?;
    let paths = tracks.iter().map(|track| path(&track, tracks.first_time, times.len())).collect();
    let group = |row: usize| Group {
        parent: filmed.groups.parent(row),
        children: filmed.groups.parts(row).collect(),
        number: row as u32,
        leaves: filmed.groups.tracks(row).collect(),
        ..Group::default()
    };
    Ok(Seen { paths, groups: (0..filmed.groups.len()).map(group).collect(), times })
}

/// Where a track is seen, in frames from the first on.
fn path(track: &Track<'_>, first: i64, n_frames: u32) -> Path {
    let at = |frame: u32| {
        let k = usize::try_from(first + i64::from(frame) - track.first_frame).ok()?;
        track.seen(k).then(|| [f64::from(track.x[k]), f64::from(track.y[k])])
    };
    Path { track: TrackId(track.id), at: (0..n_frames).map(at).collect() }
}

/// Grows by an algorithm, and hands over what has grown.
///
/// # Errors
/// A stop; and what the algorithm says: that nothing grows is the fault of the data.
pub fn grow(
    filmed: &Filmed<'_>,
    cx: &Cx<'_>,
    algorithm: impl FnOnce(&Seen) -> Result<Grown, StructureError>,
) -> Result<Skeleton> {
    cx.progress(0.0, "gathering tracks")?;
    let seen = seen(filmed)?;
    cx.progress(0.1, "growing")?;
    let grown = algorithm(&seen).map_err(|error| Error::data(error.to_string()))?;
    cx.progress(0.9, "handing over")?;
    Ok(skeleton(grown, &seen))
}

/// A skeleton as the host takes it, to the last bit.
fn skeleton(grown: Grown, seen: &Seen) -> Skeleton {
    let from = grown.skeleton;
    let joint = |joint: &honami_model::skeleton::Joint| Joint {
        parent: joint.parent,
        length: joint.length,
        groups: joint.groups.clone(),
    };
    let mut joints: Vec<Joint> = from.joints().iter().map(joint).collect();
    // Joints know the groups that have tracks; these are the forks.
    let forks = grown.joint_of.iter().enumerate().filter(|(row, _)| !seen.groups[*row].children.is_empty());
    for (row, joint) in forks {
        if let Some(joint) = joint {
            joints[*joint as usize].groups.push(row as u32);
        }
    }
    let rows: BTreeMap<TrackId, u32> = (0..).zip(&seen.paths).map(|(row, path)| (path.track, row)).collect();
    let (root, n_frames) = (from.root(), from.times().len());
    let pose = (0..n_frames).flat_map(|frame| from.directions(frame)).copied().collect();
    let leaf = |leaf: honami_model::skeleton::Leaf| {
        let track = rows.get(&leaf.track).copied()?;
        Some(Leaf { joint: leaf.joint, track, offsets: leaf.offsets })
    };
    Skeleton { root, joints, pose, leaves: from.into_leaves().into_iter().filter_map(leaf).collect() }
}
