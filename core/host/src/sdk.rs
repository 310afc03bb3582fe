//! What the author of a plugin begins with: a folder with one that works, under a name of their own, and the command
//! that makes it ready.

mod rust;
#[cfg(test)]
mod tests;
mod trax;

pub use trax::adapt;

use crate::manifest::Kind;

/// A file by its place in the folder, and what is in it.
pub type File = (String, String);

/// Languages that a plugin can be begun in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// One file, the standard library and numpy.
    Python,
    /// A package with the SDK beside it; it needs nothing from elsewhere.
    Rust,
    /// The header alone.
    C,
    /// The header and a class over it.
    Cpp,
}

/// A plugin that was just begun.
#[derive(Clone, Debug)]
pub struct Begun {
    /// What lies in its folder, the file to change first.
    pub files: Vec<File>,
    /// The command that makes it ready, in the folder that holds its own.
    pub build: String,
    /// What is then to be named to honami, from there.
    pub plugin: String,
}

/// What plugins in Python import.
pub(crate) const HONAMI_PY: &str = include_str!("../../plugin/python/honami.py");

/// The ids in the templates.
const ID: [&str; 3] = ["org.honami.template", "org.honami.linkage", "org.honami.fan"];

/// What a file of that name would stand in the way of: numpy and Python's standard library (`sys.stdlib_module_names`,
/// also of older and newer versions), any of which the SDK or what it imports may import.
const PYTHON_MODULES: &str = "\
    abc aifc annotationlib antigravity argparse array ast asynchat asyncio asyncore atexit audioop \
    base64 bdb binascii binhex bisect builtins bz2 calendar cgi cgitb chunk cmath cmd code codecs codeop \
    collections colorsys compileall compression concurrent configparser contextlib contextvars copy \
    copyreg cProfile crypt csv ctypes curses dataclasses datetime dbm decimal difflib dis distutils \
    doctest email encodings ensurepip enum errno faulthandler fcntl filecmp fileinput fnmatch formatter \
    fractions ftplib functools gc genericpath getopt getpass gettext glob graphlib grp gzip hashlib \
    heapq hmac html http idlelib imaplib imghdr imp importlib inspect io ipaddress itertools json \
    keyword lib2to3 linecache locale logging lzma macpath mailbox mailcap marshal math mimetypes mmap \
    modulefinder msilib msvcrt multiprocessing netrc nis nntplib nt ntpath nturl2path numbers numpy \
    opcode operator optparse os ossaudiodev parser pathlib pdb pickle pickletools pipes pkgutil platform \
    plistlib poplib posix posixpath pprint profile pstats pty pwd py_compile pyclbr pydoc pydoc_data \
    pyexpat queue quopri random re readline reprlib resource rlcompleter runpy sched secrets select \
    selectors shelve shlex shutil signal site smtpd smtplib sndhdr socket socketserver spwd sqlite3 \
    sre_compile sre_constants sre_parse ssl stat statistics string stringprep struct subprocess sunau \
    symbol symtable sys sysconfig syslog tabnanny tarfile telnetlib tempfile termios textwrap this \
    threading time timeit tkinter token tokenize tomllib trace traceback tracemalloc tty turtle \
    turtledemo types typing unicodedata unittest urllib uu uuid venv warnings wave weakref webbrowser \
    winreg winsound wsgiref xdrlib xml xmlrpc zipapp zipfile zipimport zlib zoneinfo";

/// The files of a new plugin, and how it is built.
///
/// # Errors
/// When the name will not do, or this kind cannot be begun in this language; a sentence.
pub fn begin(name: &str, kind: Kind, language: Language) -> Result<Begun, String> {
    check(name, language == Language::Python)?;
    let own = |text: &str| own(name, text);
    let header = ("honami.h".to_owned(), include_str!("../../abi/include/honami.h").to_owned());
    match (language, kind) {
        (Language::Python, Kind::Tracker | Kind::Clusterer | Kind::Structure) => {
            let text = match kind {
                Kind::Tracker => include_str!("../../plugin/python/examples/template.py"),
                Kind::Structure => include_str!("../../plugin/python/examples/fan.py"),
                _ => include_str!("../../plugin/python/examples/linkage.py"),
            };
            let sdk = ("honami.py".to_owned(), HONAMI_PY.to_owned());
            Ok(Begun {
                files: vec![(format!("{name}.py"), own(text)), sdk],
                build: format!("python3 {name}/{name}.py --honami-manifest"),
                plugin: format!("{name}/{name}.py"),
            })
        }
        (Language::Rust, Kind::Tracker | Kind::Clusterer | Kind::Structure) => {
            let text = match kind {
                Kind::Tracker => include_str!("../../plugin/examples/template.rs"),
                Kind::Structure => include_str!("../../plugin/examples/fan.rs"),
                _ => include_str!("../../plugin/examples/linkage.rs"),
            };
            Ok(rust::begin(name, own(text)))
        }
        (Language::C, Kind::Tracker | Kind::Structure) => {
            let text = match kind {
                Kind::Structure => include_str!("../../abi/examples/template_structure.c"),
                _ => include_str!("../../abi/examples/template_tracker.c"),
            };
            Ok(Begun {
                files: vec![(format!("{name}.c"), own(text)), header],
                build: format!(
                    "cc -std=c99 -O2 -shared -fPIC -fvisibility=hidden {name}/{name}.c -lm -o {name}/{name}.so"
                ),
                plugin: format!("{name}/{name}.so"),
            })
        }
        (Language::Cpp, Kind::Tracker | Kind::Structure) => {
            let text = match kind {
                Kind::Structure => include_str!("../../abi/examples/template_structure.cpp"),
                _ => include_str!("../../abi/examples/template_tracker.cpp"),
            };
            let class = ("honami.hpp".to_owned(), include_str!("../../abi/include/honami.hpp").to_owned());
            let types = include_str!("../../abi/include/honami_types.hpp").to_owned();
            let types = ("honami_types.hpp".to_owned(), types);
            let manifest = include_str!("../../abi/include/honami_manifest.hpp").to_owned();
            let manifest = ("honami_manifest.hpp".to_owned(), manifest);
            Ok(Begun {
                files: vec![(format!("{name}.cpp"), own(text)), class, types, manifest, header],
                build: format!(
                    "c++ -std=c++17 -O2 -shared -fPIC -fvisibility=hidden -fvisibility-inlines-hidden \
                     {name}/{name}.cpp -o {name}/{name}.so"
                ),
                plugin: format!("{name}/{name}.so"),
            })
        }
        (Language::C | Language::Cpp, Kind::Clusterer) => Err(format!(
            "a {kind} can be begun in Python and in Rust; honami.hpp (C++) and honami.h (C) say what it is"
        )),
        (_, Kind::Simulator) => Err(format!("there is no template of a {kind}")),
    }
}

/// Whether a plugin can have this name.
fn check(name: &str, is_python: bool) -> Result<(), String> {
    let is_word = name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
    if !is_word || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return Err(format!(
            "wanted a name of letters, digits, - and _ that begins with a letter, got {name:?}"
        ));
    }
    if name == "honami" || (is_python && PYTHON_MODULES.split(' ').any(|module| module == name)) {
        return Err(format!("{name:?} is the name of what the plugin needs: choose another"));
    }
    Ok(())
}

/// A template under the name of its author's.
fn own(name: &str, text: &str) -> String {
    ID.iter().fold(text.to_owned(), |text, id| text.replace(id, &format!("org.me.{name}")))
}
