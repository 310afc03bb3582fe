//! What becomes of a run whose tracker has died: another one goes on from what it carried, or from where points were seen.

use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Instant;

use honami_host::{CallContext, Checkpoint, HostError, Point, Tracker};
use honami_model::track::TrackId;
use honami_store::Seam;

use super::{Death, MAX_DEATHS, Numbers, Relay, Ride, Seed, due, is_inside, view};
use crate::error::WorkbenchError;

/// A tracker is not asked what it carries before it has worked so many times as long as its last answer took.
const WORK_PER_SAVE: f64 = 100.0;

/// What a tracker carried, the last time that it was asked.
#[derive(Clone, Default)]
pub(super) struct Saved {
    kept: Option<(u32, Checkpoint)>,
    /// The points that it was given since, by frame.
    given: BTreeMap<u32, Vec<Point>>,
    /// Seconds that it has worked since.
    worked: f64,
    /// Seconds that saving took.
    cost: f64,
    /// Whether it was asked and has not answered: it has died of it, or meanwhile.
    is_asked: bool,
    /// Whether it is not asked any more.
    is_off: bool,
}

impl Saved {
    pub(super) fn worked(&mut self, seconds: f64) {
        self.worked += seconds;
    }

    /// Notes the points that a tracker is given in a frame, as long as they will be needed for another one.
    pub(super) fn give(&mut self, frame: u32, points: &[Point]) {
        if self.kept.is_some() {
            self.given.insert(frame, points.to_vec());
        }
    }

    pub(super) fn given(&self, frame: u32) -> Option<&Vec<Point>> {
        self.given.get(&frame)
    }

    /// From here on only where points were seen is known.
    pub(super) fn forget(&mut self) {
        self.kept = None;
    }

    /// Whether the tracker is to be asked: once at its beginning, which tells what it costs; then one hundredth of the time.
    fn is_due(&self, tracker: &Tracker) -> bool {
        !self.is_off
            && tracker.can_end()
            && tracker.can_save()
            && (self.kept.is_none() || self.worked >= WORK_PER_SAVE * self.cost)
    }

    fn save(&mut self, tracker: &mut Tracker, next: u32, call: &CallContext<'_>) -> Result<(), HostError> {
        let begun = Instant::now();
        if std::mem::replace(&mut self.is_asked, true) {
            self.give_up();
            return Ok(());
        }
        match tracker.save(call) {
            Ok(checkpoint) => {
                *self = Self {
                    kept: Some((next, checkpoint)),
                    cost: begun.elapsed().as_secs_f64(),
                    ..Self::default()
                };
                Ok(())
            }
            Err(HostError::Failed { .. }) => {
                self.give_up();
                Ok(())
            }
            Err(error) => Err(error),
        }
    }

    /// What it carried is too long ago soon.
    fn give_up(&mut self) {
        self.is_off = true;
        self.forget();
    }

