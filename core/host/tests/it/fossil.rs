//! The fossil: `abi/examples/null_tracker.c`, compiled against the frozen header of ABI 1.0 and never again.
//!
//! It was made by `cc -std=c99 -O2 -s -shared -fPIC -fvisibility=hidden -Wl,--build-id=none -Iabi/1.0` and
//! `strip -R .comment`. Neither it nor its golden output ever changes: every honami must load what ran on the first.

use crate::tools::{compile, has_cc, named, point, push, start, stream};
use honami_host::{CallContext, Kind, StreamInfo};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::Path;

const FOSSIL: &str = "tests/fossil/honami-fossil-1.0-x86_64.so";
const FOSSIL_SHA256: &str = "70e78c7103d3a1598caa52a3572f4098788e9e1d7fc071f3c3a05c7a5ac81599";
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

#[test]
fn the_fossil_of_1_0_runs_as_on_its_first_day() {
    let bytes = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(FOSSIL)).unwrap();
    let hash: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(hash, FOSSIL_SHA256, "{FOSSIL} never changes: bring it back");
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        eprintln!("skipped: needs an x86-64 Linux ({FOSSIL})");
        return;
    }
    assert_eq!(story(&Path::new(env!("CARGO_MANIFEST_DIR")).join(FOSSIL)), GOLDEN);
}

#[test]
fn its_source_still_compiles_against_the_frozen_and_the_present_header() {
    if !has_cc() {
        return;
    }
    for (name, include) in
        [("null-1.0", "../abi/abi/1.0"), ("null-1.1", "../abi/abi/1.1"), ("null-now", "../abi/include")]
    {
        assert_eq!(story(&compile("../abi/examples/null_tracker.c", name, include, &[])), GOLDEN, "{name}");
    }
}
