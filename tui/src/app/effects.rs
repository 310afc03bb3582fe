//! The only door to the world: what the state wants done is done here, and what comes of it becomes facts.

mod mattes;
mod plugins;
mod window;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use honami_model::document::RunId;
use honami_model::edit::Transaction;
use honami_model::history::{Entry, EntryId, Step};
use honami_model::judgement::Judgement;
use honami_model::track::TrackId;
use honami_workbench::WorkbenchError;
use honami_workbench::cluster::{self, ClusterRequest};
use honami_workbench::offer::{Granted, Wish};
use honami_workbench::retrack::{self, Way};
use honami_workbench::scale::{self, ScaleBar};
use honami_workbench::session::Session;
use honami_workbench::store::{Project, StoreError};
use honami_workbench::track::{self, TrackRequest};
use honami_workbench::used::Used;
use honami_workbench::{correct, dense, regroup, shape, versus};

use super::command_log::{self, Origin};
use super::correcting::{Answer, Ask};
use super::dense::Measuring;
use super::groups::Groups;
use super::in_space::InSpace;
use super::jobs::{Done, Running, Work};
use super::offering::Offering;
use super::rebuilding::Rebuilding;
use super::recovery::Recovery;
use super::reviewing::Reviewing;
use super::seat::Seat;
use super::skeleton::Hand;
use super::state::{Job, Notice, State};
use super::tracks::TrackRow;
use super::update::{Effect, Fact, Hint, Judge};
use super::viewing::Viewing;
use crate::term::signals::Waker;

/// The world: the project, the clip, the plugins, and the job that runs.
pub(super) struct World {
    session: Session,
    waker: Waker,
    running: Option<(Running, Job)>,
    /// What the running job was asked by.
    asked: Option<Effect>,
    /// Measures suspicion; `None` where there is no thread for it.
    reviewing: Option<Reviewing>,
    /// Measures dense motion, once that was asked for.
    measuring: Option<Measuring>,
    rows: BTreeMap<TrackId, TrackRow>,
    /// The tracks in space that the state was told of.
    space: Option<InSpace>,
    /// What plugins were told last.
    used: Used,
    /// Entries of the undo tree that the state has been told of.
    n_told: usize,
    /// Where the user was when it was last kept.
    seat: Seat,
    /// Entries of the undo tree that were there when the session began.
    n_before: usize,
    /// The track that a correction is open on.
    studied: Option<TrackId>,
    /// Looks after the files of plugins; `None` where there are none but shipped ones, or no thread for it.
    rebuilding: Option<Rebuilding>,
    /// Works corrections out; `None` where there is no thread for it.
    offering: Option<Offering>,
    /// The matte that was found last, and not kept yet.
    found: Option<mattes::Found>,
    /// The viewer's window, where it is open.
    viewing: Option<Viewing>,
}

/// Facts, or the line that says why there are none.
type Facts = Result<Vec<Fact>, WorkbenchError>;

impl World {
    pub(super) fn new(session: Session, waker: Waker) -> Self {
        let reviewing = Reviewing::start(Arc::clone(&session.media), waker.clone()).ok();
        let offering = Offering::start(waker.clone()).ok();
        let rebuilding = Rebuilding::start(session.registry.plugins(), waker.clone());
        let (rows, seat) = (BTreeMap::new(), Seat::default());
        let (running, measuring) = (None, None);
        let n_before = session.project.history().entries().len();
        Self {
            session,
            waker,
            running,
            asked: None,
            reviewing,
            measuring,
            rows,
            space: None,
            used: Used::default(),
            n_told: 0,
            n_before,
            seat,
            studied: None,
            rebuilding,
            offering,
            found: None,
            viewing: None,
        }
    }

