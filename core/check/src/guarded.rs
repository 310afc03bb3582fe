//! Bytes between pages that nobody may touch, on pages that nobody may write: who reads past them dies of it.
#![allow(unsafe_code, reason = "protection of memory is a matter of system calls")]

use rustix::mm::{MapFlags, MprotectFlags, ProtFlags, mmap_anonymous, mprotect, munmap};
use std::ffi::c_void;
use std::io;
use std::ptr::{NonNull, null_mut};

/// Which end of the bytes lies at an unreadable page; at the other end there is one within a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Edge {
    /// A read before the first byte faults.
    Front,
    /// A read after the last byte faults.
    Back,
}

/// Bytes that cannot be written, with an unreadable page before and after.
#[derive(Debug)]
pub(crate) struct Guarded {
    pages: NonNull<c_void>,
    mapped: usize,
    start: usize,
    len: usize,
}

impl Guarded {
    /// Copies bytes to between two unreadable pages.
    ///
    /// # Errors
    /// When the system gives no memory, or does not protect it.
    pub(crate) fn new(bytes: &[u8], edge: Edge) -> io::Result<Self> {
        let page = rustix::param::page_size();
        let inner = bytes.len().next_multiple_of(page);
        let mapped = inner + 2 * page;
        let start = page + if edge == Edge::Back { inner - bytes.len() } else { 0 };
        // SAFETY: a new mapping, at a place of the system's choosing, overlaps nothing.
        let pages = unsafe {
            mmap_anonymous(null_mut(), mapped, ProtFlags::READ | ProtFlags::WRITE, MapFlags::PRIVATE)
        }?;
        let pages = NonNull::new(pages).ok_or(io::ErrorKind::OutOfMemory)?;
        let guarded = Self { pages, mapped, start, len: bytes.len() };
        // SAFETY: `start + len` and the three ranges lie within the mapping, which nobody else knows yet.
        unsafe {
            let first = pages.cast::<u8>();
            first.add(start).as_ptr().copy_from_nonoverlapping(bytes.as_ptr(), bytes.len());
            mprotect(pages.as_ptr(), page, MprotectFlags::empty())?;
            mprotect(first.add(page).cast().as_ptr(), inner, MprotectFlags::READ)?;
            mprotect(first.add(page + inner).cast().as_ptr(), page, MprotectFlags::empty())?;
        }
        Ok(guarded)
    }

    /// The bytes.
    pub(crate) fn bytes(&self) -> &[u8] {
        // SAFETY: `new` has filled this range, which stays readable and unchanged until the mapping goes with `self`.
        unsafe { std::slice::from_raw_parts(self.pages.cast::<u8>().add(self.start).as_ptr(), self.len) }
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // SAFETY: the mapping of `new`; borrows of its bytes have ended. What fails to be given back stays.
        unsafe { munmap(self.pages.as_ptr(), self.mapped) }.unwrap_or_default();
    }
}

#[cfg(test)]
mod tests;
