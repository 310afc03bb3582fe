//! Whether a plant is of a size and a thickness that plants are of: else its unit is likely another.

#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;

use honami_mechanics::Material;
use honami_model::brief::Brief;
use honami_model::plant::Plant;

/// Metres: from mosses to the tallest trees.
const HEIGHTS: RangeInclusive<f64> = 0.01..=150.0;
/// A radius is at most so much of the height.
const THICKEST: f64 = 0.25;
/// Gravity, metres per second squared.
const GRAVITY: f64 = 9.81;

/// What a file without units was taken as, and what it makes the plant; and of options that say it, those that were not
/// typed.
pub(super) fn as_taken(plant: &Plant, taken: &str, options: &[(&str, bool)]) -> String {
    let (height, radius) = (plant.height(), thickest(plant));
    let open: Vec<&str> =
        options.iter().filter(|(_, is_typed)| !is_typed).map(|(option, _)| *option).collect();
    let otherwise = match open[..] {
        [] => String::new(),
        [one] => format!("; {one} says otherwise"),
        _ => format!("; {} say otherwise", open.join(" and ")),
    };
    format!(
        "the file names no units: {taken}, which makes it {} m high and {} m thick at most{otherwise}",
        rounded(height),
        rounded(2.0 * radius)
    )
}

/// What no plant is like, a sentence with a hint; `None` where all may be as it should be.
pub(super) fn odd(plant: &Plant, material: &Material, hint: &str) -> Option<String> {
    let (height, radius) = (plant.height(), thickest(plant));
    let why = if !HEIGHTS.contains(&height) {
        format!("plants are {} to {} m high", HEIGHTS.start(), HEIGHTS.end())
    } else if radius > THICKEST * height {
        "plants are higher than twice their thickness".to_owned()
    } else if height > stands(radius, material) {
        format!("a stem so thick stands up to {} m", rounded(stands(radius, material)))
    } else {
        return None;
    };
    Some(format!(
        "{} m high and {} m thick at most is odd: {why}; {hint}",
        rounded(height),
        rounded(2.0 * radius)
    ))
}

fn thickest(plant: &Plant) -> f64 {
    plant.nodes().iter().map(|node| node.radius).fold(0.0, f64::max)
}

/// The height at which a cylinder of this radius buckles under its own weight: (7.8373 E I / (rho g A))^(1/3) (Greenhill,
/// Proc. Camb. Phil. Soc. 4, 1881), in which I / A = r^2 / 4. Trees are a quarter of it (McMahon, Science 179, 1973).
fn stands(radius: f64, material: &Material) -> f64 {
    (7.8373 * material.young * radius.powi(2) / (4.0 * material.density * GRAVITY)).cbrt()
}

/// To three digits.
fn rounded(value: f64) -> Brief {
    Brief(format!("{value:.2e}").parse().unwrap_or(value))
}
