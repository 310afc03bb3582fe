//! The form of a plugin, drawn from its parameter schema; a plugin never draws.

use std::ops::Range;

use honami_workbench::plugins::{Entry, Numeric, Param, ParamKind, Prospect, Value, Values};

/// What a plugin does for the terminal UI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Follows features.
    Track,
    /// Groups tracks.
    Cluster,
}

impl Task {
    /// What a plugin that does it is called.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Track => "tracker",
            Self::Cluster => "clusterer",
        }
    }
}

/// A plugin that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Plugin {
    /// What it does.
    pub task: Task,
    /// Its short name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its parameters.
    pub params: Vec<Param>,
    /// Whether it can find features by itself.
    pub can_detect: bool,
    /// Where it will work, and how far it will be shut in there.
    pub apart: Prospect,
}

/// Where a tracker's features come from: id of a parameter of ours.
pub const FEATURES: &str = "@features";
/// Every how many frames new features are looked for: id of a parameter of ours.
pub const EVERY: &str = "@every";
/// The first and the last frame to track: id of a parameter of ours.
pub const FRAMES: &str = "@frames";

/// What a tracker can be asked to do here.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted<'a> {
    /// Which features it can follow, the likeliest first.
    pub features: &'a [Features],
    /// Through which frames it likely is to follow them.
    pub frames: Range<u32>,
    /// Frames of the clip.
    pub n_frames: u32,
    /// What plugins were told last.
    pub used: &'a [Used],
}

/// What a plugin was told last in this project.
#[derive(Clone, Debug, PartialEq)]
pub struct Used {
    /// What it does.
    pub task: Task,
    /// Its short name.
    pub plugin: String,
    /// The values of its parameters; perhaps of some that it has no more, or not yet.
    pub values: Values,
}

/// Which features a tracker follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// Those it finds by itself.
    Found,
    /// Those of all tracks that are there.
    Here,
    /// That of the selected track.
    Selected,
}

impl Features {
    const ALL: [Self; 3] = [Self::Found, Self::Here, Self::Selected];

    /// What the form calls them: the value of [`FEATURES`].
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Found => "found anew",
            Self::Here => "the tracks here",
            Self::Selected => "the selected track",
        }
    }
}

/// A form being filled in.
#[derive(Clone, Debug)]
pub struct Form {
    /// The task.
    pub task: Task,
    /// The plugins that do it.
    pub plugins: Vec<Plugin>,
    /// Which of them.
    pub which: usize,
    /// The row that keys work on.
    pub at: usize,
    /// Whether the advanced parameters are shown.
    pub unfolded: bool,
    /// What is being typed into the row.
    pub typed: Option<String>,
    values: Values,
    n_frames: u32,
    used: Vec<Used>,
}

/// A row of a form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Row<'a> {
    /// Which plugin.
    Plugin(&'a Plugin),
    /// A parameter and its value.
    Param(&'a Param, &'a Value),
    /// So many advanced parameters, folded or not.
    Fold(usize),
}

impl Form {
    /// The form of a task; `None` when no plugin does it. A tracker follows the likeliest features through the
    /// likeliest frames, unless something else is chosen.
    #[must_use]
    pub fn new(task: Task, plugins: &[Plugin], wanted: &Wanted<'_>) -> Option<Self> {
        let mut plugins: Vec<Plugin> = plugins.iter().filter(|p| p.task == task).cloned().collect();
        for plugin in plugins.iter_mut().filter(|p| p.task == Task::Track) {
            let ours = own_params(plugin.can_detect, wanted);
            plugin.params.splice(0..0, ours);
        }
        let used = wanted.used.iter().filter(|used| used.task == task).cloned().collect();
        let (values, n_frames) = (Values::defaults(&plugins.first()?.params), wanted.n_frames);
        let mut form =
            Self { task, plugins, which: 0, at: 0, unfolded: false, typed: None, values, n_frames, used };
        form.begin(0);
        Some(form)
    }

    /// Begins with a plugin, as it was used last.
    fn begin(&mut self, which: usize) {
        self.which = which;
        self.values = Values::defaults(&self.plugin().params);
        if let Some(used) = self.used.iter().position(|used| used.plugin == self.plugin().name) {
            let values = self.used[used].values.clone();
            self.fill_in(&values);
        }
    }

    /// Fills in what the plugin takes; what it takes no more is as it is by itself.
    fn fill_in(&mut self, values: &Values) {
        for (id, value) in values.iter() {
            self.values.set(&self.plugins[self.which].params, id, value.clone()).ok();
        }
    }

    /// Chooses a plugin by its name, where it does this task.
    pub fn choose(&mut self, name: &str) {
        if let Some(which) = self.plugins.iter().position(|plugin| plugin.name == name) {
            self.begin(which);
        }
    }

