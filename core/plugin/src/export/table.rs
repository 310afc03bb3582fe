//! Tables across the border: columns of the host's read as slices, results written into columns of the host's.

use super::HostCall;
use crate::{Error, Result};
use honami_abi::{self as abi, Column, Table, code, dtype};
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::copy_nonoverlapping;

/// A Rust type that can be an element of a column.
pub(crate) trait Element: Copy {
    const DTYPE: u32;
}

macro_rules! elements {
    ($($ty:ty = $dtype:ident),*) => { $( impl Element for $ty { const DTYPE: u32 = dtype::$dtype; } )* };
}
elements!(u8 = U8, i32 = I32, u32 = U32, i64 = I64, u64 = U64, f32 = F32, f64 = F64);

fn misuse(text: impl Into<String>) -> Error {
    Error::with_code(code::ARGUMENT, text)
}

/// # Safety
/// `data` is null, or `n` elements from it live for `'a`.
pub(crate) unsafe fn slice<'a, T>(data: *const T, n: u64) -> Result<&'a [T]> {
    let n = usize::try_from(n)?;
    match (data.is_null(), n) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(misuse("the host passed a null pointer")),
        // SAFETY: the caller's promise.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(data, n) }),
    }
}

/// A struct that the host passes in.
///
/// # Safety
/// It begins with `struct_size: u32`, has no padding, and zeros are a value of every field.
pub(crate) unsafe trait Given: Sized {
    /// Its size in ABI 1.0: what every host knows. Fields behind it are read behind `has!`.
    const SIZE_MIN: usize;
}

macro_rules! all_given {
    ($($ty:ty: $last:ident),* $(,)?) => { $(
        // SAFETY: asserted by the layout table of honami-abi; the fields are numbers, pointers and optional functions.
        unsafe impl Given for $ty { const SIZE_MIN: usize = abi::size_to!($ty, $last); }
    )* };
}
all_given!(
    // Its functions may all be missing; they are asked for one by one.
    abi::Call: host,
    abi::Table: rows,
    abi::Frame: time_s,
    abi::StreamInfo: birth_count,
    abi::DetectInput: seed,
    abi::FieldInput: to,
    abi::ClustererInput: times,
    abi::SimulatorInput: instances,
    abi::StepInput: detail,
    abi::StructureInput: mask_stride,
);

/// As much of a host's struct as the host knew; the fields after that are zero.
///
/// # Safety
/// `at` is null, or as many bytes as `struct_size`, its first field, says can be read there.
pub(crate) unsafe fn given<T: Given>(at: *const T) -> Result<T> {
    if at.is_null() {
        return Err(misuse("the host passed a null pointer"));
    }
    // SAFETY: not null, and every struct that grows is at least its size.
    let size = unsafe { at.cast::<u32>().read_unaligned() } as usize;
    if size < T::SIZE_MIN {
        return Err(misuse(format!("the host passed a struct of {size} bytes, wanted {}", T::SIZE_MIN)));
    }
    let size = size.min(size_of::<T>());
    let whole_fields = size - size % align_of::<T>();
    let mut known = MaybeUninit::<T>::zeroed();
    // SAFETY: the caller's promise, and not more than `known` holds; what is not copied is zero, which `Given` allows.
    unsafe {
        copy_nonoverlapping(at.cast::<u8>(), known.as_mut_ptr().cast::<u8>(), whole_fields);
        Ok(known.assume_init())
    }
}

/// All elements of a column, however many rows it has.
///
/// # Safety
/// The table is one of the host's, and its columns live for `'a`.
pub(crate) unsafe fn column<'a, T: Element>(table: &Table, name: &CStr, ncomp: u32) -> Result<&'a [T]> {
    // SAFETY: the caller's promise; the header wants names to be strings and data to hold rows * ncomp elements.
    unsafe {
        let columns = slice(table.cols, u64::from(table.ncols))?;
        let column = columns
            .iter()
            .find(|column| !column.name.is_null() && CStr::from_ptr(column.name) == name)
            .filter(|column| column.dtype == T::DTYPE && column.ncomp == ncomp)
            .ok_or_else(|| misuse(format!("the host's table has no column {}", name.to_string_lossy())))?;
        slice(column.data.cast(), column.rows * u64::from(ncomp))
    }
}

