//! The basis against statics.

use super::{AIR, Drag, WindBasis};
use crate::{Beams, Material, Modes, Options};
use honami_model::plant::{Node, Plant};
use nalgebra::Vector3;
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

/// Deflection of the tip under a uniform load is q L^4 / 8 EI; of the first few modes somewhat more or less.
#[test]
fn modes_in_uniform_wind_add_up_to_the_deflection_of_statics() {
    let beams = rod(40);
    let modes = Modes::new(&beams, 90, 1).unwrap();
    let basis = WindBasis::new(&beams, &modes, &Drag { density: 1.5, branches: 0.8, ..Drag::default() });
    let wind = Vector3::new(3.0, 4.0, 0.0);
    let pressure = 0.5 * 1.5 * 0.8 * 2.0 * RADIUS * wind.norm();
    let wanted = pressure * wind / (8.0 * Material::default().young * PI * RADIUS.powi(4) / 4.0);
    let mut tip = Vector3::zeros();
    let mut bending = 0;
    for mode in 0..modes.len() {
        let deflection = basis.force(mode, &wind) / modes.omegas[mode].powi(2) * modes.displacement(mode, 40);
        if deflection.norm() < 1e-12 * wanted.norm() {
            continue;
        }
        tip += deflection;
        bending += 1;
        let ratio = tip.dot(&wanted) / wanted.norm_squared();
        // Each bending comes in two planes, of which the wind moves one or both.
        let known = [(2, 1.013_4), (4, 0.999_09), (6, 1.000_16), (10, 1.000_014_7), (20, 0.999_998_5)];
        if let Some((_, wanted)) = known.iter().find(|(n, _)| *n == bending) {
            assert!((ratio - wanted).abs() < 2e-4, "{bending} modes: {ratio}");
        }
    }
    assert!((tip - wanted).norm() < 3e-6 * wanted.norm(), "{tip} {wanted}");
}

/// A wind that moves with the branch does nothing: the force is the square of their difference.
#[test]
fn damping_is_how_the_force_falls_with_the_speed_of_the_branch() {
    let beams = Beams::new(&honami_synth::tree(60, 3).unwrap(), &Options::default()).unwrap();
    let modes = Modes::new(&beams, 5, 1).unwrap();
    let basis = WindBasis::new(
        &beams,
        &modes,
        &Drag { branches: 1.2, leaves: vec![(7, 0.3), (30, 0.1)], ..Drag::default() },
    );
    let (wind, step) = (Vector3::new(5.0, -2.0, 1.0), 1e-5);
    for mode in 0..5 {
        // The force on mode i while it moves at speed q': the integral of C D |v - phi q'| (v - phi q') . phi, by points.
        let force = |speed: f64| {
            let mut sum = 0.0;
            for (base, tip, section, direction) in beams.segments() {
                let ends =
                    [base, tip].map(|node| (modes.displacement(mode, node), modes.rotation(mode, node)));
                for (share, weight) in super::GAUSS {
                    let moved = super::between(share, section.length, &direction, ends);
                    let relative = wind - moved * speed;
                    let scale = 0.5 * AIR * 1.2 * 2.0 * section.radius * weight * section.length;
                    sum += scale * relative.norm() * relative.dot(&moved);
                }
            }
            for (node, area) in [(7, 0.3), (30, 0.1)] {
                let moved = modes.displacement(mode, node);
                let relative = wind - moved * speed;
                sum += 0.5 * AIR * area * relative.norm() * relative.dot(&moved);
            }
            sum
        };
        let wanted = (force(-step) - force(step)) / (2.0 * step);
        let got = basis.damping(mode, &wind);
        assert!((got / wanted - 1.0).abs() < 1e-6, "{mode}: {got} {wanted}");
        assert!((basis.force(mode, &wind) / force(0.0) - 1.0).abs() < 1e-12);
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
