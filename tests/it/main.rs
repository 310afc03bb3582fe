//! End-to-end tests: the real program, the real plugins, the workspace itself.
#![expect(clippy::unwrap_used, reason = "a failed step of a test is a failed test")]

mod checked;
mod cli;
mod compare;
mod dense;
mod edit;
mod exchange;
mod faults;
mod grow;
mod home;
mod isolated;
mod journal_kill;
mod locks;
mod offers;
mod opencv;
mod outlived;
mod plants;
mod plants_bending;
mod plants_glb;
mod plants_refused;
mod plants_round;
mod python;
mod real_clips;
mod rebuilt;
mod replay;
mod retrack;
mod rigs;
mod schema;
mod sdk;
mod settings;
mod shaped;
mod simulated;
mod stopped;
mod tidy;
mod trax;
mod wrong;