/// Name, type and components of a column.
pub(crate) type ColumnSpec = (&'static CStr, u32, u32);

/// A result: columns reserved and being filled.
pub(crate) struct Reserved<'c> {
    call: &'c HostCall<'c>,
    schema: &'static CStr,
    rows: usize,
    columns: ColumnList,
}

/// No schema of today has more columns.
const MAX_COLUMNS: usize = 8;
type ColumnList = [Column; MAX_COLUMNS];

impl<'c> Reserved<'c> {
    pub(crate) fn new(
        call: &'c HostCall<'c>,
        schema: &'static CStr,
        rows: usize,
        specs: &[ColumnSpec],
    ) -> Result<Self> {
        let reserve = call.known.reserve.ok_or_else(|| misuse("the host has no reserve"))?;
        let none = Column { name: std::ptr::null(), dtype: 0, ncomp: 0, data: std::ptr::null_mut(), rows: 0 };
        let mut columns = [none; MAX_COLUMNS];
        for (column, &(name, dtype, ncomp)) in columns.iter_mut().zip(specs) {
            *column = Column { name: name.as_ptr(), dtype, ncomp, ..none };
        }
        let n = specs.len().min(MAX_COLUMNS) as u32;
        // SAFETY: the host's function with its own context and columns that outlive the call.
        let answer = unsafe { reserve(call.raw, schema.as_ptr(), rows as u64, n, columns.as_mut_ptr()) };
        if answer < 0 {
            let why = format!("the host refused {rows} rows of {}", schema.to_string_lossy());
            return Err(Error::with_code(answer, why));
        }
        Ok(Self { call, schema, rows, columns })
    }

    /// Fills column `k` from as many elements as it has.
    ///
    /// # Panics
    /// When the column is of another type: a fault of the SDK's.
    pub(crate) fn fill<T: Element>(&mut self, k: usize, elements: impl Iterator<Item = T>) {
        for (place, element) in self.elements(k).iter_mut().zip(elements) {
            *place = element;
        }
    }

    /// Column `k`, to write into.
    ///
    /// # Panics
    /// When the column is of another type: a fault of the SDK's.
    pub(crate) fn elements<T: Element>(&mut self, k: usize) -> &mut [T] {
        let column = &self.columns[k];
        assert_eq!(column.dtype, T::DTYPE, "column {k} of {}", self.schema.to_string_lossy());
        let n = self.rows * column.ncomp as usize;
        if n == 0 || column.data.is_null() {
            return &mut [];
        }
        // SAFETY: the host gave rows * ncomp elements of this type, aligned and ours until the call returns.
        unsafe { std::slice::from_raw_parts_mut(column.data.cast::<T>(), n) }
    }

    /// Fills column `k`, of bytes, from pieces that come one after the other.
    ///
    /// # Panics
    /// When the column is of another type: a fault of the SDK's.
    pub(crate) fn fill_bytes(&mut self, k: usize, pieces: &[&[u8]]) {
        let mut left = self.elements::<u8>(k);
        for piece in pieces {
            let (place, rest) = left.split_at_mut(piece.len().min(left.len()));
            place.copy_from_slice(&piece[..place.len()]);
            left = rest;
        }
    }

    pub(crate) fn commit(self) -> Result<()> {
        let commit = self.call.known.commit.ok_or_else(|| misuse("the host has no commit"))?;
        // SAFETY: as in `new`.
        let answer = unsafe { commit(self.call.raw, self.schema.as_ptr(), self.rows as u64) };
        if answer < 0 {
            let why = format!("the host refused {}", self.schema.to_string_lossy());
            return Err(Error::with_code(answer, why));
        }
        Ok(())
    }
}
