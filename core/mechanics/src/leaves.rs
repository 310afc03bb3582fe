//! What hangs on the ends of branches.

#[cfg(test)]
mod tests;

use crate::beams::Beams;
use crate::wind_basis::Drag;
use honami_model::brief::Brief;

/// All leaves of a plant, shared alike by the ends of its branches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Leaves {
    /// What they weigh, kilograms.
    pub mass: f64,
    /// Their area times their drag coefficient, square metres.
    pub drag: f64,
}

/// Leaves that nothing weighs less than.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("leaves weigh 0 kg or more and have a drag area of 0 m2 or more, not {} kg and {} m2", Brief(*mass), Brief(*drag))]
pub struct LeavesError {
    mass: f64,
    drag: f64,
}

impl Leaves {
    /// Refuses what no leaves are.
    ///
    /// # Errors
    /// [`LeavesError`].
    pub fn check(&self) -> Result<(), LeavesError> {
        let Self { mass, drag } = *self;
        let are_leaves = [mass, drag].iter().all(|v| v.is_finite() && *v >= 0.0);
        if are_leaves { Ok(()) } else { Err(LeavesError { mass, drag }) }
    }

    /// Hangs them on the beams; how hard air presses on both. An end is a node that bears no other: a twig of no length is
    /// none, whoever measured it, and so a plant has the same ends when its beams are made into beams again.
    ///
    /// # Errors
    /// [`LeavesError`].
    pub fn hang(&self, beams: &mut Beams) -> Result<Drag, LeavesError> {
        self.check()?;
        let Self { mass, drag } = *self;
        let ends = beams.ends();
        let share = 1.0 / ends.len().max(1) as f64;
        beams.load(ends.iter().map(|end| (*end as usize, mass * share)));
        let of_end = |end: &u32| (*end as usize, drag * share);
        let leaves = if drag > 0.0 { ends.iter().map(of_end).collect() } else { Vec::new() };
        Ok(Drag { leaves, ..Drag::default() })
    }
}
