//! Mattes of frames: looked at, found behind the screen, kept.

use std::sync::Arc;
use std::time::Duration;

use honami_workbench::WorkbenchError;
use honami_workbench::matte::{self, MarkSource, MatteRequest, Matted, kept};
use honami_workbench::matting::{Options, Part, PartsWish};

use super::{Facts, World, said, said_wrong};
use crate::app::jobs::{MatteJob, Work};
use crate::app::painting::Plane;
use crate::app::update::{Fact, Hint};

/// A matte of a frame, with what it was found by.
pub(super) type Found = (u32, MatteRequest, Matted);

impl World {
    /// Tells what the project keeps of a frame; nothing where it keeps none of it.
    pub(super) fn look_at_matte(&self, frame: u32) -> Facts {
        let project = &self.session.project;
        match project.document().matte_at(frame).filter(|(of, _)| *of == frame) {
            None => Ok(Vec::new()),
            Some((_, id)) => {
                let matte = project.matte(id)?;
                let (marks, parts) = (kept::marks(&matte)?, kept::parts(&matte)?);
                Ok(vec![Fact::Matte(frame, Arc::new(marks), Arc::new(parts))])
            }
        }
    }

    /// Has a matte found behind the screen.
    pub(super) fn find_matte(
        &mut self,
        (frame, n_strokes): (u32, usize),
        plane: &Plane,
        now: Duration,
    ) -> Facts {
        let request = MatteRequest {
            path: self.session.project.path().to_owned(),
            marks: MarkSource::Painted(plane.marks.to_vec()),
            options: Options::default(),
            parts: PartsWish::default(),
        };
        let still = matte::frame(&self.session.media, frame)?;
        let job = MatteJob { frame, n_strokes, still, request };
        self.start(Work::Matte(Box::new(job)), "the matte", false, now)
    }

    /// The matte was found, or not.
    pub(super) fn found_matte(&mut self, job: MatteJob, found: Result<Matted, WorkbenchError>) -> Facts {
        let found = match found {
            Err(WorkbenchError::Stopped) => {
                return Ok(vec![said("the matte was stopped; nothing was changed".to_owned())]);
            }
            found => found?,
        };
        let n_pixels = found.parts.parts.len().max(1) as f64;
        let kept = 100.0 * found.parts.n_pixels(Part::Kept) as f64 / n_pixels;
        let line = format!("{kept:.1} % of the picture is kept");
        let parts = Arc::new(found.parts.clone());
        self.found = Some((job.frame, job.request, found));
        Ok(vec![Fact::Matted((job.frame, job.n_strokes), parts, line)])
    }

    /// Keeps the matte that was found.
    pub(super) fn keep_matte(&mut self, frame: u32, hint: Hint) -> Facts {
        let Some((of, request, matted)) = self.found.as_ref().filter(|(of, ..)| *of == frame) else {
            return Ok(vec![said_wrong(format!("no matte of frame {frame} was found")), Fact::Refused]);
        };
        kept::keep(&mut self.session.project, &[(*of, request, matted)])?;
        self.found = None;
        self.shown_and(said(format!("matte of frame {frame} kept: t r finds features inside it ({hint})")))
    }
}
