//! A plugin that would abort on a panic does not compile.
#![expect(clippy::unwrap_used, reason = "a test's helper")]

use std::path::Path;
use std::process::Command;

const SOURCE: &str = r#"//! No plugins at all.
honami_plugin::export! { library: { id: "org.example.none", version: "0", license: "MIT" }, plugins: [] }
"#;

/// Checks a library with this panic strategy; gives what the compiler said if it refused.
fn check(panic: &str) -> Result<(), String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plugin-panic");
    let manifest = format!(
        "[package]\nname = \"none\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\
         [lib]\ncrate-type = [\"cdylib\"]\n\
         [dependencies]\nhonami-plugin.path = {:?}\n\
         [profile.dev]\npanic = {panic:?}\n[workspace]\n",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::create_dir_all(folder.join("src")).unwrap();
    std::fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    std::fs::write(folder.join("src/lib.rs"), SOURCE).unwrap();
    let output = Command::new(env!("CARGO"))
        .args(["check", "--quiet", "--offline", "--target-dir", "target"])
        .current_dir(&folder)
        .output()
        .unwrap();
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

#[test]
fn a_plugin_that_aborts_on_a_panic_does_not_compile() {
    check("unwind").unwrap();
    let said = check("abort").expect_err("a plugin that aborts");
    assert!(said.contains("a plugin under panic = \"abort\" would take its host down"), "{said}");
}
