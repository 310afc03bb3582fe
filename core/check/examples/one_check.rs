//! What the tests start a process for each check with: what `honami plugin check FILE --plugin-id ID --reproduce
//! CHECK:SEED --answer` does, without the rest of honami.

use honami_check::{Asker, Subject, checks, examine};
use honami_host::{Host, Registry, SearchPath};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let asker = Asker::of_stdin()?;
    let words: Vec<String> = std::env::args().collect();
    let [_, _, _, file, _, id, _, which, _] = words.as_slice() else { return Err("other arguments".into()) };
    let (check, seed) = which.rsplit_once(':').ok_or("no seed")?;
    let registry =
        Registry::scan_path(&SearchPath { named: vec![PathBuf::from(file)], ..SearchPath::default() });
    let info = registry.plugins().iter().find(|info| info.id == *id).ok_or("no such plugin")?;
    let check = checks().into_iter().find(|known| known.id == check).ok_or("no such check")?;
    let store = PathBuf::from(file).with_file_name("store");
    let subject = Subject::new(info.clone(), Host::with_store(store), seed.parse()?);
    Ok(asker.tell(&examine(&check, &subject))?)
}
