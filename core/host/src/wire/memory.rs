//! Memory that the host and a plugin's process share: one that only the host writes, one that the process writes.
#![allow(unsafe_code, reason = "another process writes and reads the same bytes")]

use crate::reply::Element;
use memmap2::{Mmap, MmapOptions, MmapRaw};
use rustix::fs::{MemfdFlags, SealFlags, fcntl_add_seals, ftruncate, memfd_create};
use rustix::mm::{MprotectFlags, mprotect};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs::File;
use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

/// Everything begins at a multiple of so many bytes.
const ALIGN: usize = 64;
/// Room for what goes to the plugin. Pages take memory only when they are written.
const INPUT_BYTES: usize = 1 << 32;
/// Room for what comes back, until more is needed.
const OUTPUT_BYTES: usize = 1 << 20;
/// No answer takes more.
const OUTPUT_BYTES_MAX: usize = 1 << 34;
/// After a picture comes so much that nobody may read: a multiple of every system's page.
const GUARD_BYTES: usize = 1 << 16;
/// Of the output, before any column: cancel, heartbeat, progress.
const PAGE_BYTES: usize = 4096;

/// The elements as they lie in memory.
pub(crate) fn bytes_of<T: Element>(elements: &[T]) -> &[u8] {
    // SAFETY: elements are numbers without padding.
    unsafe { std::slice::from_raw_parts(elements.as_ptr().cast(), size_of_val(elements)) }
}

/// What the host writes for one request after the other.
pub(crate) struct Outbox {
    file: OwnedFd,
    map: MmapRaw,
    used: usize,
}

impl Outbox {
    /// Nobody can make it smaller, and nobody else can write it.
    pub(crate) fn new() -> io::Result<Self> {
        let file = memfd_create(c"honami-in", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING)?;
        ftruncate(&file, INPUT_BYTES as u64)?;
        let map = MmapOptions::new().len(INPUT_BYTES).map_raw(&file)?;
        fcntl_add_seals(
            &file,
            SealFlags::SHRINK | SealFlags::GROW | SealFlags::FUTURE_WRITE | SealFlags::SEAL,
        )?;
        Ok(Self { file, map, used: 0 })
    }

    /// Begins the next request over what the last one left.
    pub(crate) fn clear(&mut self) {
        self.used = 0;
    }

    /// Room for so many bytes, and where it is; `None` when there is no more.
    fn room(&mut self, n: usize) -> Option<(*mut u8, u64)> {
        let at = self.used;
        let end = at.checked_add(n)?.checked_next_multiple_of(ALIGN)?;
        (end <= self.map.len()).then(|| {
            self.used = end;
            // SAFETY: within the mapping.
            (unsafe { self.map.as_mut_ptr().add(at) }, at as u64)
        })
    }

    /// Lays down rows of bytes one after the other; where the first begins.
    pub(crate) fn put<'a>(&mut self, n: usize, rows: impl Iterator<Item = &'a [u8]>) -> Option<u64> {
        let room = self.room(n)?;
        self.fill(room, n, rows)
    }

    /// Lays down rows of a picture, as near as can be before a guard.
    pub(crate) fn put_picture<'a>(&mut self, n: usize, rows: impl Iterator<Item = &'a [u8]>) -> Option<u64> {
        let end = self.used.checked_add(n)?.checked_next_multiple_of(GUARD_BYTES)?;
        self.used = (end - n) / ALIGN * ALIGN;
        let room = self.room(end + GUARD_BYTES - self.used)?;
        self.fill(room, n, rows)
    }

    fn fill<'a>(
        &mut self,
        (mut to, at): (*mut u8, u64),
        n: usize,
        rows: impl Iterator<Item = &'a [u8]>,
    ) -> Option<u64> {
        let mut left = n;
        for row in rows {
            left = left.checked_sub(row.len())?;
            // SAFETY: the callers have made room for `n` bytes, of which so many are left; the plugin's process cannot write here.
            unsafe {
                std::ptr::copy_nonoverlapping(row.as_ptr(), to, row.len());
                to = to.add(row.len());
            }
        }
        Some(at)
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }
}

/// What the plugin's process reads of it.
pub(crate) struct Inbox {
    map: Mmap,
    /// Where guards begin that nobody can read now.
    guards: RefCell<BTreeSet<usize>>,
}

impl Inbox {
    pub(crate) fn of(file: &OwnedFd) -> io::Result<Self> {
        // SAFETY: sealed by the host, which writes only between requests.
        let map = unsafe { MmapOptions::new().map(file) }?;
        Ok(Self { map, guards: RefCell::default() })
    }

    /// So many elements from a place on.
    pub(crate) fn elements<T: Element>(&self, at: u64, n: usize) -> Option<&[T]> {
        let at = usize::try_from(at).ok().filter(|at| at.is_multiple_of(ALIGN))?;
        let bytes = self.map.get(at..at.checked_add(n.checked_mul(size_of::<T>())?)?)?;
        let mut guards = self.guards.borrow_mut();
        // Of a request before this one, where other things lie now.
        let before = guards.range((at + 1).saturating_sub(GUARD_BYTES)..at + bytes.len());
        for guard in before.copied().collect::<Vec<_>>() {
            self.protect(guard, MprotectFlags::READ)?;
            guards.remove(&guard);
        }
        // SAFETY: so many bytes are there, aligned for every number; every bit pattern is one.
        Some(unsafe { std::slice::from_raw_parts(bytes.as_ptr().cast(), n) })
    }

