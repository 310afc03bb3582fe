//! Every command on a small generated clip: what it does, and the keys that scripts rely on.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use honami_tests::{Bench, Row, by_track, missing, rows};
use serde_json::Value;

/// The answer has these keys; more may be added to it.
#[track_caller]
fn assert_keys(answer: &Value, keys: &str) {
    let missing: Vec<&str> = keys.split_whitespace().filter(|key| answer.get(key).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?} are not in {answer:#}");
}

/// Every kind of clip that can be generated here.
fn clips() -> Vec<&'static str> {
    let doctor = Bench::new().json("doctor");
    let findings = doctor["findings"].as_array().unwrap().iter();
    let has_ffmpeg =
        findings.into_iter().any(|finding| finding["what"] == "ffmpeg" && finding["there"] == true);
    let mut clips = vec!["folder", "clip.y4m"];
    if has_ffmpeg {
        clips.push("clip.mp4");
    } else {
        missing("ffmpeg (clip.mp4)");
    }
    clips
}

#[test]
fn the_whole_job_on_every_kind_of_clip() {
    for clip in clips() {
        let bench = Bench::new();
        let made = bench.json(&format!("synth {clip} --size 320x180 --frames 40 --leaves 120 --seed 3"));
        assert_keys(&made, "clip truth leaves branches step_px");
        let truth = made["truth"].as_str().unwrap();

        let new = bench.json(&format!("new p.honami {clip}"));
        assert_keys(&new, "frames width height fps variable_rate sha256");
        assert_eq!((&new["frames"], &new["width"], &new["height"]), (&40.into(), &320.into(), &180.into()));
        assert_eq!(new["variable_rate"], false);
        assert!((new["fps"].as_f64().unwrap() - 25.0).abs() < 1e-6, "{new}");

        let track = bench.json("track p.honami");
        assert_keys(&track, "run tracks lost frames stopped seconds");
        let n_tracks = track["tracks"].as_u64().unwrap();
        assert!(n_tracks > 20 && track["stopped"] == false, "{clip}: {track}");

        let review = bench.json("review p.honami");
        assert_keys(&review, "open total verdicts stale queue effort");
        let items = review["queue"].as_array().unwrap();
        assert_eq!(review["open"], items.len());
        items.iter().for_each(|item| {
            assert_keys(
                item,
                "track first_frame end_frame worst suspicion reasons later fb_px ncc nbr_px group_px",
            );
        });

        let cluster = bench.json("cluster p.honami --groups 5");
        assert_keys(&cluster, "clustering tracks groups outlier_frames seconds");
        let sizes = cluster["groups"].as_array().unwrap().iter().map(|size| size.as_u64().unwrap());
        assert_eq!((sizes.clone().count(), sizes.sum::<u64>()), (5, n_tracks));

        let compare = bench.json(&format!("compare p.honami --with klt --truth {truth}"));
        let [klt, nothing] = &compare["trackers"].as_array().unwrap()[..] else { panic!("{compare}") };
        assert_keys(klt, "tracker delta_avg within_1px median_px survival ok_tracks kept ms_per_frame");
        let delta_avg = |row: &Value| row["delta_avg"].as_f64().unwrap();
        assert!(
            delta_avg(klt) > delta_avg(nothing) + 0.1,
            "{clip}: tracking beats standing still: {compare}"
        );

        let spectrum = bench.json("spectrum p.honami");
        assert_keys(&spectrum, "fps nyquist_hz resolution_hz lines");
        let subjects =
            spectrum["lines"].as_array().unwrap().iter().map(|line| line["subject"].as_str().unwrap());
        assert_eq!(subjects.clone().next(), Some("all"));
        assert_eq!(subjects.filter(|subject| subject.starts_with("group")).count(), 5);

        let export = bench.json("export p.honami tracks out.csv");
        assert_keys(&export, "file tracks samples");
        assert_eq!(by_track(&rows(&bench.path("out.csv"))).len() as u64, n_tracks);
    }
}

