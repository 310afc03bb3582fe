//! Cameras from pictures of a chessboard, or from tracks of targets on bars.

mod chosen;
pub mod file;
pub mod held;
pub mod rig;
mod side;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use honami_cameras::camera::NUMBERS;
use honami_cameras::stereo::{from_cameras, stand};
use honami_cameras::{Calibration, Camera, CameraError, Loss, Options, Sighting, Stereo, Target, calibrate};
use honami_model::provenance::{Provenance, Value};
pub use honami_vision::board::{Board, Window};

pub use self::file::{Known, Unit};
pub use self::held::Held;
pub use self::rig::Rig;
use self::side::{Side, paired, together};
use crate::error::{CamerasError, WorkbenchError};
use crate::progress::{Flow, Progress};
use crate::session::Session;
use crate::stamp;

/// Pictures of a chessboard.
#[derive(Clone, Debug, PartialEq)]
pub struct Filmed {
    /// Image files, or one video, folder or pattern; one camera's.
    pub left: Vec<PathBuf>,
    /// The same moments by the other camera; empty where there is none.
    pub right: Vec<PathBuf>,
    /// Inner corners of the board.
    pub board: Board,
    /// Side of a square.
    pub square: f64,
    /// Its unit, where it is known.
    pub unit: Option<Unit>,
    /// How much of a picture around a corner is looked at.
    pub window: Window,
    /// Numbers that are not looked for.
    pub held: Vec<Held>,
    /// So many views at most are fitted, those that differ most in where the board stands; 40 where it is not said.
    pub n_views: Option<usize>,
}

/// Targets on bars, as tracks of projects saw them.
pub struct Tracked<'a> {
    /// The camera's project, or the left one's.
    pub left: &'a Session,
    /// The right one's.
    pub right: Option<&'a Session>,
    /// Where the targets are.
    pub rig: &'a Rig,
    /// Both cameras, where their numbers are known: only how they stand is looked for.
    pub known: Option<[KnownCamera; 2]>,
    /// So many views at most are fitted, evenly in time; 100 where it is not said.
    pub n_views: Option<usize>,
}

/// A camera whose numbers are known, and the size of its pictures, pixels.
pub type KnownCamera = (Camera, [u32; 2]);

/// A camera, and which pictures it is from.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// The camera.
    pub calibration: Calibration,
    /// Size of its pictures, pixels.
    pub size: [u32; 2],
    /// Names of the pictures that were fitted, in the order of the calibration's views.
    pub shown: Vec<String>,
    /// Pictures that show the target: more, where not all were fitted.
    pub n_shown: usize,
    /// Names of those that do not show it, and why.
    pub left_out: Vec<(String, String)>,
    /// Of round targets how many middles were measured, and how many are as the tracks have them.
    pub middles: Option<[usize; 2]>,
}

/// What was seen says of one or two cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct Cameras {
    /// The camera, or the left one.
    pub left: Calibrated,
    /// The right one, and how they stand.
    pub right: Option<(Calibrated, Stereo)>,
    /// The unit of lengths, where it is known.
    pub unit: Option<Unit>,
    /// The left camera's focal length, x, and rms, pixels, by windows that fit the board's squares, where other windows were asked
    /// for and these fit better.
    pub by_squares: Option<[f64; 2]>,
    /// What they were made from, and how.
    pub provenance: Provenance,
}

