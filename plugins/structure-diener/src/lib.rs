//! Skeletons after Diener (thesis 4.4) as a honami plugin; the algorithm is `honami_structure`.

#[cfg(test)]
mod tests;

use honami_growing::grow;
use honami_plugin::{Cx, Error, Filmed, Info, Result, Skeleton, Structure, export, params};
use honami_structure::diener;

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Stays in the plane of the picture. Else groups lie on the front of an ellipsoid about the plant, and all of it has
        /// a mirror image behind.
        flat: bool = false => { label: "Flat" },
    }
}

/// Forks where bones change their length least.
struct Diener;

impl Structure for Diener {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.diener",
        name: "Forks where bones change least",
        doc: "Groups are ellipses, forks the means of what they bear, shifted towards what bears them until bones change \
              their length least; then bones of constant length are moved so that tips are where their groups are. Depth \
              is that of an ellipsoid about the plant, and its mirror image.",
        cite: &["Diener 2009, 4.4"],
        ..Info::NEW
    };

    fn grow(settings: &Settings, filmed: &Filmed<'_>, cx: &Cx<'_>) -> Result<Skeleton> {
        if filmed.mask.is_some() {
            return Err(Error::unsupported(
                "it knows no envelope: leave it out, or take a method that fills one, such as zeng",
            ));
        }
        let settings = diener::Settings { root: filmed.root, is_flat: settings.flat };
        grow(filmed, cx, |seen| diener::grow(&seen.paths, &seen.groups, &seen.times, settings))
    }
}

export! {
    library: { id: "org.honami.diener", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [structure Diener]
}
