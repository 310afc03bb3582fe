//! The process that a plugin runs in: `honami-plughost LIBRARY [FILE…]` with the files that it may read, started by honami, never by a person.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args_os().skip(1);
    let Some(library) = args.next() else {
        return fail("this is the process that plugins run in; honami starts it: wanted a library");
    };
    let read: Vec<PathBuf> = args.map(PathBuf::from).collect();
    honami_host::serve(Path::new(&library), &read)
        .map_or_else(|error| fail(&error.to_string()), |()| ExitCode::SUCCESS)
}

fn fail(why: &str) -> ExitCode {
    // Where nobody listens there is nothing to do about it.
    drop(writeln!(std::io::stderr(), "honami-plughost: {why}"));
    ExitCode::from(2)
}
