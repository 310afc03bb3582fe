//! Manifests: what is ignored, what is refused.

use super::*;

fn with(params: &str) -> Result<Manifest, String> {
    let json = format!(
        r#"{{"honami":1,"abi":[1,3],"library":{{"id":"l","version":"1","new":0}},"needs":{{}},
            "plugins":[{{"id":"a.b","kind":"wizard","name":"B","later":true,"params":[{params}]}}]}}"#
    );
    Manifest::parse(json.as_bytes())
}

#[test]
fn what_a_later_manifest_adds_is_ignored() {
    let manifest =
        with(r#"{"id":"n","type":"int","default":1,"colour":"red"},{"id":"old","renamed_to":"n"}"#).unwrap();
    let (params, renamed) = manifest.plugins[0].params().unwrap();
    assert_eq!((params[0].label.as_str(), renamed["old"].as_str()), ("n", "n"));
    assert!(!manifest.plugins[0].caps.parallel_instances, "what is not said is not so");
}

#[test]
fn what_cannot_be_is_refused_with_its_name() {
    for (params, wanted) in [
        (r#"{"id":"n","type":"int","default":9,"max":8}"#, "n: wanted a whole number, at most 8, got \"9\""),
        (r#"{"id":"n","type":"int"}"#, "parameter \"n\": missing field `default`"),
        (r#"{"id":"n","type":"mood","default":1}"#, "parameter \"n\": unknown variant `mood`"),
        (r#"{"id":"e","type":"enum","default":"x","entries":[{"id":"y"}]}"#, "e: wanted one of y, got \"x\""),
        (
            r#"{"id":"n","type":"bool","default":true},{"id":"n","type":"bool","default":true}"#,
            "two parameters",
        ),
    ] {
        let got = with(params).expect_err(params);
        assert!(got.contains("manifest of a.b") && got.contains(wanted), "wanted {wanted}, got {got}");
    }
    assert!(Manifest::parse(br#"{"honami":2}"#).is_err());
}

#[test]
fn no_member_brings_what_moves_a_cursor_or_turns_text() {
    let whole = serde_json::json!({
        "honami": 1, "abi": [1, 0], "exec": ["python3", "it.py"], "later": { "new": ["thing"] },
        "library": { "id": "org.it", "version": "1", "license": "MIT" },
        "needs": { "exec": true, "read": ["/some/where"] },
        "plugins": [{
            "id": "org.it.a", "kind": "tracker", "name": "A", "doc": "lines\n\tof text", "cite": ["Somebody 1981"],
            "interfaces": ["honami.tracker/1"], "caps": { "pixels": ["gray8"] },
            "params": [{
                "id": "e", "type": "enum", "default": "x", "label": "E", "group": "g", "doc": "d", "unit": "px",
                "affects": "track", "when": { "e": "x" }, "entries": [{ "id": "x", "label": "X", "doc": "d" }],
            }],
        }],
    })
    .to_string();
    Manifest::parse(whole.as_bytes()).unwrap();
    // Every string of it, names of members among them, one after the other.
    let ends: Vec<usize> =
        (1..whole.len()).filter(|n| whole[*n..].starts_with('"')).skip(1).step_by(2).collect();
    assert!(ends.len() > 50, "{ends:?}");
    for end in ends {
        for letter in ["\\u001b[2J", "\\u0000", "\\r", "\\u009b", "\u{202e}", "\u{feff}"] {
            let hostile = format!("{}{letter}{}", &whole[..end], &whole[end..]);
            let why = Manifest::parse(hostile.as_bytes()).expect_err(&hostile);
            assert!(why.contains("wanted text without control characters"), "{hostile}: {why}");
            assert!(!why.chars().any(is_hidden), "{why:?}");
        }
    }
    let lines = whole.replace("org.it.a", "org.it\\na");
    assert!(Manifest::parse(lines.as_bytes()).is_err(), "only a doc has lines");
}
