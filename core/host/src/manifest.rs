//! What a library says of itself before any of its code runs: plugins, parameters, abilities.

use crate::plain::is_hidden;
use crate::values::{Value, Values};
use honami_abi::kind;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// What a plugin does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Follows points through frames.
    Tracker,
    /// Groups tracks.
    Clusterer,
    /// Grows skeletons.
    Structure,
    /// Moves plants.
    Simulator,
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tracker => "tracker",
            Self::Clusterer => "clusterer",
            Self::Structure => "structure",
            Self::Simulator => "simulator",
        })
    }
}

/// The JSON document in a library's note. Unknown members are ignored.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Manifest {
    /// Version of this document's form; 1.
    pub(crate) honami: u32,
    /// Major and minor of the ABI that it was built for.
    pub(crate) abi: (u32, u32),
    /// Of the library as a whole.
    pub(crate) library: LibraryInfo,
    /// What is in it.
    pub(crate) plugins: Vec<PluginManifest>,
    /// Of a manifest beside a program: how the program is started, its own files by name.
    #[serde(default)]
    pub(crate) exec: Vec<String>,
    /// What it must have beside what every plugin has.
    #[serde(default)]
    pub(crate) needs: Needs,
}

/// What a program must have beside what every plugin has; libraries get none of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Needs {
    /// It starts other programs.
    pub exec: bool,
    /// It reads these files and folders, beside the files that its parameters name.
    pub read: Vec<PathBuf>,
}

impl std::fmt::Display for Needs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let read = self.read.iter().map(|path| format!("reads {}", path.display()));
        let all = self.exec.then(|| "starts other programs".to_owned()).into_iter().chain(read);
        f.write_str(&all.collect::<Vec<_>>().join(", "))
    }
}

/// Of a library as a whole.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct LibraryInfo {
    /// Reverse-DNS.
    pub(crate) id: String,
    /// Version of all its plugins.
    pub(crate) version: String,
    /// SPDX expression.
    #[serde(default)]
    pub(crate) license: String,
}

/// Of one plugin.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct PluginManifest {
    /// Reverse-DNS; the last component is its short name.
    pub(crate) id: String,
    /// What it does; as text, so that a library may also hold kinds of tomorrow.
    pub(crate) kind: String,
    /// For people, a few words.
    pub(crate) name: String,
    /// Markdown.
    #[serde(default)]
    pub(crate) doc: String,
    /// Where the method comes from.
    #[serde(default)]
    pub(crate) cite: Vec<String>,
    /// Interface ids.
    #[serde(default)]
    pub(crate) interfaces: Vec<String>,
    /// Abilities.
    #[serde(default)]
    pub(crate) caps: Caps,
    #[serde(default)]
    params: Vec<serde_json::Value>,
}

/// Abilities of a plugin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Caps {
    /// By how many frames a tracker's results lag behind.
    pub latency: u32,
    /// Whether the same input gives the same bits.
    pub deterministic: bool,
    /// Whether two instances may work at once.
    pub parallel_instances: bool,
    /// Pixel formats that it takes.
    pub pixels: Vec<String>,
}

impl Default for Caps {
    fn default() -> Self {
        Self { latency: 0, deterministic: false, parallel_instances: false, pixels: vec!["gray8".into()] }
    }
}

/// One parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Param {
    /// Its name for machines and for `--set`.
    pub id: String,
    /// Its name for people; the id where the plugin gives none.
    #[serde(default)]
    pub label: String,
    /// Heading that it belongs under.
    #[serde(default)]
    pub group: String,
    /// What it does.
    #[serde(default)]
    pub doc: String,
    /// Unit of its numbers.
    #[serde(default)]
    pub unit: String,
    /// What a change makes stale: `seed`, `track`, `all`.
    #[serde(default)]
    pub affects: String,
    /// Whether most people never need it.
    #[serde(default)]
    pub advanced: bool,
    /// Values of other parameters under which it counts; all must hold.
    #[serde(default)]
    pub when: BTreeMap<String, Value>,
    /// Type, default and range.
    #[serde(flatten)]
    pub kind: ParamKind,
}

/// Type of a parameter, with its default and range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum ParamKind {
    /// Yes or no.
    Bool {
        /// Unless set.
        default: bool,
    },
    /// A whole number.
    Int(Numeric<i64>),
    /// A number.
    Float(Numeric<f64>),
    /// One of several.
    Enum {
        /// Unless set; an entry's id.
        default: String,
        /// The choices.
        entries: Vec<Entry>,
    },
    /// A text.
    String {
        /// Unless set.
        default: String,
    },
    /// A file or folder.
    Path {
        /// Unless set.
        default: String,
        /// `open`, `save` or `dir`.
        #[serde(default)]
        mode: String,
        /// Which files, as `*.png`.
        #[serde(default)]
        glob: String,
    },
    /// x, y.
    Vec2 {
        /// Unless set.
        default: [f64; 2],
    },
    /// x, y, width, height.
    Rect {
        /// Unless set.
        default: [f64; 4],
    },
    /// A seed of random choices.
    Seed {
        /// Unless set.
        default: i64,
    },
}

