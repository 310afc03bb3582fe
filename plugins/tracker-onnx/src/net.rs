//! The three graphs together: which output goes into which input, and how many points go through at a time.
//!
//! An input takes what an earlier graph gives out under the same name. What remains are the frame in the encoder, the
//! points in the query, and in the step the state, which is opaque: zero for a new point, then whatever came out.

use std::path::Path;
use std::sync::Arc;

use honami_plugin::{Error, Result};
use rten::{Dimension, ThreadPool, Value, ValueOrView};
use rten_tensor::prelude::*;

use crate::graph::{End, Graph};

/// A causal point tracker.
pub(crate) struct Net {
    encoder: Graph,
    query: Graph,
    step: Graph,
    pub(crate) frame: FrameShape,
    queries: Vec<Source>,
    points: PointShape,
    steps: Vec<Source>,
    /// Outputs of the step, by what they mean.
    tracks: usize,
    occlusion: Option<usize>,
    distance: Option<usize>,
    visible: Option<usize>,
    states: Vec<usize>,
    threads: Arc<ThreadPool>,
}

/// What the encoder sees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameShape {
    /// Of the whole tensor; open dimensions are filled in.
    pub(crate) dims: Vec<usize>,
    /// Whether colours come before rows and columns.
    pub(crate) is_planar: bool,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// How positions go into the query.
struct PointShape {
    rank: usize,
    /// Points at a time.
    n: usize,
    /// The name of that number, where it is open.
    symbol: Option<String>,
    /// Numbers a point: 2, or 3 with a frame number before them.
    numbers: usize,
}

/// Where an input's value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    /// What is given from outside.
    Given,
    /// An output of the encoder.
    Feature(usize),
    /// An output of the query.
    Query(usize),
    /// The state, by its number.
    State(usize),
}

/// What the net found of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    /// Position in pixels of the net's picture, in the net's order.
    pub(crate) at: [f32; 2],
    /// Probability that it is visible and known to a few pixels.
    pub(crate) visible: f32,
}

/// Points that go through the net together.
pub(crate) struct Batch {
    queries: Vec<Value>,
    states: Vec<Value>,
}

impl Net {
    pub(crate) fn load(folder: &Path, size: u32, batch: usize, n_threads: usize) -> Result<Self> {
        let [encoder, query, step] =
            ["encoder.onnx", "query.onnx", "step.onnx"].map(|name| Graph::load(folder, name));
        let (encoder, query, step) = (encoder?, query?, step?);
        let frame = frame_shape(&encoder, size)?;
        let queries = wire(&query, &[(&encoder, Source::Feature)])?;
        let points = point_shape(&query, &queries, batch)?;
        let mut steps = wire(&step, &[(&encoder, Source::Feature), (&query, Source::Query)])?;
        let named =
            |words: &[&str]| step.outputs.iter().position(|end| words.iter().any(|w| end.name.contains(w)));
        let tracks = named(&["track", "position", "coord"])
            .ok_or_else(|| step.unfit("one output must be called tracks: the positions"))?;
        let (occlusion, distance, visible) = (named(&["occlu"]), named(&["dist"]), named(&["visib"]));
        if occlusion.is_none() && visible.is_none() {
            return Err(step.unfit("one output must be called occlusion (a logit) or visible (0 to 1)"));
        }
        let roles = [Some(tracks), occlusion, distance, visible];
        let rest: Vec<_> = (0..step.outputs.len()).filter(|k| !roles.contains(&Some(*k))).collect();
        let states = pair_states(&step, &mut steps, rest)?;
        let threads = Arc::new(ThreadPool::with_num_threads(n_threads.max(1)));
        Ok(Self {
            encoder,
            query,
            step,
            frame,
            queries,
            points,
            steps,
            tracks,
            occlusion,
            distance,
            visible,
            states,
            threads,
        })
    }

    /// Points at a time.
    pub(crate) fn batch_size(&self) -> usize {
        self.points.n
    }

    /// Features of a frame, given as the encoder wants it.
    pub(crate) fn encode(&self, frame: Vec<f32>) -> Result<Vec<Value>> {
        let frame = Value::from_shape(&self.frame.dims, frame)?;
        self.encoder.run(vec![frame.into()], &self.threads)
    }

