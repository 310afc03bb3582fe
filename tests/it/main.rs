//! End-to-end tests: the real program, the real plugins, the workspace itself.
#![expect(clippy::unwrap_used, reason = "a failed step of a test is a failed test")]

mod tidy;
