//! Starts plugins: trust, loading, parameters, typed handles.

mod place;

use crate::clusterer::Clusterer;
use crate::context::CallContext;
use crate::error::HostError;
use crate::instance::{Handle, Instance, Request};
use crate::isolated::Limits;
use crate::manifest::{Kind, ParamKind};
use crate::quarantine::{self, Quarantine, Tally, Trail};
use crate::registry::PluginInfo;
use crate::reply::Reply;
use crate::simulator::{Sent, Simulator};
use crate::structure::Structure;
use crate::tracker::Tracker;
use crate::values::{Value, Values};
use crate::{in_process, isolated, script, store};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where a plugin works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hosting {
    /// In this process: full speed and full trust.
    InProcess,
    /// In a process of its own: what it does there cannot hurt this one.
    Isolated,
}

impl Hosting {
    /// What `$HONAMI_HOSTING` calls it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::InProcess => "in-process",
            Self::Isolated => "isolated",
        }
    }

    /// What `$HONAMI_HOSTING` says: where all plugins work, or a word that is none of ours.
    #[must_use]
    pub fn of_environment() -> Option<Result<Self, String>> {
        let word = std::env::var_os("HONAMI_HOSTING")?;
        let meant = [Self::InProcess, Self::Isolated].into_iter().find(|hosting| word == hosting.word());
        Some(meant.ok_or_else(|| word.to_string_lossy().into_owned()))
    }
}

/// Where a result came from: what to write beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Full id.
    pub plugin_id: String,
    /// Of its library.
    pub plugin_version: String,
    /// Hash of the library that was loaded, lower-case hexadecimal.
    pub plugin_sha256: String,
    /// That it was built for.
    pub abi: (u32, u32),
    /// How far it is kept apart.
    pub sandbox: String,
}

/// Starts plugins, from copies of their libraries in a store.
#[derive(Clone, Debug)]
pub struct Host {
    store: PathBuf,
    hosting: Option<Hosting>,
    /// Where plugins work by a user's wish, by id or short name.
    settled: BTreeMap<String, Hosting>,
    limits: Limits,
    has_quarantine: bool,
    leaves_trails: bool,
}

impl Default for Host {
    fn default() -> Self {
        Self::new()
    }
}

impl Host {
    /// With the store of this user, `$XDG_CACHE_HOME/honami/store`; `$HONAMI_HOSTING` may say where all plugins work,
    /// `in-process` or `isolated`, and `$HONAMI_PLUGIN_MEMORY` how many bytes they may take in processes of their own.
    #[must_use]
    pub fn new() -> Self {
        // What is misspelt is safe.
        let hosting = Hosting::of_environment().map(|said| said.unwrap_or(Hosting::Isolated));
        let host = Self { hosting, ..Self::with_store(store::folder_of_user()) };
        host.settled(Limits::default(), BTreeMap::new())
    }

    /// With a store of the caller's; the folder is made when it is first needed.
    #[must_use]
    pub fn with_store(store: PathBuf) -> Self {
        let (settled, limits) = (BTreeMap::new(), Limits::default());
        Self { store, hosting: None, settled, limits, has_quarantine: true, leaves_trails: false }
    }

    /// Lets all plugins work there; else shipped ones work in this process and others in their own.
    #[must_use]
    pub fn hosting(self, hosting: Hosting) -> Self {
        Self { hosting: Some(hosting), ..self }
    }

    /// What a plugin may take in a process of its own.
    #[must_use]
    pub fn limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// As a user has settled it: what plugins may take, and where those work that are named by id or short name. What the
    /// environment says stands over it; where that is no number of bytes, what was settled holds.
    #[must_use]
    pub fn settled(self, limits: Limits, settled: BTreeMap<String, Hosting>) -> Self {
        let memory_bytes = Limits::memory_of_environment().and_then(Result::ok).or(limits.memory_bytes);
        Self { settled, limits: Limits { memory_bytes, ..limits }, ..self }
    }

    /// Counts no deaths, and starts what has died too often: for who wants to see why.
    #[must_use]
    pub fn without_quarantine(self) -> Self {
        Self { has_quarantine: false, ..self }
    }

