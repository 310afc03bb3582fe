//! Files that are whole or not there: written beside their place, and renamed when complete.

use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::table::TableError;

/// A file being written; it takes its name in [`finish`](Self::finish) and leaves nothing behind before that.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    file: BufWriter<tempfile::NamedTempFile>,
}

impl AtomicFile {
    /// Starts the file `path`.
    ///
    /// # Errors
    /// [`TableError::File`] when the folder cannot be written to.
    pub fn create(path: &Path) -> Result<Self, TableError> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
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
        Ok(Self { path: path.into(), file: BufWriter::with_capacity(1 << 16, file) })
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
        let Self { path, file } = self;
        file.into_inner()
            .map_err(std::io::IntoInnerError::into_error)
            .and_then(|file| {
                file.as_file().sync_all()?;
                file.persist(&path).map_err(|failed| failed.error)
            })
            .map_err(|source| TableError::File { path: path.clone(), source })?;
        Ok(())
    }
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
