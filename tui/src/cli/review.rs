//! `review`: the queue of doubtful segments, how far the review is, and what it has taken.

use std::sync::Arc;

use honami_model::brief::counted;
use honami_model::judgement::Verdict;
use honami_workbench::review::{self, Item, Review, effort};
use honami_workbench::session::{Session, SessionOptions};
use serde_json::{Value, json};

use super::args::{Common, Project};
use super::report::Bar;
use super::{Answer, options, there, where_is_the_clip};

/// So many items are listed for people; machines get all.
const LISTED: usize = 40;

/// What the codes of reasons mean.
const LEGEND: &str = "FB: the way back misses, NCC: looks different, JMP: sudden step, NBR: moves unlike its neighbours, \
                      DIS: trackers disagree, GRP: moves unlike its group, LOST: lost";

/// Prints the queue, most doubtful first.
pub(super) fn review(args: &Project, common: &Common) -> anyhow::Result<Answer> {
    there(&args.project)?;
    let look = SessionOptions { read_only: true, ..options(common) };
    let session =
        Session::open(&args.project, &look).map_err(|error| where_is_the_clip(error, &args.project))?;
    let review = review::review(&session.project, Arc::clone(&session.media), &Bar::new())?;
    Ok(Answer { text: text(&session, &review), json: machine(&session, &review), done: true })
}

fn text(session: &Session, review: &Review) -> String {
    let progress = review.progress();
    let mut lines = vec![match progress.total() {
        0 => "nothing is doubtful".to_owned(),
        _ => format!("{} to review, {} done", counted(progress.open, "segment"), progress.judged.done()),
    }];
    let found = Verdict::ALL.into_iter().filter(|verdict| progress.judged.of(*verdict) > 0);
    let found: Vec<String> =
        found.map(|verdict| format!("{} {}", progress.judged.of(verdict), verdict.word())).collect();
    lines.extend((!found.is_empty()).then(|| found.join(", ")));
    lines.extend(match stale(session, review) {
        0 => None,
        1 => Some("1 judgement counts no more: the samples have changed since".to_owned()),
        n => Some(format!("{n} judgements count no more: the samples have changed since")),
    });
    let taken = effort(session.project.document());
    if !taken.is_empty() {
        let per_track = |sum: f64| sum / taken.len() as f64;
        lines.push(format!(
            "per reviewed track: {:.1} key-frames, {:.1} keystrokes, {:.1} s",
            per_track(taken.values().map(|t| f64::from(t.effort.key_frames)).sum()),
            per_track(taken.values().map(|t| f64::from(t.effort.keystrokes)).sum()),
            per_track(taken.values().map(|t| f64::from(t.effort.seconds)).sum()),
        ));
    }
    if !review.queue.is_empty() {
        lines.push(LEGEND.to_owned());
        lines.push(format!("{:>7}  {:>11}  {:>6}  {:>9}  reasons", "track", "frames", "worst", "suspicion"));
    }
    lines.extend(review.queue.iter().take(LISTED).map(row));
    let more = review.queue.len().saturating_sub(LISTED);
    lines.extend((more > 0).then(|| format!("… and {more} more (--json lists them)")));
    lines.join("\n")
}

/// Judgements of samples that have changed since.
fn stale(session: &Session, review: &Review) -> usize {
    let given: usize = session.project.document().tracks().map(|(_, track)| track.judgements.len()).sum();
    let judged = &review.progress().judged;
    given.saturating_sub(Verdict::ALL.into_iter().map(|verdict| judged.of(verdict)).sum())
}

fn row(item: &Item) -> String {
    let frames = format!("{}-{}", item.frames.start, item.frames.end - 1);
    let later = if item.later { "  later" } else { "" };
    let (track, worst) = (item.track.0, item.worst);
    let suspicion = suspicion(item.suspicion);
    let disagreement = item.reasons.codes().any(|code| code == "DIS").then(|| item.disagreement()).flatten();
    let disagreement = disagreement.map_or_else(String::new, |words| format!(": {words}"));
    format!("{track:>7}  {frames:>11}  {worst:>6}  {suspicion:>9}  {}{disagreement}{later}", item.reasons)
}

/// A probability: near 1 with the digits that tell it from 1.
fn suspicion(p: f32) -> String {
    match p {
        p if p < 0.995 => format!("{p:.2}"),
        p if p < 0.999_95 => format!("{p:.4}"),
        p if p < 0.999_999_5 => format!("{p:.6}"),
        _ => ">.999999".to_owned(),
    }
}

#[cfg(test)]
mod tests;

fn machine(session: &Session, review: &Review) -> Value {
    let item = |item: &Item| {
        let parts = &item.parts;
        json!({
            "track": item.track, "first_frame": item.frames.start, "end_frame": item.frames.end,
            "worst": item.worst, "suspicion": item.suspicion, "later": item.later,
            "reasons": item.reasons.codes().collect::<Vec<_>>(),
            "fb_px": parts.fb_px, "ncc": parts.ncc, "jump": parts.jump, "nbr_px": parts.nbr_px,
            "dis_px": parts.farthest_px(), "disagrees_with": item.opponent.as_deref(), "own_ncc": parts.own_ncc,
            "group_px": parts.group_px,
        })
    };
    let taken = effort(session.project.document());
    let taken: Vec<Value> = taken
        .iter()
        .map(|(track, sum)| json!({ "track": track, "segments": sum.segments, "effort": sum.effort }))
        .collect();
    let progress = review.progress();
    let verdicts = Verdict::ALL.map(|v| (v.word().to_owned(), progress.judged.of(v).into()));
    json!({
        "open": progress.open, "total": progress.total(),
        "verdicts": serde_json::Map::from_iter(verdicts), "stale": stale(session, review),
        "queue": review.queue.iter().map(item).collect::<Vec<_>>(), "effort": taken,
    })
}
