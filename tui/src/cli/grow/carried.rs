//! `grow --onto`: what the skeleton carries.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use honami_model::brief::{Brief, counted};
use honami_workbench::WorkbenchError;
use honami_workbench::grow::{
    self, Assembled, Begin, Blend, Bound, Carried, Fewer, Growth, Library, Onto, Out,
};
use serde_json::json;

use super::super::args::grow::{self as typed, Grow};
use super::super::{Answer, want};
use super::Files;
use super::siblings::{SEED, numbered};

/// Whether what is asked of it can be.
pub(super) fn check(args: &Grow, files: &Files<'_>) -> anyhow::Result<()> {
    let is_number = |unit: f64| unit.is_finite() && unit > 0.0;
    want(args.unit.is_none_or(is_number), || "--unit takes metres of a pixel, more than 0".to_owned())?;
    want(args.turn.is_none_or(f64::is_finite), || "--turn takes degrees".to_owned())?;
    let has_branches = !args.branches.is_empty();
    for (option, is_typed, others, has_other) in [
        ("--turn", args.turn.is_some(), "--onto", args.onto.is_some()),
        ("--up", args.up.is_some(), "--onto or --branches", args.onto.is_some() || has_branches),
        ("--seed", args.seed.is_some(), "--siblings or --branches", args.siblings.is_some() || has_branches),
    ] {
        want(!is_typed || has_other, || format!("{option} goes with {others}"))?;
    }
    let has_carried = files.iter().any(|(kind, _)| !matches!(kind, Out::Skeleton(_)));
    let asked = [
        ("--unit", args.unit.is_some()),
        ("--onto", args.onto.is_some()),
        ("--branches", has_branches),
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
    want(args.joints.is_none() || has_rig, || {
        "--joints goes with a .glb or .usda, whose joints engines count".to_owned()
    })?;
    let has_cache = files.iter().any(|(kind, _)| *kind == Out::Cache);
    want(!(has_cache && (args.onto.is_none() || args.weights)), || {
        "a .pc2 has the vertices of an .obj or .ply, and no colours: name that by --onto, and no --weights"
            .to_owned()
    })?;
    Ok(())
}

/// Whether nothing that is written, in any frame and of any sibling, takes the place of the plant that is read, or of another.
pub(super) fn check_names(args: &Grow, files: &Files<'_>, n_frames: u32) -> anyhow::Result<()> {
    check_twice(args, files)?;
    let plants: Vec<PathBuf> =
        args.onto.iter().chain(&args.branches).filter_map(|plant| plant.canonicalize().ok()).collect();
    let is_it =
        |out: &PathBuf| !plants.is_empty() && out.canonicalize().is_ok_and(|place| plants.contains(&place));
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

/// Whether no two files that are written have one name. Numbers of frames stand in place of a name's, so that two names of
/// frames are one or have nothing in common.
fn check_twice(args: &Grow, files: &Files<'_>) -> anyhow::Result<()> {
    let outs: Vec<&PathBuf> = files.iter().map(|(_, out)| *out).chain(&args.leaves).collect();
    let mut seen: HashMap<PathBuf, &PathBuf> = HashMap::new();
    for out in outs {
        // A folder that there is not is made, or refused, by the name that it has.
        let folder = out.parent().and_then(|folder| {
            if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.canonicalize().ok()
        });
        let place =
            folder.zip(out.file_name()).map_or_else(|| out.clone(), |(folder, name)| folder.join(name));
        for number in 0..=args.siblings.unwrap_or(0) {
            let place = if number == 0 { place.clone() } else { numbered(&place, number) };
            if let Some(other) = seen.insert(place.clone(), out) {
                let (name, place) = (out.display(), place.display());
                want(false, || {
                    format!(
                        "{} and {name} would both be written to {place}: give one another name",
                        other.display()
                    )
                })?;
            }
        }
    }
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
    let mut bound = onto.map(|onto| Bound::onto(&growth.skeleton, &onto)).transpose()?;
    let (unit, seed) = (args.unit.unwrap_or(grow::UNIT), args.seed.unwrap_or(SEED));
    let is_library = !args.branches.is_empty();
    let library = is_library.then(|| Library::read(&args.branches, args.up.map(Into::into))).transpose()?;
    if let Some(library) = &library {
        bound = Some(Bound::assembled(&growth.skeleton, library, unit, seed, 0)?);
    }
    let blend = args.blend.map_or(Blend::Linear, Into::into);
    let library = library.map(|library| (library, seed));
    let fewer = args.joints.map(|most| Fewer::of(&growth.skeleton, most as usize));
    let fewer = fewer.transpose().map_err(WorkbenchError::from)?;
    let (again_s, are_weights_shown) = (growth.again_s, args.weights);
    Ok(Carried { bound, library, unit, blend, fewer, again_s, are_weights_shown })
}

/// Tells of a plant of others.
pub(super) fn describe(args: &Grow, carried: &Carried, answer: &mut Answer) {
    if let Some(fewer) = &carried.fewer {
        let (n_joints, n_left_out) = (fewer.n_joints(), fewer.n_left_out());
        answer.text += &format!("\njoints of rigs: {n_joints}, bones left out: {n_left_out}");
        answer.json["rig"] = json!({ "joints": n_joints, "left_out": n_left_out });
    }
    let Some(bound) = &carried.bound else { return };
    if let (Some(assembled), Some((library, seed))) = (&bound.assembled, &carried.library) {
        tell(assembled, library, *seed, bound, answer);
    }
    let Some(plant) = &args.onto else { return };
    let [n_vertices, n_triangles] = bound.sizes();
    let unit = bound.unit();
    let [height, width] = bound.extent();
    answer.text += &format!(
        "\n{}: {}, {}, {} high and {} wide, a pixel being {} of its lengths",
        plant.display(),
        counted(n_vertices, "vertex"),
        counted(n_triangles, "triangle"),
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

/// Tells of a plant that was put together.
fn tell(assembled: &Assembled, library: &Library, seed: u64, bound: &Bound, answer: &mut Answer) {
    let Assembled { n_branches, n_used, n_grafts, scales, n_bare } = assembled;
    let [n_vertices, n_triangles] = bound.sizes();
    let [least, most] = scales.map(|scale| Brief(rounded(scale)));
    answer.text += &format!(
        "\nbranches: on {}, {n_used} of the library's {n_branches}, {least} to {most} times as large, seed {seed}; {}, {}",
        counted(*n_grafts, "bone"),
        counted(n_vertices, "vertex"),
        counted(n_triangles, "triangle")
    );
    let [pivot, lowest, fork] = [Begin::Pivot, Begin::Lowest, Begin::Fork].map(|begin| library.n_that(begin));
    let begun = [(pivot, "at pivots"), (lowest, "where lowest"), (fork, "at forks")];
    let begun = begun.iter().filter(|(n, _)| *n > 0).map(|(n, place)| format!("{n} {place}"));
    answer.text += &format!("\nthe library's begin: {}", begun.collect::<Vec<_>>().join(", "));
    let of_file = |(path, note): &(PathBuf, String)| format!("{}: {note}", path.display());
    let mut notes: Vec<String> = library.notes.iter().map(of_file).collect();
    if *n_bare > 0 {
        notes.push(format!("groups in the middle of forks bear no branch: {n_bare}"));
    }
    notes.iter().for_each(|note| answer.text += &format!("\nnote: {note}"));
    answer.json["branches"] = json!({
        "library": n_branches,
        "used": n_used,
        "begin": { "pivot": pivot, "lowest": lowest, "fork": fork },
        "bones": n_grafts,
        "scales": scales,
        "seed": seed,
        "vertices": n_vertices,
        "triangles": n_triangles,
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
    fn help_names_all_that_is_written() {
        let help = <Line as clap::CommandFactory>::command().render_long_help().to_string();
        let known: Vec<&str> = grow::ENDINGS.split([' ', ',']).filter(|word| word.contains('.')).collect();
        assert!(known.len() == 8 && known.iter().all(|ending| help.contains(ending)), "{help}");
    }

    #[test]
    fn no_name_is_written_twice() {
        for (line, wanted) in [
            ("oak.glb oak-1.glb --siblings 1", Some("oak.glb and oak-1.glb would both be written to ")),
            ("oak.glb oak-2.glb --siblings 1", None),
            ("oak.glb oak.glb", Some("oak.glb and oak.glb would both")),
            ("oak.glb ./oak.glb", Some("oak.glb and ./oak.glb would both")),
            ("oak.glb oak.usda oak.csv --siblings 3", None),
            ("a.csv --leaves a.csv", Some("a.csv and a.csv would both")),
            ("a.csv --leaves a-3.csv --siblings 2", None),
            ("a.csv --leaves a-2.csv --siblings 2", Some("a.csv and a-2.csv would both")),
            ("none/%04d.ply none/%04d.ply", Some("would both be written to none/%04d.ply")),
            ("%04d.ply %04d.obj --siblings 2", None),
        ] {
            let args = Line::parse_from(format!("grow p.honami {line}").split(' ')).grow;
            let found = check_names(&args, &files(&args).unwrap(), 40).map_err(|error| error.to_string());
            assert_eq!(found.is_err(), wanted.is_some(), "{line}: {found:?}");
            assert!(found.err().is_none_or(|error| error.contains(wanted.unwrap_or(""))), "{line}");
        }
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
            ("0039.ply", "%04d.ply --branches oak-1.glb", true),
        ] {
            let at = |word: &str| match word.contains('.') {
                true => folder.path().join(word).display().to_string(),
                false => word.to_owned(),
            };
            let option = if line.contains("--branches") { "--branches" } else { "--onto" };
            let words = format!("grow p.honami {option} {plant} {line}");
            let args = Line::parse_from(words.split(' ').map(at)).grow;
            let found = check_names(&args, &files(&args).unwrap(), 40).map_err(|error| error.to_string());
            assert_eq!(found.is_err(), is_over, "{words}");
            assert!(found.err().is_none_or(|error| error.ends_with(plant)), "{words}");
        }
    }
}
