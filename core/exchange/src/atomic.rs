//! Files that are whole or not there: written beside their place, and renamed when complete.

#[cfg(test)]
mod tests;

use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::table::TableError;

/// A file being written; it takes its name in [`finish`](Self::finish) and leaves nothing behind before that.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    /// Where that is, links followed.
    place: PathBuf,
    file: BufWriter<tempfile::NamedTempFile>,
}

impl AtomicFile {
    /// Starts the file `path`, or that to which it is a link.
    ///
    /// # Errors
    /// [`TableError::File`] when the folder cannot be written to, [`TableError::Precious`] when a project, a clip or a
    /// library stands there, or what is no file, such as a device: nobody means to lose it.
    pub fn create(path: &Path) -> Result<Self, TableError> {
        if let Some(what) = precious(path) {
            return Err(TableError::Precious { path: path.into(), what });
        }
        let place = std::fs::canonicalize(path).unwrap_or_else(|_none| path.to_owned());
        let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the umask
        // Its error names the temporary file, which nobody asked for: what the system said is enough.
        let plain = |e: std::io::Error| {
            let missing =
                || std::io::Error::new(e.kind(), format!("there is no folder {}", folder.display()));
            let source = if folder.exists() { e.kind().into() } else { missing() };
            TableError::File { path: path.into(), source }
        };
        let file = builder.prefix(".honami-").suffix(".part").tempfile_in(folder).map_err(plain)?;
        Ok(Self { path: path.into(), place: place.clone(), file: BufWriter::with_capacity(1 << 16, file) })
    }

    /// The name it will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the whole file on the disk under its name, over what stood there.
    ///
    /// # Errors
    /// [`TableError::File`] on a full disk; what stood there before then still does.
    pub fn finish(self) -> Result<(), TableError> {
        let Self { path, place, file } = self;
        file.into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(|file| {
                file.as_file().sync_all()?;
                file.persist(&place).map_err(|failed| failed.error)
            })
            .map_err(|source| TableError::File { path: path.clone(), source })?;
        Ok(())
    }
}

/// What a file is that no table may take the place of, by its first bytes.
fn precious(path: &Path) -> Option<&'static str> {
    const KNOWN: [(usize, &[u8], &str); 9] = [
        (0, b"SQLite format 3", "a project"),
        (0, b"YUV4MPEG2", "a clip"),
        (4, b"ftyp", "a video"),
        (0, &[0x1A, 0x45, 0xDF, 0xA3], "a video"),
        (0, b"RIFF", "a video"),
        (0, b"\x89PNG", "a picture"),
        (0, &[0xFF, 0xD8, 0xFF], "a picture"),
        (0, b"II*\0", "a picture"),
        (0, b"\x7FELF", "a library"),
    ];
    match std::fs::metadata(path).map(|there| there.file_type()) {
        Ok(kind) if kind.is_dir() => return Some("a folder"),
        // Its place would be taken by a file.
        Ok(kind) if !kind.is_file() => return Some("a device or a pipe"),
        _ => {}
    }
    let mut head = [0; 16];
    // What cannot be read is told when it is written.
    let n =
        std::fs::File::open(path).and_then(|mut file| std::io::Read::read(&mut file, &mut head)).unwrap_or(0);
    let is_it = |(at, magic, _): &&(usize, &[u8], &str)| {
        head[..n].get(*at..).is_some_and(|rest| rest.starts_with(magic))
    };
    KNOWN.iter().find(is_it).map(|(.., what)| *what)
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}
