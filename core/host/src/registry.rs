//! Finds plugin libraries along the search path and says what is in them, and whether they may be loaded.

use crate::error::HostError;
use crate::manifest::{Caps, Kind, Manifest, Needs, Param};
use crate::trust::TrustBook;
use crate::{note, script, store, trust};
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

mod dev;

/// Where plugins are looked for; the first of two with the same id wins.
#[derive(Clone, Debug, Default)]
pub struct SearchPath {
    /// Files and folders that the user named: `--plugin`, then `$HONAMI_PLUGIN_PATH`. Trusted.
    pub named: Vec<PathBuf>,
    /// The executable. Plugins beside it, or in `../lib/honami/plugins`, are the shipped ones.
    pub executable: Option<PathBuf>,
    /// Folders of third parties' plugins.
    pub installed: Vec<PathBuf>,
    /// One's own build trees: `--dev`, then `$HONAMI_DEV`. What is built there is found, and trusted for this session, as
    /// long as only this user or root may write it.
    pub dev: Vec<PathBuf>,
    /// Which of them may be loaded.
    pub book: TrustBook,
}

impl SearchPath {
    /// The search path of this process, with the `--plugin` arguments first.
    #[must_use]
    pub fn of_process(extra: &[PathBuf]) -> Self {
        let listed = |name| {
            let paths = std::env::var_os(name).unwrap_or_default();
            std::env::split_paths(&paths).filter(|path| !path.as_os_str().is_empty()).collect::<Vec<_>>()
        };
        let named = [extra.to_vec(), listed("HONAMI_PLUGIN_PATH")].concat();
        let absolute = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let data =
            absolute("XDG_DATA_HOME").or_else(|| absolute("HOME").map(|home| home.join(".local/share")));
        let installed = data
            .into_iter()
            .map(|data| data.join("honami/plugins"))
            .chain(["/usr/local/lib/honami/plugins", "/usr/lib/honami/plugins"].map(PathBuf::from))
            .collect();
        let executable = std::env::current_exe().ok().and_then(|path| path.canonicalize().ok());
        Self { named, dev: listed("HONAMI_DEV"), executable, installed, book: TrustBook::of_user() }
    }

    /// Where it looks, in order.
    #[must_use]
    pub fn places(&self) -> Vec<PathBuf> {
        let beside = self.executable.as_deref().and_then(Path::parent);
        let beside = beside.map(|folder| [folder.to_owned(), folder.join("../lib/honami/plugins")]);
        let known = [&self.named, &self.dev].into_iter().flatten().cloned();
        known.chain(beside.into_iter().flatten()).chain(self.installed.iter().cloned()).collect()
    }

    /// With these build trees before the others.
    #[must_use]
    pub fn with_dev(mut self, trees: &[PathBuf]) -> Self {
        self.dev.splice(0..0, trees.iter().cloned());
        self
    }
}

/// Whether a plugin may be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Came with this honami.
    Shipped,
    /// The user named it.
    Named,
    /// It lies in the user's own build tree, for as long as this honami runs.
    Dev,
    /// A person has allowed this content.
    Allowed {
        /// Of the content, lower-case hexadecimal.
        sha256: String,
    },
    /// The lab trusts it.
    Lab,
    /// Nobody has vouched for it; says what to do.
    No(String),
}

/// A plugin as its manifest describes it. None of its code has run.
#[derive(Clone, Debug)]
pub struct PluginInfo {
    /// Full id.
    pub id: String,
    /// Last component of the id.
    pub short_name: String,
    /// What it does.
    pub kind: Kind,
    /// For people.
    pub name: String,
    /// Markdown.
    pub doc: String,
    /// Where the method comes from.
    pub cite: Vec<String>,
    /// Of its library.
    pub version: String,
    /// Of its library, SPDX.
    pub license: String,
    /// ABI that it was built for.
    pub abi: (u32, u32),
    /// Id of its library.
    pub library_id: String,
    /// The library's file.
    pub library: PathBuf,
    /// Whether it may be loaded.
    pub trust: Trust,
    /// Interface ids.
    pub interfaces: Vec<String>,
    /// Abilities.
    pub caps: Caps,
    /// The form that a user fills in.
    pub params: Vec<Param>,
    /// New ids of renamed parameters.
    pub renamed: BTreeMap<String, String>,
    /// What it must have beside what every plugin has.
    pub needs: Needs,
    /// How its program is started, where it is one and no library.
    pub(crate) exec: Vec<String>,
    /// What all of this was read from, to tell whether the library is still the same when it is loaded.
    pub(crate) manifest: Arc<[u8]>,
}

impl PluginInfo {
    /// Whether it has an interface, as `honami.detect/1`.
    #[must_use]
    pub fn offers(&self, interface: &str) -> bool {
        self.interfaces.iter().any(|id| id == interface)
    }

    /// Whether it is a program, which always has a process of its own, and no library.
    #[must_use]
    pub fn is_program(&self) -> bool {
        !self.exec.is_empty()
    }

    /// The manifest that all of this was read from, JSON.
    #[must_use]
    pub fn manifest(&self) -> &[u8] {
        &self.manifest
    }