/// Calibrates a camera, or two, by pictures of a board. Pictures that do not show all of it are left out, and said.
///
/// # Errors
/// What the pictures say when they are opened; [`CamerasError::Pairs`] where the cameras did not take as many;
/// [`CamerasError::NotShown`] where nothing shows it; [`CamerasError::Camera`] and [`CamerasError::View`] where the board's
/// pictures do not tell the cameras; [`WorkbenchError::Stopped`].
pub fn by_board(filmed: &Filmed, progress: &dyn Progress) -> Result<Cameras, WorkbenchError> {
    let Board { columns, rows } = filmed.board;
    let target = Target::board(columns, rows, filmed.square).map_err(CamerasError::Camera)?;
    let options = Options { model: Held::model(&filmed.held), loss: Loss::Squares };
    let (left, mut fitting) = Side::of_board(&filmed.left, filmed, progress)?;
    let mut sides = vec![left];
    if !filmed.right.is_empty() {
        sides.push(Side::of_board(&filmed.right, filmed, progress)?.0);
    }
    sides.iter().try_for_each(Side::shows)?;
    if let [left, right] = &sides[..] {
        paired(left, right)?;
    }
    let outer = [0, columns - 1, columns * (rows - 1), columns * rows - 1];
    let n_views = filmed.n_views.unwrap_or(chosen::MOST_VIEWS);
    let stands = |view: usize| sides.iter().map(|side| side.stand(view, outer)).collect();
    let stands: Vec<Vec<chosen::Stand>> = (0..sides[0].views.len()).map(stands).collect();
    let kept: BTreeSet<usize> = chosen::chosen(&stands, n_views).into_iter().collect();
    sides.iter_mut().chain(&mut fitting).for_each(|side| side.keep(&kept));
    let fits = Fits { target: &target, options, progress };
    let mut cameras = fits.calibrated(&sides, filmed.unit, made(filmed.params(n_views), &sides))?;
    // Advice alone: where it fails there is none.
    let by_squares = fitting.and_then(|side| fits.alone(&side).ok());
    let rms = cameras.left.calibration.rms_px;
    let numbers = by_squares.map(|by| [by.calibration.camera.fx, by.calibration.rms_px]);
    cameras.by_squares = numbers.filter(|&[_, by]| by < rms);
    Ok(cameras)
}

/// Calibrates a camera, or two, by what tracks of projects saw of targets on a plane: frame n of one was taken when that of the
/// other was. Frames in which fewer than four targets are seen are left out.
///
/// Each camera has one focal length, its axis through the middle of the picture and no distortion: a handful of targets tells no
/// more (thesis, eq. 2.1). Of two cameras whose numbers are known these are kept, and only how they stand is looked for.
///
/// # Errors
/// [`CamerasError::File`] of a project without tracks of all targets; [`CamerasError::Size`] of one whose pictures are not of the
/// known camera; as [`by_board`].
pub fn by_rig(tracked: &Tracked<'_>, progress: &dyn Progress) -> Result<Cameras, WorkbenchError> {
    let Tracked { left, right, rig, known, n_views } = *tracked;
    let sessions: Vec<&Session> = std::iter::once(left).chain(right).collect();
    let mut sides: Vec<Side> =
        sessions.iter().map(|session| rig::seen(&session.project, rig)).collect::<Result<_, _>>()?;
    sides.iter().try_for_each(Side::shows)?;
    let n_views = n_views.unwrap_or(rig::MOST_VIEWS);
    rig::thinned(&mut sides, n_views);
    for (side, session) in sides.iter_mut().zip(sessions) {
        rig::refined(side, rig, &session.media, progress)?;
    }
    let params = vec![
        ("targets", Value::Text(rig.name.clone())),
        ("targets_sha256", Value::Text(rig.sha256.clone())),
        ("views", whole(n_views)),
        ("known", Value::Bool(known.is_some())),
    ];
    let provenance = made(params, &sides);
    match (known, sides.as_slice()) {
        (Some(known), [left, right]) => placed(rig, left, right, known, provenance),
        _ => Fits { target: &rig.target, options: Options::BARS, progress }
            .calibrated(&sides, rig.unit, provenance),
    }
}

impl Filmed {
    fn params(&self, n_views: usize) -> Vec<(&'static str, Value)> {
        let window = match self.window {
            Window::Radius(radius) => radius.to_string(),
            Window::Squares => "squares".to_owned(),
        };
        let mut params = vec![
            ("board", Value::Text(format!("{}x{}", self.board.columns, self.board.rows))),
            ("square", Value::Float(self.square)),
            ("window", Value::Text(window)),
            ("views", whole(n_views)),
        ];
        params.extend(self.unit.map(|unit| ("unit", Value::Text(unit.name().to_owned()))));
        if !self.held.is_empty() {
            let held: Vec<&str> = self.held.iter().map(|held| held.name()).collect();
            params.push(("hold", Value::Text(held.join(","))));
        }
        params
    }
}

