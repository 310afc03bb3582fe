//! Detection: where features may be, which come first, and that it disturbs nobody.

use super::{Case, DEADLINE, SIZE, shift};
use crate::clip::Clip;
use crate::course::{difference, follow, of_tracker, tracker};
use crate::{Check, Fault, Subject, Verdict};
use honami_host::{CallContext, DetectRequest, Feature, HostError, Point, Points, Tracker};
use honami_model::picture::Gray;

pub(super) const CHECKS: &[Check] = &[
    Check {
        id: "truth.detect",
        level: 7,
        claim: "features are where they are wanted, on what can be followed, best first",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, detect),
    },
    Check {
        id: "truth.aside",
        level: 7,
        claim: "detection and dense motion between two frames change nothing of what is tracked",
        deadline: DEADLINE,
        run: |subject| of_tracker(subject, aside),
    },
];

const DETECT: &str = "honami.detect/1";
const FIELD: &str = "honami.field/1";
/// Features to ask for.
const N: u32 = 20;
/// A feature that is nearer to a point than this is that point.
const SAME_PX: f32 = 1.0;

fn find(
    tracker: &mut Tracker,
    clip: &Clip,
    max_features: u32,
    mask: Option<&[u8]>,
    points: &[Point],
) -> Result<Vec<Feature>, HostError> {
    let mask = mask.map(|mask| Gray::packed(mask, SIZE[0], SIZE[1]));
    let wanted = DetectRequest { frame: clip.view(0), max_features, mask, points, max_threads: 1, seed: 1 };
    tracker.detect(&wanted, &CallContext::silent())
}

fn place(feature: &Feature) -> String {
    format!("({}, {})", feature.x, feature.y)
}

/// A clip whose left third is plain.
fn half_plain(subject: &Subject) -> (Clip, f32) {
    let (mut clip, _) = Case::moving(shift).texture(subject);
    let (width, plain) = (SIZE[0] as usize, SIZE[0] as usize / 3);
    clip.pictures.iter_mut().for_each(|p| p.luma.chunks_mut(width).for_each(|row| row[..plain].fill(128)));
    (clip, plain as f32)
}

fn detect(subject: &Subject) -> Result<Verdict, Fault> {
    if !subject.info.offers(DETECT) {
        return Ok(Verdict::Beside("it detects nothing".into()));
    }
    let (clip, plain) = half_plain(subject);
    let mut tracker = tracker(subject)?;
    let all = find(&mut tracker, &clip, N, None, &[])?;
    if all.is_empty() {
        return Err(Fault("it found nothing in a texture".into()));
    }
    if let Some(pair) = all.windows(2).find(|pair| pair[0].score < pair[1].score) {
        return Err(Fault(format!("the feature at {} came before a better one", place(&pair[0]))));
    }
    if !find(&mut tracker, &clip, 0, None, &[])?.is_empty() {
        return Err(Fault("it found features when 0 were wanted".into()));
    }
    masked(&mut tracker, &clip)?;
    let there: Vec<_> = all.iter().zip(1..).map(|(f, id)| Point { id, x: f.x, y: f.y }).collect();
    let more = find(&mut tracker, &clip, N, None, &there)?;
    let near = |feature: &&Feature| {
        there.iter().any(|point| (point.x - feature.x).hypot(point.y - feature.y) < SAME_PX)
    };
    if let Some(feature) = more.iter().find(near) {
        return Err(Fault(format!("it found {} again, where a point is", place(feature))));
    }
    // The gradient of the edge reaches into what is plain.
    if let Some(feature) = all.iter().find(|feature| feature.x < plain - 4.0) {
        return Ok(Verdict::Doubtful(format!("it found {}, where the picture is plain", place(feature))));
    }
    Ok(Verdict::Holds(format!("{} features", all.len())))
}

/// Where the mask has nothing there is nothing to find.
fn masked(tracker: &mut Tracker, clip: &Clip) -> Result<(), Fault> {
    let nothing = vec![0; clip.pictures[0].luma.len()];
    if let Some(feature) = find(tracker, clip, N, Some(&nothing), &[])?.first() {
        return Err(Fault(format!("it found {}, where the mask is empty", place(feature))));
    }
    let width = SIZE[0] as usize;
    let allowed = |k: usize| k % width >= 80 && k / width < 60;
    let mask: Vec<u8> = (0..nothing.len()).map(|k| u8::from(allowed(k))).collect();
    let at = |feature: &Feature| (feature.y.round() as usize) * width + feature.x.round() as usize;
    let found = find(tracker, clip, N, Some(&mask), &[])?;
    if let Some(feature) =
        found.iter().find(|feature| mask.get(at(feature)).is_none_or(|allowed| *allowed == 0))
    {
        return Err(Fault(format!("it found {}, where the mask does not allow it", place(feature))));
    }
    Ok(())
}

fn aside(subject: &Subject) -> Result<Verdict, Fault> {
    let (detects, measures) = (subject.info.offers(DETECT), subject.info.offers(FIELD));
    if !(detects || measures) || !subject.info.caps.deterministic {
        return Ok(Verdict::Beside("it does neither, or its results differ anyway".into()));
    }
    let (clip, seeds) = Case::moving(shift).texture(subject);
    let (other, _) = half_plain(subject);
    let alone = follow(&mut tracker(subject)?, &clip, &seeds)?;
    let (mut tracker, cx) = (tracker(subject)?, CallContext::silent());
    let mut between: Vec<Points> = Vec::new();
    tracker.begin(clip.stream(), &cx)?;
    tracker.seed(&seeds, &cx)?;
    for t in 0..clip.pictures.len() {
        between.extend(tracker.push(&clip.view(t), &cx)?);
        if detects {
            find(&mut tracker, &other, N, None, &seeds)?;
        }
        if measures && t % 4 == 1 {
            tracker.field(&other.view(0), &other.view(5), 1, &cx)?;
        }
    }
    between.extend(tracker.end(&cx)?);
    Ok(match difference(&alone, &between) {
        Some(what) => return Err(Fault(format!("without and with them: {what}"))),
        None => Verdict::Holds(String::new()),
    })
}
