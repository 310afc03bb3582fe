//! `shape`: hand work on skeletons, kept in the project.

use honami_model::document::Document;
use honami_model::edit::Transaction;
use honami_workbench::WorkbenchError;
use honami_workbench::shape::{self, Bone, Listed, Refused, Shape, Step};
use honami_workbench::store::{Access, Project};
use serde_json::{Value, json};

use super::args::grow::{Released, Shape as Shaping};
use super::{Answer, look, there, want};

/// Places the root, shapes a bone, takes that back; without anything to do, says what was done.
pub(super) fn shape(args: &Shaping) -> anyhow::Result<Answer> {
    let turns = [args.plane, args.lean, args.gain];
    want(args.group.is_none() || turns.iter().any(Option::is_some), || {
        "--group goes with --plane, --lean or --gain; --release GROUPS has the bone as it grows".to_owned()
    })?;
    if args.root.is_none() && args.group.is_none() && args.release.is_none() {
        return listed(&look(&args.project)?);
    }
    there(&args.project)?;
    let mut project = Project::open(&args.project, Access::Write)?;
    let mut steps: Vec<Step> = args.root.map(|place| Step::Root(Some(place.0))).into_iter().collect();
    if let Some(groups) = &args.group {
        let Listed { bone, shape: was, .. } = shape::bone(&project, &groups.0)?;
        let [plane, lean, gain] = turns;
        let shape = Shape {
            plane_rad: plane.map_or(was.plane_rad, f64::to_radians),
            lean_rad: lean.map_or(was.lean_rad, f64::to_radians),
            gain: gain.unwrap_or(was.gain),
        };
        steps.push(Step::Bone(bone, shape));
    }
    if let Some(what) = &args.release {
        steps.push(match what {
            Released::All => Step::Release,
            Released::Root => Step::Root(None),
            Released::Bone(groups) => Step::Bone(shape::bone(&project, &groups.0)?.bone, Shape::default()),
        });
    }
    let transaction = together(&project, &steps)?;
    let label = transaction.label.clone();
    let id = project.commit(transaction)?;
    let json = json!({ "edits": [{ "id": id, "label": label }], "revision": project.revision() });
    Ok(Answer { json, text: format!("{id}  {label}"), done: true })
}

/// Steps as one edit: all of them or none. What is so already is left out, where anything else is to be done.
fn together(project: &Project, steps: &[Step]) -> Result<Transaction, WorkbenchError> {
    let mut prepared: Vec<_> = steps.iter().map(|step| shape::prepare(project, step)).collect();
    let is_same = |one: &Result<_, _>| matches!(one, Err(WorkbenchError::Shape(Refused::Same(_))));
    if !prepared.iter().all(is_same) {
        prepared.retain(|one| !is_same(one));
    }
    let all = prepared.into_iter().collect::<Result<Vec<Transaction>, _>>()?;
    let label = all.iter().map(|one| &*one.label).collect::<Vec<_>>().join("; ");
    Ok(Transaction::new(label, all.into_iter().flat_map(|one| one.edits).collect()))
}

/// The root, and the bones of the shown groups with what was done to them, each farther in than what bears it.
fn listed(project: &Project) -> anyhow::Result<Answer> {
    let (bones, lengths) = (shape::bones(project)?, shape::lengths(project)?);
    let name = |listed: &Listed| format!("{}{}", "  ".repeat(listed.level), listed.bone.name);
    let width = bones.iter().map(|listed| name(listed).chars().count()).max().unwrap_or_default();
    let mut lines = vec![root(project.document())];
    let mut rows = Vec::with_capacity(bones.len());
    for listed in &bones {
        let length = lengths.get(&listed.bone.node);
        let long = length.map_or_else(|| "no bone".to_owned(), |length| format!("{length:.1} px"));
        let line = format!("{:width$}  {long:>9}  {}", name(listed), listed.shape);
        lines.push(line.trim_end().to_owned());
        let mut row = row(&listed.bone, &listed.shape);
        (row["level"], row["length_px"]) = (listed.level.into(), json!(length));
        rows.push(row);
    }
    if lengths.len() < bones.len() {
        lines.push(
            "no bone: one with what bears it, unless grown otherwise; shaping it does nothing then"
                .to_owned(),
        );
    }
    let json = json!({ "root": project.document().root(), "bones": rows });
    Ok(Answer { json, text: lines.join("\n"), done: true })
}

fn root(document: &Document) -> String {
    match document.root() {
        Some([x, y]) => format!("root at {x:.1}, {y:.1}, by hand"),
        None => "root as it grows".to_owned(),
    }
}

/// A bone and its shape, for machines; groups count from 1.
pub(super) fn row(bone: &Bone, shape: &Shape) -> Value {
    json!({
        "bone": bone.name,
        "node": bone.node,
        "groups": bone.groups.iter().map(|group| group + 1).collect::<Vec<_>>(),
        "plane_rad": shape.plane_rad,
        "lean_rad": shape.lean_rad,
        "gain": shape.gain,
    })
}
