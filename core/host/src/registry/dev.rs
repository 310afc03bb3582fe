//! Build trees of plugins' authors: where in them plugins come to lie.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Folders in which cargo, meson, cmake and make leave libraries.
const BUILT_IN: [&str; 5] = ["target/release", "target/debug", "build", "builddir", ""];

/// The folders of a build tree in which plugins may lie; the one that was built into last comes first, so that of two
/// builds of one plugin the newer counts.
pub(super) fn folders(tree: &Path) -> Vec<PathBuf> {
    let folders = BUILT_IN.iter().map(|name| tree.join(name)).filter(|folder| folder.is_dir());
    let mut folders: Vec<_> = folders.map(|folder| (newest(&folder), folder)).collect();
    folders.sort_by(|a, b| b.cmp(a));
    folders.into_iter().map(|(_, folder)| folder).collect()
}

/// When the newest library of a folder was written.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let libraries = entries.filter(|entry| entry.path().extension().is_some_and(|ending| ending == "so"));
    libraries.filter_map(|entry| entry.metadata().and_then(|meta| meta.modified()).ok()).max()
}

/// Whether a file lies in one of the trees.
pub(super) fn is_below(trees: &[PathBuf], file: &Path) -> bool {
    let Ok(file) = file.canonicalize() else { return false };
    trees.iter().filter_map(|tree| tree.canonicalize().ok()).any(|tree| file.starts_with(tree))
}
