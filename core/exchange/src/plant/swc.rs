//! SWC: a node a line, as neurons and skeletons of plants are kept (Cannon and others, J. Neurosci. Methods 84, 1998):
//! number, type, x, y, z, radius, number of the parent or -1.

#[cfg(test)]
mod tests;

use super::rooted::{self, Raw};
use super::{Measured, PlantFileError};
use honami_model::brief::Brief;

/// Reads a plant from the text of a file, whose lengths are `unit` metres. Types are not looked at; a radius of 0 was not
/// measured.
///
/// # Errors
/// [`PlantFileError`] with the line.
pub fn parse(text: &str, unit: f64) -> Result<Measured, PlantFileError> {
    let mut raw = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let wrong = |what: String| PlantFileError::Line { line, what };
        let text = text.split('#').next().unwrap_or_default();
        let cells: Vec<&str> = text.split([' ', '\t', ',']).filter(|cell| !cell.is_empty()).collect();
        if cells.is_empty() {
            continue;
        }
        let [id, _, x, y, z, radius, parent] = cells[..] else {
            let what = format!("wanted number, type, x, y, z, radius and parent, came {} cells", cells.len());
            return Err(wrong(what));
        };
        let number = |cell: &str| {
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| wrong(format!("{cell:?} is no number")))
        };
        let whole = |cell: &str| {
            let value = number(cell)?;
            let is_whole = value.fract().abs() < f64::EPSILON && value.abs() < 1e15;
            if is_whole { Ok(value as i64) } else { Err(wrong(format!("{cell:?} is no whole number"))) }
        };
        let (id, parent) = (whole(id)?, whole(parent)?);
        let position = [number(x)? * unit, number(y)? * unit, number(z)? * unit];
        let radius = number(radius)?;
        if radius < 0.0 {
            let what = format!("a radius is 0, where it was not measured, or more, not {}", Brief(radius));
            return Err(wrong(what));
        }
        let radius = Some(radius * unit);
        raw.push(Raw { id, parent: (parent >= 0).then_some(parent), position, radius, line });
    }
    if raw.is_empty() {
        return Err(PlantFileError::Lacks("a file of SWC has a line a node, this has none".into()));
    }
    let mut notes = Vec::new();
    let plant = rooted::plant(&raw, &mut notes)?;
    Ok(Measured { plant, notes })
}
