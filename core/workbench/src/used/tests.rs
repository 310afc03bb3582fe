//! Plugins that come and go, and what they were told.

use honami_host::Value;
use honami_model::edit::Transaction;
use honami_model::track::{Quality, Sample, Source, Status, TrackId, TrackSet};
use honami_store::RunHead;
use honami_synth::Settings;

use super::*;
use crate::generate::generate;
use crate::session::Session;
use crate::tried::provenance;

const SNAIL: &str = "org.lab.snail";

/// Keeps a run of a plugin that was told this, and shows it.
fn run(session: &mut Session, plugin: &str, told: &[(&str, Value)]) {
    let params = told.iter().map(|(id, value)| ((*id).to_owned(), value.clone())).collect();
    let provenance = Provenance { params, ..provenance(plugin) };
    let (source, quality) = (Source::Tracked, Quality { fb_px: None, ncc: None });
    let sample = Sample { x: 1.0, y: 2.0, status: Status::Tracked, source, quality };
    let tracks: TrackSet = [TrackId(1)].into_iter().collect();
    if session.project.document().track(TrackId(1)).is_none() {
        session.project.claim_tracks(&tracks).unwrap();
    }
    let head = RunHead { provenance, tracks: tracks.clone(), frames: 0..1 };
    let mut writer = session.project.begin_run(&head).unwrap();
    writer.append(0, &[vec![(TrackId(1), sample)]]).unwrap();
    let run = writer.finish().unwrap();
    session.project.commit(Transaction::show_run(run, tracks)).unwrap();
}

#[test]
fn what_a_plugin_was_told_outlives_its_absence_and_older_builds() {
    let folder = tempfile::tempdir().unwrap();
    let (clip, path) = (folder.path().join("clip.y4m"), folder.path().join("p.honami"));
    let settings = Settings { width: 64, height: 48, n_frames: 4, n_leaves: 2, ..Settings::default() };
    generate(&settings, &clip, &()).unwrap();
    drop(Session::create(&path, &clip, None, &Default::default()).unwrap());
    let open = || Session::open(&path, &Default::default()).unwrap();
    let snail = |session: &Session, renamed: &[(&str, &str)]| {
        let renamed = renamed.iter().map(|(old, new)| ((*old).to_owned(), (*new).to_owned())).collect();
        let mut used = Used::default();
        used.look(&session.project).unwrap();
        used.values(SNAIL, &renamed)
    };
    let values = |told: &[(&str, Value)]| -> Values {
        told.iter().map(|(id, value)| ((*id).to_owned(), value.clone())).collect()
    };
    assert_eq!(snail(&open(), &[]), Values::default());
    // A newer build has a parameter that the older one of the next run knows nothing of.
    let (pace, slime) = (("pace", Value::Float(0.1)), ("slime", Value::Text("much".to_owned())));
    let kept = [pace.clone(), slime.clone()];
    run(&mut open(), SNAIL, &kept);
    let written = |session: &Session| session.project.runs().unwrap()[0].head.provenance.clone();
    let first = written(&open());
    // It is not there, and the project is worked on.
    run(&mut open(), "org.honami.klt", &[("pace", Value::Float(9.0))]);
    assert_eq!(snail(&open(), &[]), values(&kept));
    assert_eq!(written(&open()), first);
    // It is back, first as an older build, then as a newer one that calls the pace by another name.
    run(&mut open(), SNAIL, &[("pace", Value::Float(0.25))]);
    assert_eq!(snail(&open(), &[]), values(&[("pace", Value::Float(0.25)), slime.clone()]));
    run(&mut open(), SNAIL, &[("stride", Value::Float(0.5))]);
    let mut session = open();
    let (pace, stride) = (("pace", "stride"), |x: f64| ("stride", Value::Float(x)));
    assert_eq!(snail(&session, &[pace]), values(&[slime.clone(), stride(0.5)]));
    // Undone runs are.
    session.project.undo().unwrap();
    assert_eq!(snail(&session, &[pace]), values(&[slime, stride(0.25)]));
    assert_eq!(written(&session), first);
}

#[test]
fn what_has_not_changed_is_not_looked_at_again() {
    let folder = tempfile::tempdir().unwrap();
    let clip = folder.path().join("clip.y4m");
    let settings = Settings { width: 64, height: 48, n_frames: 4, n_leaves: 2, ..Settings::default() };
    generate(&settings, &clip, &()).unwrap();
    let path = folder.path().join("p.honami");
    let mut session = Session::create(&path, &clip, None, &Default::default()).unwrap();
    let mut used = Used::default();
    assert!(!used.look(&session.project).unwrap());
    run(&mut session, SNAIL, &[]);
    assert_eq!([(); 2].map(|()| used.look(&session.project).unwrap()), [true, false]);
}
