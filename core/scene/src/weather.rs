//! Winds by name: `calm`, `steady:speed=5,towards=90`, or a table that an anemometer has recorded; several by `+`.

mod knobs;
#[cfg(test)]
mod tests;
mod typed;

use std::f64::consts::SQRT_2;

use honami_mechanics::Vector;
use honami_mechanics::wind::{
    Constant, Draw, Field, Flowing, Frozen, Growth, Inflow, Kaimal, Mask, Noise, Power, Primitive, Profile,
    Shape, Sine, Spectrum, Sum, Wind,
};

use honami_exchange::plant::PlantFileError;
use honami_mechanics::wind::FlowingError;

pub use knobs::{value, with_value};
pub use typed::{Typed, read};

/// Samples of a turbulent wind in time, and seconds between them: it begins again after seven minutes, which is told.
const N_SAMPLES: usize = 8192;
const STEP_S: f64 = 0.05;
/// Seconds after which a wind that goes round begins again at the latest: all of it is drawn.
const LONGEST_ROUND_S: f64 = 3600.0;
/// Metres between stations across a turbulent wind, if no more of them are needed than so many.
const SPACING_M: f64 = 2.0;
const MOST_STATIONS: usize = 512;

/// A wind: its name, what it is, and its values with their defaults.
pub struct Weather {
    /// As typed.
    pub name: &'static str,
    /// In a line.
    pub doc: &'static str,
    /// Names and defaults.
    pub values: &'static [(&'static str, f64)],
    make: Make,
}

/// Why there is no such wind.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WeatherError {
    /// Words that name none, or numbers that no wind has.
    #[error("{0}")]
    Words(String),
    /// A recording that cannot be read.
    #[error(transparent)]
    Recording(#[from] PlantFileError),
    /// Air that cannot flow.
    #[error(transparent)]
    Air(#[from] FlowingError),
}

impl WeatherError {
    /// Whether other words or numbers are wanted than were typed.
    #[must_use]
    pub fn is_as_typed(&self) -> bool {
        match self {
            Self::Words(_) => true,
            Self::Recording(error) => error.is_as_typed(),
            Self::Air(error) => matches!(error, FlowingError::Numbers { .. } | FlowingError::Cells { .. }),
        }
    }
}

/// A wind, or why there is none.
type Blown = Result<Box<dyn Wind>, WeatherError>;

/// What a wind is made of.
#[derive(Clone, Copy)]
enum Make {
    /// Its values,
    Alone(fn(&Values) -> Box<dyn Wind>),
    /// and what it blows over,
    Over(fn(&Values, &Ground) -> Blown),
    /// or what follows it.
    Carrying(fn(&Values, Box<dyn Wind>) -> Box<dyn Wind>),
}

/// What wind blows over, and for how long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ground {
    /// Where trees stand, metres, and their mass, kilograms.
    trees: Vec<([f64; 2], f64)>,
    /// From 0 on.
    seconds: f64,
    /// Whether it is then to begin again.
    is_round: bool,
    /// What a wind that flows may take.
    most_bytes: usize,
}

impl Ground {
    /// That on which these trees stand: where, metres, and their mass, kilograms; wind blows over it for so many seconds from
    /// 0 on. What flows by itself may take so many bytes.
    #[must_use]
    pub fn new(trees: Vec<([f64; 2], f64)>, seconds: f64, most_bytes: usize) -> Self {
        Self { trees, seconds, is_round: false, most_bytes }
    }

    /// The same for a motion that goes round.
    #[must_use]
    pub fn round(self) -> Self {
        Self { is_round: true, ..self }
    }

    /// Seconds after which a wind begins again, where it has to.
    fn period(&self) -> Option<f64> {
        self.is_round.then_some(self.seconds)
    }
}

impl Ground {
    /// From where to where trees stand across a wind, metres to the left of it; the origin, where there are none.
    fn across(&self, along: &Vector) -> [f64; 2] {
        let left = Vector::z().cross(along);
        let places = self.trees.iter().map(|([x, y], _)| x * left.x + y * left.y);
        let ends = places.fold(None, |ends: Option<[f64; 2]>, at| {
            Some(ends.map_or([at; 2], |[low, high]| [low.min(at), high.max(at)]))
        });
        ends.unwrap_or_default()
    }

    /// Side of the square that all trees stand in, metres.
    fn side(&self) -> f64 {
        let side = |axis: usize| {
            let places = || self.trees.iter().map(|(place, _)| place[axis]);
            places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
        };
        side(0).max(side(1)).max(0.0)
    }
}

const GUSTS: &str = "turbulence of Kaimal's spectrum, alike at places near one another (Davenport)";

