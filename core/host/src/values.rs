//! Values of parameters: defaults from the schema, changes as text or typed, checked; unknown ones are kept.

use crate::manifest::{Numeric, Param, ParamKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

pub use honami_model::provenance::Value;

/// Why a parameter cannot have a value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ValueError {
    /// Not of the form `name=value`.
    #[error("{0:?} is not of the form name=value")]
    Form(String),
    /// No such parameter.
    #[error("there is no parameter {id:?}{}; there are: {known}", crate::error::alike(id, known))]
    Unknown {
        /// As it was asked for.
        id: String,
        /// The ids that exist, comma-separated.
        known: String,
    },
    /// Wrong type or out of range.
    #[error("{id}: wanted {wanted}, got {got:?}")]
    Wrong {
        /// The parameter.
        id: String,
        /// Type and range.
        wanted: String,
        /// What came.
        got: String,
    },
}

/// Values by parameter id. Holds what it is given, also ids that no schema knows: a project keeps those of absent plugins.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Values(BTreeMap<String, Value>);

impl Values {
    /// What a schema says unless told otherwise.
    #[must_use]
    pub fn defaults(params: &[Param]) -> Self {
        Self(params.iter().map(|param| (param.id.clone(), param.default())).collect())
    }

    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<&Value> {
        self.0.get(id)
    }

    /// All of them, by id.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.0.iter().map(|(id, value)| (id.as_str(), value))
    }

    /// Sets a parameter after checking type and range.
    ///
    /// # Errors
    /// [`ValueError`] says what the parameter takes.
    pub fn set(&mut self, params: &[Param], id: &str, value: Value) -> Result<(), ValueError> {
        let param = find(params, id)?;
        self.0.insert(id.to_owned(), param.check(value)?);
        Ok(())
    }

    /// Sets a parameter from `name=value`, as in `--set radius=10`.
    ///
    /// # Errors
    /// [`ValueError`] says what the parameter takes.
    pub fn set_text(&mut self, params: &[Param], assignment: &str) -> Result<(), ValueError> {
        let (id, text) = assignment.split_once('=').ok_or_else(|| ValueError::Form(assignment.to_owned()))?;
        let (param, text) = (find(params, id.trim())?, text.trim());
        let value = param.parse(text).ok_or_else(|| param.wrong(text))?;
        self.0.insert(param.id.clone(), param.check(value)?);
        Ok(())
    }

    /// Checks every value that the schema knows.
    ///
    /// # Errors
    /// [`ValueError`] of the first that does not fit.
    pub fn validate(&self, params: &[Param]) -> Result<(), ValueError> {
        for param in params {
            if let Some(value) = self.get(&param.id) {
                param.check(value.clone())?;
            }
        }
        Ok(())
    }

    /// Lays values kept earlier over these defaults: renamed ids are followed, unknown ones kept untouched.
    pub fn restore(&mut self, kept: &Self, renamed: &BTreeMap<String, String>) {
        for (id, value) in kept.iter() {
            self.0.insert(renamed.get(id).map_or(id, String::as_str).to_owned(), value.clone());
        }
    }

    /// Whether a parameter counts under the present values of the others.
    #[must_use]
    pub fn is_active(&self, param: &Param) -> bool {
        param.when.iter().all(|(other, wanted)| self.get(other) == Some(wanted))
    }
}

/// Values as they were kept, of whatever schema they were.
impl FromIterator<(String, Value)> for Values {
    fn from_iter<I: IntoIterator<Item = (String, Value)>>(kept: I) -> Self {
        Self(kept.into_iter().collect())
    }
}

fn find<'p>(params: &'p [Param], id: &str) -> Result<&'p Param, ValueError> {
    params.iter().find(|param| param.id == id).ok_or_else(|| {
        let known = params.iter().map(|param| param.id.as_str()).collect::<Vec<_>>().join(", ");
        ValueError::Unknown { id: id.to_owned(), known: if known.is_empty() { "none".into() } else { known } }
    })
}

