//! What a plugin holds on to, over many frames: memory, open files, threads.

use crate::course::{HERE, of_able};
use crate::work::{Task, Work};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, FrameView, HostError, StreamInfo};
use std::fs;
use std::time::Duration;

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "running.growth",
        level: 9,
        claim: "over 2,000 frames it takes no more memory, files and threads",
        deadline: Duration::from_secs(120),
        run: |subject| of_able(subject, |subject| growth(subject, 2_000)),
    },
    Check {
        id: "running.long-growth",
        level: 10,
        claim: "over 10,000 frames it takes no more memory, files and threads",
        deadline: Duration::from_secs(600),
        run: |subject| of_able(subject, |subject| growth(subject, 10_000)),
    },
];

/// Memory that comes and goes by itself, in an allocator that keeps what was freed.
const SLACK_BYTES: u64 = 3 << 20;

/// What this process holds.
#[derive(Clone, Copy, Debug)]
struct Held {
    bytes: u64,
    files: usize,
    threads: usize,
}

impl Held {
    /// What is held after work, once threads that have ended are gone.
    fn after(before: &Self) -> Result<Self, Fault> {
        const LOOKS: usize = 100;
        let mut now = Self::now()?;
        for _ in 0..LOOKS {
            if now.threads <= before.threads {
                break;
            }
            // A thread that was joined may still be in the list of the kernel.
            std::thread::sleep(Duration::from_millis(10));
            now = Self::now()?;
        }
        Ok(now)
    }

    /// As the system tells it.
    fn now() -> Result<Self, Fault> {
        let fault =
            |error: std::io::Error| Fault(format!("/proc does not tell what this process holds: {error}"));
        let statm = fs::read_to_string("/proc/self/statm").map_err(fault)?;
        let pages: u64 = statm.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or(0);
        let count = |folder: &str| fs::read_dir(folder).map(Iterator::count).map_err(fault);
        let bytes = pages * rustix::param::page_size() as u64;
        Ok(Self { bytes, files: count("/proc/self/fd")?, threads: count("/proc/self/task")? })
    }
}

fn growth(subject: &Subject, n_frames: usize) -> Result<Verdict, Fault> {
    if subject.info.is_program() {
        return Ok(Verdict::Beside("it is a program, whose process is its own".into()));
    }
    let task = &Task::endless(subject);
    let mut work = Work::start(subject, HERE, task)?;
    // What is made once is made in the first tenth.
    go(&mut work, task, n_frames / 10)?;
    let before = Held::now()?;
    go(&mut work, task, n_frames)?;
    let after = Held::after(&before)?;
    let grown = after.bytes.saturating_sub(before.bytes);
    let (files, threads) =
        (after.files.saturating_sub(before.files), after.threads.saturating_sub(before.threads));
    let said = format!("{} kB, {files} files, {threads} threads more after {n_frames} frames", grown >> 10);
    if grown > SLACK_BYTES || files > 0 || threads > 0 { Err(Fault(said)) } else { Ok(Verdict::Holds(said)) }
}

/// Leads a tracker to and fro through the frames of a task, in streams of 200 frames; a clusterer groups, and a structure
/// builder grows, ever again, a fiftieth as often.
fn go(work: &mut Work<'_>, task: &Task, n_frames: usize) -> Result<(), HostError> {
    const STREAM: usize = 200;
    let cx = CallContext::silent();
    let (Some(tracker), Task::Follow { clip, seeds }) = (work.tracker(), task) else {
        for _ in 0..n_frames / 50 {
            while !work.step(&cx)? {}
        }
        return Ok(());
    };
    let n = clip.pictures.len();
    for first in (0..n_frames).step_by(STREAM) {
        let n_stream = STREAM.min(n_frames - first);
        tracker.begin(StreamInfo { n_frames: Some(n_stream as u64), ..clip.stream() }, &cx)?;
        tracker.seed(seeds, &cx)?;
        for index in 0..n_stream {
            // There and back: n - 1 frames each way.
            let place = index % (2 * n - 2);
            let view = clip.view(place.min(2 * n - 2 - place));
            let time_s = index as f64 / crate::clip::FPS;
            tracker.push(&FrameView { index: index as i64, time_s, ..view }, &cx)?;
        }
        tracker.end(&cx)?;
    }
    Ok(())
}
