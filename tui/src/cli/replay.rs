//! `replay`: a logged session done again in a project, without a screen.

use anyhow::Context as _;
use honami_model::brief::counted;
use serde_json::json;

use super::args::{Common, Replay};
use super::{Answer, session};
use crate::app;

/// Does what the log says, and says what was said.
pub(super) fn replay(args: &Replay, common: &Common) -> anyhow::Result<Answer> {
    let log = std::fs::read_to_string(&args.log)
        .with_context(|| format!("cannot read the log {}", args.log.display()))?;
    let (mut text, mut said) = (String::new(), Vec::new());
    let done = app::replay(session(&args.project, common)?, &log, &mut |line, notice| {
        let error = if notice.is_error { "error: " } else { "" };
        text += &format!("{line}: {error}{}\n", notice.text);
        said.push(json!({ "line": line, "text": notice.text, "error": notice.is_error }));
    })
    .with_context(|| args.log.display().to_string())?;
    text += &match &done.difference {
        Some((line, how)) => format!("{}, line {line}: {how}", args.log.display()),
        None => format!("{} done as in the log; at edit {}", counted(done.n_done, "line"), done.revision),
    };
    let difference = done.difference.as_ref().map(|(line, how)| json!({ "line": line, "what": how }));
    let json = json!({
        "done": done.n_done,
        "said": said,
        "revision": done.revision,
        "difference": difference,
    });
    Ok(Answer { json, text, done: done.difference.is_none() })
}
