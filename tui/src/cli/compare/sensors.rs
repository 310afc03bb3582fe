//! `compare --sensors`: tracks in space beside what sensors have recorded, as table 2.1 and figure 2.11 of the thesis.

use std::path::{Path, PathBuf};

use honami_workbench::densities::Pieces;
use honami_workbench::export;
use honami_workbench::sensors::{self, Axis, Compared, Deviation, Marker, Wish};
use serde_json::{Value, json};

use crate::cli::args::Compare;
use crate::cli::{Answer, look, report, want};

mod figure;

/// Clocks are not further apart than this where nothing is said, seconds.
const MOST_S: f64 = 30.0;
/// The axes of the sensors.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Brings both together, prints how far they are apart, and writes what was asked for.
pub(super) fn sensors(args: &Compare, path: &Path) -> anyhow::Result<Answer> {
    let wished = &args.beside;
    let [tracks] = &args.clip[..] else {
        anyhow::bail!("--sensors compares one table of tracks in space, came {}", args.clip.len());
    };
    for (out, ending) in [(&args.svg, "svg"), (&wished.csv, "csv")] {
        let is_right = |out: &PathBuf| out.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        want(out.as_ref().is_none_or(is_right), || format!("--{ending} writes .{ending}"))?;
    }
    let wish =
        Wish { offset_s: wished.offset, most_s: MOST_S, height_m: wished.height, pieces: Pieces::default() };
    let wind = wished.wind.as_deref().map_or(Ok(Vec::new()), sensors::wind)?;
    let records = if tracks.extension().is_some_and(|e| e == "honami") {
        let (records, stale) = sensors::of_project(&look(tracks)?)?;
        stale.iter().for_each(|line| report::say(line));
        records
    } else {
        sensors::records(tracks)?
    };
    let found = sensors::compare(&records, &sensors::records(path)?, &wish)?;
    let mut files = Vec::new();
    if let Some(out) = &wished.csv {
        sensors::write(&found, out)?;
        files.push(out.clone());
    }
    if let Some(out) = &args.svg {
        let name = tracks.file_name().unwrap_or_default().to_string_lossy();
        export::text(out, &figure::draw(&format!("{name}: {}", head(&found)), &found, &wind))?;
        files.push(out.clone());
    }
    let mut text = text(&found);
    files.iter().for_each(|file| text += &format!("\n{}", file.display()));
    Ok(Answer { json: answer(&found, &files), text, done: true })
}

/// `4 markers; the sensors' clock is ahead by 0.4137 ± 0.0002 s`.
fn head(found: &Compared) -> String {
    let (way, seconds) =
        if found.offset_s < 0.0 { ("behind", -found.offset_s) } else { ("ahead", found.offset_s) };
    let error =
        found.found.map_or_else(|| ", as given".to_owned(), |offset| format!(" ± {:.4}", offset.error_s));
    let n = found.markers.len();
    let markers = if n == 1 { "marker" } else { "markers" };
    match found.found {
        Some(_) => format!("{n} {markers}; the sensors' clock is {way} by {seconds:.4}{error} s"),
        None => format!("{n} {markers}; the sensors' clock is {way} by {seconds:.4} s{error}"),
    }
}

/// What speaks against the comparison as a whole.
fn doubts(found: &Compared) -> Vec<String> {
    /// Cameras know a scale better than to a fifth.
    const SCALES: std::ops::Range<f64> = 0.8..1.25;
    let mut doubts = Vec::new();
    let is_about = |times: f64| SCALES.contains(&(found.scale / times));
    if is_about(1000.0) {
        doubts.push("are the sensors' places in millimetres? Tables of places are in metres".to_owned());
    } else if is_about(100.0) {
        doubts.push("are the sensors' places in centimetres? Tables of places are in metres".to_owned());
    } else if !is_about(1.0) {
        doubts.push(
            "the sensors and the tracks are not of one size: is the target's, or the unit, another?"
                .to_owned(),
        );
    }
    if found.is_mirrored {
        doubts.push(
            "the sensors fit far better in a mirror: are their axes left-handed, or two of them exchanged?"
                .to_owned(),
        );
    }
    doubts
}

