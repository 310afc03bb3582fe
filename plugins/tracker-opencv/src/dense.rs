//! Dense flow, chained: every point goes where the flow at its place leads. DIS and Farneback.

use honami_follow::{check_size, picture};
use honami_plugin::{Cx, Error, FieldFn, Frame, Info, Result};
use honami_vision::field::{Field, Grid};
use opencv::core::{Mat, Ptr, Vec2f};
use opencv::prelude::*;
use opencv::video::{self, DISOpticalFlow};

use crate::follow::{Method, Step, set_threads};
use crate::picture::Picture;
use crate::settings::{DisSettings, FarnebackSettings, Preset, Shared};

/// Distance between the nodes of a field, pixels.
const FIELD_STEP_PX: u32 = 8;
/// A node whose way there and back ends farther than this from its start has no known motion, pixels.
const ASTRAY_PX: f32 = 1.0;

/// Something that measures where every pixel goes.
pub(crate) trait Engine: Sized + Send + 'static {
    type Params: Shared;
    const INFO: Info;
    const SCALES: bool;
    /// What OpenCV calls it, and the least width and height that it can work on, pixels.
    const NEEDS: (&'static str, i32);

    fn new(params: &Self::Params) -> opencv::Result<Self>;
    /// Whether the way back is wanted too.
    fn is_back_wanted(params: &Self::Params) -> bool;
    /// Displacement of every pixel.
    fn flow(&mut self, from: &Mat, to: &Mat) -> opencv::Result<Mat>;
}

/// A dense flow as a way of following points.
pub(crate) struct Dense<E> {
    engine: E,
    is_back_wanted: bool,
}

impl<E: Engine> Method for Dense<E> {
    type Params = E::Params;
    const INFO: Info = E::INFO;
    const FIELD: Option<FieldFn<E::Params>> = Some(motion::<E>);
    const SCALES: bool = E::SCALES;

    fn begin(params: &E::Params) -> Result<Self> {
        Ok(Self { engine: E::new(params)?, is_back_wanted: E::is_back_wanted(params) })
    }

