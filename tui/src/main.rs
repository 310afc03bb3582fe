//! honami: the command line and the terminal UI.

fn main() -> std::process::ExitCode {
    honami_tui::cli::main()
}
