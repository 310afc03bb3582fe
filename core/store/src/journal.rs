//! The journal: every edit with its inverse, and where in the undo tree the document stands.

use std::collections::BTreeMap;

use honami_model::document::{ClusteringId, Document, MatteId, RunId};
use honami_model::edit::{Edit, Transaction, apply};
use honami_model::history::{Entry, EntryId, History, Step};
use honami_model::space::SpaceId;
use honami_model::track::TrackSet;
use rusqlite::{Connection, OptionalExtension, TransactionBehavior, params};

use crate::error::StoreError;

/// Makes the root of an empty journal.
pub(crate) fn create(conn: &Connection, author: &str) -> Result<(), StoreError> {
    conn.execute(
        "INSERT INTO entry VALUES (0, NULL, NULL, 'project made', ?1, ?2, '[]', '[]')",
        params![author, crate::now()],
    )?;
    conn.execute("INSERT INTO state VALUES (1, 0, 0)", [])?;
    Ok(())
}

/// Reads the tree, and folds the edits from its root to its head into a document.
pub(crate) fn load(conn: &Connection, n_frames: u32) -> Result<(History, Document), StoreError> {
    let head: u32 = conn.query_row("SELECT head FROM state", [], |row| row.get(0))?;
    let mut statement =
        conn.prepare("SELECT id, parent, next, label, author, time FROM entry ORDER BY id")?;
    let entries = statement.query_map([], |row| {
        Ok(Entry {
            id: EntryId(row.get(0)?),
            parent: row.get::<_, Option<u32>>(1)?.map(EntryId),
            next: row.get::<_, Option<u32>>(2)?.map(EntryId),
            label: row.get(3)?,
            author: row.get(4)?,
            time: row.get(5)?,
        })
    })?;
    let history =
        History::new(entries.collect::<Result<_, _>>()?, EntryId(head)).map_err(StoreError::corrupt)?;
    let mut document = Document::new(n_frames);
    let path = history.path(EntryId::ROOT, history.head()).unwrap_or_default();
    // A child has a larger number than its parent: one pass in order meets the whole path.
    let mut on_path = path.iter().map(|step| step_id(*step)).peekable();
    let mut statement = conn.prepare("SELECT id, command FROM entry ORDER BY id")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let id = EntryId(row.get(0)?);
        if on_path.next_if_eq(&id).is_some() {
            let edits = parse(id, row.get_ref(1)?.as_str().map_err(StoreError::corrupt)?)?;
            apply(&mut document, &Transaction { label: String::new(), edits })
                .map_err(|error| StoreError::corrupt(format!("entry {id}: {error}")))?;
        }
    }
    Ok((history, document))
}

/// Writes an entry under the head and moves the head to it; returns when SQLite has committed.
pub(crate) fn append(
    conn: &mut Connection,
    (id, parent): (EntryId, EntryId),
    (command, inverse): (&Transaction, &Transaction),
    author: &str,
    time: &str,
) -> Result<(), StoreError> {
    let json = |edits: &[Edit]| serde_json::to_string(edits).map_err(StoreError::corrupt);
    let (forward, back) = (json(&command.edits)?, json(&inverse.edits)?);
    let tx = conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
    tx.prepare_cached("INSERT INTO entry VALUES (?1, ?2, NULL, ?3, ?4, ?5, ?6, ?7)")?.execute(params![
        id.0,
        parent.0,
        command.label,
        author,
        time,
        forward,
        back
    ])?;
    tx.prepare_cached("UPDATE entry SET next = ?1 WHERE id = ?2")?.execute([id.0, parent.0])?;
    tx.prepare_cached("UPDATE state SET head = ?1")?.execute([id.0])?;
    Ok(tx.commit()?)
}

/// The transaction that a step of a way through the tree applies.
pub(crate) fn transaction(conn: &Connection, step: Step) -> Result<Transaction, StoreError> {
    let sql = match step {
        Step::Back(_) => "SELECT inverse, label FROM entry WHERE id = ?1",
        Step::Forward(_) => "SELECT command, label FROM entry WHERE id = ?1",
    };
    let id = step_id(step);
    let row: Option<(String, String)> =
        conn.prepare_cached(sql)?.query_row([id.0], |row| Ok((row.get(0)?, row.get(1)?))).optional()?;
    let (json, label) = row.ok_or(StoreError::NoSuchEntry(id))?;
    Ok(Transaction { label, edits: parse(id, &json)? })
}

/// The tracks whose samples a step may change, in either direction.
pub(crate) fn touched(conn: &Connection, step: Step) -> Result<[TrackSet; 2], StoreError> {
    let id = step_id(step);
    let both = [Step::Forward(id), Step::Back(id)].map(|step| transaction(conn, step));
    let [forward, back] = both.map(|transaction| transaction.map(|transaction| transaction.touched()));
    Ok([forward?, back?])
}

/// The first entry that shows each result, wherever it is in the undo tree.
#[derive(Debug, Default)]
pub(crate) struct FirstShown {
    pub(crate) runs: BTreeMap<RunId, EntryId>,
    pub(crate) clusterings: BTreeMap<ClusteringId, EntryId>,
    pub(crate) mattes: BTreeMap<MatteId, EntryId>,
    pub(crate) spaces: BTreeMap<SpaceId, EntryId>,
}

/// Searches all entries, undone ones included, for those that show results.
pub(crate) fn first_shown(conn: &Connection) -> Result<FirstShown, StoreError> {
    // The names of the edits in JSON never change; a label or name with these words is only read in vain.
    let mut statement = conn.prepare(
        "SELECT id, command FROM entry
         WHERE instr(command, '\"show-') > 0 OR instr(command, '\"keep-matte') > 0 ORDER BY id",
    )?;
    let mut rows = statement.query([])?;
    let mut first = FirstShown::default();
    while let Some(row) = rows.next()? {
        let id = EntryId(row.get(0)?);
        for edit in parse(id, row.get_ref(1)?.as_str().map_err(StoreError::corrupt)?)? {
            match edit {
                Edit::ShowRun { run, .. } => first.runs.entry(run).or_insert(id),
                Edit::ShowClustering { clustering: Some(shown) } => {
                    first.clusterings.entry(shown.id).or_insert(id)
                }
                Edit::KeepMatte { matte: Some(matte), .. } => first.mattes.entry(matte).or_insert(id),
                Edit::ShowSpace { space: Some(space) } => first.spaces.entry(space).or_insert(id),
                _ => continue,
            };
        }
    }
    Ok(first)
}

/// Moves the head along a way that ends at `to`.
pub(crate) fn walk(conn: &mut Connection, path: &[Step], to: EntryId) -> Result<(), StoreError> {
    let tx = conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
    for step in path {
        if let Step::Forward(id) = step {
            let sql = "UPDATE entry SET next = ?1 WHERE id = (SELECT parent FROM entry WHERE id = ?1)";
            tx.prepare_cached(sql)?.execute([id.0])?;
        }
    }
    tx.execute("UPDATE state SET head = ?1", [to.0])?;
    Ok(tx.commit()?)
}

fn parse(id: EntryId, json: &str) -> Result<Vec<Edit>, StoreError> {
    serde_json::from_str(json).map_err(|error| StoreError::corrupt(format!("entry {id}: {error}")))
}

fn step_id(step: Step) -> EntryId {
    match step {
        Step::Back(id) | Step::Forward(id) => id,
    }
}
