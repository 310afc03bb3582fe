//! Names under which this process writes what is not finished: whoever ends it removes them first.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

static NAMES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// All of them. While they are held nothing is begun and nothing takes its own name.
pub fn names() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    NAMES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file or folder that has a name for the time being; the name is struck off the list when this goes.
#[derive(Debug)]
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// What is about to be begun under this name.
    #[must_use]
    pub fn new(name: PathBuf) -> Self {
        names().insert(name.clone());
        Self(name)
    }

    /// Begins something, which says what it is called, on the list before anybody can look.
    ///
    /// # Errors
    /// What `begin` met.
    pub fn begin<T, E>(begin: impl FnOnce() -> Result<(T, PathBuf), E>) -> Result<(T, Self), E> {
        let mut names = names();
        let (made, name) = begin()?;
        names.insert(name.clone());
        Ok((made, Self(name)))
    }

    /// What it is called for the time being.
    #[must_use]
    pub fn name(&self) -> &Path {
        &self.0
    }

    /// Does what gives it its own name while nobody holds the list.
    pub fn settle<T>(&self, settle: impl FnOnce(&Path) -> T) -> T {
        let _held = names();
        settle(&self.0)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        names().remove(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::{Unfinished, names};
    use std::path::PathBuf;

    #[test]
    fn what_is_begun_is_listed_until_it_goes() {
        let begin = |name: &str| Unfinished::begin(|| Ok::<_, ()>(((), PathBuf::from(name)))).unwrap().1;
        let (one, two) = (begin("one.part"), begin("two.part"));
        let is_listed = |name: &str| names().contains(std::path::Path::new(name));
        assert!(is_listed("one.part") && is_listed("two.part"));
        assert_eq!(one.settle(std::path::Path::to_owned), one.name());
        drop((one, two));
        assert!(!is_listed("one.part") && !is_listed("two.part"));
        assert_eq!(Unfinished::begin(|| Err::<((), PathBuf), _>("no")).unwrap_err(), "no");
    }
}
