//! What the author of a plugin begins with: a fresh folder, built by the line that honami prints, which then works.

use std::fs;
use std::process::{Command, Output};

use honami_tests::{Bench, Row, has_compiler, rows, skipped};
use serde_json::Value;

use crate::schema::assert_satisfied;

/// What `honami plugin new` begins: its words, and what must be there to build it.
const LANGUAGES: [(&str, &str, &[&str]); 4] = [
    ("in-python", "python", &["python3", "-c", "import numpy"]),
    ("in-rust", "rust", &["cargo", "--version"]),
    ("in-c", "c", &["cc", "--version"]),
    ("in-cpp", "cpp", &["c++", "--version"]),
];

/// So far every one of them is checked, as what ships is.
const LEVEL: u32 = 9;

/// What may be doubtful: how busy the machine is, and what its kernel can shut in; and what the template is too simple for,
/// which compares brightness as it is.
const DOUBTFUL: [&str; 5] =
    ["loading.scan", "loading.starts", "running.progress", "running.stop", "truth.light"];

/// Holds a plugin against what honami asks of all: nothing has failed, and there is nothing to look at.
#[track_caller]
fn assert_checked(bench: &Bench, plugin: &str) {
    let checked = bench.line(&format!("plugin check {plugin} --level {LEVEL} --json"));
    let report: Value = serde_json::from_str(&checked.stdout).unwrap_or_else(|e| panic!("{e}: {checked:?}"));
    let of = |found: &str| -> Vec<&Value> {
        let checks =
            report["plugins"].as_array().unwrap().iter().flat_map(|p| p["checks"].as_array().unwrap());
        checks.filter(|check| check["found"] == found).collect()
    };
    let (failed, doubtful) = (of("failed"), of("doubtful"));
    let may_be = |check: &&Value| check["id"].as_str().is_some_and(|id| DOUBTFUL.contains(&id));
    assert!(failed.is_empty() && doubtful.iter().all(may_be), "{plugin}: {failed:?} {doubtful:?}");
    assert_eq!(checked.code, Some(if doubtful.is_empty() { 0 } else { 3 }), "{plugin}");
}

fn runs(bench: &Bench, words: &[&str]) -> Option<Output> {
    // As an author has it: cargo builds into the plugin's own folder.
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).current_dir(bench.path("")).env_remove("CARGO_TARGET_DIR");
    command.output().ok()
}

/// Begins a plugin and builds it; its file, or `None` where this machine cannot.
pub(crate) fn begun(bench: &Bench, line: &str, needed: &[&str]) -> Option<String> {
    let is_there = match needed {
        [compiler, "--version"] => has_compiler(compiler),
        _ => runs(bench, needed).is_some_and(|output| output.status.success()),
    };
    if !is_there {
        skipped(&needed.join(" "));
        return None;
    }
    // What comes after `--` is another program's.
    let said = bench.line(&format!("plugin new --json {line}")).json();
    let build: Vec<&str> = said["next"]["build"].as_str().unwrap().split_whitespace().collect();
    let built = runs(bench, &build).unwrap();
    assert!(built.status.success(), "{build:?}: {}", String::from_utf8_lossy(&built.stderr));
    let plugin = said["plugin"].as_str().unwrap().to_owned();
    assert_satisfied(&bench.path(&plugin));
    Some(plugin)
}

/// Places in the picture, the fifth without a template, and others near the border.
const POINTS: &str = "id,x,y\n1,60,60\n2,80.3,50.7\n3,100,70\n4,75,90.5\n5,3,3\n\
                      6,9,30\n7,9,60\n8,9,90\n9,150,30\n10,150,60\n11,150,90\n12,40,9\n13,80,9\n14,120,9\n";

