//! The provenance of a result that is about to be made.

use std::collections::BTreeMap;

use honami_host::{Origin, PluginInfo, Values};
use honami_model::history::EntryId;
use honami_model::provenance::{Provenance, Value};
use honami_store::Project;

/// Says what is about to run, with all its parameters, on which revision of the project.
pub(crate) fn stamp(
    on: EntryId,
    what: &str,
    plugin: &PluginInfo,
    params: &Values,
    origin: Origin,
) -> Provenance {
    let mut all = Values::defaults(&plugin.params);
    all.restore(params, &plugin.renamed);
    Provenance {
        what: what.to_owned(),
        plugin_id: origin.plugin_id,
        plugin_version: origin.plugin_version,
        plugin_sha256: origin.plugin_sha256,
        abi: (narrow(origin.abi.0), narrow(origin.abi.1)),
        params: all.iter().map(|(id, value)| (id.to_owned(), value.clone())).collect(),
        seed: SEED,
        input_revision: on.0,
        sandbox: origin.sandbox,
        simd: honami_vision::simd::level().to_owned(),
        date: honami_store::now(),
        honami_version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

/// Says which file was read, with how it was read; nothing ran that could be named.
pub(crate) fn imported(project: &Project, params: BTreeMap<String, Value>, sha256: String) -> Provenance {
    own(project, "import", params, sha256)
}

/// Says what honami did itself, without a plugin, with the hash of the file that it did it to, if it was one.
pub(crate) fn own(
    project: &Project,
    what: &str,
    params: BTreeMap<String, Value>,
    sha256: String,
) -> Provenance {
    Provenance { input_revision: project.revision().0, ..alone(what, params, sha256) }
}

/// The same of what no project has to do with.
pub(crate) fn alone(what: &str, params: BTreeMap<String, Value>, sha256: String) -> Provenance {
    Provenance {
        what: what.to_owned(),
        plugin_id: what.to_owned(),
        plugin_version: env!("CARGO_PKG_VERSION").to_owned(),
        plugin_sha256: sha256,
        abi: (0, 0),
        params,
        seed: SEED,
        input_revision: 0,
        sandbox: "in process".to_owned(),
        simd: "none".to_owned(),
        date: honami_store::now(),
        honami_version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

fn narrow(version: u32) -> u16 {
    u16::try_from(version).unwrap_or(u16::MAX)
}

/// What was done where a rebuilt tracker did frames again, beside the run that it went on with.
pub(crate) const REBUILT: &str = "rebuilt";

/// The seed of every run: shipped plugins make no random choices, and what is repeated should repeat.
pub(crate) const SEED: u64 = 0;
