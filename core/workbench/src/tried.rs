//! What tests of projects begin with: a small project, and the provenance of a run in it.

use honami_model::edit::Transaction;
use honami_model::hierarchy::{Dendrogram, Merge};
use honami_model::provenance::Provenance;
use honami_model::track::TrackId;
use honami_store::Clustering;
use honami_synth::Settings;
use tempfile::TempDir;

use crate::generate::generate;
use crate::import::{self, ImportRequest};
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

/// Two tracks that stand still, at (10, 10) and at (50, 30), each its own group.
pub(crate) fn grouped() -> (TempDir, Session) {
    let (folder, mut session) = project(6);
    let row = |track: u32, frame: u32, x: u32, y: u32| format!("{track},{frame},{x},{y}\n");
    let rows: String = (0..6).flat_map(|frame| [row(0, frame, 10, 10), row(1, frame, 50, 30)]).collect();
    let file = folder.path().join("t.csv");
    std::fs::write(&file, format!("track,frame,x,y\n{rows}")).unwrap();
    let request = ImportRequest {
        file,
        format: None,
        origin: None,
        size: None,
        camera: None,
        pixel_size: None,
        keys: false,
    };
    import::tracks(&mut session.project, &request, &()).unwrap();
    let tracks = vec![TrackId(0), TrackId(1)];
    let dendrogram = Dendrogram::new(2, vec![Merge { a: 0, b: 1, height: 1.0, size: 2 }]).unwrap();
    let provenance = provenance("test");
    let made = Clustering { provenance, tracks, dendrogram, cut: 2, outlier_frames: vec![], notes: vec![] };
    let id = session.project.save_clustering(&made).unwrap();
    session.project.commit(Transaction::show_clustering(id, 2)).unwrap();
    (folder, session)
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
