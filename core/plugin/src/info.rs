//! What a plugin and its library say of themselves.

/// Of one plugin. Begin with [`Info::NEW`]: `Info { id: "org.lab.klt", name: "KLT", doc: "…", ..Info::NEW }`.
#[derive(Clone, Copy, Debug)]
pub struct Info {
    /// Reverse-DNS, never changed; the last component is its short name.
    pub id: &'static str,
    /// For people, a few words.
    pub name: &'static str,
    /// What it does, its equation, its limits; Markdown.
    pub doc: &'static str,
    /// Where the method comes from: `"doi:…"`, URLs.
    pub cite: &'static [&'static str],
    /// Whether the same input gives the same bits.
    pub deterministic: bool,
    /// Whether two instances may work at once. True of safe Rust; false for a foreign library with globals.
    pub parallel_instances: bool,
}

impl Info {
    /// The usual plugin, still without a name.
    pub const NEW: Self =
        Self { id: "", name: "", doc: "", cite: &[], deterministic: true, parallel_instances: true };
}

/// Of a library of plugins.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// Reverse-DNS.
    pub id: &'static str,
    /// As in `Cargo.toml`: `env!("CARGO_PKG_VERSION")`.
    pub version: &'static str,
    /// SPDX expression.
    pub license: &'static str,
}
