//! What simulators are told that have other parameters, other defaults and other choices than the one that ships.

use super::*;

/// A simulator's parameters: its own damping, whole steps, a radius in metres or of its own words.
fn params(text: &str) -> Vec<Param> {
    serde_json::from_str(text).unwrap()
}

const OWN: &str = r#"[
    {"id": "alpha", "type": "float", "default": 0.05, "max": 0.5},
    {"id": "beta", "type": "float", "default": 0.008},
    {"id": "leaf_mass", "type": "float", "default": 2},
    {"id": "method", "type": "enum", "default": "verlet", "entries": [{"id": "verlet"}, {"id": "exact"}]}
]"#;

fn asked(params: &[Param], chosen: &[&str], set: &[&str]) -> Result<Told, HostError> {
    let [chosen, set] =
        [chosen, set].map(|words| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
    values(&Wish::of("", None), &Motion::default(), ("own", params), Chosen::Only(&chosen), &set)
}

#[test]
fn what_was_chosen_is_told_and_what_was_not_is_left_with_a_word() {
    let own = params(OWN);
    let note = |id: &str, own: &str, ours: &str, option: &str| {
        format!("own goes by its own {id}, {own}, not by {ours}: --{option} tells it otherwise")
    };
    let (alpha, leaves) = (note("alpha", "0.05", "0.3", "alpha"), note("leaf_mass", "2", "0", "leaf-mass"));
    let method = note("method", "verlet", "exact", "method");
    for (chosen, set, wanted, notes) in [
        (&[][..], &[][..], ("0.05", "2", "verlet"), vec![&leaves, &alpha, &method]),
        // Though it is as usual here.
        (&["alpha"], &[], ("0.3", "2", "verlet"), vec![&leaves, &method]),
        (&["alpha", "leaf_mass", "method"], &[], ("0.3", "0", "exact"), vec![]),
        (&["method"], &["alpha = 0.2", "leaf_mass=1"], ("0.2", "1", "exact"), vec![]),
        (&["alpha"], &["alpha=0.2"], ("0.2", "2", "verlet"), vec![&leaves, &method]),
    ] {
        let told = asked(&own, chosen, set).unwrap();
        let got = ["alpha", "leaf_mass", "method"].map(|id| told.values.get(id).unwrap().to_string());
        assert_eq!(got, [wanted.0, wanted.1, wanted.2], "{chosen:?} {set:?}");
        assert!(told.notes.iter().eq(notes), "{chosen:?} {set:?}: {:?}", told.notes);
    }
}

#[test]
fn what_a_simulator_cannot_take_is_refused_where_it_was_chosen() {
    let own = params(OWN);
    for (chosen, wanted) in
        [("young", "there is no parameter \"young\""), ("bend", "there is no parameter \"bend\"")]
    {
        let error = asked(&own, &[chosen], &[]).unwrap_err().to_string();
        assert!(error.contains(wanted), "{chosen}: {error}");
    }
    let narrow = params(r#"[{"id": "alpha", "type": "float", "default": 0.05, "max": 0.1}]"#);
    let error = asked(&narrow, &["alpha"], &[]).unwrap_err().to_string();
    assert!(error.contains("alpha: wanted a number, at most 0.1, got \"0.3\""), "{error}");
    let narrow =
        params(r#"[{"id": "method", "type": "enum", "default": "verlet", "entries": [{"id": "verlet"}]}]"#);
    let error = asked(&narrow, &["method"], &[]).unwrap_err().to_string();
    assert!(error.contains("method: wanted one of verlet, got \"exact\""), "{error}");
    // The modes that are listed need not be those of whoever moves the plant.
    let told = asked(&own, &["modes"], &[]).unwrap();
    assert!(told.notes.iter().any(|note| note == "own is not told of modes: it has no such parameter"));
}

#[test]
fn radii_of_tips_are_named_to_those_who_have_the_choice() {
    for (kind, wanted) in [
        (r#""type": "enum", "default": "mean", "entries": [{"id": "mean"}, {"id": "tip"}]"#, "tip"),
        (r#""type": "enum", "default": "mean", "entries": [{"id": "mean"}, {"id": "base"}]"#, "mean"),
        (r#""type": "float", "default": 0.5"#, "0.5"),
        (r#""type": "string", "default": "thick""#, "thick"),
    ] {
        let params = params(&format!(r#"[{{"id": "radius", {kind}}}]"#));
        let told = asked(&params, &["radius"], &[]).unwrap();
        assert_eq!(told.values.get("radius").unwrap().to_string(), wanted);
        assert!(told.notes.is_empty(), "{:?}", told.notes);
    }
}

/// What is set by the name of an option is that option; what only the simulator knows is its own.
#[test]
fn what_is_set_is_what_the_plant_is() {
    let own = params(OWN);
    let told = asked(&own, &[], &["alpha=0.2", "leaf_mass=1", "method=exact"]).unwrap();
    let (damping, usual) = (told.motion.damping, Motion::default().damping);
    assert_eq!((damping.alpha, damping.beta, told.wish.leaves.mass), (0.2, usual.beta, 1.0));
    assert_eq!(asked(&own, &[], &["method=verlet"]).unwrap().motion, Motion::default());
    // Segments are divided before they are handed over, once.
    let longest = params(r#"[{"id": "longest", "type": "float", "default": 0}]"#);
    let told = asked(&longest, &[], &["longest=0.1"]).unwrap();
    assert_eq!((told.wish.beams.longest, told.values.get("longest")), (Some(0.1), Some(&Value::Float(0.0))));
    let radius =
        r#"[{"id": "radius", "type": "enum", "default": "tip", "entries": [{"id": "mean"}, {"id": "tip"}]}]"#;
    let told = asked(&params(radius), &[], &["radius=tip"]).unwrap();
    assert_eq!(told.wish.beams.rule, RadiusRule::Tip);
}
