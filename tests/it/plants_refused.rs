//! What is no plant, no motion or too much: refused with what was wanted, and nothing of it is written.

use std::fs;

use honami_tests::Bench;

/// Everything that a motion can be written as.
const OUTS: [&str; 4] = ["a.csv", "a.pc2", "a.glb", "b.csv"];

/// Plants and winds, good and bad.
fn files(bench: &Bench) {
    let mtg = |n: u32| {
        let nodes: String = (1..=n).map(|k| format!("\t^<S{k}\t0\t0\t{}\t40\n", 100 * k / n)).collect();
        let head = "CODE:\tFORM-A\n\nCLASSES:\nSYMBOL\tSCALE\nP\t1\nS\t2\n\nMTG:\nENTITY-CODE\t\tXX\tYY\tZZ\tTopDia\n";
        format!("{head}/P1\n\t/S0\t0\t0\t0\t40\n{nodes}")
    };
    let swc = |height: &str, radius: &str| format!("1 1 0 0 0 {radius} -1\n2 1 0 0 {height} {radius} 1\n");
    for (name, text) in [
        ("rod.mtg", mtg(4)),
        ("two.mtg", mtg(1)),
        ("none.mtg", "nothing".to_owned()),
        ("lost.csv", "t,x,y\n0,1,2\n0.1,-9999,2\n".to_owned()),
        ("nan.csv", "t,x,y\n0,1,2\n0.1,NaN,2\n".to_owned()),
        ("fat.swc", swc("1", "1e300")),
        ("thin.swc", swc("1", "1e-200")),
        ("tall.swc", swc("1e300", "0.02")),
        ("minus.swc", "1 1 0 0 0 .1 -1\n2 1 0 0 1 -.1 1\n".to_owned()),
        ("stub.swc", swc("0.01", "1")),
        ("wind.csv", "t,x,y\n0,1,2\n0.1,1,2\n".to_owned()),
        ("clip.pc2", "YUV4MPEG2 W2 H2 F25:1\n".to_owned()),
        ("clip.y4m", "YUV4MPEG2 W2 H2 F25:1\n".to_owned()),
    ] {
        fs::write(bench.path(name), text).unwrap();
    }
}

fn names(bench: &Bench) -> Vec<String> {
    let entries = fs::read_dir(bench.path("")).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    // The program's own home, which it may make.
    names.retain(|name| !["HOME", "XDG"].iter().any(|home| name.starts_with(home)));
    names.sort();
    names
}

/// Each with all that can be written, unless it names what is.
#[test]
fn what_is_refused_leaves_nothing_and_says_what_is_wanted() {
    let bench = Bench::new();
    files(&bench);
    let before = names(&bench);
    for (line, code, wanted) in CASES {
        let is_whole = line.starts_with("simulate")
            && !["--with", "--set", "--out", "--cache"].iter().any(|word| line.contains(word));
        let outs = if is_whole {
            let [table, cache, glb, beams] = OUTS;
            format!(" --out {table} --cache {cache} --glb {glb} --beams {beams}")
        } else {
            String::new()
        };
        let ran = bench.line(&format!("{line}{outs}"));
        assert!(ran.code == Some(*code) && ran.stderr.contains(wanted), "{line}: {ran:?}");
        assert_eq!(names(&bench), before, "{line}");
    }
}

