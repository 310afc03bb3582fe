//! The process that a plugin runs in; honami starts it, never a person.

use std::io::Write as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    match honami_host::serve(std::env::args_os().skip(1)) {
        Ok(code) => code,
        Err(error) => {
            // Where nobody listens there is nothing to do about it.
            drop(writeln!(std::io::stderr(), "honami-plughost: {error}"));
            ExitCode::from(2)
        }
    }
}
