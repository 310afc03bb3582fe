//! Which files make up a sequence, and in which order.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::MediaError;

const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp"];

/// Whether a path that does not exist is a printf pattern or a glob.
pub(super) fn is_pattern(path: &Path) -> bool {
    let name = file_name(path);
    !path.exists() && (name.contains(['*', '?']) || printf(&name).is_some())
}

/// The images that `path` (folder, pattern or one image) means, in natural order, and notes on what was left out.
pub(super) fn list(path: &Path) -> Result<(Vec<PathBuf>, Vec<String>), MediaError> {
    if path.is_file() {
        return Ok((vec![path.to_path_buf()], Vec::new()));
    }
    if path.is_dir() {
        return series(path, images_in(path, |_| true)?);
    }
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(MediaError::Missing { path: path.to_path_buf() });
    }
    let pattern = file_name(path);
    let files = match printf(&pattern) {
        Some(numbered) => images_in(folder, |name| numbered.matches(name))?,
        None => images_in(folder, |name| glob(&pattern, name))?,
    };
    match files.is_empty() {
        true => Err(MediaError::NoImages { path: path.to_path_buf() }),
        false => Ok((files, Vec::new())),
    }
}

fn images_in(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>, MediaError> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| MediaError::io("list", folder, e))? {
        let path = entry.map_err(|e| MediaError::io("list", folder, e))?.path();
        let name = file_name(&path);
        if is_image(&path) && !name.starts_with('.') && wanted(&name) && path.is_file() {
            files.push(path);
        }
    }
    files.sort_by(|a, b| natural(&file_name(a), &file_name(b)));
    Ok(files)
}

pub(super) fn is_image(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    EXTENSIONS.contains(&extension.as_str())
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Of a folder, the longest run of names that differ in their last number only; without one, everything.
fn series(folder: &Path, files: Vec<PathBuf>) -> Result<(Vec<PathBuf>, Vec<String>), MediaError> {
    if files.is_empty() {
        return Err(MediaError::NoImages { path: folder.to_path_buf() });
    }
    let mut by_pattern: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    for file in &files {
        by_pattern.entry(numberless(&file_name(file)).to_lowercase()).or_default().push(file.clone());
    }
    let longest = by_pattern.values().map(Vec::len).max().unwrap_or(0);
    if longest == 1 {
        return Ok((files, Vec::new()));
    }
    let pattern_of = |run: &Vec<PathBuf>| numberless(&file_name(&run[0]));
    let mut longest_ones: Vec<_> = by_pattern.into_values().filter(|run| run.len() == longest).collect();
    if longest_ones.len() > 1 {
        let series = longest_ones.iter().map(pattern_of).collect();
        return Err(MediaError::Ambiguous { path: folder.to_path_buf(), series });
    }
    let chosen = longest_ones.remove(0);
    let pattern = pattern_of(&chosen);
    let left_out: Vec<String> = files.iter().filter(|f| !chosen.contains(f)).map(|f| file_name(f)).collect();
    let note = match left_out.as_slice() {
        [] => None,
        [one] => Some(format!("the sequence is {pattern}; 1 other image is left out: {one}")),
        [one, ..] => Some(format!(
            "the sequence is {pattern}; {} other images are left out, {one} among them",
            left_out.len()
        )),
    };
    Ok((chosen, note.into_iter().collect()))
}

/// The name as a glob: its last run of digits before the extension becomes `*`.
fn numberless(name: &str) -> String {
    let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
    let Some(end) = stem.rfind(|c: char| c.is_ascii_digit()) else { return name.to_owned() };
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + stem[at..].chars().next().map_or(1, char::len_utf8));
    format!("{}*{}.{extension}", &stem[..start], &stem[end + 1..])
}

/// Names with numbers by their value: `img2` before `img10`; then by bytes.
pub(super) fn natural(a: &str, b: &str) -> Ordering {
    let (mut x, mut y) = (a.as_bytes(), b.as_bytes());
    while let (Some(p), Some(q)) = (x.first(), y.first()) {
        if p.is_ascii_digit() && q.is_ascii_digit() {
            let (m, n) = (number(&mut x), number(&mut y));
            let by_value = m.len().cmp(&n.len()).then_with(|| m.cmp(n));
            if by_value != Ordering::Equal {
                return by_value;
            }
        } else {
            let by_letter = p.to_ascii_lowercase().cmp(&q.to_ascii_lowercase());
            if by_letter != Ordering::Equal {
                return by_letter;
            }
            (x, y) = (&x[1..], &y[1..]);
        }
    }
    x.len().cmp(&y.len()).then_with(|| a.cmp(b))
}

/// Takes the digits at the front, without leading zeros.
fn number<'a>(text: &mut &'a [u8]) -> &'a [u8] {
    let end = text.iter().position(|c| !c.is_ascii_digit()).unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    *text = rest;
    let start = digits.iter().position(|&c| c != b'0').unwrap_or(digits.len());
    &digits[start..]
}

/// A name with one `%d` or `%04d` in it.
struct Numbered<'a> {
    before: &'a str,
    after: &'a str,
    width: usize,
}

fn printf(pattern: &str) -> Option<Numbered<'_>> {
    let (before, rest) = pattern.split_once('%')?;
    let (width, after) = rest.split_once('d')?;
    if !width.is_empty() && !width.starts_with('0') {
        return None;
    }
    let width = if width.is_empty() { 1 } else { width.parse().ok()? };
    Some(Numbered { before, after, width })
}

impl Numbered<'_> {
    /// `%04d` prints 12345 with five digits, so longer numbers match, but only without padding.
    fn matches(&self, name: &str) -> bool {
        let digits = name.strip_prefix(self.before).and_then(|rest| rest.strip_suffix(self.after));
        digits.is_some_and(|digits| {
            digits.bytes().all(|c| c.is_ascii_digit())
                && (digits.len() == self.width.max(1)
                    || digits.len() > self.width && !digits.starts_with('0'))
        })
    }
}

/// Shell globbing with `*` and `?`.
fn glob(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    let mut star = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(&c) if c == '?' || c == name[n] => (p, n) = (p + 1, n + 1),
            _ => match star {
                Some((at, from)) => {
                    star = Some((at, from + 1));
                    (p, n) = (at + 1, from + 1);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests;
