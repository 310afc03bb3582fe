//! Writes ONNX graphs: as much of the format (a protocol buffer) as the tests' graphs need.

/// A message under way.
#[derive(Default)]
struct Message(Vec<u8>);

impl Message {
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    fn int(mut self, field: u64, value: i64) -> Self {
        self.varint(field << 3);
        self.varint(value as u64);
        self
    }

    fn bytes(mut self, field: u64, bytes: &[u8]) -> Self {
        self.varint(field << 3 | 2);
        self.varint(bytes.len() as u64);
        self.0.extend(bytes);
        self
    }

    fn text(self, field: u64, text: &str) -> Self {
        self.bytes(field, text.as_bytes())
    }
}

/// A dimension: a number, or a name where it is open.
#[derive(Clone, Copy)]
pub(super) enum Dim {
    Is(i64),
    Open(&'static str),
}
pub(super) use Dim::{Is, Open};

/// A graph under way.
#[derive(Default)]
pub(super) struct Graph(Message);

const FLOAT: i64 = 1;
const INT64: i64 = 7;

impl Graph {
    /// A tensor of 32-bit numbers that goes in.
    pub(super) fn input(self, name: &str, shape: &[Dim]) -> Self {
        self.end(11, name, shape)
    }

    /// One that comes out.
    pub(super) fn output(self, name: &str, shape: &[Dim]) -> Self {
        self.end(12, name, shape)
    }

    fn end(self, field: u64, name: &str, shape: &[Dim]) -> Self {
        let dims = shape.iter().fold(Message::default(), |shape, dim| {
            let dim = match dim {
                Is(size) => Message::default().int(1, *size),
                Open(name) => Message::default().text(2, name),
            };
            shape.bytes(1, &dim.0)
        });
        let tensor = Message::default().int(1, FLOAT).bytes(2, &dims.0);
        let kind = Message::default().bytes(1, &tensor.0);
        let end = Message::default().text(1, name).bytes(2, &kind.0);
        Self(self.0.bytes(field, &end.0))
    }

    /// Constants.
    pub(super) fn floats(self, name: &str, dims: &[i64], values: &[f32]) -> Self {
        self.constant(name, dims, FLOAT, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    }

    pub(super) fn ints(self, name: &str, dims: &[i64], values: &[i64]) -> Self {
        self.constant(name, dims, INT64, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
    }

    fn constant(self, name: &str, dims: &[i64], kind: i64, raw: &[u8]) -> Self {
        let tensor = dims.iter().fold(Message::default(), |tensor, &dim| tensor.int(1, dim));
        let tensor = tensor.int(2, kind).text(8, name).bytes(9, raw);
        Self(self.0.bytes(5, &tensor.0))
    }

    /// A node with one output.
    pub(super) fn node(self, kind: &str, inputs: &[&str], output: &str) -> Self {
        self.with(kind, inputs, output, &[])
    }

    /// A convolution with as many pixels around as keep the size.
    pub(super) fn conv(self, inputs: &[&str; 2], output: &str, border: i64) -> Self {
        let one = [1; 2];
        self.with("Conv", inputs, output, &[("pads", &[border; 4]), ("strides", &one), ("dilations", &one)])
    }

    fn with(self, kind: &str, inputs: &[&str], output: &str, attributes: &[(&str, &[i64])]) -> Self {
        const INTS: i64 = 7;
        let node = inputs.iter().fold(Message::default(), |node, input| node.text(1, input));
        let node = node.text(2, output).text(3, output).text(4, kind);
        let node = attributes.iter().fold(node, |node, (name, values)| {
            let attribute = values.iter().fold(Message::default().text(1, name), |a, &value| a.int(8, value));
            node.bytes(5, &attribute.int(20, INTS).0)
        });
        Self(self.0.bytes(1, &node.0))
    }

    /// The whole file.
    pub(super) fn file(self, name: &str) -> Vec<u8> {
        let opset = Message::default().text(1, "").int(2, 17);
        let graph = self.0.text(2, name);
        Message::default().int(1, 8).bytes(7, &graph.0).bytes(8, &opset.0).0
    }
}
