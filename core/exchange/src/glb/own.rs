//! Whose a file is.

use std::fs::File;
use std::io::{self, BufReader, Read as _};
use std::path::Path;

use serde_json::Value;

/// Whether honami has written a `.glb`, in any release: models of others are not to be lost.
#[must_use]
pub fn is_own(path: &Path) -> bool {
    let generator = |words: Value| words["asset"]["generator"].as_str().map(str::to_owned);
    words(path).ok().and_then(generator).is_some_and(|by| by.split(' ').next() == Some("honami"))
}

/// The words of a `.glb`. Who made it may stand anywhere in them: they are read whole, numbers are not.
fn words(path: &Path) -> io::Result<Value> {
    let mut file = BufReader::new(File::open(path)?);
    let mut head = [0; 20];
    file.read_exact(&mut head)?;
    let [a, b, c, d] = [head[12], head[13], head[14], head[15]];
    if !head.starts_with(b"glTF") || &head[16..] != b"JSON" {
        return Err(io::ErrorKind::InvalidData.into());
    }
    Ok(serde_json::from_reader(file.take(u32::from_le_bytes([a, b, c, d]).into()))?)
}

#[cfg(test)]
mod tests {
    use super::super::Document;
    use super::super::tests::scene;
    use super::*;
    use crate::table::TableError;

    #[test]
    fn models_of_others_are_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("oak.glb");
        for (theirs, by) in [
            (scene(|_| {}), "nobody says"),
            (scene(|words| words["asset"]["generator"] = "honamiko 2".into()), "another name"),
            (scene(|words| words["asset"] = "honami 1".into()), "no generator"),
            (scene(|words| words["asset"]["generator"] = "honami 1".into())[..60].to_vec(), "cut"),
            (b"glTF".to_vec(), "no words"),
        ] {
            std::fs::write(&path, &theirs).unwrap();
            let error = Document::read(&scene(|_| {})).unwrap().write(&path).unwrap_err();
            let is_unlike = matches!(error, super::super::DocumentError::File(TableError::Unlike { .. }));
            assert!(is_unlike && std::fs::read(&path).unwrap() == theirs, "{by}: {error}");
        }
        // Its own are, wherever in the words it stands, and those of releases before.
        let long = |words: &mut Value| {
            words["asset"]["generator"] = "honami 0.0.1".into();
            words["aaa"] = " ".repeat(9000).into();
        };
        std::fs::write(&path, scene(long)).unwrap();
        for _again in 0..2 {
            Document::read(&scene(|_| {})).unwrap().write(&path).unwrap();
        }
    }
}
