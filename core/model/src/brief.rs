//! Numbers and errors in messages: short, whatever they are.

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

/// So many of what one is called: `1 group`, `3 groups`, `2 leaves`.
#[must_use]
pub fn counted(n: usize, one: &str) -> String {
    match one {
        _ if n == 1 => format!("1 {one}"),
        "leaf" => format!("{n} leaves"),
        "branch" => format!("{n} branches"),
        "vertex" => format!("{n} vertices"),
        one => format!("{n} {one}s"),
    }
}

/// An error and its causes in one line; a cause that the line tells already is not told twice.
#[must_use]
pub fn told(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).fold(String::new(), |line, cause| match line.as_str() {
        "" => cause,
        told if told.contains(&cause) => line,
        told => format!("{told}: {cause}"),
    })
}

#[cfg(test)]
mod tests {
    use super::{Brief, counted, told};

    #[derive(Debug, thiserror::Error)]
    #[error("{0}")]
    struct Fault(&'static str, #[source] Option<Box<Fault>>);

    #[test]
    fn a_cause_is_told_once() {
        let over = |text, cause| Fault(text, Some(Box::new(cause)));
        for (error, wanted) in [
            (Fault("no paint", None), "no paint"),
            (
                over("frame 3", over("no paint", Fault("the shop is closed", None))),
                "frame 3: no paint: the shop is closed",
            ),
            (over("write: no paint: a.png", Fault("no paint", None)), "write: no paint: a.png"),
        ] {
            assert_eq!(told(&error), wanted);
        }
    }

    #[test]
    fn one_is_one_and_others_are_many() {
        for (n, one, wanted) in [
            (1, "group", "1 group"),
            (0, "group", "0 groups"),
            (2, "group", "2 groups"),
            (1, "leaf", "1 leaf"),
            (2, "leaf", "2 leaves"),
            (3, "branch", "3 branches"),
            (4, "vertex", "4 vertices"),
        ] {
            assert_eq!(counted(n, one), wanted);
        }
    }

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
