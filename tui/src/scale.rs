//! Scale bars in words: lengths as they are typed, and what a pixel is.

use std::str::FromStr;

use honami_workbench::calibrate::Unit;
use honami_workbench::scale::ScaleBar;

/// A length, `25mm` or `25`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Length {
    /// How many of the unit.
    pub(crate) value: f64,
    /// The unit; none was typed where it is absent.
    pub(crate) unit: Option<Unit>,
}

impl Length {
    /// The same in metres.
    ///
    /// # Errors
    /// A line, where no unit was typed.
    pub(crate) fn metres(self) -> Result<f64, String> {
        let unit = self.unit.ok_or_else(|| format!("wanted a unit (mm, cm, m) after {}", self.value))?;
        // Not times 0.01, which is no number of binary digits: 35cm are 0.35 m.
        Ok(self.value / unit.metres().recip())
    }
}

impl FromStr for Length {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let number = text.trim_end_matches(char::is_alphabetic);
        let unit = &text[number.len()..];
        let parse = || {
            let value: f64 = number.trim().replace(',', ".").parse().ok()?;
            let unit = if unit.is_empty() { None } else { Some(unit.parse().ok()?) };
            Some(Self { value, unit })
        };
        parse()
            .filter(|length| length.value.is_finite() && length.value > 0.0)
            .ok_or_else(|| format!("wanted a length above 0 such as 25mm or 0.5m, got {text}"))
    }
}

/// What a pixel is: `2.0000 mm/px`, to four digits or more.
pub(crate) fn per_px(bar: &ScaleBar) -> String {
    let mm = 1000.0 * bar.m_per_px();
    let digits = (3.0 - mm.log10().floor()).clamp(4.0, 12.0) as usize;
    format!("{mm:.digits$} mm/px")
}

/// The same with its standard error: `2.0000 mm/px ± 0.28 %`.
pub(crate) fn per_px_and_error(bar: &ScaleBar) -> String {
    format!("{} ± {:.2} %", per_px(bar), 100.0 * bar.relative_error())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_typed_with_their_units() {
        for (text, expect) in [
            ("0.5m", Ok(0.5)),
            ("0.5 m", Ok(0.5)),
            ("35cm", Ok(0.35)),
            ("25mm", Ok(0.025)),
            ("0,5m", Ok(0.5)),
            ("1e2mm", Ok(0.1)),
            ("25", Err("wanted a unit (mm, cm, m) after 25")),
            ("0m", Err("wanted a length above 0 such as 25mm or 0.5m, got 0m")),
            ("-2cm", Err("wanted a length above 0 such as 25mm or 0.5m, got -2cm")),
            ("2in", Err("wanted a length above 0 such as 25mm or 0.5m, got 2in")),
            ("", Err("wanted a length above 0 such as 25mm or 0.5m, got ")),
        ] {
            let metres = text.parse().and_then(Length::metres);
            assert_eq!(metres, expect.map_err(str::to_owned), "{text}");
        }
    }

    #[test]
    fn a_pixel_has_four_digits_or_more() {
        for (length_m, expect) in [
            (0.5, "2.0000 mm/px ± 0.28 %"),
            (0.12345e-4, "0.00004938 mm/px ± 0.28 %"),
            (500.0, "2000.0000 mm/px ± 0.28 %"),
        ] {
            let ends = [[10.0, 20.0], [210.0, 170.0]];
            let bar = ScaleBar { frame: 0, ends, length_m, length_error_m: 0.0, end_error_px: 0.5 };
            assert_eq!(per_px_and_error(&bar), expect);
        }
    }
}
