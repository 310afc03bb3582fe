//! Fits whose answers are known otherwise.

use nalgebra::{DMatrix, DVector, Vector2};

use super::*;
use crate::staged::Noise;

/// Curves `y = a exp(b t) + c_i`, with b shared by all and a and c each curve's own; the other coordinate is their slope at 0.
#[derive(Clone)]
struct Curves {
    b: f64,
    own: Vec<[f64; 2]>,
    data: Vec<Vec<(f64, Vector2<f64>)>>,
}

impl Curves {
    fn at(a: f64, b: f64, c: f64, t: f64) -> Vector2<f64> {
        Vector2::new(a * (b * t).exp() + c, a * b)
    }

    fn truth(noise: &mut Noise) -> Self {
        let own: Vec<[f64; 2]> = (0..5).map(|i| [1.0 + 0.3 * f64::from(i), 4.0 - f64::from(i)]).collect();
        let times = || (0..12).map(|k| f64::from(k) * 0.1);
        let curve = |&[a, c]: &[f64; 2]| times().map(|t| (t, Self::at(a, -1.5, c, t))).collect();
        let mut data: Vec<Vec<(f64, Vector2<f64>)>> = own.iter().map(curve).collect();
        data.iter_mut().flatten().for_each(|(_, y)| *y += noise.pixel());
        Self { b: -1.5, own, data }
    }
}

impl Problem for Curves {
    fn n_shared(&self) -> usize {
        1
    }

    fn n_own(&self) -> usize {
        2
    }

    fn n_blocks(&self) -> usize {
        self.own.len()
    }

    fn block(&self, i: usize) -> Option<Block> {
        let ([a, c], b) = (self.own[i], self.b);
        let mut block = Block::zeros(self.data[i].len(), 1, 2);
        for (k, &(t, y)) in self.data[i].iter().enumerate() {
            let grown = (b * t).exp();
            block.offsets[k] = Self::at(a, b, c, t) - y;
            block.by_shared[(2 * k, 0)] = a * t * grown;
            block.by_shared[(2 * k + 1, 0)] = a;
            (block.by_own[(2 * k, 0)], block.by_own[(2 * k, 1)]) = (grown, 1.0);
            block.by_own[(2 * k + 1, 0)] = b;
        }
        Some(block)
    }

    fn stepped(&self, shared: &DVector<f64>, own: &[DVector<f64>]) -> Self {
        let mut next = self.clone();
        next.b += shared[0];
        for (numbers, step) in next.own.iter_mut().zip(own) {
            *numbers = [numbers[0] + step[0], numbers[1] + step[1]];
        }
        next
    }
}

fn far_off(mut curves: Curves) -> Curves {
    curves.b = -0.2;
    curves.own.iter_mut().for_each(|own| *own = [0.5, 0.0]);
    curves
}

#[test]
fn exact_data_are_met_from_afar() {
    let truth = Curves::truth(&mut Noise::new(1, 0.0));
    for loss in [Loss::Squares, Loss::Huber(0.1), Loss::Cauchy(1.0)] {
        let fitted = fit(far_off(truth.clone()), loss).unwrap();
        assert!((fitted.problem.b + 1.5).abs() < 1e-9, "{loss:?}: {}", fitted.problem.b);
        assert!(fitted.sigma_px < 1e-9);
    }
}

/// All parameters in one dense matrix: b, then a and c of each curve.
fn dense(curves: &Curves) -> (DMatrix<f64>, DVector<f64>) {
    let n = 1 + 2 * curves.own.len();
    let (mut normal, mut slope) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for i in 0..curves.own.len() {
        let block = curves.block(i).unwrap();
        let mut rows = DMatrix::zeros(2 * block.offsets.len(), n);
        rows.view_mut((0, 0), block.by_shared.shape()).copy_from(&block.by_shared);
        rows.view_mut((0, 1 + 2 * i), block.by_own.shape()).copy_from(&block.by_own);
        let offsets = DVector::from_iterator(rows.nrows(), block.offsets.iter().flat_map(|o| [o.x, o.y]));
        normal += rows.transpose() * &rows;
        slope += rows.transpose() * offsets;
    }
    (normal, slope)
}

#[test]
fn the_arrow_is_solved_as_the_whole_matrix_is() {
    let noisy = Curves::truth(&mut Noise::new(2, 0.05));
    let fitted = fit(far_off(noisy), Loss::Squares).unwrap();
    let (normal, slope) = dense(&fitted.problem);
    assert!(slope.norm() < 1e-5, "at rest: {slope}");
    let covariance = normal.try_inverse().unwrap();
    assert!((fitted.shared[(0, 0)] / covariance[(0, 0)] - 1.0).abs() < 1e-9);
    for (i, own) in fitted.own.iter().enumerate() {
        let wanted = covariance.view((1 + 2 * i, 1 + 2 * i), (2, 2));
        assert!((own - wanted).norm() < 1e-9 * wanted.norm(), "{own} {wanted}");
    }
}

#[test]
fn standard_errors_are_those_of_many_trials() {
    let (mut squares, mut told, mut sigmas) = (0.0, 0.0, 0.0);
    let n = 400;
    for seed in 0..n {
        let fitted = fit(Curves::truth(&mut Noise::new(seed, 0.05)), Loss::Squares).unwrap();
        squares += (fitted.problem.b + 1.5).powi(2);
        told += fitted.sigma_px.powi(2) * fitted.shared[(0, 0)];
        sigmas += fitted.sigma_px.powi(2);
    }
    // Of 400 trials a standard deviation is known to 3.5 %.
    assert!((squares / told - 1.0).abs() < 0.2, "{}", squares / told);
    assert!(((sigmas / n as f64).sqrt() / 0.05 - 1.0).abs() < 0.02);
}

#[test]
fn robust_losses_bear_gross_errors_and_squares_do_not() {
    let mut data = Curves::truth(&mut Noise::new(3, 0.01));
    for curve in &mut data.data {
        curve[11].1.x += 5.0;
    }
    let error = |loss| (fit(data.clone(), loss).unwrap().problem.b + 1.5).abs();
    assert!(error(Loss::Squares) > 0.2, "{}", error(Loss::Squares));
    assert!(error(Loss::Huber(0.03)) < 0.08, "{}", error(Loss::Huber(0.03)));
    assert!(error(Loss::Cauchy(0.03)) < 0.03, "{}", error(Loss::Cauchy(0.03)));
}

#[test]
fn losses_are_squares_near_nought_and_their_weights_are_their_slopes() {
    for loss in [Loss::Squares, Loss::Huber(0.7), Loss::Cauchy(0.7)] {
        assert!((loss.cost(1e-8) / 1e-8 - 1.0).abs() < 1e-6);
        assert!(loss.weight(0.0) > 0.999_999 && loss.weight(0.0) < 1.000_001);
        for squared in [0.01_f64, 0.3, 0.6, 4.0, 100.0] {
            let slope = (loss.cost(squared + 1e-5) - loss.cost(squared - 1e-5)) / 2e-5;
            assert!((slope - loss.weight(squared)).abs() < 1e-6, "{loss:?} at {squared}");
        }
    }
}

#[test]
fn parameters_that_nothing_tells_apart_are_named() {
    let mut flat = Curves::truth(&mut Noise::new(4, 0.01));
    // At t = 0 alone, a and c add up; the slope gives their product with b.
    for curve in &mut flat.data {
        curve.truncate(1);
    }
    assert_eq!(fit(flat, Loss::Squares).err(), Some(Unfitted::Loose));
}
