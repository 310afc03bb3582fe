//! What came back from a call: a code, a text, and tables in memory of the host's.

use crate::isolated::Ended;
use honami_abi::{dtype, schema};
use std::ffi::CStr;

/// A result schema: the columns that the host reads. Others may come; they are ignored.
#[derive(Debug)]
pub(crate) struct Schema {
    pub(crate) id: &'static CStr,
    pub(crate) required: &'static [ColumnType],
    pub(crate) optional: &'static [ColumnType],
}

/// Name, element type, components.
pub(crate) type ColumnType = (&'static str, u32, u32);

pub(crate) const POINTS: Schema = Schema {
    id: schema::POINTS,
    required: &[("id", dtype::U32, 1), ("x", dtype::F32, 1), ("y", dtype::F32, 1), ("status", dtype::U8, 1)],
    optional: &[("fb", dtype::F32, 1), ("ncc", dtype::F32, 1), ("frame", dtype::I64, 1)],
};
pub(crate) const FEATURES: Schema = Schema {
    id: schema::FEATURES,
    required: &[("x", dtype::F32, 1), ("y", dtype::F32, 1), ("score", dtype::F32, 1)],
    optional: &[],
};
pub(crate) const VECTORS: Schema = Schema {
    id: schema::VECTORS,
    required: &[("u", dtype::F32, 1), ("v", dtype::F32, 1)],
    optional: &[("known", dtype::U8, 1)],
};
pub(crate) const GRID: Schema = Schema {
    id: schema::GRID,
    required: &[
        ("gx", dtype::F32, 1),
        ("gy", dtype::F32, 1),
        ("step", dtype::F32, 1),
        ("nx", dtype::U32, 1),
        ("ny", dtype::U32, 1),
    ],
    optional: &[],
};
pub(crate) const DENDROGRAM: Schema = Schema {
    id: schema::DENDROGRAM,
    required: &[
        ("a", dtype::U32, 1),
        ("b", dtype::U32, 1),
        ("height", dtype::F64, 1),
        ("size", dtype::U32, 1),
    ],
    optional: &[],
};
pub(crate) const FRAMES: Schema = Schema {
    id: schema::FRAMES,
    required: &[("frame", dtype::I64, 1), ("outlier", dtype::U8, 1), ("distance", dtype::F64, 1)],
    optional: &[],
};
pub(crate) const STATE: Schema =
    Schema { id: schema::STATE, required: &[("bytes", dtype::U8, 1)], optional: &[] };
pub(crate) const JOINTS: Schema = Schema {
    id: schema::JOINTS,
    required: &[("parent", dtype::I32, 1), ("length", dtype::F64, 1)],
    optional: &[],
};
pub(crate) const ROOT: Schema = Schema {
    id: schema::ROOT,
    required: &[("x", dtype::F64, 1), ("y", dtype::F64, 1), ("z", dtype::F64, 1)],
    optional: &[],
};
pub(crate) const POSE: Schema = Schema { id: schema::POSE, required: &[("d", dtype::F64, 3)], optional: &[] };
pub(crate) const BEARS: Schema = Schema {
    id: schema::BEARS,
    required: &[("joint", dtype::U32, 1), ("group", dtype::U32, 1)],
    optional: &[],
};
pub(crate) const LEAVES: Schema = Schema {
    id: schema::LEAVES,
    required: &[("joint", dtype::U32, 1), ("track", dtype::U32, 1)],
    optional: &[],
};
pub(crate) const OFFSETS: Schema =
    Schema { id: schema::OFFSETS, required: &[("d", dtype::F64, 3)], optional: &[] };
pub(crate) const MODES: Schema = Schema {
    id: schema::MODES,
    required: &[("hz", dtype::F64, 1), ("residual", dtype::F64, 1)],
    optional: &[("certified", dtype::U8, 1)],
};
pub(crate) const MOTION: Schema =
    Schema { id: schema::MOTION, required: &[("d", dtype::F32, 3)], optional: &[] };

impl Schema {
    /// Whether memory for it is given as the call before left it: it is written whole, and much of it.
    fn keeps(&self) -> bool {
        self.id == schema::MOTION
    }

    /// The type of a column that the host reads.
    pub(crate) fn column(&self, name: &str) -> Option<&'static ColumnType> {
        self.required.iter().chain(self.optional).find(|column| column.0 == name)
    }
}