/// All winds that have a name. Metres, seconds, hertz; directions in degrees: 0 towards x, 90 towards y.
pub const WEATHERS: &[Weather] = &[
    Weather {
        name: "still",
        doc: "no wind",
        values: &[],
        make: Make::Alone(|_| Box::new(Constant(Vector::zeros()))),
    },
    Weather {
        name: "steady",
        doc: "the same everywhere and for ever",
        values: &[("speed", 8.0), ("towards", 0.0)],
        make: Make::Alone(|v| Box::new(Constant(v.blowing()))),
    },
    Weather { name: "calm", doc: "gusts of 3 m/s", values: &gusty(3.0, 0.6), make: Make::Over(gusts) },
    Weather { name: "wind", doc: "gusts of 8 m/s", values: &gusty(8.0, 1.6), make: Make::Over(gusts) },
    Weather { name: "storm", doc: "gusts of 18 m/s", values: &gusty(18.0, 3.6), make: Make::Over(gusts) },
    Weather { name: "gusts", doc: GUSTS, values: &gusty(8.0, 1.6), make: Make::Over(gusts) },
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
        make: Make::Over(|v, ground| {
            let power = Power { at_1_hz: v.of("density"), beta: v.of("beta") };
            Ok(Box::new(turbulent(v, [&power, &power, &power], ground, ground.across(&v.along()))))
        }),
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
        make: Make::Over(|v, ground| {
            let (speed, cell, second) = (v.of("swing"), v.of("cell"), v.of("second"));
            let n_cells = ground.period().map(|period| (period / second).round() as u32);
            let noise = Noise { speed, cell, second, seed: v.of("seed") as u64, n_cells };
            Ok(Box::new(Sum(vec![Box::new(Constant(v.blowing())), Box::new(noise)])))
        }),
    },
    Weather {
        name: "waves",
        doc: "a sine that travels with the mean",
        values: &[("speed", 8.0), ("towards", 0.0), ("swing", 4.0), ("hz", 0.3), ("length", 25.0)],
        make: Make::Alone(|v| {
            let along = v.along();
            let (amplitude, waves) = (along * v.of("swing"), along / v.of("length"));
            let sine = Sine { amplitude, hz: v.of("hz"), waves, phase: 0.0 };
            Box::new(Sum(vec![Box::new(Constant(v.blowing())), Box::new(sine)]))
        }),
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
        make: Make::Alone(|v| {
            let (along, pace) = (v.along(), v.of("pace"));
            let velocity = [along.x * pace, along.y * pace];
            let centre = [v.of("x"), v.of("y")];
            Box::new(Mask { wind: Constant(v.blowing()), centre, velocity, radius: v.of("radius") })
        }),
    },
    Weather {
        name: "vortex",
        doc: "round an upright axis",
        values: ABOUT,
        make: Make::Alone(|v| about(v, Shape::Vortex)),
    },
    Weather {
        name: "source",
        doc: "out of an upright axis",
        values: ABOUT,
        make: Make::Alone(|v| about(v, Shape::Source)),
    },
    Weather {
        name: "sink",
        doc: "into an upright axis",
        values: ABOUT,
        make: Make::Alone(|v| about(v, Shape::Sink)),
    },
    Weather {
        name: "air",
        doc: "a layer of air that flows by itself, held back by the trees; gusts come in at its sides",
        values: &[
            ("speed", 8.0),
            ("towards", 0.0),
            ("deviation", 1.6),
            ("scale", 60.0),
            ("decay", 10.0),
            ("seed", 1.0),
            ("cell", 4.0),
            ("drag", 0.02),
            ("viscosity", 0.5),
        ],
        make: Make::Over(flowing),
    },
    Weather {
        name: "frozen",
        doc: "carries what follows it, frozen+noise:speed=0, as it was at a time",
        values: &[("speed", 8.0), ("towards", 0.0), ("at", 0.0)],
        make: Make::Carrying(|v, turbulence| {
            Box::new(Frozen { mean: v.blowing(), turbulence, time: v.of("at") })
        }),
    },
    Weather {
        name: "log",
        doc: "what follows it, log+wind, as it is at a height and less below it, by the logarithm over rough ground",
        values: &[("height", 10.0), ("roughness", 0.1), ("displacement", 0.0)],
        make: Make::Carrying(|v, wind| {
            let (roughness, displacement) = (v.of("roughness"), v.of("displacement"));
            grown(v, wind, Growth::Log { roughness, displacement })
        }),
    },
    Weather {
        name: "power",
        doc: "what follows it, power+wind, as it is at a height and less below it, by a power of the height",
        values: &[("height", 10.0), ("exponent", 0.14)],
        make: Make::Carrying(|v, wind| grown(v, wind, Growth::Power { exponent: v.of("exponent") })),
    },
];

