//! Mattes of later frames: the marks of one are carried on by the motion of tracks, and the matte is found anew.

use honami_matting::{MattingError, Moved, Options, PartsWish, carry as carry_marks};
use honami_model::document::MatteId;
use honami_model::provenance::Value;
use honami_store::{KeptMatte, Project};

use super::kept::{self, CARRIED, keep_packed, packed};
use super::{MarkSource, MatteRequest, frame, run};
use crate::error::WorkbenchError;
use crate::error::matte::MatteError;
use crate::progress::{Flow, Progress};
use crate::session::Session;

/// A mark stays so far from all that is not marked alike, pixels: features may be wrong by as much between them.
const BAND_PX: u32 = 6;

/// What was carried.
#[derive(Debug)]
pub struct Carried {
    /// The frame of the matte that it began with.
    pub from: u32,
    /// The mattes that are kept, each with its frame.
    pub kept: Vec<(u32, MatteId)>,
    /// The frame to which it could not be carried, and why; `None` where it reached the end.
    pub ended: Option<(u32, WorkbenchError)>,
}

/// Carries the matte that a project keeps of a frame to every so many-th frame after it, each from the one before, and keeps
/// these: one edit. A matte that was not carried is left as it is, and is carried on from.
///
/// # Errors
/// [`MatteError::None`], [`MatteError::NoneOf`] where that frame has none, what kept it from the first frame, and what the
/// project met.
pub fn carry(
    session: &mut Session,
    from: u32,
    every: u32,
    progress: &dyn Progress,
) -> Result<Carried, WorkbenchError> {
    let of: Vec<u32> = session.project.document().mattes().map(|(of, _)| of).collect();
    if of.is_empty() {
        return Err(MatteError::None.into());
    }
    if !of.contains(&from) {
        return Err(MatteError::NoneOf { frame: from, of }.into());
    }
    let n_frames = session.project.document().n_frames();
    let step = every.max(1) as usize;
    let frames: Vec<u32> = (from..n_frames).step_by(step).skip(1).collect();
    let (mut last, mut found, mut ended) = (kept::at(&session.project, from)?.1, Vec::new(), None);
    for (nth, &to) in frames.iter().enumerate() {
        if let Some(own) = by_hand(&session.project, last.frame, to)? {
            last = own;
            if last.frame == to {
                continue;
            }
        }
        let part = Part { progress, nth: nth as u64, n: frames.len() as u64 };
        match one(session, &last, to, &part) {
            Ok(matte) => {
                found.push(matte.clone());
                last = matte;
            }
            Err(error) if found.is_empty() => return Err(error),
            Err(error) => {
                ended = Some((to, error));
                break;
            }
        }
    }
    let kept = if found.is_empty() { Vec::new() } else { keep_packed(&mut session.project, &found)? };
    Ok(Carried { from, kept, ended })
}

/// The last matte after a frame, up to another, that was not carried.
fn by_hand(project: &Project, after: u32, to: u32) -> Result<Option<KeptMatte>, WorkbenchError> {
    let between: Vec<_> =
        project.document().mattes().filter(|(of, _)| (after + 1..=to).contains(of)).collect();
    for (_, id) in between.into_iter().rev() {
        let matte = project.matte(id)?;
        let is_carried = matches!(matte.provenance.params.get("marks"), Some(Value::Text(marks)) if marks.starts_with(CARRIED));
        if !is_carried {
            return Ok(Some(matte));
        }
    }
    Ok(None)
}

/// The matte of a later frame, found as the one that it is carried from was.
fn one(
    session: &Session,
    last: &KeptMatte,
    to: u32,
    progress: &dyn Progress,
) -> Result<KeptMatte, WorkbenchError> {
    let mut moved = Vec::new();
    for (_, span) in session.project.shown_all()? {
        let at = |frame| {
            span.get(frame).filter(|sample| sample.status.is_seen()).map(|s| [s.x, s.y].map(f64::from))
        };
        moved.extend(at(last.frame).zip(at(to)).map(|(from, to)| Moved { from, to }));
    }
    let path = session.project.path().to_owned();
    let of = |source: MattingError| WorkbenchError::Matte { path: path.clone(), source };
    let marks = carry_marks(&kept::matte(last), &moved, BAND_PX).map_err(of)?;
    let (options, parts) = as_found(last);
    let marks = MarkSource::Carried { from: last.frame, marks };
    let request = MatteRequest { path, marks, options, parts };
    let matted = run(&frame(&session.media, to)?, &request, progress)?;
    Ok(packed(&session.project, &(to, &request, &matted)))
}

/// What a matte was found by.
fn as_found(matte: &KeptMatte) -> (Options, PartsWish) {
    let params = &matte.provenance.params;
    let number = |id: &str| match params.get(id) {
        Some(Value::Float(value)) => Some(*value),
        Some(Value::Int(value)) => Some(*value as f64),
        _ => None,
    };
    let (options, parts) = (Options::default(), PartsWish::default());
    (
        Options {
            epsilon: number("epsilon").unwrap_or(options.epsilon),
            lambda: number("lambda").unwrap_or(options.lambda),
        },
        PartsWish {
            boundary_px: number("band").map_or(parts.boundary_px, |band| band as u32),
            speck: number("speck").map_or(parts.speck, |speck| speck as usize),
            trunk: params.get("with_trunk") != Some(&Value::Bool(true)),
        },
    )
}

/// The progress of one of several.
struct Part<'a> {
    progress: &'a dyn Progress,
    nth: u64,
    n: u64,
}

impl Progress for Part<'_> {
    fn report(&self, done: u64, total: u64, what: &str) -> Flow {
        self.progress.report(self.nth * total + done, self.n * total, what)
    }
}