impl Param {
    /// The value unless set.
    #[must_use]
    pub fn default(&self) -> Value {
        match &self.kind {
            ParamKind::Bool { default } => Value::Bool(*default),
            ParamKind::Int(Numeric { default, .. }) | ParamKind::Seed { default } => Value::Int(*default),
            ParamKind::Float(Numeric { default, .. }) => Value::Float(*default),
            ParamKind::Enum { default, .. }
            | ParamKind::String { default }
            | ParamKind::Path { default, .. } => Value::Text(default.clone()),
            ParamKind::Vec2 { default } => Value::List(default.to_vec()),
            ParamKind::Rect { default } => Value::List(default.to_vec()),
        }
    }

    /// A value as somebody typed it; `None` when it is of another type.
    fn parse(&self, text: &str) -> Option<Value> {
        Some(match &self.kind {
            ParamKind::Bool { .. } => Value::Bool(match text {
                "true" | "yes" | "on" | "1" => true,
                "false" | "no" | "off" | "0" => false,
                _ => return None,
            }),
            ParamKind::Int(_) | ParamKind::Seed { .. } => Value::Int(text.parse().ok()?),
            ParamKind::Float(_) => Value::Float(text.parse().ok()?),
            ParamKind::Enum { .. } | ParamKind::String { .. } | ParamKind::Path { .. } => {
                Value::Text(text.to_owned())
            }
            ParamKind::Vec2 { .. } | ParamKind::Rect { .. } => {
                Value::List(text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?)
            }
        })
    }

    /// The value in the parameter's own type.
    ///
    /// # Errors
    /// [`ValueError::Wrong`] when it is of another type or out of range.
    pub fn check(&self, value: Value) -> Result<Value, ValueError> {
        // Whole numbers stand for floats: JSON and people write 2 for 2.0.
        let value = match (&self.kind, value) {
            (ParamKind::Float(_), Value::Int(i)) => Value::Float(i as f64),
            (_, value) => value,
        };
        let fits = match (&self.kind, &value) {
            (ParamKind::Bool { .. }, Value::Bool(_)) => true,
            (ParamKind::Int(range), Value::Int(i)) => range.holds(i),
            (ParamKind::Float(range), Value::Float(x)) => x.is_finite() && range.holds(x),
            (ParamKind::Seed { .. }, Value::Int(i)) => *i >= 0,
            (ParamKind::Enum { entries, .. }, Value::Text(id)) => entries.iter().any(|entry| entry.id == *id),
            (ParamKind::String { .. } | ParamKind::Path { .. }, Value::Text(text)) => !text.contains('\0'),
            (ParamKind::Vec2 { .. }, Value::List(list)) => {
                list.len() == 2 && list.iter().all(|n| n.is_finite())
            }
            (ParamKind::Rect { .. }, Value::List(list)) => {
                list.len() == 4 && list.iter().all(|n| n.is_finite())
            }
            _ => false,
        };
        if fits { Ok(value) } else { Err(self.wrong(&value.to_string())) }
    }

    fn wrong(&self, got: &str) -> ValueError {
        ValueError::Wrong { id: self.id.clone(), wanted: self.wanted(), got: got.to_owned() }
    }

    /// Type and range in words: `a whole number, 2 to 50 (px)`.
    #[must_use]
    pub fn wanted(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        match &self.kind {
            ParamKind::Bool { .. } => "true or false".into(),
            ParamKind::Int(range) => format!("a whole number{}{unit}", range.words()),
            ParamKind::Float(range) => format!("a number{}{unit}", range.words()),
            ParamKind::Seed { .. } => "a whole number from 0".into(),
            ParamKind::Enum { entries, .. } => {
                let ids: Vec<_> = entries.iter().map(|entry| entry.id.as_str()).collect();
                format!("one of {}", ids.join(", "))
            }
            ParamKind::String { .. } => "a text".into(),
            ParamKind::Path { .. } => "a path".into(),
            ParamKind::Vec2 { .. } => format!("x,y{unit}"),
            ParamKind::Rect { .. } => format!("x,y,width,height{unit}"),
        }
    }
}

impl<T: PartialOrd + std::fmt::Display> Numeric<T> {
    fn holds(&self, value: &T) -> bool {
        self.min.as_ref().is_none_or(|min| value >= min) && self.max.as_ref().is_none_or(|max| value <= max)
    }

    fn words(&self) -> String {
        match (&self.min, &self.max) {
            (Some(min), Some(max)) => format!(", {min} to {max}"),
            (Some(min), None) => format!(", at least {min}"),
            (None, Some(max)) => format!(", at most {max}"),
            (None, None) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests;
