//! The window: what is done there are edits of the project, and what scripts say is passed on.

use std::ffi::OsString;
use std::io::{BufRead as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{ExitCode, Stdio};
use std::sync::mpsc::{Receiver, sync_channel};

use anyhow::bail;
use honami_workbench::scene::control::{self, Command, Event, PROTOCOL};
use honami_workbench::scene::{ForestScene, Scene};
use honami_workbench::store::{Access, Project, StoreError};
use honami_workbench::view;

use super::forest::SIZE;
use super::{Grower, words};
use crate::cli::args::Common;
use crate::cli::args::view::View;
use crate::cli::report;
use crate::viewer::{self, Heard, Scenes, Teller, usual_size};

/// Lines of the viewer that wait to be heard.
const WAITING: usize = 256;

/// Shows a window until it is closed. What is done there are edits of the project.
pub(super) fn window(args: &View, project: &Path, common: &Common) -> anyhow::Result<ExitCode> {
    let (project, line) = open(project)?;
    let grower = Grower::of(args, common)?;
    let (scene, notes) = grower.grow(&project, common)?;
    line.iter().chain(&notes).for_each(|line| report::say(line));
    let size = args.size.map_or_else(|| usual_size(&scene), |size| [size.width, size.height]);
    let mut scenes = Scenes::new()?;
    let path = scenes.write(&Scene::Skeleton(Box::new(scene)))?;
    let (tell, hear) = start(words(args, &path, size), common)?;
    let mut shown = Shown { project, grower, scenes, tell, common };
    listen(hear, common, |event| shown.hear(event))
}

/// Shows a forest in a window until it is closed.
pub(super) fn forest(args: &View, scene: ForestScene, common: &Common) -> anyhow::Result<ExitCode> {
    let mut scenes = Scenes::new()?;
    let path = scenes.write(&Scene::Forest(Box::new(scene)))?;
    let size = args.size.map_or(SIZE, |size| [size.width, size.height]);
    let (_tell, hear) = start(words(args, &path, size), common)?;
    listen(hear, common, |_event| Ok(()))
}

/// Starts a window; what scripts say is passed on to it.
fn start(mut words: Vec<OsString>, common: &Common) -> anyhow::Result<(Teller, Receiver<Heard>)> {
    let (said, hear) = sync_channel(WAITING);
    let heard = move |heard| said.send(heard).unwrap_or_default();
    words.push("--control".into());
    let tell = viewer::start(&words, Stdio::inherit(), heard)?;
    if common.json {
        relay(tell.clone())?;
    }
    Ok((tell, hear))
}

/// Hears a window until it is closed; tells scripts what it says.
fn listen(
    hear: Receiver<Heard>,
    common: &Common,
    mut each: impl FnMut(&Event) -> anyhow::Result<()>,
) -> anyhow::Result<ExitCode> {
    for heard in hear {
        let event = match heard {
            Heard::Said(event) => event,
            Heard::Garbled(garbled) => {
                report::say(&format!("the viewer: {garbled}"));
                continue;
            }
            Heard::Ended(None) => break,
            Heard::Ended(Some(how)) => bail!(how),
        };
        if common.json {
            let mut out = std::io::stdout().lock();
            out.write_all(control::line(&event).as_bytes()).and_then(|()| out.flush())?;
        }
        match &event {
            Event::Ready { protocol, .. } => {
                if let Some(why) = viewer::stranger(*protocol) {
                    bail!(why);
                }
            }
            Event::Failed(why) => report::say(&format!("the viewer: {why}")),
            _ => {}
        }
        each(&event)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The project, to write, or to look where another session writes, which is said.
fn open(path: &Path) -> anyhow::Result<(Project, Option<String>)> {
    match Project::open(path, Access::Write) {
        Err(locked @ StoreError::Locked { .. }) => {
            let line = format!("{locked}; what is done in the window is not kept");
            Ok((Project::open(path, Access::Read)?, Some(line)))
        }
        other => Ok((other?, None)),
    }
}

/// Passes on to the viewer what comes by standard input, for as long as anything does.
fn relay(tell: Teller) -> std::io::Result<()> {
    let pass = move || {
        // What is no text is garbled, and told as such: the next line is read.
        for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
            tell.pass(&format!("{}\n", String::from_utf8_lossy(&line)));
        }
    };
    std::thread::Builder::new().name("relay".to_owned()).spawn(pass).map(drop)
}

/// What a window shows.
struct Shown<'a> {
    project: Project,
    grower: Grower,
    scenes: Scenes,
    tell: Teller,
    common: &'a Common,
}

impl Shown<'_> {
    /// Does what is asked for, and shows what has become of it.
    fn hear(&mut self, event: &Event) -> anyhow::Result<()> {
        match event {
            event if view::is_edit(event) => {
                let line = match self.edit(event) {
                    Ok(Some(line)) => line,
                    Ok(None) => return Ok(()),
                    Err(error) => report::chain(&error),
                };
                report::say(&line);
                self.tell(&Command::Say(line));
            }
            _ => {}
        }
        Ok(())
    }

    fn edit(&mut self, event: &Event) -> anyhow::Result<Option<String>> {
        let Some(line) = view::edit(&mut self.project, event)? else { return Ok(None) };
        // The cut that was asked for last is the one to see.
        if let Event::Cut(_) = event {
            self.grower.request.groups = None;
        }
        if let Event::Root(_) = event {
            self.grower.request.root = None;
        }
        let shown = self.show().err();
        // It is kept, whatever there is to be seen of it.
        Ok(Some(shown.map_or_else(
            || line.clone(),
            |why| format!("{line}; what is shown is older: {}", report::chain(&why)),
        )))
    }

    /// Shows the skeleton as it is now.
    fn show(&mut self) -> anyhow::Result<()> {
        let (scene, _) = self.grower.grow(&self.project, self.common)?;
        let path: PathBuf = self.scenes.write(&Scene::Skeleton(Box::new(scene)))?;
        self.tell(&Command::Scene { protocol: PROTOCOL, path });
        Ok(())
    }

    fn tell(&self, command: &Command) {
        if !self.tell.tell(&control::line(command)) {
            report::say("the window does not keep up: what it shows is behind");
        }
    }
}
