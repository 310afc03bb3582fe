//! Tracks go out and come in: through the project, in every format, and through other people's readers.

use std::fs;
use std::process::Command;

use honami_tests::{Bench, Row, by_track, root, rows, skipped};
use serde_json::Value;

/// Word and ending of every format.
const FORMATS: [(&str, &str); 8] = [
    ("csv", "csv"),
    ("parquet", "parquet"),
    ("cvat", "xml"),
    ("deeplabcut", "csv"),
    ("dltdv", "csv"),
    ("trackmate", "xml"),
    ("tapvid", "npz"),
    ("mot", "txt"),
];

/// A tracked clip with hand work: key-frames, a name is not needed, and lost tracks.
fn corrected() -> Bench {
    let bench = Bench::tracked();
    let script = "key 0 7 50.25 40.5\nkey 0 20 52 41\nkey 1 0 30 30\nadd 3 80 60\n";
    assert_eq!(bench.edit("p.honami", script).code, Some(0));
    bench
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn is_seen(row: &&Row) -> bool {
    row["status"] == "1" || row["status"] == "5"
}

#[test]
fn every_format_goes_out_and_comes_back() {
    let bench = corrected();
    let before = bench.samples("p.honami");
    for (format, ending) in FORMATS {
        let file = format!("{format}.{ending}");
        let out = bench.json(&format!("export p.honami tracks {file} --format {format}"));
        assert_eq!((&out["format"], &out["samples"]), (&format.into(), &before.len().into()));
        let project = format!("{format}.honami");
        bench.json(&format!("new {project} clip.y4m"));
        let read = bench.json(&format!("import {project} {file}"));
        assert_eq!((&read["format"], &read["beyond_clip"]), (&format.into(), &0.into()));
        assert_eq!(read["tracks"], by_track(&before).len(), "{format}");
        let after = bench.samples(&project);
        let (before, after) = (by_track(&before), by_track(&after));
        for (was, is) in before.values().zip(after.values()) {
            for was in was.iter().copied().filter(is_seen) {
                let is = is.iter().find(|row| row["frame"] == was["frame"]).unwrap();
                let close = |column| (number(was, column) - number(is, column)).abs() < 1e-4;
                assert!(close("x") && close("y"), "{format}: {was:?} came back as {is:?}");
                assert!(is["source"] == "imported" || is["source"] == was["source"], "{format}: {is:?}");
            }
        }
        let keeps_keys = ["csv", "parquet", "cvat"].contains(&format);
        assert_eq!(read["key_frames"], if keeps_keys { 4 } else { 0 }, "{format}");
        let lost: Vec<&str> =
            out["not_kept"].as_array().unwrap().iter().map(|loss| loss["what"].as_str().unwrap()).collect();
        assert_eq!(lost.contains(&"key-frames"), !keeps_keys, "{format}: {lost:?}");
    }
}

#[test]
fn the_own_table_comes_back_to_the_bit() {
    let bench = corrected();
    for ending in ["csv", "parquet"] {
        let (table, project) = (format!("t.{ending}"), format!("{ending}.honami"));
        bench.json(&format!("export p.honami tracks {table}"));
        bench.json(&format!("new {project} clip.y4m"));
        bench.json(&format!("import {project} {table}"));
        for (was, is) in bench.samples("p.honami").iter().zip(bench.samples(&project)) {
            for column in ["track", "frame", "time_s", "x", "y", "status", "fb", "ncc"] {
                assert_eq!(was[column], is[column], "{ending} {column}: {was:?} {is:?}");
            }
            assert_eq!(was["source"] == "key", is["source"] == "key", "{ending}");
        }
    }
}

#[test]
fn an_import_is_one_run_and_one_edit() {
    let bench = corrected();
    let before = bench.samples("p.honami");
    bench.json("export p.honami tracks t.xml --format cvat --tracks 0,1");
    let read = bench.json("import p.honami t.xml");
    assert_eq!(
        (&read["tracks"], &read["renumbered"], &read["key_frames"]),
        (&2.into(), &2.into(), &3.into())
    );
    let runs = bench.log("p.honami", "run");
    let made = &runs[1]["provenance"];
    assert_eq!((&made["what"], &made["params"]["file"]), (&"import".into(), &"t.xml".into()));
    assert_eq!(made["plugin_sha256"].as_str().unwrap().len(), 64);
    assert_eq!(by_track(&bench.samples("p.honami")).len(), by_track(&before).len() + 2);
    assert_eq!(bench.edit("p.honami", "undo").code, Some(0));
    assert_eq!(bench.samples("p.honami"), before);
    assert_eq!(bench.edit("p.honami", "redo").code, Some(0));
    assert_eq!(by_track(&bench.samples("p.honami")).len(), by_track(&before).len() + 2);
}

#[test]
fn what_does_not_fit_the_clip_is_counted() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 10, "");
    bench.json("new p.honami clip.y4m");
    fs::write(bench.path("t.txt"), "1,5,1,1,1,1,1\n2,5,500,1,1,1,1\n11,5,1,1,1,1,1\n99,6,1,1,1,1,1\n")
        .unwrap();
    let read = bench.json("import p.honami t.txt");
    let counts =
        ["tracks", "samples", "beyond_clip", "outside_picture"].map(|key| read[key].as_u64().unwrap());
    assert_eq!(counts, [1, 2, 2, 1]);
    assert_eq!(
        by_track(&bench.samples("p.honami")).keys().collect::<Vec<_>>(),
        [&5],
        "its own number is free"
    );
    let text = bench.text("import p.honami t.txt");
    for words in ["1 track has a new number", "2 samples left out", "1 sample lies outside the picture"] {
        assert!(text.contains(words), "{words} is not in:\n{text}");
    }
    fs::write(bench.path("late.txt"), "11,5,1,1,1,1,1\n").unwrap();
    let late = bench.line("import p.honami late.txt");
    assert!(late.code == Some(1) && late.stderr.contains("frames 0..10"), "{late:?}");
}

