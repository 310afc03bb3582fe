//! The plugins that are here: as forms know them, rebuilt, let start again.

use honami_workbench::plugins::{Host, Kind, PluginInfo};

use super::{Facts, World};
use crate::app::form::{Plugin, Task, Used};
use crate::app::state::Notice;
use crate::app::update::Fact;

impl World {
    pub(super) fn plugins(&self) -> Vec<Plugin> {
        let host = &self.session.options.host;
        self.session.registry.plugins().iter().filter_map(|info| plugin(info, host)).collect()
    }

    /// What the plugins that are here were told last in this project.
    pub(super) fn used(&self) -> Fact {
        let used = |info: &PluginInfo| {
            let values = self.used.values(&info.id, &info.renamed);
            Some(Used { task: task_of(info)?, plugin: info.short_name.clone(), values })
        };
        Fact::Used(self.session.registry.plugins().iter().filter_map(used).collect())
    }

    /// Lets a plugin start again that has failed too often.
    pub(super) fn release(&mut self, id: &str) -> Facts {
        if let Some(plugin) = self.session.registry.plugins().iter().find(|plugin| plugin.id == id) {
            self.session.options.host.retry(plugin)?;
        }
        Ok(Vec::new())
    }

    /// The plugins there are now, when the file of one is another than it was. While a job runs it looks after its own.
    pub(super) fn rebuilt(&mut self) -> Option<Vec<Fact>> {
        let rebuilding = self.rebuilding.as_ref().filter(|_| self.running.is_none())?;
        rebuilding.is_news().then(|| {
            self.session.look_for_plugins();
            // What a form begins with that is filled in anew.
            let mut facts = vec![self.used(), Fact::Plugins(self.plugins())];
            let unusable = self.session.registry.unusable().next();
            facts.extend(unusable.map(|why| Fact::Said(Notice { text: why.to_owned(), is_error: true })));
            facts
        })
    }
}

/// What a plugin does for the terminal UI; `None` for kinds without a form.
fn task_of(info: &PluginInfo) -> Option<Task> {
    match info.kind {
        Kind::Tracker => Some(Task::Track),
        Kind::Clusterer => Some(Task::Cluster),
        _ => None,
    }
}

/// A plugin as forms know it; `None` for kinds without a form.
fn plugin(info: &PluginInfo, host: &Host) -> Option<Plugin> {
    Some(Plugin {
        task: task_of(info)?,
        name: info.short_name.clone(),
        version: info.version.clone(),
        params: info.params.clone(),
        can_detect: info.offers("honami.detect/1"),
        apart: host.prospect(info),
    })
}
