//! Which line is looked at while others come and go.

use super::*;

fn lines(n: usize) -> impl Iterator<Item = Print> {
    let print =
        |n: usize| Print { frame: None, plugin: String::new(), level: Level::Info, text: n.to_string() };
    (0..n).map(print)
}

#[test]
fn a_line_stays_in_sight_until_it_is_gone_and_the_newest_is_followed() {
    let mut prints = Prints::default();
    assert_eq!(prints.current(), None);
    prints.add(lines(3));
    assert_eq!(prints.current(), Some(2));
    prints.look_at(1);
    prints.add(lines(4));
    assert_eq!(prints.current(), Some(1));
    prints.look_at(6);
    prints.add(lines(1));
    assert_eq!(prints.current(), Some(7), "the newest is followed");
    prints.look_at(4);
    prints.add(lines(N_KEPT - 6));
    assert_eq!((prints.lines().len(), prints.current()), (N_KEPT, Some(2)), "two have gone");
    prints.add(lines(N_KEPT));
    assert_eq!(prints.current(), Some(0), "it has gone, too");
}
