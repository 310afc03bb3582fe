//! A tracker that looks for every point's first picture of it, near where it was last.

use honami_plugin::{
    Cx, Frame, Gray, Info, Point, Points, Result, Seed, Status, Stream, Tracker, export, params,
};
use std::collections::BTreeMap;

params! {
    /// What the user may choose.
    pub struct Choice {
        /// Half the side of the template.
        radius: i64 = 7 => { label: "Radius", unit: "px", min: 2, max: 30 },
        /// How far a point may move from frame to frame.
        search: i64 = 6 => { label: "Search", unit: "px", min: 1, max: 30 },
    }
}

struct Template {
    radius: u32,
    search: i32,
    live: BTreeMap<u32, Followed>,
    /// The frame before: its pixels, width and height.
    last: Option<(Vec<u8>, u32, u32)>,
}

struct Followed {
    x: f32,
    y: f32,
    /// Around it, where it was seeded; none near the border.
    first: Option<Vec<u8>>,
}

impl Tracker for Template {
    type Params = Choice;
    const INFO: Info = Info {
        id: "org.honami.template",
        name: "Templates of the first frame",
        doc: "Looks for the first picture of every point, near where it was last.",
        ..Info::NEW
    };

    fn begin(params: &Choice, _: &Stream, _: &Cx<'_>) -> Result<Self> {
        let (radius, search) = (params.radius as u32, params.search as i32);
        Ok(Self { radius, search, live: BTreeMap::new(), last: None })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        let last = self.last.as_ref().map(|(pixels, width, height)| Gray::packed(pixels, *width, *height));
        for &Seed { id, x, y } in seeds {
            let first = last.and_then(|gray| gray.window(x, y, self.radius));
            self.live.insert(id, Followed { x, y, first });
        }
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        self.live.retain(|id, _| !ids.contains(id));
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let n = self.live.len();
        for (k, (&id, point)) in self.live.iter_mut().enumerate() {
            cx.progress(k as f64 / n as f64, "looking for templates")?;
            if self.last.is_none() {
                point.first = frame.gray.window(point.x, point.y, self.radius);
            }
            let status = point.look(&frame.gray, self.radius, self.search);
            out.add(Point::new(id, point.x, point.y, status));
        }
        let Gray { width, height, .. } = frame.gray;
        self.last = Some(((0..height).flat_map(|y| frame.gray.row(y)).copied().collect(), width, height));
        Ok(())
    }
}

impl Followed {
    /// Moves to where the sum of squared differences from the template is smallest; stays where all look alike. Where the
    /// search leaves the picture and finds something else, the point has left it, too.
    fn look(&mut self, gray: &Gray<'_>, r: u32, s: i32) -> Status {
        let Some(first) = &self.first else { return Status::Lost };
        let miss = |(i, j): (i32, i32)| {
            let here = gray.window(self.x + i as f32, self.y + j as f32, r)?;
            let squares = here.iter().zip(first).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2));
            Some((squares.sum::<u64>() + u64::from((i, j) != (0, 0)), i, j))
        };
        let places = (-s..=s).flat_map(|j| (-s..=s).map(move |i| (i, j)));
        let is_inside = gray.window(self.x, self.y, r + s.unsigned_abs()).is_some();
        match places.filter_map(miss).min_by_key(|found| found.0) {
            Some((best, i, j)) if is_inside || !is_other(first, best) => {
                (self.x, self.y) = (self.x + i as f32, self.y + j as f32);
                Status::Tracked
            }
            _ => Status::Lost,
        }
    }
}

/// Whether what misses by so much is something else: by more than half of the template's own contrast.
fn is_other(first: &[u8], miss: u64) -> bool {
    let n = first.len() as u64;
    let of = |power| first.iter().map(|pixel| u64::from(*pixel).pow(power)).sum::<u64>();
    2 * miss * n > n * of(2) - of(1).pow(2)
}

export! {
    library: { id: "org.honami.template", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Template],
}

#[cfg(test)]
mod tests {
    use super::{Choice, Template};

    #[test]
    fn it_bears_what_every_tracker_must() {
        honami_plugin::testing::suite::<Template>(&Choice { radius: 2, search: 1 });
    }
}
