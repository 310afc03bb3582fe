//! When frames are written, and what is told of those that are not. No test waits: what is due is told by the test's clock.

use honami_model::track::{Quality, Sample, Source, TrackId};
use honami_store::RunHead;
use tempfile::TempDir;

use super::*;
use crate::session::Session;
use crate::tried::{project, provenance};

fn kept(hidden: TrackSet) -> (TempDir, Session, Kept) {
    let (folder, mut session) = project(4);
    let tracks: TrackSet = [TrackId(1), TrackId(2)].into_iter().collect();
    session.project.claim_tracks(&tracks).unwrap();
    let head = RunHead { provenance: provenance("org.honami.klt"), tracks, frames: 0..400 };
    let writer = session.project.begin_run(&head).unwrap();
    (folder, session, Kept::new(writer, 0, hidden))
}

fn rows() -> Rows {
    let (status, source, quality) = (Status::Tracked, Source::Tracked, Quality::default());
    [1, 2].map(|track| (TrackId(track), Sample { x: 1.0, y: 2.0, status, source, quality })).to_vec()
}

/// How many frames the project has of the run.
fn n_written(session: &Session, kept: &Kept) -> u32 {
    session.project.run(kept.writer.run()).unwrap().found.end
}

#[test]
fn frames_are_written_when_it_is_time_or_there_are_many() {
    let (_folder, session, mut kept) = kept(TrackSet::default());
    let before = Instant::now();
    kept.add(0, &rows()).unwrap();
    assert_eq!((kept.look(before), n_written(&session, &kept)), (1, 1), "the first at once");
    for frame in 1..4 {
        kept.add(frame, &rows()).unwrap();
    }
    // Whatever the write took, a quarter of a second has not passed by this clock, and the longest wait has by the other.
    assert_eq!((kept.look(before), n_written(&session, &kept)), (1, 1));
    let later = Instant::now() + WAIT_MAX;
    assert_eq!((kept.look(later), n_written(&session, &kept)), (4, 4));
    for frame in 4..4 + CHUNK as u32 {
        kept.add(frame, &rows()).unwrap();
    }
    let n = 4 + CHUNK as u32;
    assert_eq!((kept.look(before), n_written(&session, &kept)), (n, n), "many at once");
}

#[test]
fn the_next_write_waits_for_as_long_as_the_last_one_makes_worth_it() {
    for (took_ms, waits_ms) in [(0, 250), (2, 250), (5, 500), (50, 1000), (100, 1000), (3000, 30_000)] {
        let [took, waits] = [took_ms, waits_ms].map(Duration::from_millis);
        assert_eq!(wait_after(took), waits, "{took_ms} ms");
    }
}

#[test]
fn only_what_is_written_is_told() {
    struct Heard(Mutex<Vec<u64>>);
    impl Progress for Heard {
        fn report(&self, done: u64, _: u64, _: &str) -> Flow {
            hand(&self.0).push(done);
            Flow::Continue
        }
    }
    let (_folder, _session, mut kept) = kept(TrackSet::default());
    let heard = Heard(Mutex::default());
    kept.due = Some(Instant::now() + Duration::from_secs(3600));
    for frame in 0..3 {
        kept.add(frame, &rows()).unwrap();
    }
    let kept = Mutex::new(&mut kept);
    let keeper = Keeper { kept: &kept, progress: &heard };
    assert_eq!(keeper.report(3, 400, "frame"), Flow::Continue);
    hand(&kept).due = None;
    assert_eq!(keeper.report(3, 400, "frame"), Flow::Continue);
    // It has done more, on trial say, or is a tracker that gives its answers at the end: they are not written.
    assert_eq!(keeper.report(10, 400, "frame"), Flow::Continue);
    assert_eq!(*hand(&heard.0), [0, 3, 3]);
}

#[test]
fn what_was_hidden_is_so_in_the_first_frame() {
    let (_folder, session, mut kept) = kept([TrackId(2)].into_iter().collect());
    for frame in 0..3 {
        kept.add(frame, &rows()).unwrap();
    }
    kept.flush().unwrap();
    let spans = session.project.run_tracks(kept.writer.run()).unwrap();
    let statuses: Vec<Vec<Status>> =
        spans.iter().map(|(_, span)| span.samples.iter().map(|sample| sample.status).collect()).collect();
    let (seen, hidden) = (Status::Tracked, Status::Occluded);
    assert_eq!(statuses, [[seen; 3], [hidden, seen, seen]]);
}
