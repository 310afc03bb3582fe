//! honami in a terminal: the screen (`term`) and the workbench on it (`app`).

pub mod term;
