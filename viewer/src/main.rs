//! honami-viewer: shows scenes that `honami view` wrote.

mod ends;

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use honami_viewer::args::Args;

fn main() -> ExitCode {
    let args = Args::parse();
    if let Err(error) = ends::heed(args.attended) {
        writeln!(std::io::stderr(), "honami-viewer: signals cannot be caught here: {error}")
            .unwrap_or_default();
    }
    match honami_viewer::run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            honami_viewer::complain(&error, args.attended);
            if honami_viewer::is_usage(&error) { ExitCode::from(2) } else { ExitCode::FAILURE }
        }
    }
}
