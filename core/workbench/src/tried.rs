//! What tests of projects begin with: a small project, and the provenance of a run in it.

use honami_model::provenance::Provenance;
use honami_synth::Settings;
use tempfile::TempDir;

use crate::generate::generate;
use crate::session::Session;

/// A project of a generated clip of so many frames, without tracks.
pub(crate) fn project(n_frames: u32) -> (TempDir, Session) {
    let folder = tempfile::tempdir().unwrap();
    let clip = folder.path().join("clip.y4m");
    let settings = Settings { width: 64, height: 48, n_frames, n_leaves: 2, ..Settings::default() };
    generate(&settings, &clip, &()).unwrap();
    let session = Session::create(&folder.path().join("clip.honami"), &clip, None, &Default::default());
    (folder, session.unwrap())
}

/// Of a tracking by this plugin, without parameters.
pub(crate) fn provenance(plugin_id: &str) -> Provenance {
    let word = || "test".to_owned();
    Provenance {
        what: "track".to_owned(),
        plugin_id: plugin_id.to_owned(),
        plugin_version: "0.1.0".to_owned(),
        plugin_sha256: word(),
        abi: (1, 0),
        params: std::iter::empty().collect(),
        seed: 0,
        input_revision: 0,
        sandbox: word(),
        simd: word(),
        date: "2026-11-22T18:20:33Z".to_owned(),
        honami_version: word(),
    }
}
