//! Plugins with nothing wrong pass.

use crate::tools::{check, compile, failed, has_cc};

#[test]
fn the_example_in_c_and_the_frame_of_the_bad_ones_pass_the_first_levels() {
    if !has_cc() {
        return;
    }
    for (source, name, flags) in [
        ("../abi/examples/null_tracker.c", "null", &[][..]),
        ("tests/bad/loaded.c", "none", &["-DFAULT=NONE"]),
    ] {
        let library = compile(source, name, flags);
        let failed = failed(&check(&library, |check| check.level <= 3));
        assert!(failed.is_empty(), "{name}: {failed:?}");
    }
}

#[test]
fn what_the_bad_ones_are_made_from_passes_all_that_is_asked_of_everybody() {
    if !has_cc() {
        return;
    }
    for name in ["tracker", "clusterer", "structure", "simulator"] {
        let library = compile(&format!("tests/bad/{name}.c"), name, &["-DFAULT=NONE", "-lm"]);
        let failed = failed(&check(&library, |check| check.level <= 9));
        assert!(failed.is_empty(), "{name}: {failed:?}");
    }
}

#[test]
fn no_check_lets_a_library_reach_out() {
    if !has_cc() {
        return;
    }
    // It dies wherever it gets a socket.
    let library = compile("tests/bad/tracker.c", "reaches-out", &["-DFAULT=REACHES_OUT", "-lm"]);
    let failed = failed(&check(&library, |check| (4..=9).contains(&check.level)));
    assert!(failed.is_empty(), "{failed:?}");
}
