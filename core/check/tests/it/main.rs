//! Bad plugins, each with one fault, and the check that must find it; good ones, which pass.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
#![expect(clippy::print_stderr, reason = "a test that is skipped says so")]

mod faults;
mod good;
mod tools;