    /// Makes points of a frame known, given in the net's pixels and order; fewer than a batch are filled up.
    pub(crate) fn begin(&self, features: &[Value], points: &[[f32; 2]]) -> Result<Batch> {
        let shape = &self.points;
        let n = if shape.symbol.is_some() { points.len() } else { shape.n };
        let filled = (0..n).map(|k| points[k.min(points.len() - 1)]);
        // A frame number before the position is that of the first frame of a window of one.
        let numbers: Vec<f32> =
            filled.flat_map(|at| std::iter::repeat_n(0.0, shape.numbers - 2).chain(at)).collect();
        let mut dims = vec![1; shape.rank];
        dims[shape.rank - 2] = n;
        dims[shape.rank - 1] = shape.numbers;
        let given = Value::from_shape(dims, numbers)?;
        let values = self.queries.iter().map(|source| match *source {
            Source::Feature(k) => ValueOrView::from(&features[k]),
            _ => ValueOrView::from(&given),
        });
        let queries = self.query.run(values.collect(), &self.threads)?;
        let ends = self.step.inputs.iter().zip(&self.steps);
        let states = ends.filter(|(_, source)| matches!(source, Source::State(_)));
        let mut states: Vec<_> = states.map(|(end, source)| (*source, self.zero(end, n))).collect();
        states.sort_by_key(|(source, _)| if let Source::State(k) = source { *k } else { usize::MAX });
        Ok(Batch { queries, states: states.into_iter().map(|(_, state)| state).collect::<Result<_>>()? })
    }

    /// A state before its first step.
    fn zero(&self, end: &End, n: usize) -> Result<Value> {
        let Some(shape) = &end.shape else {
            return Err(self.step.unfit(&format!("the shape of the state {} must be known", end.name)));
        };
        let size = |d: &Dimension| match d {
            Dimension::Fixed(size) => *size,
            Dimension::Symbolic(name) if self.points.symbol.as_ref() == Some(name) => n,
            Dimension::Symbolic(_) => 1,
        };
        let dims: Vec<_> = shape.iter().map(size).collect();
        let n = dims.iter().product();
        Ok(Value::from_shape(dims, vec![0.0_f32; n])?)
    }

    /// Follows the points of a batch into a frame; one answer a point that was there to begin with, then the filling.
    pub(crate) fn step(&self, features: &[Value], batch: &mut Batch) -> Result<Vec<Found>> {
        let values = self.steps.iter().map(|source| match *source {
            // Nothing is given to the step from outside: what remained is state.
            Source::Given => ValueOrView::from(&features[0]),
            Source::Feature(k) => ValueOrView::from(&features[k]),
            Source::State(k) => ValueOrView::from(&batch.states[k]),
            Source::Query(k) => ValueOrView::from(&batch.queries[k]),
        });
        let outputs = self.step.run(values.collect(), &self.threads)?;
        let numbers = |k: usize| self.numbers(&outputs[k], k);
        let tracks = numbers(self.tracks)?;
        let n = tracks.len() / 2;
        let of_points = |k: Option<usize>| -> Result<Option<Vec<f32>>> {
            let values = k.map(numbers).transpose()?;
            match values {
                Some(values) if values.len() != n => {
                    let name = &self.step.outputs[k.unwrap_or_default()].name;
                    let came = values.len();
                    Err(self.step.unfit(&format!("{name} must have one number a point, {n}; {came} came")))
                }
                values => Ok(values),
            }
        };
        let (occlusion, distance) = (of_points(self.occlusion)?, of_points(self.distance)?);
        let visible = of_points(self.visible)?;
        let found = tracks.chunks_exact(2).enumerate().map(|(k, at)| {
            let not = |logits: &Option<Vec<f32>>| logits.as_ref().map_or(1.0, |l| 1.0 - sigmoid(l[k]));
            let seen = visible.as_ref().map_or(1.0, |visible| visible[k]);
            Found { at: [at[0], at[1]], visible: seen * not(&occlusion) * not(&distance) }
        });
        let found = found.collect();
        let mut outputs: Vec<_> = outputs.into_iter().map(Some).collect();
        batch.states = self.states.iter().filter_map(|&k| outputs[k].take()).collect();
        Ok(found)
    }

    /// An output of the step as numbers.
    fn numbers(&self, value: &Value, k: usize) -> Result<Vec<f32>> {
        match value {
            Value::FloatTensor(tensor) => Ok(tensor.to_vec()),
            // Truth values come as whole numbers.
            Value::Int32Tensor(tensor) => Ok(tensor.iter().map(|&v| v as f32).collect()),
            _ => {
                let wanted = format!("{} must be a tensor of 32-bit numbers", self.step.outputs[k].name);
                Err(self.step.unfit(&wanted))
            }
        }
    }
}

fn sigmoid(logit: f32) -> f32 {
    1.0 / (1.0 + (-logit).exp())
}

