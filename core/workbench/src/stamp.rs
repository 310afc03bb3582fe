//! The provenance of a result that is about to be made.

use std::collections::BTreeMap;

use honami_host::{PluginInfo, Values};
use honami_model::provenance::{Provenance, Value};
use honami_store::Project;

/// Says what is about to run, on which revision of the project.
pub(crate) fn stamp(project: &Project, what: &str, plugin: &PluginInfo, params: &Values) -> Provenance {
    Provenance {
        what: what.to_owned(),
        plugin_id: plugin.id.clone(),
        plugin_version: plugin.version.clone(),
        plugin_sha256: plugin.sha256.clone(),
        abi: plugin.abi,
        params: values(params),
        seed: SEED,
        input_revision: project.revision().0,
        sandbox: "in process".to_owned(),
        simd: simd().to_owned(),
        date: honami_store::now(),
        honami_version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

/// The seed of every run: shipped plugins make no random choices, and what is repeated should repeat.
pub(crate) const SEED: u64 = 0;

/// The widest vector instructions that this machine offers to a plugin.
fn simd() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            return "avx512";
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            return "avx2";
        }
    }
    "baseline"
}

fn values(params: &Values) -> BTreeMap<String, Value> {
    params.iter().map(|(id, value)| (id.clone(), value.clone().into())).collect()
}
