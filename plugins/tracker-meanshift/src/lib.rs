//! Mean-shift tracking of regions by their colours as a honami plugin; the algorithm is `honami_vision::meanshift`.

mod settings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use honami_follow::{check_size, picture};
use honami_plugin::{
    Cx, DetectFn, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use honami_vision::meanshift::{self, Colours, Found, Histogram, Params, Region, Search, Target};
use honami_vision::{Chroma, Gray, work};
use settings::Settings;

/// Moves each region to where its colours are most like those at its key-frame, then back again.
struct MeanShift {
    settings: Settings,
    params: Params,
    n_threads: usize,
    /// Of the frame pushed last, and of the one before it (whose memory the next frame takes).
    pictures: Option<[Colours; 2]>,
    points: BTreeMap<u32, Live>,
}

/// A point that has not been retired, with the region round it where it was seen last.
struct Live {
    region: Region,
    status: Status,
    /// The colours at its key-frame; taken when the next frame comes.
    model: Option<Histogram>,
}

impl Tracker for MeanShift {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.meanshift",
        name: "Mean shift",
        doc: "Follows a region by the histogram of its colours at the key-frame: the region moves to the mean of its \
              pixels, each weighing `√(p/q)` of its colour's share there and here, as long as \
              `ρ = Σ √(p q)` rises. A leaf among leaves has the colours of all others and is not told apart: for \
              things that differ in colour from what lies round them. Displacements may reach about the radius.",
        cite: &["Comaniciu, Ramesh, Meer 2000", "Comaniciu, Ramesh, Meer 2003"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self {
            settings: settings.clone(),
            params: settings.search(),
            n_threads: stream.max_threads as usize,
            pictures: None,
            points: BTreeMap::new(),
        })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        let radius_px = self.settings.region as f32;
        self.points.extend(seeds.iter().map(|seed| {
            let region = Region { at: [seed.x, seed.y], radius_px };
            (seed.id, Live { region, status: Status::Tracked, model: None })
        }));
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        for id in ids {
            self.points.remove(id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let (luma, chroma) = (picture(frame), chroma(frame));
        let Some([last, spare]) = &mut self.pictures else {
            let first = Colours::new(&luma, chroma.as_ref(), self.settings.bins());
            self.pictures = Some([first.clone(), first]);
            self.points.iter().for_each(|(&id, point)| out.add(point.row(id)));
            return Ok(());
        };
        check_size(frame, last.size())?;
        std::mem::swap(last, spare);
        last.fill(&luma, chroma.as_ref());
        self.follow(out, cx)
    }
}

impl MeanShift {
    /// Adds a row for every point, in the order of their ids.
    fn follow(&mut self, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let Some([now, before]) = &self.pictures else { return Ok(()) };
        let mut live: Vec<_> = self.points.iter_mut().collect();
        let n = live.len();
        // There and back.
        let a_look = work::a_look(2.0 * self.params.cost_ns(self.settings.largest_px()));
        for part in live.chunks_mut(a_look) {
            cx.progress(out.rows().len() as f64 / n as f64, "following regions")?;
            learn(before, part, &self.params);
            let steps = steps([before, now], part, &self.params, self.n_threads);
            for ((id, point), step) in part.iter_mut().zip(steps) {
                let fb = step.and_then(|step| point.take(step, &self.settings, now.size()));
                out.add(Point { fb, ..point.row(**id) });
            }
        }
        Ok(())
    }
}

/// Takes the colours of points that were seeded in this frame. Those without a pixel in the picture get none.
fn learn(picture: &Colours, part: &mut [(&u32, &mut Live)], params: &Params) {
    let mut new = part.iter_mut().filter(|(_, point)| point.model.is_none()).peekable();
    if new.peek().is_none() {
        return;
    }
    let mut search = Search::new(picture, params);
    for (_, point) in new {
        point.model = search.histogram(point.region);
        if point.model.is_none() {
            point.status = Status::Outside;
        }
    }
}

/// Where the region of a point went, and where it ends when it is sought from there in the frame before.
struct Step {
    there: Found,
    back: Option<Found>,
}

/// One step for each point that has colours to look for.
fn steps(
    [before, now]: [&Colours; 2],
    part: &[(&u32, &mut Live)],
    params: &Params,
    n_threads: usize,
) -> Vec<Option<Step>> {
    let sought: Vec<_> = part.iter().map(|(_, point)| Some((point.model.as_ref()?, point.region))).collect();
    let targets: Vec<_> = sought.iter().flatten().map(|&(model, from)| Target { model, from }).collect();
    let there = meanshift::follow(now, &targets, params, n_threads);
    let returning: Vec<_> = there
        .iter()
        .zip(&targets)
        .map(|(found, target)| Target { from: found.map_or(target.from, |found| found.region), ..*target })
        .collect();
    let back = meanshift::follow(before, &returning, params, n_threads);
    let mut steps = there.into_iter().zip(back);
    let mut step = || steps.next().and_then(|(there, back)| Some(Step { there: there?, back }));
    sought.into_iter().map(|sought| sought.and_then(|_| step())).collect()
}

impl Live {
    fn row(&self, id: u32) -> Point {
        Point::new(id, self.region.at[0], self.region.at[1], self.status)
    }

    /// Goes where the colours are, if they are like enough; says how far from its start the way back ends, pixels.
    ///
    /// A region that is not found stays where it was seen last, and is looked for there again in the next frame.
    fn take(&mut self, step: Step, settings: &Settings, size: (u32, u32)) -> Option<f32> {
        let Found { mut region, similarity } = step.there;
        if similarity < settings.lose_similarity {
            self.status = if reaches_out(&self.region, size) { Status::Outside } else { Status::Lost };
            return None;
        }
        let started = self.region.at;
        let [smallest, largest] = [0.5 * settings.region, settings.largest_px()].map(|px| px as f32);
        region.radius_px = region.radius_px.clamp(smallest, largest);
        let centre = Region { radius_px: 0.0, ..region };
        self.status = if reaches_out(&centre, size) { Status::Outside } else { Status::Tracked };
        self.region = region;
        step.back.map(|back| (back.region.at[0] - started[0]).hypot(back.region.at[1] - started[1]))
    }
}

/// Whether a part of a region lies beyond the picture.
fn reaches_out(region: &Region, (width, height): (u32, u32)) -> bool {
    let beyond = |c: f32, n: u32| c - region.radius_px < -0.5 || c + region.radius_px > n as f32 - 0.5;
    beyond(region.at[0], width) || beyond(region.at[1], height)
}

fn chroma<'a>(frame: &Frame<'a>) -> Option<Chroma<'a>> {
    let plane = |honami_plugin::Gray { data, width, height, stride }| Gray { data, width, height, stride };
    frame.chroma.map(|chroma| Chroma { cb: plane(chroma.cb), cr: plane(chroma.cr) })
}

export! {
    library: { id: "org.honami.meanshift", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker MeanShift],
}
