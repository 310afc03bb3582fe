//! Hand work on skeletons: the root, planes of bones and how far they swing, kept in the project.

use honami_tests::{Bench, Row, rows};
use serde_json::Value;

/// A project of a generated clip, tracked and grouped.
fn grouped() -> Bench {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 4");
    bench
}

/// The table of a skeleton in the picture, grown so.
fn grown(bench: &Bench, name: &str, more: &str) -> (Value, Vec<Row>) {
    let answer = bench.json(&format!("grow p.honami {name} --flat {more}"));
    (answer, rows(&bench.path(name)))
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap()
}

/// Rows of a joint, in order of their frames.
fn joint(table: &[Row], joint: &str) -> Vec<Row> {
    table.iter().filter(|row| row["joint"] == joint).cloned().collect()
}

fn direction(table: &[Row], row: &Row) -> [f64; 3] {
    let from =
        table.iter().find(|from| from["frame"] == row["frame"] && from["joint"] == row["parent"]).unwrap();
    ["x_px", "y_px", "depth_px"]
        .map(|axis| (number(row, axis) - number(from, axis)) / number(row, "length_px"))
}

#[test]
fn a_bone_is_turned_out_of_the_picture_and_the_rest_stays() {
    let bench = grouped();
    let (_, before) = grown(&bench, "before.csv", "");
    // A tip that bears one group, and no other joint.
    let tip = before.iter().find(|row| row["groups"] == "3").unwrap()["joint"].clone();
    let said = bench.text("shape p.honami --group 3 --plane 90 --gain 0");
    assert!(said.trim_end().ends_with("  group 3: plane 90°, gain 0"), "{said}");
    let (answer, after) = grown(&bench, "after.csv", "");
    assert!(answer["notes"].to_string().contains("1 bone shaped by hand: group 3"), "{answer}");
    let hand = &answer["hand"]["bones"][0];
    assert_eq!((&hand["groups"], &hand["gain"]), (&serde_json::json!([3]), &0.0.into()), "{answer}");
    assert_eq!(answer["provenance"]["params"]["shaped"], "group 3: plane 90°, gain 0");
    for (was, is) in before.iter().zip(&after).filter(|(was, _)| was["joint"] != tip) {
        assert_eq!(was, is, "nothing else has changed");
    }
    // It points straight away from the camera, as stiff as what bears it: always so.
    let of_tip = joint(&after, &tip);
    assert_eq!(of_tip.len(), 40);
    for row in &of_tip {
        let [x, y, depth] = direction(&after, row);
        assert!(x.abs() < 1e-9 && y.abs() < 1e-9 && (depth - 1.0).abs() < 1e-9, "{row:?}");
        assert_eq!(row["length_px"], joint(&before, &tip)[0]["length_px"]);
    }
    // Once more than as it was seen: what bears it moves, and so it leans with that.
    bench.text("shape p.honami --group 3 --plane 0 --gain 2 --lean 20");
    let (_, swung) = grown(&bench, "swung.csv", "");
    let angles = |table: &[Row]| -> Vec<f64> {
        joint(table, &tip).iter().map(|row| number(row, "angle_rad")).collect()
    };
    let (was, is) = (angles(&before), angles(&swung));
    let wide = |angles: &[f64]| {
        angles.iter().copied().fold(f64::MIN, f64::max) - angles.iter().copied().fold(f64::MAX, f64::min)
    };
    assert!((wide(&is) - 2.0 * wide(&was)).abs() < 1e-6, "{} {}", wide(&is), wide(&was));
    let mean = |angles: &[f64]| angles.iter().sum::<f64>() / 40.0;
    let leant = mean(&is) - mean(&was);
    assert!((leant - 20_f64.to_radians()).abs() < 0.02, "{leant}");
    // As it grows, in spite of that, and for good.
    bench.text("grow p.honami --flat as.csv --as-grown");
    assert_eq!(
        std::fs::read(bench.path("as.csv")).unwrap(),
        std::fs::read(bench.path("before.csv")).unwrap()
    );
    let said = bench.text("shape p.honami --release 3");
    assert!(said.trim_end().ends_with("group 3: as it grows"), "{said}");
    grown(&bench, "back.csv", "");
    assert_eq!(
        std::fs::read(bench.path("back.csv")).unwrap(),
        std::fs::read(bench.path("before.csv")).unwrap()
    );
}

