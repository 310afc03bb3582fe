//! Many clips: which they are, and the recipe followed with all of them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::super::args::Common;
use super::super::args::recipe::Run;
use super::super::{Answer, options, want};
use super::plan::Clip;
use super::told::{Shown, planned, summary};
use super::{Recipe, crew};

/// The clips that were named, in their order, with their folders.
pub(in crate::cli) fn clips(named: &[String], into: &Path) -> anyhow::Result<Vec<Clip>> {
    let mut seen: BTreeMap<String, PathBuf> = BTreeMap::new();
    let mut clips = Vec::with_capacity(named.len());
    for word in named {
        // A path that is there is one, also where it has a `=`.
        let (name, path) = match word.split_once('=') {
            Some((name, path)) if !Path::new(word).exists() => (name.to_owned(), PathBuf::from(path)),
            _ => (name_of(Path::new(word)), PathBuf::from(word)),
        };
        let is_name = !name.is_empty()
            && !name.starts_with('.')
            && !name.contains(|c: char| "/{}".contains(c) || c.is_control());
        want(is_name, || {
            format!("{word:?}: wanted NAME=CLIP, with a name that a folder can have, without {{ and }}")
        })?;
        if let Some(other) = seen.insert(name.clone(), path.clone()) {
            let (one, two) = (other.display(), path.display());
            want(false, || {
                format!("{one} and {two} would both be called {name}: say NAME=CLIP of one of them")
            })?;
        }
        let folder = into.join(&name);
        clips.push(Clip { name, path, folder });
    }
    Ok(clips)
}

/// What a clip's file or folder is called, without its ending; of a pattern without what stands for the number.
fn name_of(path: &Path) -> String {
    let stem = if path.is_dir() { path.file_name() } else { path.file_stem() };
    let name = stem.unwrap_or_default().to_string_lossy().into_owned();
    let name = name.split('%').next().unwrap_or_default().trim_end_matches(['_', '-']).to_owned();
    // `frame_%04d.png` in folders of their own are told apart by these.
    let folder = path.parent().and_then(Path::file_name);
    if path.to_string_lossy().contains('%')
        && let Some(folder) = folder
    {
        return folder.to_string_lossy().into_owned();
    }
    name
}

/// Follows a recipe with all clips.
pub(in crate::cli) fn run(args: &Run, common: &Common) -> anyhow::Result<Answer> {
    let recipe = Recipe::read(&args.recipe)?;
    let clips = clips(&args.clips, &args.into)?;
    let registry = options(common).registry();
    // What no clip could do is said once, before the first.
    recipe.find_plugins(&registry)?;
    if args.dry_run {
        return Ok(planned(&recipe, &clips, &registry));
    }
    let since = Instant::now();
    let shown = Shown::new(&recipe, clips.len(), usize::from(args.jobs).min(clips.len()));
    let fates = crew::all((args, common), &recipe, &clips, &registry, &shown)?;
    drop(shown);
    Ok(summary(&recipe, &clips, &fates, since.elapsed().as_secs_f64()))
}
