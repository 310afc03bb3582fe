//! What a call has brought: copied out of the process' memory, then checked.
#![allow(unsafe_code, reason = "results are copied to where the reply has made room")]

use super::Isolated;
use crate::plain::plain;
use crate::reply::{Reply, Schema};
use crate::wire::{Answer, Columns};
use honami_abi::dtype;

/// No answer of a process takes more: it may name any number of rows, and each costs memory here.
const ANSWER_BYTES_MAX: usize = 1 << 30;

impl Isolated {
    /// Copies committed tables into the reply.
    pub(super) fn take(&mut self, answer: Answer, schemas: &'static [&'static Schema], reply: &mut Reply) {
        let Answer { code, text, faults, tables } = answer;
        (reply.code, reply.text) = (code, plain(&text));
        reply.faults.extend(faults.iter().map(|fault| plain(fault)));
        for (id, columns) in &tables {
            let schema = schemas.iter().find(|schema| schema.id.to_bytes() == id.as_bytes());
            let taken = match schema {
                Some(schema) => self.copy(schema, columns, reply),
                None => Err(format!("answered with {id:?}, which is no result of this function")),
            };
            if let Err(fault) = taken {
                reply.faults.push(fault);
            }
        }
    }

    fn copy(&mut self, schema: &'static Schema, columns: &Columns, reply: &mut Reply) -> Result<(), String> {
        let id = schema.id.to_string_lossy();
        let known = schema.required.iter().chain(schema.optional);
        let known: Vec<_> = known.filter_map(|column| Some((column, *columns.at.get(column.0)?))).collect();
        if let Some(missing) = schema.required.iter().find(|column| !columns.at.contains_key(column.0)) {
            return Err(format!("answered with {id} without column {:?}", missing.0));
        }
        let rows = usize::try_from(columns.rows)
            .map_err(|_too_many| format!("answered with {} rows", columns.rows))?;
        let row_bytes =
            |column: &crate::reply::ColumnType| dtype::size(column.1).unwrap_or(0) * column.2 as usize;
        let bytes_a_row: usize = known.iter().map(|(column, _)| row_bytes(column)).sum();
        if rows.checked_mul(bytes_a_row).is_none_or(|bytes| bytes > ANSWER_BYTES_MAX) {
            return Err(format!("answered with {rows} rows of {id}, more than 1 GiB"));
        }
        // Before room is made for what is not there.
        for (column, at) in &known {
            let n_bytes = rows * row_bytes(column);
            if !self.output.holds(*at, n_bytes) {
                return Err(format!("answered with column {:?} of {id} outside its memory", column.0));
            }
        }
        let types = known.iter().map(|(column, _)| (Some(*column), row_bytes(column)));
        let table = reply.slot(schema);
        let starts =
            table.reserve(rows, types).ok_or_else(|| format!("answered with {rows} rows of {id}"))?;
        for ((column, at), start) in known.iter().zip(starts) {
            self.output.copy(*at, start.cast(), rows * row_bytes(column));
        }
        table.commit(columns.rows)
    }
}
