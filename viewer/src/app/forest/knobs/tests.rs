//! Knobs as they are drawn, and words of them, which the wind reads.

use super::{Knobs, STRENGTH, Winds};
use eframe::egui::{Context, RawInput, Shape};
use honami_mechanics::{Damping, Vector};
use honami_scene::weather::{Ground, read};

fn knobs(words: &str, damping: Damping) -> Knobs {
    let winds = Winds::typed(words);
    let held = (winds.clone(), damping);
    Knobs { winds, damping, held, field: words.to_owned(), putting: None }
}

/// What is read on the knobs, as nobody touches them.
fn shown(knobs: &mut Knobs) -> Vec<String> {
    fn texts(shape: &Shape, found: &mut Vec<String>) {
        match shape {
            Shape::Text(text) => found.push(text.galley.text().to_owned()),
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts(shape, found)),
            _ => {}
        }
    }
    let context = Context::default();
    let mut found = Vec::new();
    // In the first of them places are found.
    for _ in 0..2 {
        let mut turned = super::Turned::default();
        let mut drawn = context.run_ui(RawInput::default(), |ui| turned = knobs.show(ui));
        assert_eq!(turned, super::Turned::default(), "nobody has touched it");
        drawn.textures_delta.clear();
        found.clear();
        drawn.shapes.iter().for_each(|clipped| texts(&clipped.shape, &mut found));
    }
    found
}

/// Values that the command line takes, and no slider reaches.
#[test]
fn what_lies_beyond_a_slider_is_shown_and_stays() {
    let damping = Damping { alpha: 7.0, beta: 0.5, mass: 20.0, air: 8.0 };
    let mut knobs = knobs("storm:speed=60,towards=270,deviation=12", damping);
    knobs.putting = Some("vortex");
    assert!(knobs.put([3.0, 4.0]));
    knobs.winds.put[0].strength = 2500.0;
    let (winds, words) = (knobs.winds.clone(), shown(&mut knobs));
    assert_eq!((knobs.damping, &knobs.winds), (damping, &winds));
    for (told, wanted) in [
        ("speed", 60.0),
        ("towards", -90.0),
        ("gusts", 12.0),
        ("α", 7.0),
        ("β", 0.5),
        ("m,", 20.0),
        ("air", 8.0),
        ("vortex 3, 4", 2500.0),
    ] {
        let at = words.iter().position(|word| word.starts_with(told)).unwrap();
        let numbers = words[..at].iter().rev().take(2).filter_map(|word| word.replace('−', "-").parse().ok());
        assert_eq!(numbers.collect::<Vec<f64>>().first(), Some(&wanted), "{told}: {words:?}");
    }
}

/// The sum of both, wherever and whenever; what carries carries what was typed after it alone.
#[test]
fn what_is_put_blows_beside_the_wind_and_stays_where_it_is() {
    let blow = |winds: &Winds| winds.read().unwrap().over(&Ground::new(vec![], 1.0, 1 << 20)).unwrap();
    for words in ["storm", "frozen+noise:speed=0", "log+wind", "power:exponent=1+steady", "steady+vortex"] {
        let mut knobs = knobs(words, Damping::default());
        assert!(!knobs.put([1.0, 2.0]), "nothing was chosen");
        knobs.putting = Some("vortex");
        assert!(knobs.put([1.0, -2.5]) && knobs.putting.is_none());
        let both = blow(&knobs.winds);
        let [alone, put] = [words, &format!("vortex:strength={STRENGTH},x=1,y=-2.5")]
            .map(|words| blow(&Winds::typed(words)));
        for (place, time) in [([2.0, 0.0, 3.0], 0.0), ([4.0, -6.0, 12.0], 7.5)] {
            let at = Vector::from(place);
            let wanted = alone.sample(&at, time) + put.sample(&at, time);
            let came = both.sample(&at, time);
            assert!((came - wanted).norm() < 1e-9 && put.sample(&at, time).norm() > 1.0, "{words}: {came}");
        }
    }
}

#[test]
fn what_is_refused_stays_in_the_field_alone() {
    let mut knobs = knobs("storm", Damping::default());
    knobs.type_wind("breeze");
    assert!(knobs.winds.read().is_err());
    knobs.refuse();
    assert_eq!((knobs.winds.clone(), knobs.field.as_str()), (Winds::typed("storm"), "breeze"));
    knobs.type_wind("steady");
    let steady = knobs.winds.clone();
    knobs.hold(steady.clone());
    knobs.type_wind("steady:speed=-");
    knobs.putting = Some("sink");
    assert!(knobs.put([0.0; 2]));
    knobs.refuse();
    assert_eq!(knobs.winds, steady, "as it held last");
    knobs.damping.mass = -1.0;
    knobs.refuse_damping();
    assert_eq!(knobs.damping, Damping::default());
    knobs.damping.mass = 2.0;
    knobs.hold_damping();
    knobs.refuse_damping();
    assert!((knobs.damping.mass - 2.0).abs() < 1e-12);
}

#[test]
fn directions_go_round() {
    for (degrees, wanted) in [(0.0, 0.0), (180.0, 180.0), (-180.0, -180.0), (270.0, -90.0), (-200.0, 160.0)] {
        let blowing = |degrees: f64| {
            let wind = read(&format!("steady:towards={degrees}")).unwrap();
            wind.over(&Ground::default()).unwrap().sample(&Vector::zeros(), 0.0)
        };
        let came = super::half_turns(degrees);
        assert!(
            (came - wanted).abs() < 1e-12 && (blowing(came) - blowing(degrees)).norm() < 1e-12,
            "{degrees}"
        );
    }
}
