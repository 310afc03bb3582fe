//! Points that follow dense motion: a tracker made of whatever measures that motion.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use honami_plugin::{
    Cx, Detect, DetectFn, Error, Feature, FieldFn, Frame, Info, Params, Point, Points, Result, Seed, Status,
    Stream, Tracker,
};
use honami_vision::field::{Drift, Field};
use honami_vision::ncc::Ncc;
use honami_vision::{Gray, Point as Place};

use crate::{Detection, Losing, check_size, dense, picture};

/// Measures dense motion; the parameters of the plugin are its fields.
pub trait Motion: Params + Clone {
    /// Id, name and description.
    const INFO: Info;
    /// What is kept of a frame until the next: the picture, and a pyramid of it, say.
    type Kept: Send + 'static;

    /// Prepares a frame.
    fn keep(&self, picture: &Gray<'_>, n_threads: usize) -> Self::Kept;

    /// The picture that was kept.
    fn kept(kept: &Self::Kept) -> Gray<'_>;

    /// Displacements from one picture to another of the same size; `None` where `go_on` said no.
    ///
    /// `go_on` is told the share of the work that is done, 0..=1, at least every 50 ms.
    fn measure(
        &self,
        from: &Self::Kept,
        to: &Self::Kept,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<Field>;

    /// How far samples are to be trusted.
    fn trust(&self) -> Trust<'_>;

    /// Which corners are features.
    fn detection(&self) -> &Detection;
}

/// How the quality of samples is measured.
#[derive(Clone, Copy, Debug)]
pub struct Trust<'a> {
    /// Whether motion is measured back, too: that gives the forward-backward error, at twice the time.
    pub backward: bool,
    /// Radius of the windows that are correlated, pixels.
    pub radius_px: u32,
    /// From which quality on a point is lost.
    pub losing: &'a Losing,
}

/// Follows points through the dense motion that `M` measures (J. Diener's thesis, 2.4.4).
///
/// A point goes on while the motion around it is known; else it is lost, or outside, and stays where it was seen last
/// until it is seeded again.
pub struct Particles<M: Motion> {
    motion: M,
    n_threads: usize,
    ncc: Ncc,
    last: Option<M::Kept>,
    points: BTreeMap<u32, Live>,
}

/// A point that has not been retired.
#[derive(Clone, Copy, Debug)]
struct Live {
    at: Place,
    status: Status,
}

impl<M: Motion> Tracker for Particles<M> {
    type Params = M;
    const INFO: Info = M::INFO;
    const DETECT: Option<DetectFn<M>> = Some(features::<M>);
    const FIELD: Option<FieldFn<M>> = Some(field::<M>);

    fn begin(motion: &M, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self {
            motion: motion.clone(),
            n_threads: stream.max_threads as usize,
            ncc: Ncc::new(motion.trust().radius_px),
            last: None,
            points: BTreeMap::new(),
        })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        self.points.extend(seeds.iter().map(|s| (s.id, Live { at: [s.x, s.y], status: Status::Tracked })));
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        for id in ids {
            self.points.remove(id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        if let Some(last) = &self.last {
            let before = M::kept(last);
            check_size(frame, (before.width, before.height))?;
        }
        let now = self.motion.keep(&picture(frame), self.n_threads);
        let followed = self.points.values().any(|point| point.status == Status::Tracked);
        // Where there is nobody to follow it, motion is not measured.
        let step = match &self.last {
            Some(last) if followed => Some(Step::measure(&self.motion, last, &now, self.n_threads, cx)?),
            _ => None,
        };
        for (i, (&id, point)) in self.points.iter_mut().enumerate() {
            if i % POINTS_A_BREATH == 0 {
                cx.progress(1.0, "following points")?;
            }
            let mut row = Point::new(id, point.at[0], point.at[1], point.status);
            if let Some(step) = step.as_ref().filter(|_| point.status == Status::Tracked) {
                step.carry(&mut row, self.motion.trust().losing, &mut self.ncc);
                *point = Live { at: [row.x, row.y], status: row.status };
            }
            out.add(row);
        }
        self.last = Some(now);
        Ok(())
    }
}

/// So many points take a few milliseconds.
const POINTS_A_BREATH: usize = 1000;

/// The motion from one frame to the next, and what is needed to judge it.
struct Step<'a> {
    before: Gray<'a>,
    after: Gray<'a>,
    there: Field,
    back: Option<Field>,
}

impl<'a> Step<'a> {
    fn measure<M: Motion>(
        motion: &M,
        last: &'a M::Kept,
        now: &'a M::Kept,
        n_threads: usize,
        cx: &Cx<'_>,
    ) -> Result<Self> {
        let Trust { backward, losing, .. } = motion.trust();
        // A limit wants to know what it limits.
        let backward = backward || losing.lose_fb > 0.0;
        let share = if backward { 0.5 } else { 1.0 };
        let pass = |first: f64, from, to| {
            let go_on = |done: f64| cx.progress(first + share * done, MEASURING).is_ok();
            motion.measure(from, to, n_threads, &go_on).ok_or_else(Error::cancelled)
        };
        let there = pass(0.0, last, now)?;
        let back = backward.then(|| pass(0.5, now, last)).transpose()?;
        Ok(Self { before: M::kept(last), after: M::kept(now), there, back })
    }

    /// Moves a point that is tracked, or says what became of it.
    fn carry(&self, row: &mut Point, losing: &Losing, ncc: &mut Ncc) {
        let at = [row.x, row.y];
        let to = match self.there.follow(at, self.before.width, self.before.height) {
            Drift::To(to) => to,
            Drift::Outside => return row.status = Status::Outside,
            Drift::Unknown => return row.status = Status::Lost,
        };
        let home = self.back.as_ref().and_then(|back| back.at(to));
        row.fb = home.map(|d| (to[0] + d[0] - at[0]).hypot(to[1] + d[1] - at[1]));
        row.ncc = ncc.compare(&self.before, at, &self.after, to);
        if losing.loses(row.fb, row.ncc) {
            row.status = Status::Lost;
        } else {
            [row.x, row.y] = to;
        }
    }
}

const MEASURING: &str = "measuring motion";

fn features<M: Motion>(motion: &M, wanted: &Detect<'_>, _: &Cx<'_>) -> Result<Vec<Feature>> {
    motion.detection().features(wanted)
}

/// Displacements between two frames as the host takes them.
fn field<M: Motion>(
    motion: &M,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<honami_plugin::Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let n_threads = max_threads as usize;
    let [from, to] = [from, to].map(|frame| motion.keep(&picture(frame), n_threads));
    let go_on = |done: f64| cx.progress(done, MEASURING).is_ok();
    let field = motion.measure(&from, &to, n_threads, &go_on).ok_or_else(Error::cancelled)?;
    Ok(dense(field.grid, field.vectors()))
}
