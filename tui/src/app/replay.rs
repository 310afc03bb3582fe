//! Doing a logged session again, without a screen: the same update, the same world.

use std::io::Read as _;
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use anyhow::Context as _;
use honami_workbench::session::Session;
use honami_workbench::versus;

use super::action::Action;
use super::command_log::{self, Head, Line, What};
use super::effects::World;
use super::growing::Grower;
use super::seat::Seat;
use super::skeleton::Skeletal;
use super::state::{Notice, State};
use super::update::{Effect, Fact, Msg, again, stand_by, update};
use super::versus::{Versus, VersusRequest};
use crate::term::signals;

/// Actions that are not done again: those that concern the terminal, the viewer's window and files alone, and the ways through the queue,
/// which is filled while people work. The lines that follow say where those led.
const NOT_AGAIN: &[Action] = &[
    Action::Glyphs,
    Action::Mouse,
    Action::NextItem,
    Action::NextTheme,
    Action::PreviousItem,
    Action::Redraw,
    Action::SaveLog,
    Action::Stills,
    Action::Suspend,
    Action::Window,
    Action::WorstFrame,
];

/// What has become of a replay.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Replay {
    /// Number of things that were done again.
    pub n_done: usize,
    /// The edit at which the document stands now.
    pub revision: u32,
    /// The line of the log where it first went another way, and how.
    pub difference: Option<(usize, String)>,
}

/// Does what a log says in a project, and tells every line that is said meanwhile, with the number of the log's line
/// that it belongs to. Stops where it goes another way than in the log: where something cannot be done, where
/// something else is said, or where something fails that did not.
///
/// # Errors
/// When the log cannot be read or is of another clip, or the project cannot be worked on.
pub fn replay(session: Session, log: &str, tell: &mut dyn FnMut(usize, &Notice)) -> anyhow::Result<Replay> {
    let (head, lines) = command_log::read(log).map_err(anyhow::Error::msg)?;
    let (waker, woken) = signals::pair().context("no pipe for jobs")?;
    let mut world = World::new(session, waker);
    let state = world.state()?;
    let origin = world.origin();
    anyhow::ensure!(
        origin.clip == head.origin.clip,
        "the log is of another clip: {} of {}, this is {}",
        head.origin.clip,
        head.origin.project,
        origin.clip
    );
    let mut player = Player { world, state, woken, asked: None };
    let mut done = Replay { n_done: 0, revision: origin.revision, difference: None };
    if origin.revision == head.origin.revision {
        player.sit_down(&head);
        done.difference = player.play(&lines, tell, &mut done.n_done)?;
        player.end_job(tell, lines.last().map_or(1, |(number, _)| *number))?;
        done.revision = player.world.origin().revision;
    } else {
        let line = format!(
            "the session began at edit {}, and the project stands at {}",
            head.origin.revision, origin.revision
        );
        done.difference = Some((1, line));
    }
    player.world.close(Seat::of(&player.state), None)?;
    Ok(done)
}

struct Player {
    world: World,
    state: State,
    /// Becomes readable when a job has news.
    woken: UnixStream,
    /// The skeleton that has not grown yet.
    asked: Option<u64>,
}

impl Player {
    /// Takes the place of the user when the session began.
    fn sit_down(&mut self, head: &Head) {
        self.state.size = head.screen;
        self.state.mono = head.mono;
        head.seat.take(&mut self.state);
    }

    /// Does line after line; returns the first difference.
    fn play(
        &mut self,
        lines: &[(usize, Line)],
        tell: &mut dyn FnMut(usize, &Notice),
        n_done: &mut usize,
    ) -> anyhow::Result<Option<(usize, String)>> {
        let mut rest = lines.iter().peekable();
        while let Some((number, line)) = rest.next() {
            let mut expected = Vec::new();
            while let Some((number, notice)) = rest.peek().and_then(|(n, line)| Some((*n, line.notice()?))) {
                expected.push((number, notice));
                rest.next();
            }
            if line.notice().is_some() || is_not_again(line) {
                continue;
            }
            let before = self.state.log.n();
            let has_ended = matches!(line.what, What::Ended(_));
            if let Err(why) = if has_ended { self.wait()? } else { self.step(line) } {
                return Ok(Some((*number, why)));
            }
            *n_done += 1;
            let said: Vec<Notice> = self.state.log.since(before).filter_map(Line::notice).collect();
            said.iter().for_each(|notice| tell(*number, notice));
            let difference = difference(*number, &expected, &said, is_loose(line));
            if difference.is_some() {
                return Ok(difference);
            }
        }
        Ok(None)
    }

