//! Logs on the disk: one that grows with the session, and one that is saved at once.

use std::ffi::OsString;
use std::fs::{File, Permissions};
use std::io::{self, ErrorKind, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use super::{CommandLog, json};

/// A log that is written while the session goes on.
pub(in crate::app) struct LogFile {
    file: File,
    path: PathBuf,
    /// Lines written, the first one aside; `None` before that is.
    n_written: Option<u64>,
}

impl LogFile {
    /// A new file.
    pub(in crate::app) fn create(path: &Path) -> io::Result<Self> {
        Ok(Self { file: File::create_new(path)?, path: path.to_owned(), n_written: None })
    }

    /// Writes the lines that are new, at once.
    pub(in crate::app) fn write(&mut self, log: &CommandLog) -> Result<(), String> {
        if self.n_written == Some(log.n()) {
            return Ok(());
        }
        let mut text = if self.n_written.is_none() { json(&log.head) } else { String::new() };
        log.since(self.n_written.unwrap_or(0)).for_each(|line| text += &json(line));
        self.n_written = Some(log.n());
        let written = self.file.write_all(text.as_bytes());
        written.map_err(|error| format!("the log {} ends here: {error}", self.path.display()))
    }
}

/// Saves a log beside a project as `NAME.log.jsonl`, whole or not at all; where there is one, as `NAME-2.log.jsonl`
/// and so on. Returns where.
pub(in crate::app) fn save(text: &str, project: &Path) -> io::Result<PathBuf> {
    let folder = project.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // As other new files are, not as secret as temporary ones.
    let mut file = tempfile::Builder::new().permissions(Permissions::from_mode(0o666)).tempfile_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    for number in 1_u32.. {
        let mut name = OsString::from(project.file_stem().unwrap_or_default());
        if number > 1 {
            name.push(format!("-{number}"));
        }
        name.push(".log.jsonl");
        let path = project.with_file_name(name);
        match file.persist_noclobber(&path) {
            Ok(_) => return Ok(path),
            Err(failed) if failed.error.kind() == ErrorKind::AlreadyExists => file = failed.file,
            Err(failed) => return Err(failed.error),
        }
    }
    Err(ErrorKind::AlreadyExists.into())
}
