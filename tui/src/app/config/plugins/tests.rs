//! Settings of plugins: what is understood, and what is wrong.

use super::*;

fn read(text: &str) -> (Plugins, Vec<String>) {
    let table: Table = text.parse().unwrap_or_default();
    Plugins::of(table.get("plugins"))
}

#[test]
fn what_is_settled_of_plugins_holds() {
    let usual = Limits::default();
    for (text, memory, [tell, end, stop]) in [
        ("", None, [1.8, 10.0, 3.0]),
        ("[plugins]", None, [1.8, 10.0, 3.0]),
        ("[plugins]\nmemory = 8589934592", Some(8 << 30), [1.8, 10.0, 3.0]),
        ("[plugins]\nmemory = \"8 GiB\"\nstop = 0.5", Some(8 << 30), [1.8, 10.0, 0.5]),
        ("[plugins]\nmemory = \"64MiB\"\ntell = 5\nend = 60", Some(64 << 20), [5.0, 60.0, 3.0]),
        ("[plugins]\nmemory = \"1 TiB\"", Some(1 << 40), [1.8, 10.0, 3.0]),
        // It is told at its end at the latest.
        ("[plugins]\nend = 1", None, [1.0, 1.0, 3.0]),
    ] {
        let (plugins, wrong) = read(text);
        let limits = plugins.limits;
        let times = [limits.tell, limits.end, limits.stop].map(|time| time.as_secs_f64());
        assert_eq!((limits.memory_bytes, times), (memory, [tell, end, stop]), "{text}");
        assert_eq!((limits.start, wrong), (usual.start, Vec::new()), "{text}");
    }
    let (plugins, wrong) =
        read("[plugins.hosting]\nklt = \"isolated\"\n\"org.lab.trackers.snail\" = \"in-process\"");
    let hosting = [("klt", Hosting::Isolated), ("org.lab.trackers.snail", Hosting::InProcess)];
    assert_eq!(plugins.hosting, hosting.map(|(name, place)| (name.to_owned(), place)).into());
    assert_eq!(wrong, Vec::<String>::new());
    let strangers = plugins.strangers(&Registry::default());
    assert_eq!(strangers[0], "plugins.hosting.klt: no such plugin is here");
}

#[test]
fn what_is_wrong_of_plugins_is_named_and_is_as_usual() {
    let memory = |got: &str| {
        format!("plugins.memory: 64 MiB or more is wanted, as \"8 GiB\" or in bytes; got {got}: no limit")
    };
    let seconds =
        |name: &str, got: &str| format!("plugins.{name}: seconds are wanted, up to a day; got {got}");
    for (text, expect) in [
        ("plugins = 3", "plugins: a table is wanted, [plugins]".to_owned()),
        (
            "[plugins]\nmem = 3",
            "plugins.mem is not known; there are memory, tell, end, stop, hosting".to_owned(),
        ),
        ("[plugins]\nmemory = 8", memory("8")),
        ("[plugins]\nmemory = -1", memory("-1")),
        ("[plugins]\nmemory = \"8 GB\"", memory("\"8 GB\"")),
        ("[plugins]\nmemory = \"GiB\"", memory("\"GiB\"")),
        ("[plugins]\nmemory = \"much\"", memory("\"much\"")),
        ("[plugins]\nmemory = \"\"", memory("\"\"")),
        ("[plugins]\nmemory = \"99999999999 TiB\"", memory("\"99999999999 TiB\"")),
        ("[plugins]\nmemory = true", memory("true")),
        ("[plugins]\ntell = \"2 s\"", seconds("tell", "\"2 s\"")),
        ("[plugins]\nend = 0", seconds("end", "0")),
        ("[plugins]\nend = -1.5", seconds("end", "-1.5")),
        ("[plugins]\nstop = nan", seconds("stop", "nan")),
        ("[plugins]\nstop = inf", seconds("stop", "inf")),
        ("[plugins]\nstop = 86401", seconds("stop", "86401")),
        ("[plugins]\ntell = 20", "plugins.tell: 20s would come after the end, 10s: neither holds".to_owned()),
        (
            "[plugins]\nhosting = \"isolated\"",
            "plugins.hosting: a table is wanted, [plugins.hosting]".to_owned(),
        ),
        (
            "[plugins.hosting]\nklt = \"in process\"",
            "plugins.hosting.klt: \"isolated\" or \"in-process\" is wanted, got \"in process\": isolated"
                .to_owned(),
        ),
    ] {
        let (plugins, wrong) = read(text);
        assert_eq!(wrong, [expect], "{text}");
        let (limits, usual) = (plugins.limits, Limits::default());
        let times = |limits: Limits| [limits.tell, limits.end, limits.stop];
        assert_eq!((limits.memory_bytes, times(limits)), (None, times(usual)), "{text}");
        assert!(plugins.hosting.values().all(|place| *place == Hosting::Isolated), "{text}");
    }
}

#[test]
fn a_misspelt_word_of_the_environment_is_named() {
    let place = "HONAMI_HOSTING: \"isolated\" or \"in-process\" is wanted, got \"bogus\": isolated";
    let bytes =
        "HONAMI_PLUGIN_MEMORY: 67108864 bytes or more are wanted, got \"8 GB\": as config.toml has it";
    let wrong = |word: &str| word.to_owned();
    for (hosting, memory, lines) in [
        (None, None, &[][..]),
        (Some(Ok(Hosting::InProcess)), Some(Ok(1 << 30)), &[]),
        (Some(Err(wrong("bogus"))), Some(Err(wrong("8 GB"))), &[place, bytes]),
    ] {
        assert_eq!(misspelt(hosting, memory), lines);
    }
}
