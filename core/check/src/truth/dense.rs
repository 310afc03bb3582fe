//! Dense motion against a picture that shifts.

use super::{Case, DEADLINE, FOLLOWS_SHARE, MARGIN_PX, NEAR_PX, shift, within};
use crate::course::{of_tracker, tracker};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, Field};

pub(super) const CHECKS: &[Check] = &[Check {
    id: "truth.field",
    level: 7,
    claim: "dense motion is that of the picture, there and back, and none where nothing moves",
    deadline: DEADLINE,
    run: |subject| of_tracker(subject, field),
}];

/// Frames between the two pictures: they differ by 2.9 px.
const STEP: usize = 2;

fn field(subject: &Subject) -> Result<Verdict, Fault> {
    if !subject.info.offers("honami.field/1") {
        return Ok(Verdict::Beside("it has no dense motion".into()));
    }
    let (clip, _) = Case::moving(shift).texture(subject);
    let mut tracker = tracker(subject)?;
    let mut measure =
        |from: usize, to: usize| tracker.field(&clip.view(from), &clip.view(to), 1, &CallContext::silent());
    let [right, down] = shift(STEP).shift;
    let there = off(&measure(0, STEP)?, [right, down]);
    let back = off(&measure(STEP, 0)?, [-right, -down]);
    let none = off(&measure(0, 0)?, [0.0; 2]);
    let said = format!("there {there}, back {back}, unmoved {none}");
    if none.rms_px > NEAR_PX {
        return Err(Fault(format!("{said}; nothing moves between a picture and itself")));
    }
    if there.n_known + back.n_known == 0 {
        return Ok(Verdict::Doubtful(format!("{said}: it knows nothing of a texture")));
    }
    if there.rms_px.max(back.rms_px) > FOLLOWS_SHARE * right.hypot(down) {
        return Err(Fault(format!("{said}; the picture shifted by ({right}, {down}) px")));
    }
    let good = [there, back].iter().all(|off| off.rms_px <= NEAR_PX && 2 * off.n_known >= off.n_nodes);
    Ok(if good { Verdict::Holds(said) } else { Verdict::Doubtful(said) })
}

/// How far vectors are off, away from the border.
#[derive(Clone, Copy)]
struct Off {
    n_nodes: usize,
    n_known: usize,
    rms_px: f64,
}

impl std::fmt::Display for Off {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "rms {:.2} px of {} nodes of {}", self.rms_px, self.n_known, self.n_nodes)
    }
}

fn off(field: &Field, truth: [f64; 2]) -> Off {
    let node = |k: usize| {
        let (column, row) = (k % field.nx as usize, k / field.nx as usize);
        [(field.origin[0], column), (field.origin[1], row)]
            .map(|(first, n)| f64::from(first + field.step * n as f32))
    };
    let inner = field.vectors.iter().enumerate().filter(|(k, _)| within(node(*k), MARGIN_PX));
    let inner: Vec<_> = inner.map(|(_, vector)| vector).collect();
    let known: Vec<_> = inner.iter().copied().flatten().collect();
    let square = |[u, v]: [f32; 2]| (f64::from(u) - truth[0]).powi(2) + (f64::from(v) - truth[1]).powi(2);
    let mean = known.iter().map(|vector| square(**vector)).sum::<f64>() / known.len().max(1) as f64;
    Off { n_nodes: inner.len(), n_known: known.len(), rms_px: mean.sqrt() }
}
