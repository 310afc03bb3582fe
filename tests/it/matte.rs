//! `honami matte`: a few strokes on a frame become opacities, a mask that detectors read, and its picture.

use std::fs;

use honami_tests::{Bench, rows};
use honami_workbench::media::{Still, write};

const SIZE: [usize; 2] = [96, 72];
const MIDDLE: [f64; 2] = [50.0, 34.0];

/// A leaf that lies before a bright sky, and its opacities; it moves to the right.
fn frame(n: usize) -> (Vec<[u8; 3]>, Vec<f64>) {
    let pixels = (0..SIZE[0] * SIZE[1]).map(|pixel| {
        let [x, y] = [(pixel % SIZE[0]) as f64, (pixel / SIZE[0]) as f64];
        let [u, v] = [x - MIDDLE[0] - n as f64, y - MIDDLE[1]];
        let alpha = (20.5 - u.hypot(v)).clamp(0.0, 1.0);
        // Hard spots, on which corners are found.
        let spot = if ((u / 5.0).floor() + (v / 5.0).floor()).rem_euclid(2.0) < 1.0 { 60.0 } else { 0.0 };
        let leaf = [40.0 + spot / 2.0, 90.0 + spot, 30.0];
        let sky = [180.0 + 20.0 * (x / 15.0).sin(), 190.0, 215.0 + 20.0 * (y / 11.0).cos()];
        let colour = |c: usize| (alpha * leaf[c] + (1.0 - alpha) * sky[c]).round() as u8;
        ([0, 1, 2].map(colour), alpha)
    });
    pixels.unzip()
}

fn save(bench: &Bench, name: &str, rgb: &[[u8; 3]]) {
    write::still(&bench.path(name), rgb, SIZE[0] as u32, SIZE[1] as u32).unwrap();
}

/// Paints black along the border and white within 6 px of the middle.
fn paint(rgb: &mut [[u8; 3]]) -> [usize; 2] {
    let mut n_painted = [0; 2];
    for (pixel, colour) in rgb.iter_mut().enumerate() {
        let [x, y] = [pixel % SIZE[0], pixel / SIZE[0]];
        let is_border = x < 3 || y < 3 || x + 3 >= SIZE[0] || y + 3 >= SIZE[1];
        if is_border {
            (*colour, n_painted[0]) = ([0; 3], n_painted[0] + 1);
        } else if (x as f64 - MIDDLE[0]).hypot(y as f64 - MIDDLE[1]) < 6.0 {
            (*colour, n_painted[1]) = ([255; 3], n_painted[1] + 1);
        }
    }
    n_painted
}

/// A project of three frames.
fn filmed(bench: &Bench) {
    fs::create_dir(bench.path("frames")).unwrap();
    for n in 0..3 {
        save(bench, &format!("frames/f{n}.png"), &frame(n).0);
    }
    bench.json("new p.honami frames --fps 25");
}

