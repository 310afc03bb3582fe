//! Simulators through the ABI, in this process and in one of their own.

use crate::tools::{host, isolating, of_zoo};
use honami_host::{
    CallContext, Detail, HostError, Kind, Node, PlantInstance, Simulator, Steps, Value, Values, WindRows,
};

const DT: f64 = 0.125;
const ONE: PlantInstance = PlantInstance { yaw: 0.0, scale: 1.0, mass: 1.0 };
const COPIES: [PlantInstance; 2] = [ONE, PlantInstance { scale: 2.0, mass: 4.0, ..ONE }];
/// A wind for all copies, which rises and falls,
const GUST: WindRows<'static> =
    WindRows { times_s: &[0.0, 0.5, 2.0], velocities: &[[0.0; 3], [4.0, 0.0, 2.0], [0.0, 1.0, 0.0]] };
/// and one that only the second copy feels.
const BEHIND: WindRows<'static> = WindRows { times_s: &[0.0], velocities: &[[0.0; 3], [8.0, 0.0, 0.0]] };

fn stick(n: u32) -> Vec<Node> {
    let node =
        |k: u32| Node { parent: k.checked_sub(1), position: [0.0, 0.0, k as f32], radius: 0.01, track: None };
    (0..n).map(node).collect()
}

fn steps(n: u32, wind: WindRows<'_>) -> Steps<'_> {
    Steps { dt: DT, n, wind, detail: None }
}

fn values(words: &[(&str, f64)]) -> Values {
    words.iter().map(|(id, x)| ((*id).to_owned(), Value::Float(*x))).collect()
}

/// Simulators of the zoo with three nodes in two copies, one in each way of hosting.
fn pendulums() -> [Simulator; 2] {
    let info = of_zoo(Kind::Simulator, "pendulum");
    [host(), isolating()].map(|host| {
        let cx = CallContext::silent();
        let (mut pendulum, _) = host.simulator(&info, &Values::default(), &cx).unwrap();
        let unprepared = pendulum.step(&steps(1, GUST), &cx).expect_err("no plant").to_string();
        assert!(unprepared.contains("has no plant"), "{unprepared}");
        let modes = pendulum.prepare(&stick(3), &COPIES, 1, 0, &cx).unwrap();
        let hz: Vec<_> = modes.iter().map(|mode| (mode.hz, mode.certified)).collect();
        assert_eq!(hz, [(2.0 / std::f64::consts::TAU, true); 3]);
        pendulum
    })
}

fn walk(pendulum: &mut Simulator, parts: &[u32]) -> Vec<[f32; 3]> {
    let cx = CallContext::silent();
    parts.iter().fold(Vec::new(), |_, &n| pendulum.step(&steps(n, GUST), &cx).unwrap().to_vec())
}

#[test]
fn steps_are_the_same_at_once_one_by_one_after_a_reset_and_wherever_it_works() {
    let cx = CallContext::silent();
    let [mut here, mut there] = pendulums();
    for pendulum in [&mut here, &mut there] {
        let still = pendulum.step(&steps(4, WindRows::default()), &cx).unwrap();
        assert_eq!(still, [[0.0; 3]; 6], "still air moves nothing");
        pendulum.reset(&cx).unwrap();
    }
    let wanted = walk(&mut here, &[12]);
    assert!(wanted[0][0] > 0.1 && wanted[0][2] > 0.1 && wanted[3][0] > 0.05, "{wanted:?}");
    assert_eq!(wanted, walk(&mut there, &[12]), "in a process of its own");
    for parts in [&[1; 12][..], &[5, 7], &[0, 12, 0], &[12]] {
        here.reset(&cx).unwrap();
        assert_eq!(wanted, walk(&mut here, parts), "{parts:?}");
    }
}

#[test]
fn every_copy_has_its_own_wind_and_only_what_is_wanted_comes_back() {
    let cx = CallContext::silent();
    for mut pendulum in pendulums() {
        let all = pendulum.step(&steps(1, BEHIND), &cx).unwrap().to_vec();
        let moved = (8.0 / 4.0 * DT * DT) as f32;
        let wanted = [[0.0; 3], [moved, 0.0, 0.0]].map(|d| [d; 3]);
        assert_eq!(all, wanted.as_flattened(), "mass 4 of the second copy; its scale is for who shows it");
        pendulum.reset(&cx).unwrap();
        for [first, second] in [[0, 0], [3, 0], [1, 2], [0, 3]] {
            let detail = [first, second].map(|nodes| Detail { nodes, modes: 0 });
            pendulum.reset(&cx).unwrap();
            let some = pendulum.step(&Steps { detail: Some(&detail), ..steps(1, BEHIND) }, &cx).unwrap();
            let (first, second) = (first as usize, second as usize);
            assert_eq!(some, [&all[..first], &all[3..3 + second]].concat(), "{detail:?}");
        }
    }
}

#[test]
fn what_affects_a_step_changes_in_mid_motion_and_nothing_else_does() {
    let cx = CallContext::silent();
    for mut pendulum in pendulums() {
        let before = walk(&mut pendulum, &[4]);
        pendulum.retune(&values(&[("gust", 0.0)]), &cx).unwrap();
        let gone_on = walk(&mut pendulum, &[1]);
        assert!(gone_on != before && gone_on[0][0] != 0.0, "it goes on from where it was: {gone_on:?}");
        let refused = pendulum.retune(&values(&[("stiffness", 9.0)]), &cx).expect_err("lasting").to_string();
        assert!(refused.contains("cannot change \"stiffness\" in mid-motion"), "{refused}");
        assert!(pendulum.retune(&values(&[("gust", 11.0)]), &cx).is_err(), "out of range");
        walk(&mut pendulum, &[1]);
    }
}

#[test]
fn a_saved_state_goes_on_to_the_same_bits_of_the_same_plant_alone() {
    let cx = CallContext::silent();
    let [mut here, mut there] = pendulums();
    assert!(here.can_save());
    walk(&mut here, &[5]);
    let saved = here.save(&cx).unwrap();
    assert_eq!(saved, here.save(&cx).unwrap(), "the same state, the same bytes");
    let wanted = walk(&mut here, &[7]);
    there.load(&saved, &cx).unwrap();
    assert_eq!(wanted, walk(&mut there, &[7]), "another process goes on from there");
    for bytes in [&saved[..saved.len() - 1], &[], &[7; 400]] {
        let HostError::Failed { text, .. } = here.load(bytes, &cx).expect_err("cut or foreign") else {
            panic!()
        };
        assert!(text.starts_with("what was saved is"), "{text}");
    }
    here.load(&saved, &cx).unwrap();
    assert_eq!(wanted, walk(&mut here, &[7]), "what was refused has changed nothing");
    here.prepare(&stick(4), &COPIES, 1, 0, &cx).unwrap();
    let other = here.load(&saved, &cx).expect_err("of another plant").to_string();
    assert!(other.contains("of other parameters, or of another input"), "{other}");
}

#[test]
fn what_is_no_plant_no_copy_and_no_step_is_said_before_the_plugin_sees_it() {
    let cx = CallContext::silent();
    let [mut pendulum, _] = pendulums();
    let many = [ONE; 20_000];
    let mut orphan = stick(3);
    orphan[2].parent = Some(2);
    let mut adrift = stick(3);
    adrift[1].position[1] = f32::NAN;
    let nowhere = [PlantInstance { scale: 0.0, ..ONE }];
    let plants: [(&[Node], &[PlantInstance], &str); 6] = [
        (&[], &COPIES, "cannot move 2 copies of 0 nodes"),
        (&stick(3), &[], "cannot move 0 copies of 3 nodes"),
        (&orphan, &COPIES, "node 2 has parent Some(2), which does not come before it"),
        (&adrift, &COPIES, "node 1 lies at"),
        (&stick(3), &nowhere, "copy 0 is"),
        (&stick(100_000), &many, "a motion of 22 GiB, at most 16 are possible"),
    ];
    for (nodes, instances, wanted) in plants {
        let said = pendulum.prepare(nodes, instances, 1, 0, &cx).expect_err(wanted).to_string();
        assert!(said.contains(wanted), "{said}");
    }
    pendulum.prepare(&stick(3), &COPIES, 1, 0, &cx).unwrap();
    let rows = |times_s, velocities| WindRows { times_s, velocities };
    let detail = [Detail { nodes: 4, modes: 0 }; 2];
    let walks = [
        (Steps { dt: 0.0, ..steps(1, GUST) }, "cannot go 1 steps of 0 s"),
        (Steps { dt: f64::NAN, ..steps(1, GUST) }, "cannot go 1 steps of NaN s"),
        (steps(1, rows(&[0.0, 1.0], &[[0.0; 3]; 3])), "3 rows of wind for 2 times and 2 copies"),
        (steps(1, rows(&[0.0], &[[f32::NAN; 3]])), "wind that is not finite: row 0"),
        (steps(1, rows(&[1.0, 1.0], &[[0.0; 3]; 2])), "wind whose times do not rise"),
        (Steps { detail: Some(&detail[..1]), ..steps(1, GUST) }, "the detail of 1 copies of 2"),
        (Steps { detail: Some(&detail), ..steps(1, GUST) }, "asked for 4 nodes of copy 0, which has 3"),
    ];
    for (steps, wanted) in walks {
        let said = pendulum.step(&steps, &cx).expect_err(wanted).to_string();
        assert!(said.contains(wanted), "{said}");
    }
    walk(&mut pendulum, &[1]);
}

#[test]
fn a_step_that_is_too_long_names_the_longest_and_motion_that_is_none_ends_it() {
    let cx = CallContext::silent();
    for mut pendulum in pendulums() {
        let said =
            pendulum.step(&Steps { dt: 1.5, ..steps(1, GUST) }, &cx).expect_err("unstable").to_string();
        assert!(said.contains("a step is at most 1 s, not 1.5"), "{said}");
    }
    for mut pendulum in pendulums() {
        pendulum.retune(&values(&[("gust", 10.0)]), &cx).unwrap();
        let storm = WindRows { times_s: &[0.0], velocities: &[[f32::MAX, 0.0, 0.0]] };
        let said = pendulum.step(&steps(9, storm), &cx).expect_err("overflow");
        assert!(
            matches!(&said, HostError::Misbehaved { what, .. } if what == "row 0 of the motion is not finite")
        );
    }
}
