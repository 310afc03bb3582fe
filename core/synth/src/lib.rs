//! Clips with known truth.
