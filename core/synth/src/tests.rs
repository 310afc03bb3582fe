//! Tests of scenes as a whole.
