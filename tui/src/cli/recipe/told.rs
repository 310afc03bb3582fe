//! What is told of many clips: before, on the way, in the end.

use honami_model::brief::counted;
use honami_workbench::plugins::{Registry, plain};
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::super::{Answer, report};
use super::Recipe;
use super::alone::Told;
use super::crew::Listener;
use super::plan::{Clip, plan};

/// What became of a clip.
#[derive(Clone, Debug, Default)]
pub(in crate::cli) struct Fate {
    /// Steps that stood as they were.
    pub(in crate::cli) n_fresh: usize,
    /// Steps that were done: number, seconds, what they said.
    pub(in crate::cli) done: Vec<(usize, f64, Value)>,
    /// The step that failed, and why.
    pub(in crate::cli) failed: Option<(usize, String)>,
    /// Whether it was not begun, or ended before it was through.
    pub(in crate::cli) stopped: bool,
    /// The most memory that its processes had at once, of what was seen, bytes; 0: nothing was done.
    pub(in crate::cli) peak_bytes: u64,
}

impl Fate {
    pub(super) fn failed(step: usize, why: String) -> Self {
        Self { failed: Some((step, why)), ..Self::default() }
    }

    pub(in crate::cli) fn seconds(&self) -> f64 {
        self.done.iter().fold(0.0, |sum, (_, seconds, _)| sum + seconds)
    }
}

/// What would be done.
pub(super) fn planned(recipe: &Recipe, clips: &[Clip], registry: &Registry) -> Answer {
    let mut rows = vec![["clip", "step", "what", "why"].map(str::to_owned).to_vec()];
    let mut told = Vec::new();
    let mut done = true;
    for clip in clips {
        let name = clip.name.clone();
        match plan(recipe, clip, registry) {
            Ok(plan) => {
                let why = plan.why.as_ref().map(ToString::to_string);
                let first = plan.n_fresh;
                for (k, line) in recipe.steps.iter().enumerate().skip(first) {
                    let why = if k == first { why.clone().unwrap_or_default() } else { "follows".to_owned() };
                    rows.push(vec![name.clone(), (k + 1).to_string(), line.text.clone(), why]);
                }
                if why.is_none() {
                    rows.push(vec![
                        name.clone(),
                        String::new(),
                        "nothing".to_owned(),
                        "all is fresh".to_owned(),
                    ]);
                }
                told.push(json!({
                    "clip": name,
                    "fresh": plan.n_fresh,
                    "todo": recipe.steps[plan.n_fresh..].iter().map(|line| &line.text).collect::<Vec<_>>(),
                    "why": why,
                    "edits_by_hand": plan.n_edits,
                }));
            }
            Err(error) => {
                done = false;
                let why = report::chain(&error);
                rows.push(vec![name.clone(), String::new(), "cannot be done".to_owned(), why.clone()]);
                told.push(json!({ "clip": name, "error": why }));
            }
        }
    }
    Answer { json: json!({ "clips": told }), text: report::table(&rows), done }
}

/// How far all are: a line for all and one for each at work; where nobody looks on, a line for each that is through.
pub(super) struct Shown {
    all: ProgressBar,
    each: Vec<ProgressBar>,
    /// The steps.
    lines: Vec<String>,
}

impl Shown {
    pub(super) fn new(recipe: &Recipe, n_clips: usize, n_jobs: usize) -> Self {
        let bars = MultiProgress::with_draw_target(ProgressDrawTarget::stderr_with_hz(5));
        let all = bars.add(ProgressBar::new(n_clips as u64));
        if let Ok(style) = ProgressStyle::with_template("clips {pos}/{len} ▕{bar:20}▏ {eta} left {msg}") {
            all.set_style(style.progress_chars("█▌ "));
        }
        all.tick();
        let each = || {
            let bar = bars.add(ProgressBar::new_spinner());
            if let Ok(style) = ProgressStyle::with_template("  {msg}") {
                bar.set_style(style);
            }
            bar
        };
        let lines = recipe.steps.iter().map(|line| line.text.clone()).collect();
        Self { each: (0..n_jobs).map(|_| each()).collect(), all, lines }
    }
}

