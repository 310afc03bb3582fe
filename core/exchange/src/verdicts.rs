//! The tables of a review: what was found of every segment, and what the review of every track has taken.

use honami_model::judgement::{Effort, Judgement, Verdict};
use honami_model::track::TrackId;

use crate::table::{Fields, Line, Row, TableError, finite, whole};

const COUNT: &str = "a whole number of 0 or more";
const SECONDS: &str = "a finite number";
const UNSEALED: &str = "unsealed";

/// A judgement: `track,first_frame,end_frame,verdict,stands,reasons,reviewer,time,keystrokes,key_frames,seconds`.
///
/// `end_frame` is one past the last; `stands` is `yes` or `no`, or `unsealed`; `reasons` are codes with spaces between them, `time` is RFC 3339. The seal of the
/// samples is the project's own and not written.
#[derive(Clone, Debug, PartialEq)]
pub struct VerdictRow {
    /// The track.
    pub track: TrackId,
    /// The segment's first frame.
    pub first_frame: u32,
    /// What was found of it.
    pub judgement: Judgement,
    /// Whether the samples are still those that were judged; `None`: nobody knows, they were not sealed.
    pub stands: Option<bool>,
}

impl Row for VerdictRow {
    const COLUMNS: &'static [&'static str] = &[
        "track",
        "first_frame",
        "end_frame",
        "verdict",
        "stands",
        "reasons",
        "reviewer",
        "time",
        "keystrokes",
        "key_frames",
        "seconds",
    ];
    const NEEDED: &'static [&'static str] = &["track", "first_frame", "end_frame", "verdict"];

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        let verdict = |text: &str| Verdict::ALL.into_iter().find(|verdict| verdict.word() == text);
        let text = |column| fields.text(column).unwrap_or_default();
        Ok(Self {
            track: TrackId(fields.required("track", COUNT, whole)?),
            first_frame: fields.required("first_frame", COUNT, whole)?,
            judgement: Judgement {
                end_frame: fields.required("end_frame", COUNT, whole)?,
                verdict: fields.required("verdict", "accepted, fixed, …, later", verdict)?,
                reasons: text("reasons").split_whitespace().map(str::to_owned).collect(),
                reviewer: text("reviewer").to_owned(),
                time: text("time").to_owned(),
                effort: effort(fields)?,
                seal: None,
            },
            stands: fields.optional("stands", "yes, no or unsealed", stands)?.flatten(),
        })
    }

    fn put(&self, line: &mut Line) {
        let Judgement { end_frame, verdict, reasons, reviewer, time, effort, .. } = &self.judgement;
        line.put(self.track);
        line.put(self.first_frame);
        line.put(end_frame);
        line.put(verdict.word());
        line.put(self.stands.map_or(UNSEALED, |stands| if stands { "yes" } else { "no" }));
        line.text(&reasons.join(" "));
        line.text(reviewer);
        line.put(time);
        put_effort(effort, line);
    }
}

fn stands(text: &str) -> Option<Option<bool>> {
    match text {
        "yes" => Some(Some(true)),
        "no" => Some(Some(false)),
        _ => (text == UNSEALED).then_some(None),
    }
}

/// What the review of a track has taken: `track,segments,keystrokes,key_frames,seconds`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortRow {
    /// The track.
    pub track: TrackId,
    /// Segments judged.
    pub segments: u32,
    /// Their sum.
    pub effort: Effort,
}

impl Row for EffortRow {
    const COLUMNS: &'static [&'static str] = &["track", "segments", "keystrokes", "key_frames", "seconds"];
    const NEEDED: &'static [&'static str] = Self::COLUMNS;

    fn parse(fields: &Fields<'_>) -> Result<Self, TableError> {
        Ok(Self {
            track: TrackId(fields.required("track", COUNT, whole)?),
            segments: fields.required("segments", COUNT, whole)?,
            effort: effort(fields)?,
        })
    }

    fn put(&self, line: &mut Line) {
        line.put(self.track);
        line.put(self.segments);
        put_effort(&self.effort, line);
    }
}

fn effort(fields: &Fields<'_>) -> Result<Effort, TableError> {
    Ok(Effort {
        keystrokes: fields.optional("keystrokes", COUNT, whole)?.unwrap_or(0),
        key_frames: fields.optional("key_frames", COUNT, whole)?.unwrap_or(0),
        seconds: fields.optional("seconds", SECONDS, finite)?.unwrap_or(0.0),
    })
}

fn put_effort(effort: &Effort, line: &mut Line) {
    line.put(effort.keystrokes);
    line.put(effort.key_frames);
    line.number(effort.seconds);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Writer, read};

    #[test]
    fn a_judgement_comes_back_but_for_its_seal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts.csv");
        let effort = Effort { keystrokes: 12, key_frames: 2, seconds: 8.5 };
        let rows: Vec<VerdictRow> = (0..)
            .zip(Verdict::ALL)
            .map(|(track, verdict)| VerdictRow {
                track: TrackId(track),
                first_frame: 10 * track,
                judgement: Judgement {
                    end_frame: 10 * track + 7,
                    verdict,
                    reasons: vec!["FB".to_owned(), "LOST".to_owned()],
                    reviewer: "Ann, \"A\"".to_owned(),
                    time: "2026-03-04T05:06:07Z".to_owned(),
                    effort,
                    seal: None,
                },
                stands: [Some(true), Some(false), None][track as usize % 3],
            })
            .collect();
        let mut table = Writer::create(&path).unwrap();
        rows.iter().for_each(|row| table.write(row).unwrap());
        table.finish().unwrap();
        let back: Vec<VerdictRow> = read(&path).unwrap().collect::<Result<_, _>>().unwrap();
        assert_eq!(back, rows);

        let path = folder.path().join("effort.csv");
        let rows = [EffortRow { track: TrackId(3), segments: 2, effort }];
        let mut table = Writer::create(&path).unwrap();
        rows.iter().for_each(|row| table.write(row).unwrap());
        table.finish().unwrap();
        let back: Vec<EffortRow> = read(&path).unwrap().collect::<Result<_, _>>().unwrap();
        assert_eq!(back, rows);
    }
}
