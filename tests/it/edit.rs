//! Corrections from a script.

use honami_tests::{Bench, by_track, rows};

#[test]
fn scripted_corrections_are_answered_and_undone() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami");
    let script = "\
        key 0 5 20 30   # a remark\n\n\
        undo\nredo\n\
        add 3 10 11.5\n\
        key 1 2 50 60\nclear 1 2\n\
        delete 2 3\nrestore 3\n\
        cut 2\n";
    let said = bench.edit("p.honami", script).text();
    let answers: Vec<&str> = said.lines().map(|line| line.split_once("  ").unwrap().1).collect();
    assert_eq!(answers.len(), 9, "{said}");
    for (answer, words) in answers.iter().zip([
        "track 0: key-frame at 5",
        "undo: track 0",
        "redo: track 0",
        "placed at frame 3 (10.0, 11.5)",
        "track 1: key-frame at 2",
        "track 1: key-frame at 2 cleared",
        "2 tracks deleted",
        "track 3 restored",
        "cut into 2 groups",
    ]) {
        assert!(answer.contains(words), "{words} is not in {answer}");
    }
    let samples = bench.samples("p.honami");
    let keys: Vec<_> = samples.iter().filter(|row| row["source"] == "key").collect();
    let keys: Vec<_> =
        keys.iter().map(|row| ["frame", "x", "y"].map(|column| row[column].as_str())).collect();
    assert_eq!(keys, [["5", "20", "30"], ["3", "10", "11.5"]]);
    let tracks = by_track(&samples);
    assert!(!tracks.contains_key(&2) && tracks.contains_key(&3));
    assert_eq!(bench.json("spectrum p.honami")["lines"][2]["subject"], "group 2");
}

#[test]
fn groups_are_made_by_hand() {
    let bench = Bench::tracked();
    bench.json("cluster p.honami --groups 4");
    let groups = |name: &str| -> Vec<[String; 3]> {
        bench.json(&format!("export p.honami groups {name}"));
        let rows = rows(&bench.path(name));
        rows.iter().map(|row| ["track", "group", "name"].map(|column| row[column].clone())).collect()
    };
    let cut = groups("cut.csv");
    let taken = cut.iter().find(|row| row[1] == "2").unwrap()[0].clone();
    let script = format!("group-name 1 trunk\ngroup-merge 1 3\ngroup-take 1 {taken}\n");
    let said = bench.edit("p.honami", &script).text();
    for words in ["group 1 named trunk", "groups 1 and 3 merged: ", "taken into group 1"] {
        assert!(said.contains(words), "{words} is not in {said}");
    }
    let by_hand = groups("hand.csv");
    let number = |row: &[String; 3]| row[1].parse::<u32>().unwrap();
    for (was, is) in cut.iter().zip(&by_hand) {
        let is_trunk = was[1] == "1" || was[1] == "3" || was[0] == taken;
        assert_eq!((is[2] == "trunk", is[1] == "1"), (is_trunk, is_trunk), "{was:?} became {is:?}");
    }
    // Group 4 is the third now, unless nothing was left of the second.
    let n_groups = by_hand.iter().map(number).max().unwrap();
    assert!((2..=3).contains(&n_groups));
    let lines = bench.json("spectrum p.honami");
    let of = |line: &&serde_json::Value| line["subject"] == "group 1";
    let line = lines["lines"].as_array().unwrap().iter().find(of).unwrap();
    let n_trunk = by_hand.iter().filter(|row| row[1] == "1").count() as u64;
    assert!((2..=n_trunk).contains(&line["tracks"].as_u64().unwrap()), "{line} of {n_trunk}");
    let coherence = &line["coherence"];
    assert!(coherence.is_null() || (0.0..=1.0).contains(&coherence.as_f64().unwrap()), "{coherence}");
    assert_eq!(bench.json("grow p.honami m.bvh")["groups"], n_groups);
    // Wherever the cut is, the trunk is the same.
    assert!(bench.edit("p.honami", "cut 6").text().contains("cut into 6 groups"));
    let trunk = |rows: &[[String; 3]]| -> Vec<String> {
        rows.iter().filter(|row| row[2] == "trunk").map(|row| row[0].clone()).collect()
    };
    assert_eq!(trunk(&groups("six.csv")), trunk(&by_hand));
    assert_eq!(bench.edit("p.honami", "undo\nundo\nundo\nundo\n").text().lines().count(), 4);
    assert_eq!(groups("undone.csv"), cut);
    for (script, words) in [
        ("group-merge 1 9", "there are groups 1 to 4, no group 9"),
        ("group-merge 1 0", "wanted the group as a whole number from 1 on, got 0"),
        ("group-take 1 99999", "track 99999 is in no group"),
        ("group-release", "no group was made by hand"),
    ] {
        let ran = bench.edit("p.honami", script);
        assert_eq!(ran.code, Some(1), "{script}: {ran:?}");
        assert!(ran.stderr.contains(words), "{script}: {words:?} is not in {:?}", ran.stderr);
    }
}

#[test]
fn what_is_refused_uses_no_track_number_up() {
    let bench = Bench::tracked();
    let made = |bench: &Bench| {
        let said = bench.edit("p.honami", "duplicate 0").text();
        said.trim().rsplit_once(' ').unwrap().1.parse::<u32>().unwrap()
    };
    let first = made(&bench);
    for script in ["split 0 0", "split 0 39000", "duplicate 999", "average 999 1"] {
        assert_eq!(bench.edit("p.honami", script).code, Some(1), "{script}");
    }
    assert_eq!(made(&bench), first + 1);
}

#[test]
fn a_script_of_corrections_ends_where_it_goes_wrong() {
    let bench = Bench::tracked();
    for (script, words) in [
        ("key 0 3 20 30\nkey 999 3 10 10\ndelete 0\n", "line 2, key 999 3 10 10: there is no track 999"),
        ("key 0 40 10 10", "in frame 40 is not in the clip of 160x120 pixels and 40 frames"),
        ("add 3 500 10", "(500, 10) in frame 3 is not in the clip"),
        ("add 3 nan 10", "(nan, 10) in frame 3 is not in the clip"),
        ("add 3 a 10", "wanted a position in pixels, got a"),
        ("delete", "wanted delete TRACK…"),
        ("delete 0 x", "wanted the track as a whole number, got x"),
        ("clear 0 7", "track 0 has no key-frame at 7"),
        ("restore 0", "track 0 is not deleted"),
        ("cut 3", "no clustering is shown"),
        ("cut 0", "at least 1 group"),
        ("redo", "nothing to redo"),
        ("paint 3", "add FRAME X Y"),
        ("swap 1 1 0 5", "track 1 cannot be worked on with itself"),
        ("join 1 1", "track 1 cannot be worked on with itself"),
    ] {
        let ran = bench.edit("p.honami", script);
        assert_eq!(ran.code, Some(1), "{script}: {ran:?}");
        assert!(ran.stderr.contains(words), "{script}: {words:?} is not in {:?}", ran.stderr);
    }
    let edits = bench.log("p.honami", "edit");
    let last = edits.last().unwrap()["label"].as_str().unwrap();
    assert!(
        last.starts_with("track 0: key-frame at 3"),
        "what came before is kept, and nothing after: {last}"
    );
}
