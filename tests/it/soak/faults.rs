//! Disks that are full, folders that refuse, writes that are cut short, locks of dead hosts, clocks that went back, and a
//! project that is taken away under its session: what was answered is there, and what was not is told.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use honami_tests::{Bench, Ran, program, ran, skipped};

use super::assert_whole;

/// A project with one track, in a folder of the bench.
fn project(bench: &Bench) {
    bench.synth("clip.y4m", 40, "");
    bench.json("new p.honami clip.y4m");
    assert_eq!(bench.edit("p.honami", "add 0 5 5").code, Some(0));
}

/// So many key-frames, each in its frame.
fn script(n: u32) -> String {
    (0..n).map(|k| format!("key 0 {} {} {}\n", k % 40, k % 160, k % 120)).collect()
}

fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}

/// Whether this process may mount, which nobody else sees.
fn may_mount() -> bool {
    let tried = Command::new("unshare").args(["-m", "mount", "-t", "tmpfs", "none", "/mnt"]).output();
    tried.is_ok_and(|tried| tried.status.success())
}

/// Runs a line of a shell in the bench's folder, `$HONAMI` being the program, with a script as its input.
fn shell(bench: &Bench, line: &str, input: &str) -> Ran {
    // What has the program's environment is made into a shell.
    let model = bench.command([""; 0]);
    let mut command = Command::new("sh");
    command.args(["-c", line]).env("HONAMI", program()).current_dir(bench.path(""));
    command.envs(model.get_envs().filter_map(|(name, value)| Some((name, value?))));
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::scope(|scope| {
        // A program that refuses does not read on.
        let input =
            std::thread::Builder::new().spawn_scoped(scope, move || drop(stdin.write_all(input.as_bytes())));
        assert!(input.is_ok());
        child.wait_with_output().unwrap()
    });
    ran(writer)
}

/// Every edit that was answered is in the log, and the project is whole.
#[track_caller]
fn assert_all_there(bench: &Bench, project: &str, answered: usize) {
    assert_whole(bench, project);
    // The root and the first track are there from before.
    let edits = bench.log(project, "edit").len();
    assert_eq!(edits, answered + 2, "{project}: edits in the log");
}

/// It failed, in one line that says what is the matter, and what it had answered is there.
#[track_caller]
fn assert_told(bench: &Bench, project: &str, ran: &Ran, wanted: &str) {
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.stderr.contains(wanted) && ran.stderr.trim().lines().count() == 1, "{}", ran.stderr);
    assert_all_there(bench, project, ran.stdout.lines().count());
}

#[test]
fn a_full_disk_is_told_and_takes_nothing() {
    if !is_root() || !may_mount() {
        return skipped("root and the right to mount, for a small tmpfs that gets full");
    }
    let bench = Bench::new();
    project(&bench);
    let line = "mkdir small && unshare -m sh -c 'mount -t tmpfs -o size=2m none small && cp p.honami clip.y4m small/ 2> cp.log; \
                $HONAMI edit small/p.honami; code=$?; cp small/p.honami full.honami; exit $code'";
    let ran = shell(&bench, line, &script(20_000));
    assert_told(&bench, "full.honami", &ran, "the disk is full");
    assert!(ran.stdout.lines().count() > 100, "it worked before: {ran:?}");
}

#[test]
fn writes_that_are_cut_short_are_told_and_take_nothing() {
    let bench = Bench::new();
    project(&bench);
    let size = fs::metadata(bench.path("p.honami")).unwrap().len();
    // Blocks of 512 bytes.
    let blocks = size / 512 + 40;
    let ran = shell(&bench, &format!("ulimit -f {blocks}; exec $HONAMI edit p.honami"), &script(20_000));
    assert_told(&bench, "p.honami", &ran, "nothing was changed");
}

#[test]
fn a_folder_that_refuses_is_told_and_can_be_looked_at() {
    let bench = Bench::new();
    project(&bench);
    let both = "$HONAMI log p.honami > /dev/null && exec $HONAMI edit p.honami";
    let ran = if is_root() {
        if !may_mount() {
            return skipped("a user who is not root, or the right to mount");
        }
        // Root is refused by file systems alone.
        let mount = "mount --bind . only && mount -o remount,bind,ro only && cd only";
        shell(&bench, &format!("mkdir only && exec unshare -m sh -c '{mount} && {both}'"), &script(1))
    } else {
        shell(&bench, &format!("chmod 500 . && trap 'chmod 700 .' EXIT && ({both})"), &script(1))
    };
    assert_told(&bench, "p.honami", &ran, "cannot lock the project");
}

#[test]
fn a_lock_of_a_dead_host_and_files_of_the_future_hold_nobody_up() {
    let bench = Bench::new();
    project(&bench);
    let lock = r#"{"user":"ada","host":"node17","pid":1,"since":"2126-01-01T00:00:00Z"}"#;
    for left in [lock, "", "{\"user\":\"ad", "\0\0\0"] {
        fs::write(bench.path(".p.honami.lock"), left).unwrap();
        // A clock that was set back leaves files of the future.
        let future = SystemTime::now() + Duration::from_secs(400 * 86_400);
        for name in [".p.honami.lock", "p.honami", "clip.y4m"] {
            fs::File::options().write(true).open(bench.path(name)).unwrap().set_modified(future).unwrap();
        }
        let ran = bench.edit("p.honami", "key 0 3 4 5\nundo\n");
        assert_eq!(ran.code, Some(0), "{left:?}: {ran:?}");
        assert!(!bench.path(".p.honami.lock").exists());
    }
    bench.json("track p.honami --with klt");
    assert_whole(&bench, "p.honami");
}

/// Has a session answer one edit, does something to its project, and has it go on.
fn under_a_session(bench: &Bench, change: impl FnOnce(&Path)) -> (usize, Ran) {
    let mut command = bench.command(["edit", "p.honami"]);
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().unwrap();
    let mut script = child.stdin.take().unwrap();
    script.write_all(b"key 0 3 20 30\n").unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap());
    let mut answer = String::new();
    answers.read_line(&mut answer).unwrap();
    change(&bench.path("p.honami"));
    // It may be gone already.
    drop(script.write_all(b"key 0 4 20 30\nkey 0 5 20 30\n"));
    drop(script);
    let more = answers.lines().map_while(Result::ok).count();
    (more, ran(child.wait_with_output().unwrap()))
}

#[test]
fn a_project_that_is_removed_or_replaced_under_its_session_is_never_written_to_in_silence() {
    for is_replaced in [false, true] {
        let bench = Bench::new();
        project(&bench);
        fs::copy(bench.path("p.honami"), bench.path("other.honami")).unwrap();
        let (more, ran) = under_a_session(&bench, |path| {
            fs::rename(path, bench.path("away.honami")).unwrap();
            if is_replaced {
                fs::rename(bench.path("other.honami"), path).unwrap();
            }
        });
        assert_eq!((ran.code, more), (Some(1), 0), "replaced: {is_replaced}, {ran:?}");
        assert!(ran.stderr.contains("moved, removed or replaced while it was open"), "{ran:?}");
        // What was answered is where the project went.
        assert_whole(&bench, "away.honami");
        assert_eq!(bench.log("away.honami", "edit").len(), 3);
        if is_replaced {
            assert_all_there(&bench, "p.honami", 0);
        }
    }
}