/// What came back from a call. Nothing in it has been checked beyond types and sizes; used again for the next call.
#[derive(Debug, Default)]
pub(crate) struct Reply {
    /// What the function returned.
    pub(crate) code: i32,
    /// What the plugin said of a failure.
    pub(crate) text: String,
    /// How the plugin broke the contract; empty if it kept it.
    pub(crate) faults: Vec<String>,
    /// Whether the listener said stop.
    pub(crate) stopped: bool,
    /// How the plugin's process ended, if it did.
    pub(crate) ended: Option<Ended>,
    /// The last line that a process printed which has ended.
    pub(crate) last_words: String,
    tables: Vec<Table>,
}

impl Reply {
    pub(crate) fn clear(&mut self) {
        self.code = 0;
        self.text.clear();
        self.faults.clear();
        self.stopped = false;
        self.ended = None;
        for table in &mut self.tables {
            table.clear();
        }
    }

    /// The table that was committed for a schema.
    pub(crate) fn table(&self, schema: &Schema) -> Option<&Table> {
        self.tables.iter().find(|table| table.is(schema) && table.committed.is_some())
    }

    /// The tables that were committed.
    pub(crate) fn committed(&self) -> impl Iterator<Item = &Table> {
        self.tables.iter().filter(|table| table.committed.is_some())
    }

    /// The place of a schema's table, empty or not.
    pub(crate) fn slot(&mut self, schema: &'static Schema) -> &mut Table {
        let k = self.tables.iter().position(|table| table.is(schema)).unwrap_or_else(|| {
            self.tables.push(Table::new(schema));
            self.tables.len() - 1
        });
        &mut self.tables[k]
    }

    /// Notes the columns that were written past their end.
    pub(crate) fn check_ends(&mut self) {
        let Self { tables, faults, .. } = self;
        for table in tables {
            for column in table.columns.iter().filter(|column| table.overrun(column)) {
                faults.push(format!("wrote past the end of column {} of {}", column.name(), table.id()));
            }
        }
    }
}

/// 64 bytes, the unit of column memory.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Line(pub(crate) [u8; 64]);

/// After every column stands one such line; a plugin that writes past the end changes it.
const END: Line = Line([0xA5; 64]);

/// A table's memory and what is in it.
#[derive(Debug)]
pub(crate) struct Table {
    schema: &'static Schema,
    lines: Vec<Line>,
    columns: Vec<Column>,
    reserved: Option<usize>,
    committed: Option<usize>,
}

/// Where a column lies; one that the host does not read has no type.
#[derive(Debug)]
struct Column {
    known: Option<&'static ColumnType>,
    first_line: usize,
    n_lines: usize,
}

impl Column {
    fn name(&self) -> &'static str {
        self.known.map_or("(another)", |known| known.0)
    }
}

/// More is refused: no result of today's plugins comes near.
pub(crate) const TABLE_BYTES_MAX: usize = 1 << 34;

impl Table {
    fn new(schema: &'static Schema) -> Self {
        Self { schema, lines: Vec::new(), columns: Vec::new(), reserved: None, committed: None }
    }

    fn is(&self, schema: &Schema) -> bool {
        std::ptr::eq(self.schema.id, schema.id) || self.schema.id == schema.id
    }

    pub(crate) fn id(&self) -> String {
        self.schema.id.to_string_lossy().into_owned()
    }

    fn clear(&mut self) {
        self.columns.clear();
        (self.reserved, self.committed) = (None, None);
    }

