//! Sessions done again from their logs, through the real program.

use std::fs;

use honami_tests::Bench;
use serde_json::json;

use crate::isolated::has_cc;
use crate::rebuilt::build;

/// A project with tracks, and the first line of a session that begins with it.
fn bench() -> (Bench, String) {
    let bench = Bench::new();
    bench.synth("clip.y4m", 20, "");
    let clip = bench.json("new p.honami clip.y4m")["sha256"].clone();
    bench.json("track p.honami --with klt --set max_features=9");
    let head = head(&bench, &clip);
    (bench, head)
}

/// The first line of a session that begins with the project as it is.
fn head(bench: &Bench, clip: &serde_json::Value) -> String {
    let revision = bench.json("log p.honami")["revision"].clone();
    let head = json!({
        "honami-log": 1, "honami": "0.1.0", "project": "p", "clip": clip, "revision": revision,
        "screen": [80, 24], "seat": {},
    });
    format!("{head}\n")
}

const SESSION: &str = r#"{"t_s":1.0,"action":"move-sample","in":"review","frame":4,"track":3}
{"t_s":1.5,"action":"right","in":"move","frame":4,"track":3,"count":2}
{"t_s":2.0,"mouse":{"kind":{"press":0},"cell":[0,0],"at":[80.5,60.5]},"in":"move","frame":4,"track":3}
{"t_s":2.5,"action":"accept","in":"move","frame":4,"track":3}
{"t_s":3.0,"action":"accept","in":"review","frame":7,"track":5,"judged":{"track":5,"frames":{"start":0,"end":20},"verdict":"accepted","reasons":["NCC"],"effort":{"keystrokes":4,"key_frames":0,"seconds":2.5}}}
{"t_s":4.0,"action":"track","in":"review","frame":7,"track":5}
{"t_s":4.5,"action":"accept","in":"form","frame":7,"track":5}
{"t_s":9.0,"ended":"klt"}
{"t_s":9.5,"action":"undo","in":"review","frame":7,"track":5}
"#;

#[test]
fn a_session_is_done_again_and_says_the_same() {
    let (bench, head) = bench();
    fs::copy(bench.path("p.honami"), bench.path("q.honami")).unwrap();
    fs::write(bench.path("s.jsonl"), head + SESSION).unwrap();
    let first = bench.json("replay p.honami s.jsonl");
    assert_eq!((&first["difference"], &first["done"]), (&json!(null), &json!(9)), "{first}");
    let said: Vec<&str> =
        first["said"].as_array().unwrap().iter().map(|s| s["text"].as_str().unwrap()).collect();
    for (said, words) in said.iter().zip(["track 3: ", "track 5", "klt: ", "undone: "]) {
        assert!(said.contains(words), "{words} is not in {said}");
    }
    assert_eq!(said.len(), 4, "{said:?}");
    let text = bench.text("replay q.honami s.jsonl");
    assert!(text.ends_with("9 lines done as in the log; at edit 3\n"), "{text}");
    assert_eq!(bench.samples("p.honami"), bench.samples("q.honami"));
    let labels = ["p.honami", "q.honami"].map(|project| {
        bench.log(project, "edit").iter().map(|edit| edit["label"].clone()).collect::<Vec<_>>()
    });
    assert_eq!(labels[0], labels[1]);
}

/// Hand work on a skeleton, which grows by its plugin before it is worked on.
const SHAPING: &str = r#"{"t_s":1.0,"action":"skeleton","in":"review","frame":0,"track":3}
{"t_s":2.0,"action":"place-root","in":"review","frame":0,"track":3}
{"t_s":2.5,"action":"right","in":"place","frame":0,"track":3,"count":4}
{"t_s":3.0,"action":"accept","in":"place","frame":0,"track":3}
{"t_s":3.5,"action":"panel-skeleton","in":"review","frame":0,"track":3}
{"t_s":4.0,"action":"up","in":"review","frame":0,"track":3,"count":9}
{"t_s":4.5,"action":"shape-bone","in":"review","frame":0,"track":3}
{"t_s":5.0,"action":"right","in":"shape","frame":0,"track":3,"count":6}
{"t_s":5.5,"action":"more-groups","in":"shape","frame":0,"track":3}
{"t_s":6.0,"action":"accept","in":"shape","frame":0,"track":3}
"#;

