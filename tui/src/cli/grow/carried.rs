//! `grow --onto`: what the skeleton carries.

use std::path::PathBuf;

use honami_model::brief::Brief;
use honami_workbench::grow::{self, Blend, Bound, Carried, Growth, Onto, Out};
use serde_json::json;

use super::super::args::grow::{self as typed, Grow};
use super::super::{Answer, want};
use super::Files;
use super::siblings::numbered;

/// Whether what is asked of it can be.
pub(super) fn check(args: &Grow, files: &Files<'_>) -> anyhow::Result<()> {
    let is_number = |unit: f64| unit.is_finite() && unit > 0.0;
    want(args.unit.is_none_or(is_number), || "--unit takes metres of a pixel, more than 0".to_owned())?;
    want(args.turn.is_none_or(f64::is_finite), || "--turn takes degrees".to_owned())?;
    let has_carried = files.iter().any(|(kind, _)| !matches!(kind, Out::Skeleton(_)));
    let asked = [
        ("--unit", args.unit.is_some()),
        ("--onto", args.onto.is_some()),
        ("--weights", args.weights),
        ("--blend", args.blend.is_some()),
    ];
    let alone = asked.iter().find(|(_, is_typed)| *is_typed && !has_carried);
    want(alone.is_none(), || {
        format!(
            "{} goes with a .glb, as out.glb, or with frames, as out/%04d.ply",
            alone.map_or("", |it| it.0)
        )
    })?;
    let is_dual = args.blend == Some(typed::Blend::Dual);
    let has_rig = files.iter().any(|(kind, _)| matches!(kind, Out::Rig | Out::Usd));
    want(!(is_dual && has_rig), || {
        "who reads a .glb or .usda blends linearly: --blend dual goes with frames, as out/%04d.ply, or with a .pc2"
            .to_owned()
    })?;
    let has_cache = files.iter().any(|(kind, _)| *kind == Out::Cache);
    want(!(has_cache && (args.onto.is_none() || args.weights)), || {
        "a .pc2 has the vertices of an .obj or .ply, and no colours: name that by --onto, and no --weights"
            .to_owned()
    })?;
    Ok(())
}

/// Whether nothing that is written, in any frame and of any sibling, takes the place of the plant that is read.
pub(super) fn check_names(args: &Grow, files: &Files<'_>, n_frames: u32) -> anyhow::Result<()> {
    let Some(plant) = args.onto.as_ref().and_then(|plant| plant.canonicalize().ok()) else { return Ok(()) };
    let is_it = |out: &PathBuf| out.canonicalize().is_ok_and(|place| place == plant);
    let over = (0..=args.siblings.unwrap_or(0)).find_map(|number| {
        let named = |out: &PathBuf| if number == 0 { out.clone() } else { numbered(out, number) };
        let of_files = files.iter().flat_map(|(kind, out)| kind.names(&named(out), n_frames));
        of_files.chain(args.leaves.iter().map(named)).find(is_it)
    });
    want(over.is_none(), || {
        let over = over.unwrap_or_default();
        format!("what is written takes another name than the plant that is read: {}", over.display())
    })?;
    Ok(())
}

/// What is carried, bound to the skeleton.
pub(super) fn carried(args: &Grow, growth: &Growth) -> anyhow::Result<Carried> {
    let onto = args.onto.as_ref().map(|plant| Onto {
        plant: plant.clone(),
        up: args.up.map(Into::into),
        unit: args.unit,
        turn_rad: args.turn.unwrap_or(0.0).to_radians(),
    });
    let bound = onto.map(|onto| Bound::onto(&growth.skeleton, &onto)).transpose()?;
    let blend = args.blend.map_or(Blend::Linear, Into::into);
    Ok(Carried { bound, unit: args.unit.unwrap_or(grow::UNIT), blend, are_weights_shown: args.weights })
}

/// Tells of a plant of others.
pub(super) fn describe(args: &Grow, carried: &Carried, answer: &mut Answer) {
    let (Some(bound), Some(plant)) = (&carried.bound, &args.onto) else { return };
    let [n_vertices, n_triangles] = bound.sizes();
    let unit = bound.unit();
    let [height, width] = bound.extent();
    answer.text += &format!(
        "\n{}: {n_vertices} vertices, {n_triangles} triangles, {} high and {} wide, a pixel being {} of its lengths",
        plant.display(),
        Brief(rounded(height)),
        Brief(rounded(width)),
        Brief(rounded(unit))
    );
    let notes: Vec<String> = bound.notes.iter().cloned().chain(bound.lying()).collect();
    notes.iter().for_each(|note| answer.text += &format!("\nnote: {}: {note}", plant.display()));
    answer.json["onto"] = json!({
        "plant": plant,
        "vertices": n_vertices,
        "triangles": n_triangles,
        "height": height,
        "width": width,
        "unit": unit,
        "notes": notes,
    });
}

/// To four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::super::files;
    use super::*;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        grow: Grow,
    }

    #[test]
    fn no_name_is_that_of_the_plant() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["oak-1.glb", "0039.ply", "0003-2.ply", "l-1.csv"] {
            std::fs::write(folder.path().join(name), name).unwrap();
        }
        std::fs::create_dir(folder.path().join("same")).unwrap();
        for (plant, line, is_over) in [
            ("oak-1.glb", "oak-1.glb", true),
            ("oak-1.glb", "same/../oak-1.glb", true),
            ("oak-1.glb", "oak.glb", false),
            ("oak-1.glb", "oak.glb --siblings 1", true),
            ("oak-1.glb", "rig.glb oak.bvh --siblings 3", false),
            ("0039.ply", "%04d.ply", true),
            ("0039.ply", "%05d.ply", false),
            ("0003-2.ply", "%04d.ply --siblings 1", false),
            ("0003-2.ply", "%04d.ply --siblings 2", true),
            ("l-1.csv", "a.glb --leaves l.csv", false),
            ("l-1.csv", "a.glb --leaves l.csv --siblings 1", true),
            ("none.glb", "none.glb", false),
        ] {
            let at = |word: &str| match word.contains('.') {
                true => folder.path().join(word).display().to_string(),
                false => word.to_owned(),
            };
            let words = format!("grow p.honami --onto {plant} {line}");
            let args = Line::parse_from(words.split(' ').map(at)).grow;
            let found = check_names(&args, &files(&args).unwrap(), 40).map_err(|error| error.to_string());
            assert_eq!(found.is_err(), is_over, "{words}");
            assert!(found.err().is_none_or(|error| error.ends_with(plant)), "{words}");
        }
    }
}
