//! Any video through ffmpeg as a child process: always decoded from the start, never sought.
//!
//! Seeking (`-ss`) gives wrong frames on MPEG-TS and open GOPs; frame n is the n-th frame of a sequential decode.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdout, Command, Stdio};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use super::{Decode, Shape, Source};
use crate::convert::Coded;
use crate::error::{MediaError, Size};
use crate::programs;

mod probe;

pub(crate) use probe::probe;

/// How long the first frame's report may take before frames are handed on unchecked.
const FIRST_REPORT: Duration = Duration::from_secs(20);

struct Video {
    path: PathBuf,
    shape: Shape,
    coded: Coded,
    /// `-pix_fmt` where the stream's own samples are of no use to us.
    pixel_format: Option<&'static str>,
}

impl Source for Video {
    fn recipe(&self) -> String {
        format!("ffmpeg {}, planes 1", programs::ffmpeg_version().unwrap_or_default())
    }

    fn decode(&self, _wanted: u32) -> Result<(u32, Box<dyn Decode>), MediaError> {
        Ok((0, Box::new(Running::start(self)?)))
    }
}

struct Running {
    path: PathBuf,
    shape: Shape,
    coded: Coded,
    child: Child,
    frames: BufReader<ChildStdout>,
    log: Arc<Log>,
    log_reader: Option<JoinHandle<()>>,
    next: u32,
    stored: Vec<u8>,
}

impl Running {
    fn start(video: &Video) -> Result<Self, MediaError> {
        let mut command = Command::new("ffmpeg");
        command.args([
            "-nostdin",
            "-hide_banner",
            "-nostats",
            "-loglevel",
            "level+info",
            "-noautorotate",
            "-i",
        ]);
        command.arg(programs::file_url(&video.path)).args(["-map", "0:v:0"]);
        // `showinfo` reports the coded size of each frame: ffmpeg itself would scale later sizes to the first.
        command.args(["-vf", "showinfo=checksum=0"]).args(programs::every_frame());
        if let Some(format) = video.pixel_format {
            command.args(["-pix_fmt", format]);
        }
        command.args(["-f", "rawvideo", "-"]);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|e| MediaError::io("start ffmpeg", &video.path, e))?;
        let pipes = child.stdout.take().zip(child.stderr.take());
        let (stdout, stderr) = pipes.unwrap_or_else(|| unreachable!("both were asked for"));
        let log = Arc::new(Log::default());
        let for_reader = Arc::clone(&log);
        let log_reader = std::thread::Builder::new()
            .name("honami-ffmpeg-log".to_owned())
            .spawn(move || for_reader.follow(stderr))
            .map_err(|e| MediaError::io("start a thread for", &video.path, e))?;
        Ok(Self {
            path: video.path.clone(),
            shape: video.shape,
            coded: video.coded,
            child,
            frames: BufReader::with_capacity(1 << 16, stdout),
            log,
            log_reader: Some(log_reader),
            next: 0,
            stored: vec![0; video.coded.frame_len(video.shape.width, video.shape.height)],
        })
    }

    /// The stream has ended: says so, or why it should not have.
    fn end(&mut self, leftover: usize) -> Result<bool, MediaError> {
        let status = self.child.wait().map_err(|e| MediaError::io("wait for ffmpeg on", &self.path, e))?;
        if let Some(reader) = self.log_reader.take() {
            // A panic there would only cost the text of a complaint.
            reader.join().unwrap_or_default();
        }
        if leftover > 0 || !status.success() {
            let line = self.log.complaint().unwrap_or_else(|| status.to_string());
            return Err(MediaError::Program { program: "ffmpeg", line, path: self.path.clone() });
        }
        Ok(false)
    }
}

