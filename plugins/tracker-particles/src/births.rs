//! Particles as points of their own: which of them has which id.

use std::collections::BTreeSet;
use std::ops::Range;

use honami_plugin::{Cx, Point, Points, Status};
use honami_vision::particles::Particle;
use serde::{Deserialize, Serialize};

/// The ids that the host has set aside. A particle has the one at its number; none is used twice.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Births {
    ids: Range<u32>,
    /// Particles that were reported as born: all before this number.
    n_reported: u64,
    /// Ids that are not reported any more: retired, or moved by hand.
    given_up: BTreeSet<u32>,
    has_warned: bool,
}

impl Births {
    pub(crate) fn new(ids: Range<u32>) -> Self {
        Self { ids, n_reported: 0, given_up: BTreeSet::new(), has_warned: false }
    }

    pub(crate) fn give_up(&mut self, ids: impl Iterator<Item = u32>) {
        self.given_up.extend(ids.filter(|id| self.ids.contains(id)));
    }

    /// Adds a row for each particle with an id. One that is left out has ended.
    pub(crate) fn report(&mut self, living: &[Particle], out: &mut Points, cx: &Cx<'_>) {
        if self.ids.is_empty() {
            return;
        }
        for particle in living {
            let id =
                u32::try_from(particle.number).ok().and_then(|number| self.ids.start.checked_add(number));
            let Some(id) = id.filter(|id| self.ids.contains(id)) else {
                self.warn(cx);
                break;
            };
            if !self.given_up.contains(&id) {
                let status =
                    if particle.number < self.n_reported { Status::Tracked } else { Status::Newborn };
                out.add(Point::new(id, particle.at[0], particle.at[1], status));
            }
        }
        // They are in the order of their numbers.
        self.n_reported = living.last().map_or(self.n_reported, |last| self.n_reported.max(last.number + 1));
    }

    fn warn(&mut self, cx: &Cx<'_>) {
        if !self.has_warned {
            let n = self.ids.len();
            cx.warn(&format!(
                "all {n} numbers for particles are used: those born from now on become no tracks"
            ));
            self.has_warned = true;
        }
    }
}
