//! Particles of limited life as a honami plugin; the algorithm is `honami_vision::particles`.

mod births;
mod carried;
mod dense;
mod settings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use births::Births;
use honami_follow::{check_size, picture};
use honami_plugin::{
    Cx, DetectFn, Error, FieldFn, Frame, Info, Point, Points, Result, Seed, State, Status, Stream, Tracker,
    export,
};
use honami_vision::Gray;
use honami_vision::ncc::Ncc;
use honami_vision::particles::{Params, Spots, Swarm};
use honami_vision::pyramid::Pyramid;
use honami_vision::work;
use settings::Settings;

/// Moves each point with the particles around it.
struct Particles {
    params: Params,
    n_threads: usize,
    /// Since the first frame.
    seen: Option<Seen>,
    points: BTreeMap<u32, Live>,
    births: Births,
    ncc: Ncc,
}

/// What is kept from frame to frame.
struct Seen {
    swarm: Swarm,
    /// The frame pushed last.
    now: Pyramid,
    /// The one before it, whose memory the next frame takes.
    before: Pyramid,
}

/// A point that was seeded. Once it is lost or outside it stays so, where it was seen last.
#[derive(Clone, Copy)]
struct Live {
    at: honami_vision::Point,
    status: Status,
}

impl Tracker for Particles {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.particles",
        name: "Particles of limited life",
        doc: "Follows corners for a few frames each by KLT, bears others where none is near, and moves each point with \
              those around it. A particle whose last two displacements differ weighs `exp(-‖s1 - s2‖²/σ²)`, because errors \
              are mostly uncorrelated in time. Particles become tracks of their own where the host has numbers for them. \
              A point moves as what is around it, not as its own leaf.",
        cite: &["Diener 2009, 2.5.3", "Shi, Tomasi 1994", "Bouguet 2000"],
        ..Info::NEW
    };
    const DETECT: Option<DetectFn<Settings>> =
        Some(|settings, wanted, _| settings.detection.features(wanted));
    const FIELD: Option<FieldFn<Settings>> = Some(dense::field);
    const STATE: Option<State<Self>> = Some(State { version: 1, save: Self::save, load: Self::load });

    fn begin(settings: &Settings, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self::new(settings, stream))
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        // Whoever moves a particle by hand makes it a point like any other.
        self.births.give_up(seeds.iter().map(|seed| seed.id));
        self.points.extend(seeds.iter().map(|s| (s.id, Live { at: [s.x, s.y], status: Status::Tracked })));
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        self.births.give_up(ids.iter().copied());
        for id in ids {
            self.points.remove(id);
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        let gray = picture(frame);
        let spots = match &mut self.seen {
            None => {
                let now = Pyramid::new(&gray, self.params.klt.levels, self.params.klt.radius_px);
                let swarm = Swarm::new(&self.params, &gray);
                self.seen = Some(Seen { swarm, before: now.clone(), now });
                None
            }
            Some(Seen { swarm, now, before }) => {
                check_size(frame, (now.picture().width, now.picture().height))?;
                std::mem::swap(now, before);
                now.fill(&gray);
                let mut go_on = |share: f64| cx.progress(share, "following particles").is_ok();
                Some(swarm.step([before, now], self.n_threads, &mut go_on).ok_or_else(Error::cancelled)?)
            }
        };
        let Some(seen) = &self.seen else { return Ok(()) };
        let pictures = [seen.before.picture(), seen.now.picture()];
        let a_look = work::a_look(spots.as_ref().map_or(0.0, Spots::cost_ns) + self.ncc.cost_ns());
        for (k, (&id, point)) in self.points.iter_mut().enumerate() {
            if k % a_look == 0 {
                cx.progress(1.0, "moving points")?;
            }
            let mut row = Point::new(id, point.at[0], point.at[1], point.status);
            if let Some(spots) = spots.as_ref().filter(|_| point.status == Status::Tracked) {
                carry(&mut row, spots, &pictures, &mut self.ncc);
                *point = Live { at: [row.x, row.y], status: row.status };
            }
            out.add(row);
        }
        self.births.report(seen.swarm.living(), out, cx);
        Ok(())
    }
}

impl Particles {
    fn new(settings: &Settings, stream: &Stream) -> Self {
        let params = settings.swarm();
        let births = if settings.emit { stream.births.clone() } else { 0..0 };
        Self {
            params,
            n_threads: stream.max_threads as usize,
            seen: None,
            points: BTreeMap::new(),
            births: Births::new(births),
            ncc: Ncc::new(params.klt.radius_px),
        }
    }
}

/// Moves a point, or says why it does not move.
fn carry(row: &mut Point, spots: &Spots, [before, now]: &[Gray<'_>; 2], ncc: &mut Ncc) {
    let at = [row.x, row.y];
    if !now.holds(at) {
        row.status = Status::Outside;
        return;
    }
    let Some(motion) = spots.at(at) else {
        row.status = Status::Lost;
        return;
    };
    let to = [at[0] + motion[0], at[1] + motion[1]];
    if !now.holds(to) {
        row.status = Status::Outside;
        return;
    }
    [row.x, row.y] = to;
    row.ncc = ncc.compare(before, at, now, to);
}

export! {
    library: { id: "org.honami.particles", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [tracker Particles],
}
