//! The helper programs that honami uses where they are installed: ffmpeg and ffprobe.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Version of the installed ffmpeg, as in "5.1.9-0+deb12u1"; `None` unless both ffmpeg and ffprobe are there.
///
/// Looked up once per process.
#[must_use]
pub fn ffmpeg_version() -> Option<String> {
    static FOUND: OnceLock<Option<String>> = OnceLock::new();
    FOUND.get_or_init(|| is_on_path("ffprobe").then(find_version)?).clone()
}

fn is_on_path(program: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|dir| dir.join(program).is_file()))
}

/// Third word of the first line: `ffmpeg version 5.1.9-0+deb12u1 Copyright ...`.
fn find_version() -> Option<String> {
    let output = Command::new("ffmpeg").arg("-version").stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    output.status.success().then(|| text.split_whitespace().nth(2).unwrap_or("unknown").to_owned())
}

/// A path as ffmpeg takes it, so that no name is read as an option or a protocol.
pub(crate) fn file_url(path: &Path) -> OsString {
    let mut url = OsString::from("file:");
    url.push(path);
    url
}

/// The option for "each frame once, none added": renamed in ffmpeg 5.1.
pub(crate) fn every_frame() -> [&'static str; 2] {
    let version = ffmpeg_version().unwrap_or_default();
    let mut numbers = version.split(|c: char| !c.is_ascii_digit()).map(str::parse::<u32>);
    let is_old = match (numbers.next(), numbers.next()) {
        (Some(Ok(major)), minor) => (major, minor.and_then(Result::ok).unwrap_or(0)) < (5, 1),
        _ => false,
    };
    [if is_old { "-vsync" } else { "-fps_mode" }, "passthrough"]
}