    /// Makes room, zeroed unless the schema keeps it, for columns of known or unknown types, given with bytes a row;
    /// gives each column's start. `None` when it would be too much.
    pub(crate) fn reserve(
        &mut self,
        rows: usize,
        columns: impl Iterator<Item = (Option<&'static ColumnType>, usize)>,
    ) -> Option<Vec<*mut Line>> {
        self.clear();
        let mut n_lines = 0_usize;
        for (known, row_bytes) in columns {
            let bytes = rows.checked_mul(row_bytes).filter(|&bytes| bytes <= TABLE_BYTES_MAX)?;
            let column = Column { known, first_line: n_lines, n_lines: bytes.div_ceil(size_of::<Line>()) };
            n_lines = n_lines.checked_add(column.n_lines + 1)?;
            self.columns.push(column);
        }
        if n_lines > TABLE_BYTES_MAX / size_of::<Line>()
            || self.lines.try_reserve(n_lines.saturating_sub(self.lines.len())).is_err()
        {
            self.clear();
            return None;
        }
        if self.schema.keeps() {
            self.lines.truncate(n_lines);
        } else {
            self.lines.clear();
        }
        self.lines.resize(n_lines, Line([0; 64]));
        for column in &self.columns {
            self.lines[column.first_line + column.n_lines] = END;
        }
        self.reserved = Some(rows);
        let start = self.lines.as_mut_ptr();
        Some(self.columns.iter().map(|column| start.wrapping_add(column.first_line)).collect())
    }

    /// Takes the first `rows` rows as the result.
    pub(crate) fn commit(&mut self, rows: u64) -> Result<(), String> {
        let id = self.id();
        let Some(reserved) = self.reserved else {
            return Err(format!("committed {id} without reserving it"));
        };
        if self.committed.is_some() {
            return Err(format!("committed {id} twice"));
        }
        let rows = usize::try_from(rows).unwrap_or(usize::MAX);
        if rows > reserved {
            return Err(format!("committed {rows} rows of {id} after reserving {reserved}"));
        }
        self.committed = Some(rows);
        Ok(())
    }

    fn overrun(&self, column: &Column) -> bool {
        self.lines.get(column.first_line + column.n_lines).is_some_and(|line| line.0 != END.0)
    }

    /// Number of committed rows.
    pub(crate) fn rows(&self) -> usize {
        self.committed.unwrap_or(0)
    }

    /// The elements of a column's committed rows; `None` for an optional column that did not come.
    pub(crate) fn column<T: Element>(&self, name: &str) -> Option<&[T]> {
        let column = self.columns.iter().find(|column| column.known.is_some_and(|known| known.0 == name))?;
        let &(_, dtype, ncomp) = column.known?;
        assert_eq!(dtype, T::DTYPE, "type of column {name} of {}", self.id());
        let n = self.rows() * ncomp as usize;
        let lines = &self.lines[column.first_line..column.first_line + column.n_lines];
        assert!(n * size_of::<T>() <= size_of_val(lines), "rows of column {name} of {}", self.id());
        // SAFETY: lines are plain bytes, aligned to 64, at least n elements of them; every bit pattern is an element.
        #[allow(unsafe_code, reason = "bytes that the plugin wrote, read as what they are")]
        Some(unsafe { std::slice::from_raw_parts(lines.as_ptr().cast::<T>(), n) })
    }

    /// The columns that the host knows, each with the bytes of its committed rows.
    pub(crate) fn columns(&self) -> impl Iterator<Item = (&'static str, &[u8])> {
        self.columns.iter().filter_map(|column| {
            let &(name, dtype, ncomp) = column.known?;
            let n = self.rows() * dtype::size(dtype)? * ncomp as usize;
            let lines = &self.lines[column.first_line..column.first_line + column.n_lines];
            assert!(n <= size_of_val(lines), "rows of column {name} of {}", self.id());
            // SAFETY: lines are plain bytes, at least n of them.
            #[allow(unsafe_code, reason = "bytes that the plugin wrote, as they are")]
            Some((name, unsafe { std::slice::from_raw_parts(lines.as_ptr().cast::<u8>(), n) }))
        })
    }

    /// A column that the schema requires: `reserve` has seen to it that it is there.
    pub(crate) fn required<T: Element>(&self, name: &'static str) -> &[T] {
        self.column(name).unwrap_or_default()
    }
}

/// A Rust type that can be an element of a column: a number, of which every bit pattern is one.
pub(crate) trait Element: Copy + 'static {
    const DTYPE: u32;
}

macro_rules! elements {
    ($($ty:ty = $dtype:ident),*) => { $( impl Element for $ty { const DTYPE: u32 = dtype::$dtype; } )* };
}
elements!(u8 = U8, i32 = I32, u32 = U32, i64 = I64, u64 = U64, f32 = F32, f64 = F64);
