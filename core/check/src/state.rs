//! Level 5: what a tracker saves between two frames, and another goes on with.

use crate::course::{HERE, at, difference, of_tracker};
use crate::work::Task;
use crate::{Check, Fault, Subject, Verdict};
use honami_abi::code;
use honami_host::{
    CallContext, Checkpoint, Code, HostError, Hosting, Point, Points, StreamInfo, Tracker, Values,
};
use rand::RngExt;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(60);

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "state.goes-on",
        level: 5,
        claim: "one that loads what another saved goes on to the same bits, here and in a process of its own",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| of_saving(subject, goes_on)),
    },
    Check {
        id: "state.aside",
        level: 5,
        claim: "saving changes nothing, and twice gives the same bytes",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| of_saving(subject, aside)),
    },
    Check {
        id: "state.damaged",
        level: 5,
        claim: "bytes that are cut, damaged, of another stream or of nobody are refused, and the stream goes on",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, |subject| of_saving(subject, damaged)),
    },
];

/// After so many frames of ten it saves.
const SAVED: usize = 4;

/// A clip, points in its first frame, and how it is told of them.
struct Scene {
    clip: crate::clip::Clip,
    seeds: Vec<Point>,
    stream: StreamInfo,
}

fn of_saving(
    subject: &Subject,
    check: fn(&Subject, &Scene) -> Result<Verdict, Fault>,
) -> Result<Verdict, Fault> {
    match Task::small(subject) {
        Task::Follow { clip, seeds } if subject.info.offers("honami.state/1") => {
            let stream = StreamInfo { births: 50_000..50_200, ..clip.stream() };
            check(subject, &Scene { clip, seeds, stream })
        }
        _ => Ok(Verdict::Beside("it saves nothing".into())),
    }
}

impl Scene {
    fn begun(&self, subject: &Subject, hosting: Hosting) -> Result<Tracker, HostError> {
        let mut tracker = subject.tracker(hosting, &Values::default())?;
        tracker.begin(self.stream.clone(), &CallContext::silent())?;
        Ok(tracker)
    }

    /// A tracker that has seen the first frames, with what it said of them.
    fn half(&self, subject: &Subject, hosting: Hosting) -> Result<(Tracker, Vec<Points>), HostError> {
        let mut tracker = self.begun(subject, hosting)?;
        tracker.seed(&self.seeds, &CallContext::silent())?;
        let all = self.push(&mut tracker, 0..SAVED)?;
        Ok((tracker, all))
    }

    fn push(&self, tracker: &mut Tracker, frames: std::ops::Range<usize>) -> Result<Vec<Points>, HostError> {
        let mut all = Vec::new();
        for t in frames {
            all.extend(tracker.push(&self.clip.view(t), &CallContext::silent())?);
        }
        Ok(all)
    }

    /// The rest of the frames.
    fn rest(&self, tracker: &mut Tracker) -> Result<Vec<Points>, HostError> {
        let mut all = self.push(tracker, SAVED..self.clip.pictures.len())?;
        all.extend(tracker.end(&CallContext::silent())?);
        Ok(all)
    }
}

fn goes_on(subject: &Subject, scene: &Scene) -> Result<Verdict, Fault> {
    let cx = CallContext::silent();
    let (mut wholes, mut n_bytes) = (Vec::new(), 0);
    // What works in a process of its own comes first, and is gone before this one is shut in: then it can end no other.
    for (hosting, place) in [(Hosting::Isolated, "in a process of its own"), (HERE, "here")] {
        let (mut tracker, _) = scene.half(subject, hosting)?;
        let saved = tracker.save(&cx).map_err(at(place))?;
        let whole = scene.rest(&mut tracker).map_err(at(place))?;
        let mut other = scene.begun(subject, hosting)?;
        other.load(&saved, &cx).map_err(at(place))?;
        let rest = scene.rest(&mut other).map_err(at(place))?;
        for (wanted, how) in
            [(Some(&whole), "without a break, and loaded"), (wholes.first(), "elsewhere, and")]
        {
            let found = wanted.and_then(|wanted| difference(wanted, &rest));
            if let Some(what) = found.filter(|_| subject.info.caps.deterministic) {
                return Err(Fault(format!("{how} {place}: {what}")));
            }
        }
        wholes.push(whole);
        n_bytes = saved.bytes.len();
    }
    Ok(Verdict::Holds(format!("{n_bytes} bytes")))
}

