//! `cargo xtask wan`: the real program over a real ssh and an emulated slow link, before a scripted user.
//!
//! Needs root for two network namespaces, and a few Debian packages; says so. Nothing of it outlives the run, and what
//! a killed run has left is taken away by the next.

mod cases;
mod lab;
mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use serde_json::{Map, Value};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::shell::{Step, cargo, target_dir};
use crate::{BUILD, system};
use cases::{ALL, Case, Clip, Program, Through};
use lab::{Lab, must};

/// Frames of the generated clip, and its seed.
const STORM: [&str; 6] = ["--wind", "storm", "--frames", "150", "--seed", "7"];

/// A tmux that passes 24-bit colours on.
const TMUX: &str = "set -g status off\nset -ga terminal-overrides ,*:Tc\nset -s escape-time 0\n";

pub(crate) fn run(args: &[&str]) -> anyhow::Result<()> {
    let as_json = args.contains(&"--json");
    let names: Vec<&str> = args.iter().copied().filter(|arg| *arg != "--json").collect();
    if names == ["list"] {
        ALL.iter().for_each(|case| println!("{}", case.name));
        return Ok(());
    }
    if let Some(unknown) = names.iter().find(|name| ALL.iter().all(|case| case.name != **name)) {
        bail!("no case is named {unknown}; `cargo xtask wan list` lists them");
    }
    let chosen = ALL.iter().filter(|case| names.is_empty() || names.contains(&case.name));
    need_root_and_packages()?;
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
    }
    cargo(BUILD).args(["-p", "honami", "--bins", "--examples"]).run()?;
    let lab = Lab::open()?;
    let suite = Suite::prepare(&lab, stop)?;
    let mut results = Map::new();
    for case in chosen {
        if let Some(why) = suite.cannot(case) {
            eprintln!("{}: left out, {why}", case.name);
            continue;
        }
        eprintln!("{} …", case.name);
        results.insert(case.name.to_owned(), suite.measure(case)?);
    }
    if as_json {
        let flat = results.into_iter().map(|(name, result)| (name, flat(result)));
        println!("{}", Value::Object(flat.collect()));
    } else {
        table::print(&results);
    }
    Ok(())
}

/// The storm's figures beside the parts of the session.
fn flat(mut result: Value) -> Value {
    for key in ["p50_ms", "p99_ms", "stale_ms", "paints_per_s"] {
        let value = if key.starts_with('p') { &result["held"][key] } else { &result["storm"][key] };
        result[key] = value.clone();
    }
    result
}

fn need_root_and_packages() -> anyhow::Result<()> {
    let out = Command::new("id").arg("-u").output().context("cannot find out who runs this")?;
    ensure!(
        String::from_utf8_lossy(&out.stdout).trim() == "0",
        "only root can make network namespaces: run `cargo xtask wan` as root"
    );
    let needed = [("/usr/sbin/sshd", "openssh-server"), ("ssh", "openssh-client"), ("ip", "iproute2")];
    let missing: Vec<&str> = needed
        .iter()
        .filter(|(program, _)| !system::is_there(program))
        .map(|(_, package)| *package)
        .collect();
    ensure!(missing.is_empty(), "these Debian packages are missing: apt-get install {}", missing.join(" "));
    Ok(())
}

/// Clips, projects and programs of a run.
struct Suite<'a> {
    lab: &'a Lab,
    programs: PathBuf,
    leaves: Option<PathBuf>,
    stop: Arc<AtomicBool>,
}

impl<'a> Suite<'a> {
    fn prepare(lab: &'a Lab, stop: Arc<AtomicBool>) -> anyhow::Result<Self> {
        let data = std::env::var_os("HONAMI_DATA").map(PathBuf::from);
        let leaves = data.map(|data| data.join("video/leaves_cut.mp4")).filter(|clip| clip.is_file());
        let suite = Self { lab, programs: target_dir()?.join("release"), leaves, stop };
        suite.honami().arg("synth").arg(suite.file("storm.y4m")).args(STORM).run()?;
        if let Some(leaves) = &suite.leaves {
            fs::copy(leaves, suite.file("leaves.mp4")).with_context(|| format!("{}", leaves.display()))?;
        }
        fs::write(suite.file("tmux.conf"), TMUX)?;
        for clip in ["storm.y4m", "leaves.mp4"].map(|name| suite.file(name)) {
            if clip.exists() {
                suite.honami().arg("new").arg(clip.with_extension("honami")).arg(clip).run()?;
            }
        }
        Ok(suite)
    }

