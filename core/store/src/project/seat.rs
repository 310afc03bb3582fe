//! Where each user was when they left: not part of the work, never undone, and lost without harm.

use rusqlite::{OptionalExtension as _, params};

use super::Project;
use crate::error::StoreError;
use crate::lock::user_name;

impl Project {
    /// What this user has left with [`set_seat`](Self::set_seat) the last time; `None`: nothing yet, or nobody
    /// knows who the user is.
    ///
    /// # Errors
    /// What SQLite met.
    pub fn seat(&self) -> Result<Option<String>, StoreError> {
        let Some(user) = self.lock.as_ref().map(|lock| lock.holder.user.clone()).or_else(user_name) else {
            return Ok(None);
        };
        let sql = "SELECT state FROM seat WHERE user = ?1";
        Ok(self.conn.query_row(sql, [user], |row| row.get(0)).optional()?)
    }

    /// Keeps where this user is; `state` is whatever the program likes to find again.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`], or what SQLite met.
    pub fn set_seat(&mut self, state: &str) -> Result<(), StoreError> {
        let user = self.lock()?.holder.user.clone();
        let sql = "INSERT OR REPLACE INTO seat VALUES (?1, ?2, ?3)";
        self.writer()?.execute(sql, params![user, state, crate::now()])?;
        Ok(())
    }
}
