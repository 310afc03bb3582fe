//! Which third parties' libraries may be loaded: those whose content a person has allowed, and those of the lab.
//!
//! A file is allowed by its path and its content, as direnv does it: one that has changed is a new question. Naming a
//! file on the command line allows it for that run. Nobody else may be able to change what is allowed: the file and all
//! folders above it belong to this user or to root, and only they may write them.

use crate::error::HostError;
use crate::registry::Trust;
use crate::script;
use crate::store::{self, Identity};
use rustix::process::geteuid;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// What a lab trusts, for everybody on the machine.
const OF_THE_LAB: &str = "/etc/honami/trust.toml";

/// What a person has said of libraries, and what their lab says.
#[derive(Clone, Debug, Default)]
pub struct TrustBook {
    /// A file a library.
    folder: Option<PathBuf>,
    lab: Lab,
    /// Why what the lab says does not count.
    broken: Option<String>,
}

/// The lab's file: contents, and folders whose libraries are trusted while root alone may write them.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Lab {
    sha256: Vec<String>,
    folders: Vec<PathBuf>,
}

/// What a person has said of the library at a path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Entry {
    path: PathBuf,
    /// Of the content that was allowed; none: it is denied, whatever its content.
    sha256: Option<String>,
    /// The file as it was then: while it is this, its content need not be read.
    identity: Identity,
    /// Seconds since 1970.
    said: u64,
}

impl Lab {
    /// What the file says; nothing where there is none.
    fn read(file: &Path) -> Result<Self, String> {
        let text = match fs::read_to_string(file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            text => text.map_err(|error| format!("cannot be read: {error}"))?,
        };
        only_root_writes(file)?;
        toml::from_str(&text).map_err(|error| format!("is broken: {}", error.to_string().trim_end()))
    }
}

impl TrustBook {
    /// That of this user, `$XDG_DATA_HOME/honami/trust`, and of this machine's lab.
    #[must_use]
    pub fn of_user() -> Self {
        let absolute = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let data =
            absolute("XDG_DATA_HOME").or_else(|| absolute("HOME").map(|home| home.join(".local/share")));
        let folder = data.map(|data| data.join("honami/trust"));
        let (lab, broken) = match Lab::read(Path::new(OF_THE_LAB)) {
            Ok(lab) => (lab, None),
            Err(why) => (Lab::default(), Some(why)),
        };
        Self { folder, lab, broken }
    }

    /// That what the lab says cannot be read, if it says something: none of it counts then.
    pub(crate) fn problem(&self) -> Option<HostError> {
        let why = self.broken.as_ref()?;
        let why = format!("{why}; until that is mended nothing is trusted for the lab's sake");
        Some(HostError::File { path: OF_THE_LAB.into(), why })
    }

    /// With a folder of the caller's.
    #[must_use]
    pub fn in_folder(folder: PathBuf) -> Self {
        Self { folder: Some(folder), ..Self::default() }
    }

    /// Whether a library that a third party has installed may be loaded.
    pub(crate) fn of(&self, library: &Path) -> Trust {
        let entry = self.entry(library);
        if entry.as_ref().is_some_and(|entry| entry.sha256.is_none()) {
            return denied(library);
        }
        let by_the_lab = || {
            self.lab
                .folders
                .iter()
                .any(|folder| library.starts_with(folder) && all_parts(library, only_root_writes).is_ok())
        };
        if by_the_lab() {
            return Trust::Lab;
        }
        if !self.lab.sha256.is_empty()
            && store::sha256_of(library).is_ok_and(|sha256| self.lab.sha256.contains(&sha256))
        {
            return Trust::Lab;
        }
        let Some(Entry { sha256: Some(sha256), identity, .. }) = entry else {
            return Trust::No(format!(
                "it is a third party's; `honami plugin allow {}` if you trust it, or name it with --plugin for once",
                library.display()
            ));
        };
        if let Err(why) = all_parts(library, only_user_writes) {
            return Trust::No(why);
        }
        let is_same = store::identity(library).is_ok_and(|now| now == identity)
            || store::sha256_of(library).is_ok_and(|now| now == sha256);
        if is_same {
            return Trust::Allowed { sha256 };
        }
        Trust::No(format!(
            "it has changed since you allowed it; `honami plugin allow {}` if you know why",
            library.display()
        ))
    }

    /// Whether a library may be loaded that the user names: unless it was denied.
    pub(crate) fn of_named(&self, library: &Path) -> Trust {
        self.unless_denied(library, Trust::Named)
    }

    /// Whether a library may be loaded that came with this honami: unless it was denied.
    pub(crate) fn of_shipped(&self, library: &Path) -> Trust {
        self.unless_denied(library, Trust::Shipped)
    }

    fn unless_denied(&self, library: &Path, trust: Trust) -> Trust {
        let is_denied = self.entry(library).is_some_and(|entry| entry.sha256.is_none());
        if is_denied { denied(library) } else { trust }
    }

