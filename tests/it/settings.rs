//! What a user has settled of plugins, through the real program.

use std::fs;

use honami_tests::{Bench, Ran, ran};

use crate::isolated::{compile, has_cc, project};

const TRACK: &str = "track p.honami --plugin bad.so --with bad --points points.csv";

/// A project, and a tracker with a fault; `None` without a C compiler.
fn bench(fault: &str) -> Option<Bench> {
    let bench = Bench::new();
    has_cc().then(|| {
        compile(&bench, "bad.so", &[&format!("-DFAULT={fault}")]);
        project(&bench);
        bench
    })
}

/// The tracker works in honami itself.
const INSIDE: &str = "[plugins.hosting]\n\"org.honami.bad\" = \"in-process\"";

/// Writes the settings, and runs a command line with these variables in the environment.
fn settled(bench: &Bench, settings: &str, line: &str, variables: &[(&str, &str)]) -> Ran {
    let folder = bench.path("XDG_CONFIG_HOME/honami");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("config.toml"), settings).unwrap();
    let mut command = bench.command(line.split(' '));
    command.env_remove("HONAMI_HOSTING").envs(variables.iter().copied());
    ran(command.output().unwrap())
}

#[test]
fn a_plugin_gets_no_more_memory_than_was_settled() {
    let Some(bench) = bench("LEAKS") else { return };
    let limit = ("HONAMI_PLUGIN_MEMORY", "536870912");
    for (settings, variables) in [
        ("[plugins]\nmemory = \"512 MiB\"", &[][..]),
        // The environment stands over it.
        ("[plugins]\nmemory = \"64 GiB\"", &[limit]),
        // What is misspelt does not.
        ("[plugins]\nmemory = \"512 MiB\"", &[("HONAMI_PLUGIN_MEMORY", "8 GB")]),
    ] {
        let ran = settled(&bench, settings, TRACK, variables);
        assert!(
            ran.code == Some(1) && ran.stderr.contains("no memory for a gigabyte"),
            "{settings}: {ran:?}"
        );
        let is_said = ran.stderr.contains("67108864 bytes or more are wanted, got \"8 GB\": as config.toml");
        assert_eq!(is_said, variables != [limit] && !variables.is_empty(), "{variables:?}: {ran:?}");
    }
}

#[test]
fn plugins_work_where_it_was_settled() {
    let Some(bench) = bench("NONE") else { return };
    let (bad, klt) = (TRACK, "track p.honami --with klt --points points.csv");
    let short = "[plugins.hosting]\nbad = \"in-process\"";
    // A short name is nobody's own: it gives full trust to nothing that did not come with honami.
    let told = "plugins.hosting.bad: its whole id is wanted, \"org.honami.bad\": isolated\n";
    for (settings, line, variables, here, said) in [
        ("", bad, &[][..], false, ""),
        (INSIDE, bad, &[], true, ""),
        (INSIDE, bad, &[("HONAMI_HOSTING", "isolated")], false, ""),
        (INSIDE, klt, &[], true, ""),
        (short, bad, &[], false, told),
        (short, bad, &[("HONAMI_HOSTING", "in-process")], true, ""),
        ("[plugins.hosting]\nklt = \"in-process\"", klt, &[], true, ""),
        ("[plugins.hosting]\nklt = \"isolated\"", klt, &[], false, ""),
    ] {
        let ran = settled(&bench, settings, line, variables);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), said), "{settings}: {ran:?}");
        assert_eq!(was_here(&bench), here, "{settings} {line} {variables:?}");
    }
    assert!(bench.text("log p.honami").contains("  in process"));
    let doctor = settled(&bench, short, "doctor --plugin bad.so", &[]).stdout;
    assert!(doctor.contains(told.trim()), "{doctor}");
}

/// Whether the newest run of the project was in honami's own process.
fn was_here(bench: &Bench) -> bool {
    let runs = bench.log("p.honami", "run");
    let newest = runs.iter().max_by_key(|run| run["id"].as_u64()).unwrap();
    newest["provenance"]["sandbox"] == "in process"
}

