//! Winds by name: `calm`, `steady:speed=5,towards=90`, or a table that an anemometer has recorded.

#[cfg(test)]
mod tests;

use std::fs;
use std::path::Path;

use honami_exchange::plant::{PlantFileError, anemometer};
use honami_mechanics::Direction;
use honami_mechanics::wind::{
    Constant, Draw, Field, Kaimal, Mask, Noise, Power, Primitive, Series, Shape, Sine, Spectrum, Sum, Wind,
};

use crate::error::WorkbenchError;

/// Samples of a turbulent wind in time, and seconds between them: it begins again after seven minutes.
const N_SAMPLES: usize = 8192;
const STEP_S: f64 = 0.05;
/// Stations across a turbulent wind, and metres between them.
const N_STATIONS: usize = 24;
const SPACING_M: f64 = 20.0;

/// A wind: its name, what it is, and its values with their defaults.
pub struct Weather {
    /// As typed.
    pub name: &'static str,
    /// In a line.
    pub doc: &'static str,
    /// Names and defaults.
    pub values: &'static [(&'static str, f64)],
    make: fn(&Values<'_>) -> Box<dyn Wind>,
}

const GUSTS: &str = "turbulence of Kaimal's spectrum, alike at places near one another (Davenport)";

/// All winds that have a name. Metres, seconds, hertz; directions in degrees: 0 towards x, 90 towards y.
pub const WEATHERS: &[Weather] = &[
    Weather { name: "still", doc: "no wind", values: &[], make: |_| Box::new(Constant(Direction::zeros())) },
    Weather {
        name: "steady",
        doc: "the same everywhere and for ever",
        values: &[("speed", 8.0), ("towards", 0.0)],
        make: |v| Box::new(Constant(v.blowing())),
    },
    Weather { name: "calm", doc: "gusts of 3 m/s", values: &gusty(3.0, 0.6), make: gusts },
    Weather { name: "wind", doc: "gusts of 8 m/s", values: &gusty(8.0, 1.6), make: gusts },
    Weather { name: "storm", doc: "gusts of 18 m/s", values: &gusty(18.0, 3.6), make: gusts },
    Weather { name: "gusts", doc: GUSTS, values: &gusty(8.0, 1.6), make: gusts },
    Weather {
        name: "rough",
        doc: "turbulence of spectrum density / f^beta about a mean",
        values: &[
            ("speed", 8.0),
            ("towards", 0.0),
            ("density", 0.3),
            ("beta", 5.0 / 3.0),
            ("decay", 10.0),
            ("seed", 1.0),
        ],
        make: |v| {
            let power = Power { at_1_hz: v.of("density"), beta: v.of("beta") };
            turbulent(v, [&power, &power, &power])
        },
    },
    Weather {
        name: "noise",
        doc: "Perlin's noise about a mean",
        values: &[
            ("speed", 8.0),
            ("towards", 0.0),
            ("swing", 4.0),
            ("cell", 15.0),
            ("second", 2.0),
            ("seed", 1.0),
        ],
        make: |v| {
            let (speed, cell, second) = (v.of("swing"), v.of("cell"), v.of("second"));
            let noise = Noise { speed, cell, second, seed: v.of("seed") as u64 };
            Box::new(Sum(vec![Box::new(Constant(v.blowing())), Box::new(noise)]))
        },
    },
    Weather {
        name: "waves",
        doc: "a sine that travels with the mean",
        values: &[("speed", 8.0), ("towards", 0.0), ("swing", 4.0), ("hz", 0.3), ("length", 25.0)],
        make: |v| {
            let along = v.along();
            let (amplitude, waves) = (along * v.of("swing"), along / v.of("length"));
            let sine = Sine { amplitude, hz: v.of("hz"), waves, phase: 0.0 };
            Box::new(Sum(vec![Box::new(Constant(v.blowing())), Box::new(sine)]))
        },
    },
    Weather {
        name: "squall",
        doc: "a wind in a round mask that travels with it, from x, y on",
        values: &[
            ("speed", 15.0),
            ("towards", 0.0),
            ("radius", 30.0),
            ("x", -60.0),
            ("y", 0.0),
            ("pace", 10.0),
        ],
        make: |v| {
            let (along, pace) = (v.along(), v.of("pace"));
            let velocity = [along.x * pace, along.y * pace];
            let centre = [v.of("x"), v.of("y")];
            Box::new(Mask { wind: Constant(v.blowing()), centre, velocity, radius: v.of("radius") })
        },
    },
    Weather {
        name: "vortex",
        doc: "round an upright axis",
        values: ABOUT,
        make: |v| about(v, Shape::Vortex),
    },
    Weather {
        name: "source",
        doc: "out of an upright axis",
        values: ABOUT,
        make: |v| about(v, Shape::Source),
    },
    Weather { name: "sink", doc: "into an upright axis", values: ABOUT, make: |v| about(v, Shape::Sink) },
];

const ABOUT: &[(&str, f64)] = &[("strength", 200.0), ("x", 0.0), ("y", -15.0), ("core", 1.0)];

/// No value is larger: what is made of them stays a number.
const MOST: f64 = 1e6;
/// Values that no wind of that name can have at 0 or below.
const POSITIVE: &[&str] = &["scale", "cell", "second", "length", "radius", "core", "decay"];

/// Values of a wind, all of them.
pub struct Values<'a> {
    weather: &'a Weather,
    values: Vec<f64>,
}