    /// A file of this run.
    fn file(&self, name: &str) -> PathBuf {
        self.lab.folder().join(name)
    }

    fn clip(&self, clip: Clip) -> PathBuf {
        self.file(if clip == Clip::Storm { "storm.y4m" } else { "leaves.mp4" })
    }

    fn honami(&self) -> Step {
        let folder = self.lab.folder();
        Step::new(self.programs.join("honami")).env("XDG_CACHE_HOME", folder).env("XDG_STATE_HOME", folder)
    }

    /// Why a case cannot be measured here.
    fn cannot(&self, case: &Case) -> Option<&'static str> {
        match () {
            () if case.clip == Clip::Leaves && self.leaves.is_none() => {
                Some("HONAMI_DATA names no folder with video/leaves_cut.mp4")
            }
            () if case.through == Through::Mosh && !system::is_there("mosh") => Some("mosh is not installed"),
            () if case.through == Through::Tmux && !system::is_there("tmux") => Some("tmux is not installed"),
            () => None,
        }
    }

    /// One session from start to end.
    fn measure(&self, case: &Case) -> anyhow::Result<Value> {
        let link = self.lab.link(case.link)?;
        let pid = self.file("pid");
        if pid.exists() {
            fs::remove_file(&pid)?;
        }
        // Anew for every session: a project remembers where its user was.
        let project = self.clip(case.clip).with_extension("honami");
        fs::copy(&project, self.file("case.honami")).with_context(|| project.display().to_string())?;
        let many = self.file("many.honami");
        if case.program == Program::ManyTracks && !many.exists() {
            let example = self.programs.join("examples/many_tracks");
            must(Command::new(example).arg(self.clip(case.clip)).arg(&many))?;
        }
        let output = self.file("result.json");
        let mut user = Command::new(self.programs.join("examples/wan_user"));
        user.env("XDG_CACHE_HOME", self.lab.folder());
        user.arg("--clip").arg(self.clip(case.clip)).arg("--pid-file").arg(&pid);
        user.arg("--size")
            .arg(format!("{}x{}", case.size.0, case.size.1))
            .arg("--db")
            .arg(format!("{}", case.db()));
        user.arg("--answers").arg(case.answers);
        if case.program == Program::ManyTracks {
            user.args(["--only", "start"]);
        }
        let line = self.line(case, &pid);
        user.arg("--").args(match case.through {
            Through::Ssh | Through::Tmux => self.lab.ssh(false, &line),
            Through::Compressed => self.lab.ssh(true, &line),
            Through::Mosh => self.lab.mosh(&line),
        });
        user.stdin(Stdio::null()).stdout(fs::File::create(&output)?);
        self.wait(&mut user)?;
        let mut result: Value = serde_json::from_str(&fs::read_to_string(&output)?)?;
        result["link"] = link.down()?;
        Ok(result)
    }

    /// What the shell of the far end runs: the program says its number, and when it starts.
    fn line(&self, case: &Case, pid: &Path) -> String {
        let folder = self.lab.folder().display();
        let program = match case.program {
            Program::Honami => {
                let project = self.file("case.honami");
                format!("{} {}", self.programs.join("honami").display(), project.display())
            }
            Program::ManyTracks => {
                let project = self.file("many.honami");
                format!("{} {}", self.programs.join("honami").display(), project.display())
            }
            Program::Plain => {
                let viewer = self.programs.join("examples/plain_viewer");
                format!("{} {}", viewer.display(), self.clip(case.clip).display())
            }
        };
        let env = format!("XDG_CACHE_HOME={folder} XDG_STATE_HOME={folder} COLORTERM=truecolor");
        // `exec` keeps the number that the shell has.
        let start = format!(
            "export {env}; printf '\\033]0;honami-wan-exec\\007'; echo $$ > {}; exec {program}",
            pid.display()
        );
        if case.through != Through::Tmux {
            return start;
        }
        let quoted = start.replace('\'', "'\\''");
        format!("tmux -u -S {folder}/tmux -f {folder}/tmux.conf new-session '{quoted}'")
    }

    /// Waits for a command that must succeed, or ends it when somebody wants the run to end.
    fn wait(&self, command: &mut Command) -> anyhow::Result<()> {
        let mut child = command.spawn().with_context(|| format!("cannot start {command:?}"))?;
        loop {
            if let Some(status) = child.try_wait()? {
                ensure!(status.success(), "the scripted user ended with {status}");
                return Ok(());
            }
            if self.stop.load(Ordering::Relaxed) {
                child.kill()?;
                child.wait()?;
                bail!("stopped");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}
