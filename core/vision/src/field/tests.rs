//! Sampling against fields that bilinear sampling meets exactly, and points carried round a centre.

use super::*;

/// A picture of this size.
fn blank(width: u32, height: u32) -> Gray<'static> {
    Gray::packed(&[0; 50 * 50][..(width * height) as usize], width, height)
}

/// A field that is a function of the position, known everywhere.
fn field(grid: Grid, motion: impl Fn(Point) -> [f32; 2]) -> Field {
    Field::new(grid, grid.nodes().map(|node| Some(motion(node))))
}

#[test]
fn a_grid_is_as_far_from_either_edge() {
    for (width, height, step, want) in [
        (10, 5, 1, ([0.0, 0.0], 10, 5)),
        (10, 7, 3, ([0.0, 0.0], 4, 3)),
        (9, 8, 4, ([0.0, 1.5], 3, 2)),
        (3, 2, 10, ([1.0, 0.5], 1, 1)),
        (1, 1, 0, ([0.0, 0.0], 1, 1)),
    ] {
        let grid = Grid::over(width, height, step);
        assert_eq!((grid.origin, grid.nx, grid.ny), want, "{width}x{height} every {step}");
        let last = grid.node(grid.nx - 1, grid.ny - 1);
        assert_eq!((width as f32 - 1.0 - last[0], height as f32 - 1.0 - last[1]), want.0.into());
        assert_eq!(grid.nodes().count(), grid.len());
    }
}

#[test]
fn a_bilinear_field_is_met_exactly_and_goes_on_beyond_the_outermost_nodes() {
    let motion = |[x, y]: Point| [1.0 + 0.25 * x - 0.5 * y, -2.0 + x * y / 64.0];
    let grid = Grid::over(33, 25, 4);
    let field = field(grid, motion);
    for at in [[0.0, 0.0], [5.0, 7.0], [4.0, 8.0], [31.5, 23.25], [32.0, 24.0]] {
        let [u, v] = field.at(at).unwrap();
        let want = motion(at);
        assert!((u - want[0]).abs() < 1e-4 && (v - want[1]).abs() < 1e-4, "{at:?}: {u} {v} for {want:?}");
    }
    assert_eq!(field.at([-9.0, 4.0]), field.at([0.0, 4.0]));
    assert_eq!(field.at([8.0, 1e9]), field.at([8.0, 24.0]));
    assert_eq!(field.at([f32::NAN, 4.0]), None);
}

#[test]
fn what_is_not_known_leaves_its_weight_to_what_is() {
    let grid = Grid { origin: [0.0; 2], step_px: 2.0, nx: 2, ny: 1 };
    let field = Field::new(grid, [Some([3.0, -1.0]), None]);
    assert_eq!(field.at([0.5, 0.0]), Some([3.0, -1.0]));
    assert_eq!(field.at([1.0, 0.0]), Some([3.0, -1.0]));
    assert_eq!(field.at([1.5, 0.0]), None);
    let field = Field::new(grid, [Some([f32::NAN, 1.0]), Some([f32::INFINITY, 1.0])]);
    assert_eq!((field.known, field.u, field.v), (vec![false; 2], vec![0.0; 2], vec![0.0; 2]));
}

#[test]
fn points_follow_leave_and_are_lost() {
    let grid = Grid::over(20, 10, 1);
    let mut field = field(grid, |_| [4.0, 0.0]);
    field.known[5 * 20 + 7] = false;
    assert_eq!(field.follow([3.25, 2.0], &blank(20, 10)), Drift::To([7.25, 2.0]));
    assert_eq!(field.follow([7.0, 5.0], &blank(20, 10)), Drift::Unknown);
    assert_eq!(field.follow([16.0, 5.0], &blank(20, 10)), Drift::Outside);
    assert_eq!(field.follow([-2.0, 5.0], &blank(20, 10)), Drift::Outside);
    assert_eq!(field.follow([f32::NAN, 5.0], &blank(20, 10)), Drift::Outside);
}

#[test]
fn a_point_carried_round_comes_back() {
    const STEPS: usize = 60;
    let (sin, cos) = (std::f32::consts::TAU / STEPS as f32).sin_cos();
    let turn = |[x, y]: Point| {
        let (x, y) = (x - 20.0, y - 20.0);
        [cos * x - sin * y - x, sin * x + cos * y - y]
    };
    let field = field(Grid::over(41, 41, 4), turn);
    let mut at = [31.0, 20.0];
    for _ in 0..STEPS {
        let Drift::To(to) = field.follow(at, &blank(41, 41)) else { panic!("lost at {at:?}") };
        at = to;
    }
    assert!((at[0] - 31.0).hypot(at[1] - 20.0) < 1e-3, "{at:?}");
}
