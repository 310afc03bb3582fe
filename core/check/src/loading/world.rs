//! What all of a process shares, and what a plugin must therefore leave as it is.
#![allow(unsafe_code, reason = "the locale and the buffers of C's streams have no other door")]

use crate::Fault;
use honami_host::plain;
use rustix::fs::{MemfdFlags, memfd_create};
use rustix::stdio::{dup2_stderr, dup2_stdout, stderr, stdout};
use std::ffi::CStr;
use std::fs::{self, File};
use std::io::{Read as _, Seek as _};
use std::path::Path;

/// The process at one moment.
#[derive(Debug)]
pub(super) struct World {
    pub(super) threads: usize,
    /// Each with its number and what it is.
    pub(super) files: Vec<String>,
    /// Which are blocked, ignored and caught.
    pub(super) signals: String,
    pub(super) locale: String,
    pub(super) floats: String,
    pub(super) folder: String,
    pub(super) environment: Vec<String>,
}

impl World {
    pub(super) fn now() -> Result<Self, Fault> {
        let lost = |error: std::io::Error| Fault(format!("/proc/self cannot be read: {error}"));
        let status = fs::read_to_string("/proc/self/status").map_err(lost)?;
        let signals =
            status.lines().filter(|line| ["SigBlk", "SigIgn", "SigCgt"].iter().any(|s| line.starts_with(s)));
        let signals: Vec<String> = signals.map(|line| line.replace('\t', " ")).collect();
        let mut environment: Vec<String> = std::env::vars_os()
            .map(|(name, value)| format!("{}={}", name.display(), value.display()))
            .collect();
        environment.sort();
        Ok(Self {
            threads: fs::read_dir("/proc/self/task").map_err(lost)?.count(),
            files: files().map_err(lost)?,
            signals: signals.join(", "),
            locale: locale(),
            floats: floats(),
            folder: std::env::current_dir().map_err(lost)?.display().to_string(),
            environment,
        })
    }
}

fn files() -> std::io::Result<Vec<String>> {
    let folder = Path::new("/proc/self/fd");
    let names: Vec<_> = fs::read_dir(folder)?.flatten().map(|entry| entry.file_name()).collect();
    // The folder itself was open meanwhile, and is not any more.
    let named = names.iter().filter_map(|name| {
        let what = fs::read_link(folder.join(name)).ok()?;
        Some(format!("{}: {}", name.display(), what.display()))
    });
    let mut files: Vec<String> = named.collect();
    files.sort();
    Ok(files)
}

fn locale() -> String {
    // SAFETY: a null pointer only asks; the string lives until the locale is set again, by nobody between here and there.
    let name = unsafe {
        let name = libc::setlocale(libc::LC_ALL, std::ptr::null());
        if name.is_null() { c"" } else { CStr::from_ptr(name) }
    };
    name.to_string_lossy().into_owned()
}

/// Rounding, denormal numbers and traps, without the flags of what has happened.
fn floats() -> String {
    #[cfg(target_arch = "x86_64")]
    let mode = {
        let mut mxcsr = 0_u32;
        // SAFETY: stores the register in the place that it is given.
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut mxcsr, options(nostack)) };
        let mut x87 = 0_u16;
        // SAFETY: as above, of the older unit.
        unsafe { std::arch::asm!("fnstcw [{}]", in(reg) &raw mut x87, options(nostack)) };
        u64::from(mxcsr & !0x3f) << 16 | u64::from(x87)
    };
    #[cfg(target_arch = "aarch64")]
    let mode = {
        let fpcr: u64;
        // SAFETY: reads a register.
        unsafe { std::arch::asm!("mrs {}, fpcr", out(reg) fpcr, options(nomem, nostack)) };
        fpcr
    };
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let mode = 0_u64;
    format!("{mode:#x}")
}

/// What comes of `run`, and what is printed meanwhile on standard output and standard error.
pub(super) fn listening<T>(run: impl FnOnce() -> Result<T, Fault>) -> Result<(T, String), Fault> {
    let lost = |error: std::io::Error| Fault(format!("what it prints cannot be caught: {error}"));
    let caught = memfd_create("prints", MemfdFlags::CLOEXEC).map_err(|error| lost(error.into()))?;
    let kept = [stdout(), stderr()].map(|file| rustix::io::fcntl_dupfd_cloexec(file, 3));
    let [Ok(kept_out), Ok(kept_err)] = kept else {
        return Err(Fault("standard output cannot be kept".into()));
    };
    dup2_stdout(&caught).and_then(|()| dup2_stderr(&caught)).map_err(|error| lost(error.into()))?;
    let ran = run();
    // SAFETY: of all streams of C's; what lies in their buffers was printed, too.
    unsafe { libc::fflush(std::ptr::null_mut()) };
    dup2_stdout(&kept_out).and_then(|()| dup2_stderr(&kept_err)).map_err(|error| lost(error.into()))?;
    let ran = ran?;
    let (mut file, mut bytes) = (File::from(caught), Vec::new());
    file.rewind().and_then(|()| file.take(1 << 12).read_to_end(&mut bytes)).map_err(lost)?;
    Ok((ran, plain(&String::from_utf8_lossy(&bytes))))
}
