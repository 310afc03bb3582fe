//! The host's structs as hosts of other times would make them.

use super::Sized32;
use crate::Fault;
use crate::guarded::{Edge, Guarded};
use std::marker::PhantomData;

/// Which host this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dress {
    /// As the header is now.
    Today,
    /// Of ABI 1.0: nothing after the fields that it knew can be read.
    Older,
    /// Of a later minor: with fields that nobody knows yet.
    Newer,
    /// As the header is now, with this in the fields that are reserved.
    Reserved(u32),
}

/// What a newer host's structs have more, in bytes.
const MORE: usize = 64;
const UNKNOWN: u8 = 0xa5;

/// A struct of the host's as a plugin sees it: who writes to it, or reads past its end, dies of it.
pub(crate) struct Placed<T> {
    bytes: Guarded,
    what: PhantomData<T>,
}

impl<T: Sized32> Placed<T> {
    pub(crate) fn new(value: &T, dress: Dress) -> Result<Self, Fault> {
        let all = std::ptr::from_ref(value).cast::<u8>();
        // SAFETY: all of its bytes are of fields: it has no padding.
        let mut given = unsafe { std::slice::from_raw_parts(all, size_of::<T>()) }.to_vec();
        match dress {
            Dress::Older => given.truncate(T::OLD_BYTES),
            Dress::Newer => given.resize(size_of::<T>() + MORE, UNKNOWN),
            Dress::Today | Dress::Reserved(_) => {}
        }
        let size = given.len() as u32;
        given[..4].copy_from_slice(&size.to_ne_bytes());
        if let (Dress::Reserved(number), Some(at)) = (dress, T::RESERVED_AT) {
            given[at..at + 4].copy_from_slice(&number.to_ne_bytes());
        }
        let bytes = Guarded::new(&given, Edge::Back)
            .map_err(|error| Fault(format!("no memory with a guard page can be had: {error}")))?;
        Ok(Self { bytes, what: PhantomData })
    }

    pub(crate) fn raw(&self) -> *const T {
        self.bytes.bytes().as_ptr().cast()
    }
}
