//! Provenance: what made a result, so that it can be named, judged and repeated.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A parameter's value, as plain as in a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A finite number.
    Float(f64),
    /// A word or a path.
    Text(String),
    /// Finite numbers in order.
    List(Vec<f64>),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Bool(v) => v.fmt(f),
            Self::Int(v) => v.fmt(f),
            Self::Float(v) => v.fmt(f),
            Self::Text(v) => v.fmt(f),
            Self::List(v) => {
                let words: Vec<_> = v.iter().map(ToString::to_string).collect();
                f.write_str(&words.join(","))
            }
        }
    }
}

/// Which plugin made a result, from what and how. Every result carries one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// What was done, in the words of the command line: `track`, `cluster`.
    pub what: String,
    /// Full id, `org.honami.klt`.
    pub plugin_id: String,
    /// Its version.
    pub plugin_version: String,
    /// Content hash of its library, hexadecimal.
    pub plugin_sha256: String,
    /// ABI it spoke, major and minor.
    pub abi: (u16, u16),
    /// Every parameter with the value used, defaults too.
    pub params: BTreeMap<String, Value>,
    /// Seed of all its random choices.
    pub seed: u64,
    /// The project's revision it worked on: the head of the history when it began.
    pub input_revision: u32,
    /// How it was isolated: `in process`.
    pub sandbox: String,
    /// Widest SIMD level of the machine it ran on, which the kernels of `honami-vision` use: `scalar`, `avx2` or `avx512`. A
    /// plugin with kernels of its own may have used less. `none`: nothing ran.
    pub simd: String,
    /// When it began, RFC 3339.
    pub date: String,
    /// Version of honami that ran it.
    pub honami_version: String,
}

/// `org.honami.klt 0.1.0 (3f2a…), on revision 7 levels=4 radius=10`: what made it, in one line.
impl std::fmt::Display for Provenance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hash = self.plugin_sha256.get(..8).unwrap_or_default();
        write!(
            f,
            "{} {} ({hash}…), on revision {}",
            self.plugin_id, self.plugin_version, self.input_revision
        )?;
        self.params.iter().try_for_each(|(id, value)| write!(f, " {id}={value}"))
    }
}
