//! A wind by what was typed: names with values, files, and several of them at once.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use honami_exchange::plant::{PlantFileError, anemometer};
use honami_mechanics::Vector;
use honami_mechanics::wind::{Series, Sum, Wind};

use super::{Ground, LONGEST_ROUND_S, Make, N_SAMPLES, STEP_S, Values, WEATHERS, WeatherError, range};

/// Winds that were typed, one after the other; all there is to know of them but what they blow over.
pub struct Typed(Vec<Part>);

enum Part {
    Named(Values),
    Recorded(PathBuf, Series),
}

impl Part {
    fn name(&self) -> String {
        match self {
            Self::Named(values) => values.weather.name.to_owned(),
            Self::Recorded(path, _) => path.display().to_string(),
        }
    }

    /// The name of turbulence that is drawn once and carried by its mean.
    fn drawn(&self) -> Option<&'static str> {
        match self {
            Self::Named(Values { weather, .. }) => {
                weather.values.iter().any(|(known, _)| *known == "decay").then_some(weather.name)
            }
            Self::Recorded(..) => None,
        }
    }
}

/// What does not begin again after so many seconds.
pub(super) fn not_round(name: &str, period: f64) -> WeatherError {
    wrong(format!(
        "{name} is not after {period} s what it was, and what goes round wants a wind that is: steady winds are, gusts are \
         made so, waves where their hz and noise where its second go into these seconds without a rest, a table that lasts \
         for so long; what travels, or flows by itself, is not"
    ))
}

fn wrong(what: String) -> WeatherError {
    WeatherError::Words(what)
}

/// Reads what was typed: names and files with a + between them. One before a digit is part of a number, or of a name.
///
/// # Errors
/// [`WeatherError::Words`] says which names and values there are; and what is wrong with a recording.
pub fn read(typed: &str) -> Result<Typed, WeatherError> {
    let is_file = |text: &str| Path::new(text).is_file();
    let texts = if is_file(typed) { vec![typed] } else { apart(typed) };
    let parts = texts.into_iter().map(part).collect::<Result<Vec<_>, _>>()?;
    let carries = |part: &Part| match part {
        Part::Named(values) if matches!(values.weather.make, Make::Carrying(_)) => Some(values.weather.name),
        Part::Named(_) | Part::Recorded(..) => None,
    };
    if let Some(name) = parts.last().and_then(carries) {
        return Err(wrong(format!("{name} carries what follows it: {name}+noise:speed=0, for instance")));
    }
    let frozen = parts.iter().skip_while(|part| carries(part) != Some("frozen"));
    if let Some(name) = frozen.filter_map(Part::drawn).next() {
        return Err(wrong(format!(
            "{name} is carried by a mean of its own: frozen carries what stays where it is, frozen+noise:speed=0"
        )));
    }
    Ok(Typed(parts))
}

pub(super) fn apart(typed: &str) -> Vec<&str> {
    let mut texts = Vec::new();
    let mut first = 0;
    for (at, _) in typed.match_indices('+') {
        if !typed[at + 1..].starts_with(|next: char| next.is_ascii_digit()) {
            texts.push(&typed[first..at]);
            first = at + 1;
        }
    }
    texts.push(&typed[first..]);
    texts
}

fn part(typed: &str) -> Result<Part, WeatherError> {
    let (name, given) = typed.split_once(':').unwrap_or((typed, ""));
    let Some(weather) = WEATHERS.iter().find(|weather| weather.name == name) else {
        let path = Path::new(typed);
        // What is named as files are is one, also where it is missing.
        let ending = Path::new(name).extension().unwrap_or_default().as_encoded_bytes();
        let has_ending = !ending.is_empty() && ending.iter().all(u8::is_ascii_alphabetic);
        let is_named_so = has_ending || name.contains('/');
        if is_named_so || path.exists() {
            return Ok(Part::Recorded(path.to_owned(), recorded(path)?));
        }
        let names: Vec<&str> = WEATHERS.iter().map(|weather| weather.name).collect();
        return Err(wrong(format!("{typed:?} is no wind and no file: there are {}", names.join(", "))));
    };
    let mut values: Vec<f64> = weather.values.iter().map(|(_, value)| *value).collect();
    let mut told = BTreeSet::new();
    for pair in given.split(',').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let Some(place) = weather.values.iter().position(|(known, _)| *known == key.trim()) else {
            let known: Vec<&str> = weather.values.iter().map(|(known, _)| *known).collect();
            let known = if known.is_empty() { "nothing".to_owned() } else { known.join(", ") };
            return Err(wrong(format!("{name} has no {key:?}: it takes {known}")));
        };
        if !told.insert(place) {
            return Err(wrong(format!("{name} is told its {} twice", key.trim())));
        }
        values[place] = number(name, key.trim(), value)?;
    }
    let values = Values { weather, values };
    let ground = values.of("displacement") + values.of("roughness");
    if weather.values.iter().any(|(known, _)| *known == "roughness") && values.of("height") <= ground {
        return Err(wrong(format!(
            "{name} has its wind above the ground: a height above displacement and roughness, {ground} m"
        )));
    }
    // What is carried by its mean stands still without one.
    let (speed, part) = (values.of("speed"), Part::Named(values));
    match part.drawn() {
        Some(name) if speed <= 0.0 => {
            Err(wrong(format!("{name} is carried by its mean: speed is a number above 0, not {speed}")))
        }
        _ => Ok(part),
    }
}

