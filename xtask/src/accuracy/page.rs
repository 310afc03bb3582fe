//! docs/accuracy.md, from the rows that are kept.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::cases::{Case, FORKS, LEVELS, PAIRS, SEEDS, WALNUT, What};
use super::lab::{Lab, Tracker};
use super::numbers::{NONE, mean, number, px, px_or_lost, share, with_spread};

/// The rows of a case, each with whose it is; the one that tracks nothing comes last.
type Rows = Vec<(String, Value)>;

struct Page<'a> {
    lab: &'a Lab,
    cases: &'a [Case],
    trackers: &'a [Tracker],
    text: String,
}

/// The whole document.
pub(super) fn write(lab: &Lab, cases: &[Case], trackers: &[Tracker], left_out: &[String]) -> String {
    let mut page = Page { lab, cases, trackers, text: INTRODUCTION.to_owned() };
    for (level, goal) in [
        (
            "calm",
            "Goals of the anchored tracker: δavg .12 above plain KLT and above every row of OpenCV, .50 within 1 px.",
        ),
        ("wind", "Goals of the anchored tracker: δavg .15 above plain KLT and above every row of OpenCV."),
        (
            "storm",
            "Goals of the anchored tracker: δavg .05 above plain KLT and above every row of OpenCV; of the samples called \
             seen .90 within 8 px (precision), at .60 of the visible ones (recall).",
        ),
    ] {
        page.foliage(level, goal);
    }
    page.middlebury();
    page.dic();
    page.forks();
    page.walnut();
    page.waving();
    page.real();
    if !left_out.is_empty() {
        page.put(format_args!("\nNot measured with its defaults: {}.", left_out.join("; ")));
    }
    for tracker in trackers {
        let is_missing = |case: &&Case| lab.lacks(case, tracker);
        let missing: Vec<&str> = cases.iter().filter(is_missing).map(|case| case.name.as_str()).collect();
        if !missing.is_empty() {
            page.put(format_args!("\nNot measured yet, {}: {}.", tracker.name(), missing.join(", ")));
        }
    }
    if lab.data.is_none() {
        page.text +=
            "\nThe rows of real data need `HONAMI_DATA`, the folder of the data, which was not set.\n";
    }
    page.text
}

const INTRODUCTION: &str = "\
# Accuracy

Every tracker that is shipped, on clips whose answer is known, and on some whose answer nobody knows. `cargo xtask bench \
accuracy` measures what is not measured yet and writes this page; `cargo xtask bench accuracy calm --with klt` measures \
a part and prints it; `honami compare` measures the same on your clip. Rows of real data need `HONAMI_DATA`.

All trackers are given the same points, with their default parameters, one thread each. δavg is the share of visible \
samples within 1, 2, 4, 8 and 16 px of the truth, averaged; lost samples are misses. A tracker that takes more than \
10 times as long as `klt` is given fewer points, one above 40 times far fewer and only the first seed: n says how many. Times are of two \
trackers side by side on a machine of two cores; `cargo xtask bench trackers` measures them properly. The row \"static\" \
tracks nothing. What was measured is kept: a row says what its tracker did on that day. These are of 22 and 23 November \
2026; of `box` they are from before it was kept from drifting where nothing moves.
";

