//! `spectrum`: frequencies of tracks and groups.

use honami_workbench::review;
use honami_workbench::spectra::{self, Line, Peak, Spectra, Subject, Wanted};
use honami_workbench::sways::{self, Sways, Swing};
use serde_json::json;

use super::args::Spectrum;
use super::{Answer, look, report};

/// Tracks that are listed when none was asked for; all of them are in `--json`.
const LISTED: usize = 12;

/// Prints the peaks of everything, of the groups, and of tracks.
pub(super) fn spectrum(args: &Spectrum) -> anyhow::Result<Answer> {
    if let Some(fps) = args.fps {
        return Ok(swings(&sways::of_columns(&args.project, fps, args.above)?));
    }
    if sways::is_sensors(&args.project) {
        return Ok(swings(&sways::of_sensors(&args.project, args.above)?));
    }
    let wanted = Wanted { n_peaks: args.peaks, above_hz: args.above };
    let is_table = args.project.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    let mut spectra = if is_table {
        spectra::of_table(&args.project, wanted)?
    } else {
        let project = look(&args.project)?;
        warn(review::n_doubtful(&project)?);
        spectra::of_project(&project, wanted)?
    };
    if let Some(track) = args.track {
        spectra.lines.retain(|line| matches!(line.subject, Subject::Track(id) if id.0 == track));
        anyhow::ensure!(
            !spectra.lines.is_empty(),
            "track {track} is not there, or is seen in fewer than 8 frames"
        );
    }
    Ok(describe(&spectra))
}

/// Series that are no tracks: what each swings at, and how soon it comes to rest.
fn swings(sways: &Sways) -> Answer {
    let mut rows = vec![["", "Hz", "damping %", "log decrement"].map(str::to_owned).to_vec()];
    let mut row = |name: &str, swing: Option<Swing>| {
        let none = || ["nothing swings", "", ""].map(str::to_owned).to_vec();
        let cells = swing.map_or_else(none, |swing| {
            vec![
                format!("{:.4}", swing.hz),
                format!("{:.2}", 100.0 * swing.ratio),
                format!("{:.4}", swing.log_decrement()),
            ]
        });
        rows.push(std::iter::once(name.to_owned()).chain(cells).collect());
    };
    row("median", sways.median);
    sways.series.iter().for_each(|(name, swing)| row(name, *swing));
    let text = format!("{} samples, {:.2} a second\n{}", sways.n_samples, sways.fps, report::table(&rows));
    let series = sways.series.iter().map(|(name, swing)| json!({ "name": name, "swing": swing.map(swung) }));
    let json = json!({
        "fps": sways.fps,
        "samples": sways.n_samples,
        "median": sways.median.map(swung),
        "series": series.collect::<Vec<_>>(),
    });
    Answer { json, text, done: true }
}

fn swung(swing: Swing) -> serde_json::Value {
    json!({ "hz": swing.hz, "damping": swing.ratio, "log_decrement": swing.log_decrement() })
}

/// What was never looked at may be no movement of the plant: says so.
fn warn(n_doubtful: usize) {
    let who = match n_doubtful {
        0 => return,
        1 => "1 track has".to_owned(),
        n => format!("{n} tracks have"),
    };
    report::say(&format!("{who} doubtful frames that nobody has reviewed: honami review lists them"));
}

fn describe(spectra: &Spectra) -> Answer {
    let rate = spectra.fps.map_or("irregular frames".to_owned(), |fps| format!("{fps:.2} fps"));
    let mut text = format!(
        "{rate}: nothing above {:.2} Hz can be seen, nothing closer than {:.3} Hz told apart",
        spectra.nyquist_hz, spectra.resolution_hz
    );
    let mut rows = vec![["", "tracks", "damping %", "peaks: Hz (px)"].map(str::to_owned).to_vec()];
    let is_track = |line: &&Line| matches!(line.subject, Subject::Track(_));
    let n_tracks = spectra.lines.iter().filter(is_track).count();
    let shown = spectra.lines.len() - n_tracks.saturating_sub(LISTED);
    for line in &spectra.lines[..shown] {
        let peaks: Vec<String> = line.peaks.iter().map(peak).collect();
        let peaks = if peaks.is_empty() { "nothing stands out".to_owned() } else { peaks.join("   ") };
        let damping = line.swing.map_or_else(String::new, |swing| format!("{:.1}", 100.0 * swing.ratio));
        rows.push(vec![name(line.subject), line.n_tracks.to_string(), damping, peaks]);
    }
    text += &format!("\n{}", report::table(&rows));
    if n_tracks > LISTED {
        text += &format!("\n… and {} more tracks: --track ID, or --json", n_tracks - LISTED);
    }
    if let Some(warning) = alias(spectra) {
        text += &format!("\n{warning}");
    }
    let lines: Vec<_> = spectra.lines.iter().map(entry).collect();
    let json = json!({
        "fps": spectra.fps,
        "nyquist_hz": spectra.nyquist_hz,
        "resolution_hz": spectra.resolution_hz,
        "lines": lines,
        "too_brief": spectra.n_brief,
    });
    Answer { json, text, done: true }
}

fn name(subject: Subject) -> String {
    match subject {
        Subject::All => "all".to_owned(),
        Subject::Group(group) => format!("group {}", group + 1),
        Subject::Track(track) => format!("track {track}"),
    }
}

fn peak(peak: &Peak) -> String {
    let mark = if peak.near_nyquist { "?" } else { "" };
    format!("{:.3}{mark} ({:.2})", peak.hz, peak.amplitude_px)
}

/// Whether the strongest peak may be the alias of a faster sway.
fn alias(spectra: &Spectra) -> Option<String> {
    let strongest = spectra.lines.first()?.peaks.first()?;
    let aliases: Vec<String> = strongest.aliases_hz.iter().map(|hz| format!("{hz:.2}")).collect();
    strongest.near_nyquist.then(|| {
        let hz = strongest.hz;
        format!(
            "{hz:.2} Hz? may be an alias: at this frame rate {} Hz look the same; film faster to know",
            aliases.join(", ")
        )
    })
}

fn entry(line: &Line) -> serde_json::Value {
    let peaks: Vec<_> = line
        .peaks
        .iter()
        .map(|p| {
            json!({
                "hz": p.hz,
                "amplitude_px": p.amplitude_px,
                "over_floor": p.over_floor,
                "aliases_hz": p.aliases_hz,
                "may_be_alias": p.near_nyquist,
            })
        })
        .collect();
    let swing = line.swing.map(swung);
    json!({ "subject": name(line.subject), "tracks": line.n_tracks, "peaks": peaks, "swing": swing })
}
