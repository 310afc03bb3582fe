//! The database's shape, and how older shapes become this one.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags, TransactionBehavior};

use crate::error::StoreError;

/// `HONA`: what `file` and SQLite see in the header.
const APPLICATION_ID: u32 = 0x484F_4E41;

/// How long a session waits for another one's short transaction.
pub(crate) const BUSY_TIMEOUT: Duration = Duration::from_secs(20);

/// Step n brings schema n to n + 1; a step is never changed once it was released.
const MIGRATIONS: [&str; 8] = [
    "
    CREATE TABLE state (            -- one row: what changes with every edit
        id          INTEGER PRIMARY KEY CHECK (id = 1),
        head        INTEGER NOT NULL REFERENCES entry,
        next_track  INTEGER NOT NULL
    );
    CREATE TABLE clip (             -- one row
        id          INTEGER PRIMARY KEY CHECK (id = 1),
        path        BLOB NOT NULL,  -- relative to the project where possible
        sha256      TEXT NOT NULL,
        fps         REAL,           -- the user's override
        width       INTEGER NOT NULL,
        height      INTEGER NOT NULL,
        times       BLOB NOT NULL   -- f64, seconds
    );
    CREATE TABLE entry (            -- the undo tree; 0 is its root
        id          INTEGER PRIMARY KEY,
        parent      INTEGER REFERENCES entry,
        next        INTEGER REFERENCES entry,  -- the child visited last
        label       TEXT NOT NULL,
        author      TEXT NOT NULL,
        time        TEXT NOT NULL,
        command     TEXT NOT NULL,  -- edits, JSON
        inverse     TEXT NOT NULL
    );
    CREATE TABLE run (
        id          INTEGER PRIMARY KEY,
        state       TEXT NOT NULL,  -- running, complete, stopped, interrupted
        reason      TEXT,           -- why it was stopped
        first_frame INTEGER NOT NULL,
        end_frame   INTEGER NOT NULL,
        seeds       TEXT NOT NULL,  -- ranges of tracks it began with, JSON
        provenance  TEXT NOT NULL   -- JSON
    );
    CREATE TABLE chunk (            -- frames x all tracks, while a run works
        id          INTEGER PRIMARY KEY,
        run         INTEGER NOT NULL REFERENCES run,
        data        BLOB NOT NULL
    );
    CREATE INDEX chunk_of_run ON chunk (run);
    CREATE TABLE span (             -- consecutive samples of a track, when a run has ended
        id          INTEGER PRIMARY KEY,
        run         INTEGER NOT NULL REFERENCES run,
        track       INTEGER NOT NULL,
        first_frame INTEGER NOT NULL,
        n_frames    INTEGER NOT NULL,
        data        BLOB NOT NULL
    );
    CREATE UNIQUE INDEX span_of_run ON span (run, track, first_frame, n_frames);
    CREATE TABLE clustering (
        id          INTEGER PRIMARY KEY,
        tracks      TEXT NOT NULL,  -- JSON, leaf k is the k-th
        merges      BLOB NOT NULL,  -- a u32, b u32, height f64, size u32
        cut         INTEGER NOT NULL,
        outliers    TEXT NOT NULL,  -- frames, JSON
        notes       TEXT NOT NULL,  -- JSON
        provenance  TEXT NOT NULL   -- JSON
    );
",
    "
    CREATE TABLE seat (             -- where each user was when they left
        user        TEXT PRIMARY KEY,
        state       TEXT NOT NULL,  -- JSON of the program's that wrote it
        time        TEXT NOT NULL
    );
",
    "
    CREATE TABLE seam (             -- where a plugin was started again in the middle of a run
        id          INTEGER PRIMARY KEY,
        run         INTEGER NOT NULL REFERENCES run,
        frame       INTEGER NOT NULL, -- the first that the new one tracked
        why         TEXT NOT NULL
    );
    CREATE INDEX seam_of_run ON seam (run);
",
    "
    ALTER TABLE seam ADD COLUMN plugin_version TEXT; -- of another build that goes on there; none: the same
    ALTER TABLE seam ADD COLUMN plugin_sha256 TEXT;  -- hash of its library
",
    "
    ALTER TABLE run ADD COLUMN request TEXT; -- JSON of the program's that ran it: what going on with it takes
",
    "
    CREATE TABLE matte (            -- of one frame; its planes are a byte a pixel, zlib
        id          INTEGER PRIMARY KEY,
        frame       INTEGER NOT NULL,
        width       INTEGER NOT NULL,
        height      INTEGER NOT NULL,
        parts       BLOB NOT NULL,  -- 0 outside, 1 inner background, 2 boundary, 3 trunk, 4 kept
        opacity     BLOB NOT NULL,  -- 0 background to 255 plant
        marks       BLOB NOT NULL,  -- 0 unknown, 1 background, 2 foreground
        provenance  TEXT NOT NULL   -- JSON
    );
",
    "
    CREATE TABLE space (            -- tracks in space: what two cameras see of one feature
        id          INTEGER PRIMARY KEY,
        tracks      TEXT NOT NULL,  -- left track, right track, number of fixes of each, JSON
        fixes       BLOB NOT NULL,  -- frame u32, place 3 f64 and its errors 3 f32, metres, residual f32, pixels
        provenance  TEXT NOT NULL   -- JSON
    );
",
    "
    CREATE TABLE step (             -- of the recipe that was followed last, as far as it was done
        id          INTEGER PRIMARY KEY, -- 0 is the clip itself, steps count from 1
        line        TEXT NOT NULL,  -- as on the command line, without the project
        made_of     TEXT NOT NULL,  -- hash of all that it came from, steps before it included
        before      INTEGER NOT NULL, -- revisions between which it worked
        after       INTEGER NOT NULL,
        inputs      TEXT NOT NULL,  -- files that it read, as they were seen, JSON
        outputs     TEXT NOT NULL,  -- files that it wrote, JSON
        answer      TEXT NOT NULL,  -- what it said, JSON
        seconds     REAL NOT NULL,
        time        TEXT NOT NULL
    );
",
];

