//! Which of a camera's numbers are held rather than looked for.

use std::str::FromStr;

use honami_cameras::{Focal, Model};

/// Numbers of a camera that are not looked for: few views, or a board that never comes near the edges, do not tell them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// k3 is 0: what most lenses need no more than.
    K3,
    /// p1 and p2 are 0: the lens stands straight.
    Tangential,
    /// No distortion at all.
    Distortion,
    /// The axis goes through the middle of the picture.
    Centre,
    /// Pixels are square: fx is fy.
    Square,
}

impl Held {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::K3, Self::Tangential, Self::Distortion, Self::Centre, Self::Square];

    /// How it is written.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::K3 => "k3",
            Self::Tangential => "tangential",
            Self::Distortion => "distortion",
            Self::Centre => "centre",
            Self::Square => "square",
        }
    }

    /// What is looked for where all of these are held.
    #[must_use]
    pub fn model(held: &[Self]) -> Model {
        let is = |one: Self| held.contains(&one);
        let radial = match (is(Self::Distortion), is(Self::K3)) {
            (true, _) => 0,
            (false, true) => 2,
            (false, false) => 3,
        };
        Model {
            focal: if is(Self::Square) { Focal::Square } else { Focal::Free },
            centre: !is(Self::Centre),
            radial,
            tangential: !is(Self::Tangential) && !is(Self::Distortion),
        }
    }
}

impl FromStr for Held {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let names = Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|held| held.name() == text);
        found.ok_or_else(|| format!("wanted {names}, got {text}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_is_not_looked_for() {
        assert_eq!(Held::model(&[]), Model::WHOLE);
        assert_eq!(Held::model(&[Held::K3]), Model { radial: 2, ..Model::WHOLE });
        assert_eq!(Held::model(&[Held::Tangential]), Model { tangential: false, ..Model::WHOLE });
        assert_eq!(Held::model(&[Held::Square, Held::Centre, Held::Distortion, Held::K3]), Model::FOCAL);
        assert_eq!("k3".parse(), Ok(Held::K3));
        assert_eq!(
            "k2".parse::<Held>(),
            Err("wanted k3, tangential, distortion, centre, square, got k2".to_owned())
        );
    }
}
