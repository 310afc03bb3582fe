//! Copies of a benchmark: all of each, or as much of each as an eye makes out from where it stands.

use honami_mechanics::{Detail, DetailError, Details, Stand, Stirring, Vector, View};

/// Metres between copies of a plant of height 1.
const APART: f64 = 0.8;
/// How high an eye is above the ground, metres; and between the upper and the lower edge of what it sees, radians.
const EYE: f64 = 1.7;
const ANGLE: f64 = 0.8;
/// From how many heights of the plant on: the share of its nodes that is moved, and of its modes.
const LEVELS: [(f64, f64, f64); 3] = [(3.0, 0.3, 1.0), (8.0, 0.1, 0.6), (20.0, 0.03, 0.2)];

/// Copies, each turned.
pub(super) struct Crowd {
    pub(super) stands: Vec<Stand>,
    seen: Option<Seen>,
}

/// Who sees them, and where they stand.
struct Seen {
    view: View,
    details: Details,
    places: Vec<Vector>,
}

impl Crowd {
    /// All of so many copies.
    pub(super) fn whole(n_copies: usize) -> Self {
        let stand = |k: usize| Stand { turn: k as f32, ..Stand::default() };
        Self { stands: (0..n_copies).map(stand).collect(), seen: None }
    }

    /// Copies in a square, as an eye in the middle of one side sees them that looks over all of it. The nearest come first:
    /// those of one detail are worked out together.
    pub(super) fn seen(plant: &Stirring, n_copies: usize) -> Result<Self, DetailError> {
        let (side, apart) = ((n_copies as f64).sqrt().ceil(), APART * plant.height());
        let eye = Vector::new((side - 1.0) / 2.0 * apart, -apart, EYE);
        let place = |k: usize| {
            let row = (k as f64 / side).floor();
            Vector::new((k as f64 - row * side) * apart, row * apart, 0.0)
        };
        let mut places: Vec<Vector> = (0..n_copies).map(place).collect();
        places.sort_by(|a, b| (a - eye).norm().total_cmp(&(b - eye).norm()));
        let share = |n: usize, share: f64| (n as f64 * share).ceil() as u32;
        let level = |&(from, nodes, modes): &(f64, f64, f64)| {
            let detail =
                Detail { n_nodes: share(plant.n_nodes(), nodes), n_modes: share(plant.n_modes(), modes) };
            (from * plant.height(), detail)
        };
        let levels: Vec<(f64, Detail)> = LEVELS.iter().map(level).collect();
        let far = 2.0 * side * apart;
        let view = View { eye, towards: Vector::y(), angle: ANGLE, aspect: 16.0 / 9.0, far };
        let seen = Some(Seen { view, details: Details::new(&levels)?, places });
        Ok(Self { seen, ..Self::whole(n_copies) })
    }

    /// How much of every copy is moved; `None`: all of it.
    pub(super) fn details(&self, plant: &Stirring) -> Option<Vec<Detail>> {
        let Seen { view, details, places } = self.seen.as_ref()?;
        let most = Detail { n_nodes: plant.n_nodes() as u32, n_modes: plant.n_modes() as u32 };
        let of = |place: &Vector| details.of(plant, view, place, 1.0).at_most(most);
        Some(places.iter().map(of).collect())
    }
}
