//! Level 1: what can be told of the file before any of its code runs.

use crate::{Check, Fault, Subject, Verdict};
use std::time::Duration;

pub(crate) const CHECKS: &[Check] = &[Check {
    id: "file.described",
    level: 1,
    claim: "it says what it is for, under which licence, and every parameter says what it does",
    deadline: Duration::from_secs(5),
    run: described,
}];

fn described(subject: &Subject) -> Result<Verdict, Fault> {
    let info = &subject.info;
    let silent = info.params.iter().filter(|param| param.doc.is_empty()).map(|param| param.id.as_str());
    let silent: Vec<_> = silent.collect();
    if !silent.is_empty() {
        return Ok(Verdict::Doubtful(format!("nothing is said of {}", silent.join(", "))));
    }
    if info.doc.is_empty() || info.license.is_empty() {
        return Ok(Verdict::Doubtful("its manifest has no doc or no license".into()));
    }
    Ok(Verdict::Holds(String::new()))
}
