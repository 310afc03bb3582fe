//! Mattes that a project keeps: where detectors look for features.

use honami_matting::{Mark, Matte, Part, Parts};
use honami_model::document::MatteId;
use honami_model::edit::Transaction;
use honami_model::provenance::{Provenance, Value};
use honami_store::{KeptMatte, Project, StoreError};

use super::{MarkSource, MatteRequest, Matted};
use crate::error::WorkbenchError;
use crate::error::matte::MatteError;
use crate::stamp;

/// What the provenance of a matte says of its marks where they were carried on from an earlier frame.
pub(super) const CARRIED: &str = "carried from frame";

/// A matte of a frame, with what it was found by.
pub type Found<'a> = (u32, &'a MatteRequest, &'a Matted);

/// A matte that counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Counting {
    /// Its frame.
    pub frame: u32,
    /// Its number.
    pub id: MatteId,
    /// What every pixel is of.
    pub parts: Parts,
    /// What made it.
    pub provenance: Provenance,
}

/// Keeps mattes of frames: from now on features are looked for inside them. One edit, which undo takes back.
///
/// # Errors
/// What the project met.
pub fn keep(project: &mut Project, found: &[Found<'_>]) -> Result<Vec<(u32, MatteId)>, WorkbenchError> {
    keep_packed(project, &found.iter().map(|found| packed(project, found)).collect::<Vec<_>>())
}

/// Keeps mattes that are packed.
pub(super) fn keep_packed(
    project: &mut Project,
    mattes: &[KeptMatte],
) -> Result<Vec<(u32, MatteId)>, WorkbenchError> {
    let ids = project.save_mattes(mattes)?;
    let kept: Vec<(u32, MatteId)> = mattes.iter().map(|matte| matte.frame).zip(ids).collect();
    project.commit(Transaction::keep_mattes(&kept))?;
    Ok(kept)
}

/// Keeps mattes no longer: that of one frame, or all. One edit, which undo takes back. Returns their frames.
///
/// # Errors
/// [`MatteError::None`], [`MatteError::NoneOf`], and what the project met.
pub fn remove(project: &mut Project, frame: Option<u32>) -> Result<Vec<u32>, WorkbenchError> {
    let all: Vec<u32> = project.document().mattes().map(|(frame, _)| frame).collect();
    let frames = match frame {
        _ if all.is_empty() => return Err(MatteError::None.into()),
        None => all,
        Some(frame) if all.contains(&frame) => vec![frame],
        Some(frame) => return Err(MatteError::NoneOf { frame, of: all }.into()),
    };
    project.commit(Transaction::remove_mattes(&frames))?;
    Ok(frames)
}

/// The mattes that count, in order of their frames.
///
/// # Errors
/// What the project met.
pub fn all(project: &Project) -> Result<Vec<Counting>, WorkbenchError> {
    let counting = |(frame, id)| {
        let kept = project.matte(id)?;
        Ok(Counting { frame, id, parts: parts(&kept)?, provenance: kept.provenance })
    };
    project.document().mattes().map(counting).collect()
}

/// The matte that counts in a frame.
///
/// # Errors
/// [`MatteError::None`], [`WorkbenchError::Frames`], and what the project met.
pub fn at(project: &Project, frame: u32) -> Result<(u32, KeptMatte), WorkbenchError> {
    let n_frames = project.document().n_frames();
    if frame >= n_frames {
        return Err(WorkbenchError::Frames { start: frame, end: frame.saturating_add(1), n_frames });
    }
    let (of, id) = project.document().matte_at(frame).ok_or(MatteError::None)?;
    Ok((of, project.matte(id)?))
}

/// The parts of a kept matte.
///
/// # Errors
/// [`StoreError::Corrupt`] where a number is no part's.
pub fn parts(kept: &KeptMatte) -> Result<Parts, StoreError> {
    let parts = read(&kept.parts, &Part::ALL)?;
    Ok(Parts { width: kept.width, height: kept.height, parts })
}

/// The marks of a kept matte.
///
/// # Errors
/// [`StoreError::Corrupt`] where a number is no mark's.
pub fn marks(kept: &KeptMatte) -> Result<Vec<Mark>, StoreError> {
    read(&kept.marks, &Mark::ALL)
}

/// The opacities of a kept matte, to 1 of 255.
#[must_use]
pub fn matte(kept: &KeptMatte) -> Matte {
    let alpha = kept.opacity.iter().map(|&value| f32::from(value) / 255.0).collect();
    Matte { width: kept.width, height: kept.height, alpha, n_steps: 0 }
}

/// `frame 7`, `frames 0, 20, 40`, `20 frames from 0 to 380`.
#[must_use]
pub fn frames(of: &[u32]) -> String {
    match of {
        [] => "no frame".to_owned(),
        [one] => format!("frame {one}"),
        [first, .., last] if of.len() > 6 => format!("{} frames from {first} to {last}", of.len()),
        some => format!("frames {}", some.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// A matte as the project keeps it.
pub(super) fn packed(project: &Project, &(frame, request, matted): &Found<'_>) -> KeptMatte {
    let number = |value: f64| Value::Float(value);
    let whole = |value: usize| Value::Int(i64::try_from(value).unwrap_or(i64::MAX));
    let marks = match &request.marks {
        MarkSource::Scribbles(path) => format!("scribbles {}", path.display()),
        MarkSource::Trimap(path) => format!("trimap {}", path.display()),
        MarkSource::Painted(_) => "painted".to_owned(),
        MarkSource::Carried { from, .. } => format!("{CARRIED} {from}"),
    };
    let params = [
        ("marks", Value::Text(marks)),
        ("epsilon", number(request.options.epsilon)),
        ("lambda", number(request.options.lambda)),
        ("band", whole(request.parts.boundary_px as usize)),
        ("speck", whole(request.parts.speck)),
        ("with_trunk", Value::Bool(!request.parts.trunk)),
        ("steps", whole(matted.matte.n_steps)),
    ];
    let params = params.map(|(id, value)| (id.to_owned(), value)).into();
    KeptMatte {
        provenance: stamp::own(project, "matte", params, String::new()),
        frame,
        width: matted.matte.width,
        height: matted.matte.height,
        parts: numbers(&matted.parts.parts, &Part::ALL),
        opacity: matted.matte.gray(),
        marks: numbers(&matted.marks, &Mark::ALL),
    }
}

fn numbers<T: PartialEq>(plane: &[T], all: &[T]) -> Vec<u8> {
    let number = |value: &T| all.iter().position(|known| known == value).unwrap_or_default();
    plane.iter().map(|value| number(value) as u8).collect()
}

fn read<T: Copy>(plane: &[u8], all: &[T]) -> Result<Vec<T>, StoreError> {
    let value = |&number: &u8| all.get(usize::from(number)).copied();
    let values: Option<Vec<T>> = plane.iter().map(value).collect();
    values.ok_or_else(|| StoreError::Corrupt("a pixel of a matte is of no part or mark".to_owned()))
}
