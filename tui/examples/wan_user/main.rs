//! A scripted user before a terminal: presses keys on time, and measures when what they ask for is seen.
//!
//! `cargo xtask wan` starts it: `wan_user --clip CLIP [--size 80x24] [--answers normal|silent|slow|lying]
//! [--pid-file FILE] [--db 35] [--idle-s 5] [--only start] -- COMMAND…`. Prints one line of JSON.
//!
//! A paint counts when a complete frame shows the key's frame with at least `--db` of peak signal to noise ratio
//! against the picture computed from the clip. A frame is complete when its status query comes, or, of programs that
//! send none, whenever output pauses.

mod measure;
mod process;
mod terminal;
mod wanted;

use std::io::{Read as _, Write as _};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, sync_channel};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use honami_workbench::media::{self, OpenOptions};
use portable_pty::{Child, CommandBuilder, PtySize, native_pty_system};
use serde_json::{Value, json};

use measure::{Outcome, Press, ms, paints_json, rounded};
use process::Process;
use terminal::{Answers, Terminal};
use wanted::Wanted;

/// What has not come by then never will.
const PATIENCE: Duration = Duration::from_secs(30);
/// So long without a byte is quiet.
const QUIET: Duration = Duration::from_millis(700);
/// The program keeps where its user is some seconds after they have gone there; then it idles.
const SETTLE: Duration = Duration::from_secs(6);
/// Isolated keys: how many, and how far apart.
const ISOLATED: (u32, Duration) = (8, Duration::from_millis(500));
/// A key held at 25 per second, and the storm at 30.
const HELD: (u32, Duration) = (125, Duration::from_millis(40));
const STORM: (u32, Duration) = (180, Duration::from_nanos(1_000_000_000 / 30));

struct Args {
    clip: PathBuf,
    size: (u16, u16),
    answers: Answers,
    pid_file: Option<PathBuf>,
    db: f64,
    idle: Duration,
    only_start: bool,
    command: Vec<String>,
}

fn main() -> anyhow::Result<()> {
    let args = args().context("see the head of tui/examples/wan_user/main.rs")?;
    let media = media::open(&args.clip, &OpenOptions::default())?;
    let wanted = Arc::new(Wanted::of(&media, args.size)?);
    let mut user = User::start(&args, &wanted)?;
    let result = user.session(&args)?;
    writeln!(std::io::stdout(), "{result}")?;
    Ok(())
}

fn args() -> anyhow::Result<Args> {
    let mut words = std::env::args().skip(1);
    let mut args = Args {
        clip: PathBuf::new(),
        size: (80, 24),
        answers: Answers::Normal,
        pid_file: None,
        db: 35.0,
        idle: Duration::from_secs(5),
        only_start: false,
        command: Vec::new(),
    };
    while let Some(word) = words.next() {
        if word == "--" {
            args.command = words.collect();
            break;
        }
        let value = words.next().with_context(|| format!("{word} wants a value"))?;
        match word.as_str() {
            "--clip" => args.clip = value.into(),
            "--size" => {
                let (columns, rows) = value.split_once('x').context("a size is written 80x24")?;
                args.size = (columns.parse()?, rows.parse()?);
            }
            "--answers" => args.answers = Answers::named(&value).context("no such way to answer")?,
            "--pid-file" => args.pid_file = Some(value.into()),
            "--db" => args.db = value.parse()?,
            "--idle-s" => args.idle = Duration::from_secs_f64(value.parse()?),
            "--only" => args.only_start = value == "start",
            _ => bail!("unknown word {word}"),
        }
    }
    anyhow::ensure!(!args.command.is_empty(), "a command is wanted after --");
    Ok(args)
}

/// Somebody with a terminal and a keyboard.
struct User {
    terminal: Terminal,
    output: Receiver<(Instant, Vec<u8>)>,
    keyboard: Box<dyn std::io::Write + Send>,
    child: Box<dyn Child + Send + Sync>,
    wanted: Arc<Wanted>,
    process: Option<Process>,
    db: f64,
    /// The frame that the keys so far lead to, and the way they go.
    frame: u32,
    forward: bool,
    /// Bytes that the program has written and that have not come yet, at most; written and received at the start.
    unacked_max: u64,
    base: (u64, usize),
}

