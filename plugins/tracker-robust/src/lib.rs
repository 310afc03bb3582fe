//! Robust tracking of regions as a honami plugin; the algorithm is `honami_vision::robust`.

mod settings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use honami_follow::{check_size, picture};
use honami_plugin::{
    Cx, DetectFn, Error, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use honami_vision::klt::State;
use honami_vision::ncc::Ncc;
use honami_vision::pyramid::Pyramid;
use honami_vision::robust::{self, Moved, Region};
use settings::Settings;

/// Moves each point as most of the nodes around it move.
struct Robust {
    settings: Settings,
    region: Region,
    n_threads: usize,
    /// Of the frame pushed last, and of the one before it (whose memory the next frame takes).
    pyramids: Option<[Pyramid; 2]>,
    points: BTreeMap<u32, Live>,
    ncc: Ncc,
}

/// A point that has not been retired. Once it is lost or outside it stays so, where it was seen last.
#[derive(Clone, Copy)]
struct Live {
    at: honami_vision::Point,
    status: Status,
}

impl Tracker for Robust {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.robust",
        name: "Robust regions",
        doc: "Follows a grid of nodes by KLT, and moves each point to where most of the displacements of its region \
              agree: mean shift `x ← Σ k x_i / Σ k`, `k = exp(-½ (x_i - x)ᵀ Σ⁻¹ (x_i - x))`, with the weighted \
              covariance `Σ` narrowed at each step, but not below the noise of a node. Leaves that pass through the region \
              are outliers and do not count. A region that is smaller than what moves over it follows that instead.",
        cite: &["Diener 2009, 2.5.2", "Fukunaga, Hostetler 1975", "Parzen 1962", "Bouguet 2000"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        let region = settings.tracking();
        Ok(Self {
            settings: settings.clone(),
            region,
            n_threads: stream.max_threads as usize,
            pyramids: None,
            points: BTreeMap::new(),
            ncc: Ncc::new(region.radius_px),
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
        let gray = picture(frame);
        let Some([last, spare]) = &mut self.pyramids else {
            let klt = &self.region.klt;
            let first = Pyramid::new(&gray, klt.levels, klt.radius_px);
            self.pyramids = Some([first.clone(), first]);
            self.points.iter().for_each(|(&id, p)| out.add(Point::new(id, p.at[0], p.at[1], p.status)));
            return Ok(());
        };
        let before = last.picture();
        check_size(frame, (before.width, before.height))?;
        std::mem::swap(last, spare);
        last.fill(&gray);
        self.follow(out, cx)
    }
}

/// Rows between two looks at whether to go on: some ten milliseconds of correlation.
const ROWS_A_LOOK: usize = 4096;

impl Robust {
    /// Adds a row for every point, in the order of their ids.
    fn follow(&mut self, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let Some([now, before]) = &self.pyramids else { return Ok(()) };
        let is_seen = |p: &Live| p.status == Status::Tracked;
        let from: Vec<_> = self.points.values().filter(|p| is_seen(p)).map(|p| p.at).collect();
        let is_backward = self.settings.is_backward();
        let pass = |pictures, from: &[honami_vision::Point], what| -> Result<Vec<Moved>> {
            let mut go_on = |share: f64| cx.progress(share, what).is_ok();
            robust::follow(pictures, from, &self.region, self.n_threads, &mut go_on)
                .ok_or_else(Error::cancelled)
        };
        let there = pass([before, now], &from, "following regions")?;
        let back = if is_backward {
            let ends: Vec<_> = there.iter().map(|moved| moved.to).collect();
            pass([now, before], &ends, "following regions back")?
        } else {
            Vec::new()
        };
        let mut steps = there.iter().enumerate();
        for (k, (&id, point)) in self.points.iter_mut().enumerate() {
            if k % ROWS_A_LOOK == 0 {
                cx.progress(1.0, "comparing regions")?;
            }
            let mut row = Point::new(id, point.at[0], point.at[1], point.status);
            if is_seen(point)
                && let Some((k, moved)) = steps.next()
            {
                if moved.state == State::Tracked {
                    let home = back.get(k).filter(|home| home.state == State::Tracked);
                    row.fb = home.map(|home| (home.to[0] - row.x).hypot(home.to[1] - row.y));
                    row.ncc = self.ncc.compare(&before.picture(), point.at, &now.picture(), moved.to);
                }
                row.status = self.settings.judge(moved, row.fb, row.ncc);
                if row.status == Status::Tracked {
                    [row.x, row.y] = moved.to;
                }
                *point = Live { at: [row.x, row.y], status: row.status };
            }
            out.add(row);
        }
        Ok(())
    }
}

export! {
    library: { id: "org.honami.robust", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Robust],
}
