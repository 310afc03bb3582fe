//! Tracks in space: what two cameras see of the same features becomes places in metres, kept in the left project.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use honami_cameras::clock::Offset;
use honami_cameras::matching::{self, Match};
use honami_cameras::together::{Placed, View, placed, sigma_px};
use honami_cameras::{Camera, Pair, Pixel};
use honami_model::clip::FrameTimes;
use honami_model::edit::Transaction;
use honami_model::provenance::{Provenance, Value};
use honami_model::space::{Fix, SpaceId, SpaceTrack};
use honami_model::track::TrackId;
use honami_store::{Project, Space};

use crate::calibrate::file::{self, Known, Unit};
use crate::error::{SpaceError, WorkbenchError};
use crate::progress::{Flow, Progress};
use crate::stamp;
use crate::sync::shared_names;

pub use shown::{InSpace, shown};

mod shown;

/// Which tracks of two projects are one feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pairing {
    /// Those that have the same name.
    Names,
    /// Those that lie on each other's epipolar lines and move alike, whatever they are called.
    Motion,
    /// By name, and those without a partner by motion.
    Both,
}

impl Pairing {
    /// The word of the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Names => "names",
            Self::Motion => "motion",
            Self::Both => "both",
        }
    }
}

/// How far the right clock is ahead of the left one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clocks {
    /// Both clips begin at the same moment.
    BeginTogether,
    /// This far, as was found or given; its error makes places less certain.
    Apart(Offset),
}

/// What is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceRequest {
    /// The file of both cameras.
    pub cameras: PathBuf,
    /// The unit of its lengths, where it does not say so.
    pub unit: Option<Unit>,
    /// How far the clocks are apart.
    pub clocks: Clocks,
    /// Which tracks are one.
    pub pairing: Pairing,
    /// Tracks farther than this from each other's epipolar lines are not one, pixels.
    pub farthest_px: f64,
    /// Standard deviation of one coordinate of a sample, pixels; where it is not said it is told from the residuals.
    pub sigma_px: Option<f64>,
}

/// How two tracks were found to be one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Because {
    /// They have the same name.
    Named,
    /// They lie on each other's lines and move alike.
    Moves(Match),
}

/// Two tracks that are one feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Paired {
    /// The left one.
    pub left: TrackId,
    /// The right one.
    pub right: TrackId,
    /// Why.
    pub because: Because,
    /// In how many frames it has a place.
    pub n_fixes: usize,
    /// Frames in which both are seen, but of no place before both cameras.
    pub n_lost: usize,
    /// Median of its residuals, pixels.
    pub residual_px: f64,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The tracks in space, as they are kept.
    pub id: SpaceId,
    /// Which tracks became one, in order of the left one.
    pub pairs: Vec<Paired>,
    /// Tracks of the left and of the right project without a partner.
    pub n_unmatched: [usize; 2],
    /// Samples of the left and of the right project that are left out: they lie beyond what their camera's distortion can describe.
    pub n_beyond: [usize; 2],
    /// How far the clocks are apart.
    pub offset: Offset,
    /// Standard deviation of one coordinate of a sample, pixels.
    pub sigma_px: f64,
    /// Median residual, pixels.
    pub residual_px: f64,
    /// Median standard errors along and across the line of sight, metres.
    pub errors_m: [f64; 2],
}

/// A triangulation that is ready to go.
pub struct SpaceJob {
    pair: Pair,
    offset: Offset,
    request: SpaceRequest,
    sides: [Side; 2],
    named: Vec<[usize; 2]>,
    provenance: Provenance,
}

/// A triangulation that has ended; give it to [`finish`].
pub struct SpaceDone {
    space: Space,
    found: Found,
}

/// The tracks of a project as its camera saw them.
struct Side {
    times: FrameTimes,
    ids: Vec<TrackId>,
    seen: Vec<Vec<Option<Pixel>>>,
    /// Samples that are left out: they lie beyond what the camera's distortion can describe.
    n_beyond: usize,
}

impl Side {
    fn of(project: &Project, camera: &Camera) -> Result<Self, WorkbenchError> {
        let times = project.clip().clip.times.clone();
        let (mut ids, mut seen, mut n_beyond) = (Vec::new(), Vec::new(), 0);
        for (id, span) in project.shown_all()? {
            let mut at = |frame| {
                let sample = span.get(frame).filter(|sample| sample.status.is_seen())?;
                let at = Pixel::new(sample.x.into(), sample.y.into());
                let is_within = camera.undistort(&at).is_ok();
                n_beyond += usize::from(!is_within);
                is_within.then_some(at)
            };
            seen.push((0..times.len()).map(&mut at).collect());
            ids.push(id);
        }
        match ids.is_empty() {
            true => Err(SpaceError::NoTracks { path: project.path().to_owned() }.into()),
            false => Ok(Self { times, ids, seen, n_beyond }),
        }
    }

