//! honami in a terminal: the screen (`term`), the workbench on it (`app`), and the command line (`cli`).

pub mod app;
mod braille;
pub mod cli;
mod scale;
pub mod term;
mod viewer;