impl Page<'_> {
    /// The kept rows of a case.
    fn rows(&self, case: &str) -> Rows {
        let Some(case) = self.cases.iter().find(|known| known.name == case) else { return Vec::new() };
        let kept = |tracker: &Tracker| Some((tracker.name().to_owned(), self.lab.kept_row(case, tracker)?));
        let mut rows: Rows = self.trackers.iter().filter_map(kept).collect();
        // Who stands still is measured beside everybody; on all the points beside the quick ones.
        let most = rows.iter().max_by_key(|(_, answer)| answer["points"].as_u64());
        let still = most.and_then(|(_, answer)| {
            let still = answer["trackers"].as_array()?.iter().find(|row| row["tracker"] == "static")?;
            Some(json!({ "points": answer["points"], "frames": answer["frames"], "trackers": [still] }))
        });
        rows.extend(still.map(|still| ("static".to_owned(), still)));
        rows
    }

    /// The rows of several cases, one beside the other; `None` where a tracker has none of a case.
    fn beside(&self, cases: &[String]) -> Vec<(String, Vec<Option<Value>>)> {
        let of_cases: Vec<Rows> = cases.iter().map(|case| self.rows(case)).collect();
        let names = self.trackers.iter().map(Tracker::name).chain(["static"]);
        let row = |name: &str| {
            let found =
                |rows: &Rows| rows.iter().find(|(known, _)| known == name).map(|(_, row)| row.clone());
            let found: Vec<Option<Value>> = of_cases.iter().map(found).collect();
            found.iter().any(Option::is_some).then(|| (name.to_owned(), found))
        };
        names.filter_map(row).collect()
    }

    fn put(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        self.text.write_fmt(line).unwrap_or_default();
        self.text.push('\n');
    }

    /// A heading, what is to be known, and a table with the tracker before its columns; nothing where there are no rows.
    fn table(&mut self, heading: &str, words: &str, columns: &[&str], rows: &[(String, Vec<String>)]) {
        if rows.is_empty() {
            return;
        }
        self.put(format_args!("\n## {heading}\n\n{words}\n"));
        self.put(format_args!("| tracker | {} |", columns.join(" | ")));
        self.put(format_args!("|---|{}", "---|".repeat(columns.len())));
        for (name, cells) in rows {
            self.put(format_args!("| {name} | {} |", cells.join(" | ")));
        }
    }

    fn foliage(&mut self, level: &str, goal: &str) {
        let cases: Vec<String> = SEEDS.iter().map(|seed| format!("{level}-{seed}")).collect();
        let mut rows = Vec::new();
        for (name, answers) in self.beside(&cases) {
            let answers: Vec<Value> = answers.into_iter().flatten().collect();
            let all = |path: &str| answers.iter().filter_map(|a| number(a, path)).collect::<Vec<f64>>();
            let of = |path: &str| share(mean(&all(path)));
            let n: Vec<String> = answers.iter().map(|answer| answer["points"].to_string()).collect();
            let mut cells = vec![with_spread(&all("delta_avg"))];
            cells.extend((0..5).map(|k| of(&format!("within/{k}"))));
            cells.push(px(mean(&all("trajectory_px"))));
            cells.extend([of("survival"), of("visibility")]);
            cells.push(format!("{} / {}", of("precision"), of("recall")));
            let whole = |value: Option<f64>| value.map_or_else(|| NONE.to_owned(), |v| format!("{v:.1}"));
            cells.push(whole(mean(&all("ms_per_frame"))));
            cells.push(whole(mean(&all("peak_bytes")).map(|bytes| bytes / 1e6)));
            cells.push(n.join(", "));
            rows.push((name, cells));
        }
        let columns = [
            "δavg",
            "1 px",
            "2",
            "4",
            "8",
            "16",
            "track, px",
            "survival",
            "visibility",
            "precision / recall",
            "ms",
            "MB",
            "n",
        ];
        let words = format!(
            "`honami synth --wind {level} --leaves 2600 --frames 150`, 960x720, seeds 1, 2 and 3: mean, and for δavg half \
             of what lies between the seeds. {goal} Track: median over points of the median error of a point."
        );
        self.table(&format!("Generated foliage, {level}"), &words, &columns, &rows);
    }

    fn middlebury(&mut self) {
        let mut rows = Vec::new();
        for (name, answers) in self.beside(&PAIRS.map(str::to_owned)) {
            let mut cells = Vec::new();
            for answer in &answers {
                let of = |path: &str| answer.as_ref().and_then(|answer| number(answer, path));
                cells.push(format!("{} ({})", px(of("median_px")), px(of("mean_px"))));
                cells.push(px(of("field/mean_px")));
            }
            rows.push((name, cells));
        }
        let columns = ["RubberWhale, px", "dense", "Hydrangea, px", "dense", "Grove2, px", "dense"];
        let words = "End-point error at Harris corners, median (mean), and mean over all pixels of trackers that measure \
                     dense motion. Goal: Grove2 at corners at most .08 px.";
        self.table("Pairs of pictures with their flow: Middlebury", words, &columns, &rows);
    }

    fn dic(&mut self) {
        let cases = LEVELS.map(|(level, _)| format!("dic14-{level}"));
        let mut rows = Vec::new();
        for (name, answers) in self.beside(&cases) {
            let of =
                |answer: &Option<Value>, path: &str| answer.as_ref().and_then(|answer| number(answer, path));
            let cells = answers
                .iter()
                .flat_map(|answer| [px(of(answer, "axis_rms_px/0")), px(of(answer, "bias_px/0"))]);
            rows.push((name, cells.collect()));
        }
        let columns = ["L1, rms px", "bias", "L3, rms px", "bias", "L5, rms px", "bias"];
        let words = "A speckle pattern moved by a known fraction of a pixel, in waves that grow shorter; points 16 px apart, \
                     radius 15 for trackers that have one; rms and bias of the motion to the right. Goal: rms at most .014 px.";
        self.table("Fractions of a pixel: DIC challenge, sample 14", words, &columns, &rows);
    }

    fn forks(&mut self) {
        let cases = FORKS.map(|(tone, _)| format!("fork-{tone}"));
        let mut rows = Vec::new();
        for (name, answers) in self.beside(&cases) {
            let hz = |answer: &Option<Value>| answer.as_ref().and_then(|answer| answer["hz"].as_f64());
            let cells =
                answers.iter().map(|a| hz(a).map_or_else(|| NONE.to_owned(), |hz| format!("{hz:.2}")));
            let frames = answers.iter().flatten().map(|answer| answer["frames"].to_string()).next();
            rows.push((name, cells.chain(frames).collect()));
        }
        let columns = ["32 Hz at 500 fps", "64 Hz at 1000 fps", "128 Hz at 250 fps", "frames"];
        let words = "The strongest sway of points on the prongs, Hz. 128 Hz is above half the frame rate and seen as its \
                     alias, 122. Goal: within .1 Hz of 32, 64 and 122.";
        self.table("Tuning forks", words, &columns, &rows);
    }

    fn walnut(&mut self) {
        let mut rows = Vec::new();
        for (name, answer) in self.rows("walnut") {
            let swing = &answer["swing"];
            let digits = |value: &Value, times: f64, digits: usize| {
                value.as_f64().map_or_else(|| NONE.to_owned(), |v| format!("{:.digits$}", v * times))
            };
            let cells = vec![
                digits(&swing["hz"], 1.0, 4),
                digits(&swing["damping"], 100.0, 2),
                answer["frames"].to_string(),
                answer["points"].to_string(),
            ];
            rows.push((name, cells));
        }
        let filmed = self.cases.iter().find_map(|case| match case.what {
            What::Walnut { hz, damping, .. } => Some((hz, damping)),
            _ => None,
        });
        let Some((hz, damping)) = filmed else { return };
        let words = format!(
            "A digitised walnut (2740 nodes of beams) filmed as it swings in its slowest mode, `honami synth walnut.y4m --plant \
             noylum2.mtg {WALNUT}`; its leaves are tracked, and `honami spectrum` has frequency and damping back from them. \
             They are {hz:.4} Hz and {:.2} %. Goal: within 2 % and 20 %.",
            100.0 * damping
        );
        self.table("A tree that is let go", &words, &["Hz", "damping %", "frames", "n"], &rows);
    }

    fn waving(&mut self) {
        let mut rows = Vec::new();
        for (name, answer) in self.rows("waving") {
            let of = |path: &str| number(&answer, path);
            let cells =
                vec![px(of("median_px")), px(of("rms_px")), share(of("within_1px")), share(of("kept"))];
            rows.push((name, [cells, vec![answer["points"].to_string()]].concat()));
        }
        let columns = ["median, px", "rms, px", "within 1 px", "kept", "n"];
        let words = "The building behind the shaken tree of `WavingTrees` does not move: whoever says so for 240 frames is \
                     right, and who is disturbed by the branches that cross it is not.";
        self.table("Points that stand still", words, &columns, &rows);
    }

    fn real(&mut self) {
        let cases = ["malva", "leaves_cut", "reeds_wind"].map(str::to_owned);
        let mut rows = Vec::new();
        for (name, answers) in self.beside(&cases).into_iter().filter(|(name, _)| name != "static") {
            let cells = |answer: &Option<Value>| match answer {
                None => vec![NONE.to_owned(); 3],
                Some(answer) => {
                    let of = |path: &str| share(number(answer, path));
                    vec![of("kept"), px_or_lost(answer, "back/median_px"), of("back/within_1px")]
                }
            };
            let mut cells: Vec<String> = answers.iter().flat_map(cells).collect();
            let n = answers
                .iter()
                .flatten()
                .map(|answer| format!("{} x {}", answer["points"], answer["frames"][1]));
            cells.push(n.collect::<Vec<_>>().join(", "));
            rows.push((name, cells));
        }
        let columns = [
            "malva: kept",
            "back, px",
            "within 1 px",
            "leaves_cut: kept",
            "back, px",
            "within 1 px",
            "reeds_wind: kept",
            "back, px",
            "within 1 px",
            "points x frames",
        ];
        let words = "No truth is known of these: kept, points seen in every frame; back, how far from its start a point ends \
                     that is tracked to the last frame and back, the median, and the share within 1 px. A tracker that \
                     sticks to the wrong leaf comes back, too: little here says that a tracker is bad, much does not say \
                     that it is good. Key-frames, which would tell, are part of a project: `honami compare` leaves them \
                     out one by one.";
        self.table("Real clips", words, &columns, &rows);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_page_begins_as_it_is_written() {
        let page = include_str!("../../../docs/accuracy.md");
        assert!(page.starts_with(super::INTRODUCTION), "{}", super::INTRODUCTION);
    }
}
