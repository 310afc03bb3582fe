//! Reading: a batch of every column at a time, whatever the size of a group.

use std::sync::Once;

use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use honami_model::track::{Quality, Sample, Source, Status, TrackId};

use crate::foreign::{Flaw, ForeignTracks, Table};
use crate::rows::{TrackRow, source_from, status_from};

/// Rows decoded at once.
const BATCH: usize = 1 << 15;

/// What a cell holds.
#[derive(Clone, Debug)]
enum Cell {
    Int(i64),
    Float(f64),
    Text(String),
}

/// An open column.
struct Column {
    reader: ColumnReader,
    optional: bool,
    unsigned: bool,
}

/// Reads a table of tracks.
pub(crate) fn parse<R: ChunkReader + 'static>(reader: R) -> Result<ForeignTracks, Flaw> {
    // The library panics on some damaged files: nothing of it outlives the call, and a file is not to end a program.
    let read = quietly(|| std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| groups(reader))));
    read.unwrap_or_else(|_| Err(Flaw::wrong("file", "a Parquet table of tracks", "a damaged one")))
}

thread_local! {
    /// Whether a panic of this thread is caught and told in other words.
    static IS_CAUGHT: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Works without a report of panics: `work` catches them.
fn quietly<T>(work: impl FnOnce() -> T) -> T {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !IS_CAUGHT.get() {
                report(panic);
            }
        }));
    });
    IS_CAUGHT.set(true);
    let done = work();
    IS_CAUGHT.set(false);
    done
}

fn groups<R: ChunkReader + 'static>(reader: R) -> Result<ForeignTracks, Flaw> {
    let broken = |error: ParquetError| Flaw::wrong("file", "a Parquet table of tracks", &error.to_string());
    let reader = SerializedFileReader::new(reader).map_err(broken)?;
    let mut table = Table::default();
    let mut first_row = 0;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(broken)?;
        first_row = read_group(group.as_ref(), first_row, &mut table)?;
    }
    table.done()
}

/// The columns that are known, in the order in which [`row`] wants them; the first four must be there.
const KNOWN: [&str; 8] = ["track", "frame", "x", "y", "status", "source", "fb", "ncc"];

fn read_group(group: &dyn RowGroupReader, first_row: usize, table: &mut Table) -> Result<usize, Flaw> {
    let mut columns = Vec::new();
    for (place, name) in KNOWN.into_iter().enumerate() {
        let column = open(group, name)?;
        if column.is_none() && place < 4 {
            return Err(Flaw::wrong("columns", "track, frame, x and y", &format!("no {name}")));
        }
        columns.push(column);
    }
    let mut at = first_row;
    loop {
        let mut batches = Vec::with_capacity(columns.len());
        for column in &mut columns {
            batches.push(column.as_mut().map(Column::batch).transpose()?);
        }
        let n = batches.iter().flatten().map(Vec::len).max().unwrap_or(0);
        if n == 0 {
            return Ok(at);
        }
        if batches.iter().flatten().any(|batch| batch.len() != n) {
            return Err(Flaw::wrong(format!("row {at}"), "columns of one length", "shorter ones"));
        }
        for k in 0..n {
            let cell = |place: usize| batches[place].as_ref().and_then(|batch| batch[k].as_ref());
            table.put(&row(at + k, cell)?)?;
        }
        at += n;
    }
}

fn open(group: &dyn RowGroupReader, name: &str) -> Result<Option<Column>, Flaw> {
    let meta = group.metadata();
    let found = meta.columns().iter().position(|column| column.column_descr().path().string() == name);
    let Some(place) = found else { return Ok(None) };
    let column = meta.column(place);
    let places =
        [Some(column.data_page_offset()), column.dictionary_page_offset(), Some(column.compressed_size())];
    if places.into_iter().flatten().any(|place| place < 0) {
        return Err(Flaw::wrong(format!("column {name}"), "a place in the file", "a negative one"));
    }
    let descr = column.column_descr();
    if descr.max_rep_level() > 0 || descr.max_def_level() > 1 {
        return Err(Flaw::wrong(format!("column {name}"), "plain values", "lists"));
    }
    if matches!(descr.physical_type(), Type::BOOLEAN | Type::INT96 | Type::FIXED_LEN_BYTE_ARRAY) {
        return Err(Flaw::wrong(
            format!("column {name}"),
            "numbers or text",
            &descr.physical_type().to_string(),
        ));
    }
    let (optional, unsigned) = (descr.max_def_level() > 0, is_unsigned(descr));
    let broken = |error: ParquetError| Flaw::wrong(format!("column {name}"), "a column", &error.to_string());
    Ok(Some(Column { reader: group.get_column_reader(place).map_err(broken)?, optional, unsigned }))
}