    /// Takes what was filled into another form of this task: the plugin, and what it still takes under the same ids.
    pub fn take(&mut self, other: &Self) {
        self.choose(&other.plugin().name);
        self.fill_in(&other.values);
        self.unfolded = other.unfolded;
        self.typed.clone_from(&other.typed);
        self.at = other.at.min(self.rows().len().saturating_sub(1));
    }

    /// The chosen plugin.
    #[must_use]
    pub fn plugin(&self) -> &Plugin {
        &self.plugins[self.which]
    }

    /// The values of the plugin's own parameters.
    #[must_use]
    pub fn values(&self) -> Values {
        let params: Vec<Param> =
            self.plugin().params.iter().filter(|p| !p.id.starts_with('@')).cloned().collect();
        let mut values = Values::defaults(&params);
        for param in &params {
            if let Some(value) = self.values.get(&param.id) {
                // It was checked when it was set.
                values.set(&params, &param.id, value.clone()).ok();
            }
        }
        values
    }

    /// The features to follow.
    #[must_use]
    pub fn features(&self) -> Features {
        let is_chosen = |f: &Features| self.values.get(FEATURES) == Some(&Value::Text(f.word().to_owned()));
        Features::ALL.into_iter().find(is_chosen).unwrap_or(Features::Found)
    }

    /// Every how many frames new features are looked for; `None`: only at the first.
    #[must_use]
    pub fn every(&self) -> Option<u32> {
        match self.values.get(EVERY) {
            Some(Value::Int(n)) => u32::try_from(*n).ok().filter(|n| *n > 0),
            _ => None,
        }
    }

    /// The frames to track.
    #[must_use]
    pub fn frames(&self) -> Range<u32> {
        let all = 0..self.n_frames;
        match self.values.get(FRAMES) {
            // It was checked when it was set.
            Some(Value::Text(text)) => frames_of(text, self.n_frames).unwrap_or(all),
            _ => all,
        }
    }

    /// The rows that count now.
    #[must_use]
    pub fn rows(&self) -> Vec<Row<'_>> {
        let active = || self.plugin().params.iter().filter(|p| self.values.is_active(p));
        let row = |p| self.values.get(&Param::clone(p).id).map(|value| Row::Param(p, value));
        let mut rows = vec![Row::Plugin(self.plugin())];
        rows.extend(active().filter(|p| !p.advanced).filter_map(row));
        let advanced: Vec<Row<'_>> = active().filter(|p| p.advanced).filter_map(row).collect();
        if !advanced.is_empty() {
            rows.push(Row::Fold(advanced.len()));
        }
        if self.unfolded {
            rows.extend(advanced);
        }
        rows
    }

    /// Moves to another row.
    pub fn step(&mut self, rows: i64) {
        let last = self.rows().len().saturating_sub(1);
        let at = i64::try_from(self.at).unwrap_or(0) + rows;
        self.at = usize::try_from(at).unwrap_or(0).min(last);
    }

    /// Changes the row's value by so many steps, or by tenths of its range.
    pub fn change(&mut self, steps: i64, coarse: bool) {
        match self.rows().get(self.at).copied() {
            Some(Row::Plugin(_)) => {
                let n = i64::try_from(self.plugins.len()).unwrap_or(1);
                let which = (i64::try_from(self.which).unwrap_or(0) + steps).rem_euclid(n);
                self.begin(usize::try_from(which).unwrap_or(0));
            }
            Some(Row::Fold(_)) => self.unfolded = !self.unfolded,
            Some(Row::Param(param, value)) => match changed(param, value, steps, coarse) {
                Some(value) => {
                    let id = param.id.clone();
                    let params = self.plugins[self.which].params.clone();
                    // A step beyond the range stays where it was.
                    self.values.set(&params, &id, value).ok();
                }
                None => self.typed = Some(value.to_string()),
            },
            None => {}
        }
    }

    /// Begins to type a value with its first character.
    pub fn type_first(&mut self, c: char) {
        let is_param = matches!(self.rows().get(self.at), Some(Row::Param(..)));
        if is_param && (c.is_ascii_digit() || c == '.' || c == '-') {
            self.typed = Some(c.to_string());
        }
    }

    /// Takes what was typed into the row.
    ///
    /// # Errors
    /// A line that says what the parameter takes; then the typed text stays.
    pub fn take_typed(&mut self) -> Result<(), String> {
        let Some(typed) = self.typed.clone() else { return Ok(()) };
        if let Some(Row::Param(param, _)) = self.rows().get(self.at).copied() {
            if param.id == FRAMES {
                frames_of(&typed, self.n_frames)?;
            }
            let assignment = format!("{}={typed}", param.id);
            let params = self.plugins[self.which].params.clone();
            self.values.set_text(&params, &assignment).map_err(|error| error.to_string())?;
        }
        self.typed = None;
        Ok(())
    }
}

