//! Level 8: simulators against what must be true of every plant in every wind.

use crate::course::{HERE, at, refusal};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{
    CallContext, Detail, HostError, Hosting, Kind, Node, PlantInstance, Simulator, Steps, Values, WindRows,
};
use rand::RngExt;
use rand_pcg::Pcg64;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(30);

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "simulator.rest",
        level: 8,
        claim: "in still air nothing moves",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, rest),
    },
    Check {
        id: "simulator.calms",
        level: 8,
        claim: "after a gust it comes to rest",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, calms),
    },
    Check {
        id: "simulator.chunks",
        level: 8,
        claim: "steps at once, one by one and after a reset lead to the same bits",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, chunks),
    },
    Check {
        id: "simulator.finer",
        level: 8,
        claim: "half the step halves the error at least",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, finer),
    },
    Check {
        id: "simulator.copies",
        level: 8,
        claim: "copies of a plant do what one does alone, each in its wind",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, copies),
    },
    Check {
        id: "simulator.turned",
        level: 8,
        claim: "a copy that is turned with its wind moves in its own axes as one that is not",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, turned),
    },
    Check {
        id: "simulator.detail",
        level: 8,
        claim: "what is not wanted is left out, and changes nothing of what is",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, detail),
    },
    Check {
        id: "simulator.state",
        level: 8,
        claim: "one that loads what another saved goes on to the same bits; other bytes are refused",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, state),
    },
    Check {
        id: "simulator.odd",
        level: 8,
        claim: "it moves or refuses a plant of one node, without thickness, of nodes in one place",
        deadline: DEADLINE,
        run: |subject| of_simulator(subject, odd),
    },
];

fn of_simulator(subject: &Subject, check: fn(&Subject) -> Result<Verdict, Fault>) -> Result<Verdict, Fault> {
    match subject.info.kind {
        Kind::Simulator => check(subject),
        kind => Ok(Verdict::Beside(format!("it is a {kind}"))),
    }
}

/// A copy as the plant is.
pub(crate) const PLAIN: PlantInstance = PlantInstance { yaw: 0.0, scale: 1.0, mass: 1.0 };
/// Seconds a step.
pub(crate) const DT: f64 = 1.0 / 240.0;
const STILL: WindRows<'static> = WindRows { times_s: &[], velocities: &[] };
/// A gust along x and a little upwards, and still air after it.
const GUST: WindRows<'static> = WindRows {
    times_s: &[0.0, 0.1, 0.3, 0.4],
    velocities: &[[0.0; 3], [6.0, 0.0, 1.0], [6.0, 0.0, 1.0], [0.0; 3]],
};
/// Off by less than this share of the motion is the same; the results are f32.
const SAME: f64 = 1e-3;

/// A small tree of forks: parents first, 2 m high.
pub(crate) fn sapling(chance: &mut Pcg64, n: u32) -> Vec<Node> {
    let mut nodes = vec![Node { parent: None, position: [0.0; 3], radius: 0.03, track: None }];
    for k in 1..n {
        let parent = (k - 1) / 2;
        let below = nodes[parent as usize];
        let mut aside = || if k < 3 { 0.0 } else { chance.random_range(-0.3..0.3) };
        let [x, y, z] = below.position;
        let position = [x + aside(), y + aside(), z + 0.4 + 0.05 * (k % 2) as f32];
        nodes.push(Node { parent: Some(parent), position, radius: 0.75 * below.radius, track: None });
    }
    nodes
}

/// A simulator with a sapling of 15 nodes in these copies.
fn prepared(subject: &Subject, hosting: Hosting, copies: &[PlantInstance]) -> Result<Simulator, HostError> {
    let nodes = sapling(&mut subject.chance("simulator.plant"), 15);
    let mut simulator = subject.simulator(hosting, &Values::default())?;
    simulator.prepare(&nodes, copies, 1, 1, &CallContext::silent())?;
    Ok(simulator)
}

fn go(simulator: &mut Simulator, n: u32, wind: WindRows<'_>) -> Result<Vec<[f32; 3]>, HostError> {
    let steps = Steps { dt: DT, n, wind, detail: None };
    Ok(simulator.step(&steps, &CallContext::silent())?.to_vec())
}

fn largest(motion: &[[f32; 3]]) -> f64 {
    motion.as_flattened().iter().fold(0.0, |most, v| f64::from(v.abs()).max(most))
}

fn apart(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |most, (a, b)| (f64::from(*a) - f64::from(*b)).abs().max(most))
}

