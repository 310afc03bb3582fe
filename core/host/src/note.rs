//! Reads a library's manifest from its ELF note, without running any of its code.

use crate::error::HostError;
use crate::manifest::Manifest;
use crate::regular::{self, LIBRARY_BYTES_MAX, MANIFEST_BYTES_MAX};
use crate::script;
use object::elf::{self, FileHeader64};
use object::read::ReadRef;
use object::read::elf::{Dyn, FileHeader, ProgramHeader, Sym};
use object::{Endianness, ReadCache};
use std::path::Path;

/// The manifest of a library, and its bytes as they stand in the note; `None` for a library that carries none.
///
/// # Errors
/// When the file cannot be read, is for another machine or another ABI, or its manifest is broken.
pub(crate) fn read(path: &Path) -> Result<Option<(Manifest, Vec<u8>)>, HostError> {
    let file_error = |why: String| HostError::File { path: path.to_owned(), why };
    let file =
        regular::open(path, LIBRARY_BYTES_MAX).map_err(|e| file_error(format!("cannot be read: {e}")))?;
    let data = ReadCache::new(file);
    let Some(json) = note(&data).map_err(file_error)? else { return Ok(None) };
    let manifest = Manifest::parse(&json).map_err(file_error)?;
    Ok(Some((manifest, json)))
}

/// The bytes of the note.
fn note<'d, R: ReadRef<'d>>(data: R) -> Result<Option<Vec<u8>>, String> {
    let broken = |e: object::Error| format!("is no whole ELF file: {e}");
    let header =
        FileHeader64::<Endianness>::parse(data).map_err(|_ignored| "is no 64-bit ELF library".to_owned())?;
    let endian = header.endian().map_err(broken)?;
    let machine = header.e_machine(endian);
    if Some(machine) != this_machine() {
        return Err(format!("is built for another machine (ELF machine {})", machine.0));
    }
    let mut found = None;
    for segment in header.program_headers(endian, data).map_err(broken)? {
        let Some(mut notes) = segment.notes(endian, data).map_err(broken)? else { continue };
        while let Some(note) = notes.next().map_err(broken)? {
            if note.name() == honami_abi::NOTE_NAME.to_bytes() && note.n_type(endian) == elf::NoteType(1) {
                found = Some(note.desc());
            }
        }
    }
    let Some(json) = found else { return Ok(None) };
    let json = json.strip_suffix(&[0]).unwrap_or(json);
    if json.len() as u64 > MANIFEST_BYTES_MAX {
        return Err(format!("its manifest has {} bytes, more than anybody can mean", json.len()));
    }
    exports(header, endian, data)?;
    Ok(Some(json.to_vec()))
}

/// Checks that the one symbol of our major version is there.
fn exports<'d, R: ReadRef<'d>>(
    header: &FileHeader64<Endianness>,
    endian: Endianness,
    data: R,
) -> Result<(), String> {
    let broken = |e: object::Error| format!("is no whole ELF file: {e}");
    let sections = header.sections(endian, data).map_err(broken)?;
    let symbols = sections.symbols(endian, data, elf::SHT_DYNSYM).map_err(broken)?;
    let names = symbols
        .iter()
        .filter(|symbol| symbol.st_shndx(endian) != elf::SHN_UNDEF)
        .filter_map(|symbol| symbol.name(endian, symbols.strings()).ok());
    let versions: Vec<String> = names
        .filter_map(|name| {
            std::str::from_utf8(name).ok()?.strip_prefix("honami_library_v").map(str::to_owned)
        })
        .collect();
    match versions.as_slice() {
        [] => Err("carries a manifest but does not export honami_library_v1".into()),
        all if all.iter().any(|v| *v == honami_abi::ABI_MAJOR.to_string()) => Ok(()),
        [other, ..] => {
            Err(format!("is built for ABI {other}, this honami knows ABI {}", honami_abi::ABI_MAJOR))
        }
    }
}

/// The libraries that a library needs, as the linker has noted them; none of a program.
///
/// # Errors
/// When the file cannot be read or is no whole library.
pub fn needed(path: &Path) -> Result<Vec<String>, HostError> {
    if script::is_manifest(path) {
        return Ok(Vec::new());
    }
    let file_error = |why: String| HostError::File { path: path.to_owned(), why };
    let broken = |e: object::Error| file_error(format!("is no whole ELF file: {e}"));
    let file =
        regular::open(path, LIBRARY_BYTES_MAX).map_err(|e| file_error(format!("cannot be read: {e}")))?;
    let data = ReadCache::new(file);
    let header = FileHeader64::<Endianness>::parse(&data).map_err(broken)?;
    let endian = header.endian().map_err(broken)?;
    let sections = header.sections(endian, &data).map_err(broken)?;
    let Some((dynamic, link)) = sections.dynamic(endian, &data).map_err(broken)? else {
        return Ok(Vec::new());
    };
    let strings = sections.strings(endian, &data, link).map_err(broken)?;
    let needed = dynamic.iter().filter(|entry| entry.tag(endian) == elf::DT_NEEDED);
    let names = needed.filter_map(|entry| entry.string(endian, strings).ok());
    Ok(names.map(|name| String::from_utf8_lossy(name).into_owned()).collect())
}

fn this_machine() -> Option<elf::Machine> {
    match std::env::consts::ARCH {
        "x86_64" => Some(elf::EM_X86_64),
        "aarch64" => Some(elf::EM_AARCH64),
        "riscv64" => Some(elf::EM_RISCV),
        _ => None,
    }
}