    /// What did not come with honami leaves a trail while it works in this process, until [`ended_well`](crate::ended_well);
    /// and where a process has ended while it was inside, it works in one of its own, until its file changes or
    /// [`let_in`](Self::let_in).
    #[must_use]
    pub fn leaving_trails(self) -> Self {
        Self { leaves_trails: true, ..self }
    }

    /// Looks for trails of processes that have ended; the short names of the plugins that were in them, and their
    /// files. Each is told of once.
    #[must_use]
    pub fn follow_trails(&self) -> Vec<(String, PathBuf)> {
        Quarantine::beside(&self.store).follow_trails()
    }

    /// Starts a tracker with these parameter values; those that are missing take their defaults.
    ///
    /// # Errors
    /// [`HostError`], when the plugin is not trusted, cannot be loaded, or refuses the values.
    pub fn tracker(
        &self,
        info: &PluginInfo,
        values: &Values,
        cx: &CallContext<'_>,
    ) -> Result<(Tracker, Origin), HostError> {
        let (handle, origin) = self.start(info, Kind::Tracker, values, cx)?;
        let (latency, has_state) = (info.caps.latency, info.offers("honami.state/1"));
        Ok((Tracker { handle, reply: Reply::default(), latency, has_state, stream: None }, origin))
    }

    /// Starts a clusterer with these parameter values; those that are missing take their defaults.
    ///
    /// # Errors
    /// [`HostError`], when the plugin is not trusted, cannot be loaded, or refuses the values.
    pub fn clusterer(
        &self,
        info: &PluginInfo,
        values: &Values,
        cx: &CallContext<'_>,
    ) -> Result<(Clusterer, Origin), HostError> {
        let (handle, origin) = self.start(info, Kind::Clusterer, values, cx)?;
        Ok((Clusterer { handle }, origin))
    }

    /// Starts a structure builder with these parameter values; those that are missing take their defaults.
    ///
    /// # Errors
    /// [`HostError`], when the plugin is not trusted, cannot be loaded, or refuses the values.
    pub fn structure(
        &self,
        info: &PluginInfo,
        values: &Values,
        cx: &CallContext<'_>,
    ) -> Result<(Structure, Origin), HostError> {
        let (handle, origin) = self.start(info, Kind::Structure, values, cx)?;
        Ok((Structure { handle }, origin))
    }

    /// Starts a simulator with these parameter values.
    ///
    /// # Errors
    /// [`HostError`], when the plugin is not trusted, cannot be loaded, or refuses the values.
    pub fn simulator(
        &self,
        info: &PluginInfo,
        values: &Values,
        cx: &CallContext<'_>,
    ) -> Result<(Simulator, Origin), HostError> {
        let (handle, origin) = self.start(info, Kind::Simulator, values, cx)?;
        Ok((Simulator::new(handle, info, complete(info, values)?.0), origin))
    }

    /// The copy in the store from which a trusted plugin's library is loaded, made if it is not there yet.
    ///
    /// # Errors
    /// When it is not trusted, cannot be read, or has another manifest than `info` was read from.
    pub fn copy_of(&self, info: &PluginInfo) -> Result<PathBuf, HostError> {
        Ok(in_process::keep_same(info, &self.store)?.path)
    }

    /// A folder of this name beside the store, for what is known of contents; it may not be there yet.
    #[must_use]
    pub fn beside(&self, name: &str) -> PathBuf {
        self.store.with_file_name(name)
    }

    /// Lets a plugin start again that has failed too often, where it works now; whether it was held.
    ///
    /// # Errors
    /// When its file cannot be read, or what is known of it cannot be removed.
    pub fn retry(&self, info: &PluginInfo) -> Result<bool, HostError> {
        let (quarantine, sha256) = (Quarantine::beside(&self.store), info.sha256()?);
        let was_held = quarantine.why(&sha256).is_some();
        quarantine.release(&sha256).map_err(|error| quarantine.unchanged(&error))?;
        Ok(was_held)
    }

    /// Lets a plugin work in this process again, where that is wished, though one has ended while it was inside; whether
    /// it was kept out. Full trust once more: for a person to say.
    ///
    /// # Errors
    /// As [`retry`](Self::retry).
    pub fn let_in(&self, info: &PluginInfo) -> Result<bool, HostError> {
        let (quarantine, sha256) = (Quarantine::beside(&self.store), info.sha256()?);
        quarantine.let_in(&sha256).map_err(|error| quarantine.unchanged(&error))
    }

