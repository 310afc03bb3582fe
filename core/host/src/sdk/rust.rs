//! A plugin in Rust: its package, and the sources of the SDK beside it, so that cargo needs nothing from elsewhere.

use super::{Begun, File};

/// Files of a package by their place in its folder.
macro_rules! sources {
    ($package:literal: $($file:literal),* $(,)?) => {
        &[$(($file, include_str!(concat!("../../../", $package, "/src/", $file)))),*]
    };
}

/// A package of the SDK: name, what else its manifest says, sources.
pub(super) struct Package {
    pub(super) name: &'static str,
    more: &'static str,
    pub(super) sources: &'static [(&'static str, &'static str)],
}

/// The SDK; a test sees that no source is missing.
pub(super) const SDK: [Package; 2] = [
    Package { name: "honami-abi", more: "", sources: sources!("abi": "layout.rs", "lib.rs", "structs.rs") },
    Package {
        name: "honami-plugin",
        more: "\n[dependencies]\nhonami-abi = { path = \"../honami-abi\" }\n",
        sources: sources!("plugin":
            "clusterer.rs",
            "cx.rs",
            "error.rs",
            "export.rs",
            "export/clusterer.rs",
            "export/panics.rs",
            "export/simulator.rs",
            "export/state.rs",
            "export/stateless.rs",
            "export/structure.rs",
            "export/table.rs",
            "export/tests.rs",
            "export/tracker.rs",
            "info.rs",
            "lib.rs",
            "manifest.rs",
            "params.rs",
            "simulator.rs",
            "simulator/tests.rs",
            "state.rs",
            "state/tests.rs",
            "structure.rs",
            "testing.rs",
            "testing/clip.rs",
            "testing/samples.rs",
            "testing/suite.rs",
            "testing/suite/state.rs",
            "testing/suite/tests.rs",
            "tracker.rs",
        ),
    },
];

fn manifest(name: &str, more: &str) -> String {
    let (version, rust) = (env!("CARGO_PKG_VERSION"), env!("CARGO_PKG_RUST_VERSION"));
    format!(
        "[package]\nname = \"{name}\"\nversion = \"{version}\"\nedition = \"2024\"\nrust-version = \"{rust}\"\n\
         license = \"MIT OR Apache-2.0\"\npublish = false\n{more}"
    )
}

/// The package of a plugin whose source is `text`.
pub(super) fn begin(name: &str, text: String) -> Begun {
    let library = format!("{}_plugin", name.replace('-', "_"));
    let more = format!(
        "\n[lib]\nname = \"{library}\"\ncrate-type = [\"cdylib\"]\n\n\
         [dependencies]\nhonami-plugin = {{ path = \"honami-plugin\" }}\n\n\
         # Tests at full speed.\n[profile.dev]\nopt-level = 3\n\n# A package of its own, wherever it lies.\n[workspace]\n"
    );
    let mut files: Vec<File> = vec![
        ("src/lib.rs".into(), text),
        ("Cargo.toml".into(), manifest(&format!("{name}-plugin"), &more)),
        (".gitignore".into(), "target\n".into()),
    ];
    for package in &SDK {
        files.push((format!("{}/Cargo.toml", package.name), manifest(package.name, package.more)));
        let sources = package.sources.iter();
        files
            .extend(sources.map(|(file, text)| (format!("{}/src/{file}", package.name), (*text).to_owned())));
    }
    Begun {
        files,
        build: format!("cargo build --release --offline --manifest-path {name}/Cargo.toml"),
        plugin: format!("{name}/target/release/lib{library}.so"),
    }
}
