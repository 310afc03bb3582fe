//! Values under arrow keys.

use super::*;
use crate::app::fixture;

fn wanted(features: &[Features]) -> Wanted<'_> {
    Wanted { features, frames: 20..60, n_frames: 100, used: &[] }
}

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
    let mut form = Form::new(Task::Track, &state.plugins, &wanted(&features)).unwrap();
    let ids = |form: &Form| {
        let rows = form.rows();
        rows.iter()
            .filter_map(|r| if let Row::Param(p, _) = r { Some(p.id.clone()) } else { None })
            .collect::<Vec<_>>()
    };
    assert_eq!(ids(&form), ["@features", "@frames", "radius", "motion", "check", "label"]);
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
fn what_was_filled_in_is_kept_when_the_plugin_is_another_build() {
    let mut plugins = fixture::state().plugins;
    let form = |plugins: &[Plugin]| Form::new(Task::Track, plugins, &wanted(&[Features::Here])).unwrap();
    let mut before = form(&plugins);
    let params = before.plugin().params.clone();
    for (id, value) in [("radius", Value::Int(12)), ("check", Value::Bool(false))] {
        before.values.set(&params, id, value).unwrap();
    }
    (before.at, before.unfolded) = (3, true);
    // One parameter is of another type now, one is gone.
    plugins[0].params.retain(|param| param.id != "label");
    let check = plugins[0].params.iter_mut().find(|param| param.id == "check").unwrap();
    check.kind = ParamKind::String { default: "both".to_owned() };
    let mut after = form(&plugins);
    after.take(&before);
    let value = |id: &str| after.values.get(id).cloned();
    assert_eq!(value("radius"), Some(Value::Int(12)));
    assert_eq!((value("check"), value("label")), (Some(Value::Text("both".to_owned())), None));
    assert_eq!((after.at, after.unfolded, after.frames()), (3, true, 20..60));
}

#[test]
fn a_form_begins_with_what_its_plugin_was_told_last() {
    let plugins = fixture::state().plugins;
    let told = [
        ("radius", Value::Int(12)),
        // Of a newer build, of another type, and beyond what it takes.
        ("novelty", Value::Int(1)),
        ("check", Value::Int(7)),
        ("expire", Value::Float(99.0)),
    ];
    let values: Values = told.map(|(id, value)| (id.to_owned(), value)).into_iter().collect();
    let of = |task, plugin: &str| Used { task, plugin: plugin.to_owned(), values: values.clone() };
    for (used, radius) in [
        (vec![], 10),
        (vec![of(Task::Track, "klt")], 12),
        (vec![of(Task::Track, "gone")], 10),
        (vec![of(Task::Cluster, "klt")], 10),
    ] {
        let wanted = Wanted { used: &used, ..wanted(&[Features::Here]) };
        let mut form = Form::new(Task::Track, &plugins, &wanted).unwrap();
        // Also after another was chosen meanwhile.
        for _ in 0..2 {
            let value = |id: &str| form.values.get(id).cloned();
            let expect = [Value::Int(radius), Value::Bool(true)].map(Some);
            assert_eq!([value("radius"), value("check")], expect, "{used:?}");
            assert_eq!((value("novelty"), value("expire")), (None, Some(Value::Float(0.55))), "{used:?}");
            form.change(1, false);
            form.change(-1, false);
        }
    }
}

#[test]
fn choices_are_called_what_is_shown() {
    let features = [Features::Here, Features::Selected, Features::Found];
    let form = |plugin: Plugin| Form::new(Task::Track, &[plugin], &wanted(&features)).unwrap();
    let [klt, flow, ..] = &fixture::state().plugins[..] else { panic!("two trackers") };
    let words = |plugin: &Plugin| form(plugin.clone()).plugin().params[0].wanted();
    assert_eq!(words(klt), "one of the tracks here, the selected track, found anew");
    assert_eq!(words(flow), "one of the tracks here, the selected track", "it finds none by itself");
}

#[test]
fn frames_are_typed_as_their_first_and_last() {
    let mut form = Form::new(Task::Track, &fixture::state().plugins, &wanted(&[Features::Here])).unwrap();
    assert_eq!(form.frames(), 20..60);
    form.at = 2;
    for (typed, expect) in [
        ("0-99", Ok(0..100)),
        (" 7 - 7 ", Ok(7..8)),
        ("9-8", Err("\"9-8\"")),
        ("50-100", Err("\"50-100\"")),
        ("20", Err("\"20\"")),
        ("-3-5", Err("\"-3-5\"")),
    ] {
        form.typed = Some(typed.to_owned());
        match (form.take_typed(), expect) {
            (Ok(()), Ok(frames)) => assert_eq!(form.frames(), frames, "{typed}"),
            (Err(line), Err(got)) => {
                let wanted = "frames: wanted the first and the last, of 0-99, got ";
                assert_eq!(line, format!("{wanted}{got}"));
            }
            other => panic!("{typed}: {other:?}"),
        }
    }
    assert_eq!(form.frames(), 7..8, "what was wrong changes nothing");
}