fn number(name: &str, key: &str, value: &str) -> Result<f64, WeatherError> {
    if key == "seed" {
        // Any is as good as another.
        let seed = value.trim().parse::<u32>().map(f64::from);
        return seed
            .map_err(|_none| wrong(format!("seed of {name} is a whole number, 0 or more, not {value:?}")));
    }
    let [least, most] = range(key);
    let found = value.trim().parse().ok().filter(|v| (least..=most).contains(v));
    found.ok_or_else(|| wrong(format!("{key} of {name} is a number from {least} to {most}, not {value:?}")))
}

fn recorded(path: &Path) -> Result<Series, WeatherError> {
    let text =
        fs::read_to_string(path).map_err(|source| PlantFileError::Io { path: path.to_owned(), source })?;
    let recording = anemometer::parse(&text).map_err(|error| error.of(path))?;
    let samples: Vec<Vector> = recording.samples.into_iter().map(Vector::from).collect();
    Ok(Series { step: recording.step, samples })
}

impl Typed {
    /// These, and then others: what carries the winds after it carries none of these.
    #[must_use]
    pub fn and(mut self, others: Self) -> Self {
        self.0.extend(others.0);
        self
    }

    /// Recordings among them.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.0.iter().filter_map(|part| match part {
            Part::Recorded(path, _) => Some(path.as_path()),
            Part::Named(_) => None,
        })
    }

    /// What begins again before so many seconds are over, a sentence each.
    #[must_use]
    pub fn again(&self, seconds: f64) -> Vec<String> {
        let lasts = |part: &Part| match part {
            Part::Recorded(path, series) => {
                Some((format!("{}, a recording,", path.display()), series.period()))
            }
            Part::Named(_) => part.drawn().map(|name| (name.to_owned(), N_SAMPLES as f64 * STEP_S)),
        };
        // What is frozen has stopped.
        let runs =
            self.0.iter().take_while(|part| !matches!(part, Part::Named(v) if v.weather.name == "frozen"));
        let short = runs.filter_map(lasts).filter(|(_, lasts)| *lasts < seconds * (1.0 - 1e-9));
        short
            .map(|(name, lasts)| {
                format!("{name} lasts for {lasts:.1} s, the motion for {seconds:.1} s: it begins again")
            })
            .collect()
    }

    /// The wind over some ground.
    ///
    /// # Errors
    /// What cannot flow over it.
    pub fn over(&self, ground: &Ground) -> Result<Box<dyn Wind>, WeatherError> {
        if let Some(period) = ground.period().filter(|period| *period > LONGEST_ROUND_S) {
            return Err(wrong(format!(
                "a wind begins again after {LONGEST_ROUND_S} s at most, not {period} s"
            )));
        }
        // From the last: what carries takes all that follows it.
        let mut winds: Vec<Box<dyn Wind>> = Vec::new();
        for part in self.0.iter().rev() {
            let wind = match part {
                Part::Recorded(_, series) => Box::new(series.clone()),
                Part::Named(values) => match values.weather.make {
                    Make::Alone(make) => make(values),
                    Make::Over(make) => make(values, ground)?,
                    Make::Carrying(make) => make(values, together(std::mem::take(&mut winds))),
                },
            };
            if let Some(period) = ground.period().filter(|period| !wind.repeats(*period)) {
                return Err(not_round(&part.name(), period));
            }
            winds.push(wind);
        }
        winds.reverse();
        Ok(together(winds))
    }
}

fn together(mut winds: Vec<Box<dyn Wind>>) -> Box<dyn Wind> {
    match winds.pop() {
        Some(wind) if winds.is_empty() => wind,
        Some(last) => {
            winds.push(last);
            Box::new(Sum(winds))
        }
        None => Box::new(Sum(winds)),
    }
}
