//! Parts of a file of others in another file, as often as wanted.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{Document, KEPT, Matrix, Piece, laid, product, upright};

/// Meshes of a file on their way into another, with what they need: their numbers, materials and pictures, each once.
#[derive(Debug)]
pub struct Grafting<'a> {
    from: &'a Document,
    /// What has a place in the other file already: a list and a row there.
    taken: BTreeMap<(&'static str, usize), usize>,
}

impl<'a> Grafting<'a> {
    /// Of a file.
    #[must_use]
    pub fn of(from: &'a Document) -> Self {
        Self { from, taken: BTreeMap::new() }
    }

    /// Puts a piece into the scene of `into`, moved by what moves three axes and the origin, z up. Extensions of its mesh stay
    /// behind; materials keep theirs.
    #[must_use]
    pub fn graft(
        &mut self,
        into: &mut Document,
        piece: &Piece,
        axes: [[f64; 3]; 3],
        origin: [f64; 3],
    ) -> Piece {
        let mesh = self.take(into, "meshes", piece.mesh);
        let matrix = product(&moving(axes, origin), &piece.matrix);
        let mut words = json!({ "mesh": mesh, "matrix": matrix });
        for name in KEPT {
            let kept = &self.from.words["nodes"][piece.node][name];
            if !kept.is_null() {
                words[name] = kept.clone();
            }
        }
        let node = into.put("nodes", words);
        if let Some(scene) = into.scene().as_array_mut() {
            scene.push(node.into());
        }
        Piece { node, mesh, matrix, ..piece.clone() }
    }

    /// What stands in a list: the row that it has in the other file.
    fn take(&mut self, into: &mut Document, list: &'static str, row: usize) -> usize {
        if let Some(there) = self.taken.get(&(list, row)) {
            return *there;
        }
        let mut words = self.from.words[list][row].clone();
        match list {
            "meshes" => self.mesh(into, &mut words),
            "materials" => self.refer(into, &mut words, &[("index", "textures")]),
            "textures" => self.refer(into, &mut words, &[("sampler", "samplers"), ("source", "images")]),
            "accessors" | "images" => self.refer(into, &mut words, &[("bufferView", "bufferViews")]),
            "bufferViews" => self.numbers(into, &mut words),
            _ => {}
        }
        let there = into.put(list, words);
        self.taken.insert((list, row), there);
        there
    }

    fn mesh(&mut self, into: &mut Document, words: &mut Value) {
        for primitive in words["primitives"].as_array_mut().into_iter().flatten() {
            let Some(primitive) = primitive.as_object_mut() else { continue };
            primitive.remove("extensions");
            for (name, list) in primitive.iter_mut() {
                match name.as_str() {
                    "indices" => self.renew(into, list, "accessors"),
                    "material" => self.renew(into, list, "materials"),
                    "attributes" => self.vertices(into, list),
                    "targets" => {
                        list.as_array_mut()
                            .into_iter()
                            .flatten()
                            .for_each(|target| self.vertices(into, target));
                    }
                    _ => {}
                }
            }
        }
        words.as_object_mut().into_iter().for_each(|words| drop(words.remove("extensions")));
    }

    /// What vertices have, by names.
    fn vertices(&mut self, into: &mut Document, words: &mut Value) {
        for (_, accessor) in words.as_object_mut().into_iter().flatten() {
            self.renew(into, accessor, "accessors");
        }
    }

    /// Makes rows that are named so anywhere in the words those of the other file.
    fn refer(&mut self, into: &mut Document, words: &mut Value, names: &[(&str, &'static str)]) {
        for value in words.as_array_mut().into_iter().flatten() {
            self.refer(into, value, names);
        }
        for (name, value) in words.as_object_mut().into_iter().flatten() {
            match names.iter().find(|(known, _)| known == name) {
                Some((_, list)) => self.renew(into, value, list),
                None if name == "extras" => {}
                None => self.refer(into, value, names),
            }
        }
    }

    fn renew(&mut self, into: &mut Document, row: &mut Value, list: &'static str) {
        if let Some(there) = row.as_u64() {
            *row = self.take(into, list, there as usize).into();
        }
    }

    /// The bytes of a view, at the end of those that there are.
    fn numbers(&self, into: &mut Document, words: &mut Value) {
        let [first, length] =
            ["byteOffset", "byteLength"].map(|name| words[name].as_u64().unwrap_or(0) as usize);
        let bytes =
            first.checked_add(length).and_then(|end| self.from.numbers.get(first..end)).unwrap_or_default();
        if !words.is_object() {
            *words = json!({});
        }
        into.numbers.resize(into.numbers.len().next_multiple_of(4), 0);
        words["byteOffset"] = into.numbers.len().into();
        into.numbers.extend(bytes);
    }
}

impl Document {
    /// A scene with nothing in it.
    #[must_use]
    pub fn empty() -> Self {
        Self { words: json!({ "scene": 0, "scenes": [{ "nodes": [] }] }), numbers: Vec::new() }
    }

    /// Owns up to what else it is made of: whose others are, and which extensions their materials use.
    pub fn credit(&mut self, others: &[&Self]) {
        let mut whose: Vec<&str> = Vec::new();
        for other in others {
            whose.extend(other.words["asset"]["copyright"].as_str().filter(|by| !whose.contains(by)));
            for list in ["extensionsUsed", "extensionsRequired"] {
                for name in other.words[list].as_array().into_iter().flatten() {
                    let is_there = self.words[list].as_array().is_some_and(|list| list.contains(name));
                    if !is_there {
                        self.put(list, name.clone());
                    }
                }
            }
        }
        if !whose.is_empty() {
            self.words["asset"]["copyright"] = whose.join("; ").into();
        }
    }
}

/// What moves axes and origin so, z up, as a matrix of the file, y up.
fn moving(axes: [[f64; 3]; 3], origin: [f64; 3]) -> Matrix {
    let to = |place: [f64; 3]| {
        let laid = laid(place);
        upright(std::array::from_fn(|row| (0..3).map(|axis| axes[axis][row] * laid[axis]).sum()))
    };
    let columns = [to([1.0, 0.0, 0.0]), to([0.0, 1.0, 0.0]), to([0.0, 0.0, 1.0]), upright(origin)];
    std::array::from_fn(|at| match (at / 4, at % 4) {
        (column, row) if row < 3 => columns[column][row],
        (column, _) => f64::from(u8::from(column == 3)),
    })
}
