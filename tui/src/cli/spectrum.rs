//! `spectrum`: frequencies of tracks and groups.

use honami_workbench::review;
use honami_workbench::spectra::{self, Line, Peak, Spectra, Subject, Wanted};
use honami_workbench::sways::{self, Kind, Manner, Sways, Swing, Told, Within};
use serde_json::json;

use super::args::Spectrum;
use super::{Answer, look, report, want};

/// Tracks that are listed when none was asked for; all of them are in `--json`.
const LISTED: usize = 12;
/// Peaks that are named for each.
const PEAKS: usize = 3;
/// What is steady has no damping within so many standard errors.
const SURE: f64 = 3.0;

/// Prints the peaks of everything, of the groups, and of tracks; of other series how they swing.
pub(super) fn spectrum(args: &Spectrum) -> anyhow::Result<Answer> {
    let within = Within { above_hz: args.above, from_s: args.from, to_s: args.to };
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
            Kind::Sensors => sways::of_sensors(&args.project, within)?,
            _ => sways::of_columns(&args.project, args.fps, within)?,
        };
        return Ok(swings(&sways, args.above));
    }
    let wanted = Wanted { n_peaks: args.peaks.unwrap_or(PEAKS), within };
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
    Ok(describe(&spectra))
}

/// Series that are no tracks: what each swings at, and how soon it comes to rest.
fn swings(sways: &Sways, above_hz: f64) -> Answer {
    let at_s = |sample: usize| sways.start_s + sample as f64 / sways.fps;
    let heads = ["", "Hz", "damping %", "log decrement", "swings", "from s", ""];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    let cells = |name: &str, swing: &Swing| {
        let Told { value, error } = swing.hz;
        let damping = damped(swing, swing.ratio, 100.0, 2);
        let decrement = damped(swing, swing.log_decrement(), 1.0, 3);
        let from = format!("{:.2}", at_s(swing.first));
        let swings = format!("{:.1}", swing.n_cycles);
        let hz = format!("{value:.4}±{error:.4}");
        [name.to_owned(), hz, damping, decrement, swings, from, manner(swing.manner).to_owned()].to_vec()
    };
    let of_many = sways.median.filter(|_| sways.series.len() > 1);
    rows.extend(of_many.iter().map(|swing| cells("median", swing)));
    let mut none = Vec::new();
    for (name, swing) in &sways.series {
        match swing {
            Ok(swing) => rows.push(cells(name, swing)),
            Err(why) => none.push(format!("{name}: {why}")),
        }
    }
    let n = sways.n_samples;
    let mut text = format!(
        "{n} samples, {:.2} a second, {:.2} to {:.2} s; looked for above {:.3} Hz",
        sways.fps,
        sways.start_s,
        at_s(n - 1),
        sways.lowest_hz
    );
    if sways.median.is_some() {
        text += &format!("\n{}", report::table(&rows));
        text += "\nHz: natural, without damping; ±: standard errors; swings: those above the noise";
    }
    none.iter().for_each(|why| text += &format!("\n{why}"));
    let is_calm = sways.median.is_some_and(|swing| swing.manner != Manner::Driven);
    if above_hz == 0.0 && !is_calm {
        text += "\nGusts may hide a swing that is faster: --above HZ leaves out what is slower.";
    }
    let series = sways.series.iter().map(|(name, swing)| {
        let told = swing.as_ref().ok().map(|swing| swung(swing, sways.start_s, sways.fps));
        json!({ "name": name, "swing": told, "why_none": swing.as_ref().err().map(ToString::to_string) })
    });
    let json = json!({
        "fps": sways.fps,
        "samples": n,
        "from_s": sways.start_s,
        "to_s": at_s(n - 1),
        "lowest_hz": sways.lowest_hz,
        "median": sways.median.map(|swing| swung(&swing, sways.start_s, sways.fps)),
        "series": series.collect::<Vec<_>>(),
    });
    Answer { json, text, done: true }
}

/// A damping and its standard error; of what is steady how near to none it is.
fn damped(swing: &Swing, told: Told, scale: f64, digits: usize) -> String {
    let (value, error) = (scale * told.value, scale * told.error);
    match swing.manner {
        Manner::Steady => format!("0 within {:.digits$}", SURE * error),
        _ => format!("{value:.digits$}±{error:.digits$}"),
    }
}

fn manner(manner: Manner) -> &'static str {
    match manner {
        Manner::LetGo => "let go",
        Manner::Steady => "steady",
        Manner::Growing => "growing",
        Manner::Driven => "driven",
    }
}

fn swung(swing: &Swing, start_s: f64, fps: f64) -> serde_json::Value {
    let decrement = swing.log_decrement();
    json!({
        "manner": manner(swing.manner),
        "hz": swing.hz.value,
        "hz_error": swing.hz.error,
        "damped_hz": swing.damped_hz(),
        "damping": swing.ratio.value,
        "damping_error": swing.ratio.error,
        "log_decrement": decrement.value,
        "log_decrement_error": decrement.error,
        "cycles": swing.n_cycles,
        "from_s": start_s + swing.first as f64 / fps,
    })
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
    if let Some(warning) = alias(spectra) {
        text += &format!("\n{warning}");
    }
    let fps = spectra.fps.unwrap_or(1.0);
    let lines: Vec<_> = spectra.lines.iter().map(|line| entry(line, spectra.start_s, fps)).collect();
    let json = json!({
        "fps": spectra.fps,
        "nyquist_hz": spectra.nyquist_hz,
        "resolution_hz": spectra.resolution_hz,
        "lines": lines,
        "too_brief": spectra.brief.len(),
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
    })
}
