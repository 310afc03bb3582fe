//! The key-frame-anchored tracker as a honami plugin; the algorithm is `honami_vision::anchor`.

mod settings;
#[cfg(test)]
mod tests;

use honami_follow::{check_size, from_bytes, klt_field, picture, to_bytes};
use honami_plugin::{
    Cx, DetectFn, Error, FieldFn, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export,
};
use honami_vision::anchor::{self, State};
use settings::Settings;

/// Looks for each point as its key-frame shows it, where its neighbours say it is.
struct Anchored {
    tracker: anchor::Tracker,
}

impl Tracker for Anchored {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.anchored",
        name: "Key-frame anchored",
        doc: "Looks in every frame for the template of the point's key-frame, so that errors do not add up: \
              Lucas-Kanade and the point's speed predict where it is, an affine fit with gain and offset finds it \
              to a fraction of a pixel, correlation on every pixel around finds it again where that fails. Points \
              that keep their distance from each other ride on the same branch: those that are seen carry those \
              that are hidden, which are called occluded until they are found again. The tracker is joint: what \
              becomes of a point depends on the others that are followed. Dense motion is Lucas-Kanade's search from \
              the nodes of a grid, there and back, and 0 where a node does not come back to within a pixel.",
        cite: &["Lucas, Kanade 1981", "Bouguet 2000", "Baker, Matthews 2004", "Diener 2009, 2.4.1"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));
    const FIELD: Option<FieldFn<Settings>> =
        Some(|settings, from, to, max_threads, cx| klt_field(&settings.dense(), from, to, max_threads, cx));

    const STATE: Option<honami_plugin::State<Self>> =
        Some(honami_plugin::State { version: 1, save: |anchored| to_bytes(&anchored.tracker.save()), load });

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self { tracker: anchor::Tracker::new(settings.tracking(), stream.max_threads as usize) })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        self.tracker.seed(seeds.iter().map(|seed| (seed.id, [seed.x, seed.y])));
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        self.tracker.retire(ids.iter().copied());
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        if let Some(size) = self.tracker.size() {
            check_size(frame, size)?;
        }
        self.tracker.push(&picture(frame), |share| cx.progress(share, "following points"))?;
        for anchor::Row { id, at: [x, y], state, fb, ncc } in self.tracker.rows() {
            let status = match state {
                State::Tracked => Status::Tracked,
                State::Occluded => Status::Occluded,
                State::Outside => Status::Outside,
                State::Lost => Status::Lost,
            };
            out.add(Point { fb, ncc, ..Point::new(id, x, y, status) });
        }
        Ok(())
    }
}

fn load(settings: &Settings, stream: &Stream, bytes: &[u8]) -> Result<Anchored> {
    let saved = from_bytes(bytes)?;
    let tracker = anchor::Tracker::load(settings.tracking(), stream.max_threads as usize, saved);
    tracker
        .map(|tracker| Anchored { tracker })
        .ok_or_else(|| Error::data("its points are none of this tracker's"))
}

export! {
    library: { id: "org.honami.anchored", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Anchored],
}
