//! XML, element by element: with line numbers, no document in memory, and no entities but the five of XML.

use std::io::BufRead;
use std::str::FromStr;

use quick_xml::XmlVersion;
use quick_xml::events::Event;
use quick_xml::reader::Reader;

use super::Flaw;

/// Elements within elements: the formats have six at most.
const MAX_DEPTH: usize = 64;

/// What comes next.
#[derive(Debug)]
pub(crate) enum Node {
    /// An element begins.
    Open(Tag),
    /// Text in the innermost element.
    Text(String),
    /// The innermost element ends.
    Close,
}

/// The beginning of an element.
#[derive(Debug)]
pub(crate) struct Tag {
    pub(crate) name: String,
    line: u64,
    attributes: Vec<(String, String)>,
}

impl Tag {
    /// An attribute.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// An attribute that must be there.
    pub(crate) fn need<T: FromStr>(&self, name: &str, wanted: &str) -> Result<T, Flaw> {
        let text = self.get(name).unwrap_or_default();
        text.trim().parse().map_err(|_not_that| self.wrong(name, wanted, text))
    }

    /// A finite number that must be there.
    pub(crate) fn number(&self, name: &str) -> Result<f64, Flaw> {
        let number = self.need::<f64>(name, "a number")?;
        if number.is_finite() { Ok(number) } else { Err(self.wrong(name, "a finite number", "NaN or inf")) }
    }

    /// An attribute that is `1` or `0`.
    pub(crate) fn flag(&self, name: &str) -> Result<bool, Flaw> {
        match self.get(name).unwrap_or_default() {
            "1" | "True" | "true" => Ok(true),
            "0" | "False" | "false" => Ok(false),
            other => Err(self.wrong(name, "1 or 0", other)),
        }
    }

    pub(crate) fn wrong(&self, attribute: &str, wanted: &str, came: &str) -> Flaw {
        Flaw::wrong(format!("line {}, {} of <{}>", self.line, attribute, self.name), wanted, came)
    }
}

/// An open document; knows the elements it is in.
pub(crate) struct Xml<R: BufRead> {
    reader: Reader<Lines<R>>,
    buffer: Vec<u8>,
    path: Vec<String>,
}

impl<R: BufRead> Xml<R> {
    pub(crate) fn new(reader: R) -> Self {
        let mut reader = Reader::from_reader(Lines { reader, line: 1 });
        reader.config_mut().expand_empty_elements = true;
        Self { reader, buffer: Vec::new(), path: Vec::new() }
    }

    /// The elements that what came last is in, itself included, outermost first.
    pub(crate) fn path(&self) -> impl DoubleEndedIterator<Item = &str> {
        self.path.iter().map(String::as_str)
    }

    /// What comes next; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Node>, Flaw> {
        loop {
            self.buffer.clear();
            let event = self.reader.read_event_into(&mut self.buffer);
            let line = self.reader.get_ref().line;
            let at = || format!("line {line}");
            let event = match event {
                Ok(event) => event,
                Err(quick_xml::Error::Io(error)) => return Err(std::io::Error::from(error.kind()).into()),
                Err(error) => return Err(Flaw::wrong(at(), "XML", &error.to_string())),
            };
            match event {
                Event::Start(start) => {
                    let name = start.name().as_ref().to_owned();
                    let mut attributes = Vec::new();
                    for attribute in start.attributes() {
                        let attribute =
                            attribute.map_err(|error| Flaw::wrong(at(), "XML", &error.to_string()))?;
                        let value = attribute
                            .normalized_value(XmlVersion::Implicit1_0)
                            .map_err(|error| Flaw::wrong(at(), "XML", &error.to_string()))?;
                        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
                    }
                    if self.path.len() == MAX_DEPTH {
                        return Err(Flaw::wrong(
                            at(),
                            format!("at most {MAX_DEPTH} elements inside each other"),
                            &name,
                        ));
                    }
                    self.path.push(name.clone());
                    return Ok(Some(Node::Open(Tag { name, line, attributes })));
                }
                Event::End(_) => {
                    self.path.pop();
                    return Ok(Some(Node::Close));
                }
                Event::Text(text) => return Ok(Some(Node::Text(text.xml10_content().into_owned()))),
                Event::DocType(_) => {
                    return Err(Flaw::wrong(at(), "XML without a document type", "<!DOCTYPE"));
                }
                Event::Eof if self.path.is_empty() => return Ok(None),
                Event::Eof => {
                    let open = self.path.last().map_or("", String::as_str);
                    return Err(Flaw::wrong(at(), format!("</{open}>"), "the end of the file"));
                }
                _ => {}
            }
        }
    }

    /// Skips the rest of the element that was opened last.
    pub(crate) fn skip(&mut self) -> Result<(), Flaw> {
        let depth = self.path.len();
        while self.path.len() >= depth {
            if self.next()?.is_none() {
                break;
            }
        }
        Ok(())
    }
}

/// A text as an attribute or element may hold it: escaped, without control characters.
pub(crate) fn escaped(text: &str) -> String {
    quick_xml::escape::escape(text.replace(char::is_control, " ").as_str()).into_owned()
}

/// Counts the lines that were read.
struct Lines<R> {
    reader: R,
    line: u64,
}

impl<R: BufRead> std::io::Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.reader.read(buffer)?;
        self.line += newlines(&buffer[..n]);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for Lines<R> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, n: usize) {
        if let Ok(buffer) = self.reader.fill_buf() {
            self.line += newlines(buffer.get(..n).unwrap_or_default());
        }
        self.reader.consume(n);
    }
}

fn newlines(bytes: &[u8]) -> u64 {
    bytes.iter().filter(|&&byte| byte == b'\n').count() as u64
}
