//! What is wrong with the mattes that a project keeps.

/// Why mattes of a project cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MatteError {
    /// Not one.
    #[error("the project keeps no matte: `honami matte PROJECT --scribbles IMAGE` finds one")]
    None,
    /// Not of this frame.
    #[error("no matte of frame {frame} is kept; there are those of {}", crate::matte::kept::frames(of))]
    NoneOf {
        /// As it came.
        frame: u32,
        /// Those that have one, rising.
        of: Vec<u32>,
    },
    /// All of them leave all of their frames out.
    #[error(
        "the kept mattes leave all of the picture out: a smaller --band keeps more, --no-mask looks everywhere"
    )]
    NothingKept,
}