    /// The state to begin with, of the usual size.
    pub(super) fn state(&mut self) -> Result<State, WorkbenchError> {
        let project = &self.session.project;
        let name = project.path().file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let mut state = State::new(name, self.session.media.clip().clone(), (80, 24));
        if project.access() == honami_workbench::store::Access::Read {
            let holder = project.holder();
            state.read_only = Some(holder.map_or_else(|| "somebody else".to_owned(), |h| h.to_string()));
        }
        state.plugins = self.plugins();
        state.n_ready = self.session.media.n_ready();
        let mut notes = self.session.notes.clone();
        notes.extend_from_slice(self.session.media.notes());
        notes.extend(self.session.registry.unusable().map(str::to_owned));
        notes.extend(state.read_only.iter().map(|holder| format!("read only: {holder} holds this project")));
        notes.extend(self.reviewing.is_none().then(|| "no thread: suspicion is not measured".to_owned()));
        if state.read_only.is_none()
            && let Some(run) = track::unfinished(project)?
        {
            let run = project.run(run)?;
            let id = &run.head.provenance.plugin_id;
            let name = id.rsplit('.').next().unwrap_or(id);
            notes.push(format!("run {} of {name} ended early, at frame {}", run.id.0, run.found.end));
            state.recovery = Some(Recovery::of_earlier(run.id));
        }
        if !notes.is_empty() {
            state.notice = Some(Notice { text: notes.join(" · "), is_error: false });
        }
        for fact in self.shown()? {
            super::update::update(&mut state, super::update::Msg::Fact(fact));
        }
        // A seat that another version has left in another shape is as good as none.
        if let Some(seat) = self.session.project.seat()?.and_then(|seat| serde_json::from_str(&seat).ok()) {
            Seat::take(&seat, &mut state);
        }
        self.seat = Seat::of(&state);
        Ok(state)
    }

    /// Which project it is, and where its document stands.
    pub(super) fn origin(&self) -> Origin {
        let project = &self.session.project;
        Origin {
            project: project
                .path()
                .file_stem()
                .map_or_else(String::new, |s| s.to_string_lossy().into_owned()),
            clip: project.clip().sha256.clone(),
            revision: project.revision().0,
        }
    }

    /// Keeps where the user is, unless it is kept already, or cannot be because others write.
    pub(super) fn keep(&mut self, seat: Seat) -> Result<(), WorkbenchError> {
        let is_writer = self.session.project.access() == honami_workbench::store::Access::Write;
        if is_writer && self.running.is_none() && seat != self.seat {
            self.session.project.set_seat(&serde_json::to_string(&seat).unwrap_or_default())?;
            self.seat = seat;
        }
        Ok(())
    }

    /// Whether the user is elsewhere than was kept.
    pub(super) fn has_moved(&self, seat: &Seat) -> bool {
        *seat != self.seat
    }

    /// Frames decoded so far.
    pub(super) fn n_ready(&self) -> u32 {
        self.session.media.n_ready()
    }

    /// Whether more frames will be: the first that is missing has not failed.
    pub(super) fn is_decoding(&self) -> bool {
        self.session.media.try_frame(self.n_ready()).is_ok()
    }

    /// The project file.
    pub(super) fn project(&self) -> &Path {
        self.session.project.path()
    }

    pub(super) fn session(&self) -> &Session {
        &self.session
    }

    pub(super) fn media(&self) -> Arc<honami_workbench::media::Media> {
        Arc::clone(&self.session.media)
    }