fn aside(subject: &Subject, scene: &Scene) -> Result<Verdict, Fault> {
    let cx = CallContext::silent();
    let (mut alone, _) = scene.half(subject, HERE)?;
    let (mut tracker, _) = scene.half(subject, HERE)?;
    let [once, twice] = [tracker.save(&cx)?, tracker.save(&cx)?];
    if once.bytes != twice.bytes {
        let place = once.bytes.iter().zip(&twice.bytes).position(|(a, b)| a != b);
        return Err(Fault(format!(
            "it saved {} bytes, and then {}; they differ from byte {} on",
            once.bytes.len(),
            twice.bytes.len(),
            place.unwrap_or(once.bytes.len().min(twice.bytes.len()))
        )));
    }
    let (alone, saving) = (scene.rest(&mut alone)?, scene.rest(&mut tracker)?);
    match difference(&alone, &saving).filter(|_| subject.info.caps.deterministic) {
        Some(what) => Err(Fault(format!("without and with saving: {what}"))),
        None => Ok(Verdict::Holds(String::new())),
    }
}

/// Places at which a byte is changed,
const N_CHANGED: usize = 24;
/// and of what a program has saved, which is started anew for each.
const N_CHANGED_OF_PROGRAM: usize = 8;

fn damaged(subject: &Subject, scene: &Scene) -> Result<Verdict, Fault> {
    let mut chance = subject.chance("state.damaged");
    let saved = scene.half(subject, HERE)?.0.save(&CallContext::silent())?;
    let len = saved.bytes.len();
    let with = |bytes: Vec<u8>| {
        let mut other = saved.clone();
        other.bytes = bytes;
        other
    };
    let mut cases = vec![("nothing".to_owned(), with(Vec::new()))];
    for kept in [1, len / 2, len.saturating_sub(1)] {
        cases.push((format!("the first {kept} of {len} bytes"), with(saved.bytes[..kept.min(len)].to_vec())));
    }
    cases.push(("a byte more".to_owned(), with([&*saved.bytes, &[0]].concat())));
    for _ in 0..3 {
        cases.push((
            "a million random bytes".to_owned(),
            with((0..1 << 20).map(|_| chance.random()).collect()),
        ));
    }
    let n_changed = if subject.info.is_program() { N_CHANGED_OF_PROGRAM } else { N_CHANGED };
    for _ in 0..if len > 0 { n_changed } else { 0 } {
        let (place, mut bytes) = (chance.random_range(0..len), saved.bytes.clone());
        bytes[place] ^= 1 << chance.random_range(0..8);
        cases.push((format!("its own bytes, of which byte {place} is changed"), with(bytes)));
    }
    for (what, bytes) in cases {
        refuses(subject, scene, &bytes).map_err(|fault| Fault(format!("given {what}: {fault}")))?;
    }
    let wide = StreamInfo { width: scene.stream.width + 8, ..scene.stream.clone() };
    let mut other = subject.tracker(HERE, &Values::default())?;
    other.begin(wide, &CallContext::silent())?;
    is_refused(other.load(&saved, &CallContext::silent()))
        .map_err(|fault| Fault(format!("given what was saved in a stream of another size: {fault}")))?;
    Ok(Verdict::Holds(String::new()))
}

/// Whether a tracker refuses these bytes, and works on all the same.
fn refuses(subject: &Subject, scene: &Scene, bytes: &Checkpoint) -> Result<(), Fault> {
    let mut tracker = scene.begun(subject, HERE)?;
    is_refused(tracker.load(bytes, &CallContext::silent()))?;
    tracker.seed(&scene.seeds, &CallContext::silent()).map_err(at("after it had refused them"))?;
    scene.push(&mut tracker, 0..2).map_err(at("after it had refused them"))?;
    Ok(())
}

fn is_refused(loaded: Result<(), HostError>) -> Result<(), Fault> {
    match loaded {
        Err(HostError::Failed { code: Code(code::DATA), .. }) => Ok(()),
        Err(error) => Err(error.into()),
        Ok(()) => Err(Fault("it took them, wanted HONAMI_E_DATA".into())),
    }
}
