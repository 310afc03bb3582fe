//! Parameters: one declaration gives the struct, its schema in the manifest, and its values from the host.

use crate::{Error, Result};
use honami_abi::code;
use std::path::PathBuf;

/// A set of parameters; [`params!`](crate::params!) implements it.
pub trait Params: Default + Send + 'static {
    /// What the host draws its form from.
    const SCHEMA: &'static [Param];

    /// Sets one parameter; ignores unknown ids, as the ABI wants.
    ///
    /// # Errors
    /// When the value is of another kind.
    fn set(&mut self, id: &str, value: Value<'_>) -> Result<()>;
}

impl Params for () {
    const SCHEMA: &'static [Param] = &[];
    fn set(&mut self, _: &str, _: Value<'_>) -> Result<()> {
        Ok(())
    }
}

/// One parameter of a schema.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Its name for machines, the field's.
    pub id: &'static str,
    /// Its type for machines: `"int"`, `"enum"`, …
    pub kind: &'static str,
    /// The lines of its doc comment.
    pub doc: &'static [&'static str],
    /// The default, as JSON.
    pub default: &'static str,
    /// `min`, `unit` and so on, as JSON.
    pub attributes: &'static [(&'static str, &'static str)],
    /// The choices, for an enum.
    pub entries: &'static [Entry],
}

/// One choice of an enum parameter.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Its name for machines, kept in projects.
    pub id: &'static str,
    /// Its name for people.
    pub label: &'static str,
    /// The lines of its doc comment.
    pub doc: &'static [&'static str],
}

/// A value from the host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Int(i64),
    /// A number.
    Float(f64),
    /// A string, a path or the id of a choice.
    Text(&'a str),
    /// x, y.
    Vec2([f64; 2]),
    /// x, y, width, height.
    Rect([f64; 4]),
    /// A seed of random choices.
    Seed(u64),
}

