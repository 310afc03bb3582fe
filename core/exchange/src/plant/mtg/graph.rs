//! The lines of a multiscale tree graph: parts, what each stands on, and where it ends.

use crate::plant::PlantFileError;
use honami_model::brief::Brief;
use std::collections::BTreeMap;

/// A longer series of parts is a slip of the pen.
const SERIES_MAX: u32 = 10_000;

/// All parts of all scales, each after what it stands on.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub(super) vertices: Vec<Vertex>,
}

/// A part of a plant.
#[derive(Clone, Debug)]
pub(super) struct Vertex {
    pub(super) class: String,
    index: u32,
    pub(super) line: usize,
    scale: u32,
    /// Of the finest scale that has positions.
    pub(super) is_finest: bool,
    /// The part of the finest scale that comes before it, or before its first such part.
    pub(super) before: Option<usize>,
    /// What it is a part of.
    pub(super) whole: Option<usize>,
    /// Its last part of the finest scale, or itself.
    last: Option<usize>,
    pub(super) position: Option<[f64; 3]>,
    pub(super) diameter: Option<f64>,
}

impl Vertex {
    pub(super) fn name(&self) -> String {
        format!("{}{}", self.class, self.index)
    }
}

/// Where the features are in a line.
struct Columns {
    n_axes: usize,
    position: [usize; 3],
    diameter: usize,
}

fn wrong(line: usize, what: impl Into<String>) -> PlantFileError {
    PlantFileError::Line { line, what: what.into() }
}

/// A part in a column of numbers would be lost without a word.
fn not_beyond(line: usize, cells: &[&str], n_axes: usize) -> Result<(), PlantFileError> {
    let is_part = |cell: &&&str| {
        let class = cell.trim_start_matches(['/', '<', '+', '^']);
        class.len() < cell.len() && class.starts_with(|c: char| c.is_ascii_alphabetic())
    };
    match cells.iter().find(is_part) {
        Some(part) => Err(wrong(
            line,
            format!("{part:?} stands beyond the {n_axes} columns that the header has for parts"),
        )),
        None => Ok(()),
    }
}

impl Graph {
    pub(super) fn parse(text: &str) -> Result<Self, PlantFileError> {
        let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line));
        let scales = scales(&mut lines)?;
        let finest = scales.values().copied().max().unwrap_or_default();
        let columns = columns(&mut lines)?;
        let mut graph = Self::default();
        // The last part of every column.
        let mut open: Vec<Option<usize>> = Vec::new();
        for (number, line) in lines {
            // What follows is a remark.
            let line = line.split('#').next().unwrap_or_default();
            let cells: Vec<&str> = line.split('\t').map(str::trim).collect();
            let Some(axis) = cells.iter().take(columns.n_axes).position(|cell| !cell.is_empty()) else {
                not_beyond(number, &cells, columns.n_axes)?;
                continue;
            };
            let (word, from) = match cells[axis].strip_prefix('^') {
                Some(word) => (word, Some(axis)),
                None => (cells[axis], axis.checked_sub(1)),
            };
            let from = from.and_then(|axis| open.get(axis).copied().flatten());
            if from.is_none() && axis > 0 {
                return Err(wrong(number, format!("{:?} stands under nothing", cells[axis])));
            }
            let last = graph.add_all(number, word, from, &scales, finest)?;
            graph.measure(last, number, &cells, &columns)?;
            open.resize(axis, None);
            open.push(Some(last));
        }
        Ok(graph)
    }

    /// Adds the parts of a word such as `/S1`, `+A2/S1` or `<<E35`; the last of them.
    fn add_all(
        &mut self,
        line: usize,
        word: &str,
        from: Option<usize>,
        scales: &BTreeMap<String, u32>,
        finest: u32,
    ) -> Result<usize, PlantFileError> {
        let unknown = || wrong(line, format!("{word:?} is no word such as /S1, <S2 or +A1"));
        let (mut at, mut rest) = (from, word);
        while !rest.is_empty() {
            let n_relation =
                rest.find(|c: char| !"/<+".contains(c)).filter(|n| *n > 0).ok_or_else(unknown)?;
            let (relation, more) = rest.split_at(n_relation);
            let n_class = more.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(more.len());
            let (class, more) = more.split_at(n_class);
            let n_index = more.find(|c: char| !c.is_ascii_digit()).unwrap_or(more.len());
            let (index, more) = more.split_at(n_index);
            let scale =
                *scales.get(class).ok_or_else(|| wrong(line, format!("class {class:?} is not declared")))?;
            // A part without a number is the only one.
            let index: u32 = if index.is_empty() { 0 } else { index.parse().map_err(|_none| unknown())? };
            let first = match relation {
                "<<" => at.map_or(0, |at| self.vertices[at].index).saturating_add(1),
                "/" | "<" | "+" => index,
                _ => return Err(unknown()),
            };
            if index < first || index - first > SERIES_MAX {
                return Err(wrong(
                    line,
                    format!("{relation}{class}{index} is no series from {class}{first} on"),
                ));
            }
            for index in first..=index {
                let vertex = (class.to_owned(), index, scale);
                at = Some(self.add(line, vertex, relation == "/", at, scale == finest));
            }
            rest = more;
        }
        at.ok_or_else(unknown)
    }

    fn add(
        &mut self,
        line: usize,
        (class, index, scale): (String, u32, u32),
        is_part: bool,
        from: Option<usize>,
        is_finest: bool,
    ) -> usize {
        // A coarser part that has none of the finest yet stands on what comes before it.
        let nearest = |at: usize| self.vertices[at].last.or(self.vertices[at].before);
        let before = match from {
            Some(at) if is_part => self.vertices[at].last.map_or(self.vertices[at].before, |_| None),
            Some(at) => nearest(at),
            None => None,
        };
        // What goes on from a part belongs to the same whole, of which it is of a coarser scale.
        let mut whole = from;
        while let Some(at) = whole.filter(|at| self.vertices[*at].scale >= scale) {
            whole = self.vertices[at].whole;
        }
        let new = self.vertices.len();
        let last = is_finest.then_some(new);
        let vertex = Vertex {
            class,
            index,
            line,
            scale,
            is_finest,
            before,
            whole,
            last,
            position: None,
            diameter: None,
        };
        self.vertices.push(vertex);
        if is_finest {
            let mut above = whole;
            while let Some(at) = above {
                self.vertices[at].last = Some(new);
                above = self.vertices[at].whole;
            }
        }
        new
    }

    fn measure(
        &mut self,
        vertex: usize,
        line: usize,
        cells: &[&str],
        columns: &Columns,
    ) -> Result<(), PlantFileError> {
        let number = |column: usize| match cells.get(column).copied().unwrap_or_default() {
            "" => Ok(None),
            cell => match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => Err(wrong(line, format!("{cell:?} is no number"))),
            },
        };
        let [x, y, z] = columns.position;
        if let (Some(x), Some(y), Some(z)) = (number(x)?, number(y)?, number(z)?) {
            self.vertices[vertex].position = Some([x, y, z]);
        }
        let diameter = number(columns.diameter)?;
        if let Some(negative) = diameter.filter(|diameter| *diameter < 0.0) {
            let what =
                format!("a diameter is 0, where it was not measured, or more, not {}", Brief(negative));
            return Err(wrong(line, what));
        }
        self.vertices[vertex].diameter = diameter;
        Ok(())
    }
}

