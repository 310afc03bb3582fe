//! Cameras in a file, which other programs read and write, too.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use honami_cameras::camera::{N_NUMBERS, NUMBERS};
use honami_cameras::{Camera, Pair, Pose, Stereo};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::{Calibrated, Cameras, KnownCamera};
use crate::error::{CamerasError, WorkbenchError};
use crate::export;

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
}

impl Unit {
    /// Metres of one.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::Mm => 1e-3,
            Self::Cm => 1e-2,
            Self::M => 1.0,
        }
    }

    /// How it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Cm => "cm",
            Self::M => "m",
        }
    }
}

impl FromStr for Unit {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let all = [Self::Mm, Self::Cm, Self::M];
        all.into_iter()
            .find(|unit| unit.name() == text)
            .ok_or_else(|| format!("wanted mm, cm or m, got {text}"))
    }
}

/// Two cameras as a file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Both, and how they stand, in `unit`.
    pub pair: Pair,
    /// Sizes of their pictures, pixels.
    pub sizes: [[u32; 2]; 2],
    /// Standard deviation of one coordinate of what was seen when they were calibrated, pixels.
    pub sigma_px: Option<f64>,
    /// The unit of the shift between them.
    pub unit: Option<Unit>,
}

/// What of a file is read.
#[derive(Deserialize)]
struct Contents {
    unit: Option<Unit>,
    stereo: Option<Together>,
    #[serde(flatten)]
    left: One,
    right: Option<One>,
}

#[derive(Deserialize)]
struct One {
    size: [u32; 2],
    #[serde(flatten)]
    camera: Camera,
}

/// Both cameras fitted together; without numbers of their own those of each alone are meant.
#[derive(Deserialize)]
struct Together {
    left: Option<Camera>,
    right: Option<Camera>,
    turn_rad: [f64; 3],
    shift: [f64; 3],
    sigma_px: Option<f64>,
}

/// Reads the left camera of a file and, where it has two, the right one: their numbers and the sizes of their pictures.
///
/// # Errors
/// [`CamerasError::File`] where the file has no camera, or its numbers are not sound.
pub fn read_each(path: &Path) -> Result<Vec<KnownCamera>, WorkbenchError> {
    let Contents { left, right, stereo, .. } = contents(path)?;
    let (left_too, right_too) = stereo.map_or((None, None), |stereo| (stereo.left, stereo.right));
    let of = |alone: One, both: Option<Camera>| (both.unwrap_or(alone.camera), alone.size);
    let each: Vec<_> =
        std::iter::once(of(left, left_too)).chain(right.map(|right| of(right, right_too))).collect();
    if each.iter().all(|(camera, _)| camera.is_sound()) { Ok(each) } else { Err(unsound(path).into()) }
}

fn contents(path: &Path) -> Result<Contents, CamerasError> {
    let wrong = |why: String| CamerasError::File { path: path.to_owned(), why };
    let text = fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| {
        wrong(format!("not a file of cameras, such as `honami calibrate --out` writes: {error}"))
    })
}

fn unsound(path: &Path) -> CamerasError {
    let why = "focal lengths must be above 0, all numbers finite, and the cameras not in one place";
    CamerasError::File { path: path.to_owned(), why: why.to_owned() }
}

/// Reads two cameras and how they stand.
///
/// # Errors
/// [`CamerasError::File`] where the file is none of two cameras, or their numbers are not sound.
pub fn read(path: &Path) -> Result<Known, WorkbenchError> {
    let read = contents(path)?;
    let (Some(right), Some(stereo)) = (read.right, read.stereo) else {
        let why = "one camera alone; wanted are two and how they stand: `honami calibrate LEFT… --right RIGHT… --out`";
        return Err(CamerasError::File { path: path.to_owned(), why: why.to_owned() }.into());
    };
    let cameras = [stereo.left.unwrap_or(read.left.camera), stereo.right.unwrap_or(right.camera)];
    let right_from_left = Pose::new(stereo.turn_rad.into(), stereo.shift.into());
    let stands = |v: &Vector3<f64>| v.iter().all(|c| c.is_finite()) && v.norm() > 0.0;
    if !cameras.iter().all(Camera::is_sound) || !stands(&right_from_left.translation) {
        return Err(unsound(path).into());
    }
    Ok(Known {
        pair: Pair { cameras, right_from_left },
        sizes: [read.left.size, right.size],
        sigma_px: stereo.sigma_px,
        unit: read.unit,
    })
}

