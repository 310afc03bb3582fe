//! What may be typed of skeletons.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use honami_workbench::shape::parse_groups;

use super::WithPlugin;

/// The branches behind the tracks: a skeleton that moves as filmed, from the groups of the shown clustering.
///
/// Groups are ellipses, forks the means of what they bear, shifted towards the root until bones change their length least
/// (Diener 2009; --with zeng has Zeng's way of 2015); then bones of constant length are moved so that tips are where their
/// groups are. Lengths are pixels.
/// docs/skeletons.md says how it is done, how good it is, and what files hold.
#[derive(Args, Debug)]
pub(in crate::cli) struct Grow {
    /// Project file (.honami).
    pub(in crate::cli) project: PathBuf,
    /// Files to write: .bvh (motion capture), .csv (joints and angles in every frame), .swc (the shape at rest), .glb (a rig:
    /// tubes, or the plant of --onto or --branches, on bones that move, for modellers and engines), .usda (the same, without
    /// materials), out/%04d.ply or out/%04d.obj (that, a file a frame), .pc2 (where the vertices of --onto are).
    pub(in crate::cli) out: Vec<PathBuf>,
    #[command(flatten)]
    pub(in crate::cli) plugin: WithPlugin,
    /// How far joints are shifted from the centroids of their clusters towards what bears them, 0 to less than 1 of the way
    /// (of zeng, as --set shift=A; default 0.5).
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    pub(in crate::cli) shift: Option<f64>,
    /// Copies that stand round the trunk (of zeng, as --set copies=C; default 3).
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    pub(in crate::cli) copies: Option<i64>,
    /// An image as large as the clip, white where branches may be: others are cut, and these are pushed to fill it
    /// (zeng's; default: the convex hull of the tracks).
    #[arg(long, value_name = "IMAGE")]
    pub(in crate::cli) envelope: Option<PathBuf>,
    /// Where the plant leaves the ground, pixels of the picture (default: where it was placed by hand, else under the mean of
    /// all features, as low as the lowest usually is).
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(in crate::cli) root: Option<Place>,
    /// Leave hand work on the skeleton out: the root that was placed, and bones that were shaped (see honami shape).
    #[arg(long)]
    pub(in crate::cli) as_grown: bool,
    /// Number of groups to cut the hierarchy into (default: as it is cut).
    #[arg(long, value_name = "K")]
    pub(in crate::cli) groups: Option<u32>,
    /// Stay in the plane of the picture (default: groups lie on the front of an ellipsoid about the plant, and all of it
    /// has a mirror image behind; zeng: copies stand round the trunk).
    #[arg(long)]
    pub(in crate::cli) flat: bool,
    /// Only the frames after which the motion is most as it began, so that it repeats without a jump.
    #[arg(long = "loop")]
    pub(in crate::cli) is_loop: bool,
    /// Another plant, which the skeleton carries instead of tubes: .glb, .obj, .ply, or .mtg, .swc, .csv, .mat, whose branches
    /// become tubes. It is written as a .glb, as frames (walk/%04d.ply, walk/%04d.obj) or as a point cache (.pc2).
    #[arg(long, value_name = "PLANT")]
    pub(in crate::cli) onto: Option<PathBuf>,
    /// Branches to put a plant together of, which the skeleton carries instead of tubes: on every bone that bears no other a
    /// copy of one, from a .glb, .obj or .ply, or of what hangs on the forks of a .mtg, .swc, .csv or .mat. May be repeated.
    #[arg(long, value_name = "LIB", conflicts_with = "onto")]
    pub(in crate::cli) branches: Vec<PathBuf>,
    /// Which axis of an .obj or .ply points up (default: y of .obj, z of .ply).
    #[arg(long, value_enum)]
    pub(in crate::cli) up: Option<Up>,
    /// Turn the skeleton in PLANT, counterclockwise from above, degrees.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub(in crate::cli) turn: Option<f64>,
    /// How vertices follow several bones, in frames and caches (default: linear, as who reads a .glb does).
    #[arg(long, value_enum)]
    pub(in crate::cli) blend: Option<Blend>,
    /// Colour vertices by the bones that carry them.
    #[arg(long)]
    pub(in crate::cli) weights: bool,
    /// Metres of a pixel in what is carried (default: 0.001; with --onto, of PLANT's lengths: as makes both as high).
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub(in crate::cli) unit: Option<f64>,
    /// Joints that a .glb or .usda has at most, ends of bones counted, as engines limit them: of the bones at the end those with
    /// the fewest tracks go first, and what they carried goes with what bears them.
    #[arg(long, value_name = "N")]
    pub(in crate::cli) joints: Option<u32>,
    /// Write where every track is as a leaf of the skeleton: track,joint,frame,time_s,x_px,y_px,depth_px.
    #[arg(long, value_name = "FILE.csv")]
    pub(in crate::cli) leaves: Option<PathBuf>,
    /// Draw N siblings, alike but not the same, and write each as OUT-1, OUT-2 … beside OUT: bones turn by other angles, and
    /// swing as they did.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=9999))]
    pub(in crate::cli) siblings: Option<u32>,
    /// The same seed gives the same siblings, and the same branches on the same bones (default: 1).
    #[arg(long)]
    pub(in crate::cli) seed: Option<u64>,
    /// First level of bones whose angles siblings draw; bones at the root are of level 0 (default: 3, or the last level of
    /// several bones where that comes before).
    #[arg(long, value_name = "L", requires = "siblings")]
    pub(in crate::cli) level: Option<u32>,
    /// How dense angles are at least that siblings draw, per radian (default: 0.4, or half of the highest density of a
    /// level where that is less).
    #[arg(long, value_name = "T", requires = "siblings")]
    pub(in crate::cli) threshold: Option<f64>,
    /// True positions of a generated clip, a table `track,frame,x,y,visible,branch`: say how far joints are from them.
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) truth: Option<PathBuf>,
}