#[test]
fn a_file_of_other_pictures_is_scaled_or_refused() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 10, "");
    bench.json("new p.honami clip.y4m");
    let file = "<annotations><meta><original_size><width>320</width><height>240</height></original_size></meta>\
                <track id=\"0\" label=\"tip\"><points frame=\"0\" keyframe=\"1\" outside=\"0\" occluded=\"0\" \
                points=\"1,1\"/></track></annotations>";
    fs::write(bench.path("t.xml"), file).unwrap();
    let refused = bench.line("import p.honami t.xml");
    assert!(refused.code == Some(1) && refused.stderr.contains("--size 320x240"), "{refused:?}");
    assert!(bench.log("p.honami", "run").is_empty(), "nothing is left behind");
    bench.json("import p.honami t.xml --size 320x240");
    let samples = bench.samples("p.honami");
    assert_eq!(
        (samples[0]["x"].as_str(), samples[0]["y"].as_str()),
        ("0", "0"),
        "half of (1, 1) from the corner"
    );
}

#[test]
fn tracks_and_groups_are_chosen() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 3");
    bench.json("export p.honami groups g.csv");
    let groups = rows(&bench.path("g.csv"));
    bench.json("export p.honami tracks t.csv --groups 1,3");
    let wanted: Vec<u32> =
        groups.iter().filter(|row| row["group"] != "2").map(|row| row["track"].parse().unwrap()).collect();
    assert_eq!(by_track(&rows(&bench.path("t.csv"))).into_keys().collect::<Vec<_>>(), wanted);
    bench.json("export p.honami tracks t.csv --tracks 2,4-6");
    assert_eq!(by_track(&rows(&bench.path("t.csv"))).into_keys().collect::<Vec<_>>(), [2, 4, 5, 6]);
}

/// Tracks with every status, a key-frame every nine frames.
fn of_every_status() -> Bench {
    let bench = Bench::new();
    bench.synth("clip.y4m", 40, "");
    bench.json("new p.honami clip.y4m");
    let mut table = "track,frame,x,y,status,source,fb,ncc\n".to_owned();
    for track in 0..6 {
        for frame in 2 + track..38 {
            let status = [1, 1, 2, 0, 3, 1, 4, 5][(frame * 3 + track) % 8];
            let source = if frame % 9 == 0 { "key" } else { "tracked" };
            let (x, y) = (10.0 + frame as f32 * 0.37, 20.0 + track as f32 * 9.01);
            table += &format!("{track},{frame},{x},{y},{status},{source},0.25,0.5\n");
        }
    }
    fs::write(bench.path("given.csv"), table).unwrap();
    bench.json("import p.honami given.csv");
    bench
}

