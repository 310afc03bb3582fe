//! What a simulator is told of a plant and its motion: the values of its parameters.

#[cfg(test)]
mod tests;

use honami_host::{HostError, Param, ParamKind, PluginInfo, Value, Values};
use honami_mechanics::{Form, Integrator};
use honami_model::plant::RadiusRule;

use super::sway::Motion;
use super::{USUAL_MODES, Wish};
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

/// What a simulator goes by, and what there is to say of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Values of its parameters; the rest take their defaults.
    pub values: Values,
    /// The plant as it is then,
    pub wish: Wish,
    /// and its motion.
    pub motion: Motion,
    /// Where it goes by another value than these, a sentence each.
    pub notes: Vec<String>,
}

/// Values of a simulator's parameters, by what is wanted of a plant and of its motion and by `name=value`.
///
/// What was chosen goes by the name of its option, and whoever has no such parameter refuses it; but for modes, of which not
/// all make use. The rest is left to the simulator. What is set by the name of an option is that option: the plant is then
/// what was set, whoever asks. The nodes that a simulator is given have the radius of the segment that leads to them, and lie
/// no farther apart than is wanted: one that can be told so is.
///
/// # Errors
/// What is no wood, no leaves or no motion, and the first value that it has no parameter for or that is out of range.
pub fn told(
    wish: &Wish,
    motion: &Motion,
    plugin: &PluginInfo,
    chosen: Chosen<'_>,
    set: &[String],
) -> Result<Told, WorkbenchError> {
    wish.check()?;
    motion.check()?;
    let told = values(wish, motion, (&plugin.short_name, &plugin.params), chosen, set)?;
    told.motion.check()?;
    Ok(told)
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
    set.iter().try_for_each(|assignment| values.set_text(params, assignment))?;
    let is_set = |id: &str| set.iter().any(|text| text.split('=').next().is_some_and(|key| key.trim() == id));
    let (mut wish, mut motion) = (wish.clone(), motion.clone());
    for (id, value) in values.iter().filter(|(id, _)| is_set(id)) {
        settle(&mut wish, &mut motion, id, value);
    }
    let tip = Value::Text("tip".to_owned());
    let is_of_tips = |param: &Param| {
        param.id == "radius"
            && matches!(param.kind, ParamKind::Enum { .. })
            && param.check(tip.clone()).is_ok()
    };
    if params.iter().any(is_of_tips) {
        values.set(params, "radius", tip)?;
    }
    if wish.beams.longest.is_some() && is_set("longest") {
        values.set(params, "longest", Value::Float(0.0))?;
    }
    for (param, ours) in left {
        let (id, own) = (&param.id, param.default());
        if own != ours && !is_set(id) {
            let option = id.replace('_', "-");
            notes.push(format!(
                "{name} goes by its own {id}, {own}, not by {ours}: --{option} tells it otherwise"
            ));
        }
    }
    Ok(Told { values, wish, motion, notes })
}

/// Words for how modes go on in time,
pub(super) const METHODS: [(&str, Integrator); 3] =
    [("exact", Integrator::Exact), ("symplectic", Integrator::Symplectic), ("newmark", Integrator::Newmark)];
/// and for how nodes follow them.
const BENDS: [(&str, Form); 4] =
    [("turn", Form::Turn), ("linear", Form::Linear), ("s2", Form::Mode(2)), ("s3", Form::Mode(3))];
/// And for how thick a segment is.
const RADII: [(&str, RadiusRule); 2] = [("mean", RadiusRule::Mean), ("tip", RadiusRule::Tip)];

/// Names of options that a simulator is told, and what they are.
fn options(wish: &Wish, motion: &Motion) -> [(&'static str, Value); 15] {
    let (wood, leaves, damping) = (wish.beams.material, wish.leaves, motion.damping);
    // The thesis's has no product of matrices; this is nearest to it.
    let bend = if motion.form == Form::Node { Form::Mode(2) } else { motion.form };
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
        ("modes", Value::Int(wish.n_modes.unwrap_or(USUAL_MODES) as i64)),
        ("method", Value::Text(word(&METHODS, motion.integrator).to_owned())),
        ("bend", Value::Text(word(&BENDS, bend).to_owned())),
    ]
}

/// The word for a value.
pub(super) fn word<'a, T: PartialEq>(words: &[(&'a str, T)], of: T) -> &'a str {
    words.iter().find(|(_, value)| *value == of).map_or("", |(word, _)| word)
}

/// Takes a simulator's value for the option of its name. Of another kind it is none, nor a word that only it knows.
fn settle(wish: &mut Wish, motion: &mut Motion, id: &str, value: &Value) {
    let (wood, leaves, damping) = (&mut wish.beams.material, &mut wish.leaves, &mut motion.damping);
    match (id, value) {
        ("young", Value::Float(v)) => wood.young = *v,
        ("poisson", Value::Float(v)) => wood.poisson = *v,
        ("density", Value::Float(v)) => wood.density = *v,
        ("leaf_mass", Value::Float(v)) => leaves.mass = *v,
        ("leaf_drag", Value::Float(v)) => leaves.drag = *v,
        ("drag", Value::Float(v)) => wish.drag = *v,
        ("air_density", Value::Float(v)) => wish.air_density = *v,
        ("alpha", Value::Float(v)) => damping.alpha = *v,
        ("beta", Value::Float(v)) => damping.beta = *v,
        ("air_damping", Value::Float(v)) => damping.air = *v,
        ("heavier", Value::Float(v)) => damping.mass = *v,
        ("pull", Value::Float(v)) => motion.pull = *v,
        ("longest", Value::Float(v)) => wish.beams.longest = (*v > 0.0).then_some(*v),
        ("modes", Value::Int(v)) => wish.n_modes = usize::try_from(*v).ok(),
        ("method", Value::Text(word)) => choose(&METHODS, word, &mut motion.integrator),
        ("bend", Value::Text(word)) => choose(&BENDS, word, &mut motion.form),
        ("radius", Value::Text(word)) => choose(&RADII, word, &mut wish.beams.rule),
        _ => (),
    }
}

fn choose<T: Copy>(words: &[(&str, T)], word: &str, into: &mut T) {
    if let Some((_, value)) = words.iter().find(|(known, _)| *known == word) {
        *into = *value;
    }
}
