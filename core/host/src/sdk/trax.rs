//! A tracker of somebody else's that speaks TraX, made a plugin: an adapter that knows how its servers are started.

use super::{Begun, HONAMI_PY, check, own};
use std::path::{Path, PathBuf};

/// What every plugin reads anyway.
const OF_THE_SYSTEM: [&str; 4] = ["/usr", "/lib", "/lib64", "/opt"];

/// The adapter of a TraX server that is started with this command; its words that are files are found from here.
///
/// # Errors
/// When the name will not do, or there is no command; a sentence.
pub fn adapt(name: &str, command: &[String]) -> Result<Begun, String> {
    check(name, true)?;
    if command.is_empty() {
        return Err(format!(
            "wanted how the server is started, got nothing: honami plugin new {name} --lang trax -- python3 tracker.py"
        ));
    }
    let (mut words, mut reads) = (Vec::new(), Vec::new());
    for (k, word) in command.iter().enumerate() {
        let path = Path::new(word);
        // A program without a folder is looked for on the search path; a word alone is no folder.
        let has_folder = path.components().count() > 1;
        let is_ours = (has_folder && path.exists()) || (k > 0 && path.is_file());
        let whole = std::path::absolute(path).ok().filter(|_| is_ours);
        reads.extend(whole.as_deref().and_then(|path| needed(path, k == 0)));
        words.push(whole.map_or_else(|| word.clone(), |path| path.to_string_lossy().into_owned()));
    }
    reads.sort();
    reads.dedup();
    let list = |texts: Vec<String>| serde_json::Value::from(texts).to_string();
    let reads = reads.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let text = own(name, include_str!("../../../plugin/python/examples/trax.py"))
        .replace("COMMAND = [\"python3\", \"tracker.py\"]", &format!("COMMAND = {}", list(words)))
        .replace("READS = []", &format!("READS = {}", list(reads)));
    Ok(Begun {
        files: vec![(format!("{name}.py"), text), ("honami.py".to_owned(), HONAMI_PY.to_owned())],
        build: format!("python3 {name}/{name}.py --honami-manifest"),
        plugin: format!("{name}/{name}.py"),
    })
}

/// The folder that a word of the command must be able to read: its own, or of a program in a `bin` the one above.
fn needed(path: &Path, is_program: bool) -> Option<PathBuf> {
    let folder = if path.is_dir() { path } else { path.parent()? };
    let folder = if is_program && folder.ends_with("bin") { folder.parent()? } else { folder };
    let is_known = OF_THE_SYSTEM.iter().any(|known| folder.starts_with(known));
    (!is_known).then(|| folder.to_owned())
}