/// Of five tracks two are seen once, and then all are.
#[test]
fn who_is_seen_too_briefly_to_be_grouped_is_counted() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 40, "");
    for (project, n_moving) in [("some.honami", 3), ("none.honami", 0)] {
        bench.json(&format!("new {project} clip.y4m"));
        let mut table = "track,frame,x,y\n".to_owned();
        for track in 0..5_u32 {
            for frame in 0..if track < n_moving { 30 } else { 1 } {
                let x = 20.0 + 9.0 * f64::from(track) + (0.4 * f64::from(frame * (track + 1))).sin();
                table += &format!("{track},{frame},{x},{}\n", 10 + 20 * track);
            }
        }
        fs::write(bench.path("given.csv"), table).unwrap();
        bench.json(&format!("import {project} given.csv"));
    }
    let said = bench.json("cluster some.honami");
    assert_eq!(said["tracks"], 3);
    let told = "2 tracks are seen in fewer than two frames and are in no group";
    assert!(said["warnings"].as_array().unwrap().contains(&told.into()), "{said}");
    let none = bench.line("cluster none.honami");
    assert!(none.code == Some(1) && none.stderr.contains("no track is seen in two frames"), "{none:?}");
}

/// Readers of other people, each with what it needs: `HONAMI_PYTHON` names a Python that has them.
#[test]
fn other_peoples_readers_read_what_is_written() {
    let python = std::env::var("HONAMI_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = root().join("tests/peers/readers.py");
    let bench = of_every_status();
    bench.json("export p.honami tracks table.csv");
    for (format, ending) in FORMATS {
        bench.json(&format!("export p.honami tracks {format}.{ending} --format {format}"));
    }
    let run = |what: &str| Command::new(&python).arg(&script).arg(what).current_dir(bench.path("")).output();
    let Ok(listed) = run("list") else { return skipped("python3 (other people's readers)") };
    let readers: Value = serde_json::from_slice(&listed.stdout).unwrap();
    for reader in readers.as_array().unwrap() {
        let (name, needs) = (reader["name"].as_str().unwrap(), reader["needs"].as_str().unwrap());
        if reader["there"] != true {
            skipped(&format!("{needs} ({name})"));
            continue;
        }
        let output = run(name).unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
    // What a reader of TrackMate's whole file says of it is what honami imports.
    if bench.path("whole.json").exists() {
        let theirs: Value = serde_json::from_slice(&fs::read(bench.path("whole.json")).unwrap()).unwrap();
        bench.json("new whole.honami clip.y4m");
        bench.json("import whole.honami whole.xml");
        let mut ours = bench.samples("whole.honami");
        ours.retain(|row| is_seen(&row));
        assert_eq!(ours.len(), theirs.as_array().unwrap().len());
        for spot in theirs.as_array().unwrap() {
            let at = |row: &&Row| {
                number(row, "frame") - spot[0].as_f64().unwrap() == 0.0
                    && (number(row, "x") - spot[1].as_f64().unwrap()).abs() < 1e-4
                    && (number(row, "y") - spot[2].as_f64().unwrap()).abs() < 1e-4
            };
            assert!(ours.iter().any(|row| at(&row)), "{spot} is not in {ours:?}");
        }
    }
}

#[test]
fn nothing_is_written_over_a_project_or_a_clip() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 4, "--leaves 20");
    let _said = bench.text("new p.honami clip.y4m");
    let _said = bench.text("track p.honami --with klt");
    for (line, file, what) in [
        ("export p.honami tracks p.honami --format csv", "p.honami", "a project"),
        ("export p.honami tracks clip.y4m --format csv", "clip.y4m", "a clip"),
        ("compare p.honami --with klt --quick --svg p.honami", "p.honami", "a project"),
        ("compare clip.y4m --with klt --quick --svg clip.y4m", "clip.y4m", "a clip"),
    ] {
        let before = std::fs::read(bench.path(file)).unwrap();
        let ran = bench.line(line);
        let wanted = format!("is {what}, and honami does not write over it");
        assert!(ran.code != Some(0) && ran.stderr.contains(&wanted), "{line}: {ran:?}");
        assert_eq!(std::fs::read(bench.path(file)).unwrap(), before, "{line}");
    }
}
