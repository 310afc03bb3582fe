//! `honami plugin check`: every shipped plugin passes it, and what it says of one that does not.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use honami_tests::{Bench, missing, root};
use serde_json::Value;

/// How far what ships is held.
const SHIPPED: u8 = 9;

/// What a report says of a plugin that has not passed; nothing of one that has.
fn complaints(report: &Value) -> Vec<String> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let of = |plugin: &Value| -> Vec<String> {
        let checks = plugin["checks"].as_array().unwrap().iter().filter(|check| check["found"] == "failed");
        checks
            .map(|check| {
                format!("{} {}: {}", text(&plugin["plugin"]), text(&check["id"]), text(&check["text"]))
            })
            .collect()
    };
    report["plugins"].as_array().unwrap().iter().flat_map(of).collect()
}

/// Checks a plugin; its report.
fn check(bench: &Bench, plugin: &str, level: u8) -> Value {
    let ran = bench.run(["plugin", "check", plugin, "--level", &level.to_string(), "--json"]);
    serde_json::from_str(&ran.stdout).unwrap_or_else(|error| panic!("{error}: {ran:?}"))
}

#[test]
fn every_shipped_plugin_passes_and_is_listed_as_checked() {
    let bench = Bench::new();
    let names = |listed: &Value, checked: bool| -> Vec<String> {
        let plugins =
            listed["plugins"].as_array().unwrap().iter().filter(|plugin| plugin["trust"] == "shipped");
        // OpenCV's binding exports two names of its own, which level 1 refuses.
        let plugins = plugins.filter(|plugin| !plugin["id"].as_str().unwrap().contains("opencv"));
        let plugins = plugins.filter(|plugin| !checked || plugin["checked"] == 9);
        plugins.map(|plugin| plugin["short_name"].as_str().unwrap().to_owned()).collect()
    };
    let all = names(&bench.json("plugin list"), false);
    let complaints: Vec<String> =
        all.iter().flat_map(|name| complaints(&check(&bench, name, SHIPPED))).collect();
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
    // Of one that does nothing without its user's file nobody knows how it works.
    let whole: Vec<String> = all.iter().filter(|name| *name != "onnx").cloned().collect();
    assert_eq!(names(&bench.json("plugin list"), true), whole);
    assert!(all.len() > 8 && bench.text("plugin info klt").contains("checked 9"), "{all:?}");
}

/// The example in C as a library; `None` without a C compiler.
fn example_in_c(bench: &Bench, flags: &[&str]) -> Option<PathBuf> {
    if !Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success()) {
        missing("C compiler (cc)");
        return None;
    }
    let library = bench.path("null.so");
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O1", "-shared", "-fPIC", "-I"]).arg(root().join("core/abi/include")).arg("-o");
    let built = cc.arg(&library).args(flags).arg(root().join("core/abi/examples/null_tracker.c")).status();
    assert!(built.unwrap().success());
    Some(library)
}

#[test]
fn what_is_no_plugin_does_not_pass() {
    let bench = Bench::new();
    fs::write(bench.path("text.so"), "no library").unwrap();
    let ran = bench.line("plugin check text.so");
    assert!(ran.code == Some(1) && ran.stdout.contains("file.readable"), "{ran:?}");
}

