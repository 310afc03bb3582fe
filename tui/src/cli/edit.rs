//! `edit`: corrections from a script, one a line, each answered once it is in the project file.

use std::io::{BufRead as _, Write as _};
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use honami_model::edit::Transaction;
use honami_model::history::Entry;
use honami_model::track::{TrackId, TrackSet};
use honami_workbench::store::Project;
use serde_json::json;

use super::args::{Common, EDITS};
use super::session;

/// Reads edits from standard input to its end, and does each before it reads the next.
pub(super) fn edit(path: &Path, common: &Common) -> anyhow::Result<()> {
    let mut project = session(path, common)?.project;
    for (number, line) in (1..).zip(std::io::stdin().lock().lines()) {
        let line = line.context("cannot read the edits")?;
        let edit = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> = edit.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let done = step(&mut project, &words).with_context(|| format!("line {number}, {}", edit.trim()))?;
        answer(&done, &project, common.json)?;
    }
    Ok(())
}

/// An edit that is in the project file.
struct Done {
    /// `edit`, `undo` or `redo`.
    what: &'static str,
    entry: Entry,
}

fn step(project: &mut Project, words: &[&str]) -> anyhow::Result<Done> {
    let (what, entry) = match words {
        ["undo"] => ("undo", project.undo()?.context("there is nothing to undo")?),
        ["redo"] => ("redo", project.redo()?.context("there is nothing to redo")?),
        _ => {
            let transaction = transaction(project, words)?;
            let id = project.commit(transaction)?;
            ("edit", project.history().get(id).cloned().context("the edit is not in the history")?)
        }
    };
    Ok(Done { what, entry })
}

fn transaction(project: &mut Project, words: &[&str]) -> anyhow::Result<Transaction> {
    Ok(match *words {
        ["add", frame, x, y] => {
            let (frame, [x, y]) = place(project, frame, x, y)?;
            let track = TrackId(project.reserve_tracks(1)?.start);
            Transaction::add_track(track, frame, x, y)
        }
        ["key", track, frame, x, y] => {
            let (frame, to) = place(project, frame, x, y)?;
            let track = TrackId(whole("track", track)?);
            let from = project.shown(track)?.and_then(|span| span.get(frame).map(|at| [at.x, at.y]));
            Transaction::set_key(track, frame, to, from)
        }
        ["clear", track, frame] => {
            Transaction::clear_key(TrackId(whole("track", track)?), whole("frame", frame)?)
        }
        ["delete", ref tracks @ ..] if !tracks.is_empty() => Transaction::delete_tracks(set(tracks)?),
        ["restore", ref tracks @ ..] if !tracks.is_empty() => Transaction::restore_tracks(set(tracks)?),
        ["cut", k] => {
            let k = whole("number of groups", k)?;
            let n_tracks = project.grouping()?.map_or(u32::MAX as usize, |grouping| grouping.group_of.len());
            ensure!(k as usize <= n_tracks, "{n_tracks} tracks make 1 to {n_tracks} groups, not {k}");
            Transaction::set_cut(k)
        }
        _ => bail!("this is no edit\n{EDITS}"),
    })
}

/// A position in the clip: elsewhere no tracker could go on from it.
fn place(project: &Project, frame: &str, x: &str, y: &str) -> anyhow::Result<(u32, [f32; 2])> {
    let clip = &project.clip().clip;
    let (width, height, n_frames) = (clip.width, clip.height, clip.n_frames());
    let frame = whole("frame", frame)?;
    let number = |word: &str| {
        word.parse::<f32>().ok().with_context(|| format!("wanted a position in pixels, got {word}"))
    };
    let at = [number(x)?, number(y)?];
    let inside = |v: f32, size: u32| (-0.5..size as f32 - 0.5).contains(&v);
    ensure!(
        inside(at[0], width) && inside(at[1], height) && frame < n_frames,
        "({x}, {y}) in frame {frame} is not in the clip of {width}x{height} pixels and {n_frames} frames"
    );
    Ok((frame, at))
}

fn whole(what: &str, word: &str) -> anyhow::Result<u32> {
    word.parse().ok().with_context(|| format!("wanted the {what} as a whole number, got {word}"))
}

fn set(tracks: &[&str]) -> anyhow::Result<TrackSet> {
    tracks.iter().map(|word| Ok(TrackId(whole("track", word)?))).collect()
}

/// One line, written at once: who reads it may rely on what it says.
fn answer(done: &Done, project: &Project, as_json: bool) -> anyhow::Result<()> {
    let Done { what, entry: Entry { id, label, .. } } = done;
    let line = if as_json {
        json!({ "what": what, "id": id, "label": label, "revision": project.revision() }).to_string()
    } else if *what == "edit" {
        format!("{id}  {label}")
    } else {
        format!("{id}  {what}: {label}")
    };
    let mut out = std::io::stdout().lock();
    out.write_all(format!("{line}\n").as_bytes())?;
    Ok(out.flush()?)
}
