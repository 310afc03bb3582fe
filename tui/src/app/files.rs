//! Finding a project or a clip among the files of a folder.

use std::fs;
use std::path::{Path, PathBuf};

/// Names that end so are clips.
const CLIPS: [&str; 14] =
    ["avi", "gif", "m2ts", "m4v", "mkv", "mov", "mp4", "mpeg", "mpg", "mts", "mxf", "webm", "wmv", "y4m"];
/// Names that end so are pictures, of which a folder full is a clip.
const IMAGES: [&str; 6] = ["bmp", "jpeg", "jpg", "png", "tif", "tiff"];
/// So many of a folder are listed: the rest is found by typing its path.
const N_MAX: usize = 2000;

/// Where a row of the list, or what was typed, leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Lead {
    /// Into a folder.
    Folder(PathBuf),
    /// To a project or a clip.
    File(PathBuf),
    /// To whatever has this path.
    Typed(PathBuf),
}

/// What a lead has come to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A folder, to choose from.
    Folder(Listing),
    /// Something to open.
    File(PathBuf),
}

/// The projects, clips and folders of a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// The folder.
    pub folder: PathBuf,
    /// Names as shown, what each is, and where it leads.
    pub rows: Vec<(String, String, Lead)>,
}

/// Follows a lead.
///
/// # Errors
/// A line that says why it leads nowhere.
pub fn follow(lead: &Lead) -> Result<Found, String> {
    match lead {
        Lead::Folder(folder) => list(folder).map(Found::Folder),
        Lead::File(path) => Ok(Found::File(path.clone())),
        Lead::Typed(path) => {
            let path = match (path.strip_prefix("~"), std::env::var_os("HOME")) {
                (Ok(rest), Some(home)) => PathBuf::from(home).join(rest),
                _ => path.clone(),
            };
            let is_pattern = path.to_string_lossy().contains(['%', '*', '?']);
            match () {
                () if path.is_dir() => list(&path).map(Found::Folder),
                () if path.exists() || is_pattern => Ok(Found::File(path)),
                () => Err(format!("there is no file {}", path.display())),
            }
        }
    }
}

/// Lists a folder: projects first, then clips, then folders.
///
/// # Errors
/// A line that says why it cannot be read.
pub fn list(folder: &Path) -> Result<Listing, String> {
    let wrong = |error: std::io::Error| format!("{} cannot be listed: {error}", folder.display());
    let folder = folder.canonicalize().map_err(wrong)?;
    let (mut rows, mut n_images) = (Vec::new(), 0);
    for entry in fs::read_dir(&folder).map_err(wrong)?.flatten().take(N_MAX) {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if name.starts_with('.') {
            continue;
        }
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if path.is_dir() {
            rows.push((2, format!("{name}/"), "folder".to_owned(), Lead::Folder(path)));
        } else if ending == "honami" {
            rows.push((0, name, "project".to_owned(), Lead::File(path)));
        } else if CLIPS.contains(&ending.as_str()) {
            rows.push((1, name, "clip".to_owned(), Lead::File(path)));
        } else if IMAGES.contains(&ending.as_str()) {
            n_images += 1;
        }
    }
    if n_images > 1 {
        rows.push((
            1,
            "./".to_owned(),
            format!("its {n_images} pictures as a clip"),
            Lead::File(folder.clone()),
        ));
    }
    rows.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
    let mut rows: Vec<_> = rows.into_iter().map(|(_, name, what, lead)| (name, what, lead)).collect();
    if let Some(above) = folder.parent() {
        rows.push(("../".to_owned(), "the folder above".to_owned(), Lead::Folder(above.to_owned())));
    }
    Ok(Listing { folder, rows })
}

#[cfg(test)]
mod tests;
