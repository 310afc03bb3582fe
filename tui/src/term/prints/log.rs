//! The log file of a session: it is put aside when it has grown long, and another begins.

use std::fs::{self, File};
use std::io::{self, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};

use rustix::fs::OFlags;

/// A log that grows longer than this is put aside, bytes; the one that was put aside before is gone then.
pub(super) const LOG_MAX: u64 = 1 << 20;

/// A file that is appended to.
#[derive(Debug)]
pub(in crate::term) struct Log {
    file: File,
    path: PathBuf,
    n_bytes: u64,
}

impl Log {
    /// Opens a log here, or where that cannot be written one in the folder for temporary files, or none.
    pub(in crate::term) fn open_any(path: &Path) -> io::Result<Self> {
        let name = format!("honami-{}-session.log", rustix::process::getuid().as_raw());
        Self::open(path)
            .or_else(|_| Self::open(&std::env::temp_dir().join(name)))
            .or_else(|_| Self::open(Path::new("/dev/null")))
    }

    /// Opens a log for appending, its folder made where missing.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let open = || {
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder)?;
            }
            let file = append(path)?;
            let n_bytes = file.metadata()?.len();
            let mut log = Self { file, path: path.to_owned(), n_bytes };
            if log.n_bytes > LOG_MAX {
                log.put_aside()?;
            }
            Ok(log)
        };
        open().map_err(|error: io::Error| {
            io::Error::new(error.kind(), format!("the log {} cannot be written: {error}", path.display()))
        })
    }

    /// Writes what has come. A disk that is full keeps nobody from printing.
    pub(super) fn write(&mut self, bytes: &[u8]) {
        if self.n_bytes > LOG_MAX {
            // Where that cannot be done it goes on growing, and is put aside another time.
            self.put_aside().unwrap_or_default();
            self.n_bytes = 0;
        }
        self.n_bytes += self.file.write_all(bytes).map_or(0, |()| bytes.len() as u64);
    }

    /// Gives the file another name, so that whoever reads it or writes to it keeps it whole, and begins another.
    fn put_aside(&mut self) -> io::Result<()> {
        if self.file.metadata()?.is_file() {
            fs::rename(&self.path, aside(&self.path))?;
            self.file = append(&self.path)?;
            self.n_bytes = 0;
        }
        Ok(())
    }
}

/// What a log is called that was put aside: `session.log.1`.
pub(super) fn aside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".1");
    path.with_file_name(name)
}

/// No link: in a folder that others write to it might lead anywhere.
fn append(path: &Path) -> io::Result<File> {
    let no_link = OFlags::NOFOLLOW.bits().cast_signed();
    File::options().create(true).append(true).custom_flags(no_link).open(path)
}