impl Listener for Shown {
    fn told(&self, worker: usize, clip: &Clip, told: &Told) {
        let Told::At { step, done, total, what } = told else { return };
        let line = step.checked_sub(1).and_then(|k| self.lines.get(k)).map_or("new", String::as_str);
        let n = self.lines.len();
        self.each[worker].set_message(format!(
            "{}  {step}/{n} {line}  {} {done}/{total}",
            clip.name,
            plain(what)
        ));
    }

    fn through(&self, worker: usize, clip: &Clip, fate: &Fate) {
        self.each[worker].set_message(String::new());
        if self.all.is_hidden() {
            report::say(&format!("{}: {}", clip.name, words(fate)));
        } else if let Some((_, why)) = &fate.failed {
            self.all.suspend(|| report::say(&format!("{}: {why}", clip.name)));
        }
        self.all.inc(1);
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.each.iter().chain([&self.all]).for_each(ProgressBar::finish_and_clear);
    }
}

/// What a step is called; before the first it is the clip that is wrong.
pub(in crate::cli) fn step_words(step: usize) -> String {
    if step == 0 { "the clip".to_owned() } else { format!("step {step}") }
}

pub(in crate::cli) fn words(fate: &Fate) -> String {
    let n_done = fate.done.iter().filter(|(step, ..)| *step > 0).count();
    match &fate.failed {
        Some((step, why)) => format!("{} failed: {why}", step_words(*step)),
        None if fate.stopped => "stopped".to_owned(),
        None if n_done == 0 => "fresh".to_owned(),
        None => format!("{} in {:.1} s", counted(n_done, "step"), fate.seconds()),
    }
}

/// A row a clip, and the sums.
pub(super) fn summary(recipe: &Recipe, clips: &[Clip], fates: &[Fate], seconds: f64) -> Answer {
    let mut rows = vec![["clip", "steps done", "fresh", "seconds", "MB", ""].map(str::to_owned).to_vec()];
    let mut told = Vec::new();
    for (clip, fate) in clips.iter().zip(fates) {
        let n_done = fate.done.iter().filter(|(step, ..)| *step > 0).count();
        let end = match &fate.failed {
            Some((step, why)) => format!("{} failed: {why}", step_words(*step)),
            None if fate.stopped => "stopped".to_owned(),
            None => String::new(),
        };
        rows.push(vec![
            clip.name.clone(),
            n_done.to_string(),
            fate.n_fresh.to_string(),
            format!("{:.1}", fate.seconds()),
            format!("{:.0}", fate.peak_bytes as f64 / 1e6),
            end,
        ]);
        let line = |step: usize| {
            step.checked_sub(1).and_then(|k| recipe.steps.get(k)).map_or("new", |line| &line.text)
        };
        let done = fate.done.iter().map(|(step, seconds, answer)| {
            json!({ "step": step, "line": line(*step), "seconds": seconds, "answer": answer })
        });
        told.push(json!({
            "clip": clip.name,
            "project": clip.project(),
            "fresh": fate.n_fresh,
            "done": done.collect::<Vec<_>>(),
            "failed": fate.failed.as_ref().map(|(step, why)| json!({ "step": step, "line": line(*step), "why": why })),
            "stopped": fate.stopped,
            "peak_bytes": fate.peak_bytes,
        }));
    }
    let count = |is: fn(&Fate) -> bool| fates.iter().filter(|fate| is(fate)).count();
    let (n_failed, n_stopped) = (count(|fate| fate.failed.is_some()), count(|fate| fate.stopped));
    let n_fresh = count(|fate| fate.failed.is_none() && !fate.stopped && fate.done.is_empty());
    let mut text = report::table(&rows);
    text += &format!("\n{} in {seconds:.1} s", counted(clips.len(), "clip"));
    for (n, what) in [(n_fresh, "fresh"), (n_failed, "failed"), (n_stopped, "stopped: the same line goes on")]
    {
        if n > 0 {
            text += &format!(", {n} {what}");
        }
    }
    let json = json!({ "clips": told, "failed": n_failed, "stopped": n_stopped, "fresh": n_fresh, "seconds": seconds });
    Answer { json, text, done: n_failed + n_stopped == 0 }
}
