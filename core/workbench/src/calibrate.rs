//! Cameras from pictures of a chessboard, or from tracks of targets on bars.

pub mod file;
pub mod rig;

use std::path::PathBuf;

use honami_cameras::camera::NUMBERS;
use honami_cameras::stereo::stand;
use honami_cameras::{
    Calibration, Camera, CameraError, Options, Pixel, Sighting, Stereo, Target, calibrate, stereo,
};
use honami_media::{Media, OpenOptions, Still};
pub use honami_vision::board::{Board, Window};
use honami_vision::board::{find, refined};

pub use self::file::{Known, Unit};
pub use self::rig::Rig;
use crate::error::{CamerasError, WorkbenchError};
use crate::progress::{Flow, Progress};
use crate::session::Session;

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
    /// Names of the pictures that show the target, in the order of the calibration's views.
    pub shown: Vec<String>,
    /// Names of the others, and why they say nothing.
    pub left_out: Vec<(String, String)>,
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
}

/// Calibrates a camera, or two, by pictures of a board. Pictures that do not show all of it are left out, and said.
///
/// # Errors
/// What the pictures say when they are opened; [`CamerasError::Pairs`] where the cameras did not take as many;
/// [`CamerasError::NotShown`] where nothing shows it; [`CamerasError::Camera`] and [`CamerasError::View`] where the board's
/// pictures do not tell the cameras; [`WorkbenchError::Stopped`].
pub fn by_board(filmed: &Filmed, progress: &dyn Progress) -> Result<Cameras, WorkbenchError> {
    let target = Target::board(filmed.board.columns, filmed.board.rows, filmed.square)
        .map_err(CamerasError::Camera)?;
    let (left, fitting) = Side::of_board(&filmed.left, filmed, progress)?;
    // Advice alone: where it fails there is none.
    let by_squares = fitting.and_then(|side| side.calibrated(&target, &Options::BOARD).ok());
    let mut sides = vec![left];
    if !filmed.right.is_empty() {
        sides.push(Side::of_board(&filmed.right, filmed, progress)?.0);
    }
    let mut cameras = calibrated(&target, &sides, &Options::BOARD, filmed.unit)?;
    let rms = cameras.left.calibration.rms_px;
    let numbers = by_squares.map(|by| [by.calibration.camera.fx, by.calibration.rms_px]);
    cameras.by_squares = numbers.filter(|&[_, by]| by < rms);
    Ok(cameras)
}

/// Calibrates a camera, or two, by what tracks of projects saw of targets on a plane: frame n of one was taken when that of the
/// other was. Frames in which fewer than four targets are seen are left out.
///
/// Each camera has one focal length, its axis through the middle of the picture and no distortion: a handful of targets tells no
/// more (thesis, eq. 2.1). Of two cameras whose numbers are `known` (with the sizes of their pictures), these are kept, and only
/// how they stand is looked for.
///
/// # Errors
/// [`CamerasError::File`] of a project without tracks of all targets; [`CamerasError::Size`] of one whose pictures are not of the
/// known camera; as [`by_board`].
pub fn by_rig(
    left: &Session,
    right: Option<&Session>,
    rig: &Rig,
    known: Option<[KnownCamera; 2]>,
) -> Result<Cameras, WorkbenchError> {
    let sessions: Vec<&Session> = std::iter::once(left).chain(right).collect();
    let mut sides: Vec<Side> =
        sessions.iter().map(|session| rig::seen(&session.project, rig)).collect::<Result<_, _>>()?;
    sides.iter().try_for_each(Side::shows)?;
    rig::thinned(&mut sides);
    for (side, session) in sides.iter_mut().zip(sessions) {
        rig::refined(side, rig, &session.media)?;
    }
    match (known, sides.as_slice()) {
        (Some(known), [left, right]) => placed(rig, left, right, known),
        _ => calibrated(&rig.target, &sides, &Options::BARS, rig.unit),
    }
}

/// How two cameras stand whose numbers are known.
fn placed(rig: &Rig, left: &Side, right: &Side, known: [KnownCamera; 2]) -> Result<Cameras, WorkbenchError> {
    for (side, (_, wanted)) in [left, right].into_iter().zip(known) {
        if side.size != wanted {
            return Err(CamerasError::Size { wanted, came: side.size }.into());
        }
    }
    let cameras = known.map(|(camera, _)| camera);
    let both = stand(&rig.target, &together(left, right)?, cameras, Options::BARS.loss)
        .map_err(CamerasError::Camera)?;
    let [left, right] = [(left, cameras[0]), (right, cameras[1])].map(|(side, camera)| {
        let (shown, left_out) = side.parted();
        let errors = [0.0; NUMBERS.len()];
        let (rms_px, sigma_px) = (both.rms_px, both.sigma_px);
        let calibration = Calibration { camera, errors, rms_px, sigma_px, views: Vec::new() };
        let shown = shown.into_iter().map(|(name, _)| name).collect();
        Calibrated { calibration, size: side.size, shown, left_out }
    });
    Ok(Cameras { left, right: Some((right, both)), unit: rig.unit, by_squares: None })
}

