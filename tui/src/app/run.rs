//! The wheel: wait, update, carry out, draw, paint. Draws only what changed, sends nothing when nothing does.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use honami_model::document::RunId;
use honami_workbench::plugins::{Level, plain};
use honami_workbench::versus::{self, Compared};
use honami_workbench::{WorkbenchError, plots};

use super::behind::Behind;
use super::command_log::{CommandLog, Head, LogFile};
use super::config::Config;
use super::effects::World;
use super::files::{self, Found};
use super::growing::Growing;
use super::late::Late;
use super::layout::Lens;
use super::pace::Pace;
use super::panel::Panel;
use super::pictures::Pictures;
use super::plotted::{Lot, PlotRequest, Plotted};
use super::prints::Print;
use super::recent;
use super::seat::Seat;
use super::state::{Display, Link, Mode, Notice, State};
use super::stills::{self, Stills};
use super::tally::Tally;
use super::update::{Effect, Fact, Msg, update};
use super::versus::{Versus, VersusRequest};
use super::view;
use crate::term::encode::Frame;
use crate::term::glyph::Glyphs;
use crate::term::input::{Event, Reply};
use crate::term::screen::{End, Screen};
use crate::term::still::Pixmap;

/// While the clip is being decoded, the time line is looked after this often.
const DECODING_TICK: Duration = Duration::from_millis(250);
/// Where the user is is kept so long after they have gone there.
const SEAT_TICK: Duration = Duration::from_secs(5);
/// Figures of the link change this often at most.
const LINK_TICK: Duration = Duration::from_secs(1);
/// What a link is taken to carry that has only seen frames too small to measure it by, bytes per second.
const UNMEASURED: f64 = 64.0 * 1024.0;

/// How a turn of the wheel has ended.
pub(super) enum Turned {
    /// Its user has left, or the terminal.
    End(Option<End>),
    /// Its user wants to be somewhere else.
    Next(Next),
}

/// Where a user wants to go from a project.
pub(super) enum Next {
    /// To another, or to a clip.
    File(PathBuf),
    /// To the tutorial.
    Lesson,
}

impl Turned {
    /// What ended it against its user's wish.
    pub(super) fn end(self) -> Option<End> {
        match self {
            Self::End(end) => end,
            Self::Next(_) => None,
        }
    }
}

/// Two runs, and what became of comparing them.
type Duel = ([RunId; 2], Result<Compared, WorkbenchError>);

pub(super) struct App {
    state: State,
    pictures: Pictures,
    stills: Stills,
    /// What the screen should show; `None` when the state has changed since.
    frame: Option<Frame>,
    is_exact: bool,
    pace: Pace,
    /// Pictures dropped while playing.
    tally: Tally,
    /// How late pictures are on screen while something is drawn after them.
    late: Late,
    plotting: Behind<Lot>,
    comparing: Behind<Duel>,
    growing: Growing,
    /// When the figures of the link were last looked at.
    link_seen: Duration,
    /// When to keep where the user is.
    seat_due: Option<Duration>,
    /// Where the user wants to go from here.
    next: Option<Next>,
    /// Where the log is written while the session goes on.
    log_file: Option<LogFile>,
}

impl App {
    pub(super) fn new(state: State, config: &Config, world: &World, screen: &Screen) -> anyhow::Result<Self> {
        let pictures = Pictures::new(world.media(), screen.waker())?;
        let stills = Stills::new(screen.waker())?;
        let mut app = Self {
            state,
            pictures,
            stills,
            frame: None,
            is_exact: false,
            pace: Pace::default(),
            tally: Tally::default(),
            late: Late::default(),
            plotting: Behind::new("plots", screen.waker()),
            comparing: Behind::new("two runs", screen.waker()),
            growing: Growing::new(screen.waker()),
            link_seen: Duration::ZERO,
            seat_due: None,
            next: None,
            log_file: None,
        };
        app.state.mono = screen.is_mono();
        config.take(&mut app.state);
        if let Some(text) = config.complaint() {
            app.state.notice = Some(Notice { text, is_error: true });
        }
        app.state.size = screen.size();
        if let Some(glyphs) = Glyphs::from_env(|name| std::env::var(name).ok()) {
            app.state.glyphs = glyphs;
        }
        app.look_at_display(screen);
        app.state.log = CommandLog::new(Head::of(&app.state, world.origin()));
        Ok(app)
    }

    /// The state as it is now.
    pub(super) fn state(&self) -> &State {
        &self.state
    }

    /// Notes that the project was open; those of the tutorial nobody comes back to.
    pub(super) fn note(&self, world: &World) {
        if self.state.lesson.is_none() {
            let progress = self.state.review.progress();
            // As long as nothing was found doubtful, nothing may have been looked at.
            let n_open = (progress.total() > 0).then_some(progress.open);
            recent::note(world.project(), self.state.tracks.len(), n_open);
        }
    }

