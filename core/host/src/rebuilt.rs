//! Plugins that are built again while honami is at work: their files watched, read anew, and the former builds kept.

use crate::error::HostError;
use crate::host::{Host, Hosting, Origin};
use crate::registry::{PluginInfo, Registry, Trust};
use crate::script;
use crate::store::{self, Identity};
use crate::trust::TrustBook;
use crate::values::Values;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// A linker writes a file in pieces: one that has not been written for so long is whole.
const WHOLE_AFTER: Duration = Duration::from_millis(300);

/// Looks whether a plugin's file is another one, by its name: linkers and editors put a new file in the old one's place.
///
/// It asks the file system each time, for what tells of changes by itself does not do so where a folder lies on another
/// machine.
#[derive(Debug)]
pub struct Watch {
    file: PathBuf,
    /// As it was taken last.
    taken: Option<Identity>,
    /// As it was seen last, and since when it has been that.
    seen: Option<(Identity, Instant)>,
}

impl Watch {
    /// Watches the file of a plugin, and where that is a program all its files. What is there at the first look counts as
    /// another file: only its content tells whether it is the one that was loaded.
    #[must_use]
    pub fn of(plugin: &PluginInfo) -> Self {
        Self { file: plugin.library.clone(), taken: None, seen: None }
    }

    /// Takes the file as it is now for the one that is known.
    pub fn know(&mut self) {
        self.taken = store::identity(&self.file).ok();
    }

    /// Whether there is another file now than the one that was taken last, and it is whole: nobody has written it for
    /// 300 ms, by its own date or since it was seen first. That one is taken then. A file that is not there is no other.
    pub fn look(&mut self, now: Instant) -> bool {
        let Some(identity) =
            store::identity(&self.file).ok().filter(|found| Some(found) != self.taken.as_ref())
        else {
            self.seen = None;
            return false;
        };
        let since = match self.seen {
            Some((seen, since)) if seen == identity => since,
            _ => now,
        };
        self.seen = Some((identity, since));
        let is_whole = now.duration_since(since) >= WHOLE_AFTER || is_old(&self.file);
        if is_whole {
            self.taken = Some(identity);
            self.seen = None;
        }
        is_whole
    }
}

/// Whether a file was written long enough ago, by the clock of whoever keeps it. Where that goes wrong, half a file is
/// taken, which is no plugin, and the whole one is another.
fn is_old(file: &Path) -> bool {
    let parts = if script::is_manifest(file) { script::parts(file) } else { vec![file.to_owned()] };
    parts.iter().all(|part| {
        let written = std::fs::metadata(part).and_then(|meta| meta.modified());
        let age = written.ok().and_then(|written| SystemTime::now().duration_since(written).ok());
        age.is_some_and(|age| age >= WHOLE_AFTER)
    })
}

impl PluginInfo {
    /// The same plugin as its file is now. What was named stays trusted, and so does what lies in one's own build tree;
    /// what was allowed is so no more when its content has changed.
    ///
    /// # Errors
    /// [`HostError`], when the file is no plugin library any more, holds others, or is not trusted.
    pub fn again(&self) -> Result<Self, HostError> {
        let book = TrustBook::of_user();
        let trust = match &self.trust {
            Trust::Shipped => Trust::Shipped,
            Trust::Named => book.of_named(&self.library),
            Trust::Dev => book.of_dev(&self.library),
            Trust::Allowed { .. } | Trust::Lab | Trust::No(_) => book.of(&self.library),
        };
        if let Trust::No(why) = trust {
            return Err(HostError::NotTrusted { path: self.library.clone(), why });
        }
        let registry = Registry::of_file(&self.library, trust);
        let ids: Vec<&str> = registry.plugins().iter().map(|plugin| plugin.id.as_str()).collect();
        let holds = match ids.as_slice() {
            [] => "holds no plugin any more".to_owned(),
            ids => format!("holds {} now, and {} {} no more", ids.join(", "), self.kind, self.id),
        };
        let found = registry.plugins().iter().find(|plugin| plugin.id == self.id && plugin.kind == self.kind);
        match (found.cloned(), registry.into_problems().into_iter().next()) {
            (Some(plugin), _) => Ok(plugin),
            (None, Some(problem)) => Err(problem),
            (None, None) => Err(HostError::File { path: self.library.clone(), why: holds }),
        }
    }

    /// The values that a plugin of another build worked with, as this one takes them: what it does not know them by are
    /// its own defaults.
    ///
    /// # Errors
    /// [`HostError`] for the first that it has no more, or takes otherwise.
    pub fn values_of(&self, before: &Self, values: &Values) -> Result<Values, HostError> {
        let mut used = Values::defaults(&before.params);
        used.restore(values, &before.renamed);
        let mut taken = Values::defaults(&self.params);
        for param in &before.params {
            let id = self.renamed.get(&param.id).unwrap_or(&param.id);
            if let Some(value) = used.get(&param.id) {
                taken.set(&self.params, id, value.clone())?;
            }
        }
        Ok(taken)
    }
}

impl Host {
    /// Whether a plugin works in a process of its own; only such a one can make way for another build.
    #[must_use]
    pub fn works_apart(&self, plugin: &PluginInfo) -> bool {
        self.hosting_of(plugin) != Hosting::InProcess
    }

    /// A plugin as it was loaded, whatever has become of its file: the copy in the store.
    #[must_use]
    pub fn kept(&self, plugin: &PluginInfo, origin: &Origin) -> PluginInfo {
        let folder = self.store();
        let library = if plugin.exec.is_empty() {
            store::copy_of(folder, &origin.plugin_sha256)
        } else {
            script::copy_of(folder, &origin.plugin_sha256, &plugin.library)
        };
        PluginInfo { library, ..plugin.clone() }
    }
}

#[cfg(test)]
mod tests;
