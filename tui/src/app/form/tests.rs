//! Values under arrow keys.

use super::*;
use crate::app::fixture;

#[test]
fn steps_stay_in_the_range_and_free_of_noise() {
    let state = fixture::state();
    let params = &state.plugins[0].params;
    let find = |id: &str| params.iter().find(|p| p.id == id).unwrap();
    for (id, from, steps, coarse, expect) in [
        ("radius", Value::Int(10), 1, false, Some(Value::Int(11))),
        ("radius", Value::Int(10), -1, true, Some(Value::Int(7))),
        ("radius", Value::Int(10), -99, false, Some(Value::Int(2))),
        ("motion", Value::Text("affine".into()), 1, false, Some(Value::Text("translation".into()))),
        ("check", Value::Bool(true), 1, false, Some(Value::Bool(false))),
        ("expire", Value::Float(0.55), 1, false, Some(Value::Float(0.6))),
        ("expire", Value::Float(0.55), 99, false, Some(Value::Float(1.0))),
        ("label", Value::Text("none".into()), 1, false, None),
    ] {
        assert_eq!(changed(find(id), &from, steps, coarse), expect, "{id} {from} by {steps}");
    }
}

#[test]
fn what_does_not_count_is_not_shown() {
    let state = fixture::state();
    let features = [Features::Here, Features::Selected, Features::Found];
    let mut form = Form::new(Task::Track, &state.plugins, &features).unwrap();
    let ids = |form: &Form| {
        let rows = form.rows();
        rows.iter()
            .filter_map(|r| if let Row::Param(p, _) = r { Some(p.id.clone()) } else { None })
            .collect::<Vec<_>>()
    };
    assert_eq!(ids(&form), ["@features", "radius", "motion", "check", "label"]);
    assert!(form.rows().contains(&Row::Fold(1)));
    form.unfolded = true;
    assert!(ids(&form).contains(&"expire".to_owned()));
    form.at = form.rows().iter().position(|r| matches!(r, Row::Param(p, _) if p.id == "check")).unwrap();
    form.change(1, false);
    assert!(!ids(&form).contains(&"expire".to_owned()), "it counts only with `check`");
    form.at = 1;
    for expect in [Features::Here, Features::Selected, Features::Found, Features::Here] {
        assert_eq!(form.features(), expect);
        assert_eq!(ids(&form).contains(&"@every".to_owned()), expect == Features::Found);
        form.change(1, false);
    }
}

#[test]
fn choices_are_called_what_is_shown() {
    let features = [Features::Here, Features::Selected, Features::Found];
    let form = |plugin: Plugin| Form::new(Task::Track, &[plugin], &features).unwrap();
    let [klt, flow, ..] = &fixture::state().plugins[..] else { panic!("two trackers") };
    let wanted = |plugin: &Plugin| form(plugin.clone()).plugin().params[0].wanted();
    assert_eq!(wanted(klt), "one of the tracks here, the selected track, found anew");
    assert_eq!(wanted(flow), "one of the tracks here, the selected track", "it finds none by itself");
}