#[test]
fn strokes_on_a_frame_become_a_mask_in_which_features_are_found() {
    let bench = Bench::new();
    filmed(&bench);
    let said = bench.json("matte p.honami --picture first.png");
    assert_eq!((&said["width"], &said["height"]), (&96.into(), &72.into()));

    let mut scribbled = Still::read(&bench.path("first.png")).unwrap().rgb;
    let [background, foreground] = paint(&mut scribbled);
    save(&bench, "scribbled.png", &scribbled);
    let said = bench.json(
        "matte p.honami --scribbles scribbled.png --out alpha.png --mask mask.png --parts parts.png --band 3",
    );
    assert_eq!(said["marked"]["background"], background);
    assert_eq!(said["marked"]["foreground"], foreground);
    let parts = said["parts"].as_object().unwrap();
    let n_pixels: u64 = parts.values().map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(n_pixels, 96 * 72);
    let alpha = Still::read(&bench.path("alpha.png")).unwrap().gray();
    let truth = frame(0).1;
    let off = |alpha: &[u8]| {
        let off: f64 = alpha.iter().zip(&truth).map(|(a, b)| (f64::from(*a) / 255.0 - b).abs()).sum();
        off / truth.len() as f64
    };
    assert!(off(&alpha) < 0.035, "frames have one colour for four pixels: {}", off(&alpha));
    let mut image = frame(0).0;
    paint(&mut image);
    save(&bench, "image_scribbled.png", &image);
    bench.json("matte frames/f0.png --scribbles image_scribbled.png --out image_alpha.png");
    let of_image = off(&Still::read(&bench.path("image_alpha.png")).unwrap().gray());
    assert!(of_image < 0.012, "an image has its own: {of_image}");

    // The mask is the leaf without its boundary, and features are found there.
    let mask = Still::read(&bench.path("mask.png")).unwrap().gray();
    let n_kept = mask.iter().filter(|&&value| value == 255).count();
    assert_eq!(parts["kept"], n_kept);
    let wanted = std::f64::consts::PI * 17.0 * 17.0;
    assert!((n_kept as f64 - wanted).abs() < 0.15 * wanted, "{n_kept} of {wanted}");
    bench.json("track p.honami --detect --mask mask.png");
    bench.json("export p.honami tracks t.csv");
    let tracks = rows(&bench.path("t.csv"));
    let first: Vec<_> = tracks.iter().filter(|row| row["frame"] == "0").collect();
    assert!(first.len() >= 5, "{} features", first.len());
    for row in first {
        let [x, y] = ["x", "y"].map(|column| row[column].parse::<f64>().unwrap().round() as usize);
        assert_eq!(mask[y * SIZE[0] + x], 255, "a feature at {x}, {y}");
    }

    // An image by itself, with a trimap; its own colours are somewhat others.
    let trimap: Vec<[u8; 3]> = truth
        .iter()
        .map(|&alpha| if alpha <= 0.0 || alpha >= 1.0 { alpha } else { 0.5 })
        .map(|alpha| [(alpha * 255.0) as u8; 3])
        .collect();
    save(&bench, "trimap.png", &trimap);
    bench.json("matte frames/f0.png --trimap trimap.png --out again.png --with-trunk");
    let again = Still::read(&bench.path("again.png")).unwrap().gray();
    assert!(off(&again) < 0.01, "{}", off(&again));

    // What does not fit is named with its file.
    save(&bench, "untouched.png", &Still::read(&bench.path("first.png")).unwrap().rgb);
    write::still(&bench.path("small.png"), &[[0; 3]; 12], 4, 3).unwrap();
    for (line, words) in [
        ("matte p.honami --scribbles untouched.png --out no.png", ["nothing is marked", "untouched.png"]),
        ("matte p.honami --scribbles small.png --out no.png", ["4x3 pixels, the picture 96x72", "small.png"]),
        ("matte small.png --trimap small.png --out no.png", ["only background is marked", "small.png"]),
    ] {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(1), "{line}: {}", ran.stderr);
        assert!(words.iter().all(|word| ran.stderr.contains(word)), "{line}: {}", ran.stderr);
        assert!(!bench.path("no.png").exists());
    }
}

/// Where features were found in the first frame.
fn found(bench: &Bench) -> Vec<[String; 2]> {
    bench.json("export p.honami tracks t.csv");
    let tracks = rows(&bench.path("t.csv"));
    let first = tracks.iter().filter(|row| row["frame"] == "0");
    first.map(|row| ["x", "y"].map(|column| row[column].clone())).collect()
}

/// The leaf moves by a pixel a frame, and its mask with it.
fn is_carried(bench: &Bench) {
    let said = bench.json("matte p.honami --every 2");
    assert_eq!(
        (&said["from"], &said["frames"], &said["ended"]),
        (&0.into(), &serde_json::json!([2]), &serde_json::Value::Null)
    );
    let middle = |frame: u32| {
        bench.json(&format!("export p.honami mask at.png --frame {frame}"));
        let mask = Still::read(&bench.path("at.png")).unwrap().gray();
        let white: Vec<usize> =
            (0..mask.len()).filter(|&pixel| mask[pixel] == 255).map(|pixel| pixel % SIZE[0]).collect();
        white.iter().sum::<usize>() as f64 / white.len() as f64
    };
    let moved = middle(2) - middle(0);
    assert!((moved - 2.0).abs() < 0.5, "{moved}");
    assert!((middle(1) - middle(0)).abs() < 1e-9, "the frame before counts");
    let mattes = bench.json("matte p.honami");
    assert_eq!(mattes["mattes"][1]["provenance"]["params"]["marks"], "carried from frame 0");
    assert_eq!(mattes["mattes"][1]["provenance"]["params"]["band"], 4, "as the first was found");
    bench.json("matte p.honami --remove --frame 2");
}

