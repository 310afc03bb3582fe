//! What plants are made of.

use honami_model::brief::Brief;

/// The wood of a plant, and how it loses energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus, pascals.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Kilograms per cubic metre.
    pub density: f64,
}

impl Default for Material {
    /// That of the thesis (6.2.1): 10 GPa, 1000 kg/m^3.
    fn default() -> Self {
        Self { young: 1e10, poisson: 0.3, density: 1e3 }
    }
}

/// A number of a material that no wood has.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a material has a {name} of {wanted}, not of {}", Brief(*came))]
pub struct MaterialError {
    name: &'static str,
    wanted: &'static str,
    came: f64,
}

impl Material {
    /// Shear modulus, G = E / (2 (1 + nu)) (errata E39: the text has 2.6 E), pascals.
    #[must_use]
    pub fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// Refuses what is no material.
    ///
    /// # Errors
    /// [`MaterialError`] for the first number that cannot be.
    pub fn check(&self) -> Result<(), MaterialError> {
        let wrong = |name, wanted, came| Err(MaterialError { name, wanted, came });
        if !(self.young.is_finite() && self.young > 0.0) {
            return wrong("Young's modulus", "more than 0 Pa", self.young);
        }
        if !(self.density.is_finite() && self.density > 0.0) {
            return wrong("density", "more than 0 kg/m3", self.density);
        }
        // Beyond these bounds the material would give energy away.
        if !(self.poisson > -1.0 && self.poisson <= 0.5) {
            return wrong("Poisson's ratio", "-1 to 0.5", self.poisson);
        }
        Ok(())
    }
}
