//! Hand work on the skeleton of the shown groups: its root placed, its bones shaped. It is kept in the project; growing lays it
//! over what has grown.

use std::collections::BTreeMap;

use honami_model::edit::Transaction;
use honami_model::shape::transaction;
use honami_store::Project;

pub use honami_model::shape::{Bone, MOST_GAIN, Refused, Shape, Step};

use crate::error::WorkbenchError;
use crate::grow::{Usual, check_root, named_bones, usual};

/// A bone and how it is shaped.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// The bone.
    pub bone: Bone,
    /// As hands have shaped it.
    pub shape: Shape,
    /// How many forks are between it and the trunk, which is of level 0.
    pub level: usize,
}

/// The bones that the shown groups can have, each after what bears it. One that is too short will be one with that.
///
/// # Errors
/// [`WorkbenchError::NoGroups`], [`WorkbenchError::Structure`] where nothing is seen, and what the project met.
pub fn bones(project: &Project) -> Result<Vec<Listed>, WorkbenchError> {
    let document = project.document();
    let shown = document.clustering().ok_or(WorkbenchError::NoGroups)?;
    let listed = |(bone, level): (Bone, usize)| {
        let shape = document.shape(shown.id, bone.node).unwrap_or_default();
        Listed { bone, shape, level }
    };
    Ok(named_bones(project)?.into_iter().map(listed).collect())
}

/// How long bones are in the skeleton that [`grow`](crate::grow::grow) makes unless told otherwise, by their nodes, pixels. A
/// bone that is not there is one with what bears it.
///
/// # Errors
/// As [`grow`](crate::grow::grow).
pub fn lengths(project: &Project) -> Result<BTreeMap<u32, f64>, WorkbenchError> {
    let Usual { skeleton, bones, .. } = usual(project)?;
    let joints = skeleton.joints().iter().zip(&bones.known).zip(&bones.copy_of);
    let own = joints.filter(|(_, copy_of)| copy_of.is_none());
    Ok(own.filter_map(|((joint, known), _)| Some((known.as_ref()?.node, joint.length))).collect())
}

/// The bone that bears these groups and no others, numbers from 0 in any order.
///
/// # Errors
/// [`WorkbenchError::NoBone`], and as [`bones`].
pub fn bone(project: &Project, groups: &[u32]) -> Result<Listed, WorkbenchError> {
    let mut wanted = groups.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    let all = bones(project)?;
    let names: Vec<&str> = all.iter().map(|listed| &*listed.bone.name).collect();
    let missing = || WorkbenchError::NoBone { wanted: ranges(&wanted), names: names.join("; ") };
    all.iter().find(|listed| listed.bone.groups == wanted).cloned().ok_or_else(missing)
}

/// The transaction of a step; the project stays as it is.
///
/// # Errors
/// [`WorkbenchError::Shape`] where nothing would change, [`WorkbenchError::FarRoot`].
pub fn prepare(project: &Project, step: &Step) -> Result<Transaction, WorkbenchError> {
    if let Step::Root(Some(root)) = step {
        check_root(*root, &project.clip().clip)?;
    }
    Ok(transaction(project.document(), step)?)
}

/// What people write of groups, which they count from 1, as numbers from 0: `3`, `3,4`, `1-4,7`. `None` where it is none.
#[must_use]
pub fn parse_groups(text: &str) -> Option<Vec<u32>> {
    let number = |word: &str| word.trim().parse::<u32>().ok()?.checked_sub(1);
    let mut numbers = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last) = (number(first)?, number(last)?);
        // No clip has so many, and nobody means them.
        if first > last || last - first > 99_999 {
            return None;
        }
        numbers.extend(first..=last);
    }
    Some(numbers)
}

/// Rising numbers from 0, as people count: `1-3,5`.
pub(crate) fn ranges(numbers: &[u32]) -> String {
    let mut parts: Vec<(u32, u32)> = Vec::new();
    for number in numbers.iter().map(|number| number.saturating_add(1)) {
        match parts.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => parts.push((number, number)),
        }
    }
    let part = |(first, last): (u32, u32)| match last - first {
        0 => first.to_string(),
        1 => format!("{first},{last}"),
        _ => format!("{first}-{last}"),
    };
    parts.into_iter().map(part).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::{parse_groups, ranges};

    #[test]
    fn numbers_are_told_as_people_count() {
        for (numbers, wanted) in [
            (&[][..], ""),
            (&[2], "3"),
            (&[2, 3], "3,4"),
            (&[0, 1, 2, 4], "1-3,5"),
            (&[0, 2, 4, 5, 6, 7], "1,3,5-8"),
        ] {
            assert_eq!(ranges(numbers), wanted);
            assert_eq!(parse_groups(wanted).unwrap_or_default(), numbers, "and read so");
        }
        for text in ["", "0", "a", "3-", "4-2", "1,,2", "1.5", "1-4000000000", "-3"] {
            assert_eq!(parse_groups(text), None, "{text}");
        }
    }
}
