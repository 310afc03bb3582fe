//! `edit`: corrections from a script, one a line, each answered once it is in the project file.

use std::io::{BufRead as _, Write as _};
use std::path::Path;

use anyhow::Context as _;
use honami_model::history::Entry;
use honami_workbench::script::{self, Done};
use honami_workbench::store::Project;
use serde_json::json;

use super::args::Common;
use super::session;

/// Reads edits from standard input to its end, and does each before it reads the next.
pub(super) fn edit(path: &Path, common: &Common) -> anyhow::Result<()> {
    let mut session = session(path, common)?;
    for (number, line) in (1..).zip(std::io::stdin().lock().lines()) {
        let line = line.context("cannot read the edits")?;
        let words = script::words(&line);
        if words.is_empty() {
            continue;
        }
        let done = script::step(&mut session, &words)
            .with_context(|| format!("line {number}, {}", words.join(" ")))?;
        answer(&done, &session.project, common.json)?;
    }
    Ok(())
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
