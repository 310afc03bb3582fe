//! Memory with guards: bytes lie at the edge that was asked for, and nothing may touch what is behind it.

use super::{Edge, Guarded};

#[test]
fn the_bytes_lie_at_the_edge_that_was_asked_for() {
    let page = rustix::param::page_size();
    for len in [1, 7, page - 1, page, page + 1] {
        let bytes: Vec<u8> = (0..len).map(|k| (k % 251) as u8).collect();
        let [front, back] = [Edge::Front, Edge::Back].map(|edge| Guarded::new(&bytes, edge).unwrap());
        assert_eq!((front.bytes(), back.bytes()), (&*bytes, &*bytes));
        assert_eq!(front.bytes().as_ptr() as usize % page, 0, "{len} bytes from the front");
        assert_eq!(back.bytes().as_ptr_range().end as usize % page, 0, "{len} bytes to the back");
    }
}
