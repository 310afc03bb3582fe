//! Skeletons after Zeng (2015, 5.4.2 and 5.5) as a honami plugin; the algorithm is `honami_structure`.

#[cfg(test)]
mod tests;

use honami_growing::grow;
use honami_plugin::{Cx, Filmed, Gray, Info, Result, Skeleton, Structure, export, params};
use honami_structure::zeng::{self, Alpha};

params! {
    /// What the user may choose.
    pub(crate) struct Settings {
        /// Stays in the plane of the picture: one copy, not pushed.
        flat: bool = false => { label: "Flat" },
        /// How far joints are shifted from the centroids of their clusters towards what bears them.
        shift: f64 = 0.5 => { label: "Shift", min: 0, max: 0.999 },
        /// Copies that stand round the trunk, the one in the picture counted.
        copies: i64 = 3 => { label: "Copies", min: 1, max: 64, soft_max: 5, when: flat == false },
    }
}

/// Copies round the trunk that fill an envelope.
struct Zeng;

impl Structure for Zeng {
    type Params = Settings;
    const INFO: Info = Info {
        id: "org.honami.zeng",
        name: "Copies that fill an envelope",
        doc: "Joints are centroids of clusters, shifted towards what bears them; copies of that stand in planes through the \
              trunk, and their branches are pushed until they fill the hull of the tracks, or what is white in an image: \
              branches outside of that are cut.",
        cite: &["Zeng 2015, 5.4.2, 5.5, 6.4"],
        ..Info::NEW
    };

    fn grow(settings: &Settings, filmed: &Filmed<'_>, cx: &Cx<'_>) -> Result<Skeleton> {
        let settings = zeng::Settings {
            root: filmed.root,
            is_flat: settings.flat,
            shift: settings.shift,
            copies: u32::try_from(settings.copies)?,
            envelope: filmed.mask.map(|mask| alpha(&mask)),
        };
        grow(filmed, cx, |seen| zeng::grow(&seen.paths, &seen.groups, &seen.times, &settings))
    }
}

/// White where branches may be.
fn alpha(mask: &Gray<'_>) -> Alpha {
    let white = |pixel: &u8| if *pixel > 0 { u8::MAX } else { 0 };
    let pixels = (0..mask.height).flat_map(|y| mask.row(y)).map(white).collect();
    Alpha { width: mask.width as usize, pixels }
}

export! {
    library: { id: "org.honami.zeng", version: env!("CARGO_PKG_VERSION"), license: "MIT OR Apache-2.0" },
    plugins: [structure Zeng]
}
