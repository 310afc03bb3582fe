//! The viewer's window: opened, shown what there is, told, and what is asked for there done in the project.

use std::io;

use honami_workbench::scene::control::{Command, Event};
use honami_workbench::store::Project;
use honami_workbench::view;

use super::{Facts, World, failed};
use crate::app::growing::Grower;
use crate::app::update::{Fact, Hint};
use crate::app::viewing::Viewing;
use crate::viewer::Heard;

impl World {
    /// Opens a window; one that is open goes.
    pub(super) fn open_window(&mut self) -> Vec<Fact> {
        self.viewing.take().into_iter().for_each(Viewing::close);
        let grower = Grower::of(&self.session).map_err(|error| error.to_string());
        let opened = grower.and_then(|grower| Viewing::open(grower, self.waker.clone()).map_err(no_thread));
        match opened {
            Ok(viewing) => {
                self.viewing = Some(viewing);
                Vec::new()
            }
            Err(why) => vec![Fact::Window(Heard::Ended(Some(why)))],
        }
    }

    /// Shows it the skeleton as it is now.
    pub(super) fn show_window(&mut self) -> Vec<Fact> {
        let Some(viewing) = &mut self.viewing else { return Vec::new() };
        let grower = Grower::of(&self.session).map_err(|error| error.to_string());
        let shown = grower.and_then(|grower| viewing.show(grower).map_err(no_thread));
        shown.err().map(|why| Fact::Window(Heard::Said(Event::Failed(why)))).into_iter().collect()
    }

    pub(super) fn tell_window(&mut self, command: &Command) -> Vec<Fact> {
        let heard = self.viewing.as_ref().and_then(|viewing| viewing.tell(command));
        heard.map(Fact::Window).into_iter().collect()
    }

    /// Does what was asked for in the window, and says there what has become of it.
    pub(super) fn edit(&mut self, asked: &Event, hint: Hint) -> Vec<Fact> {
        let facts = self.changed(asked, hint).unwrap_or_else(|error| vec![failed(&error), Fact::Refused]);
        let said = facts.iter().rev().find_map(|fact| match fact {
            Fact::Said(notice) => Some(notice),
            _ => None,
        });
        self.viewing.iter_mut().zip(said).for_each(|(viewing, notice)| viewing.answer(notice));
        facts
    }

    fn changed(&mut self, asked: &Event, hint: Hint) -> Facts {
        match asked {
            Event::Undo => self.travel("undone", 1, Project::undo),
            Event::Redo => self.travel("redone", 1, Project::redo),
            asked => match view::transaction(&self.session.project, asked)? {
                Some(transaction) => self.commit(transaction, hint),
                None => Ok(Vec::new()),
            },
        }
    }
}

fn no_thread(error: io::Error) -> String {
    format!("no thread for the viewer: {error}")
}
