//! Developer commands of honami: `cargo xtask demo|test|lint|opencv|peers|bench|soak|wan`.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command-line tool speaks to a person")]

mod accuracy;
mod bench;
mod forest;
mod opencv;
mod peers;
mod recipes;
mod shell;
mod soak;
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
  soak [--kills N | --minutes N] [--seed S]
                      kill -9, full disks, refused folders, a long day: 1,000 kills of each kind of work
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
        Some((&"soak", rest)) => soak::run(rest),
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
    if !args.is_empty() {
        // The end-to-end tests run the real programs with the real plugins: build them first.
        cargo(&["build"]).run()?;
        return cargo(&["test"]).args(args.iter().copied()).run();
    }
    let opencv = opencv::Kit::want();
    if opencv.is_none() {
        system::may_skip("OpenCV's trackers")?;
    }
    let peers = peers::want();
    if peers.is_none() {
        system::may_skip("what OpenSees, readers of rigs and glTF's validator say")?;
    }
    system::want_drawing()?;
    let all = All::with(opencv);
    all.cargo(&["build"]).run()?;
    // What tests build is chosen as this is: other choices would build what they share once more, with other features.
    let tests = all.cargo(&["test"]).env("HONAMI_BUILD", all.words().join(" "));
    peers.unwrap_or_default().into_iter().fold(tests, |tests, (name, value)| tests.env(name, value)).run()
}

/// Everything that a reviewer should not have to say.
fn lint() -> anyhow::Result<()> {
    cargo(&["fmt", "--all", "--check"]).run()?;
    let opencv = opencv::Kit::find();
    if opencv.is_none() {
        eprintln!("skipped: OpenCV's trackers, because OpenCV is not there (`cargo xtask opencv` gets it)");
        system::may_skip("OpenCV's trackers")?;
    }
    let all = All::with(opencv);
    all.cargo(&["clippy", "--all-targets", "--", "-D", "warnings"]).run()?;
    all.cargo(&["doc", "--no-deps", "--document-private-items"]).env("RUSTDOCFLAGS", "-D warnings").run()
}

/// Every package, with OpenCV's trackers where OpenCV is.
struct All {
    opencv: Option<opencv::Kit>,
}

impl All {
    fn with(opencv: Option<opencv::Kit>) -> Self {
        Self { opencv }
    }

    /// How cargo is told so.
    fn words(&self) -> &'static [&'static str] {
        if self.opencv.is_some() {
            &["--workspace", "--features", "honami-tracker-opencv/opencv"]
        } else {
            &["--workspace", "--exclude", "honami-tracker-opencv"]
        }
    }

    /// Cargo on all of them.
    fn cargo(&self, args: &[&str]) -> shell::Step {
        let (before, after) = args.split_at(args.iter().position(|arg| *arg == "--").unwrap_or(args.len()));
        let step = cargo(before).args(self.words()).args(after);
        self.opencv.iter().flat_map(opencv::Kit::env).fold(step, |step, (name, value)| step.env(name, value))
    }
}
