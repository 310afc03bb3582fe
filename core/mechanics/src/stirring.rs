//! All that a plant's motion in the wind is worked out from, once it is known.

use crate::beams::Beams;
use crate::bending::{Bending, Form};
use crate::modes::Modes;
use crate::turning::Turning;
use crate::wind_basis::WindBasis;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Up to so many radians the node that turns most turns in each mode where its curves are fitted: as twigs do where the
/// top of a tree is moved by 30 % of its height.
const TURN: f64 = 0.85;
/// Modes whose frequencies differ by no more than this, relatively, are as slow as one another.
const AS_SLOW: f64 = 1e-5;
/// A ball about half the height holds all nodes in the wind: so many times its radius at rest.
const SWAY: f64 = 1.3;

/// What moves nodes by so small a share of what their turns would, over the whole of the plant, moves none.
const TWIST: f64 = 1e-6;

/// A plant that cannot be pulled.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the slowest mode cannot be pulled by {metres} m: it only twists the plant, as that of a thing thicker than long does, or \
     moves it too little"
)]
pub struct PullError {
    metres: f64,
}

/// A plant ready to be moved: at rest, its modes, what wind does to them and how they bend it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stirring {
    pub(crate) omegas: Vec<f64>,
    pub(crate) basis: WindBasis,
    pub(crate) following: Following,
    pub(crate) rest: Vec<Vector3<f64>>,
    /// Amplitudes of the modes that are pulled, a metre; none where they only twist the plant.
    pull: Option<Vec<f64>>,
    pub(crate) height: f64,
    pub(crate) reach: f64,
}

/// How nodes follow their modes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Following {
    /// Each mode by itself, on straight lines or curves.
    Curves(Vec<Bending>),
    /// All together.
    Turns(Turning),
}

impl Following {
    /// All modes of beams, in a form.
    #[must_use]
    pub fn new(beams: &Beams, modes: &Modes, form: Form) -> Self {
        match form {
            Form::Turn => Self::Turns(Turning::new(beams, modes)),
            form => Self::Curves(Self::curves(beams, modes, form)),
        }
    }

    /// The curves of all modes, fitted up to turns of 0.85 radians; of a form that is no product of matrices, those by two
    /// powers.
    #[must_use]
    pub fn curves(beams: &Beams, modes: &Modes, form: Form) -> Vec<Bending> {
        let turning = Turning::new(beams, modes);
        let form = if matches!(form, Form::Node | Form::Turn) { Form::Mode(2) } else { form };
        let bending = |mode| Bending::new(modes, &turning, mode, modes.amplitude(mode, TURN), form);
        (0..modes.len()).map(bending).collect()
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        match self {
            Self::Curves(bendings) => bendings.len(),
            Self::Turns(turning) => turning.n_modes(),
        }
    }

    /// Numbers that a mode has for each coordinate of a node.
    #[must_use]
    pub fn n_powers(&self) -> usize {
        match self {
            Self::Curves(bendings) => bendings.first().map_or(1, |bending| bending.powers().len()),
            Self::Turns(_) => 1,
        }
    }
}

impl Stirring {
    /// A plant whose nodes follow its modes in a form.
    #[must_use]
    pub fn new(beams: &Beams, modes: &Modes, basis: WindBasis, form: Form) -> Self {
        let following = Following::new(beams, modes, form);
        let root = beams.nodes()[0].position;
        let rest: Vec<Vector3<f64>> = beams.nodes().iter().map(|node| node.position - root).collect();
        let height = rest.iter().map(|at| at.z).fold(0.0, f64::max);
        let centre = Vector3::z() * (height / 2.0);
        let reach = rest.iter().map(|at| (at - centre).norm()).fold(0.0, f64::max) * SWAY;
        let pull = pull(modes, rest.len(), reach);
        Self { omegas: modes.omegas.clone(), basis, following, rest, pull, height, reach }
    }

    /// Nodes, the root included.
    #[must_use]
    pub fn n_nodes(&self) -> usize {
        self.rest.len()
    }

    /// Modes.
    #[must_use]
    pub fn n_modes(&self) -> usize {
        self.omegas.len()
    }

    /// How nodes follow their modes.
    #[must_use]
    pub fn following(&self) -> &Following {
        &self.following
    }

    /// Nodes at rest, metres from the root.
    #[must_use]
    pub fn rest(&self) -> &[Vector3<f64>] {
        &self.rest
    }

    /// Amplitudes with the slowest mode pulled out, so that on straight lines the node it moves most is so many metres from
    /// rest, towards x, or y, or z, along which it moves most. Modes that are as slow are pulled with it, so that equal modes
    /// may be any of their sums.
    ///
    /// # Errors
    /// [`PullError`].
    pub fn pulled(&self, metres: f64) -> Result<Vec<f32>, PullError> {
        let mut amplitudes = vec![0.0; self.n_modes()];
        if metres.abs() > 0.0 || metres.is_nan() {
            let pull = self.pull.as_ref().ok_or(PullError { metres })?;
            for (amplitude, pull) in amplitudes.iter_mut().zip(pull) {
                *amplitude = (pull * metres) as f32;
            }
        }
        if amplitudes.iter().all(|q| q.is_finite()) { Ok(amplitudes) } else { Err(PullError { metres }) }
    }

    /// From the root to the highest node, metres.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Radius of a ball about half the height that holds all nodes, in the wind, too; metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }
}

/// Amplitudes of the slowest mode, and of those as slow, that move the node which they move most by a metre.
fn pull(modes: &Modes, n_nodes: usize, reach: f64) -> Option<Vec<f64>> {
    let slowest =
        modes.omegas.iter().take_while(|omega| **omega <= modes.omegas[0] * (1.0 + AS_SLOW)).count();
    let moves = |node: usize| (0..slowest).map(move |mode| modes.displacement(mode, node));
    let squares = |node: usize| moves(node).map(|by| by.component_mul(&by)).sum::<Vector3<f64>>();
    let most = (0..n_nodes).map(|node| squares(node).sum()).fold(0.0, f64::max);
    let turned = (0..n_nodes).map(|node| modes.rotation(0, node).norm()).fold(0.0, f64::max);
    if most.sqrt() <= TWIST * turned * reach {
        return None;
    }
    let node = (0..n_nodes).find(|node| squares(*node).sum() >= (1.0 - AS_SLOW) * most).unwrap_or(0);
    let along = squares(node);
    let axis = (0..3).find(|axis| along[*axis] >= (1.0 - AS_SLOW) * along.max()).unwrap_or(0);
    let shares: Vec<f64> = moves(node).map(|by| by[axis]).collect();
    let moved: Vector3<f64> = moves(node).zip(&shares).map(|(by, share)| by * *share).sum();
    Some(shares.iter().map(|share| share / moved.norm().max(f64::MIN_POSITIVE)).collect())
}
