//! How a job says how far it is, and how it is told to stop.

/// Whether a job goes on, or stops soon and keeps what can be kept.
pub use honami_host::{Flow, Level, Patience, Silence};

/// Whoever watches a job; called from the job's thread.
pub trait Progress: Sync {
    /// `done` of `total` steps are done; `what` names them: `frame`, `pairs`.
    fn report(&self, done: u64, total: u64, what: &str) -> Flow;

    /// A part of the job begins that takes a while and has a name: `klt, 2 of 3`.
    fn part(&self, _name: &str) {}

    /// A plugin, by its short name, has logged or printed a line while it was at this frame of the clip, where it is at
    /// one; called from any thread.
    fn hear(&self, _plugin: &str, _frame: Option<u32>, _level: Level, _line: &str) {}

    /// The plugin at work comes to this frame of the clip; what is done may be fewer frames, or more steps.
    fn at(&self, _frame: u32) {}

    /// The process of a plugin, by its short name, has ended in this frame, and how; then what became of it, or `None`
    /// where it is not started again: the job ends with the reason.
    fn died(&self, _plugin: &str, _frame: u32, _how: &str, _then: Option<&str>) {}

    /// Whether a plugin, which is at this frame of the clip, where it is at one, and last said that it was at something,
    /// is waited for while it gives no sign of life; asked all the while, with `None` once it lives.
    fn silent(&self, _plugin: &str, _frame: Option<u32>, _at: &str, _silence: Option<Silence>) -> Patience {
        Patience::Usual
    }

    /// Something has become of the job on its way that is worth a line; called from any thread.
    fn say(&self, _line: &str) {}
}

/// Somebody who watches, told of all steps under one name.
pub(crate) struct Named<'a> {
    /// Who watches.
    pub(crate) progress: &'a dyn Progress,
    /// What the steps are called: `klt 2 of 3, there and back`.
    pub(crate) name: String,
}

impl Progress for Named<'_> {
    fn report(&self, done: u64, total: u64, _what: &str) -> Flow {
        self.progress.report(done, total, &self.name)
    }

    fn hear(&self, plugin: &str, frame: Option<u32>, level: Level, line: &str) {
        self.progress.hear(plugin, frame, level, line);
    }

    fn at(&self, frame: u32) {
        self.progress.at(frame);
    }

    fn died(&self, plugin: &str, frame: u32, how: &str, then: Option<&str>) {
        self.progress.died(plugin, frame, how, then);
    }

    fn silent(&self, plugin: &str, frame: Option<u32>, at: &str, silence: Option<Silence>) -> Patience {
        self.progress.silent(plugin, frame, at, silence)
    }

    fn say(&self, line: &str) {
        self.progress.say(line);
    }
}

/// Nobody watches, and the job runs to its end.
impl Progress for () {
    fn report(&self, _done: u64, _total: u64, _what: &str) -> Flow {
        Flow::Continue
    }
}