/// The scale of every class, from the table after `CLASSES`.
fn scales<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<BTreeMap<String, u32>, PlantFileError> {
    let lacks =
        |what: &str| PlantFileError::Lacks(format!("a multiscale tree graph has {what}, this file has none"));
    lines.find(|(_, line)| line.starts_with("CLASSES")).ok_or_else(|| lacks("a table CLASSES"))?;
    lines.find(|(_, line)| line.starts_with("SYMBOL")).ok_or_else(|| lacks("a line SYMBOL SCALE"))?;
    let mut scales = BTreeMap::new();
    for (number, line) in lines {
        let mut cells = line.split('\t').map(str::trim);
        let (Some(class), Some(scale)) = (cells.next(), cells.next()) else { break };
        if scale.is_empty() {
            break;
        }
        let scale = scale.parse().map_err(|_none| wrong(number, format!("{scale:?} is no scale")))?;
        // `$`, the whole database, may be written or not.
        if class.chars().all(|c| c.is_ascii_alphabetic()) && !class.is_empty() {
            scales.insert(class.to_owned(), scale);
        }
    }
    if scales.is_empty() { Err(lacks("classes")) } else { Ok(scales) }
}

/// Columns of the features, from the line `ENTITY-CODE` after `MTG`.
fn columns<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<Columns, PlantFileError> {
    let mut lines = lines.skip_while(|(_, line)| !line.starts_with("MTG"));
    let header = lines.find(|(_, line)| line.starts_with("ENTITY-CODE"));
    let Some((_, header)) = header else {
        return Err(PlantFileError::Lacks(
            "a multiscale tree graph has a line ENTITY-CODE, this file has none".into(),
        ));
    };
    let names: Vec<&str> = header.split('\t').map(str::trim).collect();
    let place = |name: &str| {
        names.iter().position(|known| known.eq_ignore_ascii_case(name)).ok_or_else(|| {
            PlantFileError::Lacks(format!("the parts have no column {name}; there are: {}", names.join(" ")))
        })
    };
    let n_axes = 1 + names.iter().skip(1).take_while(|name| name.is_empty()).count();
    let position = [place("XX")?, place("YY")?, place("ZZ")?];
    Ok(Columns { n_axes, position, diameter: place("TopDia")? })
}
