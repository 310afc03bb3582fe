//! Plugins in Python: listed without running, run in a process of their own, and told apart when they fail.

use std::fs;
use std::process::Command;

use honami_tests::{Bench, root, skipped};

use crate::isolated::is_shut_in;

/// A folder with the example and its manifest; `None` without numpy.
pub(crate) fn with_example(change: impl Fn(String) -> String) -> Option<Bench> {
    let sdk = root().join("core/plugin/python");
    let has_numpy = Command::new("python3").args(["-c", "import numpy"]).output();
    if !has_numpy.is_ok_and(|output| output.status.success()) {
        skipped("python3 with numpy");
        return None;
    }
    let bench = Bench::new();
    let script = bench.path("template.py");
    fs::write(&script, change(fs::read_to_string(sdk.join("examples/template.py")).unwrap())).unwrap();
    let mut python = Command::new("python3");
    let output = python.arg(&script).arg("--honami-manifest").env("PYTHONPATH", &sdk).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    bench.synth("clip.y4m", 12, "--leaves 40 --wind calm");
    Some(bench)
}

#[test]
fn a_tracker_in_python_is_listed_and_follows_what_moves() {
    let Some(bench) = with_example(|text| text) else { return };
    let told = bench.text("plugin info template --plugin template.py");
    assert!(told.contains("radius") && told.contains("Half the side of the template."), "{told}");
    let line = "compare clip.y4m --truth clip.truth.csv --with template --plugin template.py --quick";
    let said = bench.json(line);
    let share = |row: usize| said["trackers"][row]["delta_avg"].as_f64().unwrap();
    assert!(share(0) > share(1) + 0.1, "{} of the template, {} of what stands still", share(0), share(1));
}

#[test]
fn a_program_is_allowed_with_its_files_and_other_parameters_want_another_manifest() {
    let Some(bench) = with_example(|text| text) else { return };
    fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n").unwrap();
    let _said = bench.text("new p.honami clip.y4m");
    let folder = bench.path("XDG_DATA_HOME").join("honami/plugins/template");
    fs::create_dir_all(&folder).unwrap();
    for file in ["template.py", "template.honami.json"] {
        fs::copy(bench.path(file), folder.join(file)).unwrap();
    }
    let first = "track p.honami --with template --points points.csv";
    assert!(bench.line("plugin list").stdout.contains("not trusted"));
    let said = bench.text("plugin allow template");
    for file in ["template.honami.json", "template.py"] {
        let n_bytes = fs::metadata(folder.join(file)).unwrap().len();
        assert!(said.contains(&format!("{file}, {n_bytes} bytes, of user ")), "{said}");
    }
    assert!(bench.text(first).contains("frames 0-11"));
    let track = "track p.honami --with template";
    let script = folder.join("template.py");
    let text = fs::read_to_string(&script).unwrap();
    fs::write(&script, text.replace("Int(6, 1, 30", "Int(9, 1, 30")).unwrap();
    assert!(bench.line(track).stderr.contains("has changed since you allowed it"));
    let _said = bench.text("plugin allow template");
    let said = bench.line(track).stderr;
    assert!(
        said.contains("has other parameters than its manifest: `python3 template.py --honami-manifest`"),
        "{said}"
    );
    let _said = bench.text("plugin deny template");
    let named = bench.line(&format!("{track} --plugin {}", script.display())).stderr;
    assert!(named.contains("it was denied"), "{named}");
}

#[test]
fn what_python_raises_is_told_in_its_words() {
    for (push, wanted) in [
        ("raise honami.Error('too dark for me')", "too dark for me (unusable data)"),
        (
            "return 1 / 0",
            "ZeroDivisionError: division by zero, template.py line LINE (a fault in the plugin)",
        ),
        ("return honami.Points([1, 2], [0], [0], [1])", "columns of honami.points/1 have [1, 2] rows"),
        ("open('/etc/passwd')", "PermissionError: [Errno 13] Permission denied: '/etc/passwd'"),
        (
            "import subprocess; subprocess.run(['true'])",
            "PermissionError: [Errno 13] Permission denied: 'true'",
        ),
        ("import os; os._exit(3)", "ended its process with status 3 in push of frame"),
    ] {
        if wanted.starts_with("PermissionError") && !is_shut_in() {
            continue;
        }
        let method = format!("    def push(self, frame):\n        {push}\n");
        let Some(bench) = with_example(|text| with_method(&text, &method)) else { return };
        fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n").unwrap();
        let _said = bench.text("new p.honami clip.y4m");
        let ran = bench.line("track p.honami --plugin template.py --with template --points points.csv");
        let all = format!("{}{}", ran.stdout, ran.stderr);
        let text = fs::read_to_string(bench.path("template.py")).unwrap();
        let line = 1 + text.lines().position(|line| line.trim() == push).unwrap();
        let wanted = &wanted.replace("LINE", &line.to_string());
        let held = wanted.contains("status 3") && all.contains("ended its process with status 3");
        assert!(ran.code == Some(1) && (held || all.contains(wanted)), "{push}: {ran:?}");
    }
}

/// The example's class with one more method, in place of its base's.
pub(crate) fn with_method(text: &str, method: &str) -> String {
    let class = "class Template(honami.PointByPoint):\n";
    assert!(text.contains(class));
    text.replace(class, &format!("{class}{method}\n"))
}

/// Ends its process in frame 5, once: what is loaded has no such wish.
const MORTAL: &str = "    dies = True

    def load(self, data):
        super().load(data)
        self.dies = False

    def push(self, frame):
        if frame.index == 5 and self.dies:
            __import__('os')._exit(3)
        return super().push(frame)
";

#[test]
fn a_tracker_in_python_that_dies_goes_on_from_what_it_saved() {
    let tables = [false, true].map(|is_mortal| {
        let bench = with_example(|text| if is_mortal { with_method(&text, MORTAL) } else { text })?;
        fs::write(bench.path("points.csv"), "id,x,y\n1,60,60\n2,90,70\n").unwrap();
        let _said = bench.text("new p.honami clip.y4m");
        let said = bench.text("track p.honami --plugin template.py --with template --points points.csv");
        let has_died = said.contains("started again at frame 5: it ended its process with status 3");
        assert_eq!(has_died, is_mortal, "{said}");
        let _said = bench.text("export p.honami tracks out.csv");
        Some(fs::read_to_string(bench.path("out.csv")).unwrap())
    });
    assert_eq!(tables[0], tables[1]);
}