/// A type that a parameter can have: `bool`, `i64`, `f64`, `String`, `PathBuf`, `u64` (a seed), `[f64; 2]` (a vector),
/// `[f64; 4]` (a rectangle), or an enum made by [`choice!`](crate::choice!).
pub trait ParamType: Sized {
    /// Its name in the manifest.
    const KIND: &'static str;
    /// The choices, for an enum.
    const ENTRIES: &'static [Entry] = &[];
    /// How its default is written.
    type Literal;
    /// The default.
    fn from_literal(literal: Self::Literal) -> Self;
    /// From the host; `None` when of another kind.
    fn from_value(value: Value<'_>) -> Option<Self>;
}

macro_rules! param_type {
    ($($ty:ty, $literal:ty, $kind:literal, $pattern:pat => $value:expr;)*) => { $(
        impl ParamType for $ty {
            const KIND: &'static str = $kind;
            type Literal = $literal;
            fn from_literal(literal: $literal) -> Self {
                literal.into()
            }
            fn from_value(value: Value<'_>) -> Option<Self> {
                match value {
                    $pattern => Some($value),
                    _ => None,
                }
            }
        }
    )* };
}

param_type! {
    bool, bool, "bool", Value::Bool(b) => b;
    i64, i64, "int", Value::Int(i) => i;
    f64, f64, "float", Value::Float(f) => f;
    u64, u64, "seed", Value::Seed(s) => s;
    String, &'static str, "string", Value::Text(t) => t.to_owned();
    PathBuf, &'static str, "path", Value::Text(t) => t.into();
    [f64; 2], [f64; 2], "vec2", Value::Vec2(v) => v;
    [f64; 4], [f64; 4], "rect", Value::Rect(r) => r;
}

#[doc(hidden)]
pub fn assign<T: ParamType>(field: &mut T, id: &str, value: Value<'_>) -> Result<()> {
    *field = T::from_value(value).ok_or_else(|| {
        Error::with_code(
            code::ARGUMENT,
            format!("parameter {id} is of type {}, the value {value:?} is not", T::KIND),
        )
    })?;
    Ok(())
}

/// Parameters of a struct and of those it takes in.
#[doc(hidden)]
#[must_use]
pub const fn joined_len(parts: &[&[Param]]) -> usize {
    let (mut i, mut n) = (0, 0);
    while i < parts.len() {
        n += parts[i].len();
        i += 1;
    }
    n
}

/// All of them in one list; `N` is [`joined_len`].
#[doc(hidden)]
#[must_use]
pub const fn joined<const N: usize>(parts: &[&[Param]]) -> [Param; N] {
    const BLANK: Param = Param { id: "", kind: "", doc: &[], default: "", attributes: &[], entries: &[] };
    let mut all = [BLANK; N];
    let (mut i, mut n) = (0, 0);
    while i < parts.len() {
        let mut k = 0;
        while k < parts[i].len() {
            all[n] = parts[i][k];
            (k, n) = (k + 1, n + 1);
        }
        i += 1;
    }
    all
}

/// Declares parameters: a struct with `Default`, and its [`Params`].
///
/// Doc comments become the parameters' descriptions. The default comes first, then `=> { … }` with what there is to say
/// of `label`, `group`, `unit`, `min`, `max`, `soft_min`, `soft_max` (ends of the slider), `step`, `scale` (`"log"`),
/// `relative_to`, `affects` (`"seed"`, `"track"`, `"step"`, `"all"`), `advanced`, `when` (`when: other == value`), and `mode` and
/// `glob` for paths. Values are literals, written as JSON writes them: `0.5`, not `.5`, `HALF` or `0.5_f64`.
///
/// ```
/// honami_plugin::params! {
///     /// How points are matched.
///     pub struct Matching {
///         /// Radius of the window; its side is 2r+1 pixels.
///         radius: i64 = 10 => { label: "Radius", unit: "px", min: 2, max: 50 },
///         /// Whether points die.
///         limited_life: bool = false => {},
///         /// How long a point lives.
///         life: f64 = 2.0 => { unit: "s", min: 0.1, max: 30, when: limited_life == true },
///     }
/// }
/// assert_eq!(Matching::default().radius, 10);
/// ```
///
/// What several plugins share is a struct of its own, taken in after the others by `..field: Struct`. The host sees one
/// flat list:
///
/// ```
/// # use honami_plugin::Params;
/// honami_plugin::params! {
///     /// Where points are looked for.
///     pub struct Looking {
///         /// The most points.
///         most: i64 = 100 => {},
///     }
/// }
/// honami_plugin::params! {
///     pub struct Settings {
///         /// Radius of the window.
///         radius: i64 = 10 => {},
///         ..looking: Looking,
///     }
/// }
/// assert_eq!(Settings::SCHEMA.iter().map(|p| p.id).collect::<Vec<_>>(), ["radius", "most"]);
/// assert_eq!(Settings::default().looking.most, 100);
/// ```
#[macro_export]
macro_rules! params {
    ($(#[doc = $struct_doc:expr])* $vis:vis struct $name:ident {
        $( $(#[doc = $doc:expr])* $id:ident : $ty:ty = $default:expr => { $($attributes:tt)* } ),* $(,)?
        $( .. $shared:ident : $shared_ty:ty , )*
    }) => {
        $(#[doc = $struct_doc])*
        #[derive(Clone, Debug, PartialEq)]
        $vis struct $name {
            $( $(#[doc = $doc])* pub $id: $ty, )*
            $( #[doc = concat!("See [`", stringify!($shared_ty), "`].")] pub $shared: $shared_ty, )*
        }

        impl ::core::default::Default for $name {
            fn default() -> Self {
                Self {
                    $( $id: <$ty as $crate::ParamType>::from_literal($default), )*
                    $( $shared: ::core::default::Default::default(), )*
                }
            }
        }

        impl $crate::Params for $name {
            const SCHEMA: &'static [$crate::Param] = {
                const PARTS: &[&[$crate::Param]] = &[
                    &[ $( $crate::Param {
                        id: stringify!($id),
                        kind: <$ty as $crate::ParamType>::KIND,
                        doc: &[$($doc),*],
                        default: stringify!($default),
                        attributes: $crate::__attributes!([] $($attributes)*),
                        entries: <$ty as $crate::ParamType>::ENTRIES,
                    }, )* ],
                    $( <$shared_ty as $crate::Params>::SCHEMA, )*
                ];
                &$crate::params::joined::<{ $crate::params::joined_len(PARTS) }>(PARTS)
            };

            fn set(&mut self, id: &str, value: $crate::Value<'_>) -> $crate::Result<()> {
                match id {
                    $( stringify!($id) => $crate::params::assign(&mut self.$id, id, value)?, )*
                    _ => { $( $crate::Params::set(&mut self.$shared, id, value)?; )* }
                }
                Ok(())
            }
        }
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __attributes {
    ([$($done:expr,)*]) => { &[$($done),*] };
    ([$($done:expr,)*] when : $other:ident == $value:literal $(, $($rest:tt)*)?) => {
        $crate::__attributes!(
            [$($done,)* ("when", concat!("{\"", stringify!($other), "\":", stringify!($value), "}")),]
            $($($rest)*)?
        )
    };
    ([$($done:expr,)*] $key:ident : $value:expr $(, $($rest:tt)*)?) => {
        $crate::__attributes!([$($done,)* (stringify!($key), stringify!($value)),] $($($rest)*)?)
    };
}

/// Declares the choices of a parameter: `Variant = "id" => "Label"`. Its default in [`params!`](crate::params!) is an id.
///
/// ```
/// honami_plugin::choice! {
///     /// How corners are scored.
///     pub enum Score {
///         /// The smaller eigenvalue of the structure tensor.
///         ShiTomasi = "shi-tomasi" => "Shi–Tomasi",
///         Harris = "harris" => "Harris",
///     }
/// }
/// honami_plugin::params! {
///     struct Detection {
///         score: Score = "harris" => { label: "Score" },
///     }
/// }
/// assert_eq!(Detection::default().score, Score::Harris);
/// ```
#[macro_export]
macro_rules! choice {
    ($(#[doc = $enum_doc:expr])* $vis:vis enum $name:ident { $(
        $(#[doc = $doc:expr])* $variant:ident = $id:literal => $label:literal
    ),* $(,)? }) => {
        $(#[doc = $enum_doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name { $(
            #[doc = $label]
            #[doc = ""]
            $(#[doc = $doc])*
            $variant,
        )* }

        impl $crate::ParamType for $name {
            const KIND: &'static str = "enum";
            const ENTRIES: &'static [$crate::Entry] =
                &[ $( $crate::Entry { id: $id, label: $label, doc: &[$($doc),*] }, )* ];
            type Literal = &'static str;
            fn from_literal(literal: &'static str) -> Self {
                match literal {
                    $( $id => Self::$variant, )*
                    // The manifest refuses to compile with a default that is no entry.
                    _ => unreachable!("{literal} is no choice"),
                }
            }
            fn from_value(value: $crate::Value<'_>) -> Option<Self> {
                match value {
                    $( $crate::Value::Text($id) => Some(Self::$variant), )*
                    _ => None,
                }
            }
        }
    };
}
