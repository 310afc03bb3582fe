//! Values against schemas: what is kept, what is refused, what comes back.

use super::*;

fn schema() -> Vec<Param> {
    let json = r#"[
        {"id":"radius","type":"int","default":10,"min":2,"max":50,"unit":"px"},
        {"id":"eps","type":"float","default":0.03,"min":1e-4},
        {"id":"on","type":"bool","default":true},
        {"id":"model","type":"path","default":"","when":{"on":true,"radius":10}}
    ]"#;
    serde_json::from_str(json).unwrap()
}

#[test]
fn text_becomes_values_of_the_right_type() {
    let params = schema();
    let mut values = Values::defaults(&params);
    for (text, id, wanted) in [
        ("radius=7", "radius", Value::Int(7)),
        ("eps = 2", "eps", Value::Float(2.0)),
        ("eps=1e-3", "eps", Value::Float(1e-3)),
        ("on=off", "on", Value::Bool(false)),
        ("model=a=b.bin", "model", Value::Text("a=b.bin".into())),
    ] {
        values.set_text(&params, text).unwrap();
        assert_eq!(values.get(id), Some(&wanted), "{text}");
    }
    for text in
        ["radius=1", "radius=51", "radius=7.0", "radius=", "eps=0", "eps=inf", "on=maybe", "=1", "model"]
    {
        let before = values.clone();
        assert!(values.set_text(&params, text).is_err(), "{text}");
        assert_eq!(values, before, "{text}");
    }
}

#[test]
fn unknown_values_are_kept_and_renamed_ones_followed() {
    let kept: Values =
        serde_json::from_str(r#"{"win":7,"eps":1,"of a later version":[1.5,"x"]}"#).unwrap_or_default();
    assert_eq!(kept, Values::default(), "lists hold numbers");
    let json = r#"{"win":7,"eps":1,"later":[1.5,2.0]}"#;
    let kept: Values = serde_json::from_str(json).unwrap();
    assert_eq!(serde_json::to_string(&kept).unwrap(), r#"{"eps":1,"later":[1.5,2.0],"win":7}"#);
    let mut values = Values::defaults(&schema());
    values.restore(&kept, &BTreeMap::from([("win".to_owned(), "radius".to_owned())]));
    assert_eq!(values.get("radius"), Some(&Value::Int(7)));
    assert_eq!(values.get("later"), Some(&Value::List(vec![1.5, 2.0])));
    assert_eq!(values.validate(&schema()), Ok(()), "a whole number stands for a float");
}

#[test]
fn when_is_a_conjunction() {
    let params = schema();
    let mut values = Values::defaults(&params);
    assert!(values.is_active(&params[3]));
    values.set(&params, "radius", Value::Int(11)).unwrap();
    assert!(!values.is_active(&params[3]));
}