const ABOUT: &[(&str, f64)] = &[("strength", 200.0), ("x", 0.0), ("y", -15.0), ("core", 1.0)];

/// No value is larger: what is made of them stays a number.
const MOST: f64 = 1e6;
/// From where to where a value may be, by its name.
fn range(name: &str) -> [f64; 2] {
    match name {
        "scale" | "cell" | "second" | "length" | "radius" | "core" | "decay" | "height" | "roughness" => {
            [1.0 / MOST, MOST]
        }
        "drag" | "viscosity" | "density" | "deviation" | "displacement" => [0.0, MOST],
        "exponent" => [0.0, 2.0],
        // Steeper spectra are no number at their ends.
        "beta" => [0.0, 20.0],
        _ => [-MOST, MOST],
    }
}

/// Values of a wind, all of them.
struct Values {
    weather: &'static Weather,
    values: Vec<f64>,
}

impl Values {
    fn of(&self, name: &str) -> f64 {
        let place = self.weather.values.iter().position(|(known, _)| *known == name);
        place.map_or(0.0, |place| self.values[place])
    }

    fn along(&self) -> Vector {
        let (sin, cos) = self.of("towards").to_radians().sin_cos();
        Vector::new(cos, sin, 0.0)
    }

    fn blowing(&self) -> Vector {
        self.along() * self.of("speed")
    }
}

fn grown(v: &Values, wind: Box<dyn Wind>, growth: Growth) -> Box<dyn Wind> {
    Box::new(Profile { wind, at: v.of("height"), growth })
}

fn about(v: &Values, shape: Shape) -> Box<dyn Wind> {
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

fn gusts(v: &Values, ground: &Ground) -> Blown {
    Ok(Box::new(gusting(v, ground, ground.across(&v.along()))))
}

/// Across and up it swings less than along the mean (Burton and others, Wind Energy Handbook, 2.6).
fn gusting(v: &Values, ground: &Ground, across: [f64; 2]) -> Field {
    let spectra =
        [1.0, 0.8, 0.5].map(|share| Kaimal::along(share * v.of("deviation"), v.of("speed"), v.of("scale")));
    turbulent(v, [&spectra[0], &spectra[1], &spectra[2]], ground, across)
}

/// Air over trees: what each holds back is its mass times the drag, square metres of ground a kilogram and second.
fn flowing(v: &Values, ground: &Ground) -> Blown {
    if let Some(period) = ground.period() {
        return Err(typed::not_round(v.weather.name, period));
    }
    let held = |&(place, mass): &([f64; 2], f64)| (place, v.of("drag") * mass);
    let trees: Vec<([f64; 2], f64)> = ground.trees.iter().map(held).collect();
    let cell = v.of("cell");
    // Of a square from whichever side, half of its diagonal.
    let beyond = (ground.side() + 2.0 * Flowing::AROUND as f64 * cell) / SQRT_2;
    let [low, high] = ground.across(&v.along());
    let air = Flowing::new(&Inflow {
        mean: v.blowing(),
        gusts: &gusting(v, ground, [low - beyond, high + beyond]),
        trees: &trees,
        cell,
        viscosity: v.of("viscosity"),
        seconds: ground.seconds,
        most_bytes: ground.most_bytes,
    });
    Ok(Box::new(air?))
}

/// Turbulence over all that lies between two places across the wind.
fn turbulent(v: &Values, spectra: [&dyn Spectrum; 3], ground: &Ground, [low, high]: [f64; 2]) -> Field {
    let spacing = f64::max(SPACING_M, (high - low) / (MOST_STATIONS - 1) as f64);
    let n_samples = ground.period().map_or(N_SAMPLES, |period| (period / STEP_S).ceil() as usize);
    let draw = Draw {
        mean: v.blowing(),
        decay: v.of("decay"),
        first: low,
        n_stations: ((high - low) / spacing).ceil() as usize + 1,
        spacing,
        n_samples,
        step: ground.period().map_or(STEP_S, |period| period / n_samples as f64),
        seed: v.of("seed") as u64,
    };
    Field::new(&draw, spectra)
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
        "Winds, with their values; metres, seconds, kilograms, hertz, and degrees: 0 towards x, 90 towards y. Several blow at \
         once by a +, as in wind+vortex:strength=300.\n{}\n\
         A file: a row an instant, seconds and two or three components in m/s (x, y, and z up), separated by commas, semicolons, \
         tabs or blanks; the first row may name the columns; evenly timed, without gaps. It begins again after its end.",
        lines.join("\n")
    )
}
