//! Level 9: the same work in other circumstances gives the same result; whoever is told to stop does; nothing grows.

mod growth;
mod stopping;

use crate::course::{HERE, file_missed};
use crate::work::{Outcome, Task, Work};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, HostError, Hosting};
use std::thread;
use std::time::Duration;

pub(crate) fn checks() -> Vec<Check> {
    [CHECKS, stopping::CHECKS, growth::CHECKS].concat()
}

const DEADLINE: Duration = Duration::from_secs(60);

const CHECKS: &[Check] = &[
    Check {
        id: "running.twice",
        level: 9,
        claim: "the same input and seed give the same bits",
        deadline: DEADLINE,
        run: |subject| same(subject, |subject, task| Work::start(subject, HERE, task)?.finish()),
    },
    Check {
        id: "running.threads",
        level: 9,
        claim: "1 thread and 4 give the same bits",
        deadline: DEADLINE,
        run: |subject| same(subject, |subject, task| Work::start(subject, HERE, task)?.threads(4).finish()),
    },
    Check {
        id: "running.isolated",
        level: 9,
        claim: "in a process of its own it gives the same bits",
        deadline: DEADLINE,
        run: isolated,
    },
    Check {
        id: "running.again",
        level: 9,
        claim: "an instance that has worked before gives what a fresh one does",
        deadline: DEADLINE,
        run: |subject| same(subject, again),
    },
    Check {
        id: "running.left",
        level: 9,
        claim: "an instance that is dropped in the middle of its work disturbs nobody",
        deadline: DEADLINE,
        run: |subject| same(subject, left),
    },
    Check {
        id: "running.turns",
        level: 9,
        claim: "two instances that take turns give what each gives alone",
        deadline: DEADLINE,
        run: |subject| alike(subject, turns),
    },
    Check {
        id: "running.parallel",
        level: 9,
        claim: "two instances that work at once give what each gives alone",
        deadline: DEADLINE,
        run: parallel,
    },
    Check {
        id: "running.callers",
        level: 9,
        claim: "calls may come from any thread, one at a time",
        deadline: DEADLINE,
        run: |subject| same(subject, callers),
    },
];

/// What an instance alone gives, and what one gives that works in another way.
type Pair = [Outcome; 2];

/// Whether a way to work gives what an instance alone gives.
fn same(subject: &Subject, way: fn(&Subject, &Task) -> Result<Outcome, HostError>) -> Result<Verdict, Fault> {
    alike(subject, |subject, task| Ok(vec![[alone(subject, task)?, way(subject, task)?]]))
}

fn alone(subject: &Subject, task: &Task) -> Result<Outcome, HostError> {
    Work::start(subject, HERE, task)?.finish()
}

/// Whether both of every pair are the same.
fn alike(
    subject: &Subject,
    pairs: impl Fn(&Subject, &Task) -> Result<Vec<Pair>, HostError>,
) -> Result<Verdict, Fault> {
    if let Some(beside) = file_missed(subject)? {
        return Ok(Verdict::Beside(beside));
    }
    let pairs = pairs(subject, &Task::small(subject))?;
    match pairs.iter().find_map(|[alone, other]| alone.difference(other)) {
        None => Ok(Verdict::Holds(String::new())),
        Some(_) if !subject.info.caps.deterministic => {
            Ok(Verdict::Holds("results differ, as its manifest says".into()))
        }
        Some(what) => Err(Fault(what)),
    }
}

fn isolated(subject: &Subject) -> Result<Verdict, Fault> {
    if subject.info.is_program() {
        return Ok(Verdict::Beside("it is a program, which always has one".into()));
    }
    alike(subject, |subject, task| {
        // First, while this process may still start others.
        let there = Work::start(subject, Hosting::Isolated, task)?.finish()?;
        Ok(vec![[alone(subject, task)?, there]])
    })
}

fn again(subject: &Subject, task: &Task) -> Result<Outcome, HostError> {
    // Pictures of another size, and other points, come first.
    let other = Task::endless(subject);
    let mut work = Work::start(subject, HERE, &other)?;
    work.finish()?;
    work.again(task).finish()
}

fn left(subject: &Subject, task: &Task) -> Result<Outcome, HostError> {
    let cx = CallContext::silent();
    let mut whole = Work::start(subject, HERE, task)?;
    for steps in 0..5 {
        let mut other = Work::start(subject, HERE, task)?;
        for _ in 0..steps {
            if other.step(&cx)? {
                break;
            }
        }
        drop(other);
        if whole.step(&cx)? {
            return Ok(whole.outcome().clone());
        }
    }
    whole.finish()
}

fn turns(subject: &Subject, task: &Task) -> Result<Vec<Pair>, HostError> {
    let cx = CallContext::silent();
    let other = Task::endless(subject);
    let tasks = [task, &other];
    let alone = tasks.iter().map(|task| alone(subject, task)).collect::<Result<Vec<_>, _>>()?;
    let works = tasks.iter().map(|task| Work::start(subject, HERE, task));
    let mut works = works.collect::<Result<Vec<_>, _>>()?;
    let mut is_done = vec![false; works.len()];
    while is_done.contains(&false) {
        for (work, is_done) in works.iter_mut().zip(&mut is_done).filter(|(_, is_done)| !**is_done) {
            *is_done = work.step(&cx)?;
        }
    }
    Ok(alone.into_iter().zip(&works).map(|(alone, work)| [alone, work.outcome().clone()]).collect())
}

fn parallel(subject: &Subject) -> Result<Verdict, Fault> {
    if !subject.info.caps.parallel_instances {
        return Ok(Verdict::Beside("its manifest does not say that they may".into()));
    }
    alike(subject, |subject, task| {
        let expected = alone(subject, task)?;
        let outcomes = thread::scope(|scope| {
            let others = [(); 2].map(|()| scope.spawn(|| alone(subject, task)));
            let mut outcomes = vec![alone(subject, task)];
            // A panic there is a fault of this program, which it takes with it.
            let joined =
                others.map(|other| other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
            outcomes.extend(joined);
            outcomes
        });
        outcomes.into_iter().map(|outcome| Ok([expected.clone(), outcome?])).collect()
    })
}

fn callers(subject: &Subject, task: &Task) -> Result<Outcome, HostError> {
    let mut work = Work::start(subject, HERE, task)?;
    loop {
        let step = thread::scope(|scope| scope.spawn(|| work.step(&CallContext::silent())).join());
        if step.unwrap_or_else(|panic| std::panic::resume_unwind(panic))? {
            return Ok(work.outcome().clone());
        }
    }
}