#[test]
fn the_same_seed_gives_the_same_clip_and_the_same_tracks() {
    let tables = [1, 1, 2].map(|seed| {
        let bench = Bench::new();
        bench.synth("clip.y4m", 20, &format!("--seed {seed}"));
        bench.json("new p.honami clip.y4m");
        bench.json("track p.honami");
        bench.json("export p.honami tracks out.csv");
        fs::read_to_string(bench.path("out.csv")).unwrap()
    });
    assert_eq!(tables[0], tables[1]);
    assert_ne!(tables[0], tables[2]);
}

#[test]
fn exported_tracks_have_the_columns_of_the_table_and_true_times() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 40, "--fps 50");
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami --with klt --frames 4..30");
    let samples = bench.samples("p.honami");
    let text = fs::read_to_string(bench.path("p.honami.csv")).unwrap();
    assert_eq!(text.lines().next(), Some("track,frame,time_s,x,y,status,source,quality,fb,ncc,run"));
    for (id, track) in by_track(&samples) {
        let frames: Vec<u32> = track.iter().map(|row| row["frame"].parse().unwrap()).collect();
        assert_eq!(frames, (4..30).collect::<Vec<_>>(), "track {id}");
        for row in track {
            let (frame, time_s): (f64, f64) = (row["frame"].parse().unwrap(), row["time_s"].parse().unwrap());
            assert!((time_s - frame / 50.0).abs() < 1e-9, "{row:?}");
            assert_eq!((row["source"].as_str(), row["run"].as_str()), ("tracked", "1"));
            assert_eq!(
                row["fb"].is_empty(),
                row["frame"] == "4",
                "every step but the first has its error: {row:?}"
            );
        }
    }
}

#[test]
fn exported_tracks_have_the_spectrum_of_the_project() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 80, "--wind wind");
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami");
    bench.json("export p.honami tracks out.csv");
    let [project, table] = ["p.honami", "out.csv"].map(|source| bench.json(&format!("spectrum {source}")));
    assert_eq!(project["lines"], table["lines"]);
    let n_peaks =
        project["lines"].as_array().unwrap().iter().flat_map(|line| line["peaks"].as_array().unwrap());
    assert!(n_peaks.count() > 5, "there is something to compare: {project}");
}

#[test]
fn features_come_from_where_they_are_asked_for() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 12, "");
    fs::write(bench.path("points.csv"), "id,x,y,frame\n7,80,60,0\n9,40.5,30.25,3\n").unwrap();
    write_mask(&bench.path("mask.bmp"));
    let inside = |row: &Row, [x, y, w, h]: [f64; 4]| {
        let at = |column: &str| row[column].parse::<f64>().unwrap();
        (x..x + w).contains(&(at("x") + 0.5)) && (y..y + h).contains(&(at("y") + 0.5))
    };
    // Options, and the rectangle of pixels in which all features begin; a pixel reaches half a pixel around its centre.
    let table = [
        ("--detect", [0.0, 0.0, 160.0, 120.0]),
        ("--detect klt --region 20,10,60,50", [20.0, 10.0, 60.0, 50.0]),
        ("--mask mask.bmp", [80.0, 0.0, 80.0, 120.0]),
        ("--points points.csv", [40.0, 30.0, 41.0, 31.0]),
    ];
    let mut n_found = Vec::new();
    for (options, area) in table {
        bench.json("new p.honami clip.y4m");
        bench.json(&format!("track p.honami {options}"));
        let samples = bench.samples("p.honami");
        let tracks = by_track(&samples);
        for rows in tracks.values() {
            assert!(inside(rows[0], area), "{options}: {:?}", rows[0]);
        }
        if options.starts_with("--points") {
            let starts: Vec<_> = tracks.iter().map(|(id, rows)| (*id, rows[0]["frame"].as_str())).collect();
            assert_eq!(starts, [(7, "0"), (9, "3")]);
        }
        n_found.push(tracks.len());
        fs::remove_file(bench.path("p.honami")).unwrap();
    }
    assert!(
        n_found[0] > n_found[1] && n_found[0] > n_found[2] && n_found[1] > 0 && n_found[2] > 0,
        "{n_found:?}"
    );
}

