//! Rigs as text of Universal Scene Description (`.usda`): a mesh, a skeleton that it is bound to, and how that turns (UsdSkel).
//!
//! Lengths are metres, y up. Times are frames of the usual rate, counted from the first: whole numbers where frames are
//! evenly spaced. Matrices have what they move by in their last row, quaternions begin with what is real.

#[cfg(test)]
mod tests;

use std::fmt::{Display, Write as _};
use std::io::Write as _;
use std::path::Path;

use honami_model::mesh::{Binding, MOST_BONES, Mesh};
use honami_model::skeleton::Skeleton;

use super::joints::{Joints, rotations};
use super::rig::{RigError, check};
use crate::atomic::{AtomicFile, is_begun_alike};
use crate::glb::upright;
use crate::table::TableError;

/// Of a clip of one frame, frames per second.
const FPS: f64 = 25.0;
/// In the first lines of what honami writes: models of others are not to be lost.
const DOC: &str = "doc = \"a plant moved by honami\"";
/// Times are told to a millionth of a frame.
const TICKS: f64 = 1e6;

/// The text of a mesh bound to the bones of `rest`, where these are at rest, which turn as those of `motion` do; both are of
/// the same bones. Bindings, and colours if there are any, are vertex by vertex. `kept` are the rows of the bones that become
/// joints, the root and what bears them among them, or `None` for all.
///
/// # Errors
/// [`RigError`].
pub fn usda(
    mesh: &Mesh,
    bindings: &[Binding],
    colours: &[[u8; 3]],
    rest: &Skeleton,
    motion: &Skeleton,
    kept: Option<&[usize]>,
) -> Result<String, RigError> {
    let joints = Joints::of(rest, kept)?;
    check(bindings, colours, &joints, mesh.positions.len())?;
    let fps = told(motion.times().nominal_fps().unwrap_or(FPS));
    let codes = codes(motion, fps)?;
    let mut text = format!(
        "#usda 1.0\n(\n    defaultPrim = \"plant\"\n    {DOC}\n    startTimeCode = 0\n    \
         endTimeCode = {}\n    timeCodesPerSecond = {fps}\n    framesPerSecond = {fps}\n    metersPerUnit = 1\n    \
         upAxis = \"Y\"\n)\n\ndef SkelRoot \"plant\" (\n    prepend apiSchemas = [\"SkelBindingAPI\"]\n)\n{{\n",
        codes.last().copied().unwrap_or_default()
    );
    skeleton(&mut text, &joints);
    animation(&mut text, &joints, &codes, rotations(rest, motion));
    text += "    }\n\n";
    skin(&mut text, mesh, &joints, bindings, colours);
    text += "}\n";
    Ok(text)
}

/// Writes such a text, whole or not at all.
///
/// # Errors
/// What the disk says.
pub fn write_usda(path: &Path, text: &str) -> Result<(), TableError> {
    let is_own = |head: &[u8]| {
        is_begun_alike(head, text) && String::from_utf8_lossy(head).lines().any(|line| line.trim() == DOC)
    };
    let mut file = AtomicFile::create(path, is_own)?;
    file.write_all(text.as_bytes()).map_err(|source| TableError::File { path: path.into(), source })?;
    file.finish()
}

/// To nine digits: steps of 0.04 s are 25 a second, not 24.999999999999996.
fn told(fps: f64) -> f64 {
    format!("{fps:.8e}").parse().unwrap_or(fps)
}

/// Times of frames, in frames.
fn codes(motion: &Skeleton, fps: f64) -> Result<Vec<f64>, RigError> {
    let times = motion.times().as_slice();
    let codes: Vec<f64> =
        times.iter().map(|time| (TICKS * fps * (time - times[0])).round() / TICKS).collect();
    match codes.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(frame) => Err(RigError::Times(frame)),
        None => Ok(codes),
    }
}

/// Writing to a string cannot fail.
fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).unwrap_or_default();
}

/// `(a, b, c)`.
fn tuple<const N: usize>(values: [f64; N]) -> String {
    format!("({})", values.map(|v| (v as f32).to_string()).join(", "))
}

/// `name = [a, b, c]`, and what is said of it.
fn list(text: &mut String, name: &str, values: impl Iterator<Item = impl Display>, said: &str) {
    put(text, format_args!("        {name} = ["));
    for (k, value) in values.enumerate() {
        put(text, format_args!("{}{value}", if k > 0 { ", " } else { "" }));
    }
    put(text, format_args!("]{said}\n"));
}

