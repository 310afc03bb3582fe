//! Times the review queue with 100,000 items, and an edit of one track of 10,000; prints one JSON line.

use std::sync::Arc;
use std::time::{Duration, Instant};

use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_review::Review;
use honami_review::evidence::{Evidence, Kind, Subject};
use honami_review::queue::{Item, Queue};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const N_ITEMS: u32 = 100_000;
/// The tracks are in so many groups.
const N_GROUPS: u32 = 12;
const N_TRACKS: u32 = 10_000;
const N_FRAMES: u32 = 378;
const REPEATS: u32 = 200;

fn item(rng: &mut Pcg64Mcg, track: u32, k: u32) -> Item {
    let (reasons, parts) = Default::default();
    let suspicion = rng.random_range(0.2..1.0);
    Item {
        track: TrackId(track),
        frames: 40 * k..40 * k + 20,
        worst: 40 * k,
        reasons,
        measured: 40 * k,
        parts,
        opponent: None,
        suspicion,
        later: false,
    }
}

/// A walk about a place, with a forward-backward error a step.
fn subject(rng: &mut Pcg64Mcg, track: u32) -> Subject {
    let mut at = [rng.random_range(0.0..1920.0_f32), rng.random_range(0.0..1080.0_f32)];
    let sample = |frame| {
        at = at.map(|c| c + rng.random_range(-2.0..2.0_f32));
        let quality = Quality { fb_px: (frame > 0).then(|| rng.random_range(0.0..0.5)), ncc: None };
        Sample { x: at[0], y: at[1], status: Status::Tracked, source: Source::Tracked, quality }
    };
    let span = Span { first_frame: 0, samples: (0..N_FRAMES).map(sample).collect() };
    let (span, kind) = (Arc::new(span), Kind::Stepwise);
    Subject { track: TrackId(track), kind, span, rivals: Vec::new(), unseen: Vec::new() }
}

/// The longest of many times, milliseconds.
fn longest_ms(times: impl Iterator<Item = Duration>) -> f64 {
    1e3 * times.max().unwrap_or_default().as_secs_f64()
}

#[expect(clippy::print_stdout, reason = "the result of a benchmark")]
fn main() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut queue = Queue::new((0..N_ITEMS).map(|k| item(&mut rng, k / 10, k % 10)));
    let mut rank = queue.first().map(Item::rank);
    let next = (0..REPEATS).map(|_| {
        let begun = Instant::now();
        rank = rank.and_then(|rank| queue.after(rank)).map(Item::rank);
        begun.elapsed()
    });
    let next_ms = longest_ms(next);
    let rank_ms = longest_ms((0..REPEATS).map(|track| {
        let items: Vec<Item> = (0..10).map(|k| item(&mut rng, track, k)).collect();
        let begun = Instant::now();
        queue.set(TrackId(track), items);
        begun.elapsed()
    }));

    let subjects: Vec<Subject> = (0..N_TRACKS).map(|track| subject(&mut rng, track)).collect();
    let begun = Instant::now();
    let mut evidence = Evidence::new(subjects, 2);
    let measure_s = begun.elapsed().as_secs_f64();
    let (mut review, none) = (Review::default(), Default::default());
    let begun = Instant::now();
    let tracks: Vec<TrackId> = evidence.tracks().collect();
    tracks.into_iter().for_each(|track| review.set(track, evidence.segments(track, &none)));
    let segment_s = begun.elapsed().as_secs_f64();
    let mut edit_ms = |evidence: &mut Evidence, review: &mut Review| {
        longest_ms((0..20).map(|track| {
            let edited = subject(&mut rng, track);
            let begun = Instant::now();
            for track in evidence.replace(edited) {
                review.set(track, evidence.segments(track, &none));
            }
            begun.elapsed()
        }))
    };
    let alone_ms = edit_ms(&mut evidence, &mut review);
    let begun = Instant::now();
    evidence.group((0..N_TRACKS).map(|track| (TrackId(track), track % N_GROUPS)).collect());
    let group_s = begun.elapsed().as_secs_f64();
    let grouped_ms = edit_ms(&mut evidence, &mut review);
    let line = serde_json::json!({
        "items": N_ITEMS, "next_item_ms": next_ms, "re_rank_track_ms": rank_ms,
        "tracks": N_TRACKS, "frames": N_FRAMES, "measure_all_s": measure_s, "segments_all_s": segment_s,
        "group_all_s": group_s,
        "edit_to_ranking_ms": alone_ms, "edit_to_ranking_grouped_ms": grouped_ms, "queue": review.queue.len(),
    });
    println!("{line}");
}
