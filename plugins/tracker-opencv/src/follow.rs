//! What all methods share: the points, their rows, and what is measured of each step.

use std::collections::BTreeMap;
use std::num::NonZero;

use honami_follow::{Losing, check_size, picture};
use honami_plugin::{
    Cx, DetectFn, FieldFn, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker,
};
use honami_vision::ncc::Ncc;
use opencv::core::{self, Mat};

use crate::picture::Picture;
use crate::settings::Shared;

/// Points whose windows are compared between two looks for a cancel.
const POINTS_A_LOOK: usize = 2000;

/// Where a point went in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Position in the new frame; means nothing where it was not found.
    pub(crate) to: honami_vision::Point,
    /// Whether it was found.
    pub(crate) is_found: bool,
    /// Distance between where it started and where the way there and back ends, pixels, if measured.
    pub(crate) fb: Option<f32>,
}

impl Step {
    pub(crate) const LOST: Self = Self { to: [0.0; 2], is_found: false, fb: None };

    /// What became of the point, once its quality is known.
    fn status(&self, is_inside: bool, row: &Point, losing: &Losing) -> Status {
        match (self.is_found, is_inside) {
            (false, _) => Status::Lost,
            (true, false) => Status::Outside,
            (true, true) if losing.loses(row.fb, row.ncc) => Status::Lost,
            (true, true) => Status::Tracked,
        }
    }
}

/// A way of following points from one frame to the next.
pub(crate) trait Method: Sized + Send + 'static {
    type Params: Shared;
    const INFO: Info;
    /// Dense motion, where the method measures that.
    const FIELD: Option<FieldFn<Self::Params>> = None;
    /// Whether a point that was lost is looked for again.
    const RETURNS: bool = false;
    /// Whether OpenCV gives the same bits on any number of threads.
    const SCALES: bool;

    fn begin(params: &Self::Params) -> Result<Self>;

    /// Follows points, given by id and position in the frame before; one step a point, in order.
    ///
    /// Called for every frame but the first, so that the frame before is always `now` of the last call.
    fn follow(
        &mut self,
        before: &Mat,
        now: &Mat,
        from: &[(u32, honami_vision::Point)],
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>>;

    /// A point is gone, or is somewhere else: drops what is known of it.
    fn forget(&mut self, _: u32) {}
}

/// A method as a tracker.
pub(crate) struct Follower<M: Method> {
    method: M,
    params: M::Params,
    n_threads: u32,
    last: Option<Picture>,
    points: BTreeMap<u32, Live>,
    ncc: Ncc,
}

/// A point that has not been retired.
#[derive(Clone, Copy)]
struct Live {
    at: honami_vision::Point,
    status: Status,
}

impl<M: Method> Tracker for Follower<M> {
    type Params = M::Params;
    const INFO: Info = Info { parallel_instances: false, ..M::INFO };
    const DETECT: Option<DetectFn<M::Params>> = Some(|params, wanted, _| params.detection().features(wanted));
    const FIELD: Option<FieldFn<M::Params>> = M::FIELD;

    fn begin(params: &M::Params, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self {
            method: M::begin(params)?,
            params: params.clone(),
            n_threads: if M::SCALES { stream.max_threads } else { 1 },
            last: None,
            points: BTreeMap::new(),
            ncc: Ncc::new(params.ncc_radius_px()),
        })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        for seed in seeds {
            self.method.forget(seed.id);
            self.points.insert(seed.id, Live { at: [seed.x, seed.y], status: Status::Tracked });
        }
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        for &id in ids {
            self.method.forget(id);
            self.points.remove(&id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        if let Some(last) = &self.last {
            check_size(frame, last.size())?;
        }
        let now = Picture::copy(&picture(frame))?;
        match self.last.take() {
            None => {
                self.points.iter().for_each(|(&id, p)| out.add(Point::new(id, p.at[0], p.at[1], p.status)))
            }
            Some(last) => self.step(&last, &now, out, cx)?,
        }
        self.last = Some(now);
        Ok(())
    }
}

impl<M: Method> Follower<M> {
    /// Adds a row for every point, in the order of their ids.
    fn step(&mut self, last: &Picture, now: &Picture, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        for point in self.points.values_mut().filter(|p| !is_inside(p.at, now.size())) {
            point.status = Status::Outside;
        }
        let wanted = |p: &Live| p.status == Status::Tracked || (M::RETURNS && p.status == Status::Lost);
        let from: Vec<_> = self.points.iter().filter(|(_, p)| wanted(p)).map(|(&id, p)| (id, p.at)).collect();
        set_threads(self.n_threads)?;
        let steps = self.method.follow(&last.mat, &now.mat, &from, cx)?;
        let (before, after) = (last.gray()?, now.gray()?);
        let mut steps = steps.into_iter();
        for (k, (&id, point)) in self.points.iter_mut().enumerate() {
            if k % POINTS_A_LOOK == 0 {
                cx.progress(1.0, "comparing windows")?;
            }
            let mut row = Point::new(id, point.at[0], point.at[1], point.status);
            if wanted(point)
                && let Some(step) = steps.next()
            {
                let is_inside = is_inside(step.to, now.size());
                if step.is_found && is_inside {
                    row.fb = step.fb;
                    row.ncc = self.ncc.compare(&before, point.at, &after, step.to);
                }
                row.status = step.status(is_inside, &row, self.params.losing());
                if row.status == Status::Tracked {
                    [row.x, row.y] = step.to;
                }
                *point = Live { at: [row.x, row.y], status: row.status };
            }
            out.add(row);
        }
        Ok(())
    }
}

/// Lets OpenCV use so many threads: a number for the whole process, which another instance may have set since.
pub(crate) fn set_threads(max_threads: u32) -> opencv::Result<()> {
    // Asked for more than there are, its scheduler complains on the terminal.
    let there = std::thread::available_parallelism().map_or(1, NonZero::get);
    core::set_num_threads(there.min(max_threads as usize) as i32)
}

/// Whether a position is in a picture of this size: pixels reach half a pixel beyond their centres.
fn is_inside([x, y]: honami_vision::Point, (width, height): (u32, u32)) -> bool {
    let within = |v: f32, size: u32| (-0.5..=size as f32 - 0.5).contains(&v);
    within(x, width) && within(y, height)
}
