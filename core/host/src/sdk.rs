//! What the author of a plugin begins with: a working tracker under a name of their own, and what it is built on.

/// A file by name, and what is in it.
pub type File = (String, String);

/// Languages that a plugin can be begun in, beside Rust (`honami-plugin`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// One file, the standard library and numpy.
    Python,
    /// The header alone.
    C,
}

/// What plugins in Python import.
pub(crate) const HONAMI_PY: &str = include_str!("../../plugin/python/honami.py");

/// The files of a new tracker, the one to change first.
#[must_use]
pub fn new_tracker(name: &str, language: Language) -> Vec<File> {
    let id = format!("org.me.{name}");
    match language {
        Language::Python => {
            let text = include_str!("../../plugin/python/examples/template.py");
            let text = text.replace("org.honami.template", &id);
            vec![(format!("{name}.py"), text), ("honami.py".to_owned(), HONAMI_PY.to_owned())]
        }
        Language::C => {
            let text = include_str!("../../abi/examples/null_tracker.c");
            let text = text.replace("org.honami.null", &id).replace("org.honami.examples", &id);
            let header = include_str!("../../abi/include/honami.h");
            vec![(format!("{name}.c"), text), ("honami.h".to_owned(), header.to_owned())]
        }
    }
}
