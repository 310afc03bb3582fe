//! Cells of the thesis's tables, for whoever measures them: `honami bench forest`, and `cargo xtask bench forest`, which takes
//! this file as it is.

/// A cell: copies, nodes, modes, and the frames per second that the thesis has (GeForce 8800 GTS; table 6.2 with
/// rendering).
pub type Cell = (usize, usize, usize, Option<f64>);

/// Table 6.1: 25 modes, without rendering.
pub const TABLE_6_1: [Cell; 13] = [
    (100, 1000, 25, Some(712.0)),
    (100, 2000, 25, Some(385.0)),
    (100, 8000, 25, Some(103.0)),
    (1000, 100, 25, Some(690.0)),
    (1000, 500, 25, Some(169.0)),
    (1000, 1000, 25, Some(87.0)),
    (1000, 2000, 25, Some(43.0)),
    (1000, 8000, 25, Some(11.0)),
    (8000, 20, 25, Some(426.0)),
    (8000, 100, 25, Some(102.0)),
    (8000, 500, 25, Some(21.0)),
    (8000, 1000, 25, Some(11.0)),
    (10_000, 3437, 25, None),
];

/// Table 6.2: 3437 nodes.
pub const TABLE_6_2: [Cell; 12] = [
    (500, 3437, 5, Some(73.0)),
    (1000, 3437, 5, Some(39.0)),
    (2000, 3437, 5, Some(19.0)),
    (4000, 3437, 5, Some(10.0)),
    (500, 3437, 15, Some(57.0)),
    (1000, 3437, 15, Some(29.0)),
    (2000, 3437, 15, Some(14.0)),
    (4000, 3437, 15, Some(7.0)),
    (500, 3437, 25, Some(43.0)),
    (1000, 3437, 25, Some(22.0)),
    (2000, 3437, 25, Some(11.0)),
    (4000, 3437, 25, Some(6.0)),
];