    /// The bytes of a picture; who reads on after them dies of it, but for the few that fill up the last multiple of
    /// [`ALIGN`].
    pub(crate) fn picture(&self, at: u64, n: usize) -> Option<&[u8]> {
        let bytes: &[u8] = self.elements(at, n)?;
        let guard = usize::try_from(at).ok()?.checked_add(n)?.checked_next_multiple_of(GUARD_BYTES)?;
        if guard + GUARD_BYTES <= self.map.len() && self.guards.borrow_mut().insert(guard) {
            self.protect(guard, MprotectFlags::empty())?;
        }
        Some(bytes)
    }

    /// Says who may read a guard.
    fn protect(&self, guard: usize, flags: MprotectFlags) -> Option<()> {
        // SAFETY: within the mapping; nothing of this request lies there.
        unsafe { mprotect(self.map.as_ptr().add(guard).cast_mut().cast(), GUARD_BYTES, flags) }.ok()
    }
}

/// What the plugin's process writes, seen from either side.
pub(crate) struct Output {
    file: File,
    map: MmapRaw,
    used: usize,
}

impl Output {
    /// A new one; it can grow, but nobody can make it smaller: reading it never faults.
    pub(crate) fn new() -> io::Result<Self> {
        let file = memfd_create(c"honami-out", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING)?;
        ftruncate(&file, OUTPUT_BYTES as u64)?;
        fcntl_add_seals(&file, SealFlags::SHRINK | SealFlags::SEAL)?;
        Self::of(file)
    }

    pub(crate) fn of(file: OwnedFd) -> io::Result<Self> {
        let file = File::from(file);
        let map = MmapOptions::new().map_raw(&file)?;
        if map.len() < PAGE_BYTES {
            return Err(io::Error::other("the memory for answers is too small"));
        }
        Ok(Self { file, map, used: PAGE_BYTES })
    }

    pub(crate) fn fd(&self) -> BorrowedFd<'_> {
        self.file.as_fd()
    }

    fn word<T>(&self, at: usize) -> &T {
        assert!(at + size_of::<T>() <= PAGE_BYTES && at.is_multiple_of(size_of::<T>()), "word {at}");
        // SAFETY: within the first page, aligned; `T` is an atomic, which two processes may share.
        unsafe { &*self.map.as_ptr().add(at).cast::<T>() }
    }

    /// Whether the plugin is to stop; set by the host, cleared by it before every request.
    pub(crate) fn cancel(&self) -> &AtomicU32 {
        self.word(0)
    }

    /// Counts the plugin's signs of life.
    pub(crate) fn heartbeat(&self) -> &AtomicU64 {
        self.word(8)
    }

    /// How far the plugin is, the bits of an f64.
    fn fraction_bits(&self) -> &AtomicU64 {
        self.word(16)
    }

    pub(crate) fn fraction(&self) -> f64 {
        f64::from_bits(self.fraction_bits().load(Relaxed))
    }

    /// A sign of life.
    pub(crate) fn beat(&self, fraction: f64) {
        self.fraction_bits().store(fraction.to_bits(), Relaxed);
        self.heartbeat().fetch_add(1, Relaxed);
    }

    /// Begins the next answer over what the last one left.
    pub(crate) fn clear(&mut self) {
        self.used = PAGE_BYTES;
    }

    /// The process' side: lays down a column; where it begins. The memory grows when it must.
    pub(crate) fn put(&mut self, bytes: &[u8]) -> io::Result<u64> {
        let at = self.used;
        let end = (at + bytes.len()).next_multiple_of(ALIGN);
        if end > self.map.len() {
            ftruncate(&self.file, end.next_power_of_two() as u64)?;
            self.map = MmapOptions::new().map_raw(&self.file)?;
        }
        // SAFETY: within the mapping; the host reads only after the answer.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.map.as_mut_ptr().add(at), bytes.len()) };
        self.used = end;
        Ok(at as u64)
    }

    /// The host's side: whether so many bytes lie there, after the words.
    pub(crate) fn holds(&mut self, at: u64, n: usize) -> bool {
        let within = |len: usize| {
            let at = usize::try_from(at).ok().filter(|at| *at >= PAGE_BYTES);
            at.and_then(|at| at.checked_add(n)).is_some_and(|end| end <= len)
        };
        // The process may have made it larger.
        if !within(self.map.len())
            && within(OUTPUT_BYTES_MAX)
            && let Ok(map) = MmapOptions::new().map_raw(&self.file)
        {
            self.map = map;
        }
        within(self.map.len())
    }

    /// Copies bytes out that it holds, to where there is room for them. What the process writes meanwhile may be in the
    /// copy; the copy is what is checked.
    pub(crate) fn copy(&mut self, at: u64, to: *mut u8, n: usize) {
        assert!(self.holds(at, n), "{n} bytes from {at}");
        // SAFETY: within the mapping, which nobody can make smaller; `to` has room for `n` bytes by the caller's promise.
        unsafe { std::ptr::copy_nonoverlapping(self.map.as_ptr().add(at as usize), to, n) }
    }
}
