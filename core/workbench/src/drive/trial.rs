//! A rebuilt tracker on trial: the one before waits in its stream, and goes on there when the new one fails.

use std::collections::BTreeMap;

use honami_host::{CallContext, HostError, Tracker};

use super::{Board, Numbers, Relay, Ride, Saved};
use crate::error::WorkbenchError;

/// So many frames a rebuilt tracker has to do before the one before is let go.
const TRIAL: u32 = 10;

/// A drive as it was when a rebuilt tracker took over.
pub(super) struct Before {
    tracker: Tracker,
    board: Board,
    born: BTreeMap<u32, u32>,
    saved: Saved,
    n_steps: usize,
    /// The first frame that it has not been given.
    frame: u32,
}

impl Ride<'_> {
    /// Lets a rebuilt tracker go on from this frame, where there is one that sees all features in the frame before.
    pub(super) fn relieve(
        &mut self,
        frame: u32,
        relay: &mut dyn Relay,
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<(), WorkbenchError> {
        let Some(rebuilt) = self.before.is_none().then(|| relay.rebuilt()).flatten() else { return Ok(()) };
        let before = Before {
            tracker: std::mem::replace(self.tracker, rebuilt),
            board: self.board.clone(),
            born: self.born.clone(),
            saved: self.saved.clone(),
            n_steps: self.step_secs.len(),
            frame,
        };
        match self.rejoin(frame, numbers, call) {
            Ok(()) => {
                self.before = Some(before);
                relay.taken(self.board.end)
            }
            Err(error) => {
                self.restore(before);
                match error {
                    WorkbenchError::Plugin(error) if !is_stop(&error) => {
                        relay.refused(&error);
                        Ok(())
                    }
                    error => Err(error),
                }
            }
        }
    }

    /// Goes back to the tracker before when the rebuilt one has failed on trial; the frame to go on with then.
    pub(super) fn give_up(
        &mut self,
        outcome: &mut Result<(), WorkbenchError>,
        relay: &mut dyn Relay,
    ) -> Result<Option<u32>, WorkbenchError> {
        let Err(WorkbenchError::Plugin(error)) = &*outcome else { return Ok(None) };
        let Some(before) = self.before.take_if(|_| !is_stop(error)) else { return Ok(None) };
        let frame = self.restore(before);
        relay.given_up(self.board.end, &error.to_string())?;
        *outcome = Ok(());
        Ok(Some(frame))
    }

    /// Gives a trial up that was stopped: only what the tracker before has done is kept.
    pub(super) fn stop(&mut self, relay: Option<&mut dyn Relay>) -> Result<(), WorkbenchError> {
        let Some((before, relay)) = self.before.take().zip(relay) else { return Ok(()) };
        self.restore(before);
        relay.given_up(self.board.end, "the run was stopped while it was on trial")
    }

    /// Ends the trial of a tracker that has done its frames, this one the last.
    pub(super) fn settle(&mut self, frame: u32, relay: &mut dyn Relay) {
        if self.before.take_if(|before| frame + 1 >= before.frame + TRIAL).is_some() {
            relay.proved();
        }
    }

    fn restore(&mut self, before: Before) -> u32 {
        *self.tracker = before.tracker;
        (self.board, self.born, self.saved) = (before.board, before.born, before.saved);
        self.step_secs.truncate(before.n_steps);
        before.frame
    }
}

fn is_stop(error: &HostError) -> bool {
    matches!(error, HostError::Cancelled { .. })
}