/// Parameters of every tracking, whatever the plugin.
fn own_params(can_detect: bool, wanted: &Wanted<'_>) -> Vec<Param> {
    let param = |id: &str, label: &str, doc: &str, kind| Param {
        id: id.to_owned(),
        label: label.to_owned(),
        group: String::new(),
        doc: doc.to_owned(),
        unit: String::new(),
        affects: String::new(),
        advanced: false,
        when: std::collections::BTreeMap::new(),
        kind,
    };
    let features = wanted.features.iter().filter(|&&f| can_detect || f != Features::Found);
    let entry = |f: &Features| Entry { id: f.word().to_owned(), label: String::new(), doc: String::new() };
    let entries: Vec<Entry> = features.map(entry).collect();
    let Some(default) = entries.first().map(|first| first.id.clone()) else { return Vec::new() };
    let kind = ParamKind::Enum { default, entries };
    let mut ours = vec![param(FEATURES, "features", "", kind)];
    if can_detect {
        let range = Numeric {
            default: 0,
            min: Some(0),
            max: None,
            soft_min: None,
            soft_max: Some(100),
            step: Some(5),
            scale: String::new(),
        };
        let mut every = param(EVERY, "look again", "every so many frames; 0: never", ParamKind::Int(range));
        every.unit = "frames".to_owned();
        every.when.insert(FEATURES.to_owned(), Value::Text(Features::Found.word().to_owned()));
        ours.push(every);
    }
    let default = frames_text(&wanted.frames);
    let doc = "the first and the last to track";
    ours.push(param(FRAMES, "frames", doc, ParamKind::String { default }));
    ours
}

/// Frames as the form shows them: `0-149`, both ends included.
fn frames_text(frames: &Range<u32>) -> String {
    format!("{}-{}", frames.start, frames.end.saturating_sub(1))
}

/// Frames as they are typed.
fn frames_of(text: &str, n_frames: u32) -> Result<Range<u32>, String> {
    let number = |word: &str| word.trim().parse::<u32>().ok();
    text.split_once('-')
        .and_then(|(first, last)| Some((number(first)?, number(last)?)))
        .filter(|(first, last)| first <= last && *last < n_frames)
        .map(|(first, last)| first..last + 1)
        .ok_or_else(|| {
            let all = frames_text(&(0..n_frames));
            format!("frames: wanted the first and the last, of {all}, got {text:?}")
        })
}

/// A value so many steps on; `None` for what can only be typed.
fn changed(param: &Param, value: &Value, steps: i64, coarse: bool) -> Option<Value> {
    Some(match (&param.kind, value) {
        (ParamKind::Bool { .. }, Value::Bool(b)) => Value::Bool(!b),
        (ParamKind::Enum { entries, .. }, Value::Text(id)) => {
            let at = entries.iter().position(|e| e.id == *id).unwrap_or(0);
            let n = i64::try_from(entries.len()).unwrap_or(1).max(1);
            let next = (i64::try_from(at).unwrap_or(0) + steps).rem_euclid(n);
            Value::Text(entries.get(usize::try_from(next).unwrap_or(0))?.id.clone())
        }
        (ParamKind::Int(range), Value::Int(i)) => {
            let span = slider(range).map_or(10, |(low, high)| high - low);
            let step = range.step.unwrap_or((span / 40).max(1));
            let step = if coarse { (span / 10).max(step) } else { step };
            let next = i.saturating_add(steps.saturating_mul(step));
            Value::Int(next.clamp(range.min.unwrap_or(i64::MIN), range.max.unwrap_or(i64::MAX)))
        }
        (ParamKind::Seed { .. }, Value::Int(i)) => Value::Int(i.saturating_add(steps).max(0)),
        (ParamKind::Float(range), Value::Float(x)) => {
            let next = if range.scale == "log" && *x > 0.0 {
                x * (if coarse { 2.0_f64 } else { 1.1 }).powi(i32::try_from(steps).unwrap_or(1))
            } else {
                let span = slider(range).map_or(1.0, |(low, high)| high - low);
                let step = range.step.unwrap_or(span / 40.0);
                x + steps as f64 * if coarse { (span / 10.0).max(step) } else { step }
            };
            Value::Float(tidy(
                next.clamp(range.min.unwrap_or(f64::NEG_INFINITY), range.max.unwrap_or(f64::INFINITY)),
            ))
        }
        _ => return None,
    })
}

/// Ends of a number's slider, where it has any.
#[must_use]
pub fn slider<T: Copy + PartialOrd>(range: &Numeric<T>) -> Option<(T, T)> {
    let low = range.soft_min.or(range.min)?;
    let high = range.soft_max.or(range.max)?;
    (low < high).then_some((low, high))
}

/// The number without the noise of binary fractions: six significant digits.
fn tidy(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests;
