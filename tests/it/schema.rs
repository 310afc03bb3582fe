//! The JSON schema of manifests: what ships satisfies it, what is wrong does not.

use std::fs;
use std::path::Path;

use honami_tests::{program, root};
use serde_json::{Value, json};

fn schema() -> Value {
    serde_json::from_str(&fs::read_to_string(root().join("core/abi/manifest.schema.json")).unwrap()).unwrap()
}

/// What is wrong with a value by a schema, and where: of JSON Schema 2020-12, the words that ours uses.
fn wrong(schema: &Value, value: &Value, all: &Value, at: &str) -> Option<String> {
    let mut found = None;
    for (word, said) in schema.as_object().unwrap() {
        let many = || said.as_array().unwrap();
        let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
        let len = value.as_array().map_or(0, Vec::len) as f64;
        let holds = match word.as_str() {
            "$schema" | "$defs" | "title" | "description" => true,
            "type" => match said.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.is_i64() || value.is_u64(),
                other => panic!("type {other} is not known here"),
            },
            "const" => said == value,
            "enum" => many().contains(value),
            "minimum" => number(value) >= number(said),
            "minItems" => len >= number(said),
            "maxItems" => len <= number(said),
            "minLength" => value.as_str().is_none_or(|text| text.chars().count() as f64 >= number(said)),
            "required" => many().iter().all(|key| value.get(key.as_str().unwrap()).is_some()),
            "$ref" => {
                let named = said.as_str().unwrap().strip_prefix('#').and_then(|path| all.pointer(path));
                found = found.or(wrong(named.unwrap(), value, all, at));
                true
            }
            "allOf" => {
                found = found.or(many().iter().find_map(|one| wrong(one, value, all, at)));
                true
            }
            "oneOf" => many().iter().filter(|one| wrong(one, value, all, at).is_none()).count() == 1,
            "properties" => {
                let members = said.as_object().unwrap().iter();
                let mut given = members.filter_map(|(key, schema)| Some((key, schema, value.get(key)?)));
                found = found
                    .or(given.find_map(|(key, schema, v)| wrong(schema, v, all, &format!("{at}/{key}"))));
                true
            }
            "items" => {
                let mut items = value.as_array().into_iter().flatten().enumerate();
                found = found.or(items.find_map(|(k, item)| wrong(said, item, all, &format!("{at}/{k}"))));
                true
            }
            other => panic!("the schema says {other}, which is not known here"),
        };
        if !holds {
            return Some(format!("{at}: {word} {said}, got {value}"));
        }
    }
    found
}

/// Whether the manifest of a library, or beside a program, is as the schema wants it.
#[track_caller]
pub(crate) fn assert_satisfied(plugin: &Path) {
    let schema = schema();
    assert_eq!(wrong(&schema, &manifest_of(plugin), &schema, ""), None, "{}", plugin.display());
}

/// The manifest beside a program, or in a library's note: JSON that ends with a NUL.
fn manifest_of(plugin: &Path) -> Value {
    if plugin.extension().is_some_and(|ending| ending == "py") {
        return serde_json::from_slice(&fs::read(plugin.with_extension("honami.json")).unwrap()).unwrap();
    }
    let bytes = fs::read(plugin).unwrap();
    let head = b"{\"honami\":1,";
    let start = bytes.windows(head.len()).position(|window| window == head).unwrap();
    let json = bytes[start..].split(|byte| *byte == 0).next().unwrap();
    serde_json::from_slice(json).unwrap()
}

#[test]
fn what_ships_satisfies_the_schema() {
    let mut n_libraries = 0;
    for entry in fs::read_dir(program().parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("libhonami_") && name.ends_with(".so") {
            assert_satisfied(&path);
            n_libraries += 1;
        }
    }
    assert!(n_libraries > 5, "{n_libraries} libraries beside the program");
}

#[test]
fn what_is_wrong_with_a_manifest_is_found() {
    let schema = schema();
    let good = json!({
        "honami": 1, "abi": [1, 1], "library": {"id": "org.me", "version": "1"}, "unknown": true,
        "plugins": [{"id": "org.me.mine", "kind": "tracker", "name": "Mine", "interfaces": ["honami.tracker/1"],
            "params": [
                {"id": "r", "type": "int", "default": 7, "min": 2, "max": 30, "unit": "px"},
                {"id": "radius", "renamed_to": "r"},
                {"id": "m", "type": "enum", "default": "a", "entries": [{"id": "a", "label": "A"}]},
            ]}],
    });
    assert_eq!(wrong(&schema, &good, &schema, ""), None);
    for (place, value, wanted) in [
        ("/honami", json!(2), "/honami: const"),
        ("/abi", json!([1]), "/abi: minItems"),
        ("/library/id", json!(""), "/library/id: minLength"),
        ("/plugins/0/kind", json!("painter"), "/plugins/0/kind: enum"),
        ("/plugins/0/interfaces", json!([]), "/plugins/0/interfaces: minItems"),
        ("/plugins/0/params/0/default", json!("seven"), "/plugins/0/params/0: oneOf"),
        ("/plugins/0/params/0/type", json!("text"), "/plugins/0/params/0: oneOf"),
        ("/plugins/0/params/2/entries", json!([]), "/plugins/0/params/2: oneOf"),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(place).unwrap() = value;
        let found = wrong(&schema, &bad, &schema, "").unwrap_or_default();
        assert!(found.starts_with(wanted), "{place}: {found:?}");
    }
}
