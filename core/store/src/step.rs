//! The steps of a recipe that were done, and what each was made of: how a later run tells what is stale.

use honami_model::history::EntryId;
use rusqlite::params;
use serde::{Deserialize, Serialize};

use crate::clustering::from_json;
use crate::error::StoreError;
use crate::project::Project;

/// A file as it was when a step had read or written it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptFile {
    /// Where it is; outputs relative to the project's folder.
    pub path: String,
    /// Bytes.
    pub size: u64,
    /// When it was changed last, nanoseconds since 1970: compared for being the same, never for being earlier.
    pub changed_ns: i128,
    /// Hash of its content.
    pub sha256: String,
}

/// A step of a recipe that was done.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// As on the command line, without the project; of the clip itself `new`.
    pub line: String,
    /// Hash of all that it came from: the line, plugins, files, this program's version, and the steps before it.
    pub made_of: String,
    /// The revision that it worked on.
    pub before: EntryId,
    /// The revision that it left.
    pub after: EntryId,
    /// Files that it read.
    pub inputs: Vec<KeptFile>,
    /// Files that it wrote.
    pub outputs: Vec<KeptFile>,
    /// What it said, as for machines.
    pub answer: serde_json::Value,
    /// How long it took.
    pub seconds: f64,
    /// When it was done, RFC 3339.
    pub time: String,
}

impl Project {
    /// The steps that were done of the recipe that was followed last, the clip itself first.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn steps(&self) -> Result<Vec<Step>, StoreError> {
        let sql = "SELECT inputs, outputs, answer, line, made_of, before, after, seconds, time FROM step ORDER BY id";
        let mut statement = self.conn.prepare(sql)?;
        let rows = statement.query_map([], |row| {
            Ok((|| {
                Ok(Step {
                    inputs: from_json(row, 0)?,
                    outputs: from_json(row, 1)?,
                    answer: from_json(row, 2)?,
                    line: row.get(3)?,
                    made_of: row.get(4)?,
                    before: EntryId(row.get(5)?),
                    after: EntryId(row.get(6)?),
                    seconds: row.get(7)?,
                    time: row.get(8)?,
                })
            })())
        })?;
        rows.map(|row| row?).collect()
    }

    /// Keeps what was done as step `number`; those that followed it, of what was there before, are steps no longer.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], or what SQLite met.
    pub fn keep_step(&mut self, number: usize, step: &Step) -> Result<(), StoreError> {
        let json = |what: serde_json::Result<String>| what.map_err(StoreError::corrupt);
        let id = u32::try_from(number).map_err(StoreError::corrupt)?;
        let (inputs, outputs) =
            (json(serde_json::to_string(&step.inputs))?, json(serde_json::to_string(&step.outputs))?);
        let answer = json(serde_json::to_string(&step.answer))?;
        self.writer()?;
        let tx = self.conn.transaction()?;
        tx.execute("DELETE FROM step WHERE id >= ?1", [id])?;
        tx.execute(
            "INSERT INTO step (id, line, made_of, before, after, inputs, outputs, answer, seconds, time)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)",
            params![
                id,
                step.line,
                step.made_of,
                step.before.0,
                step.after.0,
                inputs,
                outputs,
                answer,
                step.seconds,
                step.time
            ],
        )?;
        Ok(tx.commit()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Access;
    use crate::testing::{Bench, tracked};

    fn step(line: &str) -> Step {
        let file = KeptFile {
            path: "tracks.csv".to_owned(),
            size: 7,
            changed_ns: 1_700_000_000_123_456_789,
            sha256: "ab".repeat(32),
        };
        Step {
            line: line.to_owned(),
            made_of: "cd".repeat(32),
            before: EntryId(1),
            after: EntryId(3),
            inputs: vec![file.clone()],
            outputs: vec![file],
            answer: serde_json::json!({ "tracks": 7 }),
            seconds: 0.25,
            time: crate::now(),
        }
    }

    #[test]
    fn steps_come_back_and_a_step_that_is_done_anew_ends_those_after_it() {
        let bench = Bench::new();
        let mut project = tracked(&bench, 0..4);
        for (number, line) in ["new", "track", "cluster", "export tracks t.csv"].into_iter().enumerate() {
            project.keep_step(number, &step(line)).unwrap();
        }
        drop(project);
        let mut project = Project::open(&bench.path(), Access::Write).unwrap();
        let steps = project.steps().unwrap();
        assert_eq!(steps.len(), 4);
        assert_eq!(steps[1], Step { time: steps[1].time.clone(), ..step("track") });
        project.keep_step(2, &step("cluster --groups 3")).unwrap();
        let lines: Vec<String> = project.steps().unwrap().into_iter().map(|step| step.line).collect();
        assert_eq!(lines, ["new", "track", "cluster --groups 3"]);
        drop(project);
        let mut reader = Project::open(&bench.path(), Access::Read).unwrap();
        assert!(matches!(reader.keep_step(0, &step("new")), Err(StoreError::ReadOnly)));
    }
}