impl Decode for Running {
    fn next(&mut self, frame: &mut [u8]) -> Result<bool, MediaError> {
        let raw = self.coded.is_planes();
        let target = if raw { &mut *frame } else { &mut self.stored };
        let read =
            fill(&mut self.frames, target).map_err(|e| MediaError::io("read from ffmpeg", &self.path, e))?;
        if read < target.len() {
            return self.end(read);
        }
        if let Some(found) = self.log.size_of(self.next)
            && found != Size(self.shape.width, self.shape.height)
        {
            let first = Size(self.shape.width, self.shape.height);
            return Err(MediaError::SizeChange { path: self.path.clone(), frame: self.next, found, first });
        }
        if !raw {
            self.coded.to_planes(&self.stored, &self.shape, frame);
        }
        self.next += 1;
        Ok(true)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail only when it has ended by itself.
        self.child.kill().unwrap_or_default();
        self.child.wait().map(|_| ()).unwrap_or_default();
    }
}

/// Reads until the buffer is full or the stream ends; says how much came.
fn fill(from: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut read = 0;
    while read < buffer.len() {
        match from.read(&mut buffer[read..]) {
            Ok(0) => break,
            Ok(n) => read += n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(read)
}

/// What ffmpeg says while it decodes.
#[derive(Default)]
struct Log {
    said: Mutex<Said>,
    more: Condvar,
}

#[derive(Default)]
struct Said {
    /// Sizes from frame k on, where it differs from the one before.
    sizes: Vec<(u32, Size)>,
    /// Frames reported so far.
    n_frames: u32,
    complaint: Option<String>,
    ended: bool,
    silent: bool,
}

impl Log {
    fn follow(&self, stderr: ChildStderr) {
        for line in BufReader::new(stderr).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(size) = frame_report(&line) {
                // Counted here: ffmpeg's own count starts again where the size changes.
                let n = said.n_frames;
                if said.sizes.last().is_none_or(|&(_, before)| before != size) {
                    said.sizes.push((n, size));
                }
                said.n_frames += 1;
                self.more.notify_all();
            } else if let Some(text) = complaint(&line) {
                said.complaint.get_or_insert(text);
            }
        }
        self.said.lock().unwrap_or_else(PoisonError::into_inner).ended = true;
        self.more.notify_all();
    }

    /// Coded size of a frame that has been read; `None` when ffmpeg does not report.
    fn size_of(&self, frame: u32) -> Option<Size> {
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        // The report is written before the frame is: after the first one this never waits in vain.
        let waiting = |said: &mut Said| said.n_frames <= frame && !said.ended && !said.silent;
        let waited = self.more.wait_timeout_while(said, FIRST_REPORT, waiting);
        let (mut said, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        said.silent |= timeout.timed_out();
        said.sizes.iter().rev().find(|&&(from, _)| from <= frame).map(|&(_, size)| size)
    }

    fn complaint(&self) -> Option<String> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).complaint.clone()
    }
}

/// The size in a line of `showinfo` on a frame: `... n:   8 pts:  16384 ... s:160x120 ...`.
fn frame_report(line: &str) -> Option<Size> {
    let (_, report) = line.split_once("showinfo")?;
    let (_, after_n) = report.split_once(" n:")?;
    let (width, height) = after_n.split_once(" s:")?.1.split_whitespace().next()?.split_once('x')?;
    Some(Size(width.parse().ok()?, height.parse().ok()?))
}

/// The text of an error line, without the `[h264 @ 0x...] [error]` before it.
fn complaint(line: &str) -> Option<String> {
    let text = line.split_once("[error] ").or_else(|| line.split_once("[fatal] "))?.1;
    Some(text.trim().to_owned())
}

/// First line of what a program wrote to stderr, without ffmpeg's prefix and without the path.
fn first_line(stderr: &[u8], path: &Path) -> String {
    let text = String::from_utf8_lossy(stderr);
    let line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or("it said nothing");
    let line = line.strip_prefix('[').and_then(|rest| rest.split_once("] ")).map_or(line, |(_, text)| text);
    let url = programs::file_url(path).to_string_lossy().into_owned();
    line.strip_prefix(&url).map_or(line, |rest| rest.trim_start_matches(": ")).trim().to_owned()
}
