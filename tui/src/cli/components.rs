//! `components`: what moves together, as a table, as maps and as numbers.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use honami_model::brief::counted;
use honami_workbench::components::{self, Component, Components};
use honami_workbench::export;
use serde_json::json;

use super::args;
use super::report::Bar;
use super::{Answer, look, report, want};

mod svg;

/// Eight levels, and how many of them make a spectrum.
const LEVELS: [&str; 8] = ["▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"];
const BLOCKS: usize = 16;

/// Takes tracks apart, prints the components and writes the files that were asked for.
pub(super) fn components(args: &args::Components) -> anyhow::Result<Answer> {
    for out in &args.out {
        want(is_a(out, "svg") || is_a(out, "csv"), || {
            format!("components are written as .svg and .csv, not as {}", out.display())
        })?;
    }
    let most = args.most as usize;
    let bar = Bar::new();
    let found = if is_a(&args.project, "csv") {
        components::of_table(&args.project, most, &bar)?
    } else {
        components::of_project(&look(&args.project)?, most, &bar)?
    };
    drop(bar);
    let mut written = Vec::new();
    for out in &args.out {
        if is_a(out, "svg") {
            let name = args.project.file_name().unwrap_or_default().to_string_lossy();
            export::text(out, &svg::draw(&format!("{name}: {}", head(&found)), &found))?;
        } else {
            export::text(out, &topos_table(&found))?;
            let beside = out.with_extension("chronos.csv");
            export::text(&beside, &chronos_table(&found))?;
            written.push(beside);
        }
        written.push(out.clone());
    }
    Ok(Answer { json: answer(&found, &written), text: text(&found), done: true })
}

fn is_a(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}

/// `500 tracks, 300 frames: 4 components above the noise (38.2 px), 296 below`.
fn head(found: &Components) -> String {
    format!(
        "{}, {}: {} above the noise ({:.1} px), {} below",
        counted(found.places.len(), "track"),
        counted(found.n_frames, "frame"),
        counted(found.n_above, "component"),
        found.edge_px,
        found.n_below
    )
}

fn text(found: &Components) -> String {
    let mut text = head(found);
    if found.n_filled > 0 {
        text += &format!("\n{} filled from the other tracks", counted(found.n_filled, "position"));
    }
    if found.list.is_empty() {
        return text + "\nnothing stands out of the noise";
    }
    let heads = ["", "share %", "px", "Hz", "width Hz", "line", "straight", "half in", "spectrum"];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(found.list.iter().zip(1..).map(|(component, number)| row(component, number)));
    text += &format!("\n{}", report::table(&rows));
    let nyquist = found.list[0].spectrum.nyquist_hz;
    let resolution = found.list[0].spectrum.resolution_hz;
    text +=
        &format!("\nspectrum: 0 to {nyquist:.2} Hz; no peak is narrower than {:.3} Hz", 1.44 * resolution);
    if found.n_above > found.list.len() {
        text += &format!("\n… and {} more above the noise: --most N", found.n_above - found.list.len());
    }
    text
}

fn row(component: &Component, number: usize) -> Vec<String> {
    let [hz, width] = match (&component.peak, component.width_hz) {
        (Some(peak), Some(width)) => {
            [format!("{:.3}{}", peak.hz, if peak.near_nyquist { "?" } else { "" }), format!("{width:.3}")]
        }
        _ => ["none".to_owned(), String::new()],
    };
    vec![
        number.to_string(),
        format!("{:.1}", 100.0 * component.share),
        format!("{:.1}", component.singular_px),
        hz,
        width,
        format!("{:.0}°", degrees(component)),
        format!("{:.2}", component.axis.straight),
        component.n_half.to_string(),
        blocks(component),
    ]
}

/// The angle of a component's line as it is shown: 180 degrees are 0.
fn degrees(component: &Component) -> f64 {
    let degrees = component.axis.angle_rad.to_degrees();
    if degrees.round() >= 180.0 { 0.0 } else { degrees }
}

/// Amplitudes from 0 Hz to half the frame rate: the largest of each part of the band.
fn blocks(component: &Component) -> String {
    let band = band(component);
    let parts = band.chunks(band.len().div_ceil(BLOCKS).max(1));
    let tops: Vec<f64> = parts.map(|part| part.iter().copied().fold(0.0, f64::max).sqrt()).collect();
    let most = tops.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    tops.iter().map(|top| LEVELS[((top / most * 8.0) as usize).min(7)]).collect()
}

/// Power in the band that can be seen.
fn band(component: &Component) -> &[f64] {
    let spectrum = &component.spectrum;
    let end = (spectrum.nyquist_hz / spectrum.step_hz).round() as usize + 1;
    &spectrum.power_px2[..end.min(spectrum.power_px2.len())]
}

fn topos_table(found: &Components) -> String {
    let mut table = "component,track,x_px,y_px,dx_px,dy_px\n".to_owned();
    for (component, number) in found.list.iter().zip(1..) {
        for ((track, [x, y]), [dx, dy]) in found.places.iter().zip(&component.topos_px) {
            // Writing to a string cannot fail.
            writeln!(table, "{number},{track},{x},{y},{dx},{dy}").unwrap_or_default();
        }
    }
    table
}

fn chronos_table(found: &Components) -> String {
    let mut table = "component,frame,time_s,chronos\n".to_owned();
    for (component, number) in found.list.iter().zip(1..) {
        for (frame, (time_s, value)) in
            (found.first_frame..).zip(found.times_s.iter().zip(&component.chronos))
        {
            if let Some(value) = value {
                writeln!(table, "{number},{frame},{time_s},{value}").unwrap_or_default();
            }
        }
    }
    table
}

fn answer(found: &Components, written: &[PathBuf]) -> serde_json::Value {
    let entry = |(component, number): (&Component, usize)| {
        json!({
            "component": number,
            "share": component.share,
            "singular_px": component.singular_px,
            "hz": component.peak.as_ref().map(|peak| peak.hz),
            "width_hz": component.width_hz,
            "aliases_hz": component.peak.as_ref().map(|peak| &peak.aliases_hz),
            "may_be_alias": component.peak.as_ref().map(|peak| peak.near_nyquist),
            "direction_deg": degrees(component),
            "straight": component.axis.straight,
            "half_in_tracks": component.n_half,
            "topos_px": component.topos_px,
            "chronos": component.chronos,
            "spectrum": band(component),
        })
    };
    let tracks = found.places.iter().map(|(id, [x, y])| json!({ "track": id.0, "x_px": x, "y_px": y }));
    let first = found.list.first().map(|component| &component.spectrum);
    json!({
        "frames": found.n_frames,
        "filled": found.n_filled,
        "edge_px": found.edge_px,
        "above": found.n_above,
        "below": found.n_below,
        "nyquist_hz": first.map(|spectrum| spectrum.nyquist_hz),
        "resolution_hz": first.map(|spectrum| spectrum.resolution_hz),
        "spectrum_step_hz": first.map(|spectrum| spectrum.step_hz),
        "first_frame": found.first_frame,
        "times_s": found.times_s,
        "tracks": tracks.collect::<Vec<_>>(),
        "components": found.list.iter().zip(1..).map(entry).collect::<Vec<_>>(),
        "files": written,
    })
}
