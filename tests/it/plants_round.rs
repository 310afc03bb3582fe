//! Plants that go round by the spectrum of the wind, and methods that swing them too slowly, through the real program.

use std::fs;

use honami_tests::{Bench, rows};

/// Where all nodes are, frame by frame.
fn cached(bench: &Bench, name: &str, n_frames: usize) -> Vec<Vec<f64>> {
    let points = &fs::read(bench.path(name)).unwrap()[32..];
    let all: Vec<f64> =
        points.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect();
    all.chunks(all.len() / n_frames).map(<[f64]>::to_vec).collect()
}

/// From a frame to one after it, the farthest that any coordinate goes.
fn way(from: &[f64], to: &[f64]) -> f64 {
    from.iter().zip(to).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The last frame goes on into the first as every other into the next, in place and in speed; on any number of threads; and
/// the .glb, which is played from key to key, ends where it begins.
#[test]
fn what_goes_round_begins_again_without_a_jump() {
    let bench = Bench::new();
    for threads in [1, 2] {
        let made = bench.json(&format!(
            "simulate synth::tree:40,1 --modes 6 --wind wind --method spectrum --forest 3 --size-spread 0.3 --seconds 8 \
             --fps 10 --sensors 3 --threads {threads} --cache {threads}.pc2 --glb {threads}.glb --out {threads}.csv"
        ));
        let motion = &made["motion"];
        assert_eq!((&motion["frames"], &motion["goes_round"]), (&80.into(), &true.into()));
        assert!(motion["simulator"].is_null() && motion["deviation_m"].as_f64().unwrap() > 1e-3, "{motion}");
    }
    for name in ["pc2", "glb", "csv"] {
        let [one, two] = [1, 2].map(|n| fs::read(bench.path(&format!("{n}.{name}"))).unwrap());
        assert!(one == two, "{name}");
    }
    let frames = cached(&bench, "1.pc2", 80);
    let at = |k: usize| &frames[k % 80];
    let turn = |k: usize| -> Vec<f64> { at(k + 1).iter().zip(at(k)).map(|(a, b)| a - b).collect() };
    let ways: Vec<f64> = (0..80).map(|k| way(at(k), at(k + 1))).collect();
    let gains: Vec<f64> = (0..80).map(|k| way(&turn(k), &turn(k + 1))).collect();
    let most = |of: &[f64]| of[..78].iter().copied().fold(0.0, f64::max);
    // The two joints at the end against the longest of all others.
    assert!(
        ways[79] <= most(&ways) && gains[78] <= most(&gains) && gains[79] <= most(&gains),
        "{ways:?} {gains:?}"
    );
    let file = fs::read(bench.path("1.glb")).unwrap();
    let words: serde_json::Value =
        serde_json::from_slice(&file[20..20 + u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize])
            .unwrap();
    let sampler = &words["animations"][0]["samplers"][0];
    let keys = &words["accessors"][sampler["input"].as_u64().unwrap() as usize];
    assert_eq!((&keys["count"], &keys["max"][0]), (&81.into(), &8.0.into()), "{keys}");

    // A steady wind holds it where it is.
    bench.json(
        "simulate synth::tree:40,1 --modes 6 --wind steady --method spectrum --seconds 1 --cache held.pc2",
    );
    let held = cached(&bench, "held.pc2", 25);
    assert!(held.iter().all(|frame| way(frame, &held[0]) < 1e-6));
    assert_eq!(rows(&bench.path("1.csv")).len(), 80 * 3);
}

/// Where steps are long for a method, a line says by how much modes swing too slowly and how many steps mend it; what is
/// damped beyond critical is told.
#[test]
fn a_method_that_swings_too_slowly_is_told() {
    let bench = Bench::new();
    let line = "simulate synth::tree:40,1 --modes 6 --wind calm --seconds 1 --fps 5 --method newmark";
    let text = bench.text(line);
    let (_, said) = text.split_once("--method newmark swings modes too slowly, mode ").unwrap();
    let (_, substeps) = said.split_once("--substeps ").unwrap();
    let substeps: u32 = substeps.split(' ').next().unwrap().parse().unwrap();
    let quick = bench.text(&format!("{line} --substeps {substeps}"));
    assert!(!quick.contains("too slowly"), "{quick}");
    let slow = bench.text(&format!("{line} --substeps {}", substeps - 1));
    assert!(slow.contains("by 1."), "{slow}");
    let refused = bench.line("simulate synth::tree:40,1 --modes 6 --wind calm --fps 1 --method symplectic");
    let (_, substeps) = refused.stderr.split_once("or --substeps ").unwrap();
    let substeps: u32 = substeps.trim().parse().unwrap();
    let symplectic =
        "simulate synth::tree:40,1 --modes 6 --wind calm --fps 1 --seconds 5 --method symplectic";
    let [enough, less] =
        [substeps, substeps - 1].map(|n| bench.line(&format!("{symplectic} --substeps {n}")));
    assert_eq!((enough.code, less.code), (Some(0), Some(2)), "{enough:?}");
    let creeps = bench.text("simulate synth::tree:40,1 --modes 6 --beta 10");
    assert!(creeps.contains("note: 6 modes are damped by 100 % or more, beyond critical"), "{creeps}");
}
