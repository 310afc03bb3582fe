//! Corrections from a script.

use honami_tests::{Bench, by_track};

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
