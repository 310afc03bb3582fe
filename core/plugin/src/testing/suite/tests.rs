//! The suite finds what is wrong: a tracker with one fault at a time.

use super::*;
use crate::{Info, params};

params! {
    /// Which fault it has.
    pub(crate) struct Fault {
        /// 0: none.
        fault: i64 = 0 => { label: "Fault", min: 0, max: 20 },
    }
}

/// Leaves points where they are, but for its fault.
struct Faulty {
    fault: i64,
    n_threads: u32,
    n_pushed: u32,
    points: Vec<Seed>,
}

impl Tracker for Faulty {
    type Params = Fault;
    const INFO: Info = Info { id: "org.example.faulty", name: "Faulty", ..Info::NEW };

    fn begin(params: &Fault, stream: &Stream, _: &Cx<'_>) -> Result<Self> {
        Ok(Self { fault: params.fault, n_threads: stream.max_threads, n_pushed: 0, points: Vec::new() })
    }

    fn seed(&mut self, seeds: &[Seed], _: &Cx<'_>) -> Result<()> {
        if self.fault == 9 && self.n_pushed > 3 {
            return Ok(());
        }
        self.points.retain(|point| seeds.iter().all(|seed| seed.id != point.id));
        self.points.extend(seeds);
        Ok(())
    }

    fn retire(&mut self, ids: &[u32]) {
        if self.fault != 1 {
            self.points.retain(|point| !ids.contains(&point.id));
        }
    }

    fn push(&mut self, frame: &Frame<'_>, out: &mut Points, cx: &Cx<'_>) -> Result<()> {
        self.n_pushed += 1;
        if self.fault != 2
            && let Err(stop) = cx.progress(0.0, "standing")
        {
            return if self.fault == 3 { Ok(()) } else { Err(stop) };
        }
        if self.fault == 4 && frame.gray.row(0).iter().all(|&pixel| pixel == 0) {
            return Err(Error::data("it is too dark"));
        }
        for point in &self.points {
            let mut row = Point::new(point.id, point.x, point.y, Status::Tracked);
            match self.fault {
                5 => row.x = (row.x - 1e30).sqrt(),
                6 => row.fb = Some(-1.0),
                7 => row.status = Status::Newborn,
                8 => row.x += 0.1,
                10 if self.n_threads > 1 => row.y += 0.5,
                11 => out.add(row),
                13 => continue,
                _ => {}
            }
            out.add(row);
        }
        if self.fault == 12 && frame.gray.width == 48 {
            return Err(Error::data(""));
        }
        Ok(())
    }
}

#[test]
fn a_tracker_without_fault_passes_and_each_fault_is_named() {
    suite::<Faulty>(&Fault { fault: 0 });
    let faults = [
        (1, "a row of a point that is not live"),
        (2, "nobody was asked whether to go on"),
        (3, "told to stop it went on"),
        (4, "black, 64x48: it is too dark"),
        (5, "a position is not finite"),
        (6, "a quality is out of its range"),
        (7, "a birth with an id that is not free"),
        (8, "frame 0 reports"),
        (9, "point 12, seeded or brought back, has no row in frame 6"),
        (10, "four threads gave other rows"),
        (11, "a point has two rows"),
        (12, "refused without a reason"),
        (13, "has no row in the first frame"),
    ];
    for (fault, want) in faults {
        let met = std::panic::catch_unwind(|| suite::<Faulty>(&Fault { fault }));
        let met = met.expect_err(want);
        let text = met.downcast_ref::<String>().map_or("", String::as_str);
        assert!(text.contains(want), "fault {fault}: {text:?}");
    }
}
