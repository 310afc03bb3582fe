//! Growing: the branches behind the shown tracks, from the groups that the shown clustering is cut into.

mod assembled;
mod body;
mod bound;
mod gather;
mod hand;
mod judge;
mod outs;

use std::ops::Range;
use std::path::{Path as File, PathBuf};

pub use honami_exchange::mesh::{MeshFormat, Up};
pub use honami_exchange::skeleton::SkeletonFormat;
use honami_host::{CallContext, Filmed, Grown, Host, HostError, PluginInfo, Values};
use honami_model::clip::Clip;
use honami_model::document::Document;
use honami_model::picture::Gray;
use honami_model::provenance::{Provenance, Value};
use honami_model::skeleton::Skeleton;
use honami_model::track::TrackId;
use honami_store::Project;
pub use honami_structure::blend::Blend;
pub use honami_structure::fewer::Fewer;
use honami_structure::repeat::repeat;
pub use honami_structure::siblings::{self, Siblings};
use honami_structure::tree::Group;

pub use self::assembled::{Assembled, Begin, Library};
pub use self::bound::{Bound, Onto, UNIT};
use self::gather::gather;
pub use self::hand::{Bones, Hand, shape};
use self::hand::{Laid, lay};
pub(crate) use self::hand::{Usual, named_bones, usual};
pub use self::judge::{Judged, judge};
pub use self::outs::{Carried, ENDINGS, Out, write};
use crate::ear::Ear;
use crate::error::WorkbenchError;
use crate::progress::Progress;
use crate::stamp::stamp;

/// What the work is called while it goes on.
const WHAT: &str = "growing";
/// A brightness from here on is white.
const WHITE: u8 = 128;

/// How to grow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GrowRequest {
    /// Parameters of the structure builder; the rest take their defaults.
    pub params: Values,
    /// An image as large as the clip, white where branches may be; `None`: as the structure builder thinks.
    pub envelope: Option<PathBuf>,
    /// Where the plant leaves the ground, pixels (right, down); else where it was placed by hand, else as the structure
    /// builder thinks.
    pub root: Option<[f64; 2]>,
    /// Leave hand work on the skeleton out.
    pub as_grown: bool,
    /// Groups to cut the hierarchy into; `None`: as it is cut.
    pub groups: Option<u32>,
    /// Only the frames of the best loop, without a jump.
    pub is_loop: bool,
}

/// What has grown.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The skeleton, with a leaf for every track that it carries, and with hand work.
    pub skeleton: Skeleton,
    /// Its bones, as hands know them.
    pub bones: Bones,
    /// What of it is hand work.
    pub hand: Hand,
    /// The tracks of every group.
    pub groups: Vec<Vec<TrackId>>,
    /// Joints that a group has become, at most: the one in the picture, and its copies.
    pub n_copies: usize,
    /// Forks that were one with what bears them, as far as the structure builder tells of forks.
    pub n_collapsed: usize,
    /// Groups that have no joint, for they lay outside the envelope.
    pub n_left_out: usize,
    /// Frames of the clip that it moves through: from the first to the last in which anything of a group is seen, or a loop
    /// among them.
    pub frames: Range<u32>,
    /// When a loop begins anew: the time of the clip's next frame, in seconds.
    pub again_s: Option<f64>,
    /// Who has grown it, and how.
    pub provenance: Provenance,
    /// What whoever uses it should know, a sentence each.
    pub notes: Vec<String>,
    /// Time it took.
    pub seconds: f64,
}

