//! Dense motion of the shown frames, measured behind the screen and kept for a while.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use honami_workbench::WorkbenchError;
use honami_workbench::dense::DenseMeter;
use honami_workbench::overlay::VelocityField;

use super::behind::Behind;
use crate::term::signals::Waker;

/// Fields that are kept: those of a loop of ±8 frames, several times over.
const KEPT: usize = 64;
/// While the picture moves, the field of a frame so near stands in for one that is not measured yet.
const NEAR: u32 = 3;

/// Dense motion instead of that of the tracks: which tracker measures it, and the field that is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    /// Short name of the tracker.
    pub plugin: String,
    /// The field, and its frame; `None` while it is being measured.
    pub field: Option<FieldOf>,
}

/// A frame and its field.
pub type FieldOf = (u32, Arc<VelocityField>);

/// The tracker at work, and what it has measured.
pub(super) struct Measuring {
    meter: Arc<Mutex<DenseMeter>>,
    behind: Behind<(u32, Result<VelocityField, WorkbenchError>)>,
    asked: Option<u32>,
    /// The newest last.
    kept: VecDeque<FieldOf>,
}

impl Measuring {
    pub(super) fn new(meter: DenseMeter, waker: Waker) -> Self {
        let meter = Arc::new(Mutex::new(meter));
        Self { meter, behind: Behind::new("dense motion", waker), asked: None, kept: VecDeque::new() }
    }

    /// The field of a frame, or in a moving picture one near it. One that is missing is measured once the frames that
    /// it needs, all before `n_ready`, are decoded.
    pub(super) fn look(
        &mut self,
        frame: u32,
        is_moving: bool,
        n_ready: u32,
        n_frames: u32,
    ) -> anyhow::Result<Option<FieldOf>> {
        if let Some((frame, field)) = self.behind.news()? {
            self.asked = self.asked.filter(|asked| *asked != frame);
            self.kept.push_back((frame, Arc::new(field?)));
            self.kept.drain(..self.kept.len().saturating_sub(KEPT));
        }
        let near = self.kept.iter().min_by_key(|(of, _)| of.abs_diff(frame)).cloned();
        let apart = near.as_ref().map(|(of, _)| of.abs_diff(frame));
        let is_ready = (frame + 2).min(n_frames) <= n_ready;
        if apart != Some(0) && is_ready && self.asked.replace(frame) != Some(frame) {
            self.ask(frame)?;
        }
        Ok(near.filter(|_| apart <= Some(if is_moving { NEAR } else { 0 })))
    }

    fn ask(&mut self, frame: u32) -> std::io::Result<()> {
        let meter = Arc::clone(&self.meter);
        let measure = move || {
            let mut meter = meter.lock().unwrap_or_else(PoisonError::into_inner);
            (frame, meter.measure(frame))
        };
        self.behind.ask(measure)
    }
}