    /// Does what the state wants; what fails becomes a line.
    pub(super) fn carry_out(&mut self, effect: Effect, now: Duration) -> Vec<Fact> {
        let asked = match &effect {
            Effect::Track(_) | Effect::Retrack { .. } | Effect::Cluster(_) | Effect::Resume(_) => {
                Some(effect.clone())
            }
            _ => None,
        };
        let done = match effect {
            Effect::Commit(transaction, hint) => self.commit(transaction, hint),
            Effect::Judge(found) => self.judge(found),
            Effect::Correct(step, hint) => self.correct(&step, hint),
            Effect::Regroup(step, hint) => regroup::prepare(&self.session.project, &step)
                .and_then(|transaction| self.commit(transaction, hint)),
            Effect::Shape(step, hint) => shape::prepare(&self.session.project, &step)
                .and_then(|transaction| self.commit(transaction, hint)),
            Effect::Scale(bar, hint) => self.scale(bar, hint),
            Effect::Study(track) => {
                self.studied = Some(track);
                self.layers().map(|fact| fact.into_iter().collect())
            }
            Effect::Offer(ask) => Ok(self.offer(ask)),
            Effect::Keep(wish, hint) => self.keep_granted(&wish, hint),
            Effect::AddFeature { frame, at } => self.add_feature(frame, at),
            Effect::Undo(n) => self.travel("undone", n, Project::undo),
            Effect::Jump(to) => self.jump(to),
            Effect::Redo(n) => self.travel("redone", n, Project::redo),
            Effect::Track(request) => self.track(&request, now),
            Effect::Retrack { track, way, frame, within } => self.retrack((track, way, frame), within, now),
            Effect::Measure(track) => self.measure(track),
            Effect::Versus(runs) => self.versus(runs),
            Effect::Entrants(first) => {
                versus::entrants(&self.session.project).map(|entrants| vec![Fact::Entrants(first, entrants)])
            }
            Effect::Cluster(request) => self.cluster(&request, now),
            Effect::Resume(run) => self.resume(run, now),
            Effect::Release(plugin) => self.release(&plugin),
            Effect::Silent(patience) => {
                self.running.iter().for_each(|(running, _)| running.answer(patience));
                Ok(Vec::new())
            }
            Effect::StopJob => Ok(self.stop_job()),
            Effect::LookAtMatte(frame) => self.look_at_matte(frame),
            Effect::FindMatte(frame, n, plane) => self.find_matte((frame, n), &plane, now),
            Effect::KeepMatte(frame, hint) => self.keep_matte(frame, hint),
            Effect::SaveLog(text) => self.save_log(&text),
            Effect::OpenWindow => Ok(self.open_window()),
            Effect::ShowWindow => Ok(self.show_window()),
            Effect::Tell(command) => Ok(self.tell_window(&command)),
            Effect::Edit(asked, hint) => return self.edit(&asked, hint),
            Effect::CloseWindow => {
                self.viewing.take().into_iter().for_each(Viewing::close);
                Ok(Vec::new())
            }
            // The loop's own.
            Effect::Follow(_)
            | Effect::Teach
            | Effect::Mouse(_)
            | Effect::Redraw
            | Effect::Suspend
            | Effect::Leave => Ok(Vec::new()),
        };
        match (done, asked) {
            (Ok(facts), None) => facts,
            (Ok(facts), asked) => {
                self.asked = asked;
                facts
            }
            (Err(error), asked) => {
                let recovery = asked.map(|asked| Fact::Recovery(Recovery::of_failure(&asked, &error)));
                [failed(&error), Fact::Refused].into_iter().chain(recovery).collect()
            }
        }
    }

    fn stop_job(&self) -> Vec<Fact> {
        self.running.iter().for_each(|(running, _)| running.stop());
        Vec::new()
    }

    fn commit(&mut self, transaction: Transaction, hint: Hint) -> Facts {
        let line = format!("{} ({hint})", transaction.label);
        self.session.project.commit(transaction)?;
        self.studied = None;
        self.shown_and(said(line))
    }

    fn scale(&mut self, bar: Option<ScaleBar>, hint: Hint) -> Facts {
        let transaction = scale::prepare(&self.session.project, bar)?;
        self.commit(transaction, hint)
    }

    fn correct(&mut self, step: &correct::Step, hint: Hint) -> Facts {
        let (transaction, made) = correct::prepare(&mut self.session.project, step)?;
        let mut facts = self.commit(transaction, hint)?;
        facts.push(Fact::Corrected(made));
        Ok(facts)
    }

    fn judge(&mut self, found: Judge) -> Facts {
        let project = &self.session.project;
        let Judge { track, frames, verdict, reasons, mut effort } = found;
        // A segment that is judged again has taken what it took before, too.
        let judged = project.document().track(track).and_then(|track| track.judgements.get(&frames.start));
        if let Some(Judgement { effort: before, .. }) = judged {
            effort.keystrokes += before.keystrokes;
            effort.key_frames += before.key_frames;
            effort.seconds += before.seconds;
        }
        let seal = project.shown(track)?.map(|span| span.seal(frames.clone()));
        let reviewer = project.holder().map_or_else(String::new, |holder| holder.user.clone());
        let time = honami_workbench::store::now();
        let judgement = Judgement { end_frame: frames.end, verdict, reasons, reviewer, time, effort, seal };
        self.commit(Transaction::judge(track, frames.start, judgement), "u undoes")
    }

