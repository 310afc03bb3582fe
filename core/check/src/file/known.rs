//! The members of a manifest that this honami reads.

use crate::Fault;
use serde_json::Value;

const MANIFEST: &[&str] = &["honami", "abi", "library", "plugins", "exec", "needs", "$schema"];
const LIBRARY: &[&str] = &["id", "version", "license", "url"];
const NEEDS: &[&str] = &["exec", "read"];
const PLUGIN: &[&str] = &["id", "kind", "name", "doc", "cite", "interfaces", "caps", "params"];
const CAPS: &[&str] = &["latency", "deterministic", "parallel_instances", "pixels"];
const PARAM: &[&str] = &[
    "id",
    "label",
    "group",
    "doc",
    "unit",
    "affects",
    "advanced",
    "when",
    "type",
    "default",
    "entries",
    "mode",
    "glob",
    "min",
    "max",
    "soft_min",
    "soft_max",
    "step",
    "scale",
    "relative_to",
    "renamed_to",
];
const ENTRY: &[&str] = &["id", "label", "doc"];

/// The members that nobody here reads, by their places.
pub(super) fn unknown_to(json: &[u8]) -> Result<Vec<String>, Fault> {
    let manifest: Value =
        serde_json::from_slice(json).map_err(|error| Fault(format!("its manifest is broken: {error}")))?;
    let mut unknown = Vec::new();
    let mut look = |at: &str, value: &Value, known: &[&str]| {
        let members = value.as_object().into_iter().flatten().map(|(name, _)| name);
        unknown
            .extend(members.filter(|name| !known.contains(&name.as_str())).map(|name| format!("{at}{name}")));
    };
    look("", &manifest, MANIFEST);
    look("library.", &manifest["library"], LIBRARY);
    look("needs.", &manifest["needs"], NEEDS);
    for plugin in list(&manifest["plugins"]) {
        look("plugins.", plugin, PLUGIN);
        look("caps.", &plugin["caps"], CAPS);
        for param in list(&plugin["params"]) {
            look("params.", param, PARAM);
            list(&param["entries"]).iter().for_each(|entry| look("entries.", entry, ENTRY));
        }
    }
    unknown.sort();
    unknown.dedup();
    Ok(unknown)
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

#[cfg(test)]
mod tests;
