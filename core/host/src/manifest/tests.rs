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