    /// What the studied track is made from.
    fn layers(&mut self) -> Result<Option<Fact>, WorkbenchError> {
        let Some(track) = self.studied else { return Ok(None) };
        let layers = self.session.project.layers(track)?;
        if let Some(offering) = self.offering.as_mut().filter(|_| layers.is_some()) {
            offering.study(retrack::study(&self.session, track)?);
        }
        Ok(Some(Fact::Layers(layers.map(Arc::new))))
    }

    /// Has something worked out behind the screen; without a thread for it nothing comes of a wish.
    fn offer(&mut self, ask: Ask) -> Vec<Fact> {
        match (&mut self.offering, ask) {
            (Some(offering), ask) => {
                offering.ask(ask);
                Vec::new()
            }
            (None, Ask::Ghost(Some(wish))) => {
                let why = "there is no thread to track again on; Tab offers another correction".to_owned();
                vec![Fact::Offered(Answer::Ghost(wish, Err(why)))]
            }
            (None, _) => Vec::new(),
        }
    }

    /// Keeps what was previewed.
    fn keep_granted(&mut self, wish: &Wish, hint: Hint) -> Facts {
        match self.offering.as_mut().and_then(|offering| offering.take(wish)) {
            Some(Granted::Ready(correction)) => self.commit(correction.transaction, hint),
            Some(Granted::Retracked(retracked)) => {
                let line = retrack::finish(&mut self.session, *retracked)?.line;
                self.studied = None;
                self.shown_and(said(format!("{line} ({hint})")))
            }
            None => {
                let line =
                    format!("track {} has changed since this was worked out: nothing was kept", wish.track);
                Ok(vec![said_wrong(line), Fact::Refused])
            }
        }
    }

    fn save_log(&self, text: &str) -> Facts {
        Ok(vec![match command_log::save(text, self.session.project.path()) {
            Ok(path) => said(format!("the log of this session is saved as {}", path.display())),
            Err(error) => said_wrong(format!("the log of this session is not saved: {error}")),
        }])
    }

    fn add_feature(&mut self, frame: u32, [x, y]: [f32; 2]) -> Facts {
        let track = TrackId(self.session.project.reserve_tracks(1)?.start);
        let mut facts = self.commit(Transaction::add_track(track, frame, x, y), "t r tracks it, u undoes")?;
        facts.push(Fact::Placed(track));
        Ok(facts)
    }

    /// Goes so many edits back or forward, as far as there are any.
    fn travel(
        &mut self,
        word: &str,
        n: u32,
        go: fn(&mut Project) -> Result<Option<Entry>, StoreError>,
    ) -> Facts {
        let (mut labels, mut failure, mut n_old) = (Vec::new(), None, 0);
        for _ in 0..n {
            match go(&mut self.session.project) {
                Ok(Some(entry)) => {
                    n_old += usize::from(word == "undone" && (entry.id.0 as usize) < self.n_before);
                    labels.push(entry.label);
                }
                Ok(None) => break,
                Err(error) => {
                    failure = Some(error);
                    break;
                }
            }
        }
        let line = match &labels[..] {
            [] => format!("nothing to be {word}"),
            [label] => format!("{word}: {label}"),
            [.., last] => format!("{word}: {} edits, the last of them: {last}", labels.len()),
        };
        let line = match (n_old, labels.len()) {
            (1, 1) => format!("{line} (made before this session)"),
            (n, _) if n > 0 => format!("{line} ({n} of them made before this session)"),
            _ => line,
        };
        // What was done before something failed is shown all the same.
        self.arrived(match failure {
            None => said(line),
            Some(error) if labels.is_empty() => failed(&error.into()),
            Some(error) => said_wrong(format!("{line}; the next: {error}")),
        })
    }

