//! What must be true of a plant and of steps before a plugin sees them.

use super::{Detail, PlantInstance, Steps, WindRows};
use crate::reply::TABLE_BYTES_MAX;
use crate::types::Node;

/// What keeps this from being a plant in copies.
pub(super) fn plant_fault(nodes: &[Node], instances: &[PlantInstance]) -> Option<String> {
    if nodes.is_empty() || instances.is_empty() {
        return Some(format!("cannot move {} copies of {} nodes", instances.len(), nodes.len()));
    }
    for (k, node) in nodes.iter().enumerate() {
        if node.parent.is_none() != (k == 0) || node.parent.is_some_and(|parent| parent as usize >= k) {
            return Some(format!("node {k} has parent {:?}, which does not come before it", node.parent));
        }
        if !node.position.iter().chain([&node.radius]).all(|v| v.is_finite()) || node.radius < 0.0 {
            return Some(format!("node {k} lies at {:?} with radius {}", node.position, node.radius));
        }
    }
    let is_copy = |copy: &PlantInstance| {
        copy.yaw.is_finite() && [copy.scale, copy.mass].iter().all(|v| v.is_finite() && *v > 0.0)
    };
    if let Some(k) = instances.iter().position(|copy| !is_copy(copy)) {
        return Some(format!("copy {k} is {:?}: scale and mass are above 0", instances[k]));
    }
    let bytes = nodes.len().checked_mul(instances.len()).and_then(|n| n.checked_mul(size_of::<[f32; 3]>()));
    let is_too_much = bytes.is_none_or(|bytes| bytes > TABLE_BYTES_MAX);
    is_too_much.then(|| {
        let gib = nodes.len() as f64 * instances.len() as f64 * 12.0 / f64::from(1 << 30);
        let (copies, nodes) = (instances.len(), nodes.len());
        format!(
            "would move {copies} copies of {nodes} nodes: a motion of {gib:.0} GiB, at most 16 are possible"
        )
    })
}

/// What keeps these from being steps of so large a plant.
pub(super) fn steps_fault(steps: &Steps<'_>, n_nodes: usize, n_instances: usize) -> Option<String> {
    let Steps { dt, n, wind, detail } = *steps;
    if !(dt.is_finite() && dt > 0.0) {
        return Some(format!("cannot go {n} steps of {dt} s"));
    }
    wind_fault(wind, n_instances).or_else(|| detail_fault(detail?, n_nodes, n_instances))
}

fn wind_fault(wind: WindRows<'_>, n_instances: usize) -> Option<String> {
    let WindRows { times_s, velocities } = wind;
    let (n, rows) = (times_s.len(), velocities.len());
    if rows != n && Some(rows) != n.checked_mul(n_instances) {
        return Some(format!("was given {rows} rows of wind for {n} times and {n_instances} copies"));
    }
    if let Some(k) = velocities.iter().position(|velocity| !velocity.iter().all(|v| v.is_finite())) {
        return Some(format!("was given wind that is not finite: row {k} is {:?}", velocities[k]));
    }
    let rises = times_s.is_sorted_by(|a, b| a < b) && times_s.iter().all(|t| t.is_finite());
    (!rises).then(|| "was given wind whose times do not rise".to_owned())
}

fn detail_fault(detail: &[Detail], n_nodes: usize, n_instances: usize) -> Option<String> {
    if detail.len() != n_instances {
        return Some(format!("was given the detail of {} copies of {n_instances}", detail.len()));
    }
    let k = detail.iter().position(|copy| copy.nodes as usize > n_nodes)?;
    Some(format!("was asked for {} nodes of copy {k}, which has {n_nodes}", detail[k].nodes))
}
