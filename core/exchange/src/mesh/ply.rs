//! Stanford's `.ply`: a header of elements and their properties, and rows of them as text or as numbers.

use honami_model::mesh::Mesh;

use super::{Frame, fan};
use crate::plant::PlantFileError;

/// What files that are written begin with.
pub(super) const BEGIN: &str = "ply\nformat binary_little_endian 1.0\ncomment a plant moved by honami\n";

/// How numbers are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Text,
    Little,
    Big,
}

/// Kinds of numbers: how many bytes, and of which sort.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// A column of an element: a number a row, or a list of them with its length before it.
#[derive(Clone, Debug)]
struct Property {
    name: String,
    /// Of the length.
    list: Option<Kind>,
    kind: Kind,
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    n_rows: u64,
    properties: Vec<Property>,
}

/// Reads vertices and faces, and notes what else there is.
pub(super) fn read(bytes: &[u8]) -> Result<(Mesh, Vec<String>), PlantFileError> {
    let (order, elements, first) = header(bytes)?;
    let mut numbers = Numbers { bytes: &bytes[first..], order };
    let mut mesh = Mesh::default();
    for element in &elements {
        // A row without properties is nothing, and any number of them takes no bytes.
        if element.properties.is_empty() && element.name != "vertex" {
            continue;
        }
        let n_left = numbers.bytes.len();
        if element.n_rows > n_left as u64 {
            return Err(lacks(format!(
                "{} rows of {} cannot be in the {n_left} bytes that are left",
                element.n_rows, element.name
            )));
        }
        for row in 0..element.n_rows {
            let short =
                || lacks(format!("the file ends in row {row} of {} of {}", element.n_rows, element.name));
            let mut place = [f64::NAN; 3];
            for property in &element.properties {
                let Some(length) = property.list else {
                    let number = numbers.next(property.kind).ok_or_else(short)?;
                    if let Some(axis) = AXES.iter().position(|axis| *axis == property.name) {
                        place[axis] = number;
                    }
                    continue;
                };
                let n = numbers.next(length).ok_or_else(short)?;
                let n = whole(n).ok_or_else(|| {
                    lacks(format!("a list of {} has {n} numbers: {WHOLE} was wanted", element.name))
                })?;
                let is_face = element.keeps(property);
                let mut corners = Vec::new();
                for _ in 0..n {
                    let number = numbers.next(property.kind).ok_or_else(short)?;
                    if is_face {
                        let none = || lacks(format!("a face has vertex {number}: {WHOLE} was wanted"));
                        corners.push(whole(number).ok_or_else(none)?);
                    }
                }
                mesh.triangles.extend(fan(&corners));
            }
            if element.name == "vertex" {
                if !place.iter().all(|v| v.is_finite()) {
                    return Err(lacks(format!(
                        "vertex {row} lies at {place:?}: three finite numbers were wanted"
                    )));
                }
                mesh.positions.push(place);
            }
        }
    }
    let n = mesh.positions.len();
    match mesh.triangles.iter().flatten().find(|corner| **corner as usize >= n) {
        Some(corner) => Err(lacks(format!("a face has vertex {corner}, and there are 0 to less than {n}"))),
        None => Ok((mesh, elements.iter().filter_map(Element::note).collect())),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Element {
    /// Whether a property of it is part of a mesh.
    fn keeps(&self, property: &Property) -> bool {
        match self.name.as_str() {
            "vertex" => property.list.is_none() && AXES.contains(&property.name.as_str()),
            "face" => property.list.is_some() && property.name.starts_with("vertex_ind"),
            _ => false,
        }
    }

    /// What of it is left out.
    fn note(&self) -> Option<String> {
        let names = self.properties.iter().filter(|property| !self.keeps(property));
        let names: Vec<&str> = names.map(|property| property.name.as_str()).collect();
        if self.n_rows == 0 || names.is_empty() {
            return None;
        }
        let what = if names.len() == self.properties.len() {
            format!("{} (rows: {})", self.name, self.n_rows)
        } else {
            format!("{} of {}", names.join(", "), self.name)
        };
        Some(format!("left out of the .ply: {what}"))
    }
}

/// How numbers are kept, of which elements, and where they begin.
fn header(bytes: &[u8]) -> Result<(Order, Vec<Element>, usize), PlantFileError> {
    let (mut order, mut elements, mut first) = (None, Vec::<Element>::new(), 0);
    for (line, text) in (1..).zip(bytes.split_inclusive(|byte| *byte == b'\n')) {
        let wrong = |what: &str| PlantFileError::Line { line, what: what.to_owned() };
        first += text.len();
        let text = String::from_utf8_lossy(text);
        let words: Vec<&str> = text.split_whitespace().collect();
        match words[..] {
            ["ply"] if line == 1 => {}
            _ if line == 1 => return Err(wrong("a .ply begins with `ply`, this does not")),
            ["format", kept, _] => {
                order = match kept {
                    "ascii" => Some(Order::Text),
                    "binary_little_endian" => Some(Order::Little),
                    "binary_big_endian" => Some(Order::Big),
                    _ => return Err(wrong("a format is ascii, binary_little_endian or binary_big_endian")),
                }
            }
            ["element", name, n] => {
                let n_rows = n.parse().map_err(|_no_number| wrong("an element has a number of rows"))?;
                elements.push(Element { name: name.to_owned(), n_rows, properties: Vec::new() });
            }
            ["property", ref words @ .., name] => {
                let kinds: Option<Vec<Kind>> =
                    words.iter().filter(|word| **word != "list").map(|word| kind(word)).collect();
                let (list, kind) = match (kinds.as_deref(), words.first()) {
                    (Some([length, kind]), Some(&"list")) => (Some(*length), *kind),
                    (Some([kind]), Some(first)) if *first != "list" => (None, *kind),
                    _ => {
                        return Err(wrong(
                            "a property is of a kind of number, or a list of them, and has a name",
                        ));
                    }
                };
                let element = elements.last_mut().ok_or_else(|| wrong("a property is of an element"))?;
                element.properties.push(Property { name: name.to_owned(), list, kind });
            }
            ["end_header"] => {
                let order = order.ok_or_else(|| wrong("a header names a format, this does not"))?;
                return Ok((order, elements, first));
            }
            _ => {}
        }
    }
    Err(lacks("the header of a .ply ends with `end_header`, this does not".to_owned()))
}

fn kind(word: &str) -> Option<Kind> {
    Some(match word {
        "char" | "int8" => Kind::Signed(1),
        "uchar" | "uint8" => Kind::Unsigned(1),
        "short" | "int16" => Kind::Signed(2),
        "ushort" | "uint16" => Kind::Unsigned(2),
        "int" | "int32" => Kind::Signed(4),
        "uint" | "uint32" => Kind::Unsigned(4),
        "float" | "float32" => Kind::Float(4),
        "double" | "float64" => Kind::Float(8),
        _ => return None,
    })
}

/// Numbers that are not read yet.
struct Numbers<'a> {
    bytes: &'a [u8],
    order: Order,
}

impl Numbers<'_> {
    /// The next; `None` at the end, and for text that is none.
    fn next(&mut self, kind: Kind) -> Option<f64> {
        if self.order == Order::Text {
            let begin = self.bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
            let rest = &self.bytes[begin..];
            let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
            self.bytes = &rest[end..];
            return std::str::from_utf8(&rest[..end]).ok()?.parse().ok();
        }
        let (Kind::Signed(n) | Kind::Unsigned(n) | Kind::Float(n)) = kind;
        let (own, rest) = self.bytes.split_at_checked(n)?;
        self.bytes = rest;
        let mut word = [0; 8];
        word[..n].copy_from_slice(own);
        if self.order == Order::Big {
            word[..n].reverse();
        }
        let bits = u64::from_le_bytes(word);
        let unused = 64 - 8 * n as u32;
        Some(match kind {
            Kind::Signed(_) => ((bits << unused) as i64 >> unused) as f64,
            Kind::Unsigned(_) => bits as f64,
            Kind::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Kind::Float(_) => f64::from_bits(bits),
        })
    }
}

const WHOLE: &str = "a whole number below 2^32";

/// A number that counts; `None` for others.
fn whole(number: f64) -> Option<u32> {
    (number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number)).then_some(number as u32)
}

fn lacks(what: String) -> PlantFileError {
    PlantFileError::Lacks(what)
}

/// A frame as numbers.
pub(super) fn written(frame: &Frame<'_>) -> Vec<u8> {
    let (n, n_faces) = (frame.positions.len(), frame.triangles.len());
    let mut bytes =
        format!("{BEGIN}element vertex {n}\nproperty float x\nproperty float y\nproperty float z\n");
    if !frame.colours.is_empty() {
        bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    }
    bytes += &format!("element face {n_faces}\nproperty list uchar int vertex_indices\nend_header\n");
    let mut bytes = bytes.into_bytes();
    for (row, place) in frame.positions.iter().enumerate() {
        bytes.extend(place.iter().flat_map(|v| (*v as f32).to_le_bytes()));
        bytes.extend(frame.colours.get(row).iter().copied().flatten());
    }
    for corners in frame.triangles {
        bytes.push(3);
        bytes.extend(corners.iter().flat_map(|corner| corner.to_le_bytes()));
    }
    bytes
}