    /// Goes to an entry of the undo tree, and says how far that was.
    fn jump(&mut self, to: EntryId) -> Facts {
        let history = self.session.project.history();
        let path = history.path(history.head(), to).unwrap_or_default();
        let n_back = path.iter().filter(|step| matches!(step, Step::Back(_))).count();
        let label = history.get(to).map_or_else(String::new, |entry| entry.label.clone());
        self.session.project.jump(to)?;
        let n_again = path.len() - n_back;
        let line = match (n_back, n_again) {
            (0, 0) => format!("this is edit {to} already: {label}"),
            (_, 0) => format!("at edit {to}: {label} ({n_back} taken back)"),
            (0, _) => format!("at edit {to}: {label} ({n_again} done again)"),
            _ => format!("at edit {to}: {label} ({n_back} taken back, {n_again} done again)"),
        };
        self.arrived(said(line))
    }

    /// At another edit; a track that is there again is what the user wanted back.
    fn arrived(&mut self, fact: Fact) -> Facts {
        let before: Vec<TrackId> = self.rows.keys().copied().collect();
        let mut facts = self.shown_and(fact)?;
        let again = self.rows.keys().find(|track| before.binary_search(track).is_err());
        facts.extend(again.map(|track| Fact::ThereAgain(*track)));
        Ok(facts)
    }

    fn track(&mut self, request: &TrackRequest, now: Duration) -> Facts {
        let work = Work::Track(Box::new(track::prepare(&mut self.session, request)?));
        self.start(work, &request.plugin, true, now)
    }

    /// Goes on with a run that has ended early, or with the newest.
    fn resume(&mut self, run: Option<RunId>, now: Duration) -> Facts {
        let run = match run {
            Some(run) => run,
            None => track::unfinished(&self.session.project)?
                .ok_or(WorkbenchError::NothingToResume { run: None })?,
        };
        let job = track::resume(&mut self.session, run)?;
        let plugin = job.plugin().to_owned();
        self.start(Work::Track(Box::new(job)), &plugin, true, now)
    }

    fn retrack(
        &mut self,
        (track, way, frame): (TrackId, Way, u32),
        within: Option<Range<u32>>,
        now: Duration,
    ) -> Facts {
        let study = Arc::new(retrack::study(&self.session, track)?);
        let job = study.job(study.around(way, frame, Vec::new(), within))?;
        self.start(Work::Retrack(Box::new(job)), "re-tracking", false, now)
    }

    fn cluster(&mut self, request: &ClusterRequest, now: Duration) -> Facts {
        let work = Work::Cluster(Box::new(cluster::prepare(&self.session, request)?));
        self.start(work, &request.plugin, false, now)
    }

    /// Finds two runs to be beside each other: these, or the usual ones.
    fn versus(&self, runs: Option<[RunId; 2]>) -> Facts {
        let entrants = versus::entrants(&self.session.project)?;
        let find = |run: RunId| entrants.iter().find(|one| one.run == run).cloned();
        let two = match runs {
            None => versus::usual(&entrants),
            Some([a, b]) => find(a).zip(find(b)).map(<[_; 2]>::from),
        };
        Ok(vec![Fact::Versus(two.map(Box::new))])
    }

    /// Has a tracker measure dense motion from now on.
    fn measure(&mut self, track: Option<TrackId>) -> Facts {
        let meter = dense::prepare(&self.session, track)?;
        let plugin = meter.plugin().to_owned();
        self.measuring = Some(Measuring::new(meter, self.waker.clone()));
        Ok(vec![Fact::Measures(plugin)])
    }

    /// What is known of the dense motion of the shown frame, where it is shown and that has changed.
    pub(super) fn dense(&mut self, state: &State) -> Option<Fact> {
        let shown = state.dense.as_ref().filter(|_| state.motion.is_on)?;
        let (frame, n_frames) = (state.shown_frame(), state.clip.n_frames());
        let n_ready = self.n_ready();
        match self.measuring.as_mut()?.look(frame, state.play.is_some(), n_ready, n_frames) {
            Ok(field) => (shown.field != field).then_some(Fact::Dense(field)),
            Err(error) => Some(Fact::NotMeasured(error.to_string())),
        }
    }