/// Writes cameras, whole or not at all.
///
/// # Errors
/// What writing met; another file than one of cameras is not written over.
pub fn write(cameras: &Cameras, path: &Path) -> Result<(), WorkbenchError> {
    export::text(path, &headed(&json(cameras)))
}

/// The text of a file of two cameras of which nothing but what they are is known.
pub(crate) fn of_pair(pair: &Pair, sizes: [[u32; 2]; 2], unit: Unit) -> String {
    let [mut left, mut right] = pair.cameras.map(|camera| Value::Object(numbers(camera.numbers())));
    let stand = &pair.right_from_left;
    let turn: [f64; 3] = stand.rotation.scaled_axis().into();
    let shift: [f64; 3] = stand.translation.into();
    [left["size"], right["size"]] = sizes.map(|size| json!(size));
    left["unit"] = json!(unit);
    left["right"] = right;
    left["stereo"] = json!({ "turn_rad": turn, "shift": shift, "baseline": stand.translation.norm() });
    headed(&left)
}

/// What it is stands first, so that the next time a file is known to be in place of one.
fn headed(json: &Value) -> String {
    format!("{json:#}\n").replacen('{', "{\n  \"honami\":\"cameras\",", 1)
}

/// All that is known of cameras.
#[must_use]
pub fn json(cameras: &Cameras) -> Value {
    let mut json = one(&cameras.left);
    json["provenance"] = json!(cameras.provenance);
    if let Some(unit) = cameras.unit {
        json["unit"] = json!(unit);
    }
    if let Some([fx, rms]) = cameras.by_squares {
        json["by_squares"] = json!({ "fx": fx, "rms": rms });
    }
    if let Some((right, stereo)) = &cameras.right {
        json["right"] = one(right);
        json["stereo"] = together(stereo);
    }
    json
}

fn numbers(values: [f64; N_NUMBERS]) -> Map<String, Value> {
    NUMBERS.iter().zip(values).map(|(name, value)| ((*name).to_owned(), json!(value))).collect()
}

fn one(calibrated: &Calibrated) -> Value {
    let of = &calibrated.calibration;
    let mut json = Value::Object(numbers(of.camera.numbers()));
    json["size"] = json!(calibrated.size);
    json["rms"] = json!(of.rms_px);
    json["sigma_px"] = json!(of.sigma_px);
    json["errors"] = Value::Object(numbers(of.errors));
    let views = of.views.iter().zip(&calibrated.shown);
    json["views"] = views
        .map(|(view, name)| json!({ "picture": name, "rms": view.rms_px, "worst_px": view.worst_px }))
        .collect();
    json["shown"] = json!(calibrated.n_shown);
    if let Some([measured, tracked]) = calibrated.middles {
        json["middles"] = json!({ "measured": measured, "tracked": tracked });
    }
    let left_out = calibrated.left_out.iter();
    json["left_out"] = left_out.map(|(name, why)| json!({ "picture": name, "why": why })).collect();
    json
}

fn together(stereo: &Stereo) -> Value {
    let stand = &stereo.pair.right_from_left;
    let vector = |v: [f64; 3]| json!(v);
    let [left, right] = stereo.pair.cameras.map(|camera| Value::Object(numbers(camera.numbers())));
    json!({
        "left": left,
        "right": right,
        "rms": stereo.rms_px,
        "sigma_px": stereo.sigma_px,
        "epipolar_px": stereo.epipolar_px,
        "baseline": stereo.baseline,
        "baseline_error": stereo.baseline_error,
        "turn_rad": vector(stand.rotation.scaled_axis().into()),
        "turn_error_rad": vector(stereo.turn_errors_rad()),
        "shift": vector(stand.translation.into()),
        "shift_error": vector(stereo.shift_errors()),
    })
}