    fn follow(
        &mut self,
        before: &Mat,
        now: &Mat,
        from: &[(u32, honami_vision::Point)],
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>> {
        if from.is_empty() {
            return Ok(Vec::new());
        }
        let (name, least) = E::NEEDS;
        if before.cols().min(before.rows()) < least {
            let (width, height) = (before.cols(), before.rows());
            return Err(Error::data(format!(
                "frames of {width}x{height} are too small for {name}, which needs {least}x{least} at least: \
                 opencv-lk and klt follow points in any"
            )));
        }
        cx.progress(0.0, "measuring the flow")?;
        let there = field(&self.engine.flow(before, now)?)?;
        cx.progress(0.5, "measuring the flow back")?;
        let back = if self.is_back_wanted { Some(field(&self.engine.flow(now, before)?)?) } else { None };
        Ok(from.iter().map(|&(_, at)| step(&there, back.as_ref(), at)).collect())
    }
}

/// OpenCV's matrix of displacements as a field with a node at every pixel.
fn field(flow: &Mat) -> opencv::Result<Field> {
    let grid = Grid::over(flow.cols() as u32, flow.rows() as u32, 1);
    Ok(Field::new(grid, flow.data_typed::<Vec2f>()?.iter().map(|moved| Some(moved.0))))
}

/// Where a point went, and how far from its start the way back ends.
fn step(there: &Field, back: Option<&Field>, [x, y]: honami_vision::Point) -> Step {
    let Some([u, v]) = there.at([x, y]) else { return Step::LOST };
    let to = [x + u, y + v];
    let home = back.and_then(|back| back.at(to));
    Step { to, is_found: true, fb: home.map(|[back_u, back_v]| (u + back_u).hypot(v + back_v)) }
}

/// Displacements between two frames at the nodes of a grid; none where there and back do not agree.
fn motion<E: Engine>(
    params: &E::Params,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<honami_plugin::Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let (from, to) = (Picture::copy(&picture(from))?, Picture::copy(&picture(to))?);
    set_threads(if E::SCALES { max_threads } else { 1 })?;
    let grid = Grid::over(from.size().0, from.size().1, FIELD_STEP_PX);
    let nodes: Vec<_> = grid.nodes().map(|at| (0, at)).collect();
    let mut engine = Dense { engine: E::new(params)?, is_back_wanted: true };
    // Where nothing can be measured nothing is known.
    let is_too_small = from.mat.cols().min(from.mat.rows()) < E::NEEDS.1;
    let steps = if is_too_small {
        vec![Step::LOST; nodes.len()]
    } else {
        engine.follow(&from.mat, &to.mat, &nodes, cx)?
    };
    let moved = nodes.iter().zip(steps).map(|(&(_, from), step)| {
        let is_known = step.fb.is_some_and(|fb| fb <= ASTRAY_PX);
        is_known.then(|| [step.to[0] - from[0], step.to[1] - from[1]])
    });
    Ok(honami_follow::dense(grid, moved))
}

/// Dense inverse search.
pub(crate) struct Dis(Ptr<DISOpticalFlow>);

impl Engine for Dis {
    type Params = DisSettings;
    const INFO: Info = Info {
        id: "org.honami.opencv-dis",
        name: "OpenCV DIS",
        doc: "OpenCV's `DISOpticalFlow`: patches of 8 px are searched from coarse to fine, their displacements averaged by how well \
              they fit, and refined. Points follow the flow from frame to frame; errors add up.",
        cite: &["Kroeger, Timofte, Dai, Van Gool 2016", "opencv.org"],
        ..Info::NEW
    };
    // It shares the rows out among threads and carries good matches on within each share.
    const SCALES: bool = false;
    const NEEDS: (&'static str, i32) = ("DIS", 16);

    fn new(settings: &DisSettings) -> opencv::Result<Self> {
        DISOpticalFlow::create(match settings.preset {
            Preset::Ultrafast => video::DISOpticalFlow_PRESET_ULTRAFAST,
            Preset::Fast => video::DISOpticalFlow_PRESET_FAST,
            Preset::Medium => video::DISOpticalFlow_PRESET_MEDIUM,
        })
        .map(Self)
    }

    fn is_back_wanted(settings: &DisSettings) -> bool {
        settings.back
    }

    fn flow(&mut self, from: &Mat, to: &Mat) -> opencv::Result<Mat> {
        // An empty one: DIS would start from what is in it.
        let mut flow = Mat::default();
        self.0.calc(from, to, &mut flow)?;
        Ok(flow)
    }
}

/// Farneback's polynomial expansion.
pub(crate) struct Farneback(FarnebackSettings);

impl Engine for Farneback {
    type Params = FarnebackSettings;
    const INFO: Info = Info {
        id: "org.honami.opencv-farneback",
        name: "OpenCV Farneback",
        doc: "OpenCV's `calcOpticalFlowFarneback`: each neighbourhood is described by a quadratic polynomial, and the displacement is \
              the one that turns the polynomials of a window into those of the new frame. Points follow the flow; errors add up.",
        cite: &["Farnebäck 2003", "opencv.org"],
        ..Info::NEW
    };
    const SCALES: bool = true;
    const NEEDS: (&'static str, i32) = ("Farneback", 1);

    fn new(settings: &FarnebackSettings) -> opencv::Result<Self> {
        Ok(Self(settings.clone()))
    }

    fn is_back_wanted(settings: &FarnebackSettings) -> bool {
        settings.back
    }

    fn flow(&mut self, from: &Mat, to: &Mat) -> opencv::Result<Mat> {
        let (settings, mut flow) = (&self.0, Mat::default());
        let window = 2 * settings.radius as i32 + 1;
        let neighbourhood = 2 * settings.neighbourhood as i32 + 1;
        let (levels, steps) = (settings.levels as i32, settings.iterations as i32);
        let half = 0.5;
        video::calc_optical_flow_farneback(
            from,
            to,
            &mut flow,
            half,
            levels,
            window,
            steps,
            neighbourhood,
            settings.sigma,
            0,
        )?;
        Ok(flow)
    }
}
