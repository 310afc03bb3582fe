//! The control pipe: what whoever starts the viewer writes to it, and what it answers. JSON, a line each; docs/viewer.md has a
//! table of both.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// What both sides speak. Whoever hears another number says so, instead of guessing.
pub const PROTOCOL: u32 = 1;

/// What the viewer is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Time goes on.
    Play,
    /// Time stands.
    Pause,
    /// This frame of the clip, or of what is shown.
    Frame(u32),
    /// Another scene file takes the place of what is shown; from where it is seen stays.
    Scene {
        /// [`PROTOCOL`].
        protocol: u32,
        /// The file.
        path: PathBuf,
    },
    /// The hierarchy is cut into so many groups.
    Cut(u32),
    /// The wind, as it is typed.
    Wind(String),
    /// From where it is seen.
    Camera(Seat),
    /// What is chosen; `null`: nothing.
    Select(Option<Chosen>),
    /// A line for whoever looks; what is being shaped or placed is let be.
    Say(String),
    /// What the window shows is written as an image, `.png`.
    Capture(PathBuf),
    /// The viewer ends.
    Quit,
}

/// Where the camera is; what is left out stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Seat {
    /// About the upright, counterclockwise from above, degrees; 0 from the front.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_deg: Option<f32>,
    /// Above the level of what is looked at, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation_deg: Option<f32>,
    /// From there to the eye, in the lengths of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f32>,
}

/// What of a skeleton is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Chosen {
    /// A track, by its number.
    Track(u64),
    /// A bone, by its number in the dendrogram.
    Bone(u32),
}

/// What the viewer tells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Event {
    /// It shows the scene that it was started with.
    Ready {
        /// [`PROTOCOL`].
        protocol: u32,
        /// What draws.
        adapter: String,
    },
    /// Somebody has gone to this frame.
    Frame(u32),
    /// It plays, and shows this frame now.
    Passing(u32),
    /// Somebody has begun or stopped to play.
    Playing(bool),
    /// Somebody has chosen something, or nothing.
    Selected(Option<Chosen>),
    /// A bone is to be shaped so from now on.
    Shape {
        /// Its number in the dendrogram.
        node: u32,
        /// By how much its plane is turned out of the picture, degrees, -180 to 180.
        plane_deg: f64,
        /// By how much it leans, degrees, -180 to 180.
        lean_deg: f64,
        /// How many times as far it swings, 0 to 10.
        gain: f64,
    },
    /// The root is to be here, pixels of the clip (right, down), or where it grows.
    Root(Option<[f64; 2]>),
    /// The hierarchy is to be cut into so many groups.
    Cut(u32),
    /// What was done last is to be taken back.
    Undo,
    /// What was taken back last is to be done again.
    Redo,
    /// The image that was asked for is there.
    Captured(PathBuf),
    /// Somebody has closed the window.
    Closed,
    /// Something could not be done, and why.
    Failed(String),
}

/// A line that says nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a line of the control pipe says nothing: {why}: {line}")]
pub struct Garbled {
    /// What was wrong with it.
    pub why: String,
    /// It, or how it begins.
    pub line: String,
}

/// So much of a garbled line is told.
const TOLD_CHARS: usize = 120;

/// Reads a command: JSON, or, as people type, its word alone or with what it says after a space (`play`, `frame 12`,
/// `wind storm`).
///
/// # Errors
/// [`Garbled`]; the next line may be whole again.
pub fn command(line: &str) -> Result<Command, Garbled> {
    match line.trim_start().starts_with(['{', '"']) {
        true => read(line),
        false => {
            let (word, said) = line.trim().split_once(' ').unwrap_or((line.trim(), "null"));
            let read = |said: serde_json::Value| {
                let command = serde_json::Map::from_iter([(word.to_owned(), said)]);
                serde_json::from_value(command.into()).map_err(|why| garbled(line, &why))
            };
            // What looks like a number or the like may be meant as words: `say 12`.
            let words = || read(said.trim().into());
            match serde_json::from_str(said) {
                Ok(said) => read(said).or_else(|why| words().map_err(|_also| why)),
                Err(_words) => words(),
            }
        }
    }
}

/// Reads an event.
///
/// # Errors
/// [`Garbled`].
pub fn event(line: &str) -> Result<Event, Garbled> {
    read(line)
}

/// What is written of a command or an event: one line, with its end.
#[must_use]
pub fn line(said: &impl Serialize) -> String {
    // Numbers that are none are null in JSON, and keys are names: nothing of these types has no JSON.
    serde_json::to_string(said).unwrap_or_default() + "\n"
}

fn read<'a, T: Deserialize<'a>>(line: &'a str) -> Result<T, Garbled> {
    serde_json::from_str(line.trim()).map_err(|why| garbled(line, &why))
}

fn garbled(line: &str, why: &serde_json::Error) -> Garbled {
    Garbled { why: why.to_string(), line: line.trim().chars().take(TOLD_CHARS).collect() }
}

#[cfg(test)]
mod tests;