fn text(found: &Compared) -> String {
    let mut text = head(found);
    text += &format!(
        "\naxes turned by {:.2}°; lengths of the sensors are {:.4} times those of the tracks",
        found.axes.rotation.angle().to_degrees(),
        found.scale
    );
    doubts(found).iter().for_each(|doubt| text += &format!("\ndoubtful: {doubt}"));
    let heads = ["RMS (mean ± std) m", "track", "x", "y", "z"].map(str::to_owned).to_vec();
    let row = |name: &str, track: &str, cells: &[Deviation; 3]| {
        let cells = cells.iter().map(|c| format!("{:.4} ({:.4} ± {:.4})", c.rms, c.mean, c.std));
        [name.to_owned(), track.to_owned()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let mut rows = vec![heads];
    rows.extend(found.markers.iter().map(|marker| row(&marker.name, &marker.track, &marker.deviations)));
    rows.push(row("all", "", &found.all));
    if let Some(height) = found.height_m {
        let cells = found.all.iter().map(|c| format!("{:.2} %", 100.0 * c.rms / height));
        rows.push(["of the height".to_owned(), String::new()].into_iter().chain(cells).collect());
    }
    text += &format!("\n{}", report::table(&rows));
    let heads = ["strongest", "axis", "Hz", "coherence", "phase °"].map(str::to_owned).to_vec();
    let mut rows = vec![heads];
    for marker in &found.markers {
        for (axis, name) in marker.axes.iter().flatten().zip(AXES) {
            if let Some(at) = axis.strongest {
                let phase =
                    format!("{:.1} ± {:.1}", at.phase_rad.to_degrees(), at.phase_error_rad.to_degrees());
                rows.push(vec![
                    marker.name.clone(),
                    name.to_owned(),
                    format!("{:.3}", at.hz),
                    format!("{:.3}", at.coherence),
                    phase,
                ]);
            }
        }
    }
    if rows.len() > 1 {
        text += &format!("\n{}\nphase: how far the sensor is behind the track", report::table(&rows));
    }
    for (names, what) in found.alone.iter().zip(["tracks", "sensors"]) {
        if !names.is_empty() {
            text += &format!("\n{what} without a partner: {}", names.len());
        }
    }
    text
}

fn answer(found: &Compared, files: &[PathBuf]) -> Value {
    let cells = |cells: &[Deviation; 3]| -> Vec<Value> {
        cells.iter().map(|c| json!({ "rms_m": c.rms, "mean_m": c.mean, "std_m": c.std })).collect()
    };
    let axis = |axis: &Axis| {
        axis.strongest.map(|at| {
            json!({
                "hz": at.hz,
                "coherence": at.coherence,
                "chance_95": axis.cross.as_ref().map(|cross| cross.chance(0.95)),
                "phase_rad": at.phase_rad,
                "phase_error_rad": at.phase_error_rad,
            })
        })
    };
    let marker = |marker: &Marker| {
        json!({
            "marker": marker.name,
            "track": marker.track,
            "samples": marker.times_s.len(),
            "axes": cells(&marker.deviations),
            "strongest": marker.axes.as_ref().map(|axes| axes.iter().map(axis).collect::<Vec<_>>()),
        })
    };
    let matrix = found.axes.rotation.matrix();
    let turn = [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)]));
    json!({
        "offset_s": found.offset_s,
        "offset_error_s": found.found.map(|offset| offset.error_s),
        "alike": found.found.map(|offset| offset.alike),
        "rotation": turn,
        "translation_m": [found.axes.translation.x, found.axes.translation.y, found.axes.translation.z],
        "scale": found.scale,
        "doubts": doubts(found),
        "height_m": found.height_m,
        "all": cells(&found.all),
        "markers": found.markers.iter().map(marker).collect::<Vec<_>>(),
        "piece_s": found.piece_s,
        "alone": { "tracks": found.alone[0], "sensors": found.alone[1] },
        "files": files,
    })
}