    /// From now on what is done is written to a file.
    pub(super) fn write_log(&mut self, file: Option<LogFile>) {
        self.log_file = file;
    }

    /// Begins with what was typed while the project was opened; returns how it has ended.
    pub(super) fn turn(
        &mut self,
        screen: &mut Screen,
        world: &mut World,
        typed: Vec<Event>,
    ) -> anyhow::Result<Turned> {
        self.tell(Msg::Clock(screen.now()), screen, world)?;
        if self.hear(typed, screen, world)? {
            return Ok(self.turned(None));
        }
        self.note(world);
        loop {
            // A frame at rest waits for a slot only once no other is expected.
            let rest = self.pace.rest(screen.now()).filter(|_| self.frame.is_some() && !self.is_exact);
            let decoding = self.decoding_tick(screen, world);
            let times = [self.state.next_tick(), decoding, self.seat_due, self.stills.due(), rest];
            let wants_slot =
                self.frame.is_none() || (rest.is_none() && (!self.is_exact || screen.is_sending()));
            let happened = screen.wait(times.into_iter().flatten().min(), wants_slot)?;
            self.tell(Msg::Clock(screen.now()), screen, world)?;
            let mut is_leaving = happened.end.is_some();
            if happened.resized {
                let (columns, rows) = screen.size();
                screen.forget();
                self.tell(Msg::Resize(columns, rows), screen, world)?;
                self.frame = None;
            }
            is_leaving = is_leaving || self.hear(happened.events, screen, world)?;
            self.overhear(screen);
            for fact in world.news() {
                self.frame = None;
                self.tell(Msg::Fact(fact), screen, world)?;
            }
            if is_leaving {
                return Ok(self.turned(happened.end));
            }
            if happened.suspend {
                screen.suspend()?;
                self.frame = None;
            }
            self.sit(screen, world);
            self.show(screen, world)?;
        }
    }

    fn turned(&mut self, end: Option<End>) -> Turned {
        match self.next.take().filter(|_| end.is_none()) {
            Some(next) => Turned::Next(next),
            None => Turned::End(end),
        }
    }

    /// Keeps where the user is, now and then, and not while something moves: it costs a write to the disk.
    fn sit(&mut self, screen: &Screen, world: &mut World) {
        let seat = Seat::of(&self.state);
        let now = screen.now();
        if !world.has_moved(&seat) || self.state.play.is_some() || self.state.job.is_some() {
            self.seat_due = None;
        } else if self.seat_due.is_some_and(|due| due <= now) {
            self.seat_due = self.pace.rest(now);
            if self.seat_due.is_some() {
                return;
            }
            if let Err(error) = world.keep(seat) {
                let text = format!("where you are is not kept: {error}");
                self.state.notice = Some(Notice { text, is_error: true });
                self.frame = None;
            }
        } else {
            self.seat_due = self.seat_due.or(Some(now + SEAT_TICK));
        }
    }