/// A picture of 160x120 pixels, black in its left half and white in its right.
fn write_mask(path: &Path) {
    let header: [u32; 13] = [54 + 3 * 160 * 120, 0, 54, 40, 160, 120, 1 | 24 << 16, 0, 0, 0, 0, 0, 0];
    let line: Vec<u8> = (0..3 * 160).map(|byte| if byte < 3 * 80 { 0 } else { 255 }).collect();
    let header = header.iter().flat_map(|word| word.to_le_bytes());
    fs::write(path, [b"BM".to_vec(), header.collect(), line.repeat(120)].concat()).unwrap();
}

#[test]
fn new_features_are_found_on_the_way() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 30, "--wind storm");
    bench.json("new p.honami clip.y4m");
    bench.json(
        "track p.honami --with klt --detect --every 10 --set lose_fb=0.5 --set distance=4 --frames 2..",
    );
    let samples = bench.samples("p.honami");
    let starts = by_track(&samples).into_values().map(|rows| rows[0]["frame"].parse::<u32>().unwrap());
    let starts: BTreeSet<u32> = starts.collect();
    assert!(starts.len() > 1 && starts.iter().all(|frame| [2, 12, 22].contains(frame)), "{starts:?}");
}

/// Particles are tracks of their own: newborn (5) in their first frame, tracked (1) to their last, numbered after the
/// features.
#[test]
fn particles_are_born_into_tracks_of_their_own() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 24, "");
    bench.json("new p.honami clip.y4m");
    let words = "track p.honami --with particles --set life=6 --set max_features=40";
    let ran = bench.json(words);
    let samples = bench.samples("p.honami");
    let tracks = by_track(&samples);
    let is_newborn = |rows: &&Vec<&Row>| rows[0]["status"] == "5";
    let (born, found): (Vec<_>, Vec<_>) = tracks.values().partition(is_newborn);
    assert_eq!(
        (ran["tracks"].as_u64(), ran["born"].as_u64()),
        (Some(tracks.len() as u64), Some(born.len() as u64))
    );
    assert_eq!(found.len(), 40);
    assert!(found.iter().all(|rows| rows.len() == 24) && ran["lost"].as_u64() < Some(40), "{ran}");
    assert!(born.len() > 100, "{ran}");
    let mut first_frames = BTreeSet::new();
    for rows in &born {
        assert!((1..=6).contains(&rows.len()), "{} frames", rows.len());
        assert!(rows[1..].iter().all(|row| row["status"] == "1"));
        first_frames.insert(rows[0]["frame"].parse::<u32>().unwrap());
    }
    assert_eq!(first_frames.len(), 24, "some are born in each frame: {first_frames:?}");
    // No number is set aside for a birth that never came.
    assert_eq!(tracks.keys().copied().collect::<Vec<_>>(), (0..tracks.len() as u32).collect::<Vec<_>>());

    // Where features may be found, and nowhere else.
    bench.json("new r.honami clip.y4m");
    bench.json("track r.honami --with particles --region 20,10,60,50 --set spacing=8");
    let samples = bench.samples("r.honami");
    for rows in by_track(&samples).values() {
        let [x, y] = ["x", "y"].map(|column| rows[0][column].parse::<f64>().unwrap());
        assert!((19.5..=79.5).contains(&x) && (9.5..=59.5).contains(&y), "{:?}", rows[0]);
    }

    // Tracks that are there already are followed without births.
    bench.json("new q.honami clip.y4m");
    bench.json("track q.honami --set max_features=5");
    let again = bench.json("track q.honami --with particles");
    assert_eq!((again["tracks"].as_u64(), again["born"].as_u64()), (Some(5), Some(0)), "{again}");
}

#[test]
fn parameters_are_kept_with_the_run() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 8, "");
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami --with org.honami.klt --set method=harris --set quality=0.05 --set radius=6");
    bench.json("cluster p.honami --with movement --set linkage=average");
    let (runs, clusterings) = (bench.log("p.honami", "run"), bench.log("p.honami", "clustering"));
    assert_eq!((runs.len(), clusterings.len()), (1, 1));
    let made = &runs[0]["provenance"];
    assert_keys(
        made,
        "plugin_id plugin_version plugin_sha256 abi params seed input_revision sandbox simd date",
    );
    assert_eq!(made["plugin_id"], "org.honami.klt");
    assert_eq!(
        made["simd"],
        honami_vision::simd::level(),
        "the level that the plugin's kernels take here, by its name"
    );
    let params = &made["params"];
    assert_eq!(
        (&params["method"], &params["quality"], &params["radius"]),
        (&"harris".into(), &0.05.into(), &6.into())
    );
    assert_eq!(params["levels"], 4, "what was not set is kept, too");
    assert_eq!(clusterings[0]["provenance"]["params"]["linkage"], "average");
    let text = bench.text("log p.honami");
    for words in ["org.honami.klt", "method=harris", "radius=6", "project made", "linkage=average"] {
        assert!(text.contains(words), "{words} is not in:\n{text}");
    }
}

