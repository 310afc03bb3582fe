//! The header, its frozen copy and the mirror say the same: sizes, offsets, numbers, ids.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
#![expect(clippy::print_stderr, reason = "a test that is skipped says so")]

use honami_abi::layout::{FLOATS, IDS, NUMBERS, STABLE, Struct};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Of `abi/1.n/honami.h`, by minor. Those that were released never change: what grows is `include/honami.h`, under another
/// minor. The newest is a draft until it is released, and changes together with that, never unseen.
const HEADERS_SHA256: [&str; 2] = [
    "2c2dc1eeb9df65b2b1c5c85af35a0948c4073109a9adac9846e97de6a1e3f8d3",
    "e976ef54a1eed10620f1d93a14dd90f61decf7ce9afa08e3fde62b6aaa5299e8",
];

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root(path)).unwrap()
}

/// Compiles a text as C99 and as C++11; says so where there is no compiler.
fn check(name: &str, source: &str) {
    check_as(&[("cc", "c", "-std=c99"), ("c++", "c++", "-std=c++11")], name, source);
}

/// Compiles without a warning, by each compiler in its language and standard.
fn check_as(compilers: &[(&str, &str, &str)], name: &str, source: &str) {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&file, source).unwrap();
    for &(compiler, language, standard) in compilers {
        let output = Command::new(compiler)
            .args([
                "-x",
                language,
                standard,
                "-pedantic",
                "-Wall",
                "-Wextra",
                "-Werror",
                "-fsyntax-only",
                "-I",
            ])
            .args([root("include"), file.clone()])
            .output();
        match output {
            Err(_) => eprintln!("skipped: needs {compiler}"),
            Ok(output) => {
                assert!(output.status.success(), "{compiler}: {}", String::from_utf8_lossy(&output.stderr))
            }
        }
    }
}

/// C99 has no `_Static_assert`: an array of negative size will do.
fn assert_c(source: &mut String, condition: &str) {
    let n = source.lines().count();
    writeln!(source, "typedef char assert_{n}[({condition}) ? 1 : -1];").unwrap();
}

fn assert_struct(source: &mut String, of: &Struct) {
    let c = of.c_name;
    assert_c(source, &format!("sizeof({c}) == {}", of.size));
    // The alignment is the offset after one byte.
    writeln!(source, "typedef struct {{ char one; {c} it; }} align_{c};").unwrap();
    assert_c(source, &format!("offsetof(align_{c}, it) == {}", of.align));
    for field in of.fields {
        let f = field.c_name;
        assert_c(source, &format!("offsetof({c}, {f}) == {}", field.offset));
        assert_c(source, &format!("sizeof((({c} *)0)->{f}) == {}", field.size));
    }
    if of.fields[0].c_name == "struct_size" {
        let last = of.fields[of.fields.len() - 1].c_name;
        assert_c(source, &format!("HONAMI_SIZE_TO({c}, {last}) == sizeof({c})"));
    }
}

#[test]
fn c_lays_everything_out_as_the_table_says() {
    let mut source = "#include \"honami.h\"\n".to_owned();
    for of in STABLE {
        assert_struct(&mut source, of);
    }
    for (name, number) in NUMBERS {
        assert_c(&mut source, &format!("(long long)({name}) == {number}LL"));
    }
    for (name, id) in IDS {
        assert_c(&mut source, &format!("sizeof({name}) == {}", id.to_bytes_with_nul().len()));
    }
    check("layout.c", &source);
}

