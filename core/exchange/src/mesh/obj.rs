//! Wavefront's `.obj`: a vertex or a polygon a line.

use std::fmt::Write as _;

use honami_model::mesh::Mesh;

use super::{Frame, fan};
use crate::plant::PlantFileError;

/// What files that are written begin with.
pub(super) const BEGIN: &str = "# a plant moved by honami\n";

/// Reads vertices and polygons; all else says how these look.
pub(super) fn read(text: &str) -> Result<(Mesh, Vec<String>), PlantFileError> {
    let mut mesh = Mesh::default();
    // Polygons may name vertices that come after them: the largest is looked at in the end.
    let (mut largest, mut has_looks) = ((0, 0), false);
    for (line, text) in logical(text) {
        let wrong = |what: String| PlantFileError::Line { line, what };
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.take(3).filter_map(|word| word.parse().ok()).collect();
                let is_place = numbers.iter().all(|v| v.is_finite());
                let place: Option<[f64; 3]> = numbers.try_into().ok().filter(|_| is_place);
                let what = || wrong(format!("a vertex is three finite numbers, not {:?}", text.trim()));
                mesh.positions.push(place.ok_or_else(what)?);
            }
            Some("f") => {
                let n = mesh.positions.len() as i64;
                let corner = |word: &str| {
                    let number = word.split('/').next()?.parse::<i64>().ok()?;
                    let row = if number < 0 { n + number } else { number - 1 };
                    u32::try_from(row).ok()
                };
                let corners: Option<Vec<u32>> = words.map(corner).collect();
                let what = || {
                    wrong(format!("a polygon is three numbers of vertices or more, not {:?}", text.trim()))
                };
                let corners = corners.filter(|corners| corners.len() >= 3).ok_or_else(what)?;
                largest = corners.iter().map(|corner| (*corner, line)).fold(largest, Ord::max);
                mesh.triangles.extend(fan(&corners));
            }
            Some("usemtl" | "vt") => has_looks = true,
            _ => {}
        }
    }
    let n = mesh.positions.len();
    if !mesh.triangles.is_empty() && largest.0 as usize >= n {
        let what = format!("vertex {} of {n} was wanted", largest.0 + 1);
        return Err(PlantFileError::Line { line: largest.1, what });
    }
    let note = "materials and textures of .obj are left out; those of .glb stay".to_owned();
    Ok((mesh, if has_looks { vec![note] } else { Vec::new() }))
}

/// Lines with their numbers; those that end in a backslash go on.
fn logical(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut lines = (1..).zip(text.lines());
    std::iter::from_fn(move || {
        let (line, begun) = lines.next()?;
        let mut whole = begun.to_owned();
        while let Some(begun) = whole.strip_suffix('\\') {
            whole = format!("{begun} {}", lines.next().map_or("", |(_, more)| more));
        }
        Some((line, whole))
    })
}

/// A frame as text; a colour stands behind its vertex, as most programs read it.
pub(super) fn written(frame: &Frame<'_>) -> Vec<u8> {
    let mut text = BEGIN.to_owned();
    for (row, [x, y, z]) in frame.positions.iter().map(|place| place.map(|v| v as f32)).enumerate() {
        let colour = frame.colours.get(row).map(|colour| colour.map(|v| f32::from(v) / 255.0));
        // Writing to a string cannot fail.
        write!(text, "v {x} {y} {z}").unwrap_or_default();
        for v in colour.iter().flatten() {
            write!(text, " {v:.3}").unwrap_or_default();
        }
        text.push('\n');
    }
    for [a, b, c] in frame.triangles.iter().map(|corners| corners.map(|corner| corner + 1)) {
        writeln!(text, "f {a} {b} {c}").unwrap_or_default();
    }
    text.into_bytes()
}
