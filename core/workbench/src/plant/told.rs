//! What a simulator is told of a plant and its motion: the values of its parameters.

#[cfg(test)]
mod tests;

use honami_host::{HostError, Param, ParamKind, PluginInfo, Value, Values};
use honami_mechanics::{Form, Integrator};

use super::Wish;
use super::sway::Motion;
use crate::error::WorkbenchError;

/// What of a plant and its motion was chosen, not left as it is.
#[derive(Clone, Copy, Debug)]
pub enum Chosen<'a> {
    /// All of it.
    All,
    /// Options of these names: `alpha`, `leaf_mass`.
    Only(&'a [String]),
}

impl Chosen<'_> {
    fn has(&self, id: &str) -> bool {
        match self {
            Self::All => true,
            Self::Only(ids) => ids.iter().any(|chosen| chosen == id),
        }
    }
}

/// Values of a simulator's parameters, and what there is to say of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// The rest take their defaults.
    pub values: Values,
    /// Where it goes by another value than is shown here, a sentence each.
    pub notes: Vec<String>,
}

/// Values of a simulator's parameters, by what is wanted of a plant and of its motion and by `name=value`.
///
/// What was chosen goes by the name of its option, and whoever has no such parameter refuses it; but for modes, of which not
/// all make use. The rest is left to the simulator. The nodes that it is given have the radius of the segment that leads to
/// them: one that can be told so is.
///
/// # Errors
/// What is no motion, and the first value that it has no parameter for or that is out of range.
pub fn told(
    wish: &Wish,
    motion: &Motion,
    plugin: &PluginInfo,
    chosen: Chosen<'_>,
    set: &[String],
) -> Result<Told, WorkbenchError> {
    motion.check()?;
    Ok(values(wish, motion, (&plugin.short_name, &plugin.params), chosen, set)?)
}

fn values(
    wish: &Wish,
    motion: &Motion,
    (name, params): (&str, &[Param]),
    chosen: Chosen<'_>,
    set: &[String],
) -> Result<Told, HostError> {
    let mut values = Values::defaults(params);
    let (mut left, mut notes) = (Vec::new(), Vec::new());
    for (id, value) in options(wish, motion) {
        let known = params.iter().find(|param| param.id == id);
        match known {
            None if id == "modes" && chosen.has(id) => {
                notes.push(format!("{name} is not told of modes: it has no such parameter"));
            }
            None if !chosen.has(id) => (),
            Some(param) if !chosen.has(id) => left.push((param, value)),
            _ => values.set(params, id, value)?,
        }
    }
    let tip = Value::Text("tip".to_owned());
    let is_of_tips = |param: &&Param| {
        param.id == "radius"
            && matches!(param.kind, ParamKind::Enum { .. })
            && param.check(tip.clone()).is_ok()
    };
    if let Some(param) = params.iter().find(is_of_tips) {
        values.set(params, &param.id, tip)?;
    }
    set.iter().try_for_each(|assignment| values.set_text(params, assignment))?;
    let is_set = |id: &str| set.iter().any(|text| text.split('=').next().is_some_and(|key| key.trim() == id));
    for (param, ours) in left {
        let (id, own) = (&param.id, param.default());
        if own != ours && !is_set(id) {
            let option = id.replace('_', "-");
            notes.push(format!(
                "{name} goes by its own {id}, {own}, not by {ours}: --{option} tells it otherwise"
            ));
        }
    }
    Ok(Told { values, notes })
}

/// Names of options, and what they are.
fn options(wish: &Wish, motion: &Motion) -> [(&'static str, Value); 15] {
    let (wood, leaves, damping) = (wish.beams.material, wish.leaves, motion.damping);
    let method = match motion.integrator {
        Integrator::Exact => "exact",
        Integrator::Symplectic => "symplectic",
        Integrator::Newmark => "newmark",
    };
    let bend = match motion.form {
        Form::Turn => "turn",
        Form::Linear => "linear",
        Form::Mode(3) => "s3",
        Form::Node | Form::Mode(_) => "s2",
    };
    [
        ("young", Value::Float(wood.young)),
        ("poisson", Value::Float(wood.poisson)),
        ("density", Value::Float(wood.density)),
        ("leaf_mass", Value::Float(leaves.mass)),
        ("leaf_drag", Value::Float(leaves.drag)),
        ("drag", Value::Float(wish.drag)),
        ("air_density", Value::Float(wish.air_density)),
        ("alpha", Value::Float(damping.alpha)),
        ("beta", Value::Float(damping.beta)),
        ("air_damping", Value::Float(damping.air)),
        ("heavier", Value::Float(damping.mass)),
        ("pull", Value::Float(motion.pull)),
        ("modes", Value::Int(wish.n_modes as i64)),
        ("method", Value::Text(method.to_owned())),
        ("bend", Value::Text(bend.to_owned())),
    ]
}