/// Both cameras, or the one, from what they saw.
fn calibrated(
    target: &Target,
    sides: &[Side],
    options: &Options,
    unit: Option<Unit>,
) -> Result<Cameras, WorkbenchError> {
    let alone = |side: &Side| side.calibrated(target, options);
    let [left, right] = sides else {
        return Ok(Cameras { left: alone(&sides[0])?, right: None, unit, by_squares: None });
    };
    // Each alone first: what is wrong with one is told by the names of its pictures.
    let (left_alone, right_alone) = (alone(left)?, alone(right)?);
    let both = stereo(target, &together(left, right)?, [left.size, right.size], options)
        .map_err(CamerasError::Camera)?;
    Ok(Cameras { left: left_alone, right: Some((right_alone, both)), unit, by_squares: None })
}

/// What each view shows to both: nothing where one of them missed the target.
fn together(left: &Side, right: &Side) -> Result<Vec<[Sighting; 2]>, CamerasError> {
    let (n_left, n_right) = (left.views.len(), right.views.len());
    if n_left != n_right {
        return Err(CamerasError::Pairs { left: n_left, right: n_right });
    }
    let of = |side: &Side, view: usize| side.views[view].seen.clone().unwrap_or_default();
    Ok((0..n_left).map(|view| [of(left, view), of(right, view)]).collect())
}

/// Something of a picture, after the picture's name.
type Named<T> = (String, T);

/// What one camera saw.
struct Side {
    size: [u32; 2],
    views: Vec<View>,
}

/// One picture.
struct View {
    frame: u32,
    name: String,
    /// The target in it, or why it is not there.
    seen: Result<Sighting, String>,
}

impl Side {
    /// The board in pictures, by the windows that were asked for, and by those that fit its squares where these are others.
    fn of_board(
        paths: &[PathBuf],
        filmed: &Filmed,
        progress: &dyn Progress,
    ) -> Result<(Self, Option<Self>), WorkbenchError> {
        let media = opened(paths)?;
        let (n_frames, size) = (media.clip().n_frames(), [media.clip().width, media.clip().height]);
        let mut sides = [(); 2].map(|()| Self { size, views: Vec::with_capacity(n_frames as usize) });
        for n in 0..n_frames {
            if progress.report(u64::from(n), u64::from(n_frames), "picture") == Flow::Stop {
                return Err(WorkbenchError::Stopped);
            }
            let frame = media.frame(n)?;
            let luma = &frame.planes().y;
            let found = find(luma, filmed.board, Window::Squares);
            let asked = found.as_ref().map(|at| refined(luma, at, filmed.board.columns, filmed.window));
            let asked = asked.map_err(Clone::clone);
            for (side, corners) in sides.iter_mut().zip([asked, found]) {
                let seen = corners.map(|at| at.into_iter().map(Pixel::from).enumerate().collect());
                let seen = seen.map_err(|why| why.to_string());
                side.views.push(View { frame: n, name: name(paths, n), seen });
            }
        }
        let [asked, fitting] = sides;
        Ok((asked, (filmed.window != Window::Squares).then_some(fitting)))
    }

    /// Refuses a camera that never saw the target.
    fn shows(&self) -> Result<(), CamerasError> {
        match self.views.first() {
            Some(View { seen: Err(why), .. }) if self.views.iter().all(|view| view.seen.is_err()) => {
                Err(CamerasError::NotShown { n_pictures: self.views.len(), why: why.clone() })
            }
            _ => Ok(()),
        }
    }

    /// Views that show the target, and the others with why they do not, by name.
    fn parted(&self) -> (Vec<Named<Sighting>>, Vec<Named<String>>) {
        let (mut shown, mut left_out) = (Vec::new(), Vec::new());
        for View { name, seen, .. } in &self.views {
            match seen {
                Ok(sighting) => shown.push((name.clone(), sighting.clone())),
                Err(why) => left_out.push((name.clone(), why.clone())),
            }
        }
        (shown, left_out)
    }

    fn calibrated(&self, target: &Target, options: &Options) -> Result<Calibrated, WorkbenchError> {
        let (seen, left_out) = self.parted();
        let (shown, views): (Vec<String>, Vec<Sighting>) = seen.into_iter().unzip();
        self.shows()?;
        let calibration = calibrate(target, &views, self.size, options).map_err(|error| match error {
            // Which of those that show the target it is says its name.
            CameraError::View { view, source } => {
                CamerasError::View { name: shown[view].clone(), source: *source }
            }
            error => CamerasError::Camera(error),
        })?;
        Ok(Calibrated { calibration, size: self.size, shown, left_out })
    }
}

/// Image files as one clip; of a single path whatever it is.
fn opened(paths: &[PathBuf]) -> Result<Media, WorkbenchError> {
    let options = OpenOptions::default();
    Ok(match paths {
        [one] if !one.is_file() || !Still::is_one(one) => honami_media::open(one, &options)?,
        many => honami_media::open_images(many, &options)?,
    })
}

/// A picture's file, or the number of its frame.
fn name(paths: &[PathBuf], n: u32) -> String {
    match paths.get(n as usize) {
        Some(path) if paths.len() > 1 || Still::is_one(path) => path.display().to_string(),
        _ => format!("frame {n}"),
    }
}
