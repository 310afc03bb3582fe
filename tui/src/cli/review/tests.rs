//! The table as people read it.

use honami_workbench::review::Reasons;

use super::*;

#[test]
fn suspicions_near_1_are_told_apart() {
    for (p, want) in [
        (0.2, "0.20"),
        (0.994, "0.99"),
        (0.996, "0.9960"),
        (0.999_91, "0.9999"),
        (0.999_97, "0.999970"),
        (1.0, ">.999999"),
    ] {
        assert_eq!(suspicion(p), want);
    }
}

#[test]
fn the_legend_has_every_code() {
    for code in Reasons::CODES {
        assert!(LEGEND.contains(&format!("{code}: ")), "{code}");
    }
}
