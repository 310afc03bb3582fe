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
    ] {
        let ran = settled(&bench, settings, TRACK, variables);
        assert!(
            ran.code == Some(1) && ran.stderr.contains("no memory for a gigabyte"),
            "{settings}: {ran:?}"
        );
    }
}

#[test]
fn plugins_work_where_it_was_settled() {
    let Some(bench) = bench("NONE") else { return };
    let (bad, klt) = (TRACK, "track p.honami --with klt --points points.csv");
    for (settings, line, variables, here) in [
        ("", bad, &[][..], false),
        ("[plugins.hosting]\nbad = \"in-process\"", bad, &[], true),
        ("[plugins.hosting]\nbad = \"in-process\"", bad, &[("HONAMI_HOSTING", "isolated")], false),
        ("[plugins.hosting]\nbad = \"in-process\"", klt, &[], true),
        ("[plugins.hosting]\nklt = \"isolated\"", klt, &[], false),
    ] {
        let ran = settled(&bench, settings, line, variables);
        assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{settings}: {ran:?}");
        let runs = bench.log("p.honami", "run");
        let sandbox = &runs[runs.len() - 1]["provenance"]["sandbox"];
        assert_eq!(sandbox == "in process", here, "{settings} {line} {variables:?}: {sandbox}");
    }
    assert!(bench.text("log p.honami").contains("  in process"));
}

#[test]
fn a_misspelt_word_of_the_environment_is_said_once_and_isolates() {
    let Some(bench) = bench("NONE") else { return };
    let settings = "[plugins.hosting]\nbad = \"in-process\"";
    for line in [TRACK, "plugin list --plugin bad.so", "doctor"] {
        let ran = settled(&bench, settings, line, &[("HONAMI_HOSTING", "bogus")]);
        let said = format!("{}{}", ran.stdout, ran.stderr);
        assert_eq!(said.matches("is wanted, got \"bogus\": isolated").count(), 1, "{line}: {ran:?}");
    }
    assert_ne!(bench.log("p.honami", "run")[0]["provenance"]["sandbox"], "in process");
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
