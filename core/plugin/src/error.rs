//! Why a plugin could not do it: a code of the ABI and a sentence for the user.

use honami_abi::code;

/// A failure, as the user will read it. `?` makes one of any standard error (with code "failed").
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    code: i32,
    text: String,
}

/// What plugin functions return.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// It did not work.
    pub fn failed(text: impl Into<String>) -> Self {
        Self { code: code::FAILED, text: text.into() }
    }

    /// The input cannot be worked on: too few points, nothing moves.
    pub fn data(text: impl Into<String>) -> Self {
        Self { code: code::DATA, text: text.into() }
    }

    /// Not offered for this input.
    pub fn unsupported(text: impl Into<String>) -> Self {
        Self { code: code::UNSUPPORTED, text: text.into() }
    }

    /// The host said stop. [`Cx::progress`](crate::Cx::progress) makes it; pass it on with `?`.
    #[must_use]
    pub fn cancelled() -> Self {
        Self { code: code::CANCELLED, text: "cancelled".into() }
    }

    /// The code that goes over the border; negative.
    #[must_use]
    pub fn code(&self) -> i32 {
        self.code
    }

    pub(crate) fn with_code(code: i32, text: impl Into<String>) -> Self {
        Self { code, text: text.into() }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

// `Error` is no `std::error::Error` itself: that is what lets every other one become it.
impl<E: std::error::Error> From<E> for Error {
    fn from(error: E) -> Self {
        Self::failed(error.to_string())
    }
}
