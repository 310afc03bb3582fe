//! Where numbers lie in the file: a view for indices, one for vertices, one for times and weights.

use super::upright;
use serde_json::{Value, json};

/// Names of the standard: what a number is, and what it is for.
const U32: u32 = 5125;
const F32: u32 = 5126;
const ARRAY: u32 = 34962;
const INDICES: u32 = 34963;

/// Views, in this order.
const OF_INDICES: usize = 0;
const OF_VERTICES: usize = 1;
const OF_NUMBERS: usize = 2;

/// Numbers that are laid out one after another.
#[derive(Debug, Default)]
pub(super) struct Layout {
    accessors: Vec<Value>,
    /// Bytes of each view so far.
    views: [usize; 3],
}

impl Layout {
    /// Indices of triangles; the number of the accessor.
    pub(super) fn indices(&mut self, n_triangles: usize) -> usize {
        let count = 3 * n_triangles;
        self.add(OF_INDICES, 4 * count, json!({ "componentType": U32, "type": "SCALAR", "count": count }))
    }

    /// Three numbers a vertex, as they are before they are turned upright.
    pub(super) fn vertices(&mut self, vertices: impl ExactSizeIterator<Item = [f32; 3]>) -> usize {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let count = vertices.len();
        for vertex in vertices {
            for (axis, v) in upright(vertex).into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(v), high[axis].max(v));
            }
        }
        let what = json!({
            "componentType": F32, "type": "VEC3", "count": count, "min": low, "max": high,
        });
        self.add(OF_VERTICES, 12 * count, what)
    }

    /// Seconds, ascending.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let what = json!({
            "componentType": F32, "type": "SCALAR", "count": times.len(),
            "min": times.first().as_slice(), "max": times.last().as_slice(),
        });
        self.add(OF_NUMBERS, 4 * times.len(), what)
    }

    /// Weights of a copy.
    pub(super) fn weights(&mut self, count: usize) -> usize {
        self.add(OF_NUMBERS, 4 * count, json!({ "componentType": F32, "type": "SCALAR", "count": count }))
    }

    fn add(&mut self, view: usize, n_bytes: usize, mut what: Value) -> usize {
        what["bufferView"] = view.into();
        what["byteOffset"] = self.views[view].into();
        self.views[view] += n_bytes;
        self.accessors.push(what);
        self.accessors.len() - 1
    }

    /// Buffers, views and accessors.
    pub(super) fn finish(self) -> (Value, Value, Value) {
        let [indices, vertices, numbers] = self.views;
        let mut views = vec![
            json!({ "buffer": 0, "byteOffset": 0, "byteLength": indices, "target": INDICES }),
            json!({ "buffer": 0, "byteOffset": indices, "byteLength": vertices, "byteStride": 12, "target": ARRAY }),
        ];
        // A view of nothing is none.
        if numbers > 0 {
            views.push(json!({ "buffer": 0, "byteOffset": indices + vertices, "byteLength": numbers }));
        }
        (json!([{ "byteLength": indices + vertices + numbers }]), views.into(), self.accessors.into())
    }
}
