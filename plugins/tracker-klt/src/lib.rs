//! The pyramidal KLT tracker as a honami plugin; the algorithm is `honami_vision::klt`.

mod settings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use honami_follow::{check_size, klt_field, picture};
use honami_plugin::{
    Cx, DetectFn, FieldFn, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use honami_vision::klt::{self, State};
use honami_vision::ncc::Ncc;
use honami_vision::pyramid::Pyramid;
use settings::{Model, Settings};

/// Follows each point from frame to frame, then back again to see whether it returns.
struct Klt {
    settings: Settings,
    params: klt::Params,
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

impl Tracker for Klt {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.klt",
        name: "Pyramidal KLT",
        doc: "Moves a window until its brightness agrees with that of the frame before: \
              `(Σ g gᵀ) dv = -Σ δ g`, from the coarsest level of a pyramid to the finest, \
              then tracks back for the forward-backward error. Dense motion is the same search from the nodes of a grid, \
              one radius apart, and 0 where a node does not come back to within a pixel. Brightness must stay; displacements may reach \
              about `2^(levels-1)` radii.",
        cite: &["Lucas, Kanade 1981", "Bouguet 2000", "Shi, Tomasi 1994", "Kalal, Mikolajczyk, Matas 2010"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));
    const FIELD: Option<FieldFn<Settings>> = Some(|settings, from, to, max_threads, cx| {
        klt_field(&settings.tracking(), from, to, max_threads, cx)
    });

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        let params = settings.tracking();
        Ok(Self {
            settings: settings.clone(),
            ncc: Ncc::new(params.radius_px),
            params,
            n_threads: stream.max_threads as usize,
            pyramids: None,
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
        let gray = picture(frame);
        let Some([last, spare]) = &mut self.pyramids else {
            let first = Pyramid::new(&gray, self.params.levels, self.params.radius_px);
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

/// Points that are followed between two looks at whether to go on: some ten milliseconds.
const POINTS_A_LOOK: usize = 1024;

impl Klt {
    /// Adds a row for every point, in the order of their ids.
    fn follow(&mut self, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let Some([now, before]) = &self.pyramids else { return Ok(()) };
        let mut live: Vec<_> = self.points.iter_mut().collect();
        let n = live.len();
        let search = |prev, next, from: &[_]| {
            let mut flows = klt::track(prev, next, from, None, &self.params, self.n_threads);
            if self.settings.model == Model::Affine {
                klt::affine::refine(prev, next, from, &mut flows, &self.params, self.n_threads);
            }
            flows
        };
        for (k, part) in live.chunks_mut(POINTS_A_LOOK).enumerate() {
            cx.progress((k * POINTS_A_LOOK) as f64 / n as f64, "following points")?;
            let seen = |p: &Live| p.status == Status::Tracked;
            let from: Vec<_> = part.iter().filter(|(_, p)| seen(p)).map(|(_, p)| p.at).collect();
            let there = search(before, now, &from);
            let to: Vec<_> = there.iter().map(|flow| flow.to).collect();
            let back = search(now, before, &to);
            let mut steps = there.iter().zip(&back);
            for (id, point) in part {
                let mut row = Point::new(**id, point.at[0], point.at[1], point.status);
                if seen(point)
                    && let Some((there, back)) = steps.next()
                {
                    if there.state == State::Tracked {
                        let error = (back.to[0] - row.x).hypot(back.to[1] - row.y);
                        row.fb = (back.state == State::Tracked).then_some(error);
                        row.ncc = self.ncc.compare(&before.picture(), point.at, &now.picture(), there.to);
                    }
                    row.status = self.settings.judge(there.state, row.fb, row.ncc);
                    point.status = row.status;
                    if row.status == Status::Tracked {
                        point.at = there.to;
                        [row.x, row.y] = there.to;
                    }
                }
                out.add(row);
            }
        }
        Ok(())
    }
}

export! {
    library: { id: "org.honami.klt", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Klt],
}
