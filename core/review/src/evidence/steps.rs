//! What the steps from frame to frame say: the forward-backward error, and jumps.

use honami_model::track::{Sample, Span};

use super::anchors::Anchors;

/// A change of step is compared with the track's usual one and this, pixels: below it is noise.
const NOISE_PX: f32 = 0.25;

/// The largest forward-backward error and the largest jump since the last anchor, a pair a sample.
///
/// Before the first anchor, where a feature was tracked backwards, errors add up towards the clip's beginning.
pub(super) fn measure(span: &Span, anchors: &Anchors) -> Vec<(Option<f32>, Option<f32>)> {
    let changes = changes(span, anchors);
    let usual = median(changes.iter().copied().flatten()).unwrap_or(0.0) + NOISE_PX;
    let mut steps: Vec<(Option<f32>, Option<f32>)> = span
        .samples
        .iter()
        .zip(&changes)
        .map(|(sample, change)| (sample.quality.fb_px, change.map(|change| change / usual)))
        .collect();
    let places = anchors.as_slice().iter();
    let starts: Vec<usize> = places.map(|(frame, _)| (frame - span.first_frame) as usize).collect();
    let first = starts.first().copied().unwrap_or(steps.len());
    run_up(steps[..first].iter_mut().rev());
    for (k, &start) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(steps.len());
        steps[start] = (None, None);
        run_up(steps[start..end].iter_mut());
    }
    steps
}

/// The largest so far, in place; a step that was not measured changes nothing.
fn run_up<'a>(steps: impl Iterator<Item = &'a mut (Option<f32>, Option<f32>)>) {
    let mut so_far = (None, None);
    for step in steps {
        so_far = (larger(so_far.0, step.0), larger(so_far.1, step.1));
        *step = so_far;
    }
}

fn larger(a: Option<f32>, b: Option<f32>) -> Option<f32> {
    a.into_iter().chain(b).max_by(f32::total_cmp)
}

/// How far each step differs from the one before, pixels: |p(t) - 2 p(t-1) + p(t-2)|, where all three are seen and
/// no anchor lies between them, at which a corrected track jumps by right.
fn changes(span: &Span, anchors: &Anchors) -> Vec<Option<f32>> {
    let mut changes = vec![None; span.samples.len()];
    for (at, three) in span.samples.windows(3).enumerate() {
        changes[at + 2] = change(three);
    }
    for (frame, _) in anchors.as_slice() {
        let at = (frame - span.first_frame) as usize;
        changes.iter_mut().skip(at).take(2).for_each(|change| *change = None);
    }
    changes
}

fn change(three: &[Sample]) -> Option<f32> {
    let [a, b, c] = three else { return None };
    let seen = three.iter().all(|sample| sample.status.is_seen());
    seen.then(|| (c.x - 2.0 * b.x + a.x).hypot(c.y - 2.0 * b.y + a.y))
}

/// The middle value; of an even number the larger of the two in the middle.
pub(super) fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}
