//! How long branches stay, by each way in which nodes can follow modes.

use honami_mechanics::{Beams, Bending, Form, Modes, Turning, Vector};

use super::Vibrating;

/// A way in which nodes follow modes, and what is told of it.
pub const FORMS: [(Form, &str); 5] = [
    (Form::Linear, "linear"),
    (Form::Node, "thesis: s, s² a node"),
    (Form::Mode(2), "s2: s, s² a mode"),
    (Form::Mode(3), "s3: s, s², s³ a mode"),
    (Form::Turn, "turn: segments turn"),
];

/// Deflections of the node that is moved most, shares of the plant's height.
pub const DEFLECTIONS: [f64; 3] = [0.05, 0.15, 0.30];

/// How a form does at a deflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Root of the mean square of the relative errors of segments' lengths.
    pub stretch: f64,
    /// How far nodes are from where segments that turn have them, as a share of how far these moved; roots of mean squares.
    pub off: f64,
}

/// Cells of a form, one a deflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What follows how.
    pub form: &'static str,
    /// Where the slowest mode moves alone.
    pub alone: [Cell; 3],
    /// Where a steady wind along x holds all modes.
    pub in_wind: [Cell; 3],
}

/// All forms at all deflections. Amplitudes are those at which the modes themselves, on straight lines, have the
/// deflection; curves are fitted as far as these go.
#[must_use]
pub fn forms(plant: &Vibrating) -> Vec<Row> {
    let (beams, modes) = (&plant.beams, &plant.modes);
    let wind: Vec<f64> = (0..modes.len())
        .map(|mode| plant.basis.force(mode, &Vector::x()) / modes.omegas[mode].powi(2))
        .collect();
    let mut alone = vec![0.0; modes.len()];
    alone[0] = 1.0;
    let turning = Turning::new(beams, modes);
    let row = |&(form, name): &(Form, &'static str)| {
        let cells = |amplitudes: &[f64]| {
            DEFLECTIONS.map(|share| {
                let most = linear(beams, modes, amplitudes).iter().map(Vector::norm).fold(0.0, f64::max);
                let by = share * plant.height / most.max(f64::MIN_POSITIVE);
                let amplitudes: Vec<f64> = amplitudes.iter().map(|q| q * by).collect();
                cell(beams, modes, &turning, form, &amplitudes)
            })
        };
        Row { form: name, alone: cells(&alone), in_wind: cells(&wind) }
    };
    FORMS.iter().map(row).collect()
}

fn linear(beams: &Beams, modes: &Modes, amplitudes: &[f64]) -> Vec<Vector> {
    let of = |node| amplitudes.iter().enumerate().map(|(mode, q)| modes.displacement(mode, node) * *q).sum();
    (0..beams.len()).map(of).collect()
}

fn cell(beams: &Beams, modes: &Modes, turning: &Turning, form: Form, amplitudes: &[f64]) -> Cell {
    let turned = turning.displacements(amplitudes);
    let moved = match form {
        Form::Linear => linear(beams, modes, amplitudes),
        Form::Turn => turned.clone(),
        form => {
            let acting = amplitudes.iter().enumerate().filter(|(_, q)| q.abs() > 0.0);
            let curves: Vec<(Bending, f64)> =
                acting.map(|(mode, q)| (Bending::new(modes, turning, mode, q.abs(), form), *q)).collect();
            let of = |node| curves.iter().map(|(bending, q)| bending.displacement(node, *q)).sum();
            (0..beams.len()).map(of).collect()
        }
    };
    let errors = (0..beams.len()).filter_map(|node| {
        let parent = beams.parent(node)? as usize;
        let at_rest = beams.position(node) - beams.position(parent);
        let now = at_rest + moved[node] - moved[parent];
        Some((now.norm() / at_rest.norm() - 1.0).powi(2))
    });
    let stretch = (errors.sum::<f64>() / (beams.len() - 1) as f64).sqrt();
    let square = |of: &[Vector]| of.iter().map(Vector::norm_squared).sum::<f64>();
    let apart: Vec<Vector> = moved.iter().zip(&turned).map(|(a, b)| a - b).collect();
    Cell { stretch, off: (square(&apart) / square(&turned).max(f64::MIN_POSITIVE)).sqrt() }
}
