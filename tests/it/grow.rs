//! Skeletons from the tracks of a generated clip, through the real program.

use honami_tests::{Bench, python_with, root, rows};

/// A project of a generated clip, tracked and grouped.
fn grouped() -> Bench {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 6");
    bench
}

#[test]
fn a_skeleton_moves_as_the_plant_does_and_its_bones_keep_their_length() {
    let bench = grouped();
    let answer = bench
        .json("grow p.honami motion.bvh joints.csv rest.swc --flat --truth clip.truth.csv --leaves l.csv");
    let truth = &answer["truth"];
    let (off, still) = (truth["median_px"].as_f64().unwrap(), truth["still_px"].as_f64().unwrap());
    assert!(off < 0.6 * still, "{answer}");
    let number = |text: &str| text.parse::<f64>().unwrap();
    let table = rows(&bench.path("joints.csv"));
    let n_joints = answer["joints"].as_u64().unwrap() as usize;
    assert_eq!(table.len(), 40 * n_joints);
    for frame in table.chunks(n_joints) {
        for row in &frame[1..] {
            let from = &frame[row["parent"].parse::<usize>().unwrap()];
            let along = |axis: &str| number(&row[axis]) - number(&from[axis]);
            let length = along("x_px").hypot(along("y_px")).hypot(along("depth_px"));
            assert!((length - number(&row["length_px"])).abs() < 1e-6, "{row:?}");
        }
    }
    let n_leaves = rows(&bench.path("l.csv")).len();
    assert_eq!(n_leaves % (40 * answer["tracks"].as_u64().unwrap() as usize), 0);
    // What is at rest is a plant, and swings.
    let plant = bench.json("simulate rest.swc --unit 0.01 --modes 3");
    assert_eq!(plant["nodes"].as_u64().unwrap() as usize, n_joints);
    bench.json("grow p.honami grown.swc");
    let [grown, same] = ["grown.swc", "p.honami"]
        .map(|source| bench.json(&format!("simulate {source} --unit 0.01 --modes 3 --leaf-mass 0.1")));
    assert_eq!(grown["modes"], same["modes"], "a project stands for its skeleton");
    assert!(
        same["notes"].to_string().contains("`honami grow` makes of 6 groups, a pixel taken as 0.01 m"),
        "{same}"
    );
    assert!(same["notes"].to_string().contains("pipe model"), "{same}");
    let deep = bench.json("grow p.honami deep.bvh --root 80,115 --groups 4 --loop");
    assert_eq!((&deep["groups"], &deep["root"]), (&4.into(), &serde_json::json!([80.0, 115.0])));
    let frames = deep["frames"].as_array().unwrap();
    assert!(frames[1].as_u64().unwrap() - frames[0].as_u64().unwrap() >= 20, "{deep}");
    assert!(bench.text("grow p.honami").contains("in depth, copies: 2"));
    let made = &answer["provenance"];
    assert_eq!(
        (&made["plugin_id"], &made["params"]["flat"]),
        (&"org.honami.diener".into(), &true.into()),
        "{made}"
    );
}

#[test]
fn siblings_turn_otherwise_on_bones_of_the_same_length() {
    let bench = grouped();
    let line = "grow p.honami m.bvh j.csv --flat --groups 9 --siblings 2 --seed 5 --level 1 --leaves l.csv";
    let answer = bench.json(line);
    let siblings = &answer["siblings"];
    let files = ["m-1.bvh", "j-1.csv", "l-1.csv", "m-2.bvh", "j-2.csv", "l-2.csv"];
    assert_eq!(siblings["files"], serde_json::json!(files));
    let [source, first, second] = ["j.csv", "j-1.csv", "j-2.csv"].map(|name| rows(&bench.path(name)));
    assert_eq!((source.len(), first.len()), (second.len(), second.len()));
    let mut n_turned = 0;
    for ((was, is), other) in source.iter().zip(&first).zip(&second) {
        assert_eq!(
            [&was["joint"], &was["parent"], &was["groups"], &was["length_px"]].map(String::as_str),
            [&is["joint"], &is["parent"], &is["groups"], &is["length_px"]]
        );
        n_turned += usize::from(was["angle_rad"] != is["angle_rad"] && is["angle_rad"] != other["angle_rad"]);
    }
    let n_drawn: u64 =
        siblings["levels"].as_array().unwrap().iter().map(|level| level["bones"].as_u64().unwrap()).sum();
    assert_eq!(n_turned as u64, 40 * n_drawn, "{siblings}");
    assert_eq!(rows(&bench.path("l.csv")).len(), rows(&bench.path("l-2.csv")).len());
    let read = |name: &str| std::fs::read(bench.path(name)).unwrap();
    let wanted = read("m-1.bvh");
    bench.text("grow p.honami m.bvh --flat --groups 9 --siblings 1 --seed 5 --level 1");
    assert!(read("m-1.bvh") == wanted && wanted != read("m-2.bvh"), "known by seed and number");
    assert!(bench.text("grow p.honami m.bvh --siblings 1").contains("siblings: 1 of seed 1"));
}

