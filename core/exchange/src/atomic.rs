//! Files that are whole or not there: written beside their place, and renamed when complete.

#[cfg(test)]
mod tests;

use std::ffi::OsStr;
use std::io::{BufWriter, Read as _, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::table::TableError;
use honami_model::unfinished::Unfinished;

/// So many bytes tell what a file is.
const HEAD: u64 = 4096;

/// How the name begins and ends that a file has while it is written; what is between differs.
const PART: (&str, &str) = (".honami-", ".part");

/// A file being written; it takes its name in [`finish`](Self::finish) and leaves nothing behind before that.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    /// Where that is, links followed.
    place: PathBuf,
    file: BufWriter<tempfile::NamedTempFile>,
    unfinished: Unfinished,
}

impl AtomicFile {
    /// Starts the file `path`, or that to which it is a link, in place of one that is alike by its first bytes, or empty.
    ///
    /// # Errors
    /// [`TableError::File`] when the folder cannot be written to, [`TableError::Precious`] when a project, a clip or a
    /// library stands there, or what is no file, such as a device, [`TableError::Unlike`] for any other file that would not
    /// have been written so: nobody means to lose it.
    pub fn create(path: &Path, is_alike: impl FnOnce(&[u8]) -> bool) -> Result<Self, TableError> {
        Self::check(path, is_alike)?;
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
        builder.prefix(PART.0).suffix(PART.1);
        let begun = Unfinished::begin(|| {
            builder.tempfile_in(folder).map(|file| {
                let name = file.path().to_owned();
                (file, name)
            })
        });
        let (file, unfinished) = begun.map_err(plain)?;
        let file = BufWriter::with_capacity(1 << 16, file);
        Ok(Self { path: path.into(), place: place.clone(), file, unfinished })
    }

    /// Whether what stands at `path` would give way, if anything does.
    ///
    /// # Errors
    /// [`TableError::Precious`] and [`TableError::Unlike`], as [`create`](Self::create).
    pub fn check(path: &Path, is_alike: impl FnOnce(&[u8]) -> bool) -> Result<(), TableError> {
        let head = head(path);
        if let Some(what) = precious(path, &head) {
            return Err(TableError::Precious { path: path.into(), what });
        }
        if !(head.is_empty() || is_alike(&head)) {
            return Err(TableError::Unlike { path: path.into() });
        }
        Ok(())
    }

    /// Whether a file of this name is one that is being written, or whose writer was killed.
    #[must_use]
    pub fn is_part(name: &OsStr) -> bool {
        name.to_str().is_some_and(|name| name.starts_with(PART.0) && name.ends_with(PART.1))
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
        let Self { path, place, file, unfinished } = self;
        file.into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(|file| {
                file.as_file().sync_all()?;
                unfinished.settle(|_name| file.persist(&place)).map_err(|failed| failed.error)
            })
            .map_err(|source| TableError::File { path: path.clone(), source })?;
        Ok(())
    }
}

/// Whether a file is of the kind of a text: they begin with the same two words, or are tables with the same columns.
#[must_use]
pub fn is_begun_alike(head: &[u8], text: &str) -> bool {
    let head = String::from_utf8_lossy(head);
    // The heads of a table's columns may be one word, and what follows are numbers.
    let first = text.lines().next().filter(|line| line.contains(','));
    let is_table = first.is_some_and(|line| head.lines().next() == Some(line));
    is_table || head.split_whitespace().take(2).eq(text.split_whitespace().take(2))
}

/// The first bytes of a file; none where there is none. What cannot be read is told when it is written.
fn head(path: &Path) -> Vec<u8> {
    let mut head = Vec::new();
    if path.is_file() {
        let read = std::fs::File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
        read.unwrap_or_default();
    }
    head
}

/// What a file is that nothing may take the place of, by its first bytes.
fn precious(path: &Path, head: &[u8]) -> Option<&'static str> {
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
    let is_it =
        |(at, magic, _): &&(usize, &[u8], &str)| head.get(*at..).is_some_and(|rest| rest.starts_with(magic));
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
