//! Judgements: what a reviewer has found of a segment of a track, and what it took.

use serde::{Deserialize, Serialize};

/// What a reviewer has found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Right as it is.
    Accepted,
    /// Right now, after corrections.
    Fixed,
    /// The feature is hidden here.
    Occluded,
    /// The feature is lost from here on.
    Lost,
    /// The track is of no use.
    Rejected,
    /// To be looked at again.
    Later,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Accepted, Self::Fixed, Self::Occluded, Self::Lost, Self::Rejected, Self::Later];

    /// The word used in tables and on screen.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Fixed => "fixed",
            Self::Occluded => "occluded",
            Self::Lost => "lost",
            Self::Rejected => "rejected",
            Self::Later => "later",
        }
    }
}

/// What a judgement took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Keys pressed since the segment was opened.
    pub keystrokes: u32,
    /// Key-frames made since then.
    pub key_frames: u32,
    /// Time since then, pauses left out, seconds.
    pub seconds: f32,
}

/// A reviewer's word on a segment of a track.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// One past the segment's last frame.
    pub end_frame: u32,
    /// What was found.
    pub verdict: Verdict,
    /// Why the segment was looked at: short codes such as `FB`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<String>,
    /// Who judged.
    pub reviewer: String,
    /// When, RFC 3339.
    pub time: String,
    /// What it took.
    pub effort: Effort,
    /// Seal of the samples that were judged ([`Span::seal`](crate::track::Span::seal)): when theirs is another,
    /// they have changed since, and the judgement says nothing of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seal: Option<u32>,
}