impl Values<'_> {
    fn of(&self, name: &str) -> f64 {
        let place = self.weather.values.iter().position(|(known, _)| *known == name);
        place.map_or(0.0, |place| self.values[place])
    }

    fn along(&self) -> Direction {
        let (sin, cos) = self.of("towards").to_radians().sin_cos();
        Direction::new(cos, sin, 0.0)
    }

    fn blowing(&self) -> Direction {
        self.along() * self.of("speed")
    }
}

fn about(v: &Values<'_>, shape: Shape) -> Box<dyn Wind> {
    let (centre, strength, core) = ([v.of("x"), v.of("y")], v.of("strength"), v.of("core"));
    Box::new(Primitive { shape, centre, strength, core })
}

/// What gusts of this mean and deviation, metres per second, can be told.
const fn gusty(speed: f64, deviation: f64) -> [(&'static str, f64); 6] {
    [
        ("speed", speed),
        ("towards", 0.0),
        ("deviation", deviation),
        ("scale", 60.0),
        ("decay", 10.0),
        ("seed", 1.0),
    ]
}

/// Across and up it swings less than along the mean (Burton and others, Wind Energy Handbook, 2.6).
fn gusts(v: &Values<'_>) -> Box<dyn Wind> {
    let spectra =
        [1.0, 0.8, 0.5].map(|share| Kaimal::along(share * v.of("deviation"), v.of("speed"), v.of("scale")));
    turbulent(v, [&spectra[0], &spectra[1], &spectra[2]])
}

fn turbulent(v: &Values<'_>, spectra: [&dyn Spectrum; 3]) -> Box<dyn Wind> {
    Box::new(Field::new(
        &Draw {
            mean: v.blowing(),
            decay: v.of("decay"),
            n_stations: N_STATIONS,
            spacing: SPACING_M,
            n_samples: N_SAMPLES,
            step: STEP_S,
            seed: v.of("seed") as u64,
        },
        spectra,
    ))
}

/// A wind by what was typed.
///
/// # Errors
/// [`WorkbenchError::Weather`] says which names and values there are; and what is wrong with a recording.
pub fn blow(typed: &str) -> Result<Box<dyn Wind>, WorkbenchError> {
    let wrong = |what: String| WorkbenchError::Weather { what };
    let (name, given) = typed.split_once(':').unwrap_or((typed, ""));
    let Some(weather) = WEATHERS.iter().find(|weather| weather.name == name) else {
        let path = Path::new(typed);
        if path.exists() {
            return recorded(path);
        }
        let names: Vec<&str> = WEATHERS.iter().map(|weather| weather.name).collect();
        return Err(wrong(format!("{typed:?} is no wind and no file: there are {}", names.join(", "))));
    };
    let mut values: Vec<f64> = weather.values.iter().map(|(_, value)| *value).collect();
    for pair in given.split(',').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let Some(place) = weather.values.iter().position(|(known, _)| *known == key.trim()) else {
            let known: Vec<&str> = weather.values.iter().map(|(known, _)| *known).collect();
            let known = if known.is_empty() { "nothing".to_owned() } else { known.join(", ") };
            return Err(wrong(format!("{name} has no {key:?}: it takes {known}")));
        };
        let is_positive = POSITIVE.contains(&key.trim());
        // Any seed is as good as another.
        let most = if key.trim() == "seed" { f64::MAX } else { MOST };
        let is_fine = |v: &f64| v.abs() <= most && (*v >= 1.0 / MOST || !is_positive);
        let Some(value) = value.trim().parse().ok().filter(is_fine) else {
            let least = if is_positive { "0.000001" } else { "-1000000" };
            return Err(wrong(format!("{key} of {name} is a number from {least} to 1000000, not {value:?}")));
        };
        values[place] = value;
    }
    let values = Values { weather, values };
    // What is carried by its mean stands still without one.
    let is_carried = weather.values.iter().any(|(known, _)| *known == "decay");
    if is_carried && values.of("speed") <= 0.0 {
        return Err(wrong(format!(
            "{name} is carried by its mean: speed is a number above 0, not {}",
            values.of("speed")
        )));
    }
    Ok((weather.make)(&values))
}

fn recorded(path: &Path) -> Result<Box<dyn Wind>, WorkbenchError> {
    let text =
        fs::read_to_string(path).map_err(|source| PlantFileError::Io { path: path.to_owned(), source })?;
    let recording = anemometer::parse(&text)?;
    let samples: Vec<Direction> = recording.samples.into_iter().map(Direction::from).collect();
    if let Some(wild) = samples.iter().find(|v| v.amax() > MOST) {
        let (file, speed) = (path.display(), wild.amax());
        return Err(WorkbenchError::Weather {
            what: format!("{file}: a wind of {speed:e} m/s, more than 1000000"),
        });
    }
    Ok(Box::new(Series { step: recording.step, samples }))
}

/// All winds, their values and defaults, a line each: the end of the command's help.
#[must_use]
pub fn help() -> String {
    let line = |weather: &Weather| {
        let values = weather.values.iter().map(|(name, value)| format!("{name}={value:.4}"));
        let values: Vec<String> =
            values.map(|v| v.trim_end_matches('0').trim_end_matches('.').to_owned()).collect();
        format!(
            "  {:8} {}{}{}",
            weather.name,
            weather.doc,
            if values.is_empty() { "" } else { ": " },
            values.join(",")
        )
    };
    let lines: Vec<String> = WEATHERS.iter().map(line).collect();
    format!(
        "Winds, with their values; metres, seconds, hertz, and degrees: 0 towards x, 90 towards y.\n{}",
        lines.join("\n")
    )
}