/// What cameras are made from: these parameters, and what each of them saw.
fn made(mut params: Vec<(&'static str, Value)>, sides: &[Side]) -> Provenance {
    let names = [["left", "left_sha256", "left_revision"], ["right", "right_sha256", "right_revision"]];
    for (Side { source, .. }, [name, sha256, revision]) in sides.iter().zip(names) {
        params.push((name, Value::Text(source.name.clone())));
        params.push((sha256, Value::Text(source.sha256.clone())));
        params.extend(source.revision.map(|number| (revision, Value::Int(number.into()))));
    }
    let params: BTreeMap<_, _> = params.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    stamp::alone("calibrate", params, sides[0].source.sha256.clone())
}

fn whole(number: usize) -> Value {
    Value::Int(i64::try_from(number).unwrap_or(i64::MAX))
}

/// How two cameras stand whose numbers are known.
fn placed(
    rig: &Rig,
    left: &Side,
    right: &Side,
    known: [KnownCamera; 2],
    provenance: Provenance,
) -> Result<Cameras, WorkbenchError> {
    for (side, (_, wanted)) in [left, right].into_iter().zip(known) {
        if side.size != wanted {
            return Err(CamerasError::Size { wanted, came: side.size }.into());
        }
    }
    let cameras = known.map(|(camera, _)| camera);
    let both = stand(&rig.target, &together(left, right), cameras, Options::BARS.loss)
        .map_err(CamerasError::Camera)?;
    let [left, right] = [(left, cameras[0]), (right, cameras[1])].map(|(side, camera)| {
        let errors = [0.0; NUMBERS.len()];
        let (rms_px, sigma_px) = (both.rms_px, both.sigma_px);
        let calibration = Calibration { camera, errors, rms_px, sigma_px, views: Vec::new() };
        side.with(calibration, side.shown().map(|(name, _)| name.clone()).collect())
    });
    Ok(Cameras { left, right: Some((right, both)), unit: rig.unit, by_squares: None, provenance })
}

/// How cameras are fitted.
struct Fits<'a> {
    target: &'a Target,
    options: Options,
    progress: &'a dyn Progress,
}

impl Fits<'_> {
    /// Both cameras, or the one, from what they saw.
    fn calibrated(
        &self,
        sides: &[Side],
        unit: Option<Unit>,
        provenance: Provenance,
    ) -> Result<Cameras, WorkbenchError> {
        let n_fits = if sides.len() > 1 { 3 } else { 1 };
        let at = |fit: u64| match self.progress.report(fit, n_fits, "fit") {
            Flow::Continue => Ok(()),
            Flow::Stop => Err(WorkbenchError::Stopped),
        };
        at(0)?;
        let left = self.alone(&sides[0])?;
        let Some(side) = sides.get(1) else {
            return Ok(Cameras { left, right: None, unit, by_squares: None, provenance });
        };
        // Each alone first: what is wrong with one is told by the names of its pictures.
        at(1)?;
        let right = self.alone(side)?;
        at(2)?;
        let (views, sizes) = (together(&sides[0], side), [left.size, right.size]);
        let cameras = [&left, &right].map(|of| of.calibration.camera);
        let both = from_cameras(self.target, &views, sizes, cameras, &self.options);
        let both = both.map_err(CamerasError::Camera)?;
        Ok(Cameras { left, right: Some((right, both)), unit, by_squares: None, provenance })
    }

    fn alone(&self, side: &Side) -> Result<Calibrated, WorkbenchError> {
        side.shows()?;
        let (shown, views): (Vec<String>, Vec<Sighting>) =
            side.shown().map(|(name, seen)| (name.clone(), seen.clone())).unzip();
        let calibration = calibrate(self.target, &views, side.size, &self.options);
        let calibration = calibration.map_err(|error| match error {
            // Which of those that show the target it is says its name.
            CameraError::SameView { first, second } => {
                let [first, second] = [first, second].map(|view| shown[view].clone());
                CamerasError::Same { first, second }
            }
            CameraError::View { view, source } => {
                CamerasError::View { name: shown[view].clone(), source: *source }
            }
            error => CamerasError::Camera(error),
        })?;
        Ok(side.with(calibration, shown))
    }
}