/// What the encoder's one input looks like.
fn frame_shape(encoder: &Graph, size: u32) -> Result<FrameShape> {
    const WANTED: &str = "its one input must be a frame, [1, 3, height, width] or [1, height, width, 3], with one more 1 for the time";
    let unfit = || encoder.unfit(WANTED);
    let [End { shape: Some(shape), .. }] = encoder.inputs.as_slice() else { return Err(unfit()) };
    let first = shape.len().checked_sub(3).filter(|first| (1..=2).contains(first)).ok_or_else(unfit)?;
    let is_one = |d: &Dimension| matches!(d, Dimension::Fixed(1) | Dimension::Symbolic(_));
    let is_three = |d: &Dimension| *d == Dimension::Fixed(3);
    let is_planar = is_three(&shape[first]);
    if !shape[..first].iter().all(is_one) || !(is_planar || is_three(&shape[first + 2])) {
        return Err(unfit());
    }
    let pixels = |d: &Dimension| match d {
        Dimension::Fixed(pixels) => *pixels,
        Dimension::Symbolic(_) => size as usize,
    };
    let [rows, columns] = [0, 1].map(|k| pixels(&shape[first + k + usize::from(is_planar)]));
    let mut dims = vec![1; first];
    dims.extend(if is_planar { [3, rows, columns] } else { [rows, columns, 3] });
    Ok(FrameShape { dims, is_planar, width: columns as u32, height: rows as u32 })
}

/// A graph that ran before, and what its outputs are to those after it.
type Giver<'a> = (&'a Graph, fn(usize) -> Source);

/// Finds a source for each input, by name.
fn wire(graph: &Graph, earlier: &[Giver<'_>]) -> Result<Vec<Source>> {
    let source = |input: &End| {
        for &(giver, source) in earlier {
            let Some(k) = giver.outputs.iter().position(|output| output.name == input.name) else { continue };
            if !giver.outputs[k].fits(input) {
                let wanted =
                    format!("{} does not have the shape in which {} gives it", input.name, giver.name);
                return Err(Error::failed(format!(
                    "{}; {}",
                    graph.unfit(&wanted),
                    giver.unfit("it is the other end")
                )));
            }
            return Ok(source(k));
        }
        Ok(Source::Given)
    };
    graph.inputs.iter().map(source).collect()
}

/// What the one input of the query looks like that no encoder fills.
fn point_shape(query: &Graph, sources: &[Source], batch: usize) -> Result<PointShape> {
    const WANTED: &str = "all of its inputs but one must be called as outputs of encoder.onnx are, and that one be the points, [1, n, 2] or with a frame number [1, n, 3]";
    let unfit = || query.unfit(WANTED);
    let given: Vec<_> = query.inputs.iter().zip(sources).filter(|(_, s)| **s == Source::Given).collect();
    let [(End { shape: Some(shape), .. }, _)] = given.as_slice() else { return Err(unfit()) };
    let (n, symbol) = match shape.as_slice() {
        [.., Dimension::Fixed(n), _] if *n > 0 => (*n, None),
        [.., Dimension::Symbolic(name), _] => (batch, Some(name.clone())),
        _ => return Err(unfit()),
    };
    match shape.last() {
        Some(Dimension::Fixed(numbers @ (2 | 3))) => {
            Ok(PointShape { rank: shape.len(), n, symbol, numbers: *numbers })
        }
        _ => Err(unfit()),
    }
}

/// Pairs the inputs of the step that nothing fills with the outputs that mean nothing else, by name where an output's
/// holds the input's, else in order; gives the output of each state.
fn pair_states(step: &Graph, sources: &mut [Source], mut rest: Vec<usize>) -> Result<Vec<usize>> {
    let open: Vec<_> = (0..sources.len()).filter(|&k| sources[k] == Source::Given).collect();
    if open.len() != rest.len() {
        let names = |ks: &[usize], ends: &[End]| {
            ks.iter().map(|&k| ends[k].name.as_str()).collect::<Vec<_>>().join(", ")
        };
        return Err(step.unfit(&format!(
            "inputs must be called as outputs of encoder.onnx or query.onnx are, or be states with as many outputs to go with them: \
             unexplained are the inputs [{}] and the outputs [{}]",
            names(&open, &step.inputs),
            names(&rest, &step.outputs)
        )));
    }
    let mut states = Vec::new();
    for (state, &input) in open.iter().enumerate() {
        let name = step.inputs[input].name.as_str();
        let by_name = rest.iter().position(|&k| step.outputs[k].name.contains(name)).unwrap_or(0);
        let output = rest.remove(by_name);
        if !step.outputs[output].fits(&step.inputs[input]) {
            let output = &step.outputs[output].name;
            return Err(step.unfit(&format!(
                "the state {name} must come out in the shape it goes in, not as {output} does"
            )));
        }
        sources[input] = Source::State(state);
        states.push(output);
    }
    Ok(states)
}
