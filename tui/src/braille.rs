//! Dots finer than letters: eight to a cell.

/// Bits of the dots of a pattern, four rows of two.
pub(crate) const DOTS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// The character with these dots.
pub(crate) fn braille(dots: u8) -> char {
    // All 256 patterns are characters.
    char::from_u32(0x2800 + u32::from(dots)).unwrap_or(' ')
}
