//! Level 4: the values of parameters. Whatever the manifest allows must be borne, and mean what it says.

use crate::clip::{Clip, Texture, grid};
use crate::course::{HERE, difference, follow, of_able, refusal};
use crate::simulator::{DT, PLAIN, sapling};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{
    CallContext, Clustering, Filmed, Grown, HostError, Kind, Numeric, Param, ParamKind, Points, Steps, Value,
    Values, WindRows,
};
use rand::RngExt;
use rand_pcg::Pcg64;
use std::time::Duration;

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "params.when",
        level: 4,
        claim: "what a parameter depends on is there, and can have the value that it asks for",
        deadline: Duration::from_secs(10),
        run: when,
    },
    Check {
        id: "params.renamed",
        level: 4,
        claim: "old names lead to parameters that are there",
        deadline: Duration::from_secs(20),
        run: |subject| of_able(subject, renamed),
    },
    Check {
        id: "params.default",
        level: 4,
        claim: "it works with its defaults, and the same values give the same result again",
        deadline: Duration::from_secs(30),
        run: |subject| of_able(subject, same),
    },
    Check {
        id: "params.choices",
        level: 4,
        claim: "it works with every choice",
        deadline: Duration::from_secs(60),
        run: |subject| of_able(subject, choices),
    },
    Check {
        id: "params.extremes",
        level: 4,
        claim: "it bears every number at both ends of its range",
        deadline: Duration::from_secs(120),
        run: |subject| of_able(subject, extremes),
    },
    Check {
        id: "params.random",
        level: 4,
        claim: "it bears random sets of values",
        deadline: Duration::from_secs(120),
        run: |subject| of_able(subject, random),
    },
    Check {
        id: "params.inactive",
        level: 4,
        claim: "a parameter that does not count under the others changes nothing",
        deadline: Duration::from_secs(60),
        run: |subject| of_able(subject, inactive),
    },
];

/// Random sets of values
const N_SETS: usize = 50;
/// of a library; of a program, which is started anew for each, so many.
const N_SETS_OF_PROGRAM: usize = 20;

/// What came of a short use.
#[derive(Debug, PartialEq)]
enum Outcome {
    Points(Vec<Points>),
    Clustering(Clustering),
    Grown(Grown),
    Motion(Vec<[f32; 3]>),
    /// It says that it cannot work with this, and why.
    Refused(String),
}

/// A little work for whatever it is: four points through three small frames, or six tracks, or twelve in four groups.
fn work(subject: &Subject, values: &Values) -> Result<Outcome, HostError> {
    let done = match subject.info.kind {
        Kind::Tracker => points(subject, values).map(Outcome::Points),
        Kind::Clusterer => clustering(subject, values).map(Outcome::Clustering),
        Kind::Simulator => motion(subject, values).map(Outcome::Motion),
        Kind::Structure => grown(subject, values).map(Outcome::Grown),
    };
    match done {
        Err(error) => refusal(&error).map(|why| Outcome::Refused(why.to_owned())).ok_or(error),
        done => done,
    }
}

fn points(subject: &Subject, values: &Values) -> Result<Vec<Points>, HostError> {
    let mut chance = subject.chance("params.clip");
    let texture = Texture::new(&mut chance);
    let clip =
        Clip::new([48, 36], 3, |[x, y], t| 128.0 + texture.at([x - 1.3 * t as f64, y + 0.6 * t as f64]));
    let seeds = grid([48, 36], 8.0, [2, 2], &mut chance);
    let mut tracker = subject.tracker(HERE, values)?;
    follow(&mut tracker, &clip, &seeds)
}

fn motion(subject: &Subject, values: &Values) -> Result<Vec<[f32; 3]>, HostError> {
    let (nodes, cx) = (sapling(&mut subject.chance("params.plant"), 7), CallContext::silent());
    let mut simulator = subject.simulator(HERE, values)?;
    simulator.prepare(&nodes, &[PLAIN], 1, 1, &cx)?;
    let wind = WindRows { times_s: &[0.0], velocities: &[[3.0, 1.0, 0.0]] };
    Ok(simulator.step(&Steps { dt: DT, n: 10, wind, detail: None }, &cx)?.to_vec())
}

fn clustering(subject: &Subject, values: &Values) -> Result<Clustering, HostError> {
    let tracks = crate::clusterer::two_groups(&mut subject.chance("params.tracks"), 6);
    subject.clusterer(HERE, values)?.run(&tracks, &CallContext::silent())
}

fn grown(subject: &Subject, values: &Values) -> Result<Grown, HostError> {
    let (tracks, groups) = crate::structure::four_groups(&mut subject.chance("params.groups"), 12);
    let filmed = Filmed { tracks: &tracks, groups: &groups, root: None, mask: None };
    subject.structure(HERE, values)?.run(&filmed, &CallContext::silent())
}

/// Sets of values that it worked with, and that it refused with a reason.
#[derive(Default)]
struct Tally {
    n: usize,
    n_refused: usize,
    reason: String,
}

