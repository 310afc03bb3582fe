//! `scale`: how many metres a pixel is.

use honami_workbench::scale::{self, ScaleBar};
use honami_workbench::store::{Access, Project};
use serde_json::{Value, json};

use super::args::scale::Scale;
use super::{Answer, Usage, look, there};
use crate::scale::{Length, per_px_and_error};

/// Keeps a scale bar, takes it away, or says what there is.
pub(super) fn scale(args: &Scale) -> anyhow::Result<Answer> {
    let bar = match (&args.ends[..], &args.length) {
        ([a, b], Some(length)) => Some(ScaleBar {
            frame: args.frame,
            ends: [a.0, b.0],
            length_m: metres("--length", length)?,
            length_error_m: args
                .length_error
                .as_ref()
                .map_or(Ok(0.0), |error| metres("--length-error", error))?,
            end_error_px: args.end_error,
        }),
        _ => None,
    };
    if bar.is_none() && !args.remove {
        let shown = look(&args.project)?.document().scale();
        let text = shown.as_ref().map_or_else(
            || "no scale: honami scale PROJECT X,Y X,Y --length 0.5m says what a pixel is".to_owned(),
            told,
        );
        return Ok(Answer { json: json!({ "scale": shown.as_ref().map(entry) }), text, done: true });
    }
    there(&args.project)?;
    let mut project = Project::open(&args.project, Access::Write)?;
    let transaction = scale::prepare(&project, bar)?;
    let label = transaction.label.clone();
    let id = project.commit(transaction)?;
    let text =
        format!("{id}  {label}{}", bar.as_ref().map_or_else(String::new, |bar| format!("\n{}", told(bar))));
    let json = json!({
        "scale": bar.as_ref().map(entry),
        "edits": [{ "id": id, "label": label }],
        "revision": project.revision(),
    });
    Ok(Answer { json, text, done: true })
}

fn metres(option: &str, length: &Length) -> Result<f64, Usage> {
    length.metres().map_err(|why| Usage(format!("{option}: {why}")))
}

/// What a bar says, and of what it says nothing.
fn told(bar: &ScaleBar) -> String {
    format!(
        "{}: {} m over {:.1} px, along {:.0}°, in frame {}\n\
         It measures along itself and in its own plane: what is nearer or farther has another\n\
         scale, and what moves towards the camera is not measured.",
        per_px_and_error(bar),
        bar.length_m,
        bar.length_px(),
        bar.direction_rad().to_degrees(),
        bar.frame
    )
}

fn entry(bar: &ScaleBar) -> Value {
    json!({
        "m_per_px": bar.m_per_px(),
        "relative_error": bar.relative_error(),
        "length_px": bar.length_px(),
        "direction_deg": bar.direction_rad().to_degrees(),
        "length_m": bar.length_m,
        "length_error_m": bar.length_error_m,
        "end_error_px": bar.end_error_px,
        "ends": bar.ends,
        "frame": bar.frame,
    })
}
