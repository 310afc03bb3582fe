//! Level 10: calls in any order, and a death in the middle of one.

use crate::clip::{Clip, FPS, Texture};
use crate::course::{HERE, of_able, of_tracker, refusal};
use crate::work::{Task, Work};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{
    CallContext, DetectRequest, Flow, FrameView, HostError, Hosting, Point, StreamInfo, Tracker, Values,
};
use rand::RngExt;
use rand_pcg::Pcg64;
use rustix::process::{Pid, Signal, kill_process};
use std::collections::BTreeSet;
use std::fs;
use std::time::Duration;

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "stress.order",
        level: 10,
        claim: "it bears calls in any order that the host lets through",
        deadline: Duration::from_secs(120),
        run: |subject| of_tracker(subject, order),
    },
    Check {
        id: "stress.killed",
        level: 10,
        claim: "when its process is killed in the middle of a call, another goes on",
        deadline: Duration::from_secs(120),
        run: |subject| of_able(subject, killed),
    },
];

/// Instances that are used at random, and calls of each.
const N_INSTANCES: usize = 40;
const N_CALLS: usize = 60;

fn order(subject: &Subject) -> Result<Verdict, Fault> {
    let mut chance = subject.chance("stress.order");
    let clips = [[48, 36], [33, 50]].map(|size| {
        let texture = Texture::new(&mut chance);
        Clip::new(size, 6, |[x, y], t| 128.0 + texture.at([x - 2.0 * t as f64, y]))
    });
    let (mut n, mut n_refused) = (0, 0);
    for instance in 0..N_INSTANCES {
        let mut tracker = subject.tracker(HERE, &Values::default())?;
        let mut done = Vec::new();
        let mut index = 0;
        for _ in 0..N_CALLS {
            n += 1;
            let (name, result) = any_call(subject, &mut tracker, &clips, &mut index, &mut chance);
            done.push(name);
            match result {
                Ok(()) => {}
                // The host's own refusals, and stops, leave it as it is.
                Err(HostError::Usage { .. } | HostError::Cancelled { .. }) => n_refused += 1,
                Err(error) if refusal(&error).is_some() => {
                    n_refused += 1;
                    break;
                }
                Err(error) => {
                    return Err(Fault(format!("instance {instance}, after {}: {error}", done.join(" "))));
                }
            }
        }
    }
    Ok(Verdict::Holds(format!("{n} calls, {n_refused} of them refused")))
}

/// A call by chance, legal or not, with what it is called.
fn any_call(
    subject: &Subject,
    tracker: &mut Tracker,
    clips: &[Clip; 2],
    index: &mut i64,
    chance: &mut Pcg64,
) -> (&'static str, Result<(), HostError>) {
    let stops = chance.random_bool(0.05);
    let listen = move |_: f64, _: &str| if stops { Flow::Stop } else { Flow::Continue };
    let cx = CallContext { progress: &listen, ..CallContext::silent() };
    let clip = &clips[usize::from(chance.random_bool(0.1))];
    let view = clip.view(chance.random_range(0..clip.pictures.len()));
    match chance.random_range(0..20) {
        0 => ("end", tracker.end(&cx).map(|_| ())),
        1 | 2 => {
            *index = chance.random_range(-5..100_000);
            let births = if chance.random() { 0..0 } else { 1000..1100 };
            let stream = StreamInfo { births, seed: chance.random(), ..clip.stream() };
            ("begin", tracker.begin(StreamInfo { n_frames: None, ..stream }, &cx))
        }
        3..=5 => {
            let mut point =
                |id| Point { id, x: chance.random_range(-20.0..80.0), y: chance.random_range(-20.0..80.0) };
            let points: Vec<_> = [3, 5, 8, 13, u32::MAX].into_iter().map(&mut point).collect();
            let n = chance.random_range(0..=points.len());
            ("seed", tracker.seed(&points[..n], &cx))
        }
        6 | 7 => ("retire", tracker.retire(&[chance.random_range(0..15), 5, 5, u32::MAX], &cx)),
        8 if subject.info.offers("honami.detect/1") => {
            let wanted = DetectRequest {
                frame: view,
                max_features: 9,
                mask: None,
                points: &[],
                max_threads: 2,
                seed: 0,
            };
            ("detect", tracker.detect(&wanted, &cx).map(|_| ()))
        }
        9 if subject.info.offers("honami.field/1") => {
            ("field", tracker.field(&view, &clip.view(0), 2, &cx).map(|_| ()))
        }
        _ => {
            *index += chance.random_range(1..4);
            let view = FrameView { index: *index, time_s: *index as f64 / FPS, ..view };
            ("push", tracker.push(&view, &cx).map(|_| ()))
        }
    }
}

fn killed(subject: &Subject) -> Result<Verdict, Fault> {
    let (large, small) = (Task::large(subject), Task::small(subject));
    let before = children();
    let alone = Work::start(subject, Hosting::Isolated, &small)?.finish()?;
    let mut work = Work::start(subject, Hosting::Isolated, &large)?;
    let its: Vec<_> = children().difference(&before).filter_map(|pid| Pid::from_raw(*pid)).collect();
    let kill = |_: f64, _: &str| {
        // One that has gone already needs no killing.
        its.iter().for_each(|&pid| kill_process(pid, Signal::KILL).unwrap_or_default());
        Flow::Continue
    };
    let ended = loop {
        match work.step(&CallContext { progress: &kill, ..CallContext::silent() }) {
            Ok(false) => {}
            Ok(true) => return Ok(Verdict::Beside("no call said how far it was".into())),
            Err(HostError::Ended { how, .. }) => break how,
            Err(error) => return Err(Fault(format!("its process was killed, and the host says: {error}"))),
        }
    };
    let again = Work::start(subject, Hosting::Isolated, &small)?.finish()?;
    if let Some(what) = again.difference(&alone).filter(|_| subject.info.caps.deterministic) {
        return Err(Fault(format!("after another was killed it works differently: {what}")));
    }
    Ok(Verdict::Holds(format!("it {ended}")))
}

/// The processes that this one has started.
fn children() -> BTreeSet<i32> {
    let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let lists = threads.filter_map(|thread| fs::read_to_string(thread.path().join("children")).ok());
    lists
        .flat_map(|list| list.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<_>>())
        .collect()
}