    fn step(&mut self, line: &Line) -> Result<(), String> {
        for effect in stand_by(&mut self.state, line) {
            self.carry_out(effect);
        }
        if line.here.as_ref().is_some_and(|here| here.chosen.is_some()) {
            self.wait_for_ghost().map_err(|error| error.to_string())?;
        }
        self.compare();
        self.grow(line)?;
        for effect in again(&mut self.state, line)? {
            self.carry_out(effect);
        }
        Ok(())
    }

    /// Compares the two runs that are beside each other: whoever did the next thing had seen how they disagree.
    fn compare(&mut self) {
        if let Some(VersusRequest { runs, tracks }) = Versus::request(&mut self.state) {
            let compared = versus::compare(self.world.project(), runs, &tracks);
            let compared = compared.map(Arc::new).map_err(|error| error.to_string());
            drop(update(&mut self.state, Msg::Fact(Fact::Compared(runs, compared))));
        }
    }

    /// Grows the skeleton, where it is shown, unless whoever did the next thing was quicker.
    fn grow(&mut self, line: &Line) -> Result<(), String> {
        self.asked = Skeletal::request(&mut self.state).or(self.asked);
        let is_seen = line.here.as_ref().is_some_and(|here| !here.growing);
        let is_wanted = |revision: &mut u64| is_seen && *revision == self.state.skeleton.revision;
        if let Some(revision) = self.asked.take_if(is_wanted) {
            let grower = Grower::of(self.world.session()).map_err(|error| error.to_string())?;
            drop(update(&mut self.state, Msg::Fact(grower.fact(revision))));
        }
        Ok(())
    }

    fn carry_out(&mut self, effect: Effect) {
        for fact in self.world.carry_out(effect, self.state.now) {
            for effect in update(&mut self.state, Msg::Fact(fact)) {
                self.carry_out(effect);
            }
        }
    }

    /// Waits until the correction that is moved is worked out.
    fn wait_for_ghost(&mut self) -> anyhow::Result<()> {
        while self.state.awaits_ghost() {
            let news = self.world.news();
            if news.is_empty() {
                self.woken.read(&mut [0; 64]).context("nothing is heard of the correction")?;
            }
            news.into_iter().for_each(|fact| drop(update(&mut self.state, Msg::Fact(fact))));
        }
        Ok(())
    }

    /// Waits for the end of the job.
    fn wait(&mut self) -> anyhow::Result<Result<(), String>> {
        if self.state.job.is_none() {
            return Ok(Err("a job ended here, and now none is running".to_owned()));
        }
        loop {
            let news: Vec<Fact> = self.world.news();
            news.into_iter().for_each(|fact| drop(update(&mut self.state, Msg::Fact(fact))));
            if self.state.job.is_none() {
                return Ok(Ok(()));
            }
            self.woken.read(&mut [0; 64]).context("nothing is heard of the job")?;
        }
    }

    /// Stops a job that the session left running when it ended.
    fn end_job(&mut self, tell: &mut dyn FnMut(usize, &Notice), number: usize) -> anyhow::Result<()> {
        if self.state.job.is_some() {
            self.carry_out(Effect::StopJob);
            let before = self.state.log.n();
            drop(self.wait()?);
            self.state.log.since(before).filter_map(Line::notice).for_each(|notice| tell(number, &notice));
        }
        Ok(())
    }
}

fn is_not_again(line: &Line) -> bool {
    matches!(&line.what, What::Action(name) if NOT_AGAIN.iter().any(|action| action.info().name == name))
}

/// Whether only errors count of what is said: jobs say how long they took, and the queue which item is next.
fn is_loose(line: &Line) -> bool {
    let is_judged = line.here.as_ref().is_some_and(|here| here.judged.is_some());
    is_judged
        || match &line.what {
            What::Ended(_) => true,
            What::Mouse(touch) => touch.at.is_none(),
            _ => false,
        }
}

/// How what is said differs from what the log says: all of that must be said again, and no error besides.
fn difference(
    number: usize,
    expected: &[(usize, Notice)],
    said: &[Notice],
    is_loose: bool,
) -> Option<(usize, String)> {
    let words = |notice: &Notice| {
        format!("{} “{}”", if notice.is_error { "the error" } else { "the line" }, notice.text)
    };
    let counts = |notice: &Notice| !is_loose || notice.is_error;
    let mut got = said.iter().filter(|notice| counts(notice));
    for (number, wanted) in expected.iter().filter(|(_, notice)| counts(notice)) {
        match got.next() {
            Some(got) if got == wanted || (is_loose && got.is_error) => {}
            Some(got) => {
                let line = format!("the log has {}, and now it is {}", words(wanted), words(got));
                return Some((*number, line));
            }
            None => {
                return Some((*number, format!("the log has {}, and now nothing is said", words(wanted))));
            }
        }
    }
    got.find(|notice| notice.is_error)
        .map(|notice| (number, format!("the log has no error, and now there is {}", words(notice))))
}

#[cfg(test)]
mod tests;
