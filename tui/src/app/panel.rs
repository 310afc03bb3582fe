//! The panels of the column: one is shown at a time, or none.

/// What the column shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Panel {
    /// The queue of doubtful segments.
    Queue,
    /// The tracks, with their doubt over the clip.
    Tracks,
    /// The groups of the shown clustering.
    Groups,
    /// The bones of the skeleton.
    Skeleton,
    /// The key-frames of the selected track.
    KeyFrames,
    /// The undo tree.
    History,
    /// Curves of the selected track or its group.
    Plots,
    /// Two runs beside each other.
    Versus,
    /// What plugins print and log.
    Prints,
    /// What was done in this session.
    Log,
}

impl Panel {
    /// All of them, in the order in which they follow each other.
    pub const ALL: &[Self] = &[
        Self::Queue,
        Self::Tracks,
        Self::Groups,
        Self::Skeleton,
        Self::KeyFrames,
        Self::History,
        Self::Plots,
        Self::Versus,
        Self::Prints,
        Self::Log,
    ];

    /// What its title calls it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Queue => "queue",
            Self::Tracks => "tracks",
            Self::Groups => "groups",
            Self::Skeleton => "skeleton",
            Self::KeyFrames => "key-frames",
            Self::History => "history",
            Self::Plots => "plots",
            Self::Versus => "A/B",
            Self::Prints => "prints",
            Self::Log => "log",
        }
    }

    /// What follows: from nothing the first, after the last nothing.
    #[must_use]
    pub fn after(shown: Option<Self>) -> Option<Self> {
        let next = shown.and_then(|shown| Self::ALL.iter().position(|p| *p == shown)).map_or(0, |at| at + 1);
        Self::ALL.get(next).copied()
    }
}