/// What was typed, the exit status, and what it says.
const CASES: &[(&str, i32, &str)] = &[
    // A file that is missing is work that failed, of a plant and of a wind; a name that there is not was typed wrongly.
    ("simulate no.mtg", 1, "no.mtg: No such file"),
    ("synth a.y4m --plant no.mtg", 1, "no.mtg: No such file"),
    ("simulate two.mtg --modes 2 --wind no.csv", 1, "no.csv: No such file"),
    ("simulate two.mtg --modes 2 --wind 8.5", 2, "\"8.5\" is no wind and no file: there are still"),
    ("simulate two.mtg --modes 2 --wind calm+no/wind", 1, "no/wind: No such file"),
    (
        "simulate rod.obj",
        2,
        "\"rod.obj\" is no plant: a file whose name ends in .mtg, .swc, .csv, .mat or .honami is wanted",
    ),
    ("simulate synth::tree:1,1", 2, "synth::tree:NODES,SEED of two nodes or more"),
    ("simulate synth::tree:x", 2, "is no plant"),
    ("simulate none.mtg", 1, "has a table CLASSES"),
    (
        "simulate rod.mtg --modes 25",
        2,
        "25 modes were asked for, and of this plant 24 can be had: --modes 24 is the greatest number",
    ),
    ("bench bending rod.mtg --modes 25", 2, "--modes 24 is the greatest number"),
    ("synth a.y4m --plant rod.mtg --modes 25", 2, "--modes 24 is the greatest number"),
    ("simulate rod.mtg --set modes=25", 2, "--modes 24 is the greatest number"),
    ("simulate two.mtg --modes 2 --young=-1", 2, "a Young's modulus of more than 0 Pa, not of -1"),
    ("simulate two.mtg --modes 2 --wind gale", 2, "\"gale\" is no wind and no file: there are still"),
    ("simulate two.mtg --modes 2 --wind nan.csv", 1, "line 3: \"NaN\" is no number"),
    (
        "simulate two.mtg --modes 2 --wind lost.csv",
        1,
        "line 3: a wind of -9999, 2, 0 m/s, and none is faster than 200",
    ),
    (
        "simulate two.mtg --modes 2 --wind calm --method symplectic",
        2,
        "is wanted, or another method, or --substeps ",
    ),
    ("simulate two.mtg --modes 2 --wind squall --method spectrum", 2, "squall is not after 20 s what it was"),
    ("simulate two.mtg --modes 2 --wind air --method spectrum", 2, "air is not after 20 s what it was"),
    ("simulate two.mtg --modes 2 --wind calm --pull 1 --method spectrum", 2, "leave out --pull"),
    (
        "simulate two.mtg --modes 2 --wind calm --with modal --method spectrum",
        2,
        "leave out --with and --set",
    ),
    (
        "simulate two.mtg --modes 2 --forest 2 --alpha 0 --beta 0 --method spectrum",
        1,
        "that nothing damps has no motion by the spectrum",
    ),
    ("simulate two.mtg --modes 2 --heavier 0", 2, "masses are more than 0"),
    ("simulate two.mtg --modes 2 --wind calm --heavier 1000", 2, "heavier: wanted a number, 0.01 to 100"),
    ("simulate two.mtg --modes 2 --wind calm --with klt", 2, "no simulator \"klt\""),
    ("simulate two.mtg --modes 2 --wind calm --set bent=s2", 2, "there is no parameter \"bent\""),
    ("simulate two.mtg --modes 2 --set bent=s2", 2, "there is no parameter \"bent\""),
    ("simulate two.mtg --modes 2 --with klt", 2, "no simulator \"klt\""),
    ("synth a.y4m --plant two.mtg --set bent=s2", 2, "there is no parameter \"bent\""),
    ("synth a.y4m --set alpha=1", 2, "--plant"),
    ("simulate synth::tree:3437,1 --modes 2 --forest 10000000", 1, "10000000 copies of 3437 nodes take 41"),
    (
        "simulate two.mtg --modes 2 --pull nan",
        2,
        "is pulled by a number of metres from -1000 to 1000, not by NaN",
    ),
    ("simulate two.mtg --modes 2 --pull inf", 2, "is pulled by a number of metres"),
    ("synth two.y4m --plant two.mtg --modes 2 --frames 2 --pull 1e30", 2, "not by 1e30"),
    (
        "simulate two.mtg --modes 2 --wind steady:speed=1e200",
        2,
        "speed of steady is a number from -1000000 to 1000000, not \"1e200\"",
    ),
    ("simulate two.mtg --modes 2 --wind calm --threads 100000", 2, "wanted 1 to 1024 threads, got 100000"),
    (
        "simulate two.mtg --modes 2 --wind wind.csv --out wind.csv",
        2,
        "wind.csv is read or written already: choose another name",
    ),
    (
        "simulate two.mtg --modes 2 --sensor 9 --out a.csv",
        2,
        "there is no node 9: the beams have nodes 0 to 1",
    ),
    ("simulate two.mtg --modes 2 --longest 1e-9", 1, "nodes of beams, and 4000000 are the most"),
    ("simulate synth::tree:100000000,1", 1, "1e8 nodes of beams, and 4000000 are the most"),
    ("spectrum two.mtg --fps 4 --above=-1", 2, "wanted hertz, a number of 0 or more"),
    ("spectrum two.mtg --fps 4 --track 1", 2, "--track is for tracks, and"),
    ("spectrum two.mtg --fps 4 --peaks 2", 2, "--peaks is for tracks, and"),
    ("spectrum two.mtg --fps 4 --from soon", 2, "wanted seconds, a number, got soon"),
    ("simulate two.mtg --modes 2 --wind calm --seconds 0", 2, "a motion has 1 to 100000000 frames"),
    // Sizes.
    ("simulate fat.swc --modes 2", 1, "has a radius of 1e300 m and a segment of"),
    ("simulate thin.swc --modes 2", 1, "radii of 1e-9 to 1e6 m and segments of up to 1e6 m are wanted"),
    ("simulate tall.swc --modes 2", 1, "segments of up to 1e6 m are wanted; is it the unit?"),
    ("simulate two.mtg --modes 2 --unit 0", 2, "units are more than 0"),
    ("simulate two.mtg --modes 2 --longest 0", 2, "the longest segment is more than 0 m long, not 0 m"),
    ("simulate no.honami --modes 2", 2, "is in pixels: --unit M says how many metres one of them is"),
    ("simulate no.honami --modes 2 --unit 0.01", 1, "cannot open the project"),
    ("synth a.y4m --plant no.honami", 2, "is in pixels: --unit M says"),
    ("synth a.y4m --plant no.honami --unit 0.01", 1, "cannot open the project"),
    ("synth a.y4m --plant two.mtg --unit 0", 2, "units are more than 0"),
    ("synth a.y4m --plant nan.csv --unit 2", 2, "--unit says nothing of nan.csv"),
    ("synth a.y4m --unit 2", 2, "--plant"),
    // Options for files of other kinds, and classes that do not occur.
    ("simulate rod.mtg --modes 2 --classes S,X", 2, "rod.mtg: no part is of class X: there are S (5)"),
    (
        "simulate fat.swc --modes 2 --classes S",
        2,
        "--classes says nothing of fat.swc: it is for plants in .mtg",
    ),
    (
        "simulate nan.csv --unit 2",
        2,
        "--unit says nothing of nan.csv: it is for plants in .mtg, .swc, .honami",
    ),
    ("simulate synth::tree:9,1 --diameters 10", 2, "--diameters says nothing of synth::tree:9,1"),
    ("bench bending fat.swc --classes S", 2, "--classes says nothing of fat.swc"),
    (
        "simulate minus.swc --modes 2",
        1,
        "minus.swc: line 2: a radius is 0, where it was not measured, or more, not -0.1",
    ),
    // Long numbers are short.
    ("simulate two.mtg --modes 2 --unit=-1e300", 2, "not -1e300 m of length"),
    ("simulate two.mtg --modes 2 --young=-1e300", 2, "not of -1e300"),
    ("simulate two.mtg --modes 2 --longest 1e-300", 1, "e299 nodes of beams, and 4000000 are the most"),
    ("simulate two.mtg --modes 2 --heavier=-1e300", 2, "plants are -1e300 times as heavy"),
    // Air and room.
    (
        "simulate two.mtg --modes 2 --drag=-1",
        2,
        "a drag coefficient of 0 to 10000 in air of 0 to 10000 kg/m3, not of -1",
    ),
    ("simulate two.mtg --modes 2 --air-density nan", 2, "not of 1 in air of NaN"),
    ("simulate two.mtg --modes 2 --spacing 3", 2, "--forest"),
    ("simulate two.mtg --modes 2 --forest 3 --spacing 0", 2, "copies stand 0.001 to 100000 m apart, not 0 m"),
    (
        "simulate two.mtg --modes 2 --forest 1000 --fps 0.001 --seconds 4000 --substeps 100000000",
        1,
        "the winds of 1000 copies in 100000000 steps a frame take 1200800 MB",
    ),
    (
        "simulate synth::tree:30,1 --modes 2 --forest 100000 --seconds 4e6",
        1,
        " GB would be written there, and ",
    ),
    // Wood and leaves.
    ("simulate two.mtg --modes 2 --young nan", 2, "a Young's modulus of more than 0 Pa, not of NaN"),
    ("simulate two.mtg --modes 2 --density=-1", 2, "a density of more than 0 kg/m3, not of -1"),
    ("simulate two.mtg --modes 2 --poisson 2", 2, "a Poisson's ratio of -1 to 0.5, not of 2"),
    ("simulate two.mtg --modes 2 --density 1e-318", 2, "density: wanted a number, 1 to 100000"),
    ("bench bending two.mtg --modes 2 --density 1e-318", 1, "too small, too large or too far apart"),
    ("simulate two.mtg --modes 2 --leaf-mass=-1", 2, "leaves weigh 0 kg or more"),
    ("simulate two.mtg --modes 2 --leaf-drag nan", 2, "have a drag area of 0 m2 or more"),
    ("simulate two.mtg --modes 2 --alpha nan", 2, "damping is not negative"),
    // Motions.
    (
        "simulate two.mtg --modes 2 --seconds 1e300",
        2,
        "a motion has 1 to 100000000 frames, 1e300 s at 25.0 a second",
    ),
    ("simulate two.mtg --modes 2 --fps 1e-300", 2, "a motion has 1 to 100000000 frames"),
    ("simulate two.mtg --modes 2 --fps nan", 2, "a motion has 1 to 100000000 frames"),
    (
        "simulate two.mtg --modes 2 --seconds 1e300 --fps 1e-300",
        2,
        "a motion has 0.001 to 100000 frames a second",
    ),
    (
        "simulate two.mtg --modes 2 --substeps 100000",
        2,
        "100000 steps a second at most: of shorter ones single precision loses",
    ),
    (
        "simulate stub.swc --modes 2 --pull 0.1",
        1,
        "the slowest mode cannot be pulled by 0.1 m: it only twists the plant",
    ),
    ("synth a.y4m --plant two.mtg --modes 2 --pull nan", 2, "is pulled by a number of metres"),
    (
        "simulate two.mtg --modes 2 --forest 3 --size-spread=-1",
        2,
        "sizes and masses of copies are spread by 0 to 4, by which they are up to 5 times as much, not by -1.0 and 0.0",
    ),
    ("simulate two.mtg --modes 2 --forest 3 --mass-spread nan", 2, "not by 0.0 and NaN"),
    // Too much.
    ("simulate two.mtg --modes 2 --forest 1e12", 2, "wanted 1 to 10000000 copies, got 1e12"),
    ("simulate two.mtg --modes 2 --forest 0", 2, "wanted 1 to 10000000 copies, got 0"),
    (
        "simulate synth::tree:900,1 --modes 5000",
        2,
        "of this plant 2696 can be had: --modes 2696 is the greatest number",
    ),
    (
        "simulate synth::tree:20,1 --forest 400000 --seconds 100 --out a.csv --glb a.glb",
        1,
        "its readers hold 2147 MB at most",
    ),
    // Places.
    (
        "simulate two.mtg --modes 2 --out a.csv --cache clip.pc2",
        1,
        "clip.pc2 is a clip, and honami does not write over it",
    ),
    (
        "simulate two.mtg --modes 2 --out a.csv --cache clip.y4m",
        2,
        "a point cache is written as .pc2, not as clip.y4m",
    ),
    (
        "simulate two.mtg --modes 2 --beams rod.mtg --out a.csv",
        2,
        "a table of beams is written as .csv, not as rod.mtg",
    ),
    ("simulate two.mtg --modes 2 --glb a.gltf --out a.csv", 2, "is written as .glb, not as a.gltf"),
    ("simulate two.mtg --modes 2 --out -", 2, "is written as .csv, not as -"),
    ("simulate two.mtg --modes 2 --out nan.csv", 1, "nan.csv is there already and is another kind of file"),
    ("simulate two.mtg --modes 2 --beams nan.csv --out a.csv", 1, "is another kind of file"),
    ("simulate two.mtg --modes 2 --out a.csv --beams b.csv --glb no/a.glb", 1, "there is no folder no"),
    ("simulate two.mtg --modes 2 --out a.csv --beams ./a.csv", 2, "is read or written already"),
];
