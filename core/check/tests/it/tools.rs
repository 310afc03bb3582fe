//! What the tests share: libraries that cc builds, and the checks up to a level, each in its own process.

use honami_check::{Check, Finding, Outcome, Plan, checks};
use honami_host::{Registry, SearchPath};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// A folder for this run.
pub(crate) fn scratch() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap()).path()
}

/// Whether there is a C compiler; says so if not, which `HONAMI_SKIP=never` forbids.
pub(crate) fn has_cc() -> bool {
    let is_there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    let never = std::env::var_os("HONAMI_SKIP").is_some_and(|value| value == "never");
    assert!(is_there || !never, "there is no C compiler (cc), and HONAMI_SKIP=never forbids to do without");
    if !is_there {
        eprintln!("skipped: needs a C compiler (cc)");
    }
    is_there
}

/// Compiles a C plugin of this package's tests, or of another's. Its name comes to it when it is whole: tests that share
/// one compile it at the same time.
pub(crate) fn compile(source: &str, name: &str, flags: &[&str]) -> PathBuf {
    static BUILT: AtomicUsize = AtomicUsize::new(0);
    let library = scratch().join(format!("{name}.so"));
    let fresh = library.with_extension(format!("{}.o", BUILT.fetch_add(1, Ordering::Relaxed)));
    let output = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC", "-fvisibility=hidden"])
        .args(["-I", "../abi/include", source, "-o"])
        .arg(&fresh)
        .args(flags)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    std::fs::rename(&fresh, &library).unwrap();
    library
}

/// The programs that checks need, built by cargo, which is asked where the one to start lies.
fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // Where all is tested together, what is built has to be chosen as it was, or much is built once more.
        let all = std::env::var("HONAMI_BUILD");
        let built = |package: &str, target: [&str; 2]| {
            let output = Command::new(env!("CARGO"))
                .args(["build", "--quiet", "--message-format=json"])
                .args(target)
                .args(all.as_deref().unwrap_or(package).split_whitespace())
                .current_dir(env!("CARGO_MANIFEST_DIR"))
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let text = String::from_utf8(output.stdout).unwrap();
            let messages =
                text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
            let mut files =
                messages.filter_map(|message| Some(PathBuf::from(message["executable"].as_str()?)));
            files.next_back().unwrap()
        };
        built("-p honami-plughost", ["--bin", "honami-plughost"]);
        built("-p honami-check", ["--example", "one_check"])
    })
}

/// The checks that are wanted, on the only plugin of a library.
pub(crate) fn check(library: &Path, is_wanted: impl Fn(&Check) -> bool) -> Vec<Outcome> {
    let named = SearchPath { named: vec![library.to_owned()], ..SearchPath::default() };
    let registry = Registry::scan_path(&named);
    assert!(registry.problems().is_empty(), "{:?}", registry.problems());
    let plugin = registry.plugins()[0].id.clone();
    let mut checks: Vec<_> = checks().into_iter().filter(is_wanted).collect();
    // One that hangs does so for ever: who waits for it needs not wait as long as a user would.
    if library.file_stem().is_some_and(|name| name == "HANGS") {
        checks.iter_mut().for_each(|check| check.deadline = check.deadline.min(Duration::from_secs(5)));
    }
    let (program, file) = (program().to_owned(), library.to_owned());
    let plan = Plan { program, file, plugin, checks, seed: 1 };
    plan.run(&mut |_| {})
}

/// What has failed, in words for a test that fails.
pub(crate) fn failed(outcomes: &[Outcome]) -> Vec<String> {
    let failed = outcomes.iter().filter(|outcome| matches!(outcome.finding, Finding::Fails(_)));
    failed.map(|outcome| format!("{}: {}", outcome.check.id, outcome.finding.text())).collect()
}