    /// Takes in what the terminal has sent; returns whether its user leaves.
    fn hear(&mut self, events: Vec<Event>, screen: &mut Screen, world: &mut World) -> anyhow::Result<bool> {
        for event in events {
            let msg = match event {
                Event::Key(key) => Msg::Key(key),
                Event::Mouse(mouse) => Msg::Mouse(mouse),
                Event::Paste(text) => Msg::Paste(text),
                Event::Reply(Reply::Ready) => {
                    if let Some(by) = self.late.answered(screen.link().n_answered(), screen.now()) {
                        update(&mut self.state, Msg::Fact(Fact::Late(by)));
                    }
                    continue;
                }
                // What was learnt may show the same frame differently.
                Event::Reply(_) => {
                    self.is_exact = false;
                    self.look_at_display(screen);
                    continue;
                }
            };
            self.frame = None;
            if self.tell(msg, screen, world)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Takes in what was printed in this process: nothing of it is on the screen.
    fn overhear(&mut self, screen: &Screen) {
        let frame = self.state.job.as_ref().and_then(|job| job.frame);
        let print =
            |line: String| Print { frame, plugin: String::new(), level: Level::Info, text: plain(&line) };
        let prints: Vec<Print> = screen.printed().into_iter().map(print).collect();
        if !prints.is_empty() {
            update(&mut self.state, Msg::Fact(Fact::Printed(prints)));
            self.frame = None;
        }
    }

    fn decoding_tick(&self, screen: &Screen, world: &World) -> Option<Duration> {
        let is_decoding = self.state.n_ready < self.state.clip.n_frames() && world.is_decoding();
        is_decoding.then(|| screen.now() + DECODING_TICK)
    }

    /// Updates the state and does what it wants; returns whether it wants to leave.
    fn tell(&mut self, msg: Msg, screen: &mut Screen, world: &mut World) -> anyhow::Result<bool> {
        let before = self.state.shown_frame();
        let mut effects = VecDeque::from(update(&mut self.state, msg));
        self.log();
        while let Some(effect) = effects.pop_front() {
            match effect {
                Effect::Leave => return Ok(true),
                Effect::Suspend => {
                    screen.suspend()?;
                    self.frame = None;
                }
                Effect::Redraw => screen.forget(),
                Effect::Teach => {
                    self.next = Some(Next::Lesson);
                    return Ok(true);
                }
                Effect::Follow(lead) => match files::follow(&lead) {
                    Ok(Found::File(path)) => {
                        self.next = Some(Next::File(path));
                        return Ok(true);
                    }
                    Ok(Found::Folder(listing)) => {
                        update(&mut self.state, Msg::Fact(Fact::Files(listing)));
                    }
                    Err(text) => self.state.notice = Some(Notice { text, is_error: true }),
                },
                Effect::Mouse(ours) => screen.set_mouse(ours)?,
                other => {
                    for fact in world.carry_out(other, screen.now()) {
                        effects.extend(update(&mut self.state, Msg::Fact(fact)));
                    }
                }
            }
        }
        self.log();
        if self.state.shown_frame() != before {
            self.frame = None;
        }
        Ok(false)
    }

    /// Has the curves of the plots and the figures of a group worked out, and takes them when they are.
    fn plot(&mut self) -> anyhow::Result<()> {
        if matches!(self.state.panel, Some(Panel::Plots | Panel::Groups))
            && let Some(PlotRequest { subject, tracks, times }) = Plotted::request(&mut self.state)
        {
            self.plotting.ask(move || (subject, Arc::new(plots::of(&tracks, &times))))?;
        }
        if let Some((subject, plots)) = self.plotting.news()? {
            update(&mut self.state, Msg::Fact(Fact::Plots(subject, plots)));
            self.frame = None;
        }
        Ok(())
    }

    /// Has two runs compared, and takes what becomes of it.
    fn compare(&mut self, world: &World) -> anyhow::Result<()> {
        if let Some(VersusRequest { runs, tracks }) = Versus::request(&mut self.state) {
            let project = world.project().to_owned();
            self.comparing.ask(move || (runs, versus::compare(&project, runs, &tracks)))?;
        }
        if let Some((runs, compared)) = self.comparing.news()? {
            let compared = compared.map(Arc::new).map_err(|error| error.to_string());
            update(&mut self.state, Msg::Fact(Fact::Compared(runs, compared)));
            self.frame = None;
        }
        Ok(())
    }

    /// Has the skeleton grown, where it is shown, and takes it when it has.
    fn grow(&mut self, world: &World) -> anyhow::Result<()> {
        if let Some(fact) = self.growing.look(&mut self.state, world.session())? {
            update(&mut self.state, Msg::Fact(fact));
            self.frame = None;
        }
        Ok(())
    }

    /// Takes the dense motion of the shown frame, where that is shown, as soon as it is measured.
    fn measure(&mut self, world: &mut World) {
        if let Some(fact) = world.dense(&self.state) {
            update(&mut self.state, Msg::Fact(fact));
            self.frame = None;
        }
    }

    /// Writes what was done to the log on the disk; without room there it ends, and the session goes on.
    fn log(&mut self) {
        let written = self.log_file.as_mut().map_or(Ok(()), |file| file.write(&self.state.log));
        if let Err(text) = written {
            self.log_file = None;
            self.state.notice = Some(Notice { text, is_error: true });
            self.frame = None;
        }
    }

    /// Paints, if there is anything to paint and the link has room for it.
    fn show(&mut self, screen: &mut Screen, world: &mut World) -> anyhow::Result<()> {
        self.plot()?;
        self.compare(world)?;
        self.grow(world)?;
        self.measure(world);
        let n_ready = world.n_ready();
        if n_ready != self.state.n_ready {
            update(&mut self.state, Msg::Fact(Fact::Ready(n_ready)));
            self.frame = None;
        }
        let times_s = self.state.clip.times.as_slice();
        let dropped = self.tally.dropped(self.state.play, times_s, screen.now());
        if dropped != self.state.dropped {
            update(&mut self.state, Msg::Fact(Fact::Dropped(dropped)));
            self.frame = None;
        }
        let lens = Lens::shown(&self.state);
        match self.pictures.look(self.state.shown_frame(), lens) {
            Ok(true) => self.frame = None,
            Ok(false) => {}
            Err(error) => {
                let notice = Notice { text: error.to_string(), is_error: true };
                if self.state.notice.as_ref() != Some(&notice) {
                    self.state.notice = Some(notice);
                    self.frame = None;
                }
            }
        }
        self.look_at_still(screen);
        let now = screen.now();
        let is_resting = self.frame.is_some() && !self.is_exact && self.pace.rest(now).is_some();
        if is_resting || !screen.has_slot() {
            return Ok(());
        }
        if self.frame.is_some() && self.is_exact {
            return if screen.is_sending() { Ok(screen.send_still()?) } else { Ok(()) };
        }
        if self.frame.is_none() {
            self.look_at_link(screen);
        }
        let (state, shot) = (&self.state, self.pictures.shot());
        let frame = self.frame.get_or_insert_with(|| view::draw(state, shot));
        let picture = shot.map(|shot| (shot.frame, shot.lens));
        let is_moving = self.pace.is_moving(now, picture);
        self.is_exact = screen.paint(frame, is_moving)? && !is_moving;
        if let Some((frame, lens)) = picture {
            self.pace.painted(now, (frame, lens));
            self.tally.painted(frame);
            self.await_answer(frame, screen);
        }
        // A picture that is exact from now on may stay: nothing else wakes the screen for its still.
        if self.is_exact {
            self.look_at_still(screen);
        }
        Ok(())
    }

    /// Under a hand that draws it is measured how late the pictures are that it follows.
    fn await_answer(&mut self, frame: u32, screen: &Screen) {
        let play = self.state.play.filter(|_| matches!(self.state.mode, Mode::Sketch(_)));
        let due = play.and_then(|play| play.due(self.state.clip.times.as_slice(), frame));
        match due.filter(|_| !screen.link().is_silent()) {
            Some(due) => self.late.painted(frame, due, screen.link().n_sent()),
            None => self.late.forget(),
        }
    }

    /// Sees to it that a picture that stays is shown in the terminal's own pixels, and no other is.
    fn look_at_still(&mut self, screen: &mut Screen) {
        let is_allowed = self.state.stills && !screen.link().is_silent();
        let pixels = screen.pixels().filter(|_| is_allowed);
        if screen.has_still() && pixels.is_none() {
            screen.drop_still();
            self.is_exact = false;
        }
        let made = self.stills.take();
        let frame = self.frame.as_ref().filter(|_| self.is_exact && self.state.play.is_none());
        let goodput = screen.link().goodput().unwrap_or(UNMEASURED);
        let (Some(frame), Some(pixels), Some(shot)) = (frame, pixels, self.pictures.shot()) else {
            return self.stills.see(None, screen.has_still(), screen.now());
        };
        if let Some(still) = made {
            screen.show_still(still, frame);
        }
        let lens = shot.lens;
        self.stills.see(stills::wish(frame, lens.area, pixels), screen.has_still(), screen.now());
        let Some(wish) = self.stills.wish(screen.now()) else { return };
        let image_px = lens.cell_sides_px();
        let grid = stills::grid(pixels, screen.cell_px(), image_px);
        let picture = self.pictures.fine(grid).map(|shot| {
            let (width, height) = (shot.lens.size().0, grid.1 * u32::from(wish.area.height));
            let mut pixels = view::picture::compose(&self.state, &shot);
            pixels.truncate((width * height) as usize);
            Pixmap { width, height, pixels }
        });
        let at_once = screen.link().budget() * screen.link().window();
        self.stills.order(wish, picture, goodput, at_once);
    }

    /// Takes what is known of the terminal into the state.
    fn look_at_display(&mut self, screen: &Screen) {
        let display = Display { depth: screen.depth(), pixels: screen.pixels() };
        update(&mut self.state, Msg::Fact(Fact::Display(display)));
    }

    /// Takes the figures of the link into the state, in round numbers and not too often: they cost bytes.
    fn look_at_link(&mut self, screen: &Screen) {
        let now = screen.now();
        if self.link_seen != Duration::ZERO && now < self.link_seen + LINK_TICK {
            return;
        }
        self.link_seen = now;
        let link = screen.link();
        let round = |x: f64| {
            let unit = 10_f64.powf((x.max(1.0).log10().floor() - 1.0).max(0.0));
            ((x / unit).round() * unit) as u32
        };
        let is_late = |age: Duration| link.delay().is_some_and(|delay| age > 2 * delay) && !link.is_silent();
        let late = link.on_its_way(now).filter(|(age, _)| is_late(*age));
        let link = Link {
            delay_ms: link.delay().map(|delay| round(delay.as_secs_f64() * 1e3)),
            rate_kbs: link.goodput().map(|rate| round(rate / 1e3)),
            is_silent: link.is_silent(),
            late: late.map(|(age, n_bytes)| [round(age.as_secs_f64() * 1e3), round(n_bytes as f64)]),
        };
        update(&mut self.state, Msg::Fact(Fact::Link(link)));
    }
}
