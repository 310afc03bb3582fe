//! What the tests of this crate begin with: a folder, a clip, a project, samples.

use std::collections::BTreeMap;
use std::path::PathBuf;

use honami_model::clip::{Clip, FrameTimes};
use honami_model::provenance::{Provenance, Value};
use honami_model::track::{Quality, Sample, Source, Status, TrackId, TrackSet};
use tempfile::TempDir;

use crate::{ClipRecord, Project, RunHead};

pub(crate) const N_FRAMES: u32 = 200;

/// A folder with a project in it; both go when it is dropped.
pub(crate) struct Bench {
    pub(crate) folder: TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.path().join("plant.honami")
    }

    pub(crate) fn record(&self) -> ClipRecord {
        let times = FrameTimes::constant(N_FRAMES, 25.0).unwrap();
        ClipRecord {
            path: self.folder.path().join("clip.mp4"),
            sha256: "0123456789abcdef".to_owned(),
            fps_override: Some(25.0),
            clip: Clip { width: 64, height: 48, times },
        }
    }

    pub(crate) fn create(&self) -> Project {
        Project::create(&self.path(), &self.record()).unwrap()
    }

    /// The names in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

pub(crate) fn tracks(numbers: std::ops::Range<u32>) -> TrackSet {
    numbers.map(TrackId).collect()
}

pub(crate) fn provenance(what: &str, input_revision: u32) -> Provenance {
    Provenance {
        what: what.to_owned(),
        plugin_id: "org.honami.klt".to_owned(),
        plugin_version: "0.1.0".to_owned(),
        plugin_sha256: "feed".to_owned(),
        abi: (1, 0),
        params: BTreeMap::from([
            ("radius".to_owned(), Value::Int(10)),
            ("eps".to_owned(), Value::Float(0.01)),
        ]),
        seed: u64::MAX,
        input_revision,
        sandbox: "in process".to_owned(),
        simd: "avx2".to_owned(),
        date: "2026-01-02T03:04:05Z".to_owned(),
        honami_version: "0.1.0".to_owned(),
    }
}

pub(crate) fn head(numbers: std::ops::Range<u32>) -> RunHead {
    RunHead { provenance: provenance("track", 0), tracks: tracks(numbers), frames: 0..N_FRAMES }
}

/// A sample whose every part depends on track and frame.
pub(crate) fn sample(track: u32, frame: u32) -> Sample {
    let seed = track * 31 + frame * 7;
    Sample {
        x: frame as f32 + 0.25,
        y: track as f32 * 1.5,
        status: Status::from_u8((seed % 6) as u8).unwrap(),
        source: Source::Tracked,
        quality: Quality {
            fb_px: (!seed.is_multiple_of(3)).then_some(seed as f32 / 9.0),
            ncc: (!seed.is_multiple_of(4)).then_some(-0.5),
        },
    }
}

/// Frames of all these tracks.
pub(crate) fn rows(
    numbers: std::ops::Range<u32>,
    frames: std::ops::Range<u32>,
) -> Vec<Vec<(TrackId, Sample)>> {
    frames
        .map(|frame| numbers.clone().map(|track| (TrackId(track), sample(track, frame))).collect())
        .collect()
}

/// A project in which one run over all frames has found these tracks and is shown.
pub(crate) fn tracked(bench: &Bench, numbers: std::ops::Range<u32>) -> Project {
    let mut project = bench.create();
    project.reserve_tracks(numbers.end).unwrap();
    let mut writer = project.begin_run(&head(numbers.clone())).unwrap();
    writer.append(0, &rows(numbers.clone(), 0..N_FRAMES)).unwrap();
    let run = writer.finish().unwrap();
    project.commit(honami_model::edit::Transaction::show_run(run, tracks(numbers))).unwrap();
    project
}
