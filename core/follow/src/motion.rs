//! Points that ride on dense motion: a method of following made of whatever measures that motion.

#[cfg(test)]
mod tests;

use honami_plugin::{Cx, Error, FieldFn, Frame, Info, Params, Result};
use honami_vision::field::{Drift, Field};
use honami_vision::{Gray, Point as Place};

use crate::{Detection, Method, Step, Trust, check_size, dense, picture};

/// Measures dense motion; the parameters of the plugin are its fields.
///
/// Points follow it (J. Diener's thesis, 2.4.4): one goes on while the motion around it is known.
pub trait Motion: Params + Clone {
    /// Id, name and description.
    const INFO: Info;
    /// What is kept of a frame until the next: the picture, and a pyramid of it, say.
    type Kept: Send + 'static;

    /// Prepares a frame.
    fn keep(&self, picture: &Gray<'_>, n_threads: usize) -> Self::Kept;

    /// The picture that was kept.
    fn kept(kept: &Self::Kept) -> Gray<'_>;

    /// Displacements from one picture to another of the same size; `None` where `go_on` said no.
    ///
    /// `go_on` is told the share of the work that is done, 0..=1, at least every 50 ms.
    fn measure(
        &self,
        from: &Self::Kept,
        to: &Self::Kept,
        n_threads: usize,
        go_on: &dyn Fn(f64) -> bool,
    ) -> Option<Field>;

    /// Whether motion is measured back, too: that gives the forward-backward error, at twice the time.
    fn is_backward(&self) -> bool;

    /// How far samples are to be trusted.
    fn trust(&self) -> Trust<'_>;

    /// Which corners are features.
    fn detection(&self) -> &Detection;
}

const MEASURING: &str = "measuring motion";

impl<M: Motion> Method for M {
    const INFO: Info = M::INFO;
    const FIELD: Option<FieldFn<M>> = Some(field::<M>);
    type Kept = M::Kept;

    fn keep(&self, picture: &Gray<'_>, _: Option<M::Kept>, n_threads: usize) -> M::Kept {
        Motion::keep(self, picture, n_threads)
    }

    fn kept(kept: &M::Kept) -> Gray<'_> {
        M::kept(kept)
    }

    fn follow(
        &self,
        [last, now]: [&M::Kept; 2],
        from: &[Place],
        n_threads: usize,
        cx: &Cx<'_>,
    ) -> Result<Vec<Step>> {
        // A limit wants to know what it limits.
        let is_backward = self.is_backward() || Motion::trust(self).losing.lose_fb > 0.0;
        let share = if is_backward { 0.5 } else { 1.0 };
        let pass = |first: f64, from, to| {
            let go_on = |done: f64| cx.progress(first + share * done, MEASURING).is_ok();
            self.measure(from, to, n_threads, &go_on).ok_or_else(Error::cancelled)
        };
        let there = pass(0.0, last, now)?;
        let back = is_backward.then(|| pass(0.5, now, last)).transpose()?;
        let picture = <M as Motion>::kept(last);
        let step = |&at: &Place| {
            let to = there.follow(at, &picture);
            let back = match (to, &back) {
                (Drift::To(to), Some(back)) => back.at(to).map(|[u, v]| [to[0] + u, to[1] + v]),
                _ => None,
            };
            Step { to, home: back }
        };
        Ok(from.iter().map(step).collect())
    }

    fn trust(&self) -> Trust<'_> {
        Motion::trust(self)
    }

    fn detection(&self) -> &Detection {
        Motion::detection(self)
    }
}

/// Displacements between two frames as the host takes them.
fn field<M: Motion>(
    motion: &M,
    from: &Frame<'_>,
    to: &Frame<'_>,
    max_threads: u32,
    cx: &Cx<'_>,
) -> Result<honami_plugin::Field> {
    check_size(to, (from.gray.width, from.gray.height))?;
    let n_threads = max_threads as usize;
    let [from, to] = [from, to].map(|frame| Motion::keep(motion, &picture(frame), n_threads));
    let go_on = |done: f64| cx.progress(done, MEASURING).is_ok();
    let field = motion.measure(&from, &to, n_threads, &go_on).ok_or_else(Error::cancelled)?;
    Ok(dense(field.grid, field.vectors()))
}
