//! Plugins that are programs, in Python for one: a manifest beside them says what they are and how they are started.

use crate::error::HostError;
use crate::manifest::Manifest;
use crate::registry::{PluginInfo, Trust};
use crate::regular::{self, LIBRARY_BYTES_MAX, MANIFEST_BYTES_MAX};
use crate::store::{self, Stored};
use std::io;
use std::path::{Path, PathBuf};

/// What their manifests end with.
const ENDING: &str = ".honami.json";

/// What plugins in Python import; it is laid beside each.
const FOR_PYTHON: (&str, &str) = ("honami.py", crate::sdk::HONAMI_PY);

/// Whether a file is the manifest of a program.
pub(crate) fn is_manifest(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(ENDING))
}

/// The file that stands for a plugin of which a user names one: of `mine.py` it is its manifest, `mine.honami.json`.
#[must_use]
pub fn manifest_of(file: &Path) -> PathBuf {
    let is_script = file.extension().is_some_and(|extension| extension == "py");
    if is_script { file.with_extension(&ENDING[1..]) } else { file.to_owned() }
}

/// A manifest, and its bytes.
///
/// # Errors
/// When it cannot be read or is broken.
pub(crate) fn read(path: &Path) -> Result<(Manifest, Vec<u8>), HostError> {
    let file_error = |why: String| HostError::File { path: path.to_owned(), why };
    let json = regular::read(path, MANIFEST_BYTES_MAX).map_err(|e| {
        file_error(format!("cannot be read: {e}; `python3 {}.py --honami-manifest` writes it", stem(path)))
    })?;
    let manifest = Manifest::parse(&json).map_err(file_error)?;
    if manifest.exec.is_empty() {
        return Err(file_error("its manifest does not say how it is started (exec)".into()));
    }
    let is_own = |word: &String| Path::new(word).components().count() == 1 && word != FOR_PYTHON.0;
    if let Some(word) = manifest.exec.iter().skip(1).find(|word| !word.starts_with('-') && !is_own(word)) {
        return Err(file_error(format!(
            "is started with {word:?}: wanted a file beside it, by its name alone"
        )));
    }
    Ok((manifest, json))
}

fn stem(path: &Path) -> String {
    path.to_string_lossy().trim_end_matches(ENDING).to_owned()
}

/// A manifest and the program's own files, which lie beside it.
pub(crate) fn parts(manifest: &Path) -> Vec<PathBuf> {
    let json = regular::read(manifest, MANIFEST_BYTES_MAX).ok();
    let exec = json.and_then(|json| Manifest::parse(&json).ok()).map(|m| m.exec);
    with_own(manifest, &exec.unwrap_or_default())
}

/// A file of a plugin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Where it lies.
    pub path: PathBuf,
    /// How long it is.
    pub n_bytes: usize,
    /// Of its content, lower-case hexadecimal.
    pub sha256: String,
}

/// All files that a plugin's hash is of: a library, or a manifest and its program's own files. Only these are there when it
/// runs, and what the SDK lays beside them.
///
/// # Errors
/// When one of them cannot be read.
pub fn parts_of(library: &Path) -> Result<Vec<Part>, HostError> {
    let paths = if is_manifest(library) { parts(library) } else { vec![library.to_owned()] };
    let part = |path: PathBuf| {
        let bytes = store::read(&path)?;
        Ok(Part { n_bytes: bytes.len(), sha256: store::hex(&bytes), path })
    };
    paths.into_iter().map(part).collect()
}

fn with_own(manifest: &Path, exec: &[String]) -> Vec<PathBuf> {
    let folder = manifest.parent().unwrap_or(Path::new("."));
    let own = exec.iter().map(|word| folder.join(word)).filter(|path| path.is_file());
    std::iter::once(manifest.to_owned()).chain(own).collect()
}

/// Copies of a trusted program's files in a folder of the store, and what they import beside them.
///
/// # Errors
/// When it is not trusted, has another manifest than it had, or cannot be copied.
pub(crate) fn keep(info: &PluginInfo, store: &Path) -> Result<Stored, HostError> {
    let file_error = |why: String| HostError::File { path: info.library.clone(), why };
    if let Trust::No(why) = &info.trust {
        return Err(HostError::NotTrusted { path: info.library.clone(), why: why.clone() });
    }
    // Those of the manifest that was scanned; that it is still the same is seen below.
    let parts = with_own(&info.library, &info.exec);
    let contents: Vec<Vec<u8>> = parts
        .iter()
        .map(|part| {
            regular::read(part, LIBRARY_BYTES_MAX).map_err(|e| file_error(format!("cannot be read: {e}")))
        })
        .collect::<Result<_, _>>()?;
    let sha256 = store::hex_of_parts(&contents);
    if contents.first().is_none_or(|json| **json != *info.manifest) {
        let why = "was written anew with another manifest since honami looked at it: start honami again";
        return Err(file_error(why.into()));
    }
    if let Trust::Allowed { sha256: allowed } = &info.trust
        && *allowed != sha256
    {
        let why = "it has changed since you allowed it".into();
        return Err(HostError::NotTrusted { path: info.library.clone(), why });
    }
    let folder = folder_in(store, &sha256);
    store::make_room(store, &folder);
    let copied = || -> io::Result<()> {
        let named = parts
            .iter()
            .filter_map(|part| part.file_name())
            .map(Path::new)
            .zip(contents.iter().map(Vec::as_slice));
        for (name, bytes) in named.chain([(Path::new(FOR_PYTHON.0), FOR_PYTHON.1.as_bytes())]) {
            store::keep_bytes(&folder, &folder.join(name), bytes)?;
        }
        store::still_used(&folder);
        Ok(())
    };
    copied().map_err(|e| file_error(format!("cannot be copied to {}: {e}", folder.display())))?;
    Ok(Stored { path: folder, sha256 })
}

fn folder_in(store: &Path, sha256: &str) -> PathBuf {
    store.join(format!("{sha256}.program"))
}

/// The copy of a program's manifest, its files beside it, once it has been started.
pub(crate) fn copy_of(store: &Path, sha256: &str, manifest: &Path) -> PathBuf {
    folder_in(store, sha256).join(manifest.file_name().unwrap_or_default())
}
