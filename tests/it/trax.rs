//! Trackers that speak TraX become plugins as they are.

use std::fs;

use honami_tests::{Bench, root};

use crate::isolated::is_shut_in;
use crate::sdk::begun;

/// A small clip, and the server of the tests beside it.
pub(crate) fn with_server() -> Bench {
    let bench = Bench::new();
    bench.synth("clip.y4m", 6, "--leaves 12 --wind calm");
    fs::create_dir(bench.path("theirs")).unwrap();
    fs::copy(root().join("tests/peers/trax_server.py"), bench.path("theirs/server.py")).unwrap();
    bench
}

pub(crate) const NEEDED: [&str; 3] = ["python3", "-c", "import numpy"];

#[test]
fn a_trax_server_follows_the_points_whatever_its_form_of_images_and_version() {
    let bench = with_server();
    for (name, form, version) in
        [("memory", "memory;path", "1"), ("file", "path", "3"), ("buffer", "buffer", "4")]
    {
        let line = format!("{name} --lang trax -- python3 theirs/server.py {form} {version}");
        let Some(plugin) = begun(&bench, &line, &NEEDED) else { return };
        let told = bench.text(&format!("plugin info {name} --plugin {plugin}"));
        assert!(told.contains("it also starts other programs, reads ") && told.contains("/theirs"), "{told}");
        let said = bench.json(&format!(
            "compare clip.y4m --truth clip.truth.csv --with {name} --plugin {plugin} --quick"
        ));
        let share = |row: usize| said["trackers"][row]["within_1px"].as_f64().unwrap();
        assert!(share(0) > share(1) + 0.1, "{name}: {}, {} of what stands still", share(0), share(1));
    }
}

#[test]
fn a_trax_server_that_goes_loses_its_point_and_one_that_is_none_says_so() {
    let bench = with_server();
    fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n2,80,50\n").unwrap();
    let _said = bench.text("new p.honami clip.y4m");
    let Some(plugin) = begun(&bench, "goes --lang trax -- python3 theirs/server.py memory 4 quits", &NEEDED)
    else {
        return;
    };
    let said = bench.text(&format!("track p.honami --plugin {plugin} --with goes --points points.csv"));
    assert!(said.contains("at the end 2 lost"), "{said}");
    let Some(plugin) = begun(&bench, "none --lang trax -- true", &NEEDED) else { return };
    let fails = |more: &str, wanted: &str| {
        let _said = bench.text("new q.honami clip.y4m");
        let ran =
            bench.line(&format!("track q.honami --plugin {plugin} --with none --points points.csv{more}"));
        fs::remove_file(bench.path("q.honami")).unwrap();
        assert!(ran.code == Some(1) && ran.stderr.contains(wanted), "{ran:?}");
    };
    fails("", "true ended before it said hello");
    fails(" --set most=1", "1 points at most");
}

#[test]
fn a_trax_server_that_does_not_answer_is_named_and_costs_its_point() {
    let bench = with_server();
    fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n2,80,50\n").unwrap();
    for (name, wanted) in [
        ("hangs", "the TraX server of point 1 gave no answer for 3 s: its point is lost"),
        ("babbles", "the TraX server of point 2 said a line without end: its point is lost"),
    ] {
        let line = format!("{name} --lang trax -- python3 theirs/server.py memory 4 {name}");
        let Some(plugin) = begun(&bench, &line, &NEEDED) else { return };
        let _said = bench.text(&format!("new {name}.honami clip.y4m"));
        let ran = bench.line(&format!(
            "track {name}.honami -v --plugin {plugin} --with {name} --points points.csv --set patience_s=3"
        ));
        assert!(ran.code == Some(0) && ran.stdout.contains("at the end 2 lost"), "{ran:?}");
        assert!(ran.stderr.contains(wanted), "{ran:?}");
    }
}

#[test]
fn a_trax_server_in_the_home_folder_cannot_be_read_and_is_told_so() {
    let bench = with_server();
    fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n").unwrap();
    fs::create_dir_all(bench.path("HOME")).unwrap();
    fs::copy(bench.path("theirs/server.py"), bench.path("HOME/server.py")).unwrap();
    if !is_shut_in() {
        return;
    }
    let line = "homely --lang trax -- python3 HOME/server.py memory 4";
    let Some(plugin) = begun(&bench, line, &NEEDED) else { return };
    let _said = bench.text("new p.honami clip.y4m");
    let ran = bench.line(&format!("track p.honami --plugin {plugin} --with homely --points points.csv"));
    assert!(
        ran.code == Some(1) && ran.stderr.contains("/HOME cannot be read (Permission denied)"),
        "{ran:?}"
    );
}