#[test]
fn hand_work_is_listed_kept_undone_and_counts_wherever_a_skeleton_does() {
    let bench = grouped();
    let listed = |bench: &Bench| bench.json("shape p.honami");
    let bare = listed(&bench);
    let bones = bare["bones"].as_array().unwrap();
    assert_eq!((bones.len(), &bare["root"]), (7, &Value::Null), "4 groups make 3 forks: {bare}");
    assert_eq!((&bones[0]["bone"], &bones[0]["level"]), (&"fork 1-4".into(), &0.into()));
    assert!(bones.iter().any(|bone| bone["length_px"].as_f64().is_some_and(|length| length > 1.0)), "{bare}");
    // The same root again is nothing to do where a bone is shaped.
    for (line, label) in [
        ("shape p.honami --root 80,115", "root placed at 80.0, 115.0"),
        ("shape p.honami --root 80,115 --group 2 --plane 30 --lean -10", "group 2: plane 30°, lean -10°"),
    ] {
        let done = bench.json(line);
        assert_eq!((&done["edits"][0]["label"], &done["edits"][1]), (&label.into(), &Value::Null), "{done}");
    }
    let text = bench.text("shape p.honami");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "root at 80.0, 115.0, by hand");
    assert!(lines.len() >= 8 && lines[1].starts_with("fork 1-4 "), "{text}");
    let shaped = lines.iter().find(|line| line.trim_start().starts_with("group 2 ")).unwrap();
    assert!(shaped.starts_with("  ") && shaped.ends_with(" px  plane 30°, lean -10°"), "{text}");
    // Wherever a skeleton is wanted; another root may be asked for.
    bench.json("grow p.honami grown.swc");
    let [swc, own] = ["grown.swc", "p.honami"]
        .map(|source| bench.json(&format!("simulate {source} --unit 0.01 --modes 3 --leaf-mass 0.1")));
    assert_eq!(swc["modes"], own["modes"], "a project stands for its skeleton as hands have it");
    let told = "root placed by hand at 80.0, 115.0; 1 bone shaped by hand: group 2";
    assert!(own["notes"].to_string().contains(told), "{own}");
    bench.json("grow p.honami plain.swc --as-grown");
    assert_ne!(
        std::fs::read(bench.path("plain.swc")).unwrap(),
        std::fs::read(bench.path("grown.swc")).unwrap()
    );
    let rooted = bench.json("grow p.honami --root 60,110");
    assert_eq!(rooted["root"], serde_json::json!([60.0, 110.0]));
    assert_eq!(rooted["hand"]["root"], Value::Null, "{rooted}");
    assert_eq!(bench.json("grow p.honami")["root"], serde_json::json!([80.0, 115.0]));
    let zeng = bench.json("grow p.honami --with zeng --copies 2 round.bvh");
    assert!(zeng["notes"].to_string().contains("1 bone shaped by hand: group 2"), "{zeng}");
    // A fork may be a group of another cut, and a group may not be there.
    let fork = bones.iter().find(|bone| bone["level"] == 1 && bone["groups"][1].is_u64()).unwrap();
    let groups: Vec<String> = fork["groups"].as_array().unwrap().iter().map(ToString::to_string).collect();
    bench.text(&format!("shape p.honami --group {} --gain 0.5", groups.join(",")));
    let two = bench.json("grow p.honami --groups 2");
    let hands = two["hand"]["bones"].as_array().unwrap();
    let own = hands.iter().find(|bone| bone["node"] == fork["node"]).unwrap();
    assert!(own["bone"].as_str().unwrap().starts_with("group ") && own["gain"] == 0.5, "{two}");
    let one = bench.json("grow p.honami --groups 1");
    let gone = "2 bones shaped by hand, of groups as they were cut or made otherwise";
    assert!(one["notes"].to_string().contains(gone), "{one}");
    // Undo is that of all edits.
    let said =
        bench.edit("p.honami", "undo\nundo\nshape-bone 3 0 45 1.5\nshape-release\nundo\nundo\n").text();
    let said: Vec<&str> = said.lines().map(|line| line.split_once("  ").unwrap().1).collect();
    assert_eq!(
        said,
        [
            &*format!("undo: {}: gain 0.5", fork["bone"].as_str().unwrap()),
            "undo: group 2: plane 30°, lean -10°",
            "group 3: lean 45°, gain 1.5",
            "root and 1 bone: as the skeleton grows",
            "undo: root and 1 bone: as the skeleton grows",
            "undo: group 3: lean 45°, gain 1.5",
        ]
    );
    assert_eq!(listed(&bench)["root"], serde_json::json!([80.0, 115.0]));
    let said = bench.edit("p.honami", "shape-release root\nshape-root 70 100\n").text();
    assert!(said.contains("root: as it grows") && said.contains("root placed at 70.0, 100.0"), "{said}");
    assert_eq!(bench.text("shape p.honami").lines().next(), Some("root at 70.0, 100.0, by hand"));
    bench.text("shape p.honami --release");
    assert_eq!(listed(&bench), bare);
}

