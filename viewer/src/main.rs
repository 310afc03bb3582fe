//! honami-viewer: shows scenes that `honami view` wrote.

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use honami_viewer::args::Args;

fn main() -> ExitCode {
    match honami_viewer::run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody left to tell is no reason to fail otherwise.
            writeln!(std::io::stderr(), "honami-viewer: {error:#}").unwrap_or_default();
            ExitCode::FAILURE
        }
    }
}
