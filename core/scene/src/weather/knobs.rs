//! Words of a wind with one of its values changed: what keys and sliders turn.

use super::typed::apart;
use super::{WEATHERS, range};

/// The value of a name in words as they were typed, or its default: of the first wind among them that has it.
#[must_use]
pub fn value(words: &str, name: &str) -> Option<f64> {
    apart(words).into_iter().find_map(|part| {
        let (weather, given) = part.split_once(':').unwrap_or((part, ""));
        let default = default(weather, name)?;
        let told = pairs(given).find(|(known, _)| *known == name);
        Some(told.and_then(|(_, value)| value.trim().parse().ok()).unwrap_or(default))
    })
}

/// The same words with another value of a name, in the first wind that has it, as near to it as there is; `None` where none
/// has.
#[must_use]
pub fn with_value(words: &str, name: &str, value: f64) -> Option<String> {
    let mut parts: Vec<String> = apart(words).into_iter().map(str::to_owned).collect();
    let at = parts.iter().position(|part| {
        default(part.split_once(':').map_or(part.as_str(), |(weather, _)| weather), name).is_some()
    })?;
    let [least, most] = range(name);
    // To six digits after the point, as far as they say anything.
    let told = format!("{:.6}", value.clamp(least, most));
    let told = told.trim_end_matches('0').trim_end_matches('.');
    let told = if told == "-0" { "0" } else { told };
    let (weather, given) = parts[at].split_once(':').unwrap_or((&parts[at], ""));
    let others = pairs(given).filter(|(known, _)| *known != name);
    let pairs: Vec<String> =
        others.map(|(known, value)| format!("{known}={value}")).chain([format!("{name}={told}")]).collect();
    parts[at] = format!("{weather}:{}", pairs.join(","));
    Some(parts.join("+"))
}

fn default(weather: &str, name: &str) -> Option<f64> {
    let weather = WEATHERS.iter().find(|known| known.name == weather)?;
    weather.values.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn pairs(given: &str) -> impl Iterator<Item = (&str, &str)> {
    let pairs = given.split(',').filter(|pair| !pair.is_empty());
    pairs.map(|pair| pair.split_once('=').unwrap_or((pair, ""))).map(|(name, value)| (name.trim(), value))
}

#[cfg(test)]
mod tests {
    //! Words before and after.

    use super::{value, with_value};

    #[test]
    fn a_value_is_told_and_changed_where_it_is() {
        // Words, a name, its value, another, and the words then.
        let cases = [
            ("wind", "speed", 8.0, 9.5, "wind:speed=9.5"),
            ("wind:speed=4,seed=2", "speed", 4.0, 5.0, "wind:seed=2,speed=5"),
            ("steady:speed=1e+1+vortex", "speed", 10.0, 3.0, "steady:speed=3+vortex"),
            ("log+wind:towards=90", "towards", 90.0, -15.0, "log+wind:towards=-15"),
            ("still+storm", "speed", 18.0, 0.1 + 0.2, "still+storm:speed=0.3"),
            ("noise:cell=5", "cell", 5.0, -1.0, "noise:cell=0.000001"),
        ];
        for (words, name, was, is, wanted) in cases {
            assert!((value(words, name).unwrap() - was).abs() < 1e-12, "{words}");
            assert_eq!(with_value(words, name, is).as_deref(), Some(wanted), "{words}");
        }
        for (words, name) in [("still", "speed"), ("mast.csv", "speed"), ("", "towards")] {
            assert_eq!((value(words, name), with_value(words, name, 1.0)), (None, None), "{words}");
        }
    }
}