fn rest(subject: &Subject) -> Result<Verdict, Fault> {
    let mut simulator = prepared(subject, HERE, &[PLAIN])?;
    for (what, wind) in [("no wind", STILL), ("a wind of 0", WindRows { velocities: &[[0.0; 3]; 4], ..GUST })]
    {
        let moved = largest(&go(&mut simulator, 240, wind)?);
        if moved > 0.0 {
            return Err(Fault(format!("in {what} a node is {moved} m from where it rests after 1 s")));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

/// The largest motion in each of so many seconds from the end of the gust on.
fn after_gust(simulator: &mut Simulator, seconds: u32) -> Result<Vec<f64>, HostError> {
    let mut largest_of = Vec::new();
    go(simulator, 96, GUST)?;
    for _ in 0..seconds {
        let mut most = 0.0_f64;
        for _ in 0..24 {
            most = most.max(largest(&go(simulator, 10, GUST)?));
        }
        largest_of.push(most);
    }
    Ok(largest_of)
}

fn calms(subject: &Subject) -> Result<Verdict, Fault> {
    let sways = after_gust(&mut prepared(subject, HERE, &[PLAIN])?, 12)?;
    let (first, last) = (sways[0], sways[sways.len() - 1]);
    if first == 0.0 {
        return Err(Fault("a gust of 6 m/s moves nothing".into()));
    }
    // Modes that beat let the largest node grow for a while.
    if let Some(k) = sways.iter().position(|sway| *sway > 2.0 * first) {
        return Err(Fault(format!("{k} s after the gust it sways by {} m, at first by {first}", sways[k])));
    }
    if last > 0.9 * first {
        return Err(Fault(format!("12 s after the gust it still sways by {last} m, at first by {first}")));
    }
    Ok(Verdict::Holds(format!("{first:.3} m, after 12 s {last:.4} m")))
}

fn chunks(subject: &Subject) -> Result<Verdict, Fault> {
    let mut simulator = prepared(subject, HERE, &[PLAIN])?;
    let wanted = go(&mut simulator, 60, GUST)?;
    for parts in [&[60][..], &[1; 60], &[7, 0, 13, 40, 0]] {
        simulator.reset(&CallContext::silent())?;
        let mut last = Vec::new();
        for &n in parts {
            last = go(&mut simulator, n, GUST)?;
        }
        if last != wanted {
            let n = parts.len();
            return Err(Fault(format!("60 steps in {n} calls lead {} m away", apart(&last, &wanted))));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

fn finer(subject: &Subject) -> Result<Verdict, Fault> {
    let mut simulator = prepared(subject, HERE, &[PLAIN])?;
    let mut ends = Vec::new();
    for n in [60, 120, 240, 1920] {
        let steps = Steps { dt: 0.25 / f64::from(n), n, wind: GUST, detail: None };
        simulator.reset(&CallContext::silent())?;
        ends.push(simulator.step(&steps, &CallContext::silent())?.to_vec());
    }
    let size = largest(&ends[3]);
    let [coarse, middle, fine] = [0, 1, 2].map(|k| apart(&ends[k], &ends[3]) / size);
    let is_exact = |error: f64| error < SAME;
    if !(is_exact(middle) || middle < 0.7 * coarse) || !(is_exact(fine) || fine < 0.7 * middle) {
        return Err(Fault(format!(
            "steps of 1/240, 1/480 and 1/960 s are off by {coarse:.1e}, {middle:.1e} and {fine:.1e} of the motion"
        )));
    }
    Ok(Verdict::Holds(format!("{coarse:.1e}, {middle:.1e}, {fine:.1e}")))
}

fn copies(subject: &Subject) -> Result<Verdict, Fault> {
    let winds = [[6.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0; 3]];
    let each = WindRows { times_s: &[0.0], velocities: &winds };
    let all = go(&mut prepared(subject, HERE, &[PLAIN; 3])?, 60, each)?;
    for (k, copy) in all.chunks_exact(all.len() / 3).enumerate() {
        let own = WindRows { times_s: &[0.0], velocities: &winds[k..=k] };
        let alone = go(&mut prepared(subject, HERE, &[PLAIN])?, 60, own)?;
        if apart(copy, &alone) > SAME * largest(&alone) {
            return Err(Fault(format!("copy {k} of 3 is {} m from one alone", apart(copy, &alone))));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

fn turned(subject: &Subject) -> Result<Verdict, Fault> {
    let yaw = 0.7_f64;
    let turn = |[x, y, z]: [f32; 3]| {
        let (sin, cos) = (yaw.sin() as f32, yaw.cos() as f32);
        [cos * x - sin * y, sin * x + cos * y, z]
    };
    let winds: Vec<_> = GUST.velocities.iter().map(|wind| turn(*wind)).collect();
    let plain = go(&mut prepared(subject, HERE, &[PLAIN])?, 60, GUST)?;
    let mut other = prepared(subject, HERE, &[PlantInstance { yaw: yaw as f32, ..PLAIN }])?;
    let moved = go(&mut other, 60, WindRows { velocities: &winds, ..GUST })?;
    let off = apart(&plain, &moved) / largest(&plain);
    if off > SAME {
        return Err(Fault(format!("turned by 0.7 with its wind it is off by {off:.1e} of the motion")));
    }
    Ok(Verdict::Holds(format!("{off:.1e}")))
}

fn detail(subject: &Subject) -> Result<Verdict, Fault> {
    let all = go(&mut prepared(subject, HERE, &[PLAIN; 2])?, 60, GUST)?;
    let half = all.len() / 2;
    for [first, second] in [[0, 0], [15, 1], [0, 7], [4, 15]] {
        let wanted = [first, second].map(|nodes| Detail { nodes, modes: u32::MAX });
        let steps = Steps { dt: DT, n: 60, wind: GUST, detail: Some(&wanted) };
        let mut simulator = prepared(subject, HERE, &[PLAIN; 2])?;
        let some = simulator.step(&steps, &CallContext::silent())?.to_vec();
        let of = [&all[..first as usize], &all[half..half + second as usize]].concat();
        if some != of {
            return Err(Fault(format!("{first} and {second} nodes of two copies are not those of all")));
        }
        let next = go(&mut simulator, 1, GUST)?;
        let mut whole = prepared(subject, HERE, &[PLAIN; 2])?;
        go(&mut whole, 60, GUST)?;
        if next != go(&mut whole, 1, GUST)? {
            return Err(Fault(format!("after {first} and {second} nodes of two copies all go on otherwise")));
        }
    }
    Ok(Verdict::Holds(String::new()))
}

fn state(subject: &Subject) -> Result<Verdict, Fault> {
    if !subject.info.offers("honami.state/1") {
        return Ok(Verdict::Beside("it saves nothing".into()));
    }
    // First, while this process may still start others; it is gone before this one is shut in.
    let (saved, wanted) = saved_half_way(subject)?;
    let cx = CallContext::silent();
    let mut simulator = prepared(subject, HERE, &[PLAIN])?;
    simulator.load(&saved, &cx)?;
    if simulator.save(&cx)? != saved {
        return Err(Fault("it loads what another saved, and saves other bytes".into()));
    }
    if go(&mut simulator, 30, GUST)? != wanted {
        return Err(Fault("one that loads what another saved goes on otherwise".into()));
    }
    let mut chance = subject.chance("simulator.state");
    let noise: Vec<u8> = (0..saved.len()).map(|_| chance.random()).collect();
    for (what, bytes) in
        [("no bytes", &[][..]), ("half of them", &saved[..saved.len() / 2]), ("noise", &noise)]
    {
        match simulator.load(bytes, &cx) {
            Ok(()) => return Err(Fault(format!("it loads {what}"))),
            Err(error) if refusal(&error).is_some() => {}
            Err(error) => return Err(at(what)(error)),
        }
    }
    simulator.load(&saved, &cx)?;
    if go(&mut simulator, 30, GUST)? != wanted {
        return Err(Fault("after it was given other bytes it goes on otherwise".into()));
    }
    Ok(Verdict::Holds(format!("{} bytes", saved.len())))
}

/// What one in a process of its own saves after 30 steps, and where 30 more lead it.
fn saved_half_way(subject: &Subject) -> Result<(Vec<u8>, Vec<[f32; 3]>), Fault> {
    let mut there = prepared(subject, Hosting::Isolated, &[PLAIN])?;
    go(&mut there, 30, GUST)?;
    let cx = CallContext::silent();
    let saved = there.save(&cx)?;
    if there.save(&cx)? != saved {
        return Err(Fault("saved twice, it gave other bytes".into()));
    }
    Ok((saved, go(&mut there, 30, GUST)?))
}

fn odd(subject: &Subject) -> Result<Verdict, Fault> {
    let base = sapling(&mut subject.chance("simulator.odd"), 7);
    let thin = base.iter().map(|node| Node { radius: 0.0, ..*node }).collect();
    let in_one_place = base.iter().map(|node| Node { position: [0.0; 3], ..*node }).collect();
    let far: Vec<_> =
        base.iter().map(|node| Node { position: node.position.map(|x| 1e6 * x), ..*node }).collect();
    let mut refused = Vec::new();
    for (what, nodes) in [
        ("one node", base[..1].to_vec()),
        ("no thickness", thin),
        ("one place", in_one_place),
        ("1000 km", far),
    ] {
        let mut simulator = subject.simulator(HERE, &Values::default())?;
        let moved = simulator.prepare(&nodes, &[PLAIN], 1, 1, &CallContext::silent());
        match moved.and_then(|_| go(&mut simulator, 10, GUST)) {
            Ok(_) => {}
            Err(error) if refusal(&error).is_some() => refused.push(what),
            Err(error) => return Err(at(what)(error)),
        }
    }
    let words = if refused.is_empty() { String::new() } else { format!("refuses {}", refused.join(", ")) };
    Ok(Verdict::Holds(words))
}