impl Tally {
    /// Works with these values; a fault names them.
    fn work(&mut self, subject: &Subject, values: &Values) -> Result<(), Fault> {
        let set: Vec<_> = values.iter().map(|(id, value)| format!("{id}={value}")).collect();
        let done =
            work(subject, values).map_err(|error| Fault(format!("with {}: {error}", set.join(" "))))?;
        self.n += 1;
        if let Outcome::Refused(why) = done {
            self.n_refused += 1;
            self.reason = why;
        }
        Ok(())
    }

    fn verdict(self, what: &str) -> Verdict {
        match (self.n, self.n_refused) {
            (0, _) => Verdict::Beside(format!("it has no {what}")),
            (n, 0) => Verdict::Holds(format!("{n} sets")),
            (n, refused) if refused == n => {
                Verdict::Doubtful(format!("it refused all {n} sets, the last with: {}", self.reason))
            }
            (n, refused) => Verdict::Holds(format!("{n} sets, {refused} of them refused: {}", self.reason)),
        }
    }
}

fn when(subject: &Subject) -> Result<Verdict, Fault> {
    let params = &subject.info.params;
    let mut n = 0;
    for param in params {
        for (other, wanted) in &param.when {
            n += 1;
            let fault = |what: String| Fault(format!("{} depends on {other}={wanted}: {what}", param.id));
            let found = params.iter().find(|param| param.id == *other);
            let found = found.ok_or_else(|| fault(format!("there is no parameter {other}")))?;
            found.check(wanted.clone()).map_err(|error| fault(error.to_string()))?;
            if depends(params, found, &param.id, params.len()) {
                return Err(fault(format!("and {other} depends on {}", param.id)));
            }
        }
    }
    Ok(if n == 0 {
        Verdict::Beside("no parameter depends on others".into())
    } else {
        Verdict::Holds(String::new())
    })
}

/// Whether a parameter depends on another, over so many steps at most.
fn depends(params: &[Param], param: &Param, on: &str, steps: usize) -> bool {
    param.id == on
        || steps > 0
            && param.when.keys().any(|id| {
                params
                    .iter()
                    .find(|other| other.id == *id)
                    .is_some_and(|next| depends(params, next, on, steps - 1))
            })
}

fn renamed(subject: &Subject) -> Result<Verdict, Fault> {
    let info = &subject.info;
    for (old, new) in &info.renamed {
        let param = info.params.iter().find(|param| param.id == *new);
        let param = param.ok_or_else(|| Fault(format!("{old} was renamed to {new}, which is not there")))?;
        let kept = Values::from_iter([(old.clone(), param.default())]);
        work(subject, &kept).map_err(|error| Fault(format!("with {old}: {error}")))?;
    }
    let n = info.renamed.len();
    Ok(if n == 0 {
        Verdict::Beside("nothing was renamed".into())
    } else {
        Verdict::Holds(format!("{n} names"))
    })
}

fn same(subject: &Subject) -> Result<Verdict, Fault> {
    let defaults = Values::defaults(&subject.info.params);
    let (unsaid, said) = (work(subject, &Values::default())?, work(subject, &defaults)?);
    match (&unsaid, &said) {
        (Outcome::Refused(why), _) => Ok(Verdict::Doubtful(format!("it refuses its defaults: {why}"))),
        _ if unsaid == said => Ok(Verdict::Holds(String::new())),
        _ if !subject.info.caps.deterministic => {
            Ok(Verdict::Holds("results differ, as its manifest says".into()))
        }
        (Outcome::Points(a), Outcome::Points(b)) => {
            Err(Fault(format!("the same values twice: {}", difference(a, b).unwrap_or_default())))
        }
        _ => Err(Fault("the same values gave another result the second time".into())),
    }
}

fn choices(subject: &Subject) -> Result<Verdict, Fault> {
    let mut tally = Tally::default();
    for param in &subject.info.params {
        let all: Vec<Value> = match &param.kind {
            ParamKind::Enum { entries, .. } => entries.iter().map(|e| Value::Text(e.id.clone())).collect(),
            ParamKind::Bool { .. } => [false, true].map(Value::Bool).into(),
            _ => continue,
        };
        for value in all {
            tally.work(subject, &alone(subject, param, value))?;
        }
    }
    Ok(tally.verdict("choices"))
}

/// One parameter set, those that it depends on as it wants them, and the others at their defaults.
fn alone(subject: &Subject, param: &Param, value: Value) -> Values {
    let mut set = active(&subject.info.params, param, subject.info.params.len());
    set.push((param.id.clone(), value));
    Values::from_iter(set)
}

/// Values under which a parameter counts, over so many steps of dependence.
fn active(params: &[Param], param: &Param, steps: usize) -> Vec<(String, Value)> {
    let mut set = Vec::new();
    for (id, wanted) in param.when.iter().filter(|_| steps > 0) {
        if let Some(other) = params.iter().find(|other| other.id == *id) {
            set.extend(active(params, other, steps - 1));
        }
        set.push((id.clone(), wanted.clone()));
    }
    set
}