#[test]
fn a_root_and_a_bone_are_one_edit() {
    let bench = grouped();
    let listed = |bench: &Bench| bench.json("shape p.honami");
    let bare = listed(&bench);
    let said = bench.text("shape p.honami --root 70,100 --group 2 --gain 2");
    assert!(said.trim_end().ends_with("  root placed at 70.0, 100.0; group 2: gain 2"), "{said}");
    assert!(bench.edit("p.honami", "undo\n").text().contains("undo: root placed"));
    assert_eq!(listed(&bench), bare);
}

#[test]
fn what_cannot_be_shaped_says_why() {
    let ungrouped = Bench::tracked();
    for line in ["shape p.honami", "shape p.honami --group 1 --plane 3"] {
        let ran = ungrouped.line(line);
        assert!(ran.code == Some(1) && ran.stderr.contains("cluster the tracks first"), "{ran:?}");
    }
    assert!(ungrouped.text("shape p.honami --root 1,2").contains("root placed at 1.0, 2.0"));
    let bench = grouped();
    for (line, code, wanted) in [
        ("shape p.honami --group 9 --plane 3", 1, "no bone bears 9 and nothing else: there are fork 1-4; "),
        ("shape p.honami --root 80,115 --group 9 --plane 3", 1, "no bone bears 9 and nothing else"),
        ("shape p.honami --root 80,115 --group 3 --plane 181", 1, "turned by -180 to 180 degrees, not 181"),
        ("shape p.honami --group 1-3,4,9 --plane 3", 1, "no bone bears 1-4,9 and nothing else"),
        ("shape p.honami --group 0 --plane 3", 2, "wanted groups as 3, 3,4 or 1-4, got 0"),
        ("shape p.honami --group 3", 2, "--group goes with --plane, --lean or --gain"),
        ("shape p.honami --plane 3", 2, "--group <GROUPS>"),
        ("shape p.honami --group 3 --plane 181", 1, "turned by -180 to 180 degrees, not 181"),
        ("shape p.honami --group 3 --lean nan", 1, "a bone leans by -180 to 180 degrees, not NaN"),
        ("shape p.honami --group 3 --gain -1", 1, "the gain of a bone is 0 (stiff) to 10, not -1"),
        ("shape p.honami --group 3 --gain 1", 1, "group 3: as it grows already"),
        ("shape p.honami --root 80,280.5", 2, "a root lies in the picture (160x120 pixels)"),
        ("shape p.honami --release", 1, "nothing of the skeleton was placed or shaped by hand"),
        ("shape p.honami --release root", 1, "root: as it grows already"),
        ("shape p.honami --release twig", 2, "wanted groups as 3, 3,4 or 1-4, got twig, nor root"),
        ("shape p.honami --release root --root 1,2", 2, "cannot be used with"),
        ("shape none.honami", 1, "there is no project none.honami"),
    ] {
        let ran = bench.line(line);
        assert!(ran.code == Some(code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
    }
    let edits = bench.log("p.honami", "edit");
    assert!(edits.iter().all(|edit| !edit["label"].as_str().unwrap().contains("group 3")), "{edits:?}");
    assert!(edits.iter().all(|edit| !edit["label"].as_str().unwrap().contains("80.0, 115.0")), "{edits:?}");
}