    /// Gives a new tracker what the last one carried; the frame that comes next, if it takes it.
    fn load(&mut self, tracker: &mut Tracker, call: &CallContext<'_>) -> Result<Option<u32>, HostError> {
        let Some((next, checkpoint)) = self.kept.as_ref().filter(|_| tracker.can_save()) else {
            return Ok(None);
        };
        match tracker.load(checkpoint, call) {
            Ok(()) => Ok(Some(*next)),
            // Another build, say.
            Err(HostError::Failed { .. }) => {
                self.forget();
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}

impl Ride<'_> {
    /// Before a frame: asks the tracker what it carries, when it is time.
    pub(super) fn keep(&mut self, next: u32, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        if next > self.plan.frames.start && self.saved.is_due(self.tracker) {
            self.saved.save(self.tracker, next, call)?;
        }
        Ok(())
    }

    /// Lets other trackers do a frame in which the tracker has died.
    pub(super) fn revive(
        &mut self,
        frame: u32,
        mut outcome: Result<(), WorkbenchError>,
        relay: &mut dyn Relay,
        numbers: Numbers<'_>,
    ) -> Result<(), WorkbenchError> {
        let (Range { start, end }, ear) = (self.plan.frames.clone(), self.ear);
        let (done, total) = (u64::from(frame - start), u64::from(end - start));
        let mut death = Death::First;
        for n_deaths in 1..=MAX_DEATHS {
            let Err(WorkbenchError::Plugin(error)) = &outcome else { break };
            let Some(why) = error.end() else { break };
            let seam = Seam { frame: self.board.end, why, build: None };
            if n_deaths == MAX_DEATHS {
                // What it carried may be what it dies of.
                self.saved.forget();
            }
            let died_in = match error {
                HostError::Ended { frame: Some(frame), .. } => u32::try_from(*frame).unwrap_or_default(),
                _ => frame,
            };
            let another = relay.again(&seam, death);
            let is_left_out = frame > start && matches!(another, Ok((_, Death::Again)));
            let then = if is_left_out {
                format!("started again, and frame {frame} is left out")
            } else {
                format!("started again at frame {}", seam.frame)
            };
            ear.died(died_in, &seam.why, another.is_ok().then_some(&then));
            (*self.tracker, death) = another?;
            self.tracker.pardon(true);
            outcome = ear.call(done, total, |call| self.resume(frame, death, numbers, call));
            self.tracker.pardon(false);
            if is_left_out && outcome.is_ok() {
                ear.warn(format!(
                    "frame {frame} is left out: it died there twice, and every point is lost in it"
                ));
            }
            death = Death::Again;
            if outcome.is_err() && ear.is_told_to_stop(done, total) {
                return Err(WorkbenchError::Stopped);
            }
        }
        outcome
    }

    /// Gives a new tracker what the one before carried or had seen, and goes on with it up to a frame, which is the next.
    pub(super) fn rejoin(
        &mut self,
        next: u32,
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<(), WorkbenchError> {
        let (unanswered, seen_in) = self.board.back();
        self.begin(call)?;
        let first = match self.saved.load(self.tracker, call)? {
            Some(next) => next,
            None => {
                self.go_on_from(seen_in, call)?;
                unanswered
            }
        };
        for frame in first..next {
            if self.board.is_lost(frame) {
                self.pass_over(frame, call)?;
            } else {
                self.step(frame, numbers, call)?;
            }
        }
        Ok(())
    }

    /// Goes on with a new tracker where the one before died in frame `fatal`, with that frame or, when that is fatal
    /// again, after it.
    fn resume(
        &mut self,
        fatal: u32,
        death: Death,
        numbers: Numbers<'_>,
        call: &CallContext<'_>,
    ) -> Result<(), WorkbenchError> {
        self.rejoin(fatal, numbers, call)?;
        if death == Death::Again && fatal > self.plan.frames.start {
            self.board.lose(fatal);
            return self.pass_over(fatal, call);
        }
        self.step(fatal, numbers, call)
    }

    /// Gives a new tracker the points where they were last; those that had left the picture are gone.
    fn go_on_from(&mut self, seen_in: Option<u32>, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        // Its own points of before are features like any other now.
        self.born.clear();
        if let Some(seen_in) = seen_in {
            let picture = self.media.frame(seen_in)?;
            let clip = self.media.clip();
            let is_there =
                |p: &Point| is_inside(&Seed { frame: seen_in, track: TrackId(p.id), x: p.x, y: p.y }, clip);
            let live: Vec<Point> = self.board.live().filter(is_there).collect();
            self.tracker.seed(&live, call)?;
            // Where they are there is known already.
            self.tracker.push(&view(self.media, &picture, seen_in), call)?;
        }
        Ok(())
    }

    /// Leaves a frame out. What begins there begins all the same, a frame early for the tracker.
    fn pass_over(&mut self, frame: u32, call: &CallContext<'_>) -> Result<(), WorkbenchError> {
        let given = self.saved.given(frame).cloned();
        let new: Vec<Point> = given.unwrap_or_else(|| due(&self.plan.seeds, frame).collect());
        self.saved.give(frame, &new);
        if !new.is_empty() {
            self.tracker.seed(&new, call)?;
            self.board.place(frame, &new);
        }
        Ok(())
    }
}
