//! Finds, loads and calls honami plugins.
