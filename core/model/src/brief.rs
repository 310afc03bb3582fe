//! Numbers in messages: short, whatever they are.

use std::fmt;

/// A number as people write it; very large and very small ones by powers of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brief(pub f64);

impl fmt::Display for Brief {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-4..1e7).contains(&size) || !size.is_finite() {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Brief;

    #[test]
    fn a_number_is_short_and_the_same() {
        for (value, wanted) in [
            (0.0, "0"),
            (-1.0, "-1"),
            (0.0125, "0.0125"),
            (1_234_567.0, "1234567"),
            (1e7, "1e7"),
            (-1e300, "-1e300"),
            (5e-324, "5e-324"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(Brief(value).to_string(), wanted);
        }
    }
}
