//! What a user has settled: keys, theme, mouse and plugins, in `$XDG_CONFIG_HOME/honami/config.toml`.
//!
//! What is changed on screen and not settled there is kept in `$XDG_STATE_HOME/honami/choices.toml`.

mod plugins;

use std::fs;
use std::path::{Path, PathBuf};

use honami_workbench::plugins::{Hosting, Limits};

use super::keymap::KeyMap;
use super::state::State;
use super::view::theme::Theme;
use plugins::Plugins;

/// What can be settled.
const NAMES: [&str; 5] = ["keys", "theme", "themes", "mouse", "plugins"];

/// What the terminal UI begins with.
#[derive(Clone, Debug)]
pub struct Config {
    /// The live key map.
    pub keys: KeyMap,
    /// The themes there are.
    pub themes: Vec<Theme>,
    /// The one to begin with.
    pub theme: usize,
    /// Whether the mouse is ours.
    pub mouse: bool,
    /// How plugins are started.
    pub plugins: Plugins,
    /// What is wrong with what was settled, one line each.
    pub wrong: Vec<String>,
    /// What is wrong with what the environment says, one line each.
    misspelt: Vec<String>,
    /// What came of the end before, one line each.
    kept_out: Vec<String>,
    /// Whether theme and mouse were settled, so that no choice on screen outlasts the session.
    settled: (bool, bool),
}

impl Default for Config {
    fn default() -> Self {
        Self::of("", "")
    }
}

impl Config {
    /// Reads what was settled and chosen; what is not there is as usual.
    #[must_use]
    pub fn load() -> Self {
        let read = |path: Option<PathBuf>| match path.as_deref().map(fs::read_to_string) {
            Some(Ok(text)) => Ok(text),
            Some(Err(error)) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
            _ => Ok(String::new()),
        };
        let chosen = read(choices_path()).unwrap_or_default();
        let mut config = match read(Self::path()) {
            Ok(text) => Self::of(&text, &chosen),
            Err(error) => {
                let mut config = Self::of("", &chosen);
                config.wrong.push(format!("it cannot be read: {error}"));
                config
            }
        };
        config.misspelt = plugins::misspelt(Hosting::of_environment(), Limits::memory_of_environment());
        config
    }

    /// Where a user settles things.
    #[must_use]
    pub fn path() -> Option<PathBuf> {
        folder("XDG_CONFIG_HOME", ".config").map(|folder| folder.join("config.toml"))
    }

    /// The text of a configuration, and of what was chosen on screen.
    #[must_use]
    pub fn of(text: &str, chosen: &str) -> Self {
        let mut wrong = Vec::new();
        let table: toml::Table = text.parse().unwrap_or_else(|error: toml::de::Error| {
            wrong.push(format!("it is no TOML: {}", error.message()));
            toml::Table::new()
        });
        for name in table.keys().filter(|name| !NAMES.contains(&name.as_str())) {
            wrong.push(format!("{name} is not known; there are {}", NAMES.join(", ")));
        }
        let none = toml::Table::new();
        let part = |name: &str| table.get(name).and_then(toml::Value::as_table).unwrap_or(&none);
        let (keys, wrong_keys) = KeyMap::with(part("keys"));
        wrong.extend(wrong_keys);
        let (plugins, wrong_plugins) = Plugins::of(table.get("plugins"));
        wrong.extend(wrong_plugins);
        let mut themes = Theme::all();
        for (name, wanted) in part("themes") {
            let wanted = wanted.as_table().unwrap_or(&none);
            let like = wanted.get("like").and_then(toml::Value::as_str);
            let base =
                like.and_then(|like| themes.iter().find(|theme| theme.name == like)).unwrap_or(&themes[0]);
            let (theme, wrong_theme) = Theme::like(base, name, wanted);
            wrong.extend(wrong_theme);
            themes.push(theme);
        }
        // A file of choices that cannot be read is as good as none.
        let chosen: toml::Table = chosen.parse().unwrap_or_default();
        let settled = (table.contains_key("theme"), table.contains_key("mouse"));
        let named = table.get("theme").or(chosen.get("theme")).and_then(toml::Value::as_str);
        let theme = named.and_then(|named| themes.iter().position(|theme| theme.name == named));
        if let Some(named) = named.filter(|_| theme.is_none() && settled.0) {
            let known: Vec<&str> = themes.iter().map(|theme| theme.name.as_str()).collect();
            wrong.push(format!("there is no theme {named}; there are {}", known.join(", ")));
        }
        let mouse = table.get("mouse").or(chosen.get("mouse")).and_then(toml::Value::as_bool).unwrap_or(true);
        Self {
            keys,
            themes,
            theme: theme.unwrap_or(0),
            mouse,
            plugins,
            wrong,
            misspelt: Vec::new(),
            kept_out: Vec::new(),
            settled,
        }
    }

    /// Takes the settings into a state.
    pub(super) fn take(&self, state: &mut State) {
        state.keys = self.keys.clone();
        state.themes = self.themes.clone();
        state.theme = self.theme;
        state.mouse = self.mouse;
    }

    /// As it is for who begins to start plugins now: with what became of them since, which is told once.
    #[must_use]
    pub fn beginning(self) -> Self {
        let plugins = self.plugins.host().follow_trails();
        Self {
            kept_out: plugins.iter().map(|(plugin, library)| plugins::kept_out(plugin, library)).collect(),
            ..self
        }
    }

    /// One line for the screen, where something is wrong.
    #[must_use]
    pub fn complaint(&self) -> Option<String> {
        let lines = self.complaints();
        (!lines.is_empty()).then(|| lines.join(" · "))
    }

    /// What there is to say at the start, one line each.
    #[must_use]
    pub fn complaints(&self) -> Vec<String> {
        let settled = self.wrong.split_first().map(|(first, others)| match others.len() {
            0 => format!("config.toml: {first}"),
            n => format!("config.toml: {first}, and {n} more: `honami keys --check` says all"),
        });
        self.kept_out.iter().chain(&self.misspelt).cloned().chain(settled).collect()
    }

    /// Keeps what was chosen on screen and is not settled. Lost without harm: nobody is told.
    pub(super) fn keep(&self, state: &State) {
        if (state.theme, state.mouse) == (self.theme, self.mouse) {
            return;
        }
        let mut chosen = toml::Table::new();
        if let Some(theme) = state.themes.get(state.theme).filter(|_| !self.settled.0) {
            chosen.insert("theme".to_owned(), theme.name.clone().into());
        }
        if !self.settled.1 {
            chosen.insert("mouse".to_owned(), state.mouse.into());
        }
        if let Some(path) = choices_path() {
            fs::create_dir_all(path.parent().unwrap_or(Path::new("/"))).ok();
            fs::write(path, chosen.to_string()).ok();
        }
    }
}

fn choices_path() -> Option<PathBuf> {
    folder("XDG_STATE_HOME", ".local/state").map(|folder| folder.join("choices.toml"))
}

/// honami's folder in one of the user's: as the variable says, else in the home folder.
pub(super) fn folder(variable: &str, in_home: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(in_home));
    named.or_else(home).map(|folder| folder.join("honami"))
}

#[cfg(test)]
mod tests;
