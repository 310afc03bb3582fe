//! A simulator at work, and the check of what it returns. Metres, z up, right-handed; radians; seconds.

mod input;
#[cfg(test)]
mod tests;

use crate::context::CallContext;
use crate::error::HostError;
use crate::host::complete;
use crate::instance::{Handle, Request};
use crate::registry::PluginInfo;
use crate::reply::{self, Reply, Table};
use crate::types::Node;
use crate::values::{Value, Values};

/// A copy of a plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantInstance {
    /// Turned about z, from x towards y, radians.
    pub yaw: f32,
    /// Of all its lengths, above 0.
    pub scale: f32,
    /// Times the plant's mass, above 0.
    pub mass: f32,
}

impl Default for PlantInstance {
    fn default() -> Self {
        Self { yaw: 0.0, scale: 1.0, mass: 1.0 }
    }
}

/// A vibration mode that a simulator has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeRow {
    /// Frequency, above 0.
    pub hz: f64,
    /// |K x - w² M x| over |K x|.
    pub residual: f64,
    /// Whether it was proved that there is no other below.
    pub certified: bool,
}

/// How far a simulator is to go, in which wind.
#[derive(Clone, Copy, Debug)]
pub struct Steps<'a> {
    /// Seconds a step, above 0.
    pub dt: f64,
    /// How many; 0: only where everything is now.
    pub n: u32,
    /// The wind on the way.
    pub wind: WindRows<'a>,
    /// How much of every copy is wanted, one a copy; `None`: everything.
    pub detail: Option<&'a [Detail]>,
}

/// How much of a copy is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// Its first so many nodes,
    pub nodes: u32,
    /// moved by its first so many modes.
    pub modes: u32,
}

/// Wind over time at every copy: straight between its times, before the first and after the last as there.
#[derive(Clone, Copy, Debug, Default)]
pub struct WindRows<'a> {
    /// Seconds since the last reset, rising; none: still air.
    pub times_s: &'a [f64],
    /// Metres per second in the world: one a time for all copies alike, or `(time, copy)` row-major.
    pub velocities: &'a [[f32; 3]],
}

/// A simulator at work. Made by [`Host`](crate::Host).
///
/// `prepare`, then any number of `step`, `retune` and `reset`.
#[derive(Debug)]
pub struct Simulator {
    handle: Handle,
    reply: Reply,
    info: PluginInfo,
    values: Values,
    plant: Option<Shape>,
}

/// How large its plant is.
#[derive(Clone, Copy, Debug)]
struct Shape {
    n_nodes: usize,
    n_instances: usize,
}

/// Of a motion that was written in this process a row a copy is looked at, its last where all nodes are wanted, and so many
/// rows at least: where a copy's motion is lost it is in all of its rows but the first, the root's, and all rows of a
/// forest would be read as slowly as they were written.
const LOOKS_LEAST: usize = 1 << 10;

impl Simulator {
    pub(crate) fn new(handle: Handle, info: &PluginInfo, values: Values) -> Self {
        Self { handle, reply: Reply::default(), info: info.clone(), values, plant: None }
    }

    /// Hands over a plant, every copy at rest at time 0; the modes that the plugin has found, lowest first, if it works
    /// with such.
    ///
    /// # Errors
    /// [`HostError`], when that is no plant, its motion would be more than 16 GiB, or the plugin cannot work on it.
    pub fn prepare(
        &mut self,
        nodes: &[Node],
        instances: &[PlantInstance],
        max_threads: u32,
        seed: u64,
        cx: &CallContext<'_>,
    ) -> Result<Vec<ModeRow>, HostError> {
        self.plant = None;
        if let Some(fault) = input::plant_fault(nodes, instances) {
            return Err(self.handle.usage(fault));
        }
        let request = Request::Prepare { nodes, instances, max_threads, seed };
        self.handle.ask(&request, cx, &mut self.reply)?;
        let modes = self.reply.table(&reply::MODES).map_or(Ok(Vec::new()), read_modes);
        let modes = modes.map_err(|what| self.handle.misbehaved("prepare", what))?;
        self.plant = Some(Shape { n_nodes: nodes.len(), n_instances: instances.len() });
        Ok(modes)
    }

    /// Goes on under other values of the parameters that affect `"step"`.
    ///
    /// # Errors
    /// [`HostError`], when a value is none, another parameter has another value, or the plugin refuses them; it then goes
    /// on as before.
    pub fn retune(&mut self, values: &Values, cx: &CallContext<'_>) -> Result<(), HostError> {
        self.prepared()?;
        let (values, sent) = complete(&self.info, values)?;
        let lasts = |id: &str| self.info.params.iter().any(|param| param.id == id && param.affects != "step");
        if let Some((id, _, _)) =
            sent.iter().find(|(id, value, _)| lasts(id) && self.values.get(id) != Some(value))
        {
            return Err(self
                .handle
                .usage(format!("cannot change {id:?} in mid-motion: start it anew and prepare it")));
        }
        let sent: Vec<_> = sent.iter().map(|(id, value, kind)| (id.as_str(), value, *kind)).collect();
        self.handle.ask(&Request::SetParams(&sent), cx, &mut self.reply)?;
        self.values = values;
        Ok(())
    }

