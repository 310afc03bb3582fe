//! Growing: the branches behind the shown tracks, from the groups that the shown clustering is cut into.

mod body;
mod judge;
mod outs;

use std::ops::Range;
use std::path::{Path as File, PathBuf};

pub use honami_exchange::skeleton::SkeletonFormat;
use honami_model::clip::Clip;
use honami_model::skeleton::Skeleton;
use honami_model::track::{Span, TrackId};
use honami_store::Project;
use honami_structure::diener;
use honami_structure::follow::Path;
use honami_structure::repeat::repeat;
pub use honami_structure::siblings::{self, Siblings};
use honami_structure::tree::tree_of;
use honami_structure::zeng::{self, Alpha};
pub use honami_structure::zeng::{COPIES, SHIFT};

pub use self::judge::{Judged, judge};
pub use self::outs::{Out, UNIT, write};
use crate::error::WorkbenchError;
use crate::track::{Area, mask};

/// How to grow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrowRequest {
    /// The published way.
    pub method: Method,
    /// Where the plant leaves the ground, pixels (right, down); else under the mean of all features, as low as the lowest.
    pub root: Option<[f64; 2]>,
    /// Groups to cut the hierarchy into; `None`: as it is cut.
    pub groups: Option<u32>,
    /// Stay in the plane of the picture.
    pub is_flat: bool,
    /// Only the frames of the best loop, without a jump.
    pub is_loop: bool,
}

/// How places of joints are found.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Method {
    /// Diener's, of the thesis 4.4: forks where bones change their length least; a mirror image for depth.
    #[default]
    Diener,
    /// Zeng's: centroids of clusters, shifted; copies round the trunk, pushed until they fill an envelope.
    Zeng {
        /// How far joints are shifted from centroids towards what bears them, 0 to less than 1; see [`SHIFT`].
        shift: f64,
        /// Copies, 1 or more; see [`COPIES`].
        copies: u32,
        /// An image as large as the clip, white where branches may be; `None`: the convex hull.
        envelope: Option<PathBuf>,
    },
}

/// What has grown.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The skeleton, with a leaf for every track.
    pub skeleton: Skeleton,
    /// From the centre of its group to where each track usually is, pixels (right, down).
    pub places: Vec<(TrackId, [f64; 2])>,
    /// Of every fork, how much was left of the way from what bears it to the mean of what it bears.
    pub alphas: Vec<f64>,
    /// Forks that were one with what bears them.
    pub n_collapsed: usize,
    /// Joints that were cut off, for they lay outside the envelope.
    pub n_cut: usize,
    /// Groups.
    pub n_groups: usize,
    /// Frames of the clip that it moves through.
    pub frames: Range<u32>,
    /// What whoever uses it should know, a sentence each.
    pub notes: Vec<String>,
    /// Time it took.
    pub seconds: f64,
}

/// Grows a skeleton; the project stays as it is.
///
/// # Errors
/// [`WorkbenchError::NoGroups`], [`WorkbenchError::Groups`], [`WorkbenchError::Structure`], and what the project met.
pub fn grow(project: &Project, request: &GrowRequest) -> Result<Growth, WorkbenchError> {
    let shown = project.document().clustering().ok_or(WorkbenchError::NoGroups)?;
    let clustering = project.clustering(shown.id)?;
    let (dendrogram, n_tracks) = (&clustering.dendrogram, clustering.tracks.len());
    let k = request.groups.unwrap_or(shown.k);
    if k == 0 || k as usize > n_tracks.max(1) {
        return Err(WorkbenchError::Groups { groups: k, n_tracks });
    }
    let times = &project.clip().clip.times;
    let mut paths = Vec::with_capacity(n_tracks);
    for &track in &clustering.tracks {
        paths.push(path(track, project.shown(track)?.as_deref(), times.len()));
    }
    let mut notes = Vec::new();
    if let Some(stale) = project.is_stale(shown.id)? {
        notes.push(format!("the groups are {stale}"));
    }
    let begun = std::time::Instant::now();
    let is_seen: Vec<bool> = paths.iter().map(Path::is_seen).collect();
    let n_lost = is_seen.iter().filter(|is_seen| !**is_seen).count();
    if n_lost > 0 {
        notes.push(format!("{n_lost} of {n_tracks} tracks are seen in no frame now and are left out"));
    }
    let shown = dendrogram.groups(k, project.document().held_groups(shown.id));
    let groups = tree_of(dendrogram, &shown, &is_seen);
    let (root, is_flat) = (request.root, request.is_flat);
    let grown = match &request.method {
        Method::Diener => diener::grow(&paths, &groups, times, diener::Settings { root, is_flat })?,
        Method::Zeng { shift, copies, envelope } => {
            let envelope = envelope.as_ref().map(|image| alpha(image, &project.clip().clip)).transpose()?;
            let is_painted = envelope.is_some();
            let settings = zeng::Settings { root, is_flat, shift: *shift, copies: *copies, envelope };
            let grown = zeng::grow(&paths, &groups, times, &settings)?;
            if is_painted && grown.n_cut == 0 {
                notes.push("no branch is outside what is white in the envelope: none was cut".to_owned());
            }
            grown
        }
    };
    let (skeleton, frames) =
        if request.is_loop { repeat(&grown.skeleton)? } else { (grown.skeleton, 0..times.len()) };
    let places = paths.iter().zip(grown.places).filter_map(|(path, place)| Some((path.track, place?)));
    Ok(Growth {
        skeleton,
        places: places.collect(),
        alphas: grown.alphas,
        n_collapsed: grown.n_collapsed,
        n_cut: grown.n_cut,
        n_groups: groups.iter().filter(|group| group.children.is_empty()).count(),
        frames,
        notes,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

/// The image of an envelope.
fn alpha(image: &File, clip: &Clip) -> Result<Alpha, WorkbenchError> {
    let pixels = mask(&Area::Mask(image.into()), clip)?.unwrap_or_default();
    Ok(Alpha { width: clip.width as usize, pixels })
}

/// Where a track is seen.
fn path(track: TrackId, span: Option<&Span>, n_frames: u32) -> Path {
    let at = |frame: u32| {
        let sample = span?.get(frame).filter(|sample| sample.status.is_seen())?;
        Some([f64::from(sample.x), f64::from(sample.y)])
    };
    Path { track, at: (0..n_frames).map(at).collect() }
}

/// What siblings of a skeleton are drawn from.
///
/// # Errors
/// [`WorkbenchError::Structure`] where there is nothing that they could differ in.
pub fn siblings<'a>(
    growth: &'a Growth,
    settings: siblings::Settings,
) -> Result<Siblings<'a>, WorkbenchError> {
    Ok(Siblings::of(&growth.skeleton, settings)?)
}

/// The `number`-th sibling of a seed.
///
/// # Errors
/// [`WorkbenchError::Structure`].
pub fn draw(siblings: &Siblings, seed: u64, number: u32) -> Result<Skeleton, WorkbenchError> {
    Ok(siblings.draw(seed, number)?)
}

/// Writes where the leaves of a skeleton are; returns the number of rows.
///
/// # Errors
/// What the disk met.
pub fn write_leaves(skeleton: &Skeleton, out: &File) -> Result<usize, WorkbenchError> {
    Ok(honami_exchange::skeleton::write_leaves(out, skeleton)?)
}
