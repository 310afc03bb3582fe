//! A point tracker that the user brings as ONNX graphs: the encoder of a frame, the query of points, the causal step.

mod graph;
mod net;
mod picture;
mod settings;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use honami_follow::check_size;
use honami_plugin::{
    Cx, DetectFn, Error, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use net::{Batch, Found, Net};
use picture::Scale;
use rten::Value;
use settings::Settings;

/// Follows points through a net, a batch at a time.
struct Onnx {
    settings: Settings,
    net: Net,
    /// Size of the frames and features of the last one.
    last: Option<((u32, u32), Vec<Value>)>,
    points: BTreeMap<u32, Live>,
    /// Points that the net does not know yet: they were seeded in the last frame.
    waiting: BTreeSet<u32>,
    groups: Vec<Group>,
}

/// A point that has not been retired.
#[derive(Clone, Copy)]
struct Live {
    at: honami_vision::Point,
    status: Status,
}

/// Points that were made known to the net together, and stay together.
struct Group {
    /// `None` where the point has been retired, or seeded again.
    ids: Vec<Option<u32>>,
    batch: Batch,
}

impl Tracker for Onnx {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.onnx",
        name: "ONNX point tracker",
        doc: "Any causal point tracker (as BootsTAPIR) whose three graphs are in a folder: `encoder.onnx` (frame to features), \
              `query.onnx` (features and points to query features), `step.onnx` (features, query features and state to tracks, \
              visibility and state). A point is tracked while `(1 - σ(occlusion)) (1 - σ(expected distance))` is above a limit, else \
              occluded; the net finds it again by itself. No weights are shipped.",
        cite: &["Doersch et al. 2023 (TAPIR)", "Doersch et al. 2024 (BootsTAP)"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));

    fn begin(settings: &Settings, stream: &Stream, cx: &Cx<'_>) -> Result<Self> {
        cx.progress(-1.0, "reading the graphs")?;
        if settings.graphs.as_os_str().is_empty() {
            return Err(Error::failed(
                "no net is set: give `graphs` the folder with encoder.onnx, query.onnx and step.onnx",
            ));
        }
        let (size, batch) = (settings.size as u32, settings.batch as usize);
        let net = Net::load(&settings.graphs, size, batch, stream.max_threads as usize)?;
        Ok(Self {
            settings: settings.clone(),
            net,
            last: None,
            points: BTreeMap::new(),
            waiting: BTreeSet::new(),
            groups: Vec::new(),
        })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        let ids: Vec<u32> = seeds.iter().map(|seed| seed.id).collect();
        self.forget(&ids);
        self.points.extend(seeds.iter().map(|s| (s.id, Live { at: [s.x, s.y], status: Status::Tracked })));
        self.waiting.extend(ids);
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        self.forget(ids);
        for id in ids {
            self.points.remove(id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let size = (frame.gray.width, frame.gray.height);
        if let Some((before, _)) = &self.last {
            check_size(frame, *before)?;
        }
        cx.progress(0.0, "encoding the frame")?;
        let features = self.net.encode(picture::tensor(frame, &self.net.frame))?;
        if let Some((_, last)) = self.last.take() {
            let scale = Scale::new(size, &self.net.frame);
            self.introduce(&last, scale, cx)?;
            self.follow(&features, scale, cx)?;
        }
        self.last = Some((size, features));
        self.points.iter().for_each(|(&id, p)| out.add(Point::new(id, p.at[0], p.at[1], p.status)));
        Ok(())
    }
}

impl Onnx {
    /// Takes points out of their groups; a group goes with its last point.
    fn forget(&mut self, ids: &[u32]) {
        let ids: BTreeSet<u32> = ids.iter().copied().collect();
        self.waiting.retain(|id| !ids.contains(id));
        for group in &mut self.groups {
            for slot in &mut group.ids {
                *slot = slot.filter(|id| !ids.contains(id));
            }
        }
        self.groups.retain(|group| group.ids.iter().any(Option::is_some));
    }

    /// Makes the points known that were seeded in the last frame, and steps into that frame, as the net was trained.
    fn introduce(&mut self, last: &[Value], scale: Scale, cx: &Cx<'_>) -> Result<()> {
        let mut ids = Vec::new();
        for id in std::mem::take(&mut self.waiting) {
            match self.points.get_mut(&id) {
                Some(point) if scale.holds(point.at) => ids.push(id),
                Some(point) => point.status = Status::Outside,
                None => {}
            }
        }
        for ids in ids.chunks(self.net.batch_size()) {
            cx.progress(0.1, "making points known")?;
            let order = self.settings.query_order;
            let places: Vec<_> =
                ids.iter().map(|id| order.arrange(scale.to_net(self.points[id].at))).collect();
            let mut batch = self.net.begin(last, &places)?;
            self.net.step(last, &mut batch)?;
            self.groups.push(Group { ids: ids.iter().copied().map(Some).collect(), batch });
        }
        Ok(())
    }

    /// Steps every group into a frame.
    fn follow(&mut self, features: &[Value], scale: Scale, cx: &Cx<'_>) -> Result<()> {
        let n = self.groups.len();
        for (k, group) in self.groups.iter_mut().enumerate() {
            cx.progress(0.2 + 0.8 * k as f64 / n as f64, "following points")?;
            let found = self.net.step(features, &mut group.batch)?;
            if found.len() < group.ids.len() {
                let (points, came) = (group.ids.len(), found.len());
                return Err(Error::failed(format!("step.onnx gives {came} positions for {points} points")));
            }
            for (id, found) in group.ids.iter().zip(found) {
                if let Some(point) = id.and_then(|id| self.points.get_mut(&id)) {
                    *point = judge(*point, &found, &self.settings, scale);
                }
            }
        }
        Ok(())
    }
}

/// What became of a point. The net follows it whatever it was before.
fn judge(before: Live, found: &Found, settings: &Settings, scale: Scale) -> Live {
    let at = scale.to_clip(settings.track_order.arrange(found.at));
    if !at.iter().all(|c| c.is_finite()) || found.visible.is_nan() {
        return Live { status: Status::Lost, ..before };
    }
    let status = if !scale.holds(at) {
        Status::Outside
    } else if f64::from(found.visible) > settings.visible {
        Status::Tracked
    } else {
        Status::Occluded
    };
    Live { at, status }
}

export! {
    library: { id: "org.honami.onnx", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Onnx],
}
