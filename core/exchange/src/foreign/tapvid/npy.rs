//! Arrays of NumPy, format 1.0 to 3.0: plain numbers in C order, and nothing that runs code.

use std::io::Read;

use super::super::Flaw;

/// A header as long as any of a plain array.
const MAX_HEADER: usize = 4096;

/// What an array holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bool,
    F32,
    F64,
}

/// What the header of an array says.
#[derive(Debug)]
pub(super) struct Head {
    pub(super) shape: Vec<usize>,
    kind: Kind,
    big_endian: bool,
}

/// Reads the header of an array.
pub(super) fn head(reader: &mut impl Read, array: &str) -> Result<Head, Flaw> {
    let mut magic = [0; 8];
    fill(reader, &mut magic, array)?;
    if !magic.starts_with(b"\x93NUMPY") {
        return Err(Flaw::wrong(array, "an array of NumPy", &String::from_utf8_lossy(&magic[..6])));
    }
    let length = match magic[6] {
        1 => {
            let mut length = [0; 2];
            fill(reader, &mut length, array)?;
            usize::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            fill(reader, &mut length, array)?;
            u32::from_le_bytes(length) as usize
        }
        version => return Err(Flaw::wrong(array, "an array of format 1 to 3", &version.to_string())),
    };
    if length > MAX_HEADER {
        let came = format!("{length} bytes");
        return Err(Flaw::wrong(array, format!("a header of at most {MAX_HEADER} bytes"), &came));
    }
    let mut text = vec![0; length];
    fill(reader, &mut text, array)?;
    let text = String::from_utf8_lossy(&text);
    let wrong =
        || Flaw::wrong(array, "the header {'descr': …, 'fortran_order': …, 'shape': (…)}", text.trim());
    let literal = literal(&text).ok_or_else(wrong)?;
    let (kind, big_endian) = kind(&literal.descr).ok_or_else(|| {
        let objects = literal.descr.contains('O');
        let wanted = if objects {
            "plain numbers; objects are pickles, which honami never loads (docs/formats.md has a converter)"
        } else {
            "numbers of type f4, f8 or bool"
        };
        Flaw::wrong(array, wanted, &literal.descr)
    })?;
    if literal.fortran_order {
        return Err(Flaw::wrong(array, "C order (np.ascontiguousarray)", "Fortran order"));
    }
    Ok(Head { shape: literal.shape, kind, big_endian })
}

fn kind(descr: &str) -> Option<(Kind, bool)> {
    Some(match descr {
        "|b1" | "|u1" | "|i1" => (Kind::Bool, false),
        "<f4" => (Kind::F32, false),
        ">f4" => (Kind::F32, true),
        "<f8" => (Kind::F64, false),
        ">f8" => (Kind::F64, true),
        _ => return None,
    })
}

impl Head {
    /// The next number.
    pub(super) fn number(&self, reader: &mut impl Read, array: &str) -> Result<f64, Flaw> {
        match self.kind {
            Kind::F32 => {
                let mut bytes = [0; 4];
                fill(reader, &mut bytes, array)?;
                let value =
                    if self.big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) };
                Ok(value.into())
            }
            Kind::F64 => {
                let mut bytes = [0; 8];
                fill(reader, &mut bytes, array)?;
                Ok(if self.big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) })
            }
            Kind::Bool => Err(Flaw::wrong(array, "numbers of type f4 or f8", "bool")),
        }
    }

    /// The next yes or no.
    pub(super) fn flag(&self, reader: &mut impl Read, array: &str) -> Result<bool, Flaw> {
        if self.kind != Kind::Bool {
            return Err(Flaw::wrong(array, "an array of type bool", "numbers"));
        }
        let mut byte = [0];
        fill(reader, &mut byte, array)?;
        Ok(byte[0] != 0)
    }
}

fn fill(reader: &mut impl Read, bytes: &mut [u8], array: &str) -> Result<(), Flaw> {
    reader.read_exact(bytes).map_err(|error| Flaw::wrong(array, "a whole array", &error.to_string()))
}

/// The dictionary of a header.
#[derive(Debug, Default, PartialEq)]
struct Literal {
    descr: String,
    fortran_order: bool,
    shape: Vec<usize>,
}

/// Reads `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }`, its keys in any order; a `descr` that is
/// no string (a record) comes back as it stands.
fn literal(text: &str) -> Option<Literal> {
    let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
    let (mut descr, mut order, mut shape) = (None, None, None);
    while !rest.is_empty() {
        let (key, after) = quoted(rest)?;
        let after = after.trim_start().strip_prefix(':')?.trim_start();
        let end = match key {
            "descr" => {
                let (value, after) = quoted(after).unwrap_or((after, ""));
                descr = Some(value.to_owned());
                after
            }
            "fortran_order" => {
                let (value, after) = after.split_at(after.find([',', ' ']).unwrap_or(after.len()));
                order = Some(match value {
                    "True" => true,
                    "False" => false,
                    _ => return None,
                });
                after
            }
            "shape" => {
                let (value, after) = after.strip_prefix('(')?.split_once(')')?;
                let numbers = value.split(',').map(str::trim).filter(|number| !number.is_empty());
                shape = Some(numbers.map(|number| number.parse().ok()).collect::<Option<Vec<usize>>>()?);
                after
            }
            _ => return None,
        };
        rest = end.trim_start();
        rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
    }
    Some(Literal { descr: descr?, fortran_order: order?, shape: shape? })
}

/// A string in quotes, and what follows it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| *c == '\'' || *c == '"')?;
    text[1..].split_once(quote)
}

/// The header of an array, format 1.0, padded to 64 bytes.
pub(super) fn header(descr: &str, shape: &[usize]) -> Vec<u8> {
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let shape = shape.trim_end();
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes()].concat()
}

#[cfg(test)]
mod tests;
