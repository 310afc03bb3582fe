//! The control pipe: commands come by standard input, events go by standard output.

use std::io::{BufRead as _, Write as _};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use eframe::egui::Context;
use honami_scene::control::{self, Command, Event};

/// Commands that wait to be done.
const WAITING: usize = 256;

/// Both ways.
pub(super) struct Pipe {
    commands: Option<Receiver<Command>>,
}

impl Pipe {
    /// Listens and tells; where nobody steers, neither.
    ///
    /// # Errors
    /// Where the system has no thread left.
    pub(super) fn new(context: &Context, is_steered: bool) -> std::io::Result<Self> {
        if !is_steered {
            return Ok(Self { commands: None });
        }
        let (told, commands) = sync_channel(WAITING);
        let context = context.clone();
        let listen = move || listen(&told, &context);
        std::thread::Builder::new().name("control pipe".to_owned()).spawn(listen)?;
        Ok(Self { commands: Some(commands) })
    }

    /// The next command, if there is one.
    pub(super) fn next(&self) -> Option<Command> {
        self.commands.as_ref()?.try_recv().ok()
    }

    /// Tells whoever steers. Nobody left to hear it is no reason to fail: the pipe's end is the viewer's.
    pub(super) fn tell(&self, event: &Event) {
        if self.commands.is_some() {
            tell(event);
        }
    }

    /// Writes what the window shows into a file, and tells when it is there.
    pub(super) fn capture(&self, context: &Context, path: std::path::PathBuf) {
        let is_steered = self.commands.is_some();
        context.request_screenshot(move |picture| {
            let [width, height] = picture.size.map(|side| u32::try_from(side).unwrap_or_default());
            let pixels: Vec<[u8; 3]> = picture.pixels.iter().map(|at| [at.r(), at.g(), at.b()]).collect();
            let event = match honami_media::write::still(&path, &pixels, width, height) {
                Ok(()) => Event::Captured(path),
                Err(why) => Event::Failed(why.to_string()),
            };
            if is_steered {
                tell(&event);
            }
        });
    }
}

/// Writes an event.
pub(crate) fn tell(event: &Event) {
    let mut out = std::io::stdout().lock();
    out.write_all(control::line(event).as_bytes()).and_then(|()| out.flush()).unwrap_or_default();
}

/// Until the pipe ends, with which the viewer ends.
fn listen(told: &SyncSender<Command>, context: &Context) {
    for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line);
        if line.trim().is_empty() {
            continue;
        }
        match control::command(&line) {
            Ok(command) => match told.send(command) {
                Ok(()) => context.request_repaint(),
                Err(_nobody) => return,
            },
            Err(garbled) => tell(&Event::Failed(garbled.to_string())),
        }
    }
    told.send(Command::Quit).unwrap_or_default();
    context.request_repaint();
}