#[test]
fn a_fault_is_told_with_what_repeats_it_and_the_verdict_is_for_that_content() {
    let bench = Bench::new();
    let Some(library) = example_in_c(&bench, &["-fvisibility=hidden"]) else { return };
    let ran = bench.line("plugin check null.so --level 6");
    assert!(ran.code == Some(0) && ran.stdout.contains("null: level 6, "), "{ran:?}");
    // A line a level, the whole and what is doubtful; with -v a line a check.
    assert!(ran.stdout.contains(" 2  loading ") && !ran.stdout.contains("passed"), "{ran:?}");
    let whole = bench.line("plugin check null.so --level 2 -v").stdout;
    assert!(whole.lines().filter(|line| line.starts_with("passed ")).count() > 10, "{whole}");
    assert!(bench.text("plugin list --plugin null.so").contains("checked 6"));
    // Its helper functions are static; a flag of the linker is a fault of another build.
    let _other = example_in_c(&bench, &["-fvisibility=hidden", "-Wl,-z,execstack"]);
    assert!(!bench.text("plugin list --plugin null.so").contains("checked"));
    let ran = bench.line("plugin check null.so --level 1 --junit report.xml");
    let repeat = format!(
        "honami plugin check {} --plugin-id org.honami.null --reproduce file.stack:1",
        library.display()
    );
    assert!(ran.code == Some(1) && ran.stdout.contains(&repeat), "{ran:?}");
    assert!(ran.stdout.contains("null: level 0, "), "{ran:?}");
    let xml = fs::read_to_string(bench.path("report.xml")).unwrap();
    assert!(xml.contains("<failure message=") && xml.contains("name=\"file.stack\""), "{xml}");
    let words: Vec<&str> = repeat.split(' ').skip(1).collect();
    let again = bench.run(words.iter().copied().chain(["--json"]));
    let report: Value = serde_json::from_str(&again.stdout).unwrap();
    assert!(again.code == Some(1) && complaints(&report).len() == 1, "{again:?}");
    let late = bench.line("plugin check null.so --junit no/report.xml");
    assert!(
        late.code == Some(1) && late.stdout.is_empty() && late.stderr.contains("no/report.xml"),
        "{late:?}"
    );
    let again = bench.run(words);
    assert!(again.code == Some(1) && again.stdout.contains("file.stack failed: its stack"), "{again:?}");
}

#[test]
fn what_is_installed_is_checked_without_being_allowed_and_what_is_held_all_the_same() {
    let bench = Bench::new();
    let Some(library) = example_in_c(&bench, &["-fvisibility=hidden"]) else { return };
    let folder = bench.path("XDG_DATA_HOME/honami/plugins/null");
    fs::create_dir_all(&folder).unwrap();
    fs::rename(library, folder.join("null.so")).unwrap();
    assert!(bench.text("plugin list").contains("not trusted"));
    let sha256 = bench.json("plugin info null")["sha256"].as_str().unwrap().to_owned();
    let quarantine = bench.path("XDG_CACHE_HOME/honami/quarantine");
    fs::create_dir_all(&quarantine).unwrap();
    fs::write(quarantine.join(format!("{sha256}.held")), "died of SIGSEGV").unwrap();
    let ran = bench.line("plugin check null --level 4");
    assert!(ran.code == Some(0) && ran.stdout.contains("null: level 4, "), "{ran:?}");
    assert!(bench.text("plugin list").contains("not trusted"), "a check allows nothing");
    let _denied = bench.text("plugin deny null");
    let ran = bench.line("plugin check null --level 1 --json");
    let said: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(ran.code == Some(1) && said["error"].as_str().unwrap().contains("it was denied"), "{ran:?}");
    let ran = bench.line("plugin check nothere.so --json");
    let said: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(ran.code == Some(2) && said["error"].as_str().unwrap().contains("/nothere.so"), "{ran:?}");
}

#[test]
fn a_shipped_plugin_that_was_denied_is_not_loaded_until_it_is_allowed() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 3, "--leaves 5");
    let _made = bench.text("new p.honami clip.y4m");
    let library = bench.json("plugin info klt")["library"].as_str().unwrap().to_owned();
    let said = bench.text("plugin deny klt");
    assert!(said.contains(&library) && said.contains("org.honami.klt (tracker)"), "{said}");
    let ran = bench.line("track p.honami --with klt");
    assert!(ran.code == Some(1) && ran.stderr.contains("it was denied; `honami plugin allow "), "{ran:?}");
    let doctor = bench.line("doctor").stdout;
    let of = |what: &str| doctor.lines().find(|line| line.contains(what)).unwrap_or_default().to_owned();
    assert!(of("not loaded").contains("klt") && !of("ok  plugins").contains("klt"), "{doctor}");
    let said = bench.text(&format!("plugin allow {library}"));
    assert!(said.contains("is loaded again"), "{said}");
    let _tracked = bench.text("track p.honami --with klt");
}