#[test]
fn what_honami_died_with_works_apart_from_then_on_until_it_is_rebuilt_or_let_in_again() {
    let Some(bench) = bench("SEGFAULT") else { return };
    let settings = INSIDE;
    let said = "bad works in a process of its own: honami ended while it was inside; `honami plugin retry --in-process /";
    // A run that nobody has ended keeps the numbers of its tracks: each begins with a project that has none.
    let track = |with: &str| {
        fs::copy(bench.path("p.honami"), bench.path("empty.honami")).unwrap();
        let ran = settled(&bench, settings, &format!("track p.honami {with} --points points.csv"), &[]);
        let here = (ran.code == Some(0)).then(|| was_here(&bench));
        fs::rename(bench.path("empty.honami"), bench.path("p.honami")).unwrap();
        (here, ran.stderr.contains(said))
    };
    let bad = "--plugin bad.so --with bad";
    assert_eq!(track(bad), (None, false), "it dies");
    // Who starts no plugin, or hears nothing but JSON, leaves it to who does.
    for line in ["plugin list --json --plugin bad.so", "plugin list", "doctor --json"] {
        let ran = settled(&bench, settings, line, &[]);
        assert!(!format!("{}{}", ran.stdout, ran.stderr).contains(said), "{line}: {ran:?}");
    }
    // It is told once, and costs a frame instead of honami.
    assert_eq!([bad; 2].map(track), [(Some(false), true), (Some(false), false)]);
    let list = settled(&bench, settings, "plugin list --plugin bad.so", &[]).stdout;
    let inside = "honami has ended while it was inside, `honami plugin retry --in-process bad.so` lets it in";
    assert!(list.contains(inside), "{list}");
    // What did come with honami leaves no trail, nor does what ends well.
    assert_eq!(track("--with klt"), (Some(true), false));
    // To let what is held go is not to let it in.
    for (line, said, then) in [
        ("plugin retry bad.so", "bad was not held: nothing to do", Some(false)),
        ("plugin retry --in-process bad.so", "bad may start again, also in honami's own process", None),
    ] {
        assert_eq!(settled(&bench, settings, line, &[]).stdout.trim(), said);
        assert_eq!(track(bad), (then, false), "{line}");
    }
    // Another build is another plugin, though what became of the one before is told.
    compile(&bench, "bad.so", &["-DFAULT=NONE"]);
    assert_eq!([bad; 2].map(track), [(Some(true), true), (Some(true), false)]);
    let left = fs::read_dir(bench.path("XDG_CACHE_HOME/honami/quarantine")).unwrap();
    let left: Vec<_> = left.map(|entry| entry.unwrap().path()).collect();
    assert!(left.iter().all(|path| path.extension().is_none_or(|e| e != "inside")), "{left:?}");
}

#[test]
fn a_misspelt_word_of_the_environment_is_said_once_and_isolates() {
    let Some(bench) = bench("NONE") else { return };
    let settings = INSIDE;
    for line in [TRACK, "plugin list --plugin bad.so", "doctor"] {
        let ran = settled(&bench, settings, line, &[("HONAMI_HOSTING", "bogus")]);
        let said = format!("{}{}", ran.stdout, ran.stderr);
        assert_eq!(said.matches("is wanted, got \"bogus\": isolated").count(), 1, "{line}: {ran:?}");
    }
    assert!(!was_here(&bench));
}

#[test]
fn what_is_wrong_with_settings_of_plugins_is_said_by_commands_that_start_them() {
    let Some(bench) = bench("NONE") else { return };
    let settings = "[plugins]\nmemory = \"much\"\n[plugins.hosting]\nbad = \"here\"\nsnail = \"isolated\"";
    let ran = settled(&bench, settings, TRACK, &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.stderr.contains("config.toml: plugins.memory: 64 MiB or more is wanted"), "{ran:?}");
    assert!(ran.stderr.contains("and 1 more"), "{ran:?}");
    let doctor = bench.json("doctor --plugin bad.so");
    let wrong: Vec<&str> = doctor["settings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
    assert!(
        wrong[1].starts_with("plugins.hosting.bad: \"isolated\" or \"in-process\" is wanted"),
        "{wrong:?}"
    );
    assert_eq!(wrong[2..], ["plugins.hosting.snail: no such plugin is here"]);
}
