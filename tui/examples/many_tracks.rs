//! Makes a project of 10,000 tracks on a clip, for measuring how soon the screen is there.
//!
//! `many_tracks CLIP PROJECT.honami`

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::Context as _;
use honami_model::edit::Transaction;
use honami_model::provenance::Provenance;
use honami_model::track::{Quality, Sample, Source, Status, TrackId};
use honami_workbench::session::{Session, SessionOptions};
use honami_workbench::store::{self, RunHead};

const N_TRACKS: u32 = 10_000;
/// Frames that are written at once.
const CHUNK: u32 = 64;

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args_os().skip(1).map(PathBuf::from);
    let (clip, file) = words.next().zip(words.next()).context("a clip and a project are wanted")?;
    let mut session = Session::create(&file, &clip, None, &SessionOptions::default())?;
    let project = &mut session.project;
    let clip = project.clip().clip.clone();
    let numbers = project.reserve_tracks(N_TRACKS)?;
    let provenance = Provenance {
        what: "track".to_owned(),
        plugin_id: "org.honami.klt".to_owned(),
        plugin_version: "0.1.0".to_owned(),
        plugin_sha256: String::new(),
        abi: (1, 0),
        params: BTreeMap::new(),
        seed: 0,
        input_revision: 0,
        sandbox: "in process".to_owned(),
        simd: "none".to_owned(),
        date: store::now(),
        honami_version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let tracks = numbers.clone().map(TrackId).collect();
    let mut writer = project.begin_run(&RunHead { provenance, tracks, frames: 0..clip.n_frames() })?;
    for first in (0..clip.n_frames()).step_by(CHUNK as usize) {
        let frames: Vec<Vec<_>> = (first..clip.n_frames().min(first + CHUNK))
            .map(|frame| {
                let sample = |n| (TrackId(n), sample(n, frame, (clip.width, clip.height)));
                numbers.clone().map(sample).collect()
            })
            .collect();
        writer.append(first, &frames)?;
    }
    let run = writer.finish()?;
    let found = project.run(run)?.tracks;
    project.commit(Transaction::show_run(run, found))?;
    Ok(())
}

fn sample(track: u32, frame: u32, (width, height): (u32, u32)) -> Sample {
    let quality = Quality { fb_px: Some(0.25), ncc: Some(0.9) };
    let sway = 1.0 + (frame as f32 * 0.1).sin();
    let (x, y) = ((track * 7 % (width - 2)) as f32 + sway, (track * 3 % height) as f32);
    Sample { x, y, status: Status::Tracked, source: Source::Tracked, quality }
}
