//! A density as a few lines of dots: decades upwards, hertz to the right.

use super::curves::Curve;
use crate::braille::{DOTS, braille};

/// Cells of the field.
const COLUMNS: usize = 64;
const ROWS: usize = 6;
/// So many times the peak's frequency are shown.
const BEYOND_PEAK: f64 = 5.0;
/// What is fainter than so many decades below the strongest is not shown.
const DECADES: f64 = 6.0;

/// The curve under its name, six rows of 64 cells, with its ends.
pub(super) fn draw(title: &str, curve: &Curve<'_>) -> String {
    let density = curve.density;
    let nyquist = (density.per_hz.len() - 1) as f64 * density.step_hz;
    let top_hz = curve.peak.map_or(nyquist, |peak| (BEYOND_PEAK * peak.hz).min(nyquist));
    let across = 2 * COLUMNS;
    let last = density.per_hz.len() - 1;
    let tops: Vec<f64> = (0..across)
        .map(|i| {
            let bin = |i: usize| ((top_hz * i as f64 / across as f64 / density.step_hz) as usize).min(last);
            density.per_hz[bin(i)..=bin(i + 1)].iter().copied().fold(0.0, f64::max)
        })
        .collect();
    let most = tops.iter().copied().fold(0.0, f64::max);
    if most <= 0.0 {
        return format!("{title}: nothing moves");
    }
    let least =
        tops.iter().copied().filter(|v| *v > 0.0).fold(most, f64::min).max(most / 10_f64.powf(DECADES));
    let decades = (most / least).log10().max(1e-9);
    let up = 4 * ROWS - 1;
    let height = |value: f64| {
        let share = ((value / least).max(1.0).log10() / decades).min(1.0);
        up - (share * up as f64).round() as usize
    };
    let mut dots = vec![0_u8; COLUMNS * ROWS];
    let mut before = height(tops[0]);
    for (i, value) in tops.iter().enumerate() {
        let here = height(*value);
        for row in here.min(before + 1)..=here.max(before.saturating_sub(1)) {
            dots[row / 4 * COLUMNS + i / 2] |= DOTS[row % 4][i % 2];
        }
        before = here;
    }
    let mut text = format!("{title}, {least:.1e} to {most:.1e}");
    for row in dots.chunks(COLUMNS) {
        let cells: String = row.iter().map(|bits| if *bits == 0 { ' ' } else { braille(*bits) }).collect();
        text += &format!("\n{}", cells.trim_end());
    }
    text + &format!("\n0{:>width$}", format!("{top_hz:.2} Hz"), width = COLUMNS - 1)
}

#[cfg(test)]
mod tests {
    use honami_workbench::densities::Density;

    use super::*;

    #[test]
    fn a_peak_is_where_it_is() {
        let mut per_hz = vec![1e-3; 201];
        per_hz[50] = 1.0;
        let density =
            Density { step_hz: 0.05, per_hz, n_pieces: 7, freedom: 13.0, noise_hz: 0.1, window_hz: 0.1 };
        let text = draw("all", &Curve { name: "all".to_owned(), density: &density, peak: None });
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 1 + ROWS + 1, "{text}");
        assert_eq!(lines[0], "all, 1.0e-3 to 1.0e0");
        // 2.5 Hz of 10 are a fourth of 64 cells.
        assert_eq!(lines[1].chars().count(), 17, "{text}");
        assert!(lines[6].chars().count() == 64 && lines[7].ends_with("10.00 Hz"), "{text}");
        let still = Density { per_hz: vec![0.0; 201], ..density.clone() };
        let text = draw("all", &Curve { name: "all".to_owned(), density: &still, peak: None });
        assert_eq!(text, "all: nothing moves");
    }
}
