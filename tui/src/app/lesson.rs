//! The tutorial: one step at a time, each over when the state shows that it was done.

use super::action::{Action, Context, TABLE};
use super::keymap::KeyMap;
use super::state::{Mode, State};
use honami_model::history::EntryId;
use honami_model::track::TrackId;

/// A step: what to do, and how the state shows that it was done. `{name}` stands for the keys of an action while
/// reviewing, `{place:name}` for its keys elsewhere.
struct Step {
    text: &'static str,
    is_done: fn(&State, &Lesson) -> bool,
}

const STEPS: [Step; 16] = [
    Step {
        text: "This shrub has been tracked for you. Press {play} to see it move.",
        is_done: |state, _| state.play.is_some(),
    },
    Step {
        text: "Each dot follows a place on a leaf: a track. {play} again pauses.",
        is_done: |state, _| state.play.is_none(),
    },
    Step {
        text: "{step} goes one frame on, {step-back} one back; a number before it, so many.",
        is_done: |_, lesson| lesson.was_done(Action::StepForward) || lesson.was_done(Action::StepBack),
    },
    Step {
        text: "{down} selects the next track, {up} the one before; so does a click.",
        is_done: |state, lesson| state.selected != lesson.selected,
    },
    Step {
        text: "{next-item} opens the most doubtful stretch of all tracks, at its worst frame.",
        is_done: |state, lesson| lesson.was_done(Action::NextItem) && state.opened().is_some(),
    },
    Step {
        text: "Is it right? {accept} accepts it, {reject} rejects its track, {later} puts it off: then the next is open.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::Accept, Action::Reject, Action::Later]),
    },
    Step {
        text: "{move-sample} takes hold of the sample: {move:left} {move:down} {move:up} {move:right} move it, \
               {move:accept} keeps it there.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::MoveSample]),
    },
    Step {
        text: "The sample is a key-frame now. {retrack-both} tracks again from it, to both sides.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::RetrackBoth]) && state.job.is_none(),
    },
    Step {
        text: "Where a leaf is gone, {mark-lost} says that it is lost, from here to the next key-frame.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::MarkLost]),
    },
    Step {
        text: "{sketch} draws a track: {sketch:step} puts it down and steps on, {sketch:play-slow} plays under mouse \
               or arrows; {sketch:accept} keeps.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::Sketch]),
    },
    Step {
        text: "{undo} takes the last edit back, and the one before it; nothing is ever lost.",
        is_done: |state, lesson| lesson.has_edited(state, &[Action::Undo]),
    },
    Step {
        text: "{motion} shows motion: hue is direction, strength is speed.",
        is_done: |state, _| state.motion.is_on,
    },
    Step {
        text: "{cluster} groups the tracks by their movement: {form:accept} in its form runs it.",
        is_done: |state, _| state.groups.is_some(),
    },
    Step {
        text: "Colours are groups now. {palette} finds every action by its name; {menu:back} leaves the list.",
        is_done: |state, lesson| lesson.was_done(Action::Palette) && matches!(state.mode, Mode::Review),
    },
    Step {
        text: "{help} lists what works where you are; {menu:back} leaves the list.",
        is_done: |state, lesson| lesson.was_done(Action::Help) && matches!(state.mode, Mode::Review),
    },
    Step {
        text: "That is the way through it. {open} finds your own clip, {back} closes this, {quit} leaves.",
        is_done: |_, _| false,
    },
];

/// A tutorial under way.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lesson {
    /// The step; past the last, the tutorial is closed.
    at: usize,
    /// Actions that were called in this step, and where the document stood then.
    done: Vec<(Action, EntryId)>,
    /// The selected track when the step began.
    selected: Option<TrackId>,
}

impl Lesson {
    /// Begins it.
    #[must_use]
    pub fn new(state: &State) -> Self {
        Self { selected: state.selected, ..Self::default() }
    }

    /// The step, counted from 1, and of how many; `None` once it is closed.
    #[must_use]
    pub fn step(&self) -> Option<(usize, usize)> {
        STEPS.get(self.at).map(|_| (self.at + 1, STEPS.len()))
    }

    /// The words of the step, and whether each is a key.
    #[must_use]
    pub fn words(&self, keys: &KeyMap) -> Vec<(String, bool)> {
        let text = STEPS.get(self.at).map_or("", |step| step.text);
        text.split_whitespace().map(|word| filled(word, keys)).collect()
    }

    /// Notes that an action was called.
    pub(super) fn note(&mut self, action: Action, head: EntryId) {
        self.done.push((action, head));
    }

    /// Closes it.
    pub(super) fn close(&mut self) {
        self.at = STEPS.len();
    }

    fn was_done(&self, action: Action) -> bool {
        self.done.iter().any(|(done, _)| *done == action)
    }

    /// Whether one of these actions was called, and the document is another one since.
    fn has_edited(&self, state: &State, actions: &[Action]) -> bool {
        let mut done = self.done.iter();
        done.any(|(action, head)| actions.contains(action) && state.history.head != *head)
    }
}

/// A word of a step with its keys; an action without any is called by its name.
fn filled(word: &str, keys: &KeyMap) -> (String, bool) {
    let Some((name, rest)) = word.strip_prefix('{').and_then(|word| word.split_once('}')) else {
        return (word.to_owned(), false);
    };
    let (place, name) = name.split_once(':').unwrap_or((Context::Review.name(), name));
    let place = Context::ALL.into_iter().find(|context| context.name() == place);
    let action = TABLE.iter().find(|info| info.name == name).map(|info| info.action);
    let bound = place.zip(action).and_then(|(place, action)| keys.keys_of(place, action));
    (bound.unwrap_or_else(|| format!(":{name}")) + rest, true)
}

/// Goes on to the next step when this one is done.
pub(super) fn follow(state: &mut State) {
    let Some(lesson) = &state.lesson else { return };
    if STEPS.get(lesson.at).is_some_and(|step| (step.is_done)(state, lesson)) {
        state.lesson = Some(Lesson { at: lesson.at + 1, ..Lesson::new(state) });
    }
}

#[cfg(test)]
mod tests;