    /// How its program is started, its own files by name; empty for a library.
    #[must_use]
    pub fn exec(&self) -> &[String] {
        &self.exec
    }

    /// What tells its file from one that was touched since: two that are alike have the same content.
    ///
    /// # Errors
    /// When the file cannot be examined.
    pub fn stamp(&self) -> std::io::Result<String> {
        let (dev, ino, len, times) = store::identity(&self.library)?;
        let numbers = [dev, ino, len].map(|n| n.to_string()).into_iter().chain(times.map(|n| n.to_string()));
        Ok(numbers.collect::<Vec<_>>().join("-"))
    }

    /// Hash of its library's file as it is now, lower-case hexadecimal.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn sha256(&self) -> Result<String, HostError> {
        store::sha256_of(&self.library)
    }
}

/// The plugins that there are.
#[derive(Debug, Default)]
pub struct Registry {
    plugins: Vec<PluginInfo>,
    shadowed: Vec<PluginInfo>,
    problems: Vec<HostError>,
    /// How many of the plugins come from places that the user named.
    n_named: usize,
    /// What cannot be used there: whether the file itself was named, which, and why.
    unusable: Vec<(bool, PathBuf, String)>,
}

impl Registry {
    /// Looks along the search path of this process, the given files and folders first.
    #[must_use]
    pub fn scan(extra: &[PathBuf]) -> Self {
        Self::scan_path(&SearchPath::of_process(extra))
    }

    /// Looks along a search path.
    #[must_use]
    pub fn scan_path(path: &SearchPath) -> Self {
        let mut registry = Self::default();
        let of_named = |file: &Path| path.book.of_named(&script::manifest_of(file));
        for named in &path.named {
            if named.is_dir() {
                registry.scan_folder(named, false, of_named);
            } else {
                registry.add_file(named, of_named(named), true);
            }
        }
        for folder in path.dev.iter().flat_map(|tree| dev::folders(tree)) {
            registry.scan_folder(&folder, false, |file| path.book.of_dev(file));
        }
        registry.n_named = registry.plugins.len();
        registry.unusable = unusable(&registry.problems, &path.named);
        if let Some((executable, folder)) =
            path.executable.as_deref().and_then(|exe| Some((exe, exe.parent()?)))
        {
            for folder in [folder.to_owned(), folder.join("../lib/honami/plugins")] {
                registry.scan_folder(&folder, false, |file| match shipped(executable, &folder, file) {
                    Trust::Shipped => path.book.of_shipped(file),
                    other => other,
                });
            }
        }
        for folder in &path.installed {
            registry.scan_folder(folder, true, |file| match dev::is_below(&path.dev, file) {
                true => path.book.of_dev(file),
                false => path.book.of(file),
            });
        }
        registry.problems.extend(path.book.problem());
        registry
    }

    /// Looks into one file.
    pub(crate) fn of_file(file: &Path, trust: Trust) -> Self {
        let mut registry = Self::default();
        registry.add_file(file, trust, true);
        registry
    }

    pub(crate) fn into_problems(self) -> Vec<HostError> {
        self.problems
    }

    /// The plugins, in the order of the search path.
    #[must_use]
    pub fn plugins(&self) -> &[PluginInfo] {
        &self.plugins
    }

    /// Plugins hidden by one with the same id that was found first.
    #[must_use]
    pub fn shadowed(&self) -> &[PluginInfo] {
        &self.shadowed
    }

    /// Files that look like plugins and cannot be used.
    #[must_use]
    pub fn problems(&self) -> &[HostError] {
        &self.problems
    }

    /// The plugin with this full id or short name.
    ///
    /// # Errors
    /// [`HostError::NotFound`], or [`HostError::Ambiguous`] for a short name that several share. [`HostError::Instead`]
    /// where a file that the user named cannot be used, or one of that name in a folder that was named: it may be the one
    /// that is meant, and nothing from elsewhere takes its place unsaid.
    pub fn find(&self, kind: Kind, name: &str) -> Result<&PluginInfo, HostError> {
        let found = self.among_all(kind, name)?;
        if self.plugins[..self.n_named].iter().any(|plugin| plugin.id == found.id) {
            return Ok(found);
        }
        let is_meant = |(is_named, file, _): &&(bool, PathBuf, String)| {
            *is_named || file.file_name() == found.library.file_name()
        };
        match self.unusable.iter().find(is_meant) {
            Some((_, _, problem)) => {
                let (name, library) = (name.to_owned(), found.library.clone());
                Err(HostError::Instead { name, library, problem: problem.clone() })
            }
            None => Ok(found),
        }
    }

    /// Why a file cannot be used that the user named, or that lies in a folder that was named.
    pub fn unusable(&self) -> impl Iterator<Item = &str> {
        self.unusable.iter().map(|(_, _, problem)| problem.as_str())
    }