    fn start(&mut self, work: Work, plugin: &str, keeps_frames: bool, since: Duration) -> Facts {
        let (plugin, what) = (plugin.to_owned(), "starting".to_owned());
        let first = match &work {
            Work::Track(job) => u64::from(job.frames().start),
            _ => 0,
        };
        let (done, is_stopping) = ((0, 0), false);
        let (frame, quiet) = (None, None);
        let job = Job { plugin, what, done, first, since, keeps_frames, is_stopping, frame, quiet };
        match Running::start(work, self.waker.clone()) {
            Ok(running) => {
                self.running = Some((running, job.clone()));
                Ok(vec![Fact::Job(Some(job))])
            }
            Err(error) => Ok(vec![said_wrong(format!("no thread for the job: {error}"))]),
        }
    }

    /// What has become of the review, and of the running job.
    pub(super) fn news(&mut self) -> Vec<Fact> {
        let (told, failed) = self.reviewing.as_ref().map(Reviewing::told).unwrap_or_default();
        let mut news: Vec<Fact> = (!told.is_empty()).then_some(Fact::Review(told)).into_iter().collect();
        news.extend(failed.map(|error| said_wrong(format!("suspicion cannot be measured: {error}"))));
        let answers = self.offering.as_mut().map(Offering::news).unwrap_or_default();
        news.extend(answers.into_iter().map(Fact::Offered));
        news.extend(self.job_news());
        let heard = self.viewing.as_mut().map(Viewing::news).unwrap_or_default();
        news.extend(heard.into_iter().map(Fact::Window));
        news.extend(self.rebuilt().into_iter().flatten());
        news
    }

    fn job_news(&mut self) -> Vec<Fact> {
        let Some((running, job)) = &mut self.running else { return Vec::new() };
        // Before its last words are asked for it must have ended.
        let is_finished = running.is_finished();
        let prints = running.prints();
        let mut facts: Vec<Fact> =
            (!prints.is_empty()).then_some(Fact::Printed(prints)).into_iter().collect();
        facts.extend(running.said().into_iter().map(Fact::Happened));
        if !is_finished {
            let step = running.step();
            let is = Job {
                done: (step.done, step.total),
                what: step.what,
                frame: step.frame,
                quiet: running.quiet(),
                ..job.clone()
            };
            if is != *job {
                *job = is;
                facts.push(Fact::Job(Some(job.clone())));
            }
            return facts;
        }
        facts.push(Fact::Job(None));
        let asked = self.asked.take();
        facts.extend(self.finish().unwrap_or_else(|error| {
            let recovery = asked.map(|asked| Fact::Recovery(Recovery::of_failure(&asked, &error)));
            [failed(&error)].into_iter().chain(recovery).collect()
        }));
        facts
    }

    /// Takes the ended job's result into the project.
    fn finish(&mut self) -> Facts {
        let Some((running, job)) = self.running.take() else { return Ok(Vec::new()) };
        let before = self.session.project.revision();
        let mut recovery = None;
        let (mut text, is_error) = match running.join() {
            Some(Done::Track(done)) => {
                let outcome = track::finish(&mut self.session, (*done)?)?;
                recovery = Recovery::of_run(&outcome);
                (outcome.line, outcome.error.is_some())
            }
            Some(Done::Retrack(done)) => match *done {
                Err(WorkbenchError::Stopped) => {
                    ("re-tracking stopped; nothing was changed".to_owned(), false)
                }
                done => (retrack::finish(&mut self.session, done?)?.line, false),
            },
            Some(Done::Cluster(done)) => match *done {
                Err(WorkbenchError::Stopped) => {
                    (format!("{} stopped; nothing was changed", job.plugin), false)
                }
                done => (cluster::finish(&mut self.session, done?)?.line, false),
            },
            Some(Done::Matte(job, found)) => return self.found_matte(*job, *found),
            None => {
                let fault = "stopped by a fault of its own; the session's log has its report";
                (format!("{} {fault}", job.plugin), true)
            }
        };
        if self.session.project.revision() != before {
            text.push_str(" (u undoes)");
        }
        let notice = Notice { text, is_error };
        let mut facts = self.shown_and(Fact::Said(notice))?;
        facts.push(Fact::Recovery(recovery));
        Ok(facts)
    }

