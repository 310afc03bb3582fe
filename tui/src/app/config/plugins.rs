//! `[plugins]`: what plugins may take in a process of their own, and where they work.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use honami_workbench::plugins::{Host, Hosting, Limits, Registry, quoted};
use toml::{Table, Value};

/// What can be settled.
const NAMES: [&str; 5] = ["memory", "tell", "end", "stop", "hosting"];
/// Nobody waits longer for a plugin.
const SECONDS_MAX: f64 = 86_400.0;

/// How plugins are started.
#[derive(Clone, Debug, Default)]
pub struct Plugins {
    limits: Limits,
    /// By id or short name.
    hosting: BTreeMap<String, Hosting>,
}

impl Plugins {
    /// Reads what was settled, with what is wrong with it, one line each.
    pub(super) fn of(settled: Option<&Value>) -> (Self, Vec<String>) {
        let mut wrong = Vec::new();
        let none = Table::new();
        let table = settled.map_or(Some(&none), Value::as_table).unwrap_or_else(|| {
            wrong.push("plugins: a table is wanted, [plugins]".to_owned());
            &none
        });
        for name in table.keys().filter(|name| !NAMES.contains(&name.as_str())) {
            wrong.push(format!("plugins.{name} is not known; there are {}", NAMES.join(", ")));
        }
        let memory = table.get("memory");
        let memory_bytes = memory.and_then(bytes);
        if let Some(value) = memory.filter(|_| memory_bytes.is_none()) {
            wrong.push(format!(
                "plugins.memory: 64 MiB or more is wanted, as \"8 GiB\" or in bytes; got {value}: no limit"
            ));
        }
        let usual = Limits::default();
        let mut limits = Limits { memory_bytes, ..usual };
        for (name, limit) in
            [("tell", &mut limits.tell), ("end", &mut limits.end), ("stop", &mut limits.stop)]
        {
            match table.get(name).map(|value| (value, seconds(value))) {
                None => {}
                Some((_, Some(time))) => *limit = time,
                Some((value, None)) => {
                    wrong.push(format!("plugins.{name}: seconds are wanted, up to a day; got {value}"));
                }
            }
        }
        if !table.contains_key("tell") {
            limits.tell = limits.tell.min(limits.end);
        }
        if limits.tell > limits.end {
            wrong.push(format!(
                "plugins.tell: {:?} would come after the end, {:?}: neither holds",
                limits.tell, limits.end
            ));
            (limits.tell, limits.end) = (usual.tell, usual.end);
        }
        let hosting = hosting(table.get("hosting"), &mut wrong);
        (Self { limits, hosting }, wrong)
    }

    /// What starts plugins as it was settled; what the environment says stands over it.
    #[must_use]
    pub fn host(&self) -> Host {
        Host::new().settled(self.limits, self.hosting.clone()).leaving_trails()
    }

    /// What is said of plugins that are not there, one line each.
    #[must_use]
    pub fn strangers(&self, registry: &Registry) -> Vec<String> {
        let is_there = |name: &str| registry.plugins().iter().any(|p| p.id == name || p.short_name == name);
        let strangers = self.hosting.keys().filter(|name| !is_there(name));
        strangers.map(|name| format!("plugins.hosting.{name}: no such plugin is here")).collect()
    }

    /// What is said of plugins that do not work where it was settled because of the name, one line each; `find` looks for
    /// the plugins that there are, if any is asked for.
    #[must_use]
    pub fn too_short(&self, find: impl FnOnce() -> Registry) -> Vec<String> {
        if !self.hosting.values().any(|place| *place == Hosting::InProcess) {
            return Vec::new();
        }
        let (registry, host) = (find(), self.host());
        let plugins = registry.plugins().iter().filter(|plugin| host.is_named_too_shortly(plugin));
        plugins
            .map(|p| {
                format!("plugins.hosting.{}: its whole id is wanted, {:?}: isolated", p.short_name, p.id)
            })
            .collect()
    }
}

/// What is said of a plugin that was in honami when that ended.
pub(super) fn kept_out(plugin: &str, library: &Path) -> String {
    let file = quoted(library);
    format!(
        "{plugin} works in a process of its own: honami ended while it was inside; `honami plugin retry --in-process {file}` \
         lets it in again"
    )
}

/// What is wrong with what the environment says of where plugins work and what memory they may take, one line each.
pub(super) fn misspelt(
    hosting: Option<Result<Hosting, String>>,
    memory_bytes: Option<Result<u64, String>>,
) -> Vec<String> {
    let hosting = hosting.and_then(Result::err).map(|word| {
        format!("HONAMI_HOSTING: \"isolated\" or \"in-process\" is wanted, got {word:?}: isolated")
    });
    let memory = memory_bytes.and_then(Result::err).map(|word| {
        let least = Limits::MEMORY_BYTES_MIN;
        format!("HONAMI_PLUGIN_MEMORY: {least} bytes or more are wanted, got {word:?}: as config.toml has it")
    });
    hosting.into_iter().chain(memory).collect()
}

/// Where plugins work, by id or short name. What is misspelt is safe.
fn hosting(settled: Option<&Value>, wrong: &mut Vec<String>) -> BTreeMap<String, Hosting> {
    let Some(settled) = settled else { return BTreeMap::new() };
    let Some(table) = settled.as_table() else {
        wrong.push("plugins.hosting: a table is wanted, [plugins.hosting]".to_owned());
        return BTreeMap::new();
    };
    let mut hosting = BTreeMap::new();
    for (name, value) in table {
        let place = match value.as_str() {
            Some("in-process") => Hosting::InProcess,
            Some("isolated") => Hosting::Isolated,
            _ => {
                wrong.push(format!(
                    "plugins.hosting.{name}: \"isolated\" or \"in-process\" is wanted, got {value}: isolated"
                ));
                Hosting::Isolated
            }
        };
        hosting.insert(name.clone(), place);
    }
    hosting
}

/// A number of bytes, or one with its unit: `8 GiB`.
fn bytes(value: &Value) -> Option<u64> {
    let bytes = match value {
        Value::Integer(bytes) => u64::try_from(*bytes).ok()?,
        Value::String(text) => {
            let (number, unit) = text.split_at(text.find(|c: char| !c.is_ascii_digit())?);
            let shift = match unit.trim() {
                "KiB" => 10,
                "MiB" => 20,
                "GiB" => 30,
                "TiB" => 40,
                _ => return None,
            };
            number.parse::<u64>().ok()?.checked_mul(1 << shift)?
        }
        _ => return None,
    };
    (bytes >= Limits::MEMORY_BYTES_MIN).then_some(bytes)
}

/// A time in seconds, whole or not.
fn seconds(value: &Value) -> Option<Duration> {
    let seconds = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))?;
    let is_sound = seconds > 0.0 && seconds <= SECONDS_MAX;
    Duration::try_from_secs_f64(seconds).ok().filter(|_| is_sound)
}

#[cfg(test)]
mod tests;