    /// Whether a library in the user's own build tree may be loaded: unless it was denied, or others may write it.
    pub(crate) fn of_dev(&self, library: &Path) -> Trust {
        match (self.of_named(library), all_parts(library, only_user_writes)) {
            (Trust::Named, Ok(())) => Trust::Dev,
            (Trust::Named, Err(why)) => Trust::No(why),
            (trust, _) => trust,
        }
    }

    /// Allows a library as it is now; its hash.
    ///
    /// # Errors
    /// [`HostError::NotTrusted`] when others could change it, [`HostError::File`] when it cannot be read or the answer
    /// not be kept.
    pub fn allow(&self, library: &Path) -> Result<String, HostError> {
        let refused = |why| HostError::NotTrusted { path: library.to_owned(), why };
        all_parts(library, only_user_writes).map_err(refused)?;
        let sha256 = store::sha256_of(library)?;
        self.keep(library, Some(sha256.clone()))?;
        Ok(sha256)
    }

    /// Denies a library, whatever its content.
    ///
    /// # Errors
    /// [`HostError::File`] when it is not there or the answer cannot be kept.
    pub fn deny(&self, library: &Path) -> Result<(), HostError> {
        self.keep(library, None)
    }

    fn keep(&self, library: &Path, sha256: Option<String>) -> Result<(), HostError> {
        let said = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
        let kept = || -> io::Result<()> {
            let path = library.canonicalize()?;
            let file = self
                .file(&path)
                .ok_or_else(|| io::Error::other("there is no home folder to keep that in"))?;
            let entry = Entry { identity: store::identity(&path)?, path, sha256, said };
            let folder = file.parent().unwrap_or(Path::new("."));
            fs::create_dir_all(folder)?;
            fs::set_permissions(folder, fs::Permissions::from_mode(0o700))?;
            let part = file.with_extension("part");
            fs::write(&part, serde_json::to_vec(&entry)?)?;
            fs::rename(&part, &file)
        };
        kept().map_err(|error| HostError::File { path: library.to_owned(), why: error.to_string() })
    }

    fn entry(&self, library: &Path) -> Option<Entry> {
        let path = library.canonicalize().ok()?;
        let entry: Entry = serde_json::from_slice(&fs::read(self.file(&path)?).ok()?).ok()?;
        (entry.path == path).then_some(entry)
    }

    fn file(&self, path: &Path) -> Option<PathBuf> {
        let name = store::hex(path.as_os_str().as_encoded_bytes());
        self.folder.as_ref().map(|folder| folder.join(format!("{name}.json")))
    }
}

fn denied(library: &Path) -> Trust {
    Trust::No(format!("it was denied; `honami plugin allow {}` allows it", library.display()))
}

/// Holds a library, or a manifest and the files of its program, against a rule.
fn all_parts(library: &Path, rule: fn(&Path) -> Result<(), String>) -> Result<(), String> {
    if !script::is_manifest(library) {
        return rule(library);
    }
    script::parts(library).iter().try_for_each(|part| rule(part))
}

fn only_user_writes(path: &Path) -> Result<(), String> {
    only_owner_writes(path, geteuid().as_raw())
}

fn only_root_writes(path: &Path) -> Result<(), String> {
    only_owner_writes(path, 0)
}

/// Whether only root and this user may write a file and the folders above it; else what to do about it.
fn only_owner_writes(path: &Path, user: u32) -> Result<(), String> {
    let told = |error: io::Error| format!("{}: {error}", path.display());
    let link = fs::symlink_metadata(path).map_err(told)?;
    if !link.is_file() {
        return Err(format!(
            "{} is no file but a link or something else: name the file itself",
            path.display()
        ));
    }
    let path = path.canonicalize().map_err(told)?;
    path.ancestors().try_for_each(|place| only_writes(place, &[0, user]))
}

/// Whether a file or folder belongs to one of these users, and they alone may write it; else what to do about it. The
/// last of them may have a group of their own.
pub(crate) fn only_writes(place: &Path, users: &[u32]) -> Result<(), String> {
    let meta = fs::metadata(place).map_err(|error| format!("{}: {error}", place.display()))?;
    if !users.contains(&meta.uid()) {
        return Err(format!(
            "{} belongs to another user: chown it, or copy the plugin elsewhere",
            place.display()
        ));
    }
    // In a folder with the sticky bit nobody can take away what is another's.
    let is_shared = meta.is_dir() && meta.mode() & 0o1000 != 0;
    // Where every user has a group of their own (number as the user's), its members are that user.
    let by_group = meta.mode() & 0o020 != 0 && users.last() != Some(&meta.gid());
    if (meta.mode() & 0o002 != 0 || by_group) && !is_shared {
        return Err(format!("others may write it: chmod go-w {}", place.display()));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