/// The schema this program writes.
pub(crate) const SCHEMA: u32 = MIGRATIONS.len() as u32;

/// A connection to an existing or new database file.
pub(crate) fn connect(path: &Path, write: bool) -> Result<Connection, StoreError> {
    let opened = match open(path, OpenFlags::SQLITE_OPEN_READ_WRITE) {
        // A reader may lack the right to write; with it, it can roll a dead writer's journal back.
        Err(_) if !write => open(path, OpenFlags::SQLITE_OPEN_READ_ONLY),
        other => other,
    };
    let conn = opened.map_err(|error| match error.sqlite_error_code() {
        Some(ErrorCode::NotADatabase) => StoreError::NotAProject(path.to_owned()),
        _ => error.into(),
    })?;
    conn.pragma_update(None, "query_only", !write)?;
    Ok(conn)
}

fn open(path: &Path, access: OpenFlags) -> rusqlite::Result<Connection> {
    let conn = Connection::open_with_flags(path, access | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    conn.busy_timeout(BUSY_TIMEOUT)?;
    // EXTRA is FULL plus a sync of the folder after the journal is unlinked: without it a commit that was
    // acknowledged could be rolled back by a power cut.
    conn.pragma_update(None, "synchronous", "EXTRA")?;
    conn.pragma_update(None, "foreign_keys", true)?;
    conn.set_prepared_statement_cache_capacity(64);
    Ok(conn)
}

/// Makes a database in an empty file.
pub(crate) fn create(path: &Path) -> Result<Connection, StoreError> {
    let mut conn = open(path, OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE)?;
    conn.pragma_update(None, "application_id", APPLICATION_ID)?;
    migrate(&mut conn, 0)?;
    Ok(conn)
}

/// The schema of a project.
///
/// # Errors
/// [`StoreError::NotAProject`], or [`StoreError::Newer`] for a schema not known here.
pub(crate) fn version(conn: &Connection, path: &Path) -> Result<u32, StoreError> {
    let pragma = |name| conn.pragma_query_value(None, name, |row| row.get::<_, u32>(0));
    if pragma("application_id")? != APPLICATION_ID {
        return Err(StoreError::NotAProject(path.to_owned()));
    }
    let came = pragma("user_version")?;
    if came > SCHEMA {
        return Err(StoreError::Newer { came, known: SCHEMA, path: path.to_owned() });
    }
    Ok(came)
}

/// Brings an older project up to this schema; a session that only reads cannot.
pub(crate) fn bring_up(conn: &mut Connection, write: bool, path: &Path) -> Result<(), StoreError> {
    match version(conn, path)? {
        SCHEMA => Ok(()),
        came if write => migrate(conn, came),
        came => Err(StoreError::Older { came, known: SCHEMA, path: path.to_owned() }),
    }
}

fn migrate(conn: &mut Connection, from: u32) -> Result<(), StoreError> {
    let tx = conn.transaction_with_behavior(TransactionBehavior::Immediate)?;
    for step in &MIGRATIONS[from as usize..] {
        tx.execute_batch(step)?;
    }
    tx.pragma_update(None, "user_version", SCHEMA)?;
    Ok(tx.commit()?)
}

#[cfg(test)]
mod tests;
