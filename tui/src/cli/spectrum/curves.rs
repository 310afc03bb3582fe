//! Densities: what is told of their peaks, their table, and a small curve where the answer goes to a terminal.

use std::fmt::Write as _;
use std::io::IsTerminal as _;
use std::path::PathBuf;

use honami_workbench::densities::{Density, HalfPower, Window};
use honami_workbench::export;
use serde_json::json;

use super::{sketch, svg};
use crate::cli::args::spectrum::Spectrum;
use crate::cli::{report, want};

/// The band that is told has the truth so often.
const SURE: f64 = 0.95;
/// Rows of the table of widths.
const LISTED: usize = 12;

/// The density of something.
pub(super) struct Curve<'a> {
    pub(super) name: String,
    pub(super) density: &'a Density,
    /// Where it is highest about the swing, if it has a peak there.
    pub(super) peak: Option<HalfPower>,
}

/// Densities of a record.
pub(super) struct Curves<'a> {
    /// What the series are measured in.
    pub(super) unit: &'a str,
    pub(super) window: Window,
    pub(super) piece_s: f64,
    /// What is told and drawn.
    pub(super) told: Vec<Curve<'a>>,
    /// What is written as well.
    pub(super) more: Vec<Curve<'a>>,
}

/// Checks what is to be written before anything is worked out.
pub(super) fn check(args: &Spectrum) -> anyhow::Result<()> {
    for (path, ending) in [(&args.svg, "svg"), (&args.csv, "csv")] {
        let Some(path) = path else { continue };
        want(path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)), || {
            format!("--{ending} writes .{ending}, not {}", path.display())
        })?;
    }
    Ok(())
}

/// Writes the files that were asked for.
pub(super) fn written(curves: Option<&Curves<'_>>, args: &Spectrum) -> anyhow::Result<Vec<PathBuf>> {
    match curves {
        Some(curves) => curves.write(args),
        None if args.csv.is_some() || args.svg.is_some() => anyhow::bail!(
            "there is no density to write: it takes evenly timed samples, and a series seen for a whole piece (--piece)"
        ),
        None => Ok(Vec::new()),
    }
}

impl Curves<'_> {
    /// Writes what was asked for; the files.
    pub(super) fn write(&self, args: &Spectrum) -> anyhow::Result<Vec<PathBuf>> {
        let mut written = Vec::new();
        if let Some(path) = &args.csv {
            export::text(path, &self.table())?;
            written.push(path.clone());
        }
        if let Some(path) = &args.svg {
            let name = args.project.file_name().unwrap_or_default().to_string_lossy();
            export::text(path, &svg::draw(&format!("{name}: {}", self.head()), self))?;
            written.push(path.clone());
        }
        Ok(written)
    }

    /// `Welch's densities, pieces of 10.00 s (hann)`.
    fn head(&self) -> String {
        format!("Welch's densities, pieces of {:.2} s ({})", self.piece_s, self.window.word())
    }

    /// Lines for people.
    pub(super) fn text(&self) -> String {
        let Some(first) = self.told.first() else { return String::new() };
        let mut text = String::new();
        let [low, high] = first.density.band(SURE);
        text += &format!(
            "\n{}: {} of them, {:.0} degrees of\nfreedom, {:.0} % within {low:.2} to {high:.2} times; noise bandwidth {:.3} Hz",
            self.head(),
            first.density.n_pieces,
            first.density.freedom,
            100.0 * SURE,
            first.density.noise_hz
        );
        let heads = ["half-power", "Hz", "width Hz", "of window", "damping %", "of window", "log decrement"];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        rows.extend(self.told.iter().filter_map(|curve| Some(row(&curve.name, &curve.peak?))).take(LISTED));
        if rows.len() > 1 {
            text += &format!("\n{}\nToo broad by about what the window has", report::table(&rows));
        }
        if std::io::stdout().is_terminal() {
            let unit = self.density_unit();
            text += &format!("\n{}", sketch::draw(&format!("{}, {unit}", first.name), first));
        }
        text
    }

    pub(super) fn density_unit(&self) -> String {
        format!("{}²/Hz", self.unit)
    }

    fn table(&self) -> String {
        let mut table = "series,unit,hz,density,low,high\n".to_owned();
        let unit = self.density_unit();
        for Curve { name, density, .. } in self.told.iter().chain(&self.more) {
            let name = if name.contains([',', '"']) {
                format!("\"{}\"", name.replace('"', "\"\""))
            } else {
                name.clone()
            };
            for (k, value) in density.per_hz.iter().enumerate() {
                let [low, high] = density.band_at(k, SURE);
                let hz = k as f64 * density.step_hz;
                // Writing to a string cannot fail.
                writeln!(table, "{name},{unit},{hz:.6},{value:e},{:e},{:e}", low * value, high * value)
                    .unwrap_or_default();
            }
        }
        table
    }

    pub(super) fn json(&self) -> serde_json::Value {
        let first = self.told.first().map(|curve| curve.density);
        json!({
            "window": self.window.word(),
            "piece_s": self.piece_s,
            "unit": self.density_unit(),
            "step_hz": first.map(|density| density.step_hz),
            "pieces": first.map(|density| density.n_pieces),
            "degrees_of_freedom": first.map(|density| density.freedom),
            "noise_bandwidth_hz": first.map(|density| density.noise_hz),
            "band_95": first.map(|density| density.band(SURE)),
        })
    }
}

/// The band in which the truth is in 95 of 100 cases, in shares of a value.
pub(super) fn band(density: &Density) -> [f64; 2] {
    density.band(SURE)
}

fn row(name: &str, peak: &HalfPower) -> Vec<String> {
    let decrement = peak.log_decrement().map_or_else(String::new, |decrement| format!("{decrement:.3}"));
    vec![
        name.to_owned(),
        format!("{:.3}", peak.hz),
        format!("{:.3}", peak.width_hz),
        format!("{:.3}", peak.window_hz),
        format!("{:.2}", 100.0 * peak.damping()),
        format!("{:.2}", 100.0 * peak.window_damping()),
        decrement,
    ]
}

/// A peak by its width, for machines.
pub(super) fn half_power(peak: &HalfPower) -> serde_json::Value {
    json!({
        "hz": peak.hz,
        "width_hz": peak.width_hz,
        "window_hz": peak.window_hz,
        "damping": peak.damping(),
        "window_damping": peak.window_damping(),
        "log_decrement": peak.log_decrement(),
    })
}
