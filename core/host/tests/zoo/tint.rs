//! A tracker that answers every seed with the colour under it: x is Cb, y is Cr, and `fb` the range (1 limited, 2 full).

use honami_plugin::{Cx, Frame, Info, Point, Points, Result, Seed, Status, Stream, Tracker};

/// The tracker.
pub(crate) struct Tint {
    seeds: Vec<Seed>,
}

impl Tracker for Tint {
    type Params = ();
    const INFO: Info =
        Info { id: "org.honami.zoo.tint", name: "Tint", doc: "[x, y] = [Cb, Cr]", ..Info::NEW };

    fn begin((): &(), _: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self { seeds: Vec::new() })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        self.seeds.extend(seeds);
        Ok(())
    }

    fn retire(&mut self, _: &[u32]) {}

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, _: &Cx<'_>) -> Result<()> {
        for seed in &self.seeds {
            let fb = frame.range.map(|range| range as u32 as f32);
            let [cb, cr] = frame.chroma_at(seed.x as u32, seed.y as u32).unwrap_or_default().map(f32::from);
            out.add(Point { fb, ..Point::new(seed.id, cb, cr, Status::Tracked) });
        }
        Ok(())
    }
}
