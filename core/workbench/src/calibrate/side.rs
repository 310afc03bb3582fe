//! What a camera saw of a target: the pictures that show it, and why the others do not.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use honami_cameras::{Calibration, Pixel, Sighting};
use honami_media::{Media, OpenOptions, Still};
use honami_vision::board::{Window, find, refined};

use super::{Calibrated, Filmed, chosen};
use crate::error::{CamerasError, WorkbenchError};
use crate::progress::{Flow, Progress};

/// Refuses two cameras that did not take as many pictures.
pub(super) fn paired(left: &Side, right: &Side) -> Result<(), CamerasError> {
    let (n_left, n_right) = (left.views.len(), right.views.len());
    if n_left == n_right { Ok(()) } else { Err(CamerasError::Pairs { left: n_left, right: n_right }) }
}

/// What each view shows to both, who have as many: nothing where one of them missed the target.
pub(super) fn together(left: &Side, right: &Side) -> Vec<[Sighting; 2]> {
    let of = |view: &View| view.seen.clone().unwrap_or_default();
    left.views.iter().zip(&right.views).map(|(left, right)| [of(left), of(right)]).collect()
}

/// Something of a picture, after the picture's name.
type Named<T> = (String, T);

/// What one camera saw.
pub(super) struct Side {
    pub(super) size: [u32; 2],
    /// Its pictures; those alone that are fitted, once they are chosen.
    pub(super) views: Vec<View>,
    /// Pictures that show the target, fitted or not.
    pub(super) n_shown: usize,
    /// Names of the others, and why they do not.
    pub(super) left_out: Vec<Named<String>>,
    pub(super) middles: Option<[usize; 2]>,
    pub(super) source: Source,
}

/// Where pictures come from: their names, or their project's, and their hash.
pub(super) struct Source {
    pub(super) name: String,
    pub(super) sha256: String,
    /// Of a project's tracks.
    pub(super) revision: Option<u32>,
}

/// One picture.
pub(super) struct View {
    pub(super) frame: u32,
    pub(super) name: String,
    /// The target in it, or why it is not there.
    pub(super) seen: Result<Sighting, String>,
}

impl Side {
    pub(super) fn new(size: [u32; 2], views: Vec<View>, source: Source) -> Self {
        let why = |view: &View| Some((view.name.clone(), view.seen.as_ref().err()?.clone()));
        let left_out: Vec<_> = views.iter().filter_map(why).collect();
        Self { size, n_shown: views.len() - left_out.len(), views, left_out, middles: None, source }
    }

    /// The board in pictures, by the windows that were asked for, and by those that fit its squares where these are others.
    pub(super) fn of_board(
        paths: &[PathBuf],
        filmed: &Filmed,
        progress: &dyn Progress,
    ) -> Result<(Self, Option<Self>), WorkbenchError> {
        let media = opened(paths)?;
        let (n_frames, size) = (media.clip().n_frames(), [media.clip().width, media.clip().height]);
        let mut both = [(); 2].map(|()| Vec::with_capacity(n_frames as usize));
        for n in 0..n_frames {
            if progress.report(u64::from(n), u64::from(n_frames), "picture") == Flow::Stop {
                return Err(WorkbenchError::Stopped);
            }
            let frame = media.frame(n)?;
            let luma = &frame.planes().y;
            let found = find(luma, filmed.board, Window::Squares);
            let asked = found.as_ref().map(|at| refined(luma, at, filmed.board.columns, filmed.window));
            let asked = asked.map_err(Clone::clone);
            for (views, corners) in both.iter_mut().zip([asked, found]) {
                let seen = corners.map(|at| at.into_iter().map(Pixel::from).enumerate().collect());
                let seen = seen.map_err(|why| why.to_string());
                views.push(View { frame: n, name: name(paths, n), seen });
            }
        }
        let names: Vec<String> = paths.iter().map(|path| file_name(path)).collect();
        let side = |views: Vec<View>| {
            let source = Source { name: names.join(", "), sha256: media.sha256(), revision: None };
            Self::new(size, views, source)
        };
        let [asked, fitting] = both;
        Ok((side(asked), (filmed.window != Window::Squares).then(|| side(fitting))))
    }

    /// Where some points of the target are in a view, parts of the picture's width.
    pub(super) fn stand(&self, view: usize, points: [usize; 4]) -> chosen::Stand {
        let seen = self.views[view].seen.as_ref().ok()?;
        Some(points.map(|point| seen[point].1 / f64::from(self.size[0])))
    }

    /// Goes on with these views alone.
    pub(super) fn keep(&mut self, frames: &BTreeSet<usize>) {
        self.views.retain(|view| frames.contains(&(view.frame as usize)));
    }

    /// Refuses a camera that never saw the target.
    pub(super) fn shows(&self) -> Result<(), CamerasError> {
        match self.left_out.first() {
            Some((_, why)) if self.n_shown == 0 => {
                Err(CamerasError::NotShown { n_pictures: self.left_out.len(), why: why.clone() })
            }
            _ => Ok(()),
        }
    }

    /// Views that show the target, by name.
    pub(super) fn shown(&self) -> impl Iterator<Item = (&String, &Sighting)> {
        self.views.iter().filter_map(|view| Some((&view.name, view.seen.as_ref().ok()?)))
    }

    /// The camera of this side, fitted to these views.
    pub(super) fn with(&self, calibration: Calibration, shown: Vec<String>) -> Calibrated {
        let (size, n_shown, middles) = (self.size, self.n_shown, self.middles);
        Calibrated { calibration, size, shown, n_shown, left_out: self.left_out.clone(), middles }
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

/// The last part of a path.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A picture's file, or the number of its frame.
fn name(paths: &[PathBuf], n: u32) -> String {
    match paths.get(n as usize) {
        Some(path) if paths.len() > 1 || Still::is_one(path) => file_name(path),
        _ => format!("frame {n}"),
    }
}
