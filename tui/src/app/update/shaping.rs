//! Shaping a bone by hand: its plane, how it leans, its gain. What is seen meanwhile is what Enter keeps.

use std::f64::consts::{PI, TAU};

use honami_workbench::shape::{MOST_GAIN, Shape, Step};

use super::actions::count;
use super::{Effect, Mode, State, UNDO, complain, edit, say, skeleton};
use crate::app::skeleton::{ORBIT, Shaping, Skeletal};

/// A step of plane and lean, degrees; a fine one is a tenth of it.
const TURN_DEG: f64 = 5.0;
/// Steps of the gain from 0 to 1.
const GAINS: f64 = 10.0;

/// Has the chosen bone shaped.
pub(super) fn begin(state: &mut State) -> Vec<Effect> {
    if !edit::is_writable(state) {
        return Vec::new();
    }
    // What is seen meanwhile is of what was before, whose bones are others perhaps.
    if Skeletal::is_growing(state) {
        say(state, "the skeleton is still growing");
        return Vec::new();
    }
    let Some(bones) = state.skeleton.bones.clone() else {
        complain(state, "no skeleton is shown: v k grows it, and P s lists its bones");
        return Vec::new();
    };
    let bone = Skeletal::current(state).map(|row| bones.known(row).cloned());
    match (bone, state.skeleton.pose.clone()) {
        (Some(Some(bone)), Some(pose)) => {
            let shape = state.skeleton.hand.shape(bone.node);
            state.skeleton.chosen = Some(bone.node);
            state.mode = Mode::Shape(Box::new(Shaping { bone, shape, pose }));
        }
        (Some(None), _) => complain(state, "the structure builder does not tell what this bone is of"),
        _ => complain(state, "no bone is chosen: P s lists them, j and k choose"),
    }
    Vec::new()
}

/// hjkl at a bone: across turns its plane, up and down let it lean.
pub(super) fn steer(state: &mut State, [across, down]: [f64; 2], part: f64) {
    // A coarse step is 1, a fine one a quarter elsewhere; here it is a tenth, half a degree.
    let step = if part < 1.0 { TURN_DEG / 10.0 } else { TURN_DEG } * count(state) as f64;
    let by = |deg: f64, from: f64| wrapped(from + (deg * step).to_radians());
    change(state, |shape| Shape {
        plane_rad: by(across, shape.plane_rad),
        lean_rad: by(down, shape.lean_rad),
        ..shape
    });
}

/// More gain, or less.
pub(super) fn gain(state: &mut State, by: i64) {
    change(state, |shape| Shape {
        gain: ((shape.gain * GAINS).round() + by as f64).clamp(0.0, MOST_GAIN * GAINS) / GAINS,
        ..shape
    });
}

/// An angle, -π to π: whoever turns on comes round. Rounded to a hundredth of a degree, so that there and back is nowhere.
fn wrapped(angle_rad: f64) -> f64 {
    let turned =
        if angle_rad.abs() > PI + 1e-6 { angle_rad - TAU * (angle_rad / TAU).round() } else { angle_rad };
    let hundredths = (turned.to_degrees() * 100.0).round();
    (hundredths / 100.0).to_radians().clamp(-PI, PI)
}

fn change(state: &mut State, change: impl Fn(Shape) -> Shape) {
    if let Mode::Shape(shaping) = &mut state.mode {
        shaping.shape = change(shaping.shape);
    }
    skeleton::preview(state);
}

/// Keeps the bone as it is seen.
pub(super) fn keep(state: &mut State) -> Vec<Effect> {
    let Mode::Shape(shaping) = std::mem::replace(&mut state.mode, Mode::Review) else { return Vec::new() };
    let Shaping { bone, shape, .. } = *shaping;
    if shape == state.skeleton.hand.shape(bone.node) {
        say(state, format!("{} stays as it was", bone.name));
        return Vec::new();
    }
    vec![Effect::Shape(Step::Bone(bone, shape), UNDO)]
}

/// Goes so many steps round the plant.
pub(super) fn orbit(state: &mut State, by: i64) {
    if state.skeleton.pose.is_none() {
        return complain(state, "there is no skeleton to go round: v k grows it");
    }
    let steps = i64::from(360 / ORBIT);
    let at = (i64::from(state.skeleton.azimuth / ORBIT) + by).rem_euclid(steps);
    let at = if at > steps / 2 { at - steps } else { at };
    state.skeleton.azimuth = i32::try_from(at).unwrap_or(0) * ORBIT;
    let line = match state.skeleton.azimuth {
        0 => "seen from the front, as the camera does".to_owned(),
        at => format!("seen from {at}° round the plant, without the picture: V goes back to the front"),
    };
    say(state, line);
}

/// Goes back to the front; whether it was elsewhere.
pub(super) fn leave_round(state: &mut State) -> bool {
    let is_turned = Skeletal::azimuth(state) != 0;
    if is_turned {
        front(state);
    }
    is_turned
}

/// Goes back to the front.
pub(super) fn front(state: &mut State) {
    state.skeleton.azimuth = 0;
    say(state, "seen from the front, as the camera does");
}
