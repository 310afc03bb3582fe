//! `cv::calcOpticalFlowPyrLK`, there and back.

use honami_plugin::{Cx, Info, Result};
use opencv::core::{
    BORDER_CONSTANT, BORDER_REFLECT_101, Mat, Point2f, Size, TermCriteria, TermCriteria_Type, Vector,
};
use opencv::video;

use crate::follow::{Method, Step};
use crate::settings::LkSettings;

/// Points that are followed between two looks for a cancel.
const POINTS_A_LOOK: usize = 2000;

/// Follows each point's window, then back again to see whether it returns.
pub(crate) struct Lk {
    settings: LkSettings,
    /// Of the frame before, where it was pushed here.
    last: Option<Pyramid>,
}

/// A pyramid with its gradients.
pub(crate) struct Pyramid {
    levels: Vector<Mat>,
}

impl Method for Lk {
    type Params = LkSettings;
    const INFO: Info = Info {
        id: "org.honami.opencv-lk",
        name: "OpenCV PyrLK",
        doc: "OpenCV's `calcOpticalFlowPyrLK`: the pyramidal Lucas-Kanade of `tracker-klt`, which gives the same answer; here for \
              comparison. Tracks back for the forward-backward error.",
        cite: &["Bouguet 2000", "opencv.org"],
        ..Info::NEW
    };
    const SCALES: bool = true;

    fn begin(settings: &LkSettings) -> Result<Self> {
        Ok(Self { settings: settings.clone(), last: None })
    }

    fn follow(
        &mut self,
        before: &Mat,
        now: &Mat,
        from: &[(u32, honami_vision::Point)],
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>> {
        let before = match self.last.take() {
            Some(pyramid) => pyramid,
            None => self.pyramid(before)?,
        };
        let now = self.pyramid(now)?;
        let mut steps = Vec::with_capacity(from.len());
        for (k, points) in from.chunks(POINTS_A_LOOK).enumerate() {
            cx.progress((k * POINTS_A_LOOK) as f64 / from.len() as f64, "following")?;
            let points: Vec<_> = points.iter().map(|&(_, [x, y])| Point2f::new(x, y)).collect();
            let there = self.flow(&before, &now, &points)?;
            let ends: Vec<_> = there.iter().map(|&(to, _)| to).collect();
            let back = self.flow(&now, &before, &ends)?;
            steps.extend(points.iter().zip(there).zip(back).map(
                |((from, (to, is_found)), (end, is_back))| {
                    let fb = (is_found && is_back).then(|| (end.x - from.x).hypot(end.y - from.y));
                    Step { to: [to.x, to.y], is_found, fb }
                },
            ));
        }
        self.last = Some(now);
        Ok(steps)
    }
}

impl Lk {
    fn window(&self) -> Size {
        let side = 2 * self.settings.radius as i32 + 1;
        Size::new(side, side)
    }

    pub(crate) fn pyramid(&self, picture: &Mat) -> opencv::Result<Pyramid> {
        let mut levels = Vector::new();
        let top = self.settings.levels as i32 - 1;
        video::build_optical_flow_pyramid(
            picture,
            &mut levels,
            self.window(),
            top,
            true,
            BORDER_REFLECT_101,
            BORDER_CONSTANT,
            false,
        )?;
        Ok(Pyramid { levels })
    }

    /// Where points went, and whether they were found.
    pub(crate) fn flow(
        &self,
        from: &Pyramid,
        to: &Pyramid,
        points: &[Point2f],
    ) -> opencv::Result<Vec<(Point2f, bool)>> {
        if points.is_empty() {
            return Ok(Vec::new());
        }
        let criteria = TermCriteria::new(
            TermCriteria_Type::COUNT as i32 + TermCriteria_Type::EPS as i32,
            self.settings.iterations as i32,
            self.settings.epsilon,
        )?;
        let (mut ends, mut found) = (Vector::<Point2f>::new(), Vector::<u8>::new());
        video::calc_optical_flow_pyr_lk(
            &from.levels,
            &to.levels,
            &Mat::from_slice(points)?,
            &mut ends,
            &mut found,
            &mut opencv::core::no_array(),
            self.window(),
            self.settings.levels as i32 - 1,
            criteria,
            0,
            self.settings.min_eigenvalue,
        )?;
        Ok(ends.iter().zip(found.iter().map(|f| f != 0)).collect())
    }
}