    fn among_all(&self, kind: Kind, name: &str) -> Result<&PluginInfo, HostError> {
        let of_kind = || self.plugins.iter().filter(|plugin| plugin.kind == kind);
        if let Some(plugin) = of_kind().find(|plugin| plugin.id == name) {
            return Ok(plugin);
        }
        let named: Vec<_> = of_kind().filter(|plugin| plugin.short_name == name).collect();
        let list = |plugins: &mut dyn Iterator<Item = &str>| plugins.collect::<Vec<_>>().join(", ");
        match named.as_slice() {
            [plugin] => Ok(plugin),
            [] => {
                let known = list(&mut of_kind().map(|plugin| plugin.short_name.as_str()));
                let known = if known.is_empty() { "none; see honami plugin list".into() } else { known };
                // What was meant may lie in one of these.
                let problems = self.problems.iter().map(|problem| format!("; {problem}")).collect();
                Err(HostError::NotFound { kind, name: name.to_owned(), known, problems })
            }
            several => {
                let ids = list(&mut several.iter().map(|plugin| plugin.id.as_str()));
                Err(HostError::Ambiguous { name: name.to_owned(), ids })
            }
        }
    }

    /// Looks into a folder. Programs may have folders of their own there, and libraries where they are `installed`: what is
    /// built leaves others in such folders, which are none to load.
    fn scan_folder(&mut self, folder: &Path, installed: bool, trust: impl Fn(&Path) -> Trust) {
        let within = |folder: &Path| -> Vec<PathBuf> {
            fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
        };
        let is_library = |path: &Path| path.extension().is_some_and(|extension| extension == "so");
        let own = |path: PathBuf| {
            let mut files = if path.is_dir() { within(&path) } else { Vec::new() };
            files.retain(|file| script::is_manifest(file) || (installed && is_library(file)));
            std::iter::once(path).chain(files)
        };
        let mut files: Vec<PathBuf> = within(folder)
            .into_iter()
            .flat_map(own)
            .filter(|path| is_library(path) || script::is_manifest(path))
            .collect();
        files.sort();
        for file in files {
            let trust = trust(&file);
            self.add_file(&file, trust, false);
        }
    }

    /// Adds the plugins of a library. One that carries no manifest is no plugin, which is a problem if it was named.
    fn add_file(&mut self, file: &Path, trust: Trust, named: bool) {
        let file = &script::manifest_of(file);
        let read = if script::is_manifest(file) { script::read(file).map(Some) } else { note::read(file) };
        match read {
            Ok(Some((manifest, json))) => self.add_manifest(file, &trust, manifest, &json.into()),
            Ok(None) if named => self.problems.push(HostError::File {
                path: file.to_owned(),
                why: "is no honami plugin: it carries no manifest (.note.honami)".into(),
            }),
            Ok(None) => {}
            Err(problem) => self.problems.push(problem),
        }
    }

    fn add_manifest(&mut self, file: &Path, trust: &Trust, manifest: Manifest, json: &Arc<[u8]>) {
        for plugin in manifest.plugins {
            let kind = serde_json::from_value(plugin.kind.clone().into());
            let (Ok(kind), Ok((params, renamed))) = (kind, plugin.params()) else {
                let why = format!("{} is a {}, which this honami does not know", plugin.id, plugin.kind);
                self.problems.push(HostError::File { path: file.to_owned(), why });
                continue;
            };
            let info = PluginInfo {
                short_name: plugin.id.rsplit('.').next().unwrap_or(&plugin.id).to_owned(),
                id: plugin.id,
                kind,
                name: plugin.name,
                doc: plugin.doc,
                cite: plugin.cite,
                version: manifest.library.version.clone(),
                license: manifest.library.license.clone(),
                abi: manifest.abi,
                library_id: manifest.library.id.clone(),
                library: file.to_owned(),
                trust: trust.clone(),
                interfaces: plugin.interfaces,
                caps: plugin.caps,
                params,
                renamed,
                needs: manifest.needs.clone(),
                exec: manifest.exec.clone(),
                manifest: Arc::clone(json),
            };
            let hidden = self.plugins.iter().any(|other| other.id == info.id);
            if hidden { self.shadowed.push(info) } else { self.plugins.push(info) }
        }
    }
}

/// Files that cannot be used, and whether they are among those that were named themselves.
fn unusable(problems: &[HostError], named: &[PathBuf]) -> Vec<(bool, PathBuf, String)> {
    let named: Vec<PathBuf> = named.iter().map(|file| script::manifest_of(file)).collect();
    let of_file = |problem: &HostError| match problem {
        HostError::File { path, .. } => Some((named.contains(path), path.clone(), problem.to_string())),
        _ => None,
    };
    problems.iter().filter_map(of_file).collect()
}

/// Beside the executable, with its owner and no other writer.
fn shipped(executable: &Path, folder: &Path, file: &Path) -> Trust {
    let Ok(owner) = fs::metadata(executable).map(|meta| meta.uid()) else {
        return Trust::No("the owner of the executable cannot be told".into());
    };
    match [folder, file].iter().try_for_each(|place| trust::only_writes(place, &[owner])) {
        Ok(()) => Trust::Shipped,
        Err(why) => Trust::No(why),
    }
}