#[test]
fn a_tracker_that_was_just_begun_follows_the_texture_and_is_the_same_in_every_language() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 12, "--leaves 40 --wind calm");
    // Here some leave the picture.
    bench.synth("storm.y4m", 12, "--leaves 40 --wind storm");
    fs::write(bench.path("points.csv"), POINTS).unwrap();
    let mut samples = Vec::new();
    for (name, lang, needed) in LANGUAGES {
        let Some(plugin) = begun(&bench, &format!("{name} --lang {lang}"), needed) else { continue };
        let told = bench.text(&format!("plugin info {name} --plugin {plugin}"));
        assert!(told.contains("radius") && told.contains("Half the side of the template."), "{told}");
        assert_checked(&bench, &plugin);
        assert!(bench.text(&format!("plugin list --plugin {plugin}")).contains("checked 9"), "{name}");
        let with = format!("--with {name} --plugin {plugin}");
        let said = bench.json(&format!("compare clip.y4m --truth clip.truth.csv {with} --quick"));
        let share = |row: usize| said["trackers"][row]["delta_avg"].as_f64().unwrap();
        assert!(share(0) > share(1) + 0.1, "{name}: {}, {} of what stands still", share(0), share(1));
        assert!(said["trackers"][0]["median_px"].as_f64().unwrap() < 1.0, "{name}: {said}");
        bench.json(&format!("new {name}.honami storm.y4m"));
        bench.json(&format!("track {name}.honami {with} --points points.csv"));
        samples.push(bench.samples(&format!("{name}.honami")));
    }
    assert!(samples.windows(2).all(|pair| pair[0] == pair[1]), "{samples:?}");
    let is_lost = |row: &Row| row["track"] != "5" && row["status"] == "0";
    assert!(samples.iter().all(|rows| rows.iter().any(is_lost)), "{samples:?}");
    assert_eq!(bench.line("plugin new in-c").code, Some(1), "it is there already");
}

#[test]
fn a_plugin_with_the_short_name_of_another_is_begun_under_its_full_id() {
    let bench = Bench::new();
    let said = bench.text("plugin new klt");
    assert!(
        said.contains("klt is also the short name of org.honami.klt: this one is called org.me.klt"),
        "{said}"
    );
    assert!(said.contains("--with org.me.klt --plugin klt/klt.py"), "{said}");
    let said = bench.text("plugin new mine --lang c");
    assert!(!said.contains("also") && said.contains("after each change"), "{said}");
}

#[test]
fn a_structure_builder_that_was_just_begun_grows_alike_in_every_language() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 5");
    let mut tables = Vec::new();
    for (name, lang, needed) in &LANGUAGES {
        let Some(plugin) = begun(&bench, &format!("{name} --kind structure --lang {lang}"), needed) else {
            continue;
        };
        assert_checked(&bench, &plugin);
        let said = bench.json(&format!("grow p.honami j.csv --root 80,118 --with {name} --plugin {plugin}"));
        assert_eq!((&said["joints"], &said["groups"]), (&6.into(), &5.into()), "{said}");
        let rows = rows(&bench.path("j.csv")).into_iter();
        let place =
            |row: Row| ["joint", "frame", "x_px", "y_px"].map(|name| row[name].parse::<f64>().unwrap());
        tables.push(rows.map(place).collect::<Vec<_>>());
    }
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-5;
    let alike =
        |pair: &[Vec<[f64; 4]>]| pair[0].as_flattened().iter().zip(pair[1].as_flattened()).all(is_near);
    assert!(tables.windows(2).all(|pair| pair[0].len() == pair[1].len() && alike(pair)), "{tables:?}");
}

#[test]
fn a_clusterer_that_was_just_begun_groups_tracks_alike_in_every_language() {
    let bench = Bench::tracked();
    let mut groups = Vec::new();
    for (name, lang, needed) in &LANGUAGES[..2] {
        let Some(plugin) = begun(&bench, &format!("{name} --kind clusterer --lang {lang}"), needed) else {
            continue;
        };
        assert_checked(&bench, &plugin);
        let said = bench.json(&format!("cluster p.honami --with {name} --plugin {plugin}"));
        assert!(said["groups"].as_array().unwrap().len() > 1, "{said}");
        groups.push(said["groups"].clone());
    }
    assert!(groups.windows(2).all(|pair| pair[0] == pair[1]), "{groups:?}");
}
