//! What the linker has written into a library, read without running it.

use crate::Fault;
use object::Endianness;
use object::elf::{self, FileHeader64};
use object::read::elf::{Dyn as _, FileHeader as _, ProgramHeader as _, Sym as _};
use std::fs;
use std::path::Path;

/// Names that linkers give of themselves.
const LINKERS: [&str; 6] = ["", "_init", "_fini", "__bss_start", "_edata", "_end"];

/// What there is to judge.
#[derive(Debug)]
pub(super) struct Elf {
    /// Names that other libraries see and that clash when two define them; those of templates (weak) do not.
    pub(super) exports: Vec<String>,
    /// Libraries by name.
    pub(super) needed: Vec<String>,
    /// Folders in which these are looked for first, RPATH or RUNPATH.
    pub(super) runpath: Vec<String>,
    pub(super) has_text_relocations: bool,
    pub(super) wants_executable_stack: bool,
}

impl Elf {
    pub(super) fn read(path: &Path) -> Result<Self, Fault> {
        let bytes = fs::read(path).map_err(|error| Fault(format!("it cannot be read: {error}")))?;
        Self::parse(&bytes).map_err(|error| Fault(format!("it is no whole ELF file: {error}")))
    }

    fn parse(bytes: &[u8]) -> object::Result<Self> {
        let header = FileHeader64::<Endianness>::parse(bytes)?;
        let endian = header.endian()?;
        let sections = header.sections(endian, bytes)?;
        let symbols = sections.symbols(endian, bytes, elf::SHT_DYNSYM)?;
        let text = |name: &[u8]| String::from_utf8_lossy(name).into_owned();
        let exports = symbols.iter().filter(|symbol| symbol.st_shndx(endian) != elf::SHN_UNDEF);
        let exports = exports.filter(|symbol| symbol.st_bind() == elf::STB_GLOBAL);
        let exports = exports.filter_map(|symbol| symbol.name(endian, symbols.strings()).ok());
        let exports = exports.map(text).filter(|name| !LINKERS.contains(&name.as_str())).collect();
        let stack =
            header.program_headers(endian, bytes)?.iter().find(|s| s.p_type(endian) == elf::PT_GNU_STACK);
        let mut found = Self {
            exports,
            needed: Vec::new(),
            runpath: Vec::new(),
            has_text_relocations: false,
            // One that says nothing gets one that can be executed, as in old times.
            wants_executable_stack: stack.is_none_or(|s| s.p_flags(endian).0 & elf::PF_X.0 != 0),
        };
        let Some((dynamic, link)) = sections.dynamic(endian, bytes)? else { return Ok(found) };
        let strings = sections.strings(endian, bytes, link)?;
        for entry in dynamic {
            let tag = entry.tag(endian);
            if tag == elf::DT_NEEDED {
                found.needed.push(text(entry.string(endian, strings)?));
            } else if tag == elf::DT_RUNPATH || tag == elf::DT_RPATH {
                found.runpath = text(entry.string(endian, strings)?).split(':').map(str::to_owned).collect();
            } else if tag == elf::DT_TEXTREL {
                found.has_text_relocations = true;
            } else if tag == elf::DT_FLAGS {
                found.has_text_relocations |= entry.val(endian) & elf::DF_TEXTREL.0 != 0;
            }
        }
        Ok(found)
    }
}
