//! Starts plugins: trust, loading, parameters, typed handles.

use crate::clusterer::Clusterer;
use crate::context::CallContext;
use crate::draft::{Simulator, Structure};
use crate::error::HostError;
use crate::instance::{Handle, Request};
use crate::manifest::{Kind, ParamKind};
use crate::registry::PluginInfo;
use crate::reply::Reply;
use crate::tracker::Tracker;
use crate::values::Values;
use crate::{in_process, store};
use honami_abi::kind;
use std::path::PathBuf;

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
    pub sandbox: &'static str,
}

/// Starts plugins, from copies of their libraries in a store.
#[derive(Clone, Debug)]
pub struct Host {
    store: PathBuf,
}

impl Default for Host {
    fn default() -> Self {
        Self::new()
    }
}

impl Host {
    /// With the store of this user, `$XDG_CACHE_HOME/honami/store`.
    #[must_use]
    pub fn new() -> Self {
        Self { store: store::folder_of_user() }
    }

    /// With a store of the caller's; the folder is made when it is first needed.
    #[must_use]
    pub fn with_store(store: PathBuf) -> Self {
        Self { store }
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
        let latency = info.caps.latency;
        Ok((Tracker { handle, reply: Reply::default(), latency, stream: None }, origin))
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

    /// Starts a structure builder (draft) with these parameter values.
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

    /// Starts a simulator (draft) with these parameter values.
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
        Ok((Simulator { handle, reply: Reply::default(), n_rows: None }, origin))
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
        let mut complete = Values::defaults(&info.params);
        complete.restore(values, &info.renamed);
        complete.validate(&info.params)?;
        if !info.caps.pixels.iter().any(|format| format == "gray8") {
            let what = format!("takes only pixels of format {:?}, this honami has gray8", info.caps.pixels);
            return Err(HostError::Usage { plugin: info.id.clone(), what });
        }
        let library = in_process::load(info, &self.store)?;
        let origin = Origin {
            plugin_id: info.id.clone(),
            plugin_version: info.version.clone(),
            plugin_sha256: library.sha256.clone(),
            abi: info.abi,
            sandbox: "in process",
        };
        let mut handle = Handle::new(info.id.clone(), in_process::create(info, library, cx)?);
        let checked: Vec<_> = info
            .params
            .iter()
            .map(|param| {
                let value = complete.get(&param.id).cloned().unwrap_or_else(|| param.default());
                Ok((param.id.as_str(), param.check(value)?, kind_of(&param.kind)))
            })
            .collect::<Result<_, HostError>>()?;
        let sent: Vec<_> = checked.iter().map(|(id, value, kind)| (*id, value, *kind)).collect();
        handle.ask(&Request::SetParams(&sent), cx, &mut Reply::default())?;
        Ok((handle, origin))
    }
}

fn kind_of(param: &ParamKind) -> u32 {
    match param {
        ParamKind::Bool { .. } => kind::BOOL,
        ParamKind::Int(_) => kind::INT,
        ParamKind::Float(_) => kind::FLOAT,
        ParamKind::Enum { .. } | ParamKind::String { .. } | ParamKind::Path { .. } => kind::TEXT,
        ParamKind::Vec2 { .. } => kind::VEC2,
        ParamKind::Rect { .. } => kind::RECT,
        ParamKind::Seed { .. } => kind::SEED,
    }
}