/// Joints by their paths, from the root on.
fn paths(joints: &Joints) -> Vec<String> {
    let mut paths: Vec<String> = Vec::with_capacity(joints.names.len());
    for (name, parent) in joints.names.iter().zip(&joints.parents) {
        let path = parent.map_or_else(|| name.clone(), |parent| format!("{}/{name}", paths[parent]));
        paths.push(path);
    }
    paths
}

/// The skeleton, which stays open.
fn skeleton(text: &mut String, joints: &Joints) {
    let matrix = |by: [f64; 3]| {
        format!("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({}, {}, {}, 1))", by[0], by[1], by[2])
    };
    let all = 0..joints.names.len();
    *text +=
        "    def Skeleton \"skeleton\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n";
    let quoted = paths(joints).into_iter().map(|path| format!("\"{path}\""));
    list(text, "uniform token[] joints", quoted, "");
    list(text, "uniform matrix4d[] bindTransforms", joints.places.iter().map(|place| matrix(*place)), "");
    list(text, "uniform matrix4d[] restTransforms", all.map(|joint| matrix(joints.offset(joint))), "");
    *text += "        rel skel:animationSource = </plant/skeleton/filmed>\n\n";
}

fn animation(text: &mut String, joints: &Joints, codes: &[f64], frames: impl Iterator<Item = Vec<[f64; 4]>>) {
    let n = joints.names.len();
    *text += "        def SkelAnimation \"filmed\"\n        {\n";
    let quoted = paths(joints).into_iter().map(|path| format!("\"{path}\""));
    list(text, "    uniform token[] joints", quoted, "");
    list(text, "    float3[] translations", (0..n).map(|joint| tuple(joints.offset(joint))), "");
    list(text, "    half3[] scales", (0..n).map(|_| "(1, 1, 1)"), "");
    *text += "            quatf[] rotations.timeSamples = {\n";
    for (code, turns) in codes.iter().zip(frames) {
        // Ends of tips have no bone, and do not turn.
        let still = std::iter::repeat_n([0.0, 0.0, 0.0, 1.0], n - joints.rows.len());
        let turns =
            joints.rows.iter().map(|row| turns[*row]).chain(still).map(|[x, y, z, w]| tuple([w, x, y, z]));
        put(text, format_args!("                {code}: [{}],\n", turns.collect::<Vec<_>>().join(", ")));
    }
    *text += "            }\n        }\n";
}

fn skin(text: &mut String, mesh: &Mesh, joints: &Joints, bindings: &[Binding], colours: &[[u8; 3]]) {
    let places: Vec<[f64; 3]> = mesh.positions.iter().map(|place| upright(*place)).collect();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (axis, v) in places.iter().flat_map(|place| place.iter().enumerate()) {
        (low[axis], high[axis]) = (low[axis].min(*v), high[axis].max(*v));
    }
    *text += "    def Mesh \"mesh\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n";
    let vertex = " (\n            interpolation = \"vertex\"\n        )";
    let four = format!(
        " (\n            elementSize = {MOST_BONES}\n            interpolation = \"vertex\"\n        )"
    );
    list(text, "float3[] extent", [low, high].into_iter().map(tuple), "");
    list(text, "int[] faceVertexCounts", mesh.triangles.iter().map(|_| 3), "");
    list(text, "int[] faceVertexIndices", mesh.triangles.iter().flatten(), "");
    list(text, "point3f[] points", places.into_iter().map(tuple), "");
    if !mesh.normals.is_empty() {
        let normals = mesh.normals.iter().map(|normal| tuple(upright(*normal)));
        list(text, "normal3f[] normals", normals, vertex);
    }
    if !colours.is_empty() {
        let colours = colours.iter().map(|colour| tuple(colour.map(|v| f64::from(v) / 255.0)));
        list(text, "color3f[] primvars:displayColor", colours, vertex);
    }
    list(
        text,
        "int[] primvars:skel:jointIndices",
        bindings.iter().flat_map(|binding| joints.bones(binding)),
        &four,
    );
    list(text, "float[] primvars:skel:jointWeights", bindings.iter().flat_map(Binding::weights), &four);
    *text += "        matrix4d primvars:skel:geomBindTransform = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))\n";
    *text += "        rel skel:skeleton = </plant/skeleton>\n        uniform token subdivisionScheme = \"none\"\n    }\n";
}
