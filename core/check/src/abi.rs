//! Level 3: hosts of other times, and hosts that have nothing to give.

use crate::loading::loaded;
use crate::raw::{Desk, Dress, Library, Made, Played, Scene, play};
use crate::{Check, Fault, Subject, Verdict};
use rand::RngExt as _;
use std::ffi::CString;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(20);

pub(crate) const CHECKS: &[Check] = &[
    Check {
        id: "abi.tables",
        level: 3,
        claim: "it has every interface that its manifest announces, the same every time",
        deadline: DEADLINE,
        run: tables,
    },
    Check {
        id: "abi.older-host",
        level: 3,
        claim: "it reads no field that a host of ABI 1.0 does not have",
        deadline: DEADLINE,
        run: |subject| as_today(subject, Scene { dress: Dress::Older, ..GRAY }),
    },
    Check {
        id: "abi.newer-host",
        level: 3,
        claim: "it works, and writes nothing, in structs that have grown",
        deadline: DEADLINE,
        run: |subject| as_today(subject, Scene { dress: Dress::Newer, ..GRAY }),
    },
    Check {
        id: "abi.reserved",
        level: 3,
        claim: "it reads no reserved field",
        deadline: DEADLINE,
        run: |subject| {
            let number = subject.chance("abi.reserved").random::<u32>() | 1;
            as_today(subject, Scene { dress: Dress::Reserved(number), ..GRAY })
        },
    },
    Check {
        id: "abi.optional",
        level: 3,
        claim: "it does without all that a host may leave out: parameters, colour, mask, services",
        deadline: DEADLINE,
        run: optional,
    },
    Check {
        id: "abi.no-memory",
        level: 3,
        claim: "it fails with a code when it is refused memory for its results",
        deadline: DEADLINE,
        run: no_memory,
    },
];

/// Frames without colour, as a host of 1.0 has them.
const GRAY: Scene = Scene { dress: Dress::Today, has_colour: false, sets_params: true, refuses: None };

/// What refuses ordinary work with its defaults can be told nothing.
fn beside(today: &Played) -> Option<Verdict> {
    let why = today.ended.as_ref()?;
    Some(Verdict::Beside(format!("with its defaults it does not work: {why}")))
}

fn tables(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |library: &Library| {
        let (info, desk) = (&subject.info, Desk::new()?);
        let made = Made::of(library, &desk, info)?;
        for name in &info.interfaces {
            let id = CString::new(name.as_str()).map_err(|error| Fault(error.to_string()))?;
            let at = made.interface(&id)?;
            if at.is_null() {
                return Err(Fault(format!("its manifest has {name}, its instance has none")));
            }
            if made.interface(&id)? != at {
                return Err(Fault(format!("it gave another table of {name} the second time")));
            }
        }
        Ok(Verdict::Holds(info.interfaces.join(", ")))
    })
}

/// It does in another dress what it does in today's.
fn as_today(subject: &Subject, scene: Scene) -> Result<Verdict, Fault> {
    loaded(subject, |_| {
        let today = play(subject, GRAY)?;
        if let Some(beside) = beside(&today) {
            return Ok(beside);
        }
        same(subject, &today, &play(subject, scene)?)
    })
}

fn same(subject: &Subject, today: &Played, other: &Played) -> Result<Verdict, Fault> {
    if let Some(why) = &other.ended {
        return Err(Fault(format!("wanted what it does in a host of today, got {why}")));
    }
    if subject.info.caps.deterministic && today.results != other.results {
        return Err(Fault("its results are others than in a host of today".into()));
    }
    Ok(Verdict::Holds(format!("{} results", other.results.len())))
}

fn optional(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |_| {
        let colour = play(subject, Scene { has_colour: true, ..GRAY })?;
        if let Some(beside) = beside(&colour) {
            return Ok(beside);
        }
        let (today, bare) = (play(subject, GRAY)?, play(subject, Scene { sets_params: false, ..GRAY })?);
        same(subject, &today, &bare)
    })
}

fn no_memory(subject: &Subject) -> Result<Verdict, Fault> {
    loaded(subject, |_| {
        let today = play(subject, GRAY)?;
        if let Some(beside) = beside(&today) {
            return Ok(beside);
        }
        let mut refused = Vec::new();
        for name in ["push", "end", "detect", "field", "run"] {
            let played = play(subject, Scene { refuses: Some(name), ..GRAY })?;
            if played.n_refused > 0 {
                refused.push(name);
            }
        }
        if refused.is_empty() {
            return Ok(Verdict::Beside("it asked for none".into()));
        }
        Ok(Verdict::Holds(format!("refused in {}", refused.join(", "))))
    })
}
