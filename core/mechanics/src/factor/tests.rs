//! The factors against whole matrices.

use super::{Factor, Flexibility};
use crate::six::DOF;
use crate::tree_matrix::TreeMatrix;
use crate::{Beams, Options};
use honami_model::plant::{Node, Plant};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

fn beams(seed: u64) -> Beams {
    Beams::new(&honami_synth::tree(14, seed).unwrap(), &Options::default()).unwrap()
}

/// All numbers of a matrix, zeros too.
fn whole(matrix: &TreeMatrix) -> DMatrix<f64> {
    let height = DOF * matrix.len();
    let mut whole = DMatrix::zeros(height, height);
    for (k, mut column) in whole.column_iter_mut().enumerate() {
        let unit: Vec<f64> = (0..height).map(|row| f64::from(u8::from(row == k))).collect();
        matrix.times(&unit, column.as_mut_slice());
    }
    whole
}

/// Eigenvalues of K x = lambda M x, ascending.
fn eigenvalues(stiffness: &DMatrix<f64>, mass: &DMatrix<f64>) -> Vec<f64> {
    let lower = mass.clone().cholesky().unwrap().l();
    let half = lower.solve_lower_triangular(stiffness).unwrap();
    let both = lower.solve_lower_triangular(&half.transpose()).unwrap();
    let mut lambdas: Vec<f64> =
        ((&both + both.transpose()) * 0.5).symmetric_eigenvalues().iter().copied().collect();
    lambdas.sort_by(f64::total_cmp);
    lambdas
}

#[test]
fn negative_pivots_count_the_eigenvalues_below_any_shift() {
    for seed in 1..4 {
        let beams = beams(seed);
        let (flexibility, mass) = (Flexibility::new(&beams), beams.mass());
        let lambdas = eigenvalues(&whole(&beams.stiffness()), &whole(&mass));
        // The highest are of stretching, where a whole matrix has digits to spare.
        for below in 0..lambdas.len() {
            let before = below.checked_sub(1).map_or(0.0, |k| lambdas[k]);
            if lambdas[below] < before * (1.0 + 1e-6) {
                continue;
            }
            let between = f64::midpoint(before, lambdas[below]);
            let factor = Factor::new(&flexibility, &mass, between).unwrap();
            assert_eq!(factor.n_negative(), below, "seed {seed}, below {between}");
        }
    }
}

#[test]
fn a_solution_solves_with_and_without_a_shift() {
    let beams = beams(5);
    let (stiffness, mass) = (whole(&beams.stiffness()), beams.mass());
    for shift in [0.0, 40.0, 3e4] {
        let factor = Factor::new(&Flexibility::new(&beams), &mass, shift).unwrap();
        let wanted = DVector::from_fn(stiffness.nrows(), |row, _| (row as f64 * 0.7).sin());
        let right = (&stiffness - whole(&mass) * shift) * &wanted;
        let mut got = right.as_slice().to_vec();
        factor.solve(&mut got);
        let off = (DVector::from_vec(got) - &wanted).norm() / wanted.norm();
        // The right side has lost digits to stretching, which is stiff; the factors have not.
        assert!(off < 1e-7, "shift {shift}: {off:e}");
    }
}

#[test]
fn columns_that_are_solved_together_are_those_solved_alone() {
    let beams = beams(6);
    let factor = Factor::new(&Flexibility::new(&beams), &beams.mass(), 25.0).unwrap();
    let n = DOF * (beams.len() - 1);
    let three: Vec<f64> = (0..3 * n).map(|k| (k as f64 * 1.3).cos()).collect();
    let mut together = three.clone();
    factor.solve(&mut together);
    for (column, got) in three.chunks(n).zip(together.chunks(n)) {
        let mut alone = column.to_vec();
        factor.solve(&mut alone);
        let size = alone.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(alone.iter().zip(got).all(|(a, b)| (a - b).abs() < 1e-12 * size));
    }
}

/// F L^3 / 3 E I, and the tip turns by F L^2 / 2 E I.
#[test]
fn a_load_at_its_tip_bends_a_rod_as_statics_says() {
    let n = 16_u32;
    let node = |k: u32| Node {
        parent: k.checked_sub(1),
        position: [f64::from(k) / f64::from(n), 0.0, 0.0],
        radius: 0.02,
    };
    let plant = Plant::new((0..=n).map(node).collect()).unwrap();
    let beams = Beams::new(&plant, &Options::default()).unwrap();
    let factor = Factor::new(&Flexibility::new(&beams), &beams.mass(), 0.0).unwrap();
    let mut bent = vec![0.0; DOF * n as usize];
    let tip = DOF * (n as usize - 1);
    bent[tip + 2] = 3.0;
    factor.solve(&mut bent);
    let stiff = Options::default().material.young * PI * 0.02_f64.powi(4) / 4.0;
    let (down, turned) = (bent[tip + 2] * stiff, -bent[tip + 4] * stiff);
    assert!((down - 1.0).abs() < 1e-9 && (turned - 1.5).abs() < 1e-9, "{down} {turned}");
}
