//! The fossils: `abi/examples/null_tracker.c`, compiled against the frozen header of ABI 1.0 and never again, and
//! `abi/examples/tint_tracker.c`, against that of 1.1.
//!
//! They were made by `cc -std=c99 -O2 -s -shared -fPIC -fvisibility=hidden -Wl,--build-id=none -Iabi/1.n` and
//! `strip -R .comment`. Neither they nor what they answer ever changes: every honami must load what ran on the first.

use crate::tools::{compile, has_cc, named, pixels, point, push, start, stream, view};
use honami_host::{CallContext, DetectRequest, FrameView, Kind, StreamInfo};
use honami_model::picture::{Chroma, Gray};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const FOSSIL: &str = "tests/fossil/honami-fossil-1.0-x86_64.so";
const FOSSIL_SHA256: &str = "70e78c7103d3a1598caa52a3572f4098788e9e1d7fc071f3c3a05c7a5ac81599";
const TINT: &str = "tests/fossil/honami-fossil-1.1-x86_64.so";
const TINT_SHA256: &str = "1444e871c88e09f9cd0b943d67890ce6ce542c0566f303ded849aa9de7659702";
const GOLDEN: &str = include_str!("../fossil/golden-1.0.txt");

/// What the library says of itself and what it makes of a stream with everything in it.
fn story(library: &Path) -> String {
    let registry = named(&[library]);
    let info = registry.find(Kind::Tracker, "null").unwrap();
    let mut text = format!("{} {} {:?} {}\n", info.id, info.version, info.abi, info.interfaces.join(" "));
    for param in &info.params {
        writeln!(text, "{} {} {} {}", param.id, param.label, param.unit, param.default()).unwrap();
    }
    let cx = CallContext::silent();
    for (reversed, settings) in [(false, ["drift=0.25"]), (true, ["drift=-1.5"])] {
        let mut tracker = start(info, &settings).unwrap();
        tracker.begin(StreamInfo { reversed, ..stream() }, &cx).unwrap();
        tracker.seed(&[point(7, 0.1, 3.0), point(2, 7.3, 0.5)], &cx).unwrap();
        for n in 0..5 {
            match n {
                2 => tracker.seed(&[point(9, 4.0, 1.0), point(7, 1.0, 1.0)], &cx).unwrap(),
                4 => tracker.retire(&[2], &cx).unwrap(),
                _ => {}
            }
            let index = if reversed { 10 - n } else { n };
            for points in push(&mut tracker, index).unwrap() {
                for row in points.rows {
                    let (x, y) = (row.x.to_bits(), row.y.to_bits());
                    writeln!(text, "{} {} {x:08x} {y:08x} {:?}", points.frame, row.id, row.status).unwrap();
                }
            }
        }
        assert!(tracker.end(&cx).unwrap().is_empty());
    }
    text
}

/// A fossil, as it was on its first day; `None`, and why, where it cannot run.
fn fossil(path: &str, sha256: &str) -> Option<PathBuf> {
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let bytes = std::fs::read(&library).unwrap();
    let hash: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hash, sha256, "{path} never changes: bring it back");
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        eprintln!("skipped: needs an x86-64 Linux ({path})");
        return None;
    }
    Some(library)
}

#[test]
fn the_fossil_of_1_0_runs_as_on_its_first_day() {
    if let Some(library) = fossil(FOSSIL, FOSSIL_SHA256) {
        assert_eq!(story(&library), GOLDEN);
    }
}

/// What the tint tracker says of a picture whose last pixel has Cb 41 and Cr 242, and of one without colour.
fn tints(library: &Path) -> [i32; 2] {
    let registry = named(&[library]);
    let mut tracker = start(registry.find(Kind::Tracker, "tint").unwrap(), &[]).unwrap();
    let (luma, cb, cr) = (pixels(0), [10, 20, 99, 40, 41, 99], [210, 220, 99, 240, 242, 99]);
    let plane = |data| Gray { data, width: 2, height: 2, stride: 3 };
    let gray = view(&luma, 0);
    let coloured = FrameView { chroma: Some(Chroma { cb: plane(&cb), cr: plane(&cr) }), ..gray };
    [coloured, gray].map(|frame| {
        let wanted =
            DetectRequest { frame, max_features: 9, mask: None, points: &[], max_threads: 1, seed: 0 };
        tracker.detect(&wanted, &CallContext::silent()).unwrap()[0].score as i32
    })
}

#[test]
fn the_fossil_of_1_1_sees_colour_as_on_its_first_day() {
    if let Some(library) = fossil(TINT, TINT_SHA256) {
        assert_eq!(tints(&library), [41_242, -1]);
    }
    if has_cc() {
        for (name, include) in [("tint-1.1", "../abi/abi/1.1"), ("tint-now", "../abi/include")] {
            let built = compile("../abi/examples/tint_tracker.c", name, include, &[]);
            assert_eq!(tints(&built), [41_242, -1], "{name}");
        }
    }
}

#[test]
fn the_source_of_the_first_still_compiles_against_the_frozen_and_the_present_header() {
    if !has_cc() {
        return;
    }
    for (name, include) in
        [("null-1.0", "../abi/abi/1.0"), ("null-1.1", "../abi/abi/1.1"), ("null-now", "../abi/include")]
    {
        assert_eq!(story(&compile("../abi/examples/null_tracker.c", name, include, &[])), GOLDEN, "{name}");
    }
}
