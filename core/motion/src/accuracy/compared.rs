//! One track beside its truth, or beside another track, sample by sample.

use honami_model::track::Span;

use super::TruePath;

/// A sample beside the truth of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Its frame.
    pub frame: u32,
    /// Whether the feature can be seen there.
    pub visible: bool,
    /// From the true position to that of the track, right and down, pixels; `None` where the track is not seen.
    pub offset_px: Option<[f64; 2]>,
}

impl Compared {
    /// Distance from the truth, pixels; `None` where the track is not seen.
    #[must_use]
    pub fn error_px(&self) -> Option<f64> {
        self.offset_px.map(|[x, y]| x.hypot(y))
    }

    /// The same, where a sample that is not seen is farther off than any other.
    #[must_use]
    pub fn far_px(&self) -> f64 {
        self.error_px().unwrap_or(f64::INFINITY)
    }
}

/// The samples of a track in the frames of a true path after `query_frame`.
#[must_use]
pub fn compared(truth: &TruePath, query_frame: u32, track: &Span) -> Vec<Compared> {
    let after_query = (truth.first_frame..).zip(&truth.positions).filter(|(frame, _)| *frame > query_frame);
    let sample = |(frame, &(x, y, visible)): (u32, &(f64, f64, bool))| {
        let seen = track.get(frame).filter(|sample| sample.status.is_seen());
        let offset_px = seen.map(|s| [f64::from(s.x) - x, f64::from(s.y) - y]);
        Compared { frame, visible, offset_px }
    };
    after_query.map(sample).collect()
}
