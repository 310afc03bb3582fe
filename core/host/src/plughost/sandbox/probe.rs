//! How far this system would shut a plugin in, told without giving anything up.

use super::{Level, RIGHTS, calls, level};
use landlock::{
    ABI, Access as _, AccessFs, AccessNet, CompatLevel, Compatible as _, Ruleset, RulesetAttr as _,
    RulesetError, RulesetStatus, Scope,
};
use std::fs;
use std::sync::OnceLock;

/// What the kernel can answer a filtered call with.
const ANSWERS: &str = "/proc/sys/kernel/seccomp/actions_avail";

/// The level that [`super::enter`] would reach here, and what keeps it from being full. `programs` says why other
/// programs could not be refused, if they could not.
pub(crate) fn foresee(programs: Option<&str>) -> (Level, String) {
    // A kernel answers the same as long as it runs, and lists of plugins ask for each of them.
    static ANSWER: OnceLock<(RulesetStatus, bool)> = OnceLock::new();
    let (files, calls) = ANSWER.get_or_init(|| (files(), are_calls_refused()));
    let of_files = match files {
        RulesetStatus::FullyEnforced => None,
        RulesetStatus::PartiallyEnforced => Some("this kernel's landlock is too old for all of it"),
        RulesetStatus::NotEnforced => Some("this kernel has no landlock, which keeps files from it"),
    };
    let of_calls = (!*calls).then_some("this kernel refuses no calls (seccomp)");
    let why: Vec<&str> = [programs, of_files, of_calls].into_iter().flatten().collect();
    (level(files, *calls, programs.is_none()), why.join("; "))
}

/// What would be kept of files: rulesets that are made and thrown away bind nobody.
fn files() -> RulesetStatus {
    let hard = || Ruleset::default().set_compatibility(CompatLevel::HardRequirement);
    let all = || -> Result<(), RulesetError> {
        hard()
            .handle_access(AccessFs::from_all(RIGHTS))?
            .handle_access(AccessNet::from_all(RIGHTS))?
            .scope(Scope::from_all(RIGHTS))?
            .create()?;
        Ok(())
    };
    let first = || hard().handle_access(AccessFs::from_all(ABI::V1)).and_then(|ruleset| ruleset.create());
    if all().is_ok() {
        RulesetStatus::FullyEnforced
    } else if first().is_ok() {
        RulesetStatus::PartiallyEnforced
    } else {
        RulesetStatus::NotEnforced
    }
}

fn are_calls_refused() -> bool {
    let answers = fs::read_to_string(ANSWERS).unwrap_or_default();
    calls::is_known_here() && answers.split_whitespace().any(|answer| answer == "errno")
}
