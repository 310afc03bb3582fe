//! Box matching as a honami plugin; the algorithm is `honami_vision::boxes`.

mod dense;
mod settings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use honami_follow::{check_size, picture};
use honami_plugin::{
    Cx, DetectFn, FieldFn, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use honami_vision::boxes::{self, Boxes, Match, Template};
use honami_vision::klt::State;
use honami_vision::ncc::Ncc;
use honami_vision::work;
use settings::{Settings, Source};

/// Looks for each point's surroundings in every new frame.
struct BoxMatching {
    settings: Settings,
    params: boxes::Params,
    n_threads: usize,
    /// Of the frame pushed last, and of the one before it (whose memory the next frame takes).
    pictures: Option<[Boxes; 2]>,
    points: BTreeMap<u32, Live>,
    ncc: Ncc,
}

/// A point that has not been retired. Once it is lost or outside it stays so, where it was seen last.
struct Live {
    at: honami_vision::Point,
    status: Status,
    /// What it looked like where it was seeded, if that is what is looked for; cut when the frame is there.
    key: Option<Template>,
}

impl Tracker for BoxMatching {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.box",
        name: "Box matching",
        doc: "Tries displacements of a window and takes that of least squared difference, \
              `d* = argmin_d Σ (I(p) - J(p + d))²`, or of greatest normalised correlation; then a quadratic through the nine \
              costs around it for the fraction of a pixel. Pyramidal: all displacements in a picture of 2x2 averages of 2x2 \
              averages, and below it those around the best share. The template is that of the frame before, or of the \
              key-frame, which does not drift while the feature looks the same.",
        cite: &["Diener 2009, 2.4.1 and 2.5.1", "Shi, Tomasi 1994", "Kalal, Mikolajczyk, Matas 2010"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));
    const FIELD: Option<FieldFn<Settings>> = Some(dense::field);

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        let params = settings.matching();
        Ok(Self {
            settings: settings.clone(),
            ncc: Ncc::new(params.radius_px),
            params,
            n_threads: stream.max_threads as usize,
            pictures: None,
            points: BTreeMap::new(),
        })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        for seed in seeds {
            let mut live = Live { at: [seed.x, seed.y], status: Status::Tracked, key: None };
            if let Some([now, _]) = &self.pictures {
                live.cut(&self.settings, now);
            }
            self.points.insert(seed.id, live);
        }
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        for id in ids {
            self.points.remove(id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let gray = picture(frame);
        let Some([now, before]) = &mut self.pictures else {
            let first = Boxes::new(&gray, self.params.levels(), self.params.radius_px);
            for (&id, point) in &mut self.points {
                point.cut(&self.settings, &first);
                out.add(Point::new(id, point.at[0], point.at[1], point.status));
            }
            self.pictures = Some([first.clone(), first]);
            return Ok(());
        };
        check_size(frame, now.size())?;
        std::mem::swap(now, before);
        now.fill(&gray);
        self.follow(out, cx)
    }
}

impl Live {
    /// Takes what will be looked for, where that is the key-frame's.
    fn cut(&mut self, settings: &Settings, now: &Boxes) {
        if settings.template == Source::Key {
            self.key.get_or_insert_default().cut(now, self.at);
        }
    }
}

/// How long it takes at most to look for a point, roughly, nanoseconds: a window is compared at every place.
fn cost_ns(params: &boxes::Params) -> f64 {
    const PIXEL_NS: f64 = 0.05;
    let [places, area] = [params.search_px, params.radius_px].map(|r| f64::from(2 * r + 1).powi(2));
    PIXEL_NS * places * area
}

impl BoxMatching {
    /// Adds a row for every point, in the order of their ids.
    fn follow(&mut self, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let Some([now, before]) = &self.pictures else { return Ok(()) };
        let mut live: Vec<_> = self.points.iter_mut().collect();
        let n = live.len();
        for part in live.chunks_mut(work::a_look(2.0 * cost_ns(&self.params))) {
            cx.progress(out.rows().len() as f64 / n as f64, "following points")?;
            let seen: Vec<&Live> =
                part.iter().map(|(_, point)| &**point).filter(|p| p.status == Status::Tracked).collect();
            let steps = Step::find(&seen, before, now, &self.params, self.n_threads);
            let mut steps = steps.into_iter();
            for (id, point) in part {
                let mut row = Point::new(**id, point.at[0], point.at[1], point.status);
                if point.status == Status::Tracked
                    && let Some(step) = steps.next()
                {
                    if step.found.state == State::Tracked {
                        row.fb = step.fb(point.at);
                        row.ncc = step.ncc(point, before, now, &mut self.ncc);
                    }
                    row.status = self.settings.judge(step.found.state, row.fb, row.ncc);
                    point.status = row.status;
                    if row.status == Status::Tracked {
                        point.at = step.found.to;
                        [row.x, row.y] = point.at;
                    }
                }
                out.add(row);
            }
        }
        Ok(())
    }
}

/// Where a point was found, and where that leads back to.
struct Step {
    found: Match,
    back: Option<Match>,
}

impl Step {
    /// Looks for points: their key-frames' templates if they have one, else those of the frame before, then back again.
    fn find(
        points: &[&Live],
        before: &Boxes,
        now: &Boxes,
        params: &boxes::Params,
        n_threads: usize,
    ) -> Vec<Self> {
        let from: Vec<_> = points.iter().map(|point| point.at).collect();
        let keys: Vec<_> = points.iter().filter_map(|point| point.key.as_ref()).collect();
        if keys.len() == points.len() {
            let found = boxes::find(&keys, now, &from, params, n_threads);
            return found.into_iter().map(|found| Self { found, back: None }).collect();
        }
        let there = boxes::track(before, now, &from, None, params, n_threads);
        let ends: Vec<_> = there.iter().map(|found| found.to).collect();
        let back = boxes::track(now, before, &ends, None, params, n_threads);
        there.into_iter().zip(back).map(|(found, back)| Self { found, back: Some(back) }).collect()
    }

    /// How far from its start the way there and back ends, pixels.
    fn fb(&self, start: honami_vision::Point) -> Option<f32> {
        let back = self.back.filter(|back| back.state == State::Tracked)?;
        Some((back.to[0] - start[0]).hypot(back.to[1] - start[1]))
    }

    /// How well the place that was found correlates with the template.
    fn ncc(&self, point: &Live, before: &Boxes, now: &Boxes, ncc: &mut Ncc) -> Option<f32> {
        let to = self.found.to;
        let Some(key) = &point.key else {
            return ncc.compare(&before.picture(), point.at, &now.picture(), to);
        };
        // The template's middle is a pixel; the point may lie beside it.
        let (window, [x, y]) = (key.window(), key.beside());
        let middle = window.width as f32 / 2.0 - 0.5;
        ncc.compare(&window, [middle; 2], &now.picture(), [to[0] - x, to[1] - y])
    }
}

export! {
    library: { id: "org.honami.box", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker BoxMatching],
}