/// Grows a skeleton by a structure builder; the project stays as it is.
///
/// # Errors
/// [`WorkbenchError::NoGroups`], [`WorkbenchError::Groups`], [`WorkbenchError::FarRoot`], what the plugin says,
/// [`WorkbenchError::Stopped`], [`WorkbenchError::Structure`] where nothing is seen and of what does not repeat, and what the
/// project and the image of the envelope met.
pub fn grow(
    project: &Project,
    host: &Host,
    plugin: &PluginInfo,
    request: &GrowRequest,
    progress: &dyn Progress,
) -> Result<Growth, WorkbenchError> {
    let gathered = gather(project, request.groups)?;
    let clip = &project.clip().clip;
    let hands = (!request.as_grown).then(|| project.document());
    let placed = hands.and_then(Document::root).filter(|_| request.root.is_none());
    let root = request.root.or(placed);
    if let Some(root) = root {
        check_root(root, clip)?;
    }
    let envelope = request.envelope.as_ref().map(|image| white(image, clip)).transpose();
    // Whether a method takes an envelope at all is said before what is wrong with this one.
    let everywhere = vec![1; clip.width as usize * clip.height as usize];
    let pixels = envelope.as_ref().map_or_else(|_wrong| Some(&everywhere), Option::as_ref);
    let begun = std::time::Instant::now();
    let tree = gathered.tree();
    let filmed = Filmed {
        tracks: &gathered.tracks,
        groups: &tree,
        root,
        mask: pixels.map(|pixels| Gray::packed(pixels, clip.width, clip.height)),
    };
    let (mut structure, origin) = host.structure(plugin, &request.params, &CallContext::silent())?;
    let ear = Ear::new(&plugin.short_name, progress);
    let Grown { skeleton, bears } = match ear.whole(WHAT, |call| structure.run(&filmed, call)) {
        Err(HostError::Cancelled { .. }) => return Err(WorkbenchError::Stopped),
        other => other?,
    };
    let envelope = envelope?;
    let Laid { skeleton, bones, hand, notes: of_hands } =
        lay(skeleton, &bears, (gathered.clustering, &gathered.bones), hands, placed)?;
    let (skeleton, frames, again_s) = match request.is_loop {
        true => {
            let (repeated, of) = repeat(&skeleton, gathered.unbroken.clone())?;
            let again_s = skeleton.times().get(of.end);
            (repeated, gathered.frames.start + of.start..gathered.frames.start + of.end, again_s)
        }
        false => (skeleton, gathered.frames.clone(), None),
    };
    let Became { n_copies, n_collapsed, n_left_out } = became(&gathered.groups, &bears);
    let mut notes = gathered.notes.clone();
    notes.extend(of_hands);
    notes.extend(ear.warnings());
    if envelope.is_some() && n_left_out == 0 {
        notes.push("no group is outside what is white in the envelope: none was cut".to_owned());
    }
    let mut provenance = stamp(project.revision(), "grow", plugin, &request.params, origin);
    // What is not the plugin's to know is beside its parameters, unless one has that name.
    let beside = root.map(|root| ("root", Value::List(root.to_vec()))).into_iter().chain(hand.told());
    for (id, value) in beside {
        provenance.params.entry(id.to_owned()).or_insert(value);
    }
    Ok(Growth {
        skeleton,
        bones,
        hand,
        groups: gathered.members(),
        n_copies,
        n_collapsed,
        n_left_out,
        frames,
        again_s,
        provenance,
        notes,
        seconds: begun.elapsed().as_secs_f64(),
    })
}

/// What groups have become.
struct Became {
    n_copies: usize,
    n_collapsed: usize,
    n_left_out: usize,
}

/// What groups have become, by which joint has become which of them.
fn became(groups: &[Group], bears: &[(u32, u32)]) -> Became {
    let joints_of =
        |group: usize| bears.iter().filter(move |pair| pair.1 as usize == group).map(|pair| pair.0);
    let ends: Vec<usize> = (0..groups.len()).filter(|&row| groups[row].children.is_empty()).collect();
    let is_collapsed = |(row, group): &(usize, &Group)| {
        let bearer = group.parent.map_or(Some(0), |parent| joints_of(parent).next());
        !group.children.is_empty() && joints_of(*row).next().is_some_and(|own| Some(own) == bearer)
    };
    Became {
        n_copies: ends.iter().map(|&row| joints_of(row).count()).max().unwrap_or_default(),
        n_collapsed: groups.iter().enumerate().filter(is_collapsed).count(),
        n_left_out: ends.iter().filter(|&&row| joints_of(row).next().is_none()).count(),
    }
}

/// Refuses a root that is farther from the picture than its larger side.
pub(crate) fn check_root([x, y]: [f64; 2], clip: &Clip) -> Result<(), WorkbenchError> {
    let (width, height) = (clip.width, clip.height);
    let most = f64::from(width.max(height));
    let is_near = |v: f64, size: u32| (-most..=f64::from(size) + most).contains(&v);
    match is_near(x, width) && is_near(y, height) {
        true => Ok(()),
        false => Err(WorkbenchError::FarRoot { x, y, width, height }),
    }
}

/// Where an image is white: bright by half at least.
fn white(image: &File, clip: &Clip) -> Result<Vec<u8>, WorkbenchError> {
    let pixels = crate::track::image(&PathBuf::from(image), clip)?;
    Ok(pixels.into_iter().map(|pixel| u8::from(pixel >= WHITE)).collect())
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

/// Writes where the leaves of a skeleton are, its frames numbered from `first` on; returns the number of rows.
///
/// # Errors
/// What the disk met.
pub fn write_leaves(skeleton: &Skeleton, first: u32, out: &File) -> Result<usize, WorkbenchError> {
    Ok(honami_exchange::skeleton::write_leaves(out, skeleton, first)?)
}