#[test]
fn a_matte_is_kept_heeded_told_written_and_removed() {
    let bench = Bench::new();
    filmed(&bench);
    bench.json("matte p.honami --picture first.png");
    let mut scribbled = Still::read(&bench.path("first.png")).unwrap().rgb;
    paint(&mut scribbled);
    save(&bench, "scribbled.png", &scribbled);
    assert_eq!(bench.json("matte p.honami")["mattes"].as_array().map(Vec::len), Some(0));

    let said =
        bench.json("matte p.honami --scribbles scribbled.png --band 4 --mask mask.png --out alpha.png");
    assert_eq!((&said["matte"], &said["frame"]), (&1.into(), &0.into()));
    let kept = &bench.json("matte p.honami")["mattes"][0];
    assert_eq!((&kept["frame"], &kept["parts"]), (&said["frame"], &said["parts"]));
    let params = &kept["provenance"]["params"];
    assert_eq!((&params["band"], &params["marks"]), (&4.into(), &"scribbles scribbled.png".into()));

    // What is kept is what was written, to the pixel.
    let files = ["mask.png", "alpha.png"].map(|name| Still::read(&bench.path(name)).unwrap().rgb);
    bench.json("matte p.honami --mask again.png --out alpha_again.png --parts parts.png");
    bench.json("export p.honami mask exported.png --frame 2");
    let again = |name: &str| Still::read(&bench.path(name)).unwrap().rgb;
    assert_eq!([again("again.png"), again("alpha_again.png")], files);
    assert_eq!(again("exported.png"), files[0], "it counts in later frames, too");

    // Tracking heeds it by itself, as if the mask was given, and says so.
    let text = bench.text("track p.honami --with klt");
    assert!(text.contains("inside the matte of frame 0"), "{text}");
    let inside = found(&bench);
    assert!(inside.len() >= 3, "{inside:?}");
    assert!(bench.edit("p.honami", "undo\n").text().contains("undo"));
    bench.json("track p.honami --with klt --detect --mask mask.png");
    assert_eq!(found(&bench), inside);
    assert!(bench.edit("p.honami", "undo\n").text().contains("undo"));
    let everywhere = bench.json("track p.honami --with klt --no-mask");
    assert!(everywhere["tracks"].as_u64() > Some(0), "{everywhere}");
    assert_eq!(everywhere["mattes"].as_array().map(Vec::len), Some(0));
    let log = bench.json("log p.honami");
    let log = log["log"].as_array().unwrap();
    let runs: Vec<usize> = log
        .iter()
        .filter(|line| line["what"] == "run")
        .map(|run| run["mattes"].as_array().unwrap().len())
        .collect();
    assert_eq!(runs, [1, 0, 0]);
    assert_eq!(log.iter().filter(|line| line["what"] == "matte" && line["frame"] == 0).count(), 1);

    is_carried(&bench);

    // Removing is an edit as keeping was.
    let ran = bench.line("matte p.honami --remove --frame 2");
    assert_eq!(ran.code, Some(2), "{}", ran.stderr);
    let said = [ran.stderr, bench.text("matte p.honami --frame 2")];
    assert!(said.iter().all(|said| said.contains("there are those of frame 0")), "{said:?}");
    bench.json("matte p.honami --remove");
    assert!(bench.text("matte p.honami").contains("no matte is kept"));
    for line in ["matte p.honami --remove", "export p.honami mask no.png", "matte p.honami --mask no.png"] {
        let ran = bench.line(line);
        assert_eq!(ran.code, Some(1), "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains("keeps no matte"), "{line}: {}", ran.stderr);
    }
}
