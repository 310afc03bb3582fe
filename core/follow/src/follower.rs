//! Points from frame to frame: a tracker made of whatever says where points of one frame are in the next.

use std::collections::BTreeMap;

use honami_plugin::{
    Cx, DetectFn, Error, FieldFn, Frame, Info, Params, Point, Points, Result, Seed, State, Status, Stream,
    Tracker,
};
use honami_vision::field::Drift;
use honami_vision::ncc::Ncc;
use honami_vision::saved::SavedPicture;
use honami_vision::{Gray, Point as Place, work};

use serde::{Deserialize, Serialize};

use crate::{Detection, Losing, check_size, from_bytes, picture, to_bytes};

/// Says where points of one frame are in the next; the parameters of the plugin are its fields.
pub trait Method: Params + Clone {
    /// Id, name and description.
    const INFO: Info;
    /// Dense motion between two frames, if the method measures that.
    const FIELD: Option<FieldFn<Self>> = None;
    /// What is kept of a frame until the next: a pyramid, say.
    type Kept: Send + 'static;

    /// Prepares a frame; `spare` is what was kept of one that nobody needs any more, whose memory may be used.
    fn keep(&self, picture: &Gray<'_>, spare: Option<Self::Kept>, n_threads: usize) -> Self::Kept;

    /// The picture that was kept.
    fn kept(kept: &Self::Kept) -> Gray<'_>;

    /// Follows points from one frame to the next: one step a point, in order.
    ///
    /// # Errors
    /// When the user wants to stop, who is asked at least every 50 ms.
    fn follow(
        &self,
        frames: [&Self::Kept; 2],
        from: &[Place],
        n_threads: usize,
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>>;

    /// How far samples are to be trusted.
    fn trust(&self) -> Trust<'_>;

    /// Which corners are features.
    fn detection(&self) -> &Detection;
}

/// How the quality of samples is measured.
#[derive(Clone, Copy, Debug)]
pub struct Trust<'a> {
    /// Radius of the windows that are correlated, pixels.
    pub radius_px: u32,
    /// From which quality on a point is lost.
    pub losing: &'a Losing,
}

/// Where a point went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Where it is in the new frame.
    pub to: Drift,
    /// Where the way back from there ends; `None` where it was not measured, or lost.
    pub home: Option<Place>,
}

impl Step {
    /// Moves the row of a point that is tracked, or says what became of it.
    fn carry(&self, row: &mut Point, [before, now]: &[Gray<'_>; 2], losing: &Losing, ncc: &mut Ncc) {
        let at = [row.x, row.y];
        let to = match self.to {
            Drift::To(to) => to,
            Drift::Outside => return row.status = Status::Outside,
            Drift::Unknown => return row.status = Status::Lost,
        };
        row.fb = self.home.map(|home| (home[0] - at[0]).hypot(home[1] - at[1]));
        row.ncc = ncc.compare(before, at, now, to);
        if losing.loses(row.fb, row.ncc) {
            row.status = Status::Lost;
        } else {
            [row.x, row.y] = to;
        }
    }
}

/// The tracker of a method.
///
/// A point goes on while the method finds it; else it is lost, or outside, and stays where it was seen last until it is
/// seeded again.
pub struct Follower<M: Method> {
    method: M,
    n_threads: usize,
    ncc: Ncc,
    last: Option<M::Kept>,
    spare: Option<M::Kept>,
    points: BTreeMap<u32, Live>,
}

/// A point that has not been retired.
#[derive(Clone, Copy, Debug)]
struct Live {
    at: Place,
    status: Status,
}

/// What later frames depend on.
#[derive(Serialize, Deserialize)]
struct Carried {
    last: Option<SavedPicture>,
    points: Vec<(u32, Place, u8)>,
}

impl<M: Method> Follower<M> {
    fn save(&self) -> Result<Vec<u8>> {
        let last = self.last.as_ref().map(|last| SavedPicture::of(&M::kept(last)));
        let points = self.points.iter().map(|(&id, point)| (id, point.at, point.status as u8)).collect();
        to_bytes(&Carried { last, points })
    }

    fn load(method: &M, stream: &Stream, bytes: &[u8]) -> Result<Self> {
        let carried: Carried = from_bytes(bytes)?;
        let mut tracker = Self::new(method, stream);
        if let Some(last) = carried.last {
            let picture = last.gray().ok_or_else(|| Error::data("its picture is not whole"))?;
            tracker.last = Some(method.keep(&picture, None, tracker.n_threads));
        }
        for (id, at, status) in carried.points {
            tracker.points.insert(id, Live { at, status: Status::try_from(status)? });
        }
        Ok(tracker)
    }

    fn new(method: &M, stream: &Stream) -> Self {
        Self {
            method: method.clone(),
            n_threads: stream.max_threads as usize,
            ncc: Ncc::new(method.trust().radius_px),
            last: None,
            spare: None,
            points: BTreeMap::new(),
        }
    }
}

impl<M: Method> Tracker for Follower<M> {
    type Params = M;
    const INFO: Info = M::INFO;
    const DETECT: Option<DetectFn<M>> = Some(|method, wanted, _| method.detection().features(wanted));
    const FIELD: Option<FieldFn<M>> = M::FIELD;
    const STATE: Option<State<Self>> = Some(State { version: 1, save: Self::save, load: Self::load });

    fn begin(method: &M, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self::new(method, stream))
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
        let now = self.method.keep(&picture(frame), self.spare.take(), self.n_threads);
        let tracked = self.points.values().filter(|point| point.status == Status::Tracked);
        let from: Vec<_> = tracked.map(|point| point.at).collect();
        // In the first frame points are where they were seeded; and where there are none, nothing is measured.
        let followed = self.last.as_ref().filter(|_| !from.is_empty());
        let steps = followed.map(|last| self.method.follow([last, &now], &from, self.n_threads, cx));
        let mut steps = steps.transpose()?.unwrap_or_default().into_iter();
        let pictures = [self.last.as_ref().unwrap_or(&now), &now].map(M::kept);
        let a_look = work::a_look(self.ncc.cost_ns());
        for (k, (&id, point)) in self.points.iter_mut().enumerate() {
            if k % a_look == 0 {
                cx.progress(1.0, "comparing windows")?;
            }
            let mut row = Point::new(id, point.at[0], point.at[1], point.status);
            if row.status == Status::Tracked
                && let Some(step) = steps.next()
            {
                step.carry(&mut row, &pictures, self.method.trust().losing, &mut self.ncc);
                *point = Live { at: [row.x, row.y], status: row.status };
            }
            out.add(row);
        }
        self.spare = self.last.replace(now);
        Ok(())
    }
}