impl ParamKind {
    /// Its number in the header.
    pub(crate) fn abi(&self) -> u32 {
        match self {
            Self::Bool { .. } => kind::BOOL,
            Self::Int(_) => kind::INT,
            Self::Float(_) => kind::FLOAT,
            Self::Enum { .. } | Self::String { .. } | Self::Path { .. } => kind::TEXT,
            Self::Vec2 { .. } => kind::VEC2,
            Self::Rect { .. } => kind::RECT,
            Self::Seed { .. } => kind::SEED,
        }
    }
}

/// Range of a number: hard ends, softer ones for sliders.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numeric<T> {
    /// Unless set.
    pub default: T,
    /// Smallest value.
    pub min: Option<T>,
    /// Largest value.
    pub max: Option<T>,
    /// Where a slider begins.
    pub soft_min: Option<T>,
    /// Where a slider ends.
    pub soft_max: Option<T>,
    /// What an arrow key adds.
    pub step: Option<T>,
    /// `lin` or `log`.
    #[serde(default)]
    pub scale: String,
}

/// One choice of an enum.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Its name for machines, kept in projects.
    pub id: String,
    /// Its name for people.
    #[serde(default)]
    pub label: String,
    /// What it does.
    #[serde(default)]
    pub doc: String,
}

impl Manifest {
    /// Reads the document of a note.
    ///
    /// # Errors
    /// A sentence, when it is no such document or says what cannot be.
    pub(crate) fn parse(json: &[u8]) -> Result<Self, String> {
        let broken = |e: serde_json::Error| format!("its manifest is broken: {e}");
        // Before anything that it says stands in a message.
        no_hidden(&serde_json::from_slice(json).map_err(broken)?, "the document")?;
        let manifest: Self = serde_json::from_slice(json).map_err(broken)?;
        if manifest.honami != 1 {
            return Err(format!("its manifest is of form {}, this honami reads form 1", manifest.honami));
        }
        if manifest.abi.0 != honami_abi::ABI_MAJOR {
            let (major, known) = (manifest.abi.0, honami_abi::ABI_MAJOR);
            return Err(format!("built for ABI {major}, this honami knows ABI {known}"));
        }
        let mut ids = BTreeSet::new();
        for plugin in &manifest.plugins {
            if plugin.id.is_empty() || !ids.insert(&plugin.id) {
                return Err(format!("its manifest has two plugins, or a nameless one: {:?}", plugin.id));
            }
            plugin.params().map_err(|e| format!("manifest of {}: {e}", plugin.id))?;
        }
        Ok(manifest)
    }
}

/// Refuses letters that would change what stands around them on a screen. Only a `doc` has lines.
fn no_hidden(value: &serde_json::Value, member: &str) -> Result<(), String> {
    let shown = |text: &str, has_lines: bool| {
        let is_line = |letter| has_lines && ['\n', '\t'].contains(&letter);
        match text.chars().find(|letter| is_hidden(*letter) && !is_line(*letter)) {
            Some(letter) => Err(format!(
                "its manifest has U+{:04X} in {member:?}: wanted text without control characters",
                u32::from(letter)
            )),
            None => Ok(()),
        }
    };
    match value {
        serde_json::Value::String(text) => shown(text, member == "doc"),
        serde_json::Value::Array(all) => all.iter().try_for_each(|value| no_hidden(value, member)),
        serde_json::Value::Object(all) => {
            all.iter().try_for_each(|(name, value)| shown(name, false).and_then(|()| no_hidden(value, name)))
        }
        _ => Ok(()),
    }
}

impl PluginManifest {
    /// The parameters, and the new ids of renamed ones.
    ///
    /// # Errors
    /// A sentence, when one is declared wrongly.
    pub(crate) fn params(&self) -> Result<(Vec<Param>, BTreeMap<String, String>), String> {
        let mut params: Vec<Param> = Vec::new();
        let mut renamed = BTreeMap::new();
        for json in &self.params {
            let text = |key: &str| json.get(key).and_then(serde_json::Value::as_str).unwrap_or("").to_owned();
            let (id, new) = (text("id"), text("renamed_to"));
            if !new.is_empty() {
                renamed.insert(id, new);
                continue;
            }
            let mut param: Param =
                serde_json::from_value(json.clone()).map_err(|e| format!("parameter {id:?}: {e}"))?;
            if param.id.is_empty() || params.iter().any(|other| other.id == param.id) {
                return Err(format!("two parameters, or a nameless one: {id:?}"));
            }
            if param.label.is_empty() {
                param.label.clone_from(&param.id);
            }
            params.push(param);
        }
        Values::defaults(&params).validate(&params).map_err(|e| format!("default out of range: {e}"))?;
        Ok((params, renamed))
    }
}

#[cfg(test)]
mod tests;