/// The ends of a number's range. One without an end is any number that a person might type.
fn ends(kind: &ParamKind) -> Vec<Value> {
    match kind {
        ParamKind::Int(Numeric { min, max, .. }) => {
            [min.unwrap_or(-1_000_000), max.unwrap_or(1_000_000)].map(Value::Int).into()
        }
        ParamKind::Float(Numeric { min, max, .. }) => {
            [min.unwrap_or(-1e9), max.unwrap_or(1e9)].map(Value::Float).into()
        }
        ParamKind::Seed { .. } => [0, i64::MAX].map(Value::Int).into(),
        ParamKind::Vec2 { .. } => [-1e6, 1e6].map(|end| Value::List(vec![end; 2])).into(),
        ParamKind::Rect { .. } => [0.0, 1e6].map(|end| Value::List(vec![end; 4])).into(),
        ParamKind::String { .. } => [String::new(), "ä".repeat(4000)].map(Value::Text).into(),
        ParamKind::Bool { .. } | ParamKind::Enum { .. } | ParamKind::Path { .. } => Vec::new(),
    }
}

fn extremes(subject: &Subject) -> Result<Verdict, Fault> {
    let mut tally = Tally::default();
    for param in &subject.info.params {
        for end in ends(&param.kind) {
            tally.work(subject, &alone(subject, param, end))?;
        }
    }
    Ok(tally.verdict("numbers"))
}

fn random(subject: &Subject) -> Result<Verdict, Fault> {
    let mut chance = subject.chance("params.random");
    let mut tally = Tally::default();
    let n = if subject.info.is_program() { N_SETS_OF_PROGRAM } else { N_SETS };
    for _ in 0..if subject.info.params.is_empty() { 0 } else { n } {
        let set = subject.info.params.iter().map(|param| (param.id.clone(), any(param, &mut chance)));
        tally.work(subject, &set.collect())?;
    }
    Ok(tally.verdict("parameters"))
}

/// A value that a person might choose: within a slider's ends more often than beyond.
fn any(param: &Param, chance: &mut Pcg64) -> Value {
    let beyond = chance.random_bool(0.1);
    match &param.kind {
        ParamKind::Bool { .. } => Value::Bool(chance.random()),
        ParamKind::Int(Numeric { min, max, soft_min, soft_max, .. }) => {
            let low = soft_min.filter(|_| !beyond).or(*min).unwrap_or(-1000);
            let high = soft_max.filter(|_| !beyond).or(*max).unwrap_or(1000).max(low);
            Value::Int(chance.random_range(low..=high))
        }
        ParamKind::Float(Numeric { min, max, soft_min, soft_max, .. }) => {
            let low = soft_min.filter(|_| !beyond).or(*min).unwrap_or(-1000.0);
            let high = soft_max.filter(|_| !beyond).or(*max).unwrap_or(1000.0).max(low);
            // Small numbers of a range that spans decades come as often as large ones.
            let share = chance.random::<f64>();
            let value = if low > 0.0 { low * (high / low).powf(share) } else { low + (high - low) * share };
            Value::Float(value.clamp(low, high))
        }
        ParamKind::Seed { .. } => Value::Int(chance.random_range(0..i64::MAX)),
        ParamKind::Enum { entries, default } => {
            let entry = entries.get(chance.random_range(0..entries.len().max(1)));
            Value::Text(entry.map_or_else(|| default.clone(), |entry| entry.id.clone()))
        }
        ParamKind::Vec2 { .. }
        | ParamKind::Rect { .. }
        | ParamKind::String { .. }
        | ParamKind::Path { .. } => param.default(),
    }
}

fn inactive(subject: &Subject) -> Result<Verdict, Fault> {
    let params = &subject.info.params;
    let idle: Vec<_> = params.iter().filter_map(|param| Some((param, idle(params, param)?))).collect();
    if idle.is_empty() || !subject.info.caps.deterministic {
        return Ok(Verdict::Beside("no parameter depends on others, or its results differ anyway".into()));
    }
    for (param, others) in &idle {
        let base = work(subject, &others.iter().cloned().collect())?;
        for end in ends(&param.kind) {
            let set = others.iter().cloned().chain([(param.id.clone(), end.clone())]);
            if work(subject, &set.collect())? != base {
                let others: Vec<_> = others.iter().map(|(id, value)| format!("{id}={value}")).collect();
                let id = &param.id;
                return Err(Fault(format!(
                    "{id} does not count with {}, but {id}={end} does",
                    others.join(" ")
                )));
            }
        }
    }
    Ok(Verdict::Holds(format!("{} parameters", idle.len())))
}

/// Values under which a parameter does not count: one that it depends on has another than it wants.
fn idle(params: &[Param], param: &Param) -> Option<Vec<(String, Value)>> {
    let (id, wanted) = param.when.iter().next()?;
    let other = params.iter().find(|other| other.id == *id)?;
    let mut set = active(params, other, params.len());
    let value = match &other.kind {
        ParamKind::Bool { .. } => Value::Bool(*wanted != Value::Bool(true)),
        ParamKind::Enum { entries, .. } => {
            entries.iter().map(|entry| Value::Text(entry.id.clone())).find(|value| value != wanted)?
        }
        _ => return None,
    };
    set.push((id.clone(), value));
    Some(set)
}
