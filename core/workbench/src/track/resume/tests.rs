//! Which run is gone on with, and from where.

use std::ops::Range;
use std::path::{Path, PathBuf};

use honami_model::track::{Quality, Sample, Source};
use honami_store::RunHead;

use super::*;
use crate::tried::{project, provenance};

const N_FRAMES: u32 = 8;

fn sample(track: u32, frame: u32, status: Status) -> Sample {
    let (source, quality) = (Source::Tracked, Quality::default());
    Sample { x: 5.0 * track as f32, y: frame as f32, status, source, quality }
}

/// A run of some tracks through frames from 0 on that is shown; an early one has ended before the clip.
fn run(
    session: &mut Session,
    tracks: Range<u32>,
    frames: u32,
    status: impl Fn(u32, u32) -> Status,
    asked: &str,
) -> RunId {
    let provenance = provenance("org.honami.klt");
    let set: TrackSet = tracks.clone().map(TrackId).collect();
    let document = session.project.document();
    let new: TrackSet = set.iter().filter(|&track| document.track(track).is_none()).collect();
    session.project.claim_tracks(&new).unwrap();
    let head = RunHead { provenance, tracks: set.clone(), frames: 0..N_FRAMES };
    let mut writer = session.project.begin_run(&head).unwrap();
    if !asked.is_empty() {
        writer.keep_request(asked).unwrap();
    }
    let rows = |frame: u32| {
        tracks.clone().map(|track| (TrackId(track), sample(track, frame, status(track, frame)))).collect()
    };
    writer.append(0, &(0..frames).map(rows).collect::<Vec<Vec<_>>>()).unwrap();
    let run = if frames < N_FRAMES { writer.abandon("stopped") } else { writer.finish() }.unwrap();
    session.project.commit(Transaction::show_run(run, set)).unwrap();
    run
}

#[test]
fn the_newest_early_run_that_nothing_newer_has_replaced_is_gone_on_with() {
    let (_folder, mut session) = project(N_FRAMES);
    let seen = |_, _| Status::Tracked;
    let asked = Asked::default().text();
    assert_eq!(unfinished(&session.project).unwrap(), None);
    let first = run(&mut session, 1..4, 5, seen, &asked);
    run(&mut session, 2..3, N_FRAMES, seen, &asked);
    assert_eq!(unfinished(&session.project).unwrap(), Some(first), "two of its tracks are its own");
    run(&mut session, 1..6, N_FRAMES, seen, &asked);
    assert_eq!(unfinished(&session.project).unwrap(), None, "it is replaced");
    let second = run(&mut session, 1..3, 5, seen, &asked);
    assert_eq!(unfinished(&session.project).unwrap(), Some(second));
    let on = Asked { resumes: Some(second.0), ..Asked::default() }.text();
    let third = run(&mut session, 1..2, 6, seen, &on);
    assert_eq!(unfinished(&session.project).unwrap(), Some(third), "it goes on with the one before");
    run(&mut session, 1..2, N_FRAMES, seen, &on);
    assert_eq!(unfinished(&session.project).unwrap(), None, "all are gone on with");
}

#[test]
fn hidden_features_are_gone_on_with_and_those_that_are_lost_or_outside_are_not() {
    let (_folder, mut session) = project(N_FRAMES);
    let status = |track, frame| match (track, frame) {
        (_, 4) | (2, 3) => Status::Occluded,
        (3, 2..) => Status::Lost,
        (4, 3) => Status::Outside,
        _ => Status::Tracked,
    };
    let run = run(&mut session, 1..5, 5, status, "");
    let clip = session.media.clip();
    let seed = |track: u32| Seed { frame: 3, track: TrackId(track), x: 5.0 * track as f32, y: 3.0 };
    // In frame 4 none is seen.
    let hidden: TrackSet = [TrackId(2)].into_iter().collect();
    assert_eq!(seen_last(&session.project, run, clip).unwrap(), (vec![seed(1), seed(2)], hidden));
}

#[test]
fn why_a_run_cannot_be_gone_on_with_is_told_as_it_is() {
    let (_folder, mut session) = project(N_FRAMES);
    let seen = |_, _| Status::Tracked;
    let through = run(&mut session, 1..2, N_FRAMES, seen, &Asked::default().text());
    let bare = run(&mut session, 2..3, 5, seen, "");
    let broken = run(&mut session, 3..4, 5, seen, "{\"seeds\":7}");
    for (run, wanted) in [
        (through, "run 1 has not ended early"),
        (bare, "what run 2 was asked for is not kept"),
        (broken, "what run 3 was asked for is not kept in the project, or cannot be read"),
    ] {
        let told = resume(&mut session, run).err().unwrap().to_string();
        assert!(told.starts_with(wanted), "{told}");
    }
}

#[test]
fn the_mask_of_a_run_is_kept_with_its_whole_path() {
    let mut request = TrackRequest {
        plugin: "klt".to_owned(),
        params: Values::default(),
        points: PointSource::Detect,
        frames: 0..1,
        every: None,
        area: Area::Mask(PathBuf::from("mask.png")),
    };
    let wanted = std::env::current_dir().unwrap().join("mask.png");
    assert_eq!(Asked::of(&request, &[], None).area, Area::Mask(wanted));
    let there = Area::Mask(Path::new("/there/mask.png").to_owned());
    request.area = there.clone();
    assert_eq!(Asked::of(&request, &[], None).area, there);
}