fn is_unsigned(descr: &ColumnDescriptor) -> bool {
    use ConvertedType::{UINT_8, UINT_16, UINT_32, UINT_64};
    let logical = matches!(descr.logical_type_ref(), Some(LogicalType::Integer(int)) if !int.is_signed);
    logical || matches!(descr.converted_type(), UINT_8 | UINT_16 | UINT_32 | UINT_64)
}

impl Column {
    /// The next cells; none at the end.
    fn batch(&mut self) -> Result<Vec<Option<Cell>>, Flaw> {
        let (optional, unsigned) = (self.optional, self.unsigned);
        let int32 = |v: i32| Cell::Int(if unsigned { v.cast_unsigned().into() } else { v.into() });
        let text =
            |v: parquet::data_type::ByteArray| Cell::Text(String::from_utf8_lossy(v.data()).into_owned());
        match &mut self.reader {
            ColumnReader::Int32ColumnReader(reader) => cells(reader, optional, int32),
            ColumnReader::Int64ColumnReader(reader) => cells(reader, optional, Cell::Int),
            ColumnReader::FloatColumnReader(reader) => cells(reader, optional, |v| Cell::Float(v.into())),
            ColumnReader::DoubleColumnReader(reader) => cells(reader, optional, Cell::Float),
            ColumnReader::ByteArrayColumnReader(reader) => cells(reader, optional, text),
            _ => Ok(Vec::new()),
        }
    }
}

fn cells<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    optional: bool,
    cell: impl Fn(T::T) -> Cell,
) -> Result<Vec<Option<Cell>>, Flaw> {
    let (mut values, mut there) = (Vec::new(), Vec::new());
    let levels = optional.then_some(&mut there);
    let read = reader.read_records(BATCH, levels, None, &mut values);
    read.map_err(|error| Flaw::wrong("columns", "a readable page", &error.to_string()))?;
    if !optional {
        return Ok(values.into_iter().map(cell).map(Some).collect());
    }
    let mut values = values.into_iter();
    Ok(there.into_iter().map(|level| if level > 0 { values.next().map(&cell) } else { None }).collect())
}

/// A row from its cells, which are in the order of [`KNOWN`].
fn row<'a>(at: usize, cell: impl Fn(usize) -> Option<&'a Cell>) -> Result<TrackRow, Flaw> {
    let wrong = |place: usize, wanted: &str| {
        let came = match cell(place) {
            None => "nothing".to_owned(),
            Some(Cell::Int(v)) => v.to_string(),
            Some(Cell::Float(v)) => v.to_string(),
            Some(Cell::Text(v)) => v.clone(),
        };
        Flaw::wrong(format!("row {at}, column {}", KNOWN[place]), wanted, &came)
    };
    let whole = |place: usize| {
        let number = match cell(place) {
            Some(Cell::Int(v)) => u32::try_from(*v).ok(),
            _ => None,
        };
        number.ok_or_else(|| wrong(place, "a whole number of 0 or more"))
    };
    let finite = |place: usize| {
        let number = match cell(place) {
            None => return Ok(None),
            Some(Cell::Float(v)) => Some(*v as f32),
            Some(Cell::Int(v)) => Some(*v as f32),
            Some(Cell::Text(_)) => None,
        };
        number.filter(|v| v.is_finite()).map(Some).ok_or_else(|| wrong(place, "a finite number"))
    };
    let position = |place: usize| finite(place)?.ok_or_else(|| wrong(place, "a finite number"));
    let status = match cell(4) {
        None => Some(Status::Tracked),
        Some(Cell::Int(v)) => u8::try_from(*v).ok().and_then(Status::from_u8),
        Some(Cell::Text(word)) => status_from(word),
        Some(Cell::Float(_)) => None,
    };
    let source = match cell(5) {
        None => Some(Source::Imported),
        Some(Cell::Text(word)) => source_from(word),
        Some(_) => None,
    };
    let sample = Sample {
        x: position(2)?,
        y: position(3)?,
        status: status.ok_or_else(|| wrong(4, "0 to 5, or lost, tracked, …, newborn"))?,
        source: source.ok_or_else(|| wrong(5, "key, sketch, tracked, interpolated or imported"))?,
        quality: Quality { fb_px: finite(6)?, ncc: finite(7)? },
    };
    Ok(TrackRow { track: TrackId(whole(0)?), frame: whole(1)?, time_s: None, sample, run: None })
}
