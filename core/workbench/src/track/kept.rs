//! A run while its tracker works: what is kept of it, and which other trackers go on where one cannot.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use honami_host::{CallContext, Host, HostError, Tracker};
use honami_media::Media;
use honami_store::Seam;

use super::frames::{Keeper, Kept, hand};
use crate::drive::{self, Death, Driven, Plan, Relay, Rows};
use crate::error::WorkbenchError;
use crate::progress::Progress;
use crate::rebuilt::{Beside, Found, Lookout, Made, Stretch};

/// How far a run came, and what a rebuilt tracker makes of the frames before it took over.
pub(super) struct Tracked {
    pub(super) driven: Driven,
    pub(super) beside: Option<Found>,
}

impl Tracked {
    /// Of a run that has failed.
    pub(super) fn up_to(end: u32) -> Self {
        Self { driven: Driven { end, step_secs: Vec::new(), warnings: Vec::new() }, beside: None }
    }
}

/// Tracks all, and keeps it.
pub(super) fn track(
    kept: &mut Kept,
    media: &Arc<Media>,
    (mut tracker, made): (Tracker, Made),
    host: &Host,
    plan: Plan,
    progress: &dyn Progress,
) -> Result<Tracked, WorkbenchError> {
    let stretch = Stretch { rows: Vec::new(), seeds: plan.seeds.clone(), max_threads: plan.max_threads };
    let n_frames = u64::from(plan.frames.end - plan.frames.start);
    let lookout = Lookout::new(host.clone(), made.clone());
    let kept = Mutex::new(kept);
    let mut shift = Shift {
        kept: &kept,
        media,
        host,
        lookout: &lookout,
        progress,
        made,
        next: None,
        before: None,
        failed: BTreeSet::new(),
        stretch,
        since: 0,
        seam: 0,
        beside: None,
        said: Vec::new(),
    };
    let mut numbers = |n| Ok(hand(&kept).writer.reserve_tracks(n)?);
    let mut sink = |frame: u32, rows: &Rows| hand(&kept).add(frame, rows);
    let keeper = Keeper { kept: &kept, progress };
    let driven = lookout.during(progress, || {
        drive::drive(media, &mut tracker, plan, &mut numbers, &mut sink, Some(&mut shift), &keeper)
    });
    let Shift { beside, said, .. } = shift;
    hand(&kept).flush()?;
    let mut driven = match driven {
        Ok(driven) => driven,
        Err(error) => {
            // Nobody waits for what is beside a run that has failed.
            if let Some(beside) = beside {
                beside.give_up();
            }
            return Err(error);
        }
    };
    let beside = beside.and_then(|beside| beside.end(n_frames, progress));
    driven.warnings.extend(said);
    Ok(Tracked { driven, beside })
}

/// Gives a drive its other trackers, and tells the run of them.
struct Shift<'a> {
    kept: &'a Mutex<&'a mut Kept>,
    media: &'a Arc<Media>,
    host: &'a Host,
    lookout: &'a Lookout,
    progress: &'a dyn Progress,
    /// The build that is at work.
    made: Made,
    /// A rebuilt one that is about to take over.
    next: Option<Made>,
    /// The one before, while the one at work is on trial.
    before: Option<Made>,
    /// Hashes of builds that have failed in this run, or could not take over.
    failed: BTreeSet<String>,
    /// The frames before the last seam.
    stretch: Stretch,
    /// The first frame of the build before it.
    since: u32,
    seam: u32,
    beside: Option<Beside>,
    /// What whoever reads the run's end should know.
    said: Vec<String>,
}

impl Shift<'_> {
    fn has_failed(&self, made: &Made) -> bool {
        self.failed.contains(&made.origin.plugin_sha256)
    }

    fn say(&mut self, line: String) {
        self.progress.say(&line);
        self.said.push(line);
    }

    fn write(&self, seam: &Seam) -> Result<(), WorkbenchError> {
        Ok(hand(self.kept).writer.seam(seam)?)
    }

    /// A tracker of the file as it is now, or where that is no good of the copy that was kept of the build at work.
    fn another(&self) -> Result<(Tracker, Made), HostError> {
        let cx = CallContext::silent();
        match self.made.start_anew(self.host, &cx) {
            Ok((tracker, made)) if !self.has_failed(&made) => Ok((tracker, made)),
            Err(error) if self.made.is_in_its_file() => Err(error),
            _ => self.made.start_again(self.host, &cx),
        }
    }
}

impl Relay for Shift<'_> {
    fn again(&mut self, seam: &Seam, death: Death) -> Result<(Tracker, Death), WorkbenchError> {
        let (tracker, made) = self.another()?;
        let build = (!made.is(&self.made)).then(|| made.build());
        if build.is_some() {
            self.since = seam.frame;
        }
        if death == Death::First || build.is_some() {
            self.write(&Seam { build: build.clone(), ..seam.clone() })?;
        }
        self.made = made;
        // Another build may well do the frame.
        Ok((tracker, if build.is_some() { Death::First } else { death }))
    }

    fn rebuilt(&mut self) -> Option<Tracker> {
        let ready = self.lookout.take().filter(|ready| !ready.made.is(&self.made))?;
        if self.has_failed(&ready.made) {
            self.say(format!("{} has failed in this run, and is not tried again", ready.made.build()));
            return None;
        }
        self.next = Some(ready.made);
        Some(ready.tracker)
    }

    fn refused(&mut self, why: &HostError) {
        if let Some(next) = self.next.take() {
            self.say(format!("{} cannot take over, and the build before goes on: {why}", next.build()));
            self.failed.insert(next.origin.plugin_sha256);
        }
    }

    fn taken(&mut self, frame: u32) -> Result<(), WorkbenchError> {
        let Some(next) = self.next.take() else { return Ok(()) };
        self.write(&Seam { frame, why: "was rebuilt".to_owned(), build: Some(next.build()) })?;
        self.progress.say(&format!("{} tracks from frame {frame} on", next.build()));
        self.before = Some(std::mem::replace(&mut self.made, next));
        self.stretch.rows = hand(self.kept).recent(self.since);
        self.seam = frame;
        Ok(())
    }

    fn given_up(&mut self, frame: u32, why: &str) -> Result<(), WorkbenchError> {
        let Some(before) = self.before.take() else { return Ok(()) };
        let failed = std::mem::replace(&mut self.made, before);
        let why = format!("was given up: {why}");
        self.write(&Seam { frame, why: why.clone(), build: Some(self.made.build()) })?;
        let (new, old) = (failed.build(), self.made.build());
        self.progress.say(&format!("{new} {why}; {old} tracks from frame {frame} on again"));
        self.failed.insert(failed.origin.plugin_sha256);
        Ok(())
    }

    fn proved(&mut self) {
        self.before = None;
        self.since = self.seam;
        if let Some(earlier) = self.beside.take() {
            earlier.give_up();
        }
        let stretch = Stretch { rows: std::mem::take(&mut self.stretch.rows), ..self.stretch.clone() };
        let (media, host) = (Arc::clone(self.media), self.host.clone());
        self.beside = Beside::begin(media, host, self.made.clone(), stretch, self.seam);
    }
}
