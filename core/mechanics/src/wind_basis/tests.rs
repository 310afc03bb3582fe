//! The basis against statics, closed forms of a rod, and sums of many small parts.

use super::{AIR, Drag, WindBasis};
use crate::element::{frame, tests::shape};
use crate::{Beams, Material, Modes, Options};
use honami_model::plant::{Node, Plant};
use nalgebra::{SVector, Vector3};
use std::f64::consts::PI;

const RADIUS: f64 = 0.02;

fn rod(n: u32) -> Beams {
    let node = |k: u32| Node {
        parent: k.checked_sub(1),
        position: [0.0, 0.0, f64::from(k) / f64::from(n)],
        radius: RADIUS,
    };
    Beams::new(&Plant::new((0..=n).map(node).collect()).unwrap(), &Options::default()).unwrap()
}

/// Of a clamped rod, bending by bending: the root b of cos b cosh b = -1, and s = (sinh b - sin b) / (cosh b + cos b).
fn bendings() -> impl Iterator<Item = (f64, f64)> {
    (0..).map(|r| {
        // Nearly odd quarters of a turn; a few steps of Newton's find what is left.
        let mut b = (f64::from(r) + 0.5) * PI;
        for _ in 0..20 {
            let (value, slope) = (b.cos() + 1.0 / b.cosh(), -b.sin() - b.tanh() / b.cosh());
            b -= value / slope;
        }
        (b, (b.sinh() - b.sin()) / (b.cosh() + b.cos()))
    })
}

/// Deflection of the tip under a uniform load is q L^4 / 8 EI, to which a bending gives 32 s / b^5 of itself, one up, the next
/// down.
#[test]
fn modes_in_uniform_wind_add_up_to_the_deflection_of_statics() {
    let beams = rod(40);
    let modes = Modes::new(&beams, 30, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag { density: 1.5, branches: 0.8, ..Drag::default() });
    let wind = Vector3::new(3.0, 4.0, 0.0);
    let pressure = 0.5 * 1.5 * 0.8 * 2.0 * RADIUS * wind.norm();
    let wanted = pressure * wind / (8.0 * Material::default().young * PI * RADIUS.powi(4) / 4.0);
    // Each bending comes in two planes, of which the wind moves one or both: all of one frequency together.
    let mut tips: Vec<(f64, Vector3<f64>)> = Vec::new();
    for (mode, omega) in modes.omegas.iter().enumerate() {
        let tip = basis.force(mode, &wind) / omega.powi(2) * modes.displacement(mode, 40);
        match tips.last_mut() {
            Some((last, sum)) if (omega / *last - 1.0).abs() < 1e-6 => *sum += tip,
            _ => tips.push((*omega, tip)),
        }
    }
    // Of the last there may be one more.
    tips.pop();
    tips.retain(|(_, tip)| tip.norm() > 1e-12 * wanted.norm());
    let (mut tip, mut ratio) = (Vector3::zeros(), 0.0);
    assert!(tips.len() > 8, "{}", tips.len());
    for (r, ((_, part), (b, s))) in tips.iter().zip(bendings()).enumerate() {
        tip += part;
        ratio += if r % 2 == 0 { 32.0 } else { -32.0 } * s / b.powi(5);
        assert!(
            (tip - ratio * wanted).norm() < 1e-9 * wanted.norm(),
            "{r}: {tip} {ratio} {:e}",
            (tip - ratio * wanted).norm() / wanted.norm()
        );
    }
}

