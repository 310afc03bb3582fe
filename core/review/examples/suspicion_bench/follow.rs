//! Tracks of generated clips, their evidence, and which of their samples are bad.

use std::error::Error;
use std::sync::Arc;

use honami_model::track::{Quality, Sample, Source, Span, Status, TrackId};
use honami_review::evidence::{Evidence, Parts, Subject, is_judged};
use honami_review::suspicion::BAD_PX;
use honami_synth::{LeafTruth, Level, Picture, Scene, Settings};
use honami_vision::klt::{self, State};
use honami_vision::pyramid::Pyramid;

const LEVELS: u32 = 4;
/// The tracker that is reviewed, and the one beside it that some tracks were followed with too.
const RADII_PX: [u32; 2] = [10, 15];

/// One clip followed in one way.
pub(super) struct Case {
    pub(super) key_every: Option<u32>,
    pub(super) tracks: Vec<Track>,
}

/// A track of a clip.
pub(super) struct Track {
    /// The evidence of every visible judged sample, and whether it is bad.
    pub(super) samples: Vec<Option<(Parts, bool)>>,
}

/// The clip of a level and seed, followed without key-frames or with exact ones every so many frames.
pub(super) fn cases(level: Level, seed: u64, keyed: &[Option<u32>]) -> Result<Vec<Case>, Box<dyn Error>> {
    let scene = Scene::new(&Settings { seed, ..Settings::benchmark(level) })?;
    let pictures: Vec<Picture> = (0..scene.n_frames()).map(|frame| scene.render(frame)).collect();
    let leaves: Vec<&LeafTruth> = scene.truth().leaves.iter().filter(|leaf| leaf.path[0].visible).collect();
    let spans = |radius_px| -> Vec<Vec<Arc<Span>>> {
        let pyramids: Vec<Pyramid> =
            pictures.iter().map(|p| Pyramid::new(&p.planes().y, LEVELS, radius_px)).collect();
        keyed.iter().map(|&every| follow(&pyramids, radius_px, &leaves, every)).collect()
    };
    let (shown, beside) = (spans(RADII_PX[0]), spans(RADII_PX[1]));
    let each = keyed.iter().zip(shown.iter().zip(&beside));
    Ok(each.map(|(&key_every, (a, b))| case(key_every, (a, b), &leaves, &pictures)).collect())
}

fn case(
    key_every: Option<u32>,
    (shown, beside): (&[Arc<Span>], &[Arc<Span>]),
    leaves: &[&LeafTruth],
    pictures: &[Picture],
) -> Case {
    let subject = |(k, leaf): (usize, &&LeafTruth)| Subject {
        track: TrackId(leaf.id),
        span: Arc::clone(&shown[k]),
        // Half of them were followed by one tracker only.
        rivals: if k % 2 == 0 { vec![Arc::clone(&shown[k]), Arc::clone(&beside[k])] } else { Vec::new() },
        unseen: Vec::new(),
    };
    let mut evidence = Evidence::new(leaves.iter().enumerate().map(subject).collect(), 2);
    let mut correlator = evidence.correlator(&evidence.tracks().collect::<Vec<_>>());
    for frame in correlator.template_frames() {
        correlator.cut(frame, &pictures[frame as usize].planes().y);
    }
    for frame in correlator.sample_frames() {
        correlator.look(frame, &pictures[frame as usize].planes().y);
    }
    evidence.correlated(correlator);
    let track = |(leaf, span): (&&LeafTruth, &Arc<Span>)| {
        let parts = evidence.parts(TrackId(leaf.id)).unwrap_or_default();
        let each = span.frames().zip(&span.samples).zip(parts);
        let samples = each.map(|((frame, sample), parts)| {
            let truth = leaf.path[frame as usize];
            let error_px = (f64::from(sample.x) - truth.x).hypot(f64::from(sample.y) - truth.y);
            (truth.visible && is_judged(sample)).then_some((parts, error_px > BAD_PX))
        });
        Track { samples: samples.collect() }
    };
    Case { key_every, tracks: leaves.iter().zip(shown).map(track).collect() }
}

/// Follows the leaves, from their true places in the first frame and in the key-frames; one span a leaf.
fn follow(pyramids: &[Pyramid], radius_px: u32, leaves: &[&LeafTruth], every: Option<u32>) -> Vec<Arc<Span>> {
    let params = klt::Params { radius_px, ..klt::Params::default() };
    let true_place = |leaf: &LeafTruth, frame: usize| [leaf.path[frame].x as f32, leaf.path[frame].y as f32];
    let mut last: Vec<Sample> = leaves.iter().map(|leaf| sample(true_place(leaf, 0), None)).collect();
    let mut spans: Vec<Span> =
        last.iter().map(|&first| Span { first_frame: 0, samples: vec![first] }).collect();
    for frame in 1..pyramids.len() {
        let (before, now) = (&pyramids[frame - 1], &pyramids[frame]);
        let from: Vec<_> = last.iter().map(|sample| [sample.x, sample.y]).collect();
        let there = klt::track(before, now, &from, None, &params, 2);
        let to: Vec<_> = there.iter().map(|flow| flow.to).collect();
        let back = klt::track(now, before, &to, None, &params, 2);
        for (k, leaf) in leaves.iter().enumerate() {
            // Not all in the same frame, as a person would.
            let is_key = every.is_some_and(|n| (frame as u32 + 13 * k as u32).is_multiple_of(n));
            last[k] = if is_key && leaf.path[frame].visible {
                Sample { source: Source::Key, ..sample(true_place(leaf, frame), None) }
            } else if last[k].status != Status::Tracked {
                last[k]
            } else if there[k].state == State::Tracked {
                let fb_px = (back[k].to[0] - from[k][0]).hypot(back[k].to[1] - from[k][1]);
                sample(to[k], (back[k].state == State::Tracked).then_some(fb_px))
            } else {
                Sample { status: Status::Outside, quality: Quality::default(), ..last[k] }
            };
            spans[k].samples.push(last[k]);
        }
    }
    spans.into_iter().map(Arc::new).collect()
}

fn sample([x, y]: [f32; 2], fb_px: Option<f32>) -> Sample {
    let quality = Quality { fb_px, ncc: None };
    Sample { x, y, status: Status::Tracked, source: Source::Tracked, quality }
}
