//! What the screen says of plugins at work.

use super::check;
use crate::app::fixture;

#[test]
fn what_plugins_print() {
    check("prints_80x24", (80, 24), "P o", fixture::prints);
    check("prints_120x40", (120, 40), "P o P w", fixture::prints);
}
