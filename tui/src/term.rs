//! The terminal: bytes in, bytes out, and nothing of honami.
//!
//! `term` knows nothing of clips, tracks or plugins. It decodes what the terminal sends (`input`), learns what
//! it can do (`capabilities`), keeps a model of what it shows (`encode`, and `glyph` for
//! characters as pixels), spends no more bytes than the link carries (`link`), paints
//! whole frames (`writer`), gives the terminal back as it was (`tty`), and waits for all of it (`screen`).

pub mod capabilities;
pub mod colour;
pub mod encode;
pub mod glyph;
pub mod input;
pub mod key;
pub mod link;
mod prints;
pub mod screen;
pub mod signals;
pub mod still;
pub mod tty;
pub mod writer;