    /// Back to rest at time 0.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant or the plugin cannot do it.
    pub fn reset(&mut self, cx: &CallContext<'_>) -> Result<(), HostError> {
        self.prepared()?;
        self.handle.ask(&Request::Reset, cx, &mut self.reply).map(|_| ())
    }

    /// Goes so many steps; gives how far every wanted node is from where it rests, metres in the axes and the size of the
    /// plant, whatever its copy's yaw and scale; copy after copy.
    /// It lies in memory that the next call uses again.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant, these are no steps, or the plugin cannot do it or its motion is none.
    pub fn step(&mut self, steps: &Steps<'_>, cx: &CallContext<'_>) -> Result<&[[f32; 3]], HostError> {
        let shape = self.prepared()?;
        if let Some(fault) = input::steps_fault(steps, shape.n_nodes, shape.n_instances) {
            return Err(self.handle.usage(fault));
        }
        self.handle.ask(&Request::Step(steps), cx, &mut self.reply)?;
        let all = shape.n_nodes * shape.n_instances;
        let wanted = steps.detail.map_or(all, |copies| copies.iter().map(|copy| copy.nodes as usize).sum());
        let looks = if self.handle.can_end() { usize::MAX } else { shape.n_instances.max(LOOKS_LEAST) };
        if let Err(what) = check_motion(self.reply.table(&reply::MOTION), wanted, looks) {
            return Err(self.handle.misbehaved("step", what));
        }
        let motion = self.reply.table(&reply::MOTION).map(|table| table.required::<f32>("d"));
        Ok(motion.unwrap_or_default().as_chunks().0)
    }

    /// Whether the plugin can save what it carries (`honami.state/1`).
    #[must_use]
    pub fn can_save(&self) -> bool {
        self.info.offers("honami.state/1")
    }

    /// Saves what later steps depend on; the plugin's own bytes.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant or the plugin cannot.
    pub fn save(&mut self, cx: &CallContext<'_>) -> Result<Vec<u8>, HostError> {
        self.prepared()?;
        self.handle.ask(&Request::Save, cx, &mut self.reply)?;
        match self.reply.table(&reply::STATE) {
            Some(table) => Ok(table.required::<u8>("bytes").to_vec()),
            None => Err(self.handle.misbehaved("save", "returned without committing honami.state/1")),
        }
    }

    /// Goes on from what was saved of the same plant, under the same parameters but for those that affect `"step"`.
    ///
    /// # Errors
    /// [`HostError`], when there is no plant or the plugin refuses the bytes; it then goes on as before.
    pub fn load(&mut self, bytes: &[u8], cx: &CallContext<'_>) -> Result<(), HostError> {
        self.prepared()?;
        self.handle.ask(&Request::Load(bytes), cx, &mut self.reply).map(|_| ())
    }

    fn prepared(&self) -> Result<Shape, HostError> {
        self.plant.ok_or_else(|| self.handle.usage("has no plant: prepare it first"))
    }
}

/// Values as they are sent: id, value, its kind in the ABI.
pub(crate) type Sent = Vec<(String, Value, u32)>;

fn read_modes(table: &Table) -> Result<Vec<ModeRow>, String> {
    let (hz, residuals) = (table.required::<f64>("hz"), table.required::<f64>("residual"));
    let certified = table.column::<u8>("certified");
    let mut last = 0.0;
    let mut modes = Vec::with_capacity(hz.len());
    for (k, (&hz, &residual)) in hz.iter().zip(residuals).enumerate() {
        let is_mode = hz.is_finite() && hz > 0.0 && hz >= last && residual.is_finite() && residual >= 0.0;
        if !is_mode {
            return Err(format!("committed mode {k} of {hz} Hz after one of {last} Hz, residual {residual}"));
        }
        last = hz;
        modes.push(ModeRow { hz, residual, certified: certified.is_some_and(|proofs| proofs[k] != 0) });
    }
    Ok(modes)
}

fn check_motion(table: Option<&Table>, wanted: usize, looks: usize) -> Result<(), String> {
    let table = table.ok_or("returned without committing honami.motion/1")?;
    if table.rows() != wanted {
        return Err(format!("committed {} rows of motion, wanted {wanted}", table.rows()));
    }
    match lost(table.required::<f32>("d").as_chunks().0, looks) {
        Some(row) => Err(format!("row {row} of the motion is not finite")),
        None => Ok(()),
    }
}

/// A row that is no number, of so many that are looked at.
fn lost(rows: &[[f32; 3]], looks: usize) -> Option<usize> {
    let stride = (rows.len() / looks).max(1);
    let mut looked_at = (stride - 1..rows.len()).step_by(stride);
    looked_at.find(|row| !rows[*row].iter().all(|v| v.is_finite()))
}
