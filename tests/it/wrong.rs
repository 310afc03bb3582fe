//! Wrong input: one line that says what was wanted and what came, the right exit code, nothing left behind.

use std::collections::BTreeSet;
use std::fs;

use honami_tests::Bench;

/// The work failed.
const FAILED: i32 = 1;
/// The command line was not understood.
const USAGE: i32 = 2;

/// A command line, how it ends, and words that the error has.
type Case = (&'static str, i32, &'static [&'static str]);

const CASES: &[Case] = &[
    // Projects and clips.
    ("new q.honami missing.mp4", FAILED, &["no such file", "missing.mp4"]),
    ("new q.honami empty", FAILED, &["no PNG, JPEG, TIFF or BMP image", "empty"]),
    ("new q.honami points.csv", FAILED, &["not a video", "points.csv"]),
    ("new q.honami cut.y4m", FAILED, &["cut.y4m"]),
    ("new p.honami clip.y4m", FAILED, &["exists already", "choose another name", "p.honami"]),
    ("new nowhere/q.honami clip.y4m", FAILED, &["nowhere/q.honami", "No such file"]),
    ("new q.honami clip.y4m --fps 0", USAGE, &["frames per second", "above 0"]),
    ("new q.honami", USAGE, &["<CLIP>"]),
    ("new q.txt clip.y4m", USAGE, &[".honami", "q.txt"]),
    ("log missing.honami", FAILED, &["there is no project missing.honami", "honami new"]),
    ("log text.honami", FAILED, &["not a honami project", "honami new", "text.honami"]),
    ("track text.honami", FAILED, &["not a honami project"]),
    ("export text.honami tracks out.csv", FAILED, &["not a honami project"]),
    // Cameras.
    ("calibrate", USAGE, &["<IMAGES>"]),
    ("calibrate clip.y4m --board 9", USAGE, &["inner corners as CxR", "got 9"]),
    ("calibrate clip.y4m --square 0", USAGE, &["a length above 0 such as 25mm", "got 0"]),
    ("calibrate clip.y4m --square 25in", USAGE, &["a length above 0 such as 25mm", "got 25in"]),
    ("calibrate clip.y4m --hold k2", USAGE, &["wanted k3, tangential, distortion, centre, square", "got k2"]),
    ("calibrate clip.y4m --views 0", USAGE, &["1 to 10000 views", "got 0"]),
    ("calibrate clip.y4m --window 0", USAGE, &["pixels, 1 to 100, or squares", "got 0"]),
    ("calibrate clip.y4m", FAILED, &["none of ", "shows the whole target", "of the first: ", "9 by 6"]),
    ("calibrate a.honami b.honami --rig bars.toml", USAGE, &["one project a camera"]),
    ("synth stage --target bars --plant walnut.mtg", USAGE, &["--target", "--plant"]),
    ("calibrate clip.y4m --rig none.toml", FAILED, &["none.toml"]),
    // Plugins and their parameters.
    ("track p.honami --with nothing", USAGE, &["no tracker \"nothing\"", "there are:", "klt"]),
    ("track p.honami --with movement", USAGE, &["no tracker \"movement\""]),
    ("cluster p.honami --with klt", USAGE, &["no clusterer \"klt\"", "movement"]),
    ("plugin info nothing", USAGE, &["no plugin \"nothing\"", "there are:"]),
    (
        "plugin check nothere.so",
        USAGE,
        &["there is no file /", "/nothere.so", "looked in", "/honami/plugins"],
    ),
    ("plugin deny nothing", USAGE, &["no plugin \"nothing\"", "looked in"]),
    ("track p.honami --with klt --plugin nothere.so", USAGE, &["--plugin nothere.so: there is no such file"]),
    ("plugin check klt --reproduce foo", USAGE, &["a check and a seed", "got foo", "the nearest of"]),
    ("plugin check klt --reproduce loading.start:1", USAGE, &["no check loading.start", "loading.starts"]),
    ("plugin check klt --reproduce loading.starts:one", USAGE, &["loading.starts:one"]),
    ("plugin check klt --only nonsense", USAGE, &["no check up to level 9 is chosen"]),
    ("plugin new mine --kind clusterer --lang c", USAGE, &["in Python and in Rust"]),
    ("plugin new json", USAGE, &["\"json\"", "choose another"]),
    ("plugin new mine --lang c -- python3 it.py", USAGE, &["--lang trax"]),
    ("plugin new empty", FAILED, &["there is empty already", "another name"]),
    ("track p.honami --set foo=1", USAGE, &["no parameter \"foo\"", "there are: radius"]),
    ("track p.honami --set radius", USAGE, &["name=value"]),
    ("track p.honami --set radius=wide", USAGE, &["radius", "whole number, 2 to 50 (px)", "wide"]),
    ("track p.honami --set radius=0", USAGE, &["radius", "2 to 50", "\"0\""]),
    ("track p.honami --set method=fast", USAGE, &["one of shi-tomasi, harris", "fast"]),
    // Frames, areas and points.
    ("track p.honami --frames 0..41", USAGE, &["0..41", "0..40"]),
    ("track p.honami --frames 5..5", USAGE, &["A..B", "5..5"]),
    ("track p.honami --frames all", USAGE, &["A..B", "all"]),
    ("track p.honami --every 0", USAGE, &["--every"]),
    ("track p.honami --detect --mask small.y4m", FAILED, &["mask", "64x48", "160x120", "small.y4m"]),
    ("track p.honami --detect --mask missing.png", FAILED, &["missing.png"]),
    ("track p.honami --region 1,2,3", USAGE, &["x,y,w,h", "1,2,3"]),
    ("track p.honami --mask small.y4m --region 1,2,3,4", USAGE, &["--mask", "--region"]),
    ("track p.honami --points outside.csv", FAILED, &["point 0", "(500, 20)", "160x120"]),
    ("track p.honami --points late.csv", FAILED, &["point 1", "frame 40", "40 frames"]),
    ("track p.honami --points columns.csv", FAILED, &["columns.csv line 1", "id,x,y", "`y` is missing"]),
    ("track p.honami --points words.csv", FAILED, &["words.csv line 2", "column `x`", "`a`"]),
    ("track p.honami --points missing.csv", FAILED, &["missing.csv"]),
    ("track p.honami --points points.csv --detect", USAGE, &["--points", "--detect"]),
    ("track p.honami --points points.csv --region 1,2,3,4", USAGE, &["--points", "--region"]),
    ("track p.honami --region 500,500,10,10", USAGE, &["no pixel of the clip, 160x120,", "500,500,10,10"]),
    ("track p.honami --detect --mask black.y4m", FAILED, &["all of the mask is black", "black.y4m"]),
    ("matte clip.y4m", USAGE, &["--scribbles or --trimap", "--picture OUT.png"]),
    ("matte clip.y4m --out a.png", USAGE, &["--scribbles or --trimap"]),
    ("matte clip.y4m --remove", USAGE, &["--remove is of projects", "clip.y4m"]),
    ("matte clip.y4m --every 5", USAGE, &["--every is of projects", "clip.y4m"]),
    ("matte p.honami --every 0", USAGE, &["--every"]),
    ("matte p.honami --every 5", FAILED, &["keeps no matte"]),
    ("matte p.honami --remove", FAILED, &["keeps no matte", "--scribbles IMAGE"]),
    ("matte p.honami --remove --mask a.png", USAGE, &["--remove", "--mask"]),
    ("matte p.honami --out a.png", FAILED, &["keeps no matte"]),
    ("matte p.honami --out a.png --frame 40", USAGE, &["frames 40..41", "0..40"]),
    ("export p.honami mask a.png", FAILED, &["keeps no matte"]),
    ("export p.honami mask a.jpg", USAGE, &[".png", "a.jpg"]),
    ("track p.honami --mask small.y4m --no-mask", USAGE, &["--mask", "--no-mask"]),
    ("matte p.honami --picture a.jpg", USAGE, &[".png", "a.jpg"]),
    ("matte p.honami --scribbles black.png --trimap black.png", USAGE, &["--scribbles", "--trimap"]),
    ("matte p.honami --picture a.png --frame 40", USAGE, &["frames 40..41", "0..40"]),
    ("matte p.honami --scribbles missing.png", FAILED, &["no such file", "missing.png"]),
    ("run missing.toml clip.y4m", FAILED, &["cannot read the recipe missing.toml"]),
    ("run points.csv clip.y4m", USAGE, &["points.csv: "]),
    ("run points.csv", USAGE, &["<CLIP>"]),
    ("run points.csv clip.y4m -j 0", USAGE, &["-j", "0"]),
    ("recipe save bare.honami", USAGE, &["nothing was tracked", "bare.honami"]),
    ("recipe save p.honami r.txt", USAGE, &["a recipe is a .toml file: r.txt"]),
    ("rerun bare.honami", USAGE, &["nothing was tracked"]),
    (
        "calibrate clip.y4m --right clip.y4m --square 25mm",
        USAGE,
        &["clip.y4m is given as left and as right", "two views"],
    ),
    ("sync p.honami clip.y4m", USAGE, &["clip.y4m is no project", "--flash"]),
    ("sync p.honami p.honami --flash-right all", USAGE, &["--flash"]),
    ("sync p.honami clip.y4m --flash 1,2,3", USAGE, &["x,y,w,h", "or all", "1,2,3"]),
    (
        "sync p.honami clip.y4m --flash 500,0,9,9",
        USAGE,
        &["no pixel of the clip, 160x120", "500,0,9,9", "p.honami"],
    ),
    ("sync p.honami clip.y4m --flash all --exposure 2", USAGE, &["above 0 to 1", "got 2"]),
    ("sync p.honami clip.y4m --flash all --gamma 0", USAGE, &["0.2 to 5"]),
    ("sync p.honami p.honami --most 0", USAGE, &["above 0"]),
    ("sync small.y4m clip.y4m --flash all", FAILED, &["a signal has at least 16", "small.y4m"]),
    ("sync clip.y4m ./clip.y4m --flash all", USAGE, &["given as left and as right", "two views"]),
    ("triangulate p.honami p.honami --cameras c.json", USAGE, &["given as left and as right", "two views"]),
    ("sync clip.y4m p.honami --flash all", FAILED, &["no flash", "region of the lamp", "clip.y4m"]),
    ("sync p.honami bare.honami", FAILED, &["no tracks: honami track", "bare.honami"]),
    ("sync p.honami missing.honami", FAILED, &["there is no project missing.honami"]),
    ("triangulate p.honami p.honami", USAGE, &["--cameras"]),
    ("triangulate p.honami p.honami --cameras c.json --unit ft", USAGE, &["mm, cm or m", "ft"]),
    (
        "triangulate p.honami p.honami --cameras c.json --offset 1 --flash all",
        USAGE,
        &["--offset", "--flash"],
    ),
    ("triangulate p.honami p.honami --cameras c.json --match looks", USAGE, &["looks", "names"]),
    ("triangulate p.honami p.honami --cameras c.json --farthest 0", USAGE, &["above 0"]),
    ("triangulate p.honami missing.honami --cameras c.json", FAILED, &["no project missing.honami"]),
    (
        "triangulate p.honami bare.honami --cameras points.csv",
        FAILED,
        &["not a file of cameras", "points.csv"],
    ),
    ("export p.honami space t.csv", FAILED, &["no tracks in space", "honami triangulate", "p.honami"]),
    ("export p.honami space t.txt", USAGE, &[".csv", "t.txt"]),
    ("matte missing.honami --picture a.png", FAILED, &["there is no project missing.honami"]),
    // Results.
    ("cluster p.honami --groups 0", USAGE, &["groups, not 0"]),
    ("cluster p.honami --groups 9999", USAGE, &["groups, not 9999"]),
    ("cluster bare.honami", FAILED, &["no tracks yet", "track features first"]),
    ("export p.honami tracks -", USAGE, &["standard output", "name one"]),
    ("export p.honami tracks out.avi", USAGE, &["out.avi", "--format", "csv, parquet, cvat"]),
    ("export p.honami tracks out.xml", USAGE, &["out.xml", "--format", "cvat", "trackmate"]),
    ("export p.honami groups out.txt", USAGE, &[".csv", "out.txt"]),
    ("export p.honami tracks out.csv --tracks 9-3", USAGE, &["3,7,10-19", "9-3"]),
    ("export p.honami tracks out.csv --tracks 9999", USAGE, &["none of the tracks"]),
    ("export p.honami tracks out.csv --groups 1", FAILED, &["no groups yet"]),
    ("export p.honami tracks out.csv --format avi", USAGE, &["csv, parquet", "avi"]),
    ("import p.honami missing.xml", FAILED, &["missing.xml", "No such file"]),
    ("import p.honami clip.y4m", FAILED, &["clip.y4m", "not recognised", "--format: csv, parquet"]),
    ("import p.honami points.csv --format mot", FAILED, &["points.csv", "line 1", "frame,id,left"]),
    ("import p.honami late.csv --format csv", FAILED, &["late.csv line 1", "track,frame,x,y"]),
    ("import p.honami points.csv --origin middle", USAGE, &["normalised", "middle"]),
    ("import p.honami points.csv --pixel-size 0", USAGE, &["pixel-size"]),
    ("export p.honami tracks nowhere/out.csv", FAILED, &["nowhere/out.csv", "there is no folder nowhere"]),
    ("export bare.honami tracks out.csv", FAILED, &["no tracks yet", "track features first"]),
    ("export p.honami movie -", USAGE, &["standard output", "name one"]),
    ("export p.honami movie out.avi", USAGE, &[".mp4, .y4m or a folder", "out.avi"]),
    ("export p.honami movie clip.y4m", FAILED, &["clip.y4m is there already", "another name"]),
    ("export p.honami movie nowhere/out.y4m", FAILED, &["nowhere/out.y4m", "nowhere is no folder"]),
    ("export p.honami movie out.y4m --show leaves", USAGE, &["motion, trails, groups, skeleton", "leaves"]),
    ("export p.honami movie out.y4m --show groups", FAILED, &["no groups yet"]),
    ("export p.honami movie out.y4m --frames 30..50", USAGE, &["30..50", "0..40"]),
    ("export p.honami movie out.y4m --scale 0.01", USAGE, &["16 to 8192 pixels", "--scale"]),
    ("export p.honami movie out.y4m --scale 2 --size 320x240", USAGE, &["--scale", "--size"]),
    ("export p.honami movie out.y4m --fps 0", USAGE, &["frames per second", "0.001 to 100000"]),
    ("export p.honami movie out.y4m --trail 0", USAGE, &["--trail", "above 0"]),
    ("export p.honami movie out.y4m --format csv", USAGE, &["--format is of tables"]),
    ("export p.honami tracks out.csv --show tracks", USAGE, &["--show is of movies"]),
    ("export bare.honami movie out.y4m", FAILED, &["no tracks yet", "track features first"]),
    ("export p.honami pictures out.csv", USAGE, &["pictures", "tracks"]),
    ("spectrum p.honami --track 9999", USAGE, &["track 9999"]),
    ("spectrum brief.csv --track 1", FAILED, &["track 1 is seen in fewer than 8 frames"]),
    ("spectrum brief.csv --track 2", USAGE, &["track 2 is not there"]),
    ("scale p.honami 1,1 1,1 --length 1m", USAGE, &["at least 2 px apart", "0.00 px"]),
    ("scale p.honami 1,1 9000,1 --length 1m", USAGE, &["(9000.0, 1.0) is not in the picture of"]),
    ("scale p.honami 1,1 50,1 --length 1m --length-error 2m", USAGE, &["wrong by 200 %", "measures nothing"]),
    ("scale p.honami 1,1 50,1 --length 1", USAGE, &["--length: wanted a unit (mm, cm, m) after 1"]),
    ("scale p.honami 1,1 50,1 --length 0m", USAGE, &["wanted a length above 0"]),
    ("scale p.honami 1,1 50,1 --length 1m --frame 99999", USAGE, &["there is no frame 99999"]),
    ("scale p.honami 1,1 --length 1m", USAGE, &["2 values required"]),
    ("scale p.honami --remove", USAGE, &["the project has no scale bar"]),
    ("spectrum p.honami --window kaiser", USAGE, &["kaiser", "hann, hamming, blackman, rect"]),
    ("spectrum p.honami --piece 0", USAGE, &["wanted seconds, a number above 0"]),
    (
        "spectrum p.honami --piece 900",
        USAGE,
        &["pieces of 900 s are longer than the record", "--piece is shorter"],
    ),
    ("spectrum p.honami --piece 0.1", USAGE, &["fewer than 8 samples", "--piece is longer"]),
    ("spectrum p.honami --svg out.png", USAGE, &["--svg writes .svg, not out.png"]),
    ("spectrum p.honami --csv out.txt", USAGE, &["--csv writes .csv, not out.txt"]),
    ("spectrum points.csv", FAILED, &["points.csv", "`track` is missing"]),
    ("spectrum bare.honami", FAILED, &["no tracks yet"]),
    ("components bare.honami", FAILED, &["no tracks yet"]),
    ("components points.csv", FAILED, &["points.csv", "`track` is missing"]),
    ("components p.honami out.png", USAGE, &[".svg and .csv", "out.png"]),
    ("components p.honami --most 0", USAGE, &["--most"]),
    ("compare p.honami --sensors points.csv", FAILED, &["no tracks in space", "honami triangulate"]),
    ("compare missing.csv --sensors points.csv", FAILED, &["cannot read the table", "missing.csv"]),
    ("compare points.csv --sensors points.csv", FAILED, &["wanted a column time_s", "points.csv"]),
    ("compare p.honami --sensors points.csv --with klt", USAGE, &["--sensors", "--with"]),
    ("compare points.csv --height 5", USAGE, &["--sensors"]),
    ("compare points.csv --sensors points.csv --svg out.png", USAGE, &["--svg writes .svg"]),
    ("compare clip.y4m --truth missing.csv", FAILED, &["missing.csv"]),
    ("compare clip.y4m --truth points.csv", FAILED, &["points.csv line 1"]),
    ("compare p.honami --with klt --set foo=1", USAGE, &["no parameter \"foo\""]),
    ("compare p.honami --with nothing", USAGE, &["no tracker \"nothing\"", "klt"]),
    // Generated clips.
    ("synth clip.y4m", FAILED, &["clip.y4m", "choose another name"]),
    ("synth out.gif", USAGE, &[".mp4, .y4m or a folder", "out.gif"]),
    ("synth out.y4m --size 1x1", USAGE, &["WxH", "1x1"]),
    ("synth out.y4m --frames 1", USAGE, &["--frames"]),
    ("synth out.y4m --wind gale", USAGE, &["gale", "storm"]),
    // Anything else.
    ("trak p.honami", USAGE, &["no command", "\"trak\"", "did you mean track"]),
    ("plugins", USAGE, &["`honami plugin list`"]),
    ("new q.honami clip.y4m --fps -3", USAGE, &["frames per second", "above 0", "-3"]),
    ("trak.honami", USAGE, &["there is no file trak.honami"]),
    ("relink p.honami small.y4m", FAILED, &["SHA-256"]),
    ("export bare.honami groups out.csv", FAILED, &["no groups yet"]),
    ("doctor --loud", USAGE, &["--loud"]),
];

fn files(bench: &Bench) -> BTreeSet<String> {
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    fs::read_dir(bench.path("")).unwrap().map(name).collect()
}

#[test]
fn wrong_input_is_told_in_one_line_and_leaves_nothing_behind() {
    let bench = Bench::tracked();
    bench.json("new bare.honami clip.y4m");
    bench.json("synth small.y4m --size 64x48 --frames 2");
    fs::create_dir(bench.path("empty")).unwrap();
    let clip = fs::read(bench.path("clip.y4m")).unwrap();
    fs::write(bench.path("cut.y4m"), &clip[..30]).unwrap();
    let [luma, chroma] = [vec![0_u8; 160 * 120], vec![128; 160 * 120 / 2]];
    let head = b"YUV4MPEG2 W160 H120 F25:1 Ip A1:1 C420jpeg\nFRAME\n";
    fs::write(bench.path("black.y4m"), [&head[..], &luma, &chroma].concat()).unwrap();
    let row = |track, frame: u32| {
        format!("{track},{frame},{},{},5\n", f64::from(frame) / 25.0, f64::from(frame * 7 % 5))
    };
    let brief: String =
        (0..20).map(|frame| row(0, frame)).chain((3..10).map(|frame| row(1, frame))).collect();
    fs::write(bench.path("brief.csv"), format!("track,frame,time_s,x,y\n{brief}")).unwrap();
    for (name, text) in [
        ("text.honami", "dear diary"),
        ("points.csv", "id,x,y\n0,10,10\n"),
        ("outside.csv", "id,x,y\n0,500,20\n"),
        ("late.csv", "id,x,y,frame\n0,20,20,3\n1,20,20,40\n"),
        ("columns.csv", "id,x\n0,500\n"),
        ("words.csv", "id,x,y\n0,a,20\n"),
    ] {
        fs::write(bench.path(name), text).unwrap();
    }
    let (before, log) = (files(&bench), bench.json("log p.honami"));
    for &(line, code, words) in CASES {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(code), "honami {line}: {ran:?}");
        assert_eq!(ran.stdout, "", "honami {line}");
        for word in words {
            assert!(ran.stderr.contains(word), "honami {line}: {word:?} is not in {:?}", ran.stderr);
        }
        if code == FAILED {
            assert!(ran.stderr.starts_with("honami: ") && ran.stderr.lines().count() == 1, "{line}: {ran:?}");
        }
        assert_eq!(files(&bench), before, "honami {line}");
    }
    assert_eq!(bench.json("log p.honami"), log, "the project is as it was");
}

#[test]
fn errors_never_tell_the_same_cause_twice() {
    let bench = Bench::new();
    for line in
        ["new q.honami missing.y4m", "compare missing.y4m --points missing.csv", "spectrum missing.csv"]
    {
        let told = bench.line(line).stderr;
        assert_eq!(told.matches("o such file").count(), 1, "honami {line}: {told}");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let bench = Bench::new();
    let mut child =
        bench.command(["completions", "bash"]).stdout(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_clip_is_found_beside_its_moved_project_and_never_guessed() {
    let bench = Bench::tracked();
    fs::create_dir(bench.path("moved")).unwrap();
    for name in ["p.honami", "clip.y4m"] {
        fs::rename(bench.path(name), bench.path("moved").join(name)).unwrap();
    }
    bench.json("track moved/p.honami --frames 0..5");

    bench.json("synth moved/other.y4m --size 160x120 --frames 40 --seed 9");
    fs::rename(bench.path("moved/other.y4m"), bench.path("moved/clip.y4m")).unwrap();
    let ran = bench.line("track moved/p.honami");
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stderr.contains("not the project's clip") && ran.stderr.contains("SHA-256"),
        "{}",
        ran.stderr
    );

    fs::remove_file(bench.path("moved/clip.y4m")).unwrap();
    let ran = bench.line("track moved/p.honami");
    assert_eq!(ran.code, Some(1));
    assert!(ran.stderr.contains("clip.y4m") && ran.stderr.contains("honami relink"), "{}", ran.stderr);
}