/// A picture as large as the clip, white in these columns.
fn paint(bench: &Bench, name: &str, white: std::ops::Range<usize>) {
    let mut image = b"YUV4MPEG2 W160 H120 F25:1 Cmono\nFRAME\n".to_vec();
    image.extend((0..160 * 120).map(|k| if white.contains(&(k % 160)) { 235 } else { 16 }));
    std::fs::write(bench.path(name), image).unwrap();
}

#[test]
fn copies_stand_round_the_trunk_and_fill_an_envelope() {
    let bench = grouped();
    let flat = bench.json("grow p.honami f.csv --with zeng --groups 9 --flat --truth clip.truth.csv");
    let deep = bench.json("grow p.honami d.csv --with zeng --groups 9 --copies 4 --truth clip.truth.csv");
    let number = |answer: &serde_json::Value, name: &str| answer[name].as_u64().unwrap() as usize;
    let n_trunk = (4 * number(&flat, "joints") - number(&deep, "joints")) / 3;
    assert_eq!(number(&deep, "joints"), n_trunk + 4 * (number(&flat, "joints") - n_trunk), "{deep}");
    assert!((1..4).contains(&n_trunk), "{flat} {deep}");
    let of = |answer: &serde_json::Value, name: &str| answer["truth"][name].as_f64().unwrap();
    for name in ["median_px", "still_px", "motion_px"] {
        assert!((of(&flat, name) - of(&deep, name)).abs() < 1e-6, "seen from the front they are one: {name}");
    }
    let sways = bench.json("grow p.honami --groups 9 --flat --truth clip.truth.csv");
    assert!(of(&flat, "motion_px") < 0.6 * of(&sways, "still_px"), "{flat} {sways}");
    let depths: Vec<f64> =
        rows(&bench.path("d.csv")).iter().map(|row| row["depth_px"].parse().unwrap()).collect();
    assert!(depths.iter().any(|depth| *depth > 5.0) && depths.iter().any(|depth| *depth < -5.0));
    paint(&bench, "all.y4m", 0..160);
    paint(&bench, "some.y4m", 60..100);
    paint(&bench, "none.y4m", 0..0);
    let line = "grow p.honami --with zeng --groups 9 --envelope";
    let all = bench.json(&format!("{line} all.y4m"));
    assert!(number(&all, "left_out") == 0 && all["notes"].to_string().contains("none was cut"), "{all}");
    let some = bench.json(&format!("{line} some.y4m"));
    assert!(number(&some, "left_out") > 0 && number(&some, "joints") < number(&all, "joints"), "{some}");
    let none = bench.line(&format!("{line} none.y4m"));
    assert!(none.code == Some(1) && none.stderr.contains("paint white where branches may be"), "{none:?}");
    bench.json("grow p.honami s.bvh --with zeng --groups 9 --siblings 2");
    assert!(bench.path("s-2.bvh").exists(), "siblings of either method");
}

/// Another reader of motion capture finds joints where the table has them, to 1e-4 of a pixel, where it is installed.
#[test]
fn another_program_reads_the_same_motion() {
    let Some(python) = python_with("bvhio") else { return };
    let python = |args: &[&str]| std::process::Command::new(&python).args(args).output();
    let bench = grouped();
    let script = root().join("tests/peers/bvh_bvhio.py");
    for more in ["--flat", "--groups 9", "--loop"] {
        bench.text(&format!("grow p.honami motion.bvh joints.csv {more}"));
        let files = [bench.path("motion.bvh"), bench.path("joints.csv")];
        let output =
            python(&[script.to_str().unwrap(), files[0].to_str().unwrap(), files[1].to_str().unwrap()])
                .unwrap();
        assert!(output.status.success(), "{more}: {output:?}");
    }
}

/// What was never tracked is in no file: neither as frames that stand still, of which loops would be, nor as creeping.
#[test]
fn only_what_was_tracked_grows() {
    let bench = Bench::new();
    bench.synth("clip.y4m", 60, "");
    bench.json("new p.honami clip.y4m");
    bench.json("track p.honami --with klt --frames 15..40");
    bench.json("cluster p.honami --groups 6");
    let answer = bench.json("grow p.honami m.bvh j.csv --flat --leaves l.csv --truth clip.truth.csv");
    assert_eq!(answer["frames"], serde_json::json!([15, 40]));
    assert_eq!(answer["truth"]["frames"], answer["frames"]);
    assert!(std::fs::read_to_string(bench.path("m.bvh")).unwrap().contains("\nFrames: 25\n"));
    for name in ["j.csv", "l.csv"] {
        let table = rows(&bench.path(name));
        let frames: std::collections::BTreeSet<u32> =
            table.iter().map(|row| row["frame"].parse().unwrap()).collect();
        assert!(frames.into_iter().eq(15..40), "{name}");
        let time = table[0]["time_s"].parse::<f64>().unwrap();
        assert!((time - 15.0 / 25.0).abs() < 1e-9, "{name} begins at {time} s");
    }
    let frames_of = |answer: &serde_json::Value| [0, 1].map(|k| answer["frames"][k].as_u64().unwrap());
    let [first, end] = frames_of(&bench.json("grow p.honami loop.csv --loop --flat"));
    assert!(15 <= first && end < 40 && end - first >= 13, "{first}..{end}");
    assert_eq!(rows(&bench.path("loop.csv"))[0]["frame"], first.to_string());
    // A truth of fewer frames is compared as far as it goes.
    let truth = std::fs::read_to_string(bench.path("clip.truth.csv")).unwrap();
    let until = |end: u32| {
        let is_kept = |line: &&str| {
            line.split(',').nth(1).and_then(|word| word.parse().ok()).is_none_or(|frame: u32| frame < end)
        };
        truth.lines().filter(is_kept).map(|line| format!("{line}\n")).collect::<String>()
    };
    std::fs::write(bench.path("half.csv"), until(30)).unwrap();
    std::fs::write(bench.path("none.csv"), until(10)).unwrap();
    assert!(bench.text("grow p.honami --truth half.csv").contains("in frames 15-29 that both have"));
    let none = bench.line("grow p.honami --truth none.csv");
    assert!(
        none.code == Some(1)
            && none.stderr.contains("the truth has frames 0..10, and the skeleton moves through 15..40"),
        "{none:?}"
    );
}

