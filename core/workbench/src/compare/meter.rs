//! What a tracker costs: time and memory.

use std::hint::black_box;
use std::ops::Range;

use honami_media::Media;

use crate::error::WorkbenchError;
use crate::progress::{Flow, Progress};

/// Bytes in a page of memory, at least.
const PAGE: usize = 4096;

/// Time in a tracker, milliseconds a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// All of it, shared among the frames.
    pub mean_ms: f64,
    /// Of the frame in the middle.
    pub median_ms: f64,
    /// 95 % of the frames take no longer.
    pub p95_ms: f64,
}

impl Time {
    /// Of the seconds that each frame took; `None` of none.
    pub(super) fn of(step_secs: &[f64]) -> Option<Self> {
        let mut sorted = step_secs.to_vec();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let share = |part: f64| 1e3 * sorted[(last as f64 * part).round() as usize];
        let mean_ms = 1e3 * sorted.iter().sum::<f64>() / sorted.len() as f64;
        Some(Self { mean_ms, median_ms: share(0.5), p95_ms: share(0.95) })
    }
}

/// Decodes the frames and looks at every page of them: what they take, in time and memory, is no tracker's cost.
pub(super) fn warm(media: &Media, frames: Range<u32>, progress: &dyn Progress) -> Result<(), WorkbenchError> {
    let (first, total) = (frames.start, u64::from(frames.end - frames.start));
    for frame in frames {
        if progress.report(u64::from(frame - first), total, "decoding") == Flow::Stop {
            return Err(WorkbenchError::Stopped);
        }
        let picture = media.frame(frame)?;
        black_box(picture.bytes().iter().step_by(PAGE).fold(0_u8, |sum, byte| sum ^ byte));
    }
    Ok(())
}

/// The resident memory of this program while something is at work.
pub(super) struct Memory {
    before_bytes: u64,
}

impl Memory {
    /// Forgets what the peak was before; `None` where the system keeps none (`/proc`, as on Linux).
    pub(super) fn begin() -> Option<Self> {
        // "5" resets the peak to what is resident now: proc(5).
        std::fs::write("/proc/self/clear_refs", "5").ok()?;
        Some(Self { before_bytes: status("VmRSS:")? })
    }

    /// How far the peak since then lies above what was resident then, bytes.
    pub(super) fn peak_bytes(self) -> Option<u64> {
        Some(status("VmHWM:")?.saturating_sub(self.before_bytes))
    }
}

/// A line of `/proc/self/status`, bytes.
fn status(name: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}
