//! One ONNX graph: its file, what goes in and out of it by name, and running it.

use std::path::Path;
use std::sync::Arc;

use honami_plugin::{Error, Result};
use rten::{Dimension, Model, ModelOptions, NodeId, RunOptions, ThreadPool, Value, ValueOrView};

/// A graph with named ends.
pub(crate) struct Graph {
    /// Its file's name, for messages.
    pub(crate) name: &'static str,
    model: Model,
    pub(crate) inputs: Vec<End>,
    pub(crate) outputs: Vec<End>,
}

/// Something that goes into a graph or comes out of it.
pub(crate) struct End {
    id: NodeId,
    pub(crate) name: String,
    /// `None` where the file does not say.
    pub(crate) shape: Option<Vec<Dimension>>,
}

impl Graph {
    /// Reads `folder/name`.
    pub(crate) fn load(folder: &Path, name: &'static str) -> Result<Self> {
        let path = folder.join(name);
        let shown = path.display();
        if !path.is_file() {
            return Err(Error::failed(format!(
                "there is no {shown}: set `graphs` to the folder with encoder.onnx, query.onnx and step.onnx"
            )));
        }
        let load = || ModelOptions::with_all_ops().load_file(&path);
        let model = load().map_err(|error| Error::failed(format!("{shown} cannot be used: {error}")))?;
        let ends = |ids: &[NodeId]| {
            let end = |&id| {
                let node = model.node_info(id);
                let name = node.as_ref().and_then(rten::NodeInfo::name).unwrap_or_default().to_owned();
                End { id, name, shape: node.and_then(|node| node.shape()) }
            };
            ids.iter().map(end).collect::<Vec<_>>()
        };
        let (inputs, outputs) = (ends(model.input_ids()), ends(model.output_ids()));
        Ok(Self { name, model, inputs, outputs })
    }

    /// Runs it on one value an input, in order; gives one value an output, in order.
    pub(crate) fn run(&self, values: Vec<ValueOrView<'_>>, threads: &Arc<ThreadPool>) -> Result<Vec<Value>> {
        let inputs = self.inputs.iter().map(|end| end.id).zip(values).collect();
        let outputs: Vec<_> = self.outputs.iter().map(|end| end.id).collect();
        let options = RunOptions::default().with_thread_pool(Some(Arc::clone(threads)));
        let run = self.model.run(inputs, &outputs, Some(options));
        run.map_err(|error| Error::failed(format!("{} failed: {error}", self.name)))
    }

    /// A complaint about this graph: what was wanted, what came.
    pub(crate) fn unfit(&self, wanted: &str) -> Error {
        let list = |ends: &[End]| ends.iter().map(End::describe).collect::<Vec<_>>().join(", ");
        Error::failed(format!(
            "{}: {wanted}; it takes {} and gives {}",
            self.name,
            list(&self.inputs),
            list(&self.outputs)
        ))
    }
}

impl End {
    /// `tracks [1, n, 2]`.
    fn describe(&self) -> String {
        match &self.shape {
            None => self.name.clone(),
            Some(shape) => {
                let size = |d: &Dimension| match d {
                    Dimension::Fixed(n) => n.to_string(),
                    Dimension::Symbolic(name) => name.clone(),
                };
                format!("{} [{}]", self.name, shape.iter().map(size).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// Whether what comes out here may go in there: no fixed dimension contradicts.
    pub(crate) fn fits(&self, there: &Self) -> bool {
        let (Some(here), Some(there)) = (&self.shape, &there.shape) else { return true };
        let may_be = |pair: (&Dimension, &Dimension)| match pair {
            (Dimension::Fixed(a), Dimension::Fixed(b)) => a == b,
            _ => true,
        };
        here.len() == there.len() && here.iter().zip(there).all(may_be)
    }
}