    /// Stops what runs and keeps what it has found, and where the user is; says so on standard error, for it may
    /// take a while. What takes longer than `patience` is left: the project finds it interrupted.
    pub(super) fn close(mut self, seat: Seat, patience: Option<Duration>) -> Result<(), WorkbenchError> {
        let mut finished = Ok(Vec::new());
        if let Some((running, job)) = &self.running {
            running.stop();
            let kept = if job.keeps_frames { ", keeping its frames" } else { "" };
            // Nobody may be there to read it.
            writeln!(std::io::stderr(), "stopping {}{kept} …", job.plugin).unwrap_or_default();
            if patience.is_none_or(|patience| running.ends_within(patience)) {
                finished = self.finish();
            }
        }
        // Where the user is is kept also where the result could not be.
        let kept = self.keep(seat);
        finished?;
        kept
    }

    fn shown_and(&mut self, fact: Fact) -> Facts {
        let mut facts = self.shown()?;
        facts.push(fact);
        Ok(facts)
    }

    /// Tracks and groups as the project shows them now. Rows whose samples are the same are kept.
    fn shown(&mut self) -> Facts {
        let project = &self.session.project;
        let mut old = std::mem::take(&mut self.rows);
        for (id, span) in project.shown_all()? {
            let name = project.document().track(id).and_then(|track| track.name.clone());
            let row = match old.remove(&id) {
                Some(row) if Arc::ptr_eq(&row.span, &span) => TrackRow { name, ..row },
                _ => TrackRow::new(id, name, span),
            };
            self.rows.insert(id, row);
        }
        if let Some(reviewing) = &mut self.reviewing {
            reviewing.look_at(project)?;
        }
        let groups = match project.document().clustering() {
            None => None,
            Some(shown) => {
                let clustering = project.clustering(shown.id)?;
                let stale = project.is_stale(shown.id)?.map_or("", |_| ", stale");
                let id = &clustering.provenance.plugin_id;
                let what = format!("by {}{stale}", id.rsplit('.').next().unwrap_or(id));
                let document = project.document();
                let mut groups = Groups::new(
                    what,
                    (shown.id, clustering.tracks, clustering.dendrogram),
                    (shown.k, document.held_groups(shown.id)),
                    clustering.outlier_frames,
                );
                let name = |node| document.group_name(shown.id, node).map(str::to_owned);
                groups.names = groups.shown.mains().map(name).collect();
                Some(Box::new(groups))
            }
        };
        let tracker = match project.document().runs().last() {
            None => None,
            Some(shown) => {
                let provenance = project.run(shown.run)?.head.provenance;
                let id = &provenance.plugin_id;
                Some(format!("{} {}", id.rsplit('.').next().unwrap_or(id), provenance.plugin_version))
            }
        };
        let rows = self.rows.values().cloned().collect();
        let history = project.history();
        let new = history.entries().get(self.n_told..).unwrap_or_default().to_vec();
        self.n_told = history.entries().len();
        let told = Fact::History(new, history.head());
        let hand = Hand::of(project.document());
        let scale = Fact::Scale(project.document().scale());
        self.space = InSpace::of(project, self.space.take())?;
        let space = Fact::Space(self.space.clone());
        let mut facts = vec![
            Fact::Tracks(rows),
            Fact::Groups(groups),
            Fact::Hand(hand),
            scale,
            space,
            Fact::Tracker(tracker),
            told,
        ];
        if self.used.look(&self.session.project)? {
            facts.push(self.used());
        }
        facts.extend(self.layers()?);
        Ok(facts)
    }
}

fn said(text: String) -> Fact {
    Fact::Said(Notice { text, is_error: false })
}

fn said_wrong(text: String) -> Fact {
    Fact::Said(Notice { text, is_error: true })
}

fn failed(error: &WorkbenchError) -> Fact {
    said_wrong(error.to_string())
}