#[test]
fn a_skeleton_shaped_in_a_session_is_shaped_again() {
    let (bench, before) = bench();
    let clip = serde_json::from_str::<serde_json::Value>(&before).unwrap()["clip"].clone();
    bench.json("cluster p.honami --groups 3");
    fs::write(bench.path("s.jsonl"), head(&bench, &clip) + SHAPING).unwrap();
    let done = bench.json("replay p.honami s.jsonl");
    assert_eq!((&done["difference"], &done["done"]), (&json!(null), &json!(10)), "{done}");
    let edits = bench.log("p.honami", "edit");
    let labels: Vec<&str> = edits.iter().rev().map(|edit| edit["label"].as_str().unwrap()).collect();
    let [bone, root, ..] = labels[..] else { panic!("{labels:?}") };
    assert!(root.starts_with("root placed at ") && bone.ends_with(": plane 30°, gain 1.1"), "{labels:?}");
    let grown = bench.json("grow p.honami");
    let note = format!("1 bone shaped by hand: {}", bone.split(':').next().unwrap());
    assert!(grown["notes"].to_string().contains(&note), "{note} in {grown}");
}

#[test]
fn it_stops_where_it_goes_another_way() {
    let (bench, head) = bench();
    for (from, to, line, words) in [
        ("\"in\":\"form\"", "\"in\":\"move\"", 8, "this was done in move, and now it would be done in form"),
        ("right", "whistle", 3, "there is no action whistle"),
        ("\"track\":5,\"judged\"", "\"track\":99,\"judged\"", 6, "there is no track 99"),
        ("80.5,60.5", "800.5,60.5", 4, "the point 800.5, 60.5 is not seen now"),
        (
            "{\"t_s\":9.0,\"ended\"",
            "{\"t_s\":9.0,\"error\":\"no room\"}\n{\"t_s\":9.0,\"ended\"",
            9,
            "nothing is said",
        ),
    ] {
        fs::copy(bench.path("p.honami"), bench.path("q.honami")).unwrap();
        let log = (head.clone() + SESSION).replacen(from, to, 1);
        fs::write(bench.path("s.jsonl"), log).unwrap();
        let ran = bench.line("replay q.honami s.jsonl");
        assert_eq!(ran.code, Some(1), "{ran:?}");
        let last = ran.stdout.lines().last().unwrap_or_default();
        assert!(last.starts_with(&format!("s.jsonl, line {line}: ")) && last.contains(words), "{ran:?}");
    }
    fs::write(bench.path("s.jsonl"), "hello\n").unwrap();
    for (line, words) in [
        ("replay p.honami s.jsonl", "line 1: wanted the first line of a log of honami"),
        ("replay p.honami gone.jsonl", "cannot read the log gone.jsonl"),
        ("replay gone.honami s.jsonl", "there is no project gone.honami"),
    ] {
        let ran = bench.line(line);
        assert!(ran.code == Some(1) && ran.stderr.contains(words), "{ran:?}");
    }
}

#[test]
fn a_form_begins_with_what_its_plugin_was_told_before_it_was_away() {
    if !has_cc() {
        return;
    }
    let bench = Bench::new();
    bench.synth("clip.y4m", 8, "--leaves 20");
    let clip = bench.json("new p.honami clip.y4m")["sha256"].clone();
    fs::write(bench.path("points.csv"), "id,x,y\n1,20,30\n2,60,40\n").unwrap();
    build(&bench, &[]);
    let with = "--plugin mine.so --with mine --set gate=elsewhere --points points.csv";
    bench.json(&format!("track p.honami {with}"));
    let told = |bench: &Bench| {
        let runs = bench.log("p.honami", "run");
        let newest = runs.iter().max_by_key(|run| run["id"].as_u64()).unwrap();
        (newest["provenance"]["plugin_id"].clone(), newest["provenance"]["params"].clone())
    };
    let before = told(&bench);
    assert_eq!(before, (json!("org.me.mine"), json!({ "gate": "elsewhere" })));
    // It is away while another tracker works in the project, from the form, and its run is undone.
    fs::rename(bench.path("mine.so"), bench.path("away")).unwrap();
    bench.json("track p.honami --with klt --points points.csv");
    let run = r#"{"t_s":1.0,"action":"track","in":"review","frame":0}
{"t_s":1.5,"action":"accept","in":"form","frame":0}
"#;
    let undo = r#"{"t_s":9.5,"action":"undo","in":"review","frame":0,"count":2}"#;
    let session = format!("{}{run}{{\"t_s\":9.0,\"ended\":\"klt\"}}\n{undo}\n", head(&bench, &clip));
    fs::write(bench.path("s.jsonl"), session).unwrap();
    assert_eq!(bench.json("replay p.honami s.jsonl")["difference"], json!(null));
    assert_eq!(told(&bench).0, "org.honami.klt");
    // Back again it is used as before.
    fs::rename(bench.path("away"), bench.path("mine.so")).unwrap();
    let session = format!("{}{run}{{\"t_s\":9.0,\"ended\":\"mine\"}}\n", head(&bench, &clip));
    fs::write(bench.path("s.jsonl"), session).unwrap();
    let done = bench.json("replay p.honami s.jsonl --plugin mine.so");
    assert_eq!((&done["difference"], told(&bench)), (&json!(null), before), "{done}");
}
