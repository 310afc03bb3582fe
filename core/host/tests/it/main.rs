//! The host against real libraries: the zoo (Rust), the bad ones (C), the fossils of ABI 1.0 and 1.1.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
#![expect(clippy::print_stderr, reason = "a test that is skipped says so")]

mod bad;
mod cpp;
mod fossil;
mod hostile;
mod isolated;
mod registry;
mod simulator;
mod state;
mod structure;
mod threads;
mod tools;
mod zoo;