#[test]
fn the_table_has_every_struct_number_and_id_of_the_header() {
    let mut structs = BTreeSet::new();
    let mut numbers = BTreeSet::new();
    let text = read("include/honami.h");
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("typedef struct ") {
            structs.insert(name.split([' ', '{', ';']).next().unwrap().to_owned());
        }
        let Some((name, value)) = line.strip_prefix("#define ").and_then(|rest| rest.split_once(' ')) else {
            continue;
        };
        if let Some(id) = value.trim().strip_prefix('"') {
            let (_, mirrored) = IDS.iter().find(|(c_name, _)| *c_name == name).unwrap();
            assert_eq!(mirrored.to_str().unwrap(), id.trim_end_matches('"'), "{name}");
        } else if let Some((_, mirrored)) = FLOATS.iter().find(|(c_name, _)| *c_name == name) {
            assert_eq!(value.trim_matches(['(', ')', 'f']).parse(), Ok(*mirrored), "{name}");
        } else if name.starts_with("HONAMI_") && !name.contains('(') && name != "HONAMI_EXPORT" {
            numbers.insert(name.to_owned());
        }
    }
    let in_table = STABLE.iter().map(|of| of.c_name.to_owned()).collect();
    assert_eq!(structs, in_table);
    assert_eq!(numbers, NUMBERS.iter().map(|(name, _)| (*name).to_owned()).collect());
}

#[test]
fn the_headers_that_are_kept_are_those_that_were_kept() {
    for (minor, wanted) in HEADERS_SHA256.iter().enumerate() {
        let path = format!("abi/1.{minor}/honami.h");
        let hash: String = Sha256::digest(read(&path)).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hash, *wanted, "{path}: bring one that is frozen back; say here what became of a draft");
    }
    let newest = format!("abi/1.{}/honami.h", honami_abi::ABI_MINOR);
    assert_eq!(honami_abi::ABI_MINOR as usize, HEADERS_SHA256.len() - 1, "every minor is kept");
    assert_eq!(read("include/honami.h"), read(&newest), "the header of today is that of the newest minor");
}

/// Old structs are the first part of new ones: nothing in a frozen header may be taken away or turned.
#[test]
fn a_newer_header_has_all_fields_of_an_older_one_in_the_same_places() {
    for minor in 0..HEADERS_SHA256.len() {
        let (older, newer) = (read(&format!("abi/1.{minor}/honami.h")), read("include/honami.h"));
        for (name, fields) in structs(&older) {
            let now = structs(&newer).remove(&name).unwrap();
            assert_eq!(now[..fields.len()], fields, "{name} of 1.{minor}");
        }
    }
}

/// The declarations of every struct of a header, in order, without comments.
fn structs(header: &str) -> BTreeMap<String, Vec<String>> {
    let pieces = header.split("/*").enumerate();
    let code: String =
        pieces.map(|(k, piece)| if k == 0 { piece } else { piece.split_once("*/").unwrap().1 }).collect();
    let bodies = code.split("struct ").filter_map(|part| {
        let (name, rest) = part.split_once(" {")?;
        let (body, _) = rest.split_once('}')?;
        let one_line = |field: &str| field.split_whitespace().collect::<Vec<_>>().join(" ");
        let fields = body.split(';').map(one_line).filter(|field| !field.is_empty()).collect();
        name.starts_with("honami_").then(|| (name.to_owned(), fields))
    });
    bodies.collect()
}

#[test]
fn the_headers_and_the_examples_compile_by_themselves() {
    check("alone.c", "#include \"honami.h\"\n");
    check("null_tracker.c", &read("examples/null_tracker.c"));
    check("tint_tracker.c", &read("examples/tint_tracker.c"));
    for file in ["template_tracker.c", "template_structure.c"] {
        check_as(&[("cc", "c", "-std=c99")], file, &read(&format!("examples/{file}")));
    }
    let cpp = [("c++", "c++", "-std=c++17"), ("c++", "c++", "-std=c++20")];
    for file in ["template_tracker.cpp", "template_structure.cpp"] {
        check_as(&cpp, file, &read(&format!("examples/{file}")));
    }
}

#[test]
fn a_shorter_struct_lacks_the_fields_behind_its_size() {
    let shorter = honami_abi::TrackerV1 {
        struct_size: honami_abi::size_to!(honami_abi::TrackerV1, retire) as u32,
        latency: 0,
        begin: None,
        seed: None,
        retire: None,
        push: None,
        end: None,
    };
    assert!(honami_abi::has!(shorter, honami_abi::TrackerV1, retire));
    assert!(!honami_abi::has!(shorter, honami_abi::TrackerV1, push));
}
