//! Manifests made from the schema that authors are given.

use super::*;
use serde_json::{Map, json};

const SCHEMA: &str = include_str!("../../../../abi/manifest.schema.json");

/// Something with every member that a schema names, those of all alternatives together; and this one in each object.
fn whole(schema: &Value, root: &Value, more: Option<&str>) -> Value {
    if let Some(place) = schema["$ref"].as_str() {
        return whole(root.pointer(place.trim_start_matches('#')).unwrap(), root, more);
    }
    if schema["items"].is_object() {
        return json!([whole(&schema["items"], root, more)]);
    }
    let mut members = Map::new();
    for part in [&schema["allOf"], &schema["oneOf"]].into_iter().flat_map(list) {
        members.extend(whole(part, root, more).as_object().unwrap().clone());
    }
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        members.insert(name.clone(), whole(property, root, more));
        members.extend(more.map(|name| (name.to_owned(), Value::Null)));
    }
    Value::Object(members)
}

#[test]
fn every_member_of_the_schema_is_known_and_another_is_named_wherever_it_stands() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let unknown = |more| unknown_to(whole(&schema, &schema, more).to_string().as_bytes()).unwrap();
    assert_eq!(unknown(None), [""; 0]);
    let places = ["caps.odd", "entries.odd", "library.odd", "needs.odd", "odd", "params.odd", "plugins.odd"];
    assert_eq!(unknown(Some("odd")), places);
}