/// Of a rod whose every bending has mass 1: p = (rho C d / 2) 2 s L / b / sqrt(m L) across it, and T is rho C d / 2 m in its
/// plane, whatever the bending.
#[test]
fn a_rod_has_the_basis_of_its_closed_form() {
    let beams = rod(40);
    let modes = Modes::new(&beams, 20, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    let (per_metre, heavy) = (0.5 * AIR * 2.0 * RADIUS, Material::default().density * PI * RADIUS.powi(2));
    let mut bent = 0;
    for mode in 0..modes.len() {
        let (force, tensor, moved) = (basis.forces[mode], basis.dampings[mode], modes.displacement(mode, 40));
        // Twisted, it has nothing that the wind could press on.
        if moved.norm() < 1e-6 * modes.rotation(mode, 40).norm() {
            assert!(force.norm() < 1e-12 && tensor.norm() < 1e-12, "{mode}: {force} {tensor}");
            continue;
        }
        assert!((tensor.trace() * heavy / per_metre - 1.0).abs() < 1e-12, "{mode}: {tensor}");
        if moved.z.abs() < 1e-6 * moved.norm() {
            let (b, s) = bendings().nth(bent / 2).unwrap();
            let wanted = per_metre * 2.0 * s / b / heavy.sqrt();
            // Cubics on 40 segments come as near as the sixth power of a segment's share in a wave.
            let near = 1e-11 + 2e-4 * (b / 40.0).powi(6);
            assert!((force.norm() / wanted - 1.0).abs() < near, "{mode}: {force} {wanted}");
            bent += 1;
        }
    }
    assert!(bent > 12, "{bent}");
}

/// A wind that moves with the branch does nothing: the force is the square of their difference, here on many small parts of
/// every segment, each where the shape functions of 6.4 have it.
#[test]
fn damping_is_how_the_force_falls_with_the_speed_of_the_branch() {
    let beams = Beams::new(&honami_synth::tree(60, 3).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 5, 1).unwrap();
    let leaves = vec![(7, 0.3), (30, 0.1)];
    let basis = WindBasis::new(&beams, &modes, &Drag { density: 1.5, branches: 1.2, leaves: leaves.clone() });
    let (wind, step, n) = (Vector3::new(5.0, -2.0, 1.0), 1e-5, 40_u32);
    for mode in 0..5 {
        // How parts move a unit of the amplitude, and 1/2 rho C d of each.
        let mut parts: Vec<(Vector3<f64>, f64)> = Vec::new();
        for (base, tip, section, direction) in beams.segments() {
            let frame = frame(&direction);
            let mut ends = SVector::<f64, 12>::zeros();
            for (first, node) in [(0, base), (6, tip)] {
                let own = [modes.displacement(mode, node), modes.rotation(mode, node)]
                    .map(|v| frame.transpose() * v);
                ends.fixed_rows_mut::<3>(first).copy_from(&own[0]);
                ends.fixed_rows_mut::<3>(first + 3).copy_from(&own[1]);
            }
            for k in 0..=n {
                // Simpson's.
                let weight = if k == 0 || k == n {
                    1.0
                } else if k % 2 == 1 {
                    4.0
                } else {
                    2.0
                } / f64::from(3 * n);
                let moved = shape(f64::from(k) / f64::from(n), section.length) * ends;
                let area = 0.5 * 1.5 * 1.2 * 2.0 * section.radius * weight * section.length;
                parts.push((frame * moved.fixed_rows::<3>(0), area));
            }
        }
        parts.extend(leaves.iter().map(|(node, area)| (modes.displacement(mode, *node), 0.5 * 1.5 * area)));
        let force = |speed: f64| {
            let on = |(moved, area): &(Vector3<f64>, f64)| {
                let relative = wind - moved * speed;
                area * relative.norm() * relative.dot(moved)
            };
            parts.iter().map(on).sum::<f64>()
        };
        let wanted = (force(-step) - force(step)) / (2.0 * step);
        let got = basis.damping(mode, &wind);
        assert!((got / wanted - 1.0).abs() < 1e-9, "{mode}: {got} {wanted}");
        assert!((basis.force(mode, &wind) / force(0.0) - 1.0).abs() < 1e-13, "{mode}");
    }
}

#[test]
fn still_air_damps_nothing() {
    let beams = rod(4);
    let modes = Modes::new(&beams, 2, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag::default());
    assert!(basis.damping(0, &Vector3::zeros()).abs() < f64::MIN_POSITIVE);
    assert!(basis.force(0, &Vector3::zeros()).abs() < f64::MIN_POSITIVE);
}
