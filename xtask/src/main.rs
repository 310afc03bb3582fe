//! Developer commands of honami: `cargo xtask demo|test|lint|opencv|peers|bench|wan`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command-line tool speaks to a person")]

mod accuracy;
mod bench;
mod forest;
mod opencv;
mod peers;
mod shell;
mod system;
mod wan;

use std::process::ExitCode;

use shell::cargo;

const HELP: &str = "\
cargo xtask <command>

  demo [--headless]   build what the demo needs (release) and run it
  demo --viewer       build the viewer, too, and draw a forest into honami-demo/forest.png
  test [args…]        install what the tests need where it may, then run every test
  lint                formatting, clippy and documentation, warnings denied
  opencv              install what OpenCV's trackers need where it may, then build them (release)
  peers               install the programs that tests compare with where it may; say how tests find them
  bench [name]        measure; without a name, list the benchmarks
  wan [--json] [case…]  measure over slow links (as root); `wan list` lists the cases";

/// How they are built to be used.
const BUILD: &[&str] = &["build", "--release"];

/// The package that is built apart, for it takes minutes.
const VIEWER: [&str; 2] = ["-p", "honami-viewer"];

/// The packages of a working installation: the program and what the demo uses of the plugins.
const DEMO: [&str; 8] =
    ["-p", "honami", "-p", "honami-plughost", "-p", "honami-tracker-anchored", "-p", "honami-clusterer-bod"];

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let result = match args.split_first() {
        Some((&"demo", rest)) => demo(rest),
        Some((&"test", rest)) => test(rest),
        Some((&"lint", [])) => lint(),
        Some((&"opencv", [])) => opencv::build(),
        Some((&"peers", [])) => peers::tell(),
        Some((&"bench", rest)) => bench::run(rest),
        Some((&"wan", rest)) => wan::run(rest),
        Some((&("help" | "--help" | "-h"), _)) => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        _ => {
            eprintln!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("xtask: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Builds the program and its plugins and runs the demo.
fn demo(args: &[&str]) -> anyhow::Result<()> {
    system::need_compiler()?;
    if args == ["--viewer"] {
        cargo(BUILD).args(DEMO).args(VIEWER).run()?;
        return viewer();
    }
    cargo(BUILD).args(DEMO).run()?;
    shell::built("release", "honami")?.arg("demo").args(args).run()
}

/// Draws a forest of a generated tree.
fn viewer() -> anyhow::Result<()> {
    let out = "honami-demo/forest.png";
    std::fs::create_dir_all(shell::root().join("honami-demo"))?;
    let view = shell::built("release", "honami")?.args(["view", "synth::tree:3437,1", "--forest", "12"]);
    view.args(["--offscreen", out]).run()
}

/// Installs what the tests need and runs all of them.
fn test(args: &[&str]) -> anyhow::Result<()> {
    system::need_compiler()?;
    system::want_ffmpeg()?;
    // What is asked for by name is looked for in the packages that build everywhere.
    let opencv = if args.is_empty() { opencv::Kit::want() } else { None };
    if args.is_empty() && opencv.is_none() {
        system::may_skip("OpenCV's trackers")?;
    }
    let peers = if args.is_empty() { peers::want() } else { None };
    if args.is_empty() && peers.is_none() {
        system::may_skip("what OpenSees, readers of rigs and glTF's validator say")?;
    }
    // The end-to-end tests run the real programs with the real plugins: build them first.
    cargo(&["build"]).run()?;
    if args.is_empty() {
        system::want_drawing()?;
        cargo(&["build"]).args(VIEWER).run()?;
    }
    if let Some(opencv) = &opencv {
        opencv.cargo(&["build"]).run()?;
    }
    let tests = cargo(&["test"]).args(args.iter().copied());
    peers.unwrap_or_default().into_iter().fold(tests, |tests, (name, value)| tests.env(name, value)).run()?;
    if args.is_empty() {
        cargo(&["test"]).args(VIEWER).run()?;
    }
    opencv.map_or(Ok(()), |opencv| opencv.cargo(&["test"]).run())
}

/// Everything that a reviewer should not have to say.
fn lint() -> anyhow::Result<()> {
    cargo(&["fmt", "--all", "--check"]).run()?;
    let clippy = ["clippy", "--all-targets", "--", "-D", "warnings"];
    let doc = ["doc", "--no-deps", "--document-private-items"];
    cargo(&clippy).run()?;
    cargo(&["clippy"]).args(VIEWER).args(clippy[1..].iter().copied()).run()?;
    cargo(&doc).env("RUSTDOCFLAGS", "-D warnings").run()?;
    cargo(&doc).args(VIEWER).env("RUSTDOCFLAGS", "-D warnings").run()?;
    let Some(opencv) = opencv::Kit::find() else {
        eprintln!("skipped: OpenCV's trackers, because OpenCV is not there (`cargo xtask opencv` gets it)");
        return system::may_skip("OpenCV's trackers");
    };
    opencv.cargo(&clippy).run()?;
    opencv.cargo(&doc).env("RUSTDOCFLAGS", "-D warnings").run()
}