    fn start(
        &self,
        info: &PluginInfo,
        wanted: Kind,
        values: &Values,
        cx: &CallContext<'_>,
    ) -> Result<(Handle, Origin), HostError> {
        if info.kind != wanted {
            let what = format!("is a {}, not a {wanted}", info.kind);
            return Err(HostError::Usage { plugin: info.id.clone(), what });
        }
        let (complete, checked) = complete(info, values)?;
        if !info.caps.pixels.iter().any(|format| format == "gray8") {
            let what = format!("takes only pixels of format {:?}, this honami has gray8", info.caps.pixels);
            return Err(HostError::Usage { plugin: info.id.clone(), what });
        }
        let Made { instance, sha256: plugin_sha256, sandbox, trail } = self.instance(info, &complete, cx)?;
        let origin = Origin {
            plugin_id: info.id.clone(),
            plugin_version: info.version.clone(),
            plugin_sha256,
            abi: info.abi,
            sandbox,
        };
        let tally = self.tally(&origin.plugin_sha256);
        let mut handle = Handle::new(info.id.clone(), instance, tally, trail);
        let sent: Vec<_> = checked.iter().map(|(id, value, kind)| (id.as_str(), value, *kind)).collect();
        handle.ask(&Request::SetParams(&sent), cx, &mut Reply::default())?;
        Ok((handle, origin))
    }

    pub(crate) fn store(&self) -> &Path {
        &self.store
    }

    /// Makes an instance where it is to work.
    fn instance(&self, info: &PluginInfo, values: &Values, cx: &CallContext<'_>) -> Result<Made, HostError> {
        match self.hosting_of(info) {
            Hosting::InProcess => {
                let trail = self.leave_trail(info)?;
                let library = in_process::load(info, &self.store)?;
                let sha256 = library.sha256.clone();
                let instance = in_process::create(info, library, cx)?;
                Ok(Made { instance, sha256, sandbox: "in process".to_owned(), trail })
            }
            Hosting::Isolated => {
                let copy = if info.exec.is_empty() {
                    in_process::keep_same(info, &self.store)?
                } else {
                    script::keep(info, &self.store)?
                };
                let tally = self.tally(&copy.sha256);
                if let Some(why) = tally.as_ref().and_then(Tally::held) {
                    return Err(quarantine::held(info, why));
                }
                let read = files_of(info, values);
                let made = isolated::create(info, &copy.path, read, self.limits, cx);
                if let (Err(HostError::Ended { how, last_words, .. }), Some(tally)) = (&made, tally) {
                    tally.ended(how, last_words);
                }
                let (instance, sandbox) = made?;
                Ok(Made { instance, sha256: copy.sha256, sandbox, trail: None })
            }
        }
    }

    /// Where the deaths of a library are counted, if they are.
    fn tally(&self, sha256: &str) -> Option<Tally> {
        let tally = || Tally::new(Quarantine::beside(&self.store), sha256.to_owned());
        self.has_quarantine.then(tally)
    }
}

/// An instance where it is to work.
struct Made {
    instance: Box<dyn Instance>,
    /// Of its library.
    sha256: String,
    /// How far it is kept apart.
    sandbox: String,
    trail: Option<Trail>,
}

/// The files that a plugin was given by name, which it is to open.
fn files_of(info: &PluginInfo, values: &Values) -> Vec<PathBuf> {
    let paths = info.params.iter().filter(|param| matches!(param.kind, ParamKind::Path { .. }));
    let file = |value: &Value| match value {
        Value::Text(path) if !path.is_empty() => Some(PathBuf::from(path)),
        _ => None,
    };
    paths.filter_map(|param| values.get(&param.id).and_then(file)).collect()
}

/// The values of all parameters of a plugin, those that are missing by default; and as they are sent.
pub(crate) fn complete(info: &PluginInfo, values: &Values) -> Result<(Values, Sent), HostError> {
    let mut complete = Values::defaults(&info.params);
    complete.restore(values, &info.renamed);
    complete.validate(&info.params)?;
    let sent = info.params.iter().map(|param| {
        let value = complete.get(&param.id).cloned().unwrap_or_else(|| param.default());
        Ok((param.id.clone(), param.check(value)?, param.kind.abi()))
    });
    let sent = sent.collect::<Result<_, HostError>>()?;
    Ok((complete, sent))
}