impl User {
    fn start(args: &Args, wanted: &Arc<Wanted>) -> anyhow::Result<Self> {
        let size = PtySize { rows: args.size.1, cols: args.size.0, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size)?;
        let mut command = CommandBuilder::new(&args.command[0]);
        command.args(&args.command[1..]);
        command.cwd(std::env::current_dir()?);
        command.env("TERM", "xterm-256color");
        command.env("COLORTERM", "truecolor");
        for name in ["TMUX", "SSH_CONNECTION", "NO_COLOR", "HONAMI_COLOR"] {
            command.env_remove(name);
        }
        let child = pair.slave.spawn_command(command)?;
        drop(pair.slave);
        let mut reader = pair.master.try_clone_reader()?;
        let (sender, output) = sync_channel(4096);
        std::thread::Builder::new().name("output".to_owned()).spawn(move || {
            let mut bytes = vec![0; 1 << 16];
            while let Ok(n @ 1..) = reader.read(&mut bytes) {
                if sender.send((Instant::now(), bytes[..n].to_vec())).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self {
            terminal: Terminal::new(args.size, args.answers, Arc::clone(wanted)).context("no size")?,
            output,
            keyboard: pair.master.take_writer()?,
            child,
            wanted: Arc::clone(wanted),
            process: None,
            db: args.db,
            frame: 0,
            forward: true,
            unacked_max: 0,
            base: (0, 0),
        })
    }

    /// Everything in turn: the start, single keys, a held key, the storm, idling, the end.
    fn session(&mut self, args: &Args) -> anyhow::Result<Value> {
        let start = self.wait_for_start(args)?;
        let mut result = json!({ "start": start });
        if !args.only_start {
            result["isolated"] = self.press(ISOLATED)?;
            result["held"] = self.press(HELD)?;
            result["storm"] = self.press(STORM)?;
            result["idle"] = self.idle(args.idle)?;
        }
        self.keyboard.write_all(b"q")?;
        let until = Instant::now() + Duration::from_secs(5);
        while self.child.try_wait()?.is_none() {
            if Instant::now() > until {
                self.child.kill()?;
            }
            self.listen(Instant::now() + Duration::from_millis(20))?;
        }
        Ok(result)
    }

    /// Shows what comes, and answers, until a time; returns whether anything came.
    fn listen(&mut self, until: Instant) -> anyhow::Result<bool> {
        let mut has_come = false;
        loop {
            let (answers, due) = self.terminal.take_answers(Instant::now());
            if !answers.is_empty() {
                self.keyboard.write_all(&answers)?;
            }
            let wake = due.map_or(until, |due| due.min(until));
            let mut next = match self.output.recv_timeout(wake.saturating_duration_since(Instant::now())) {
                Ok(chunk) => Some(chunk),
                Err(RecvTimeoutError::Timeout) if Instant::now() < until => continue,
                Err(RecvTimeoutError::Timeout) => return Ok(has_come),
                Err(RecvTimeoutError::Disconnected) => {
                    // The program has ended, or is about to.
                    std::thread::sleep(Duration::from_millis(5));
                    return Ok(has_come);
                }
            };
            has_come = true;
            self.look_at_unacked();
            while let Some((at, bytes)) = next {
                let more = self.output.try_recv();
                self.terminal.show(&bytes, at, matches!(more, Err(TryRecvError::Empty)));
                next = more.ok();
            }
        }
    }

    fn look_at_unacked(&mut self) {
        let Some(process) = &self.process else { return };
        let written = process.n_written() - self.base.0;
        let received = (self.terminal.n_received - self.base.1) as u64;
        self.unacked_max = self.unacked_max.max(written.saturating_sub(received));
    }

    /// Listens until something is so; returns whether it ever was.
    fn listen_until(&mut self, mut is_so: impl FnMut(&Terminal) -> bool) -> anyhow::Result<bool> {
        let until = Instant::now() + PATIENCE;
        while !is_so(&self.terminal) {
            if Instant::now() > until || self.child.try_wait()?.is_some() {
                return Ok(false);
            }
            self.listen(Instant::now() + Duration::from_millis(5))?;
        }
        Ok(true)
    }

    /// Waits until the picture is exact and nothing more comes.
    fn wait_for_start(&mut self, args: &Args) -> anyhow::Result<Value> {
        let begin = Instant::now();
        let is_exact = |terminal: &Terminal| {
            terminal.desk().paints.last().is_some_and(|paint| paint.number == 0 && paint.psnr > 90.0)
        };
        let exact = self.listen_until(is_exact)?.then(Instant::now);
        while self.listen(Instant::now() + QUIET)? && begin.elapsed() < PATIENCE {}
        let desk = self.terminal.desk();
        let screen = self.terminal.screen().contents();
        anyhow::ensure!(desk.chrome.is_some(), "the program does not start:\n{screen}");
        let exec = desk.exec.unwrap_or(begin);
        let since = |at: Option<Instant>| rounded(at.map(|at| ms(at.saturating_duration_since(exec))));
        let start = json!({
            "is_from_exec": desk.exec.is_some(),
            "first_byte_ms": since(self.terminal.first_byte),
            "first_chrome_ms": since(desk.chrome),
            "exact_ms": since(exact),
        });
        self.process = args.pid_file.as_deref().and_then(Process::of_file);
        self.base = (self.process.as_ref().map_or(0, Process::n_written), self.terminal.n_received);
        Ok(start)
    }

    /// Presses the step key some times, then waits for the exact picture; says what was seen.
    fn press(&mut self, (n_keys, apart): (u32, Duration)) -> anyhow::Result<Value> {
        self.terminal.forget_paints();
        self.unacked_max = 0;
        let begin = Instant::now() + Duration::from_millis(20);
        let mut presses = Vec::new();
        for k in 0..n_keys {
            self.listen(begin + apart * k)?;
            let key = self.step();
            self.keyboard.write_all(key)?;
            presses.push(Press { at: Instant::now(), frame: self.frame });
        }
        let (end, frame) = (presses[presses.len() - 1].at, self.frame);
        self.listen_until(|terminal| {
            terminal.desk().paints.last().is_some_and(|paint| paint.number == frame && paint.psnr > 90.0)
        })?;
        let paints = self.terminal.desk().paints.clone();
        while self.listen(Instant::now() + QUIET)? && end.elapsed() < 2 * PATIENCE {}
        let exact = paints.iter().find(|p| p.at >= end && p.number == frame && p.psnr > 90.0);
        let mut result = Outcome::of(&presses, &paints, |paint| paint.psnr >= self.db).json();
        result["number_only"] = Outcome::of(&presses, &paints, |_| true).json();
        result["exact_ms"] = json!(rounded(exact.map(|paint| ms(paint.at - end))));
        let moving: Vec<_> = paints.iter().copied().filter(|paint| paint.at <= end).collect();
        result["paints"] = paints_json(&moving);
        result["unacked_max"] = json!(self.process.as_ref().map(|_| self.unacked_max));
        Ok(result)
    }

    /// The key that goes on, turning round at the ends of the clip.
    fn step(&mut self) -> &'static [u8] {
        if self.frame == self.wanted.last_frame() {
            self.forward = false;
        } else if self.frame == 0 {
            self.forward = true;
        }
        if self.forward {
            self.frame += 1;
            b"."
        } else {
            self.frame -= 1;
            b","
        }
    }

    fn idle(&mut self, time: Duration) -> anyhow::Result<Value> {
        self.listen(Instant::now() + SETTLE)?;
        let before = (self.terminal.n_received, self.process.as_ref().map(Process::usage));
        let until = Instant::now() + time;
        while Instant::now() < until {
            self.listen(until)?;
        }
        let usage = self.process.as_ref().map(Process::usage);
        let used = before.1.zip(usage).map(|(before, after)| {
            let cpu = 100.0 * (after.cpu_s - before.cpu_s) / time.as_secs_f64();
            json!({ "switches": after.n_switches - before.n_switches, "cpu_percent": rounded(Some(cpu)) })
        });
        Ok(json!({
            "seconds": time.as_secs_f64(),
            "bytes": self.terminal.n_received - before.0,
            "used": used,
        }))
    }
}
