//! A forest: one plant, how it moves, and where its copies stand in which wind.

pub mod live;

use honami_mechanics::{Pace, Stand, Stirring, Vector};
use serde::{Deserialize, Serialize};

use crate::body::Body;
use crate::camera::Orbit;
use crate::grove::Grove;
use crate::weather::Ground;

/// Copies of a plant in the wind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForestScene {
    /// What the plant was read from, for titles.
    pub name: String,
    /// How it moves: by turns of its segments.
    pub stirring: Stirring,
    /// What it looks like.
    pub body: Body,
    /// Where copies stand, metres,
    pub places: Vec<[f32; 2]>,
    /// and how: one a place.
    pub stands: Vec<Stand>,
    /// What a plant weighs, kilograms: winds that flow are held back by it.
    pub kilograms: f64,
    /// How it goes on.
    pub pace: Pace,
    /// The wind, as it is typed.
    pub wind: String,
    /// Seconds that the wind blew before what is shown begins.
    pub run_in: f64,
    /// From where it is seen at first.
    pub orbit: Orbit,
}

impl ForestScene {
    /// Where copies stand.
    #[must_use]
    pub fn grove(&self) -> Grove {
        let place = |[x, y]: &[f32; 2]| Vector::new(f64::from(*x), f64::from(*y), 0.0);
        let (places, stands) = (self.places.iter().map(place).collect(), self.stands.clone());
        Grove { places, stands, height: self.stirring.height() }
    }

    /// What wind blows over, for so many seconds from 0 on; air that flows may take so many bytes.
    #[must_use]
    pub fn ground(&self, seconds: f64, most_bytes: usize) -> Ground {
        let heavy = self.kilograms * self.pace.damping.mass;
        let tree = |([x, y], stand): (&[f32; 2], &Stand)| {
            ([f64::from(*x), f64::from(*y)], heavy * f64::from(stand.scale.powi(3) * stand.mass))
        };
        Ground::new(self.places.iter().zip(&self.stands).map(tree).collect(), seconds, most_bytes)
    }

    /// What of it cannot be drawn.
    pub(crate) fn odd(&self) -> Option<String> {
        let (body, n_nodes) = (&self.body, self.stirring.n_nodes());
        let is_order = {
            let mut rows: Vec<u32> = body.order.clone();
            rows.sort_unstable();
            // What bears a node comes before it, the root first.
            rows.into_iter().eq(0..n_nodes as u32) && body.order.first() == Some(&0)
        };
        if self.places.is_empty() || self.places.len() != self.stands.len() {
            return Some(format!("{} places and {} copies", self.places.len(), self.stands.len()));
        }
        let is_number = self.places.as_flattened().iter().all(|v| v.is_finite())
            && self
                .stands
                .iter()
                .all(|stand| [stand.turn, stand.scale, stand.mass].into_iter().all(f32::is_finite));
        if !is_number {
            return Some("copies stand at what is no number".to_owned());
        }
        let (step, run_in) = (self.pace.step, self.run_in);
        if !(1e-6..=1.0).contains(&step) || !(0.0..=3600.0).contains(&run_in) {
            return Some(format!("{run_in} s of wind before it is seen, in steps of {step} s"));
        }
        if !is_order || body.levels.is_empty() {
            return Some(format!(
                "{} levels, and an order of {} of {n_nodes} nodes",
                body.levels.len(),
                body.order.len()
            ));
        }
        let wrong = body.levels.iter().position(|level| !level.is_drawn(n_nodes, self.stirring.n_modes()));
        wrong.map(|level| format!("level {level} names what it has not"))
    }
}