#[test]
fn plugins_say_what_they_are_and_take() {
    let bench = Bench::new();
    let list = bench.json("plugin list");
    let plugins = list["plugins"].as_array().unwrap();
    for (name, kind) in [("klt", "tracker"), ("movement", "clusterer")] {
        let plugin = plugins.iter().find(|plugin| plugin["short_name"] == name).unwrap();
        assert_eq!((&plugin["kind"], &plugin["trust"]), (&kind.into(), &"shipped".into()));
        let info = bench.json(&format!("plugin info {name}"));
        assert_keys(&info, "id short_name kind version abi library sha256 interfaces params doc cite");
        let text = bench.text(&format!("plugin info {}", info["id"].as_str().unwrap()));
        for param in info["params"].as_array().unwrap() {
            assert!(text.contains(param["id"].as_str().unwrap()), "{param} is not in:\n{text}");
        }
        assert!(bench.text("plugin list").contains(name));
        assert_eq!((&info["hosting"], &info["sandbox"]), (&"in-process".into(), &"none".into()));
    }
}

#[test]
fn doctor_manual_and_completions_know_every_command() {
    let bench = Bench::new();
    let doctor = bench.json("doctor");
    for finding in doctor["findings"].as_array().unwrap() {
        assert_keys(finding, "what there found adds advice");
    }
    bench.json("man pages");
    let help = bench.text("--help");
    let bash = bench.text("completions bash");
    let commands = "new track cluster edit compare components spectrum export synth demo plugin log doctor completions man";
    for command in commands.split(' ') {
        assert!(help.contains(&format!("\n  {command} ")), "{command} is not in:\n{help}");
        assert!(bash.contains(command), "{command} is not in the completions");
        let page = fs::read_to_string(bench.path(&format!("pages/honami-{command}.1"))).unwrap();
        assert!(page.contains(".SH NAME"), "{command}: {page}");
        assert!(!bench.text(&format!("{command} --help")).is_empty());
    }
    for shell in ["zsh", "fish", "elvish", "powershell"] {
        assert!(bench.text(&format!("completions {shell}")).contains("honami"));
    }
    assert!(bench.text("--version").starts_with("honami "));
}

#[test]
fn the_demo_does_the_whole_job() {
    let bench = Bench::new();
    let demo = bench.json("demo --headless --folder demo");
    assert_keys(&demo, "project clip truth tracks groups");
    assert!(demo["tracks"].as_u64().unwrap() > 50 && demo["groups"].as_u64().unwrap() > 1, "{demo}");
    assert_eq!(bench.json("demo --headless --folder demo"), demo, "a second demo finds its work done");
    assert_eq!(bench.log("demo/shrub.honami", "run").len(), 1);
}

#[test]
fn a_run_over_another_says_how_to_go_back() {
    let bench = Bench::tracked();
    let text = bench.text("track p.honami --with klt --set radius=5");
    let [run, shown] = &text.lines().collect::<Vec<_>>()[..] else { panic!("{text}") };
    assert!(run.contains("% of samples seen; at the end"), "{run}");
    assert_eq!(*shown, "run 2 is shown now instead of run 1; back: echo undo | honami edit p.honami");
    // A tracker that fails before its first frame leaves no run, and no number that says nothing.
    let ran = bench.line("track p.honami --with onnx");
    assert_eq!((ran.code, ran.stdout.as_str(), ran.stderr.lines().count()), (Some(1), "", 1), "{ran:?}");
    assert!(ran.stderr.contains("no net is set") && !ran.stderr.contains("(failed"), "{}", ran.stderr);
    assert!(!bench.text("log p.honami").contains("run 3"));
}
