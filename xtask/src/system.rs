//! What honami needs from the system: a C compiler to build, ffmpeg for most videos.

use std::process::{Command, Stdio};

use anyhow::ensure;

use crate::shell::Step;

/// Makes sure that the linker is there, and that the bundled C source of SQLite can be built.
pub(crate) fn need_compiler() -> anyhow::Result<()> {
    if !answers("cc") {
        install("build-essential");
    }
    ensure!(answers("cc"), "a C compiler is needed: install it with `apt-get install build-essential`");
    Ok(())
}

/// ffmpeg is wanted: without it the tests of most video formats say that they are skipped.
pub(crate) fn want_ffmpeg() -> anyhow::Result<()> {
    if answers("ffmpeg") || install("ffmpeg") {
        return Ok(());
    }
    eprintln!("ffmpeg is missing: tests that need it say so. To install it: apt-get install ffmpeg");
    may_skip("the tests that need ffmpeg")
}

/// A driver that draws without a graphics card, and a display that nobody sees, are wanted: without them the viewer's tests
/// say that they are skipped.
pub(crate) fn want_drawing() -> anyhow::Result<()> {
    let has_driver =
        || std::fs::read_dir("/usr/share/vulkan/icd.d").is_ok_and(|mut files| files.next().is_some());
    let missing = [("mesa-vulkan-drivers", has_driver()), ("xvfb", is_there("Xvfb"))];
    for (package, _) in missing.into_iter().filter(|(_, is_there)| !is_there) {
        if !install(package) {
            eprintln!(
                "{package} is missing: tests that need it say so. To install it: apt-get install {package}"
            );
            may_skip(&format!("the viewer's tests that need {package}"))?;
        }
    }
    Ok(())
}

/// Lets tests be left out for want of a system library, unless `HONAMI_SKIP=never`, as in CI.
pub(crate) fn may_skip(what: &str) -> anyhow::Result<()> {
    let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
    ensure!(!never, "{what} would be skipped, which HONAMI_SKIP=never forbids");
    Ok(())
}

/// Whether a program is there, by its path or on the search path.
pub(crate) fn is_there(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

fn answers(program: &str) -> bool {
    let quiet = |flag: &str| {
        Command::new(program)
            .arg(flag)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .stdin(Stdio::null())
            .status()
    };
    quiet("-version").is_ok_and(|s| s.success()) || quiet("--version").is_ok_and(|s| s.success())
}

/// Installs a Debian package where this user may do so without a question; says so where not.
pub(crate) fn install(package: &str) -> bool {
    let Some(apt) = Apt::find() else {
        eprintln!("{package} is missing and cannot be installed from here (needs root and apt-get)");
        return false;
    };
    let done = apt.run(&["update"]).and_then(|()| apt.run(&["install", "--no-install-recommends", package]));
    if let Err(error) = &done {
        eprintln!("could not install {package}: {error:#}");
    }
    done.is_ok()
}

/// apt-get, for a user who may install.
pub(crate) struct Apt {
    /// The words that make a command run as root: none for root itself, `sudo -n` where it asks nothing.
    prefix: &'static [&'static str],
}

impl Apt {
    pub(crate) fn find() -> Option<Self> {
        let ok = |program: &str, args: &[&str]| {
            let out = Command::new(program).args(args).stderr(Stdio::null()).output().ok()?;
            out.status.success().then(|| String::from_utf8_lossy(&out.stdout).trim().to_owned())
        };
        ok("apt-get", &["--version"])?;
        if ok("id", &["-u"])? == "0" {
            return Some(Self { prefix: &[] });
        }
        ok("sudo", &["-n", "true"]).map(|_| Self { prefix: &["sudo", "-n"] })
    }

    pub(crate) fn run(&self, args: &[&str]) -> anyhow::Result<()> {
        let mut words = self.prefix.iter().chain(&["apt-get", "-qq", "-y"]).chain(args);
        let program = words.next().unwrap_or(&"apt-get");
        Step::new(program).args(words).env("DEBIAN_FRONTEND", "noninteractive").run()
    }
}