    fn view(&self, track: usize) -> View<'_> {
        View { times_s: self.times.as_slice(), seen: &self.seen[track] }
    }
}

/// Reads cameras and tracks.
///
/// # Errors
/// [`SpaceError::NoUnit`], [`SpaceError::Size`] of clips that the cameras did not take, [`SpaceError::NoTracks`], and what reading met.
pub fn prepare(left: &Project, right: &Project, request: SpaceRequest) -> Result<SpaceJob, WorkbenchError> {
    let Known { mut pair, sizes, unit, .. } = file::read(&request.cameras)?;
    let unit =
        request.unit.or(unit).ok_or_else(|| SpaceError::NoUnit { cameras: request.cameras.clone() })?;
    pair.right_from_left.translation *= unit.metres();
    for (project, wanted) in [left, right].into_iter().zip(sizes) {
        let clip = &project.clip().clip;
        let came = [clip.width, clip.height];
        if came != wanted {
            let (path, cameras) = (project.path().to_owned(), request.cameras.clone());
            return Err(SpaceError::Size { path, came, wanted, cameras }.into());
        }
    }
    let sides = [Side::of(left, &pair.cameras[0])?, Side::of(right, &pair.cameras[1])?];
    let offset = match request.clocks {
        Clocks::Apart(offset) => offset,
        Clocks::BeginTogether => {
            let [first, second] = sides.each_ref().map(|side| side.times.as_slice()[0]);
            Offset { seconds: second - first, error_s: 0.0, alike: 1.0, rival_s: None }
        }
    };
    let named = match request.pairing {
        Pairing::Motion => Vec::new(),
        Pairing::Names | Pairing::Both => by_name([left, right], &sides),
    };
    let provenance = provenance(left, right, &request, &offset)?;
    Ok(SpaceJob { pair, offset, request, sides, named, provenance })
}

/// Numbers of the tracks that have the same name in both; of several of one name the first.
fn by_name(projects: [&Project; 2], sides: &[Side; 2]) -> Vec<[usize; 2]> {
    let named = |side: usize| -> BTreeMap<String, usize> {
        let name = |&(_, id): &(usize, &TrackId)| projects[side].document().track(*id)?.name.clone();
        let tracks = sides[side].ids.iter().enumerate().rev();
        tracks.filter_map(|track| Some((name(&track)?, track.0))).collect()
    };
    let (left, right) = (named(0), named(1));
    shared_names(projects).iter().filter_map(|name| Some([*left.get(name)?, *right.get(name)?])).collect()
}

