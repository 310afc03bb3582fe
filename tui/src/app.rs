//! The workbench in a terminal: one state, actions in one table, a pure update, drawing, effects.
//!
//! `state` knows nothing of the terminal device and nothing of files; `update` turns a message into the next state
//! and the effects it asks for; `view` draws a state; `effects` is the only door to the project, the clip and
//! the plugins; `run` turns the wheel; `door` leads from one project to the next, by way of the start screen.

pub mod action;
pub mod before;
mod behind;
pub mod clock;
pub mod command_log;
pub mod config;
pub mod correcting;
pub mod dense;
pub mod door;
mod effects;
pub mod files;
#[cfg(test)]
mod fixture;
pub mod forest;
pub mod form;
mod fuzzy;
pub mod groups;
mod growing;
mod history;
pub mod in_space;
mod jobs;
pub mod keymap;
mod labels;
mod late;
pub mod layout;
pub mod lesson;
pub mod menu;
pub mod motion;
mod offering;
pub mod opening;
mod pace;
pub mod painting;
pub mod panel;
mod pictures;
pub mod plotted;
pub mod prints;
pub mod queue;
pub mod ranging;
mod rebuilding;
pub mod recent;
pub mod recovery;
mod replay;
mod reviewing;
mod run;
pub mod scaling;
mod seat;
pub mod skeleton;
pub mod sketching;
pub mod start;
pub mod state;
mod stills;
mod tally;
pub mod tracks;
pub mod typing;
pub mod update;
pub mod versus;
pub mod view;
mod viewing;
pub mod window;

pub use door::{Gives, Offer, Offers, forest as run_forest, run};
pub use opening::Plan;
pub use replay::{Replay, replay};
