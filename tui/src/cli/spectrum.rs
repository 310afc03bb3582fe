//! `spectrum`: frequencies of tracks and groups.

mod curves;
mod series;
mod sketch;
mod svg;

use honami_workbench::densities::Pieces;
use honami_workbench::review;
use honami_workbench::spectra::{self, Line, Peak, Spectra, Subject, Wanted};
use honami_workbench::sways::{self, Kind, Within};
use serde_json::json;

use super::args::spectrum::Spectrum;
use super::{Answer, look, report, want};
use curves::{Curve, Curves, half_power, written};
use series::{damped, swung};

/// Tracks that are listed when none was asked for; all of them are in `--json`.
const LISTED: usize = 12;
/// Peaks that are named for each.
const PEAKS: usize = 3;

/// Prints the peaks of everything, of the groups, and of tracks; of other series how they swing.
pub(super) fn spectrum(args: &Spectrum) -> anyhow::Result<Answer> {
    curves::check(args)?;
    let within = Within { above_hz: args.above, from_s: args.from, to_s: args.to };
    let pieces = Pieces { window: args.window, piece_s: args.piece };
    let kind = sways::kind(&args.project);
    want(kind != Kind::Untimed || args.fps.is_some(), || {
        let path = args.project.display();
        format!("{path}: numbers without times: --fps F says how many rows there are a second")
    })?;
    if kind == Kind::Sensors || kind == Kind::Timed || args.fps.is_some() {
        let only_tracks = |is_there: bool, option: &str| {
            want(!is_there, || format!("{option} is for tracks, and {} has none", args.project.display()))
        };
        only_tracks(args.track.is_some(), "--track")?;
        only_tracks(args.peaks.is_some(), "--peaks")?;
        want(kind != Kind::Sensors || args.fps.is_none(), || {
            "a table of sensors has its times: leave --fps out".to_owned()
        })?;
        let sways = match kind {
            Kind::Sensors => sways::of_sensors(&args.project, within, pieces)?,
            _ => sways::of_columns(&args.project, args.fps, within, pieces)?,
        };
        return series::swings(&sways, args);
    }
    let wanted = Wanted { n_peaks: args.peaks.unwrap_or(PEAKS), within, pieces };
    let is_table = args.project.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
    let mut spectra = if is_table {
        spectra::of_table(&args.project, wanted)?
    } else {
        let project = look(&args.project)?;
        warn(review::n_doubtful(&project)?);
        spectra::of_project(&project, wanted)?
    };
    if let Some(track) = args.track {
        let is_brief = spectra.brief.iter().any(|id| id.0 == track);
        anyhow::ensure!(!is_brief, "track {track} is seen in fewer than 8 frames: too few for a spectrum");
        spectra.lines.retain(|line| matches!(line.subject, Subject::Track(id) if id.0 == track));
        want(!spectra.lines.is_empty(), || format!("track {track} is not there"))?;
    }
    describe(&spectra, args)
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

fn describe(spectra: &Spectra, args: &Spectrum) -> anyhow::Result<Answer> {
    let rate = spectra.fps.map_or("irregular frames".to_owned(), |fps| format!("{fps:.2} fps"));
    let mut text = format!(
        "{rate}: nothing above {:.2} Hz can be seen, nothing closer than {:.3} Hz told apart",
        spectra.nyquist_hz, spectra.resolution_hz
    );
    let mut rows =
        vec![["", "tracks", "coherence", "damping %", "peaks: Hz (px)"].map(str::to_owned).to_vec()];
    let is_track = |line: &&Line| matches!(line.subject, Subject::Track(_));
    let n_tracks = spectra.lines.iter().filter(is_track).count();
    let shown = spectra.lines.len() - n_tracks.saturating_sub(LISTED);
    for line in &spectra.lines[..shown] {
        let peaks: Vec<String> = line.peaks.iter().map(peak).collect();
        let peaks = if peaks.is_empty() { "nothing stands out".to_owned() } else { peaks.join("   ") };
        let damping = line.swing.map_or_else(String::new, |swing| damped(&swing, swing.ratio, 100.0, 2));
        let coherence = line.coherence.map_or_else(String::new, |share| format!("{share:.2}"));
        rows.push(vec![name(line.subject), line.n_tracks.to_string(), coherence, damping, peaks]);
    }
    text += &format!("\n{}", report::table(&rows));
    if n_tracks > LISTED {
        text += &format!("\n… and {} more tracks: --track ID, or --json", n_tracks - LISTED);
    }
    let strongest = spectra.lines.first().and_then(|line| line.peaks.first());
    if let Some(peak) = strongest.filter(|peak| peak.near_nyquist) {
        text += &format!("\n{}", aliased(peak.hz, &peak.aliases_hz));
    }
    let curves = curves_of(spectra, args);
    let files = written(curves.as_ref(), args)?;
    text += &curves.as_ref().map_or_else(String::new, Curves::text);
    files.iter().for_each(|path| text += &format!("\n{}", path.display()));
    let fps = spectra.fps.unwrap_or(1.0);
    let lines: Vec<_> = spectra.lines.iter().map(|line| entry(line, spectra.start_s, fps)).collect();
    let json = json!({
        "fps": spectra.fps,
        "nyquist_hz": spectra.nyquist_hz,
        "resolution_hz": spectra.resolution_hz,
        "lines": lines,
        "too_brief": spectra.brief.len(),
        "welch": curves.as_ref().map(Curves::json),
        "files": files,
    });
    Ok(Answer { json, text, done: true })
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

/// That a peak may be the alias of something faster.
fn aliased(hz: f64, aliases_hz: &[f64]) -> String {
    let aliases: Vec<String> = aliases_hz.iter().map(|hz| format!("{hz:.2}")).collect();
    format!(
        "{hz:.2} Hz? may be an alias: at this rate {} Hz look the same; film or sample faster to know",
        aliases.join(", ")
    )
}

/// The densities of all tracks together and of groups, and those of tracks as well; of one that was asked for its own.
fn curves_of<'a>(spectra: &'a Spectra, args: &Spectrum) -> Option<Curves<'a>> {
    let curve = |line: &'a Line| {
        Some(Curve { name: name(line.subject), density: line.density.as_ref()?, peak: line.half_power() })
    };
    let is_track = |line: &&Line| args.track.is_none() && matches!(line.subject, Subject::Track(_));
    let (more, told): (Vec<&Line>, Vec<&Line>) = spectra.lines.iter().partition(is_track);
    let [told, more] = [told, more].map(|lines| lines.into_iter().filter_map(curve).collect());
    let unit = if spectra.scale.is_some() { "m" } else { "px" };
    Some(Curves { unit, window: args.window, piece_s: spectra.piece_s?, told, more })
}

fn entry(line: &Line, start_s: f64, fps: f64) -> serde_json::Value {
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
    let swing = line.swing.map(|swing| swung(&swing, start_s, fps));
    json!({
        "subject": name(line.subject),
        "tracks": line.n_tracks,
        "peaks": peaks,
        "swing": swing,
        "coherence": line.coherence,
        "half_power": line.half_power().as_ref().map(half_power),
    })
}