#[test]
fn what_cannot_grow_says_why() {
    let bench = Bench::tracked();
    let ungrouped = bench.line("grow p.honami out.bvh");
    assert!(
        ungrouped.code == Some(1) && ungrouped.stderr.contains("cluster the tracks first"),
        "{ungrouped:?}"
    );
    bench.json("cluster p.honami");
    let cases = [
        (
            "grow p.honami out.obj",
            2,
            "skeletons are written as .bvh, .csv, .swc, .glb, .usda, .pc2 or as frames, out/%04d.ply or out/%04d.obj, not as out.obj",
        ),
        ("grow p.honami mv/%04d.glb", 2, "or out/%04d.obj, not as mv/%04d.glb"),
        ("grow p.honami a.glb a-1.glb --siblings 1", 2, "a.glb and a-1.glb would both be written to"),
        ("grow p.honami --leaves out.obj", 2, "leaves are written as .csv, not as out.obj"),
        ("grow p.honami --root 3", 2, "wanted a place as X,Y in pixels, got 3"),
        ("grow p.honami --root nan,1", 2, "wanted a place as X,Y"),
        ("grow p.honami --root -5000,9e9", 2, "up to 160 pixels off it, not at -5000,9e9: X,Y are right"),
        ("grow p.honami --root 1e300,1", 2, "not at 1e300,1: X,Y are right"),
        ("grow p.honami --root 80,280.5", 2, "a root lies in the picture (160x120 pixels)"),
        ("grow p.honami --groups 0", 2, "groups, not 0"),
        ("grow p.honami --groups 100000", 2, "groups, not 100000"),
        ("grow p.honami --truth p.honami", 1, "p.honami"),
        (
            "grow p.honami --copies 2",
            2,
            "--copies is of plugins with a parameter of that name, and diener has none",
        ),
        ("grow p.honami --with zeng --shift 1", 2, "shift: wanted a number, 0 to 0.999"),
        ("grow p.honami --with nobody", 2, "there is no structure \"nobody\"; there are: diener, zeng"),
        ("grow p.honami --envelope clip.y4m", 1, "it knows no envelope"),
        ("grow p.honami --envelope none.png", 1, "it knows no envelope"),
        ("grow p.honami --with zeng --envelope none.png", 1, "none.png"),
        (
            "grow p.honami --with zeng --envelope clip.y4m",
            1,
            "one picture is wanted that says where, and this has 40: ",
        ),
        ("grow p.honami out.bvh --siblings 0", 2, "0 is not in 1..=9999"),
        ("grow p.honami --siblings 2", 2, "name its file, as out.bvh"),
        ("grow p.honami out.bvh --seed 2", 2, "--seed goes with --siblings or --branches"),
        (
            "grow p.honami out.bvh --flat --siblings 2 --groups 1",
            1,
            "no two bones are of one level from 0 on",
        ),
        ("grow p.honami out.bvh --siblings 2 --level 70", 2, "no two bones are of one level from 70 on"),
        ("grow p.honami out.bvh --siblings 2 --threshold 1e6", 2, "is as dense as 1000000 per radian"),
        ("grow p.honami out.bvh --siblings 2 --threshold nan", 2, "is as dense as NaN per radian"),
        ("grow p.honami clip.y4m.csv/out.bvh", 1, "there is no folder"),
        ("grow none.honami out.bvh", 1, "there is no project none.honami"),
    ];
    for (line, code, wanted) in cases {
        let ran = bench.line(line);
        assert!(ran.code == Some(code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
    }
    let tracks: std::collections::BTreeSet<String> =
        bench.samples("p.honami").into_iter().map(|row| row["track"].clone()).collect();
    let script: String = tracks.iter().map(|track| format!("delete {track}\n")).collect();
    assert_eq!(bench.edit("p.honami", &script).code, Some(0));
    let unseen = bench.line("grow p.honami out.bvh");
    assert!(unseen.code == Some(1) && unseen.stderr.contains("no track of any group is seen"), "{unseen:?}");
}