/// Hand work on the skeleton of the shown groups.
#[derive(Args, Debug)]
pub(in crate::cli) struct Shape {
    /// Project file (.honami).
    pub(in crate::cli) project: PathBuf,
    /// Where the plant leaves the ground, pixels of the picture.
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub(in crate::cli) root: Option<Place>,
    /// The bone that bears these groups and no others: 3, or 3,4 or 1-4 of a fork.
    #[arg(long, visible_alias = "groups", value_name = "GROUPS")]
    pub(in crate::cli) group: Option<Groups>,
    /// Turn the plane that the bone moves in, so that it points away from the camera (-: towards it): -180 to 180 degrees.
    #[arg(long, value_name = "DEG", requires = "group", allow_negative_numbers = true)]
    pub(in crate::cli) plane: Option<f64>,
    /// Have the bone lean otherwise at rest, clockwise as the bone that bears it sees the picture: -180 to 180 degrees.
    #[arg(long, value_name = "DEG", requires = "group", allow_negative_numbers = true)]
    pub(in crate::cli) lean: Option<f64>,
    /// Have the bone swing so many times as far beside what bears it: 0 (stiff) to 10.
    #[arg(long, value_name = "G", requires = "group", allow_negative_numbers = true)]
    pub(in crate::cli) gain: Option<f64>,
    /// Leave it as it grows: the root, the bone that bears these groups, or, without a word, all.
    #[arg(long, value_name = "root|GROUPS", num_args = 0..=1, default_missing_value = "all", conflicts_with_all = ["root", "group"])]
    pub(in crate::cli) release: Option<Released>,
}

/// Groups as people count them, kept from 0: `3`, `1-4,7`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) struct Groups(pub(in crate::cli) Vec<u32>);

impl std::str::FromStr for Groups {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wanted = || format!("wanted groups as 3, 3,4 or 1-4, got {text}");
        parse_groups(text).map(Self).ok_or_else(wanted)
    }
}

/// What is to be as it grows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum Released {
    All,
    Root,
    Bone(Groups),
}

impl std::str::FromStr for Released {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::All),
            "root" => Ok(Self::Root),
            groups => groups.parse().map(Self::Bone).map_err(|why: String| format!("{why}, nor root")),
        }
    }
}

/// Axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Up {
    Y,
    Z,
}

impl From<Up> for honami_workbench::grow::Up {
    fn from(up: Up) -> Self {
        match up {
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

/// Ways to follow several bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum Blend {
    /// The mean of where each bone would have a vertex.
    Linear,
    /// Dual quaternions: what is twisted keeps its thickness.
    Dual,
}

impl From<Blend> for honami_workbench::grow::Blend {
    fn from(blend: Blend) -> Self {
        match blend {
            Blend::Linear => Self::Linear,
            Blend::Dual => Self::Dual,
        }
    }
}

/// `X,Y` in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::cli) struct Place(pub(in crate::cli) [f64; 2]);

impl std::str::FromStr for Place {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |word: &str| word.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        text.split_once(',')
            .and_then(|(x, y)| Some(Self([number(x)?, number(y)?])))
            .ok_or_else(|| format!("wanted a place as X,Y in pixels, got {text}"))
    }
}
