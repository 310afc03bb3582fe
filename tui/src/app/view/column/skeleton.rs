//! The bones of the skeleton: what each is of, how long it is, how far it moves, and how hands have shaped it.

use ratatui::text::{Line, Span};

use super::{List, Pick, style};
use crate::app::skeleton::Skeletal;
use crate::app::state::{Mode, State};
use crate::app::view::fitted;

/// Cells of a bone's name.
const NAME: usize = 13;

pub(super) struct BoneList<'a> {
    state: &'a State,
    rows: &'a [usize],
}

impl<'a> BoneList<'a> {
    pub(super) fn of(state: &'a State) -> Self {
        let bones = state.skeleton.bones.as_deref();
        let bones = bones.filter(|_| state.skeleton.pose.is_some() && !state.skeleton.is_past);
        Self { state, rows: bones.map_or(&[], |bones| &bones.own) }
    }

    /// What is known of a bone: its name, its length and how far it moves, pixels and degrees, and its shape.
    fn known(&self, i: usize) -> Option<(String, [f64; 2], String)> {
        let (skeleton, row) = (&self.state.skeleton, *self.rows.get(i)?);
        let (bones, pose) = (skeleton.bones.as_deref()?, skeleton.pose.as_deref()?);
        let bone = bones.known(row);
        let name = bone.map_or_else(|| "not told".to_owned(), |bone| bone.name.clone());
        let (shape, pose) = match (&self.state.mode, bone) {
            (Mode::Shape(shaping), Some(bone)) if shaping.bone.node == bone.node => {
                (shaping.shape.to_string(), &*shaping.pose)
            }
            (_, Some(bone)) => (skeleton.hand.shape(bone.node).to_string(), pose),
            (_, None) => (String::new(), pose),
        };
        let length = bones.growth.skeleton.joints()[row].length;
        Some((name, [length, *pose.moves_deg.get(i)?], shape))
    }
}

impl List for BoneList<'_> {
    /// Where its root is by hand.
    fn above(&self, _columns: u16, _rows: u16) -> Vec<Line<'static>> {
        let skeleton = &self.state.skeleton;
        let root = skeleton.hand.root.map(|[x, y]| format!("root by hand at {x:.1}, {y:.1}"));
        root.map(|words| Line::styled(words, style::DIM)).into_iter().collect()
    }

    fn text(&self) -> Option<String> {
        let (name, [length, moves_deg], shape) = self.known(self.current()?)?;
        let by_hand = if shape.is_empty() { shape } else { format!(", by hand {shape}") };
        Some(format!("{name}: {length:.0} px, moves {moves_deg:.1}°{by_hand}"))
    }

    fn heading(&self) -> String {
        format!("  {:NAME$}    px moves", "bone")
    }

    fn nothing(&self) -> &'static str {
        match &self.state.groups {
            _ if Skeletal::is_growing(self.state) => "growing …",
            None => "no groups to grow from: c groups",
            Some(_) => "no skeleton is shown: v k grows it",
        }
    }

    fn len(&self) -> usize {
        self.rows.len()
    }

    fn current(&self) -> Option<usize> {
        let row = Skeletal::current(self.state)?;
        self.rows.iter().position(|other| *other == row)
    }

    fn tells_rest(&self) -> bool {
        true
    }

    fn row(&self, i: usize) -> Line<'static> {
        let Some((name, [length, moves_deg], shape)) = self.known(i) else { return Line::default() };
        let joints = self.state.skeleton.bones.as_deref().map(|bones| bones.growth.skeleton.joints());
        let group = joints.and_then(|joints| joints[self.rows[i]].groups.first()).copied();
        let (mark, style) = match group {
            Some(group) => ("●", style::group_text(Some(group))),
            None => ("╌", style::DIM),
        };
        // Of the current one all is said below.
        let is_brief = !shape.is_empty() && self.current() != Some(i);
        let shape = if is_brief { "by hand".to_owned() } else { shape };
        Line::from(vec![
            Span::styled(mark, style),
            Span::raw(format!(" {} {length:>5.0} {moves_deg:>4.1}° ", fitted(&name, NAME))),
            Span::styled(shape, style::KEY),
        ])
    }

    fn pick(&self, i: usize) -> Option<Pick> {
        let bones = self.state.skeleton.bones.as_deref()?;
        bones.known(*self.rows.get(i)?).map(|bone| Pick::Bone(bone.node))
    }
}
