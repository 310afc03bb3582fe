//! A call that takes a while: it says how far it is, and stops when it is told to.

use super::DEADLINE;
use crate::course::{HERE, of_able};
use crate::work::{Task, Work};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, Flow, HostError};
use rustix::time::{ClockId, clock_gettime};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "running.progress",
        level: 9,
        claim: "a long call says how far it is at least four times a second, and never goes back",
        deadline: DEADLINE,
        run: |subject| of_able(subject, |subject| progress(subject, &Task::large(subject))),
    },
    Check {
        id: "running.stop",
        level: 9,
        claim: "told to stop it does within half a second, gives no result, and can work again",
        deadline: DEADLINE,
        run: |subject| of_able(subject, |subject| stop(subject, &Task::large(subject))),
    },
];

/// A call may be silent for so long.
const SILENCE: Duration = Duration::from_millis(250);
/// A call that was told to stop may go on for so long.
const PATIENCE: Duration = Duration::from_millis(500);
/// Code that is not optimised explains so many times that long, and no more.
const SLOW: u32 = 4;

/// Time of the clock, and of this process alone: what takes long only because others work too is no fault.
#[derive(Clone, Copy, Debug, Default)]
struct Took {
    clock: Duration,
    own: Duration,
}

impl Took {
    fn max(self, other: Self) -> Self {
        Self { clock: self.clock.max(other.clock), own: self.own.max(other.own) }
    }
}

impl std::fmt::Display for Took {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ms", self.clock.as_millis())
    }
}

/// A moment from which time is taken.
#[derive(Clone, Copy, Debug)]
struct Since(Instant, Duration);

impl Since {
    fn now() -> Self {
        Self(Instant::now(), own())
    }

    fn took(self) -> Took {
        Took { clock: self.0.elapsed(), own: own().saturating_sub(self.1) }
    }
}

/// What this process has worked so far, on one thread.
fn own() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

/// What a call has said, and when.
struct Heard {
    last: Since,
    longest: Took,
    n: usize,
    done: f64,
    fell: Option<(f64, f64)>,
}

impl Heard {
    fn new() -> Self {
        Self { last: Since::now(), longest: Took::default(), n: 0, done: -1.0, fell: None }
    }

    fn hear(&mut self, done: f64) {
        self.end();
        self.n += 1;
        // Less than 0 is unknown.
        if done >= 0.0 {
            if done < self.done {
                self.fell.get_or_insert((self.done, done));
            }
            self.done = done;
        }
    }

    /// The call says something, or returns.
    fn end(&mut self) {
        self.longest = self.longest.max(self.last.took());
        self.last = Since::now();
    }
}

fn progress(subject: &Subject, task: &Task) -> Result<Verdict, Fault> {
    let mut work = Work::start(subject, HERE, task)?;
    let (mut longest, mut n) = (Took::default(), 0);
    for call in 0.. {
        let heard = Mutex::new(Heard::new());
        let listen = |done: f64, _: &str| {
            heard.lock().unwrap_or_else(PoisonError::into_inner).hear(done);
            Flow::Continue
        };
        let is_last = work.step(&CallContext { progress: &listen, ..CallContext::silent() })?;
        let mut heard = heard.into_inner().unwrap_or_else(PoisonError::into_inner);
        heard.end();
        if let Some((from, to)) = heard.fell {
            return Err(Fault(format!("in call {call} it was at {from}, and then at {to}")));
        }
        longest = longest.max(heard.longest);
        n += heard.n;
        if is_last {
            break;
        }
    }
    let said = format!("{n} times; silent for {longest} at most");
    if longest.own > SLOW * SILENCE {
        return Err(Fault(format!("{said}, wanted {} ms", SILENCE.as_millis())));
    }
    Ok(if longest.clock > SILENCE { Verdict::Doubtful(said) } else { Verdict::Holds(said) })
}

fn stop(subject: &Subject, task: &Task) -> Result<Verdict, Fault> {
    let mut work = Work::start(subject, HERE, task)?;
    let (was_told, slowest) = told_to_stop(&mut work, subject.info.is_program())?;
    if slowest.own > SLOW * PATIENCE {
        let silent = format!("it worked for {slowest} and never asked whether to go on");
        return Err(Fault(if was_told { format!("it went on for {slowest}") } else { silent }));
    }
    if !was_told {
        let said = format!("no call took more than {slowest}, and none heard that it must stop");
        return Ok(if slowest.clock > PATIENCE { Verdict::Doubtful(said) } else { Verdict::Beside(said) });
    }
    // The same instance is idle again, and as good as a fresh one.
    let small = Task::small(subject);
    let (again, fresh) = (work.again(&small).finish()?, Work::start(subject, HERE, &small)?.finish()?);
    if let Some(what) = again.difference(&fresh).filter(|_| subject.info.caps.deterministic) {
        return Err(Fault(format!("after a stop its work differs from that of a fresh instance: {what}")));
    }
    let took = slowest.to_string();
    Ok(if slowest.clock > PATIENCE { Verdict::Doubtful(took) } else { Verdict::Holds(took) })
}

/// Makes calls until one asks whether to go on and hears that it must not. Whether one did, and how long it then took;
/// else how long the longest call took. One that `is_apart`, in a process of its own, hears it late, and may have ended.
fn told_to_stop(work: &mut Work<'_>, is_apart: bool) -> Result<(bool, Took), Fault> {
    let mut slowest = Took::default();
    loop {
        let told = Mutex::new(None);
        let listen = |_: f64, _: &str| {
            told.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(Since::now);
            Flow::Stop
        };
        let begun = Since::now();
        let done = work.step(&CallContext { progress: &listen, ..CallContext::silent() });
        match (told.into_inner().unwrap_or_else(PoisonError::into_inner), done) {
            (Some(told), Err(HostError::Cancelled { .. })) => return Ok((true, told.took())),
            (Some(_), Ok(_)) if !is_apart => {
                return Err(Fault("it was told to stop, and gave a result".into()));
            }
            (_, Err(error)) => return Err(Fault(format!("told to stop: {error}"))),
            (_, Ok(is_last)) => {
                slowest = slowest.max(begun.took());
                if is_last {
                    return Ok((false, slowest));
                }
            }
        }
    }
}