fn provenance(
    left: &Project,
    right: &Project,
    request: &SpaceRequest,
    offset: &Offset,
) -> Result<Provenance, WorkbenchError> {
    let text = |path: &Path| Value::Text(path.display().to_string());
    let together = matches!(request.clocks, Clocks::BeginTogether);
    let mut params: BTreeMap<String, Value> = [
        ("cameras", text(&request.cameras)),
        ("right", text(right.path())),
        ("right_clip_sha256", Value::Text(right.clip().sha256.clone())),
        ("right_revision", Value::Int(right.revision().0.into())),
        ("offset_s", Value::Float(offset.seconds)),
        ("offset_error_s", Value::Float(offset.error_s)),
        ("begin_together", Value::Bool(together)),
        ("match", Value::Text(request.pairing.word().to_owned())),
        ("farthest_px", Value::Float(request.farthest_px)),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    params.extend(request.sigma_px.map(|sigma| ("sigma_px".to_owned(), Value::Float(sigma))));
    params.extend(request.unit.map(|unit| ("unit".to_owned(), Value::Text(unit.name().to_owned()))));
    let sha256 = honami_media::sha256_of_file(&request.cameras)?;
    Ok(stamp::own(left, "triangulate", params, sha256))
}

impl SpaceJob {
    /// Finds which tracks are one, and where they are; stopped, it keeps nothing.
    ///
    /// # Errors
    /// [`SpaceError::NoPairs`] where no tracks are one or have no place together, [`WorkbenchError::Stopped`].
    pub fn run(self, progress: &dyn Progress) -> Result<SpaceDone, WorkbenchError> {
        let (mut pairs, n_unmatched) = self.pairs();
        let n_beyond = self.sides.each_ref().map(|side| side.n_beyond);
        pairs.sort_by_key(|&([left, _], _)| left);
        let (mut tracks, mut told) = (Vec::new(), Vec::new());
        for (k, ([left, right], because)) in pairs.iter().enumerate() {
            if progress.report(k as u64, pairs.len() as u64, "pair") == Flow::Stop {
                return Err(WorkbenchError::Stopped);
            }
            let views = [self.sides[0].view(*left), self.sides[1].view(*right)];
            let (fixes, n_lost) = placed(&self.pair, &views[0], &views[1], &self.offset);
            let residuals = fixes.iter().map(|placed| placed.fix.rms_px).collect();
            told.push(Paired {
                left: self.sides[0].ids[*left],
                right: self.sides[1].ids[*right],
                because: *because,
                n_fixes: fixes.len(),
                n_lost,
                residual_px: median(residuals).unwrap_or(0.0),
            });
            tracks.push(fixes);
        }
        let residuals: Vec<f64> = tracks.iter().flatten().map(|placed| placed.fix.rms_px).collect();
        let told_px = sigma_px(residuals.clone());
        let (Some(residual_px), Some(told_px)) = (median(residuals), told_px) else {
            return Err(SpaceError::NoPairs {
                n: self.sides.map(|side| side.ids.len()),
                farthest_px: self.request.farthest_px,
            }
            .into());
        };
        let sigma_px = self.request.sigma_px.unwrap_or(told_px);
        let fixes = tracks.iter().flatten();
        let middle = self.pair.right_from_left.centre() / 2.0;
        let errors: Vec<[f64; 2]> =
            fixes.map(|placed| placed.with(sigma_px).along_and_across(&middle)).collect();
        let errors_m = [0, 1].map(|k| median(errors.iter().map(|e| e[k]).collect()).unwrap_or(0.0));
        let mut provenance = self.provenance;
        provenance.params.insert("sigma_px".to_owned(), Value::Float(sigma_px));
        let kept = tracks.iter().zip(&told).filter(|(fixes, _)| !fixes.is_empty());
        let tracks = kept.map(|(fixes, pair)| kept_track(pair, fixes, sigma_px)).collect();
        let found = Found {
            id: SpaceId(0),
            pairs: told,
            n_unmatched,
            n_beyond,
            offset: self.offset,
            sigma_px,
            residual_px,
            errors_m,
        };
        Ok(SpaceDone { space: Space { provenance, tracks }, found })
    }
}

impl SpaceJob {
    /// Numbers of the tracks that are one, and why; and how many of either side are none.
    fn pairs(&self) -> (Vec<([usize; 2], Because)>, [usize; 2]) {
        let mut pairs: Vec<([usize; 2], Because)> =
            self.named.iter().map(|&pair| (pair, Because::Named)).collect();
        let left_over = |side: usize| -> Vec<usize> {
            let is_taken = |track: usize| self.named.iter().any(|pair| pair[side] == track);
            (0..self.sides[side].ids.len()).filter(|&track| !is_taken(track)).collect()
        };
        let rest = [left_over(0), left_over(1)];
        if self.request.pairing != Pairing::Names {
            let times = self.sides[0].times.as_slice();
            let moved: Vec<Vec<Option<Pixel>>> = rest[1]
                .iter()
                .map(|&track| {
                    let view = self.sides[1].view(track);
                    times.iter().map(|t| Some(view.at(t + self.offset.seconds)?.0)).collect()
                })
                .collect();
            let left: Vec<_> = rest[0].iter().map(|&track| self.sides[0].seen[track].as_slice()).collect();
            let right: Vec<_> = moved.iter().map(Vec::as_slice).collect();
            let options =
                matching::Options { farthest_px: self.request.farthest_px, ..matching::Options::default() };
            let found = matching::matched(&self.pair, &left, &right, &options);
            pairs.extend(
                found.into_iter().map(|one| ([rest[0][one.left], rest[1][one.right]], Because::Moves(one))),
            );
        }
        let n_unmatched = [0, 1].map(|side| self.sides[side].ids.len() - pairs.len());
        (pairs, n_unmatched)
    }
}

fn kept_track(pair: &Paired, fixes: &[Placed], sigma_px: f64) -> SpaceTrack {
    let fix = |placed: &Placed| {
        let fix = placed.with(sigma_px);
        Fix {
            frame: placed.frame as u32,
            place_m: fix.place.into(),
            errors_m: fix.errors().map(|error| error as f32),
            residual_px: fix.rms_px as f32,
        }
    };
    SpaceTrack { track: pair.left, right: pair.right, fixes: fixes.iter().map(fix).collect() }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Keeps the tracks in space in the left project and shows them: one edit, which undo takes back.
///
/// # Errors
/// What the project met.
pub fn finish(left: &mut Project, done: SpaceDone) -> Result<Found, WorkbenchError> {
    let SpaceDone { space, found } = done;
    let id = left.save_space(&space)?;
    left.commit(Transaction::show_space(id, space.tracks.len()))?;
    Ok(Found { id, ..found })
}
