//! What checks of trackers share: a tracker with its defaults, led through a clip.

use crate::clip::Clip;
use crate::{Fault, Subject, Verdict};
use honami_abi::code;
use honami_host::{
    CallContext, HostError, Hosting, Kind, ParamKind, Point, PointRow, Points, StreamInfo, Tracker, Values,
};

/// Where plugins work in all checks but those of where they work: here, so that what they do to memory is seen.
/// Programs have processes of their own all the same.
pub(crate) const HERE: Hosting = Hosting::InProcess;

/// A tracker with its defaults.
pub(crate) fn tracker(subject: &Subject) -> Result<Tracker, HostError> {
    subject.tracker(HERE, &Values::default())
}

/// A check of trackers alone, and of those that work with what every honami has.
pub(crate) fn of_tracker(
    subject: &Subject,
    check: fn(&Subject) -> Result<Verdict, Fault>,
) -> Result<Verdict, Fault> {
    if subject.info.kind != Kind::Tracker {
        return Ok(Verdict::Beside(format!("it is a {}", subject.info.kind)));
    }
    of_able(subject, check)
}

/// A check of plugins that work with what every honami has.
pub(crate) fn of_able(
    subject: &Subject,
    check: fn(&Subject) -> Result<Verdict, Fault>,
) -> Result<Verdict, Fault> {
    match file_missed(subject)? {
        Some(why) => Ok(Verdict::Beside(why)),
        None => check(subject),
    }
}

/// Why a tracker does not start without a file that only its user has.
pub(crate) fn file_missed(subject: &Subject) -> Result<Option<String>, Fault> {
    let is_open = |kind: &ParamKind| matches!(kind, ParamKind::Path { default, .. } if default.is_empty());
    let path = subject.info.params.iter().find(|param| is_open(&param.kind));
    let Some(path) = path.filter(|_| subject.info.kind == Kind::Tracker) else { return Ok(None) };
    let stream = Clip::new([64, 48], 1, |_, _| 0.0).stream();
    // In a process of its own: this one may start others no more once something of the plugin has run in it.
    let mut tracker = subject.tracker(Hosting::Isolated, &Values::default())?;
    Ok(match tracker.begin(stream, &CallContext::silent()) {
        Err(HostError::Failed { text, .. }) => Some(format!("it needs a file for {} ({text})", path.id)),
        Err(error) => return Err(error.into()),
        Ok(()) => None,
    })
}

/// The words of a plugin that says that it cannot work on this, which it may.
pub(crate) fn refusal(error: &HostError) -> Option<&str> {
    match error {
        HostError::Failed { code, text, .. }
            if [code::DATA, code::UNSUPPORTED, code::ARGUMENT, code::IO].contains(&code.0)
                && text != "gives no reason" =>
        {
            Some(text)
        }
        _ => None,
    }
}

/// Begins, seeds before the first frame, pushes all frames, ends. Gives the points of every frame, in order.
pub(crate) fn follow(tracker: &mut Tracker, clip: &Clip, seeds: &[Point]) -> Result<Vec<Points>, HostError> {
    follow_in(tracker, clip, seeds, clip.stream())
}

/// The same in a stream that is more than the clip says.
pub(crate) fn follow_in(
    tracker: &mut Tracker,
    clip: &Clip,
    seeds: &[Point],
    stream: StreamInfo,
) -> Result<Vec<Points>, HostError> {
    let cx = CallContext::silent();
    tracker.begin(stream, &cx)?;
    tracker.seed(seeds, &cx)?;
    let mut all = Vec::with_capacity(clip.pictures.len());
    for t in 0..clip.pictures.len() {
        all.extend(tracker.push(&clip.view(t), &cx)?);
    }
    all.extend(tracker.end(&cx)?);
    Ok(all)
}

/// The row of a point in a frame.
pub(crate) fn row(points: &Points, id: u32) -> Option<&PointRow> {
    points.rows.iter().find(|row| row.id == id)
}

/// Whether a row has a point exactly where it was seeded.
pub(crate) fn is_at(row: &PointRow, point: &Point) -> bool {
    row.x.to_bits() == point.x.to_bits() && row.y.to_bits() == point.y.to_bits()
}

/// What an error says after what it happened in.
pub(crate) fn at(place: impl std::fmt::Display) -> impl FnOnce(HostError) -> Fault {
    move |error| Fault(format!("{place}: {error}"))
}

/// The first difference of two results that should have the same bits, in words.
pub(crate) fn difference(a: &[Points], b: &[Points]) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} frames, and {}", a.len(), b.len()));
    }
    let (a, b) = a.iter().zip(b).find(|(a, b)| a != b)?;
    let rows = a.rows.iter().zip(&b.rows).find(|(a, b)| a != b);
    Some(match rows {
        Some((a_row, b_row)) => format!("frame {}: {}, and {}", a.frame, words(a_row), words(b_row)),
        None => format!("frame {}: {} points, and {}", a.frame, a.rows.len(), b.rows.len()),
    })
}

/// A row as one reads it in a report.
pub(crate) fn words(row: &PointRow) -> String {
    format!("point {} at ({}, {}) {:?}", row.id, row.x, row.y, row.status)
}
