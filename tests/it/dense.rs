//! Dense motion of a generated clip, against how its leaves really move.

use std::process::Command;
use std::sync::Arc;

use honami_tests::{Bench, has_compiler, program, root};
use honami_workbench::WorkbenchError;
use honami_workbench::compare::read_truth;
use honami_workbench::dense;
use honami_workbench::plugins::{Host, Hosting, Registry, SearchPath};
use honami_workbench::session::{Session, SessionOptions};

const N_FRAMES: u32 = 12;

#[test]
fn dense_motion_is_that_of_the_leaves() {
    let bench = Bench::new();
    bench.json(&format!("synth clip.y4m --size 320x240 --frames {N_FRAMES} --leaves 60 --wind wind"));
    let truth = read_truth(&bench.path("clip.truth.csv"), N_FRAMES).unwrap();
    let options = SessionOptions {
        plugin_paths: vec![program().parent().unwrap().to_owned()],
        ..SessionOptions::default()
    };
    let session = Session::create(&bench.path("p.honami"), &bench.path("clip.y4m"), None, &options).unwrap();
    let times = &session.media.clip().times;
    let mut meter = dense::prepare(&session, None).unwrap();
    assert_eq!(meter.plugin(), "anchored");
    let (mut errors, mut speeds) = (Vec::new(), Vec::new());
    // In the last frame motion is that of the way which led there.
    for (frame, other) in
        (0..N_FRAMES).map(|frame| (frame, if frame + 1 < N_FRAMES { frame + 1 } else { frame - 1 }))
    {
        let field = meter.measure(frame).unwrap();
        let step_s = times.get(other).unwrap() - times.get(frame).unwrap();
        for path in truth.values() {
            let at = |frame: u32| path.positions.get(frame.checked_sub(path.first_frame)? as usize).copied();
            let (Some((x, y, true)), Some((x1, y1, true))) = (at(frame), at(other)) else { continue };
            let Some([u, v]) = field.at([x, y]) else { continue };
            let (tu, tv) = ((x1 - x) / step_s, (y1 - y) / step_s);
            errors.push((u - tu).hypot(v - tv));
            speeds.push(tu.hypot(tv));
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (error, speed) = (median(&mut errors), median(&mut speeds));
    assert!(
        errors.len() > 200 && error < 0.3 * speed,
        "off by {error} px/s of {speed} px/s, {} leaves",
        errors.len()
    );

    let picture = [b"YUV4MPEG2 W16 H16 F25:1 Cmono\nFRAME\n".as_slice(), &[128; 256]].concat();
    std::fs::write(bench.path("still.y4m"), picture).unwrap();
    let still = Session::create(&bench.path("s.honami"), &bench.path("still.y4m"), None, &options).unwrap();
    assert!(matches!(dense::prepare(&still, None), Err(WorkbenchError::OneFrame)));
}

#[test]
fn a_death_costs_the_dense_motion_of_its_frame_and_no_other() {
    if !has_compiler("c++") {
        return;
    }
    let bench = Bench::new();
    bench.synth("clip.y4m", 4, "--leaves 20");
    let library = bench.path("dies.so");
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++17", "-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I"]);
    compiler.args([root().join("core/abi/include"), "-o".into(), library.clone()]);
    assert!(compiler.arg(root().join("tests/it/dense/dies.cpp")).status().unwrap().success());
    let host = Host::with_store(bench.path("store")).hosting(Hosting::Isolated);
    let options = SessionOptions { host, ..SessionOptions::default() };
    let mut session =
        Session::create(&bench.path("p.honami"), &bench.path("clip.y4m"), None, &options).unwrap();
    let named = SearchPath { named: vec![library], ..SearchPath::default() };
    session.registry = Arc::new(Registry::scan_path(&named));
    let mut meter = dense::prepare(&session, None).unwrap();
    assert_eq!([1, 2, 1, 2, 3].map(|frame| meter.measure(frame).is_ok()), [true, false, true, false, true]);
    // The third death is one too many.
    assert!(meter.measure(2).is_err());
    let held = meter.measure(1).unwrap_err().to_string();
    assert!(held.contains("has failed three times"), "{held}");
}
