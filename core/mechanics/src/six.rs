//! Blocks of six by six numbers, which stay in registers, and what they make of the rows of a node.
//!
//! All of it is part of whoever calls it, so that it becomes the instructions that were chosen there.

/// Degrees of freedom a node.
pub(crate) const DOF: usize = 6;

/// A block, column by column.
pub(crate) type Six = [[f64; DOF]; DOF];

/// A node's rows of `N` columns.
pub(crate) type Rows<const N: usize> = [[f64; N]; DOF];

pub(crate) const ZERO: Six = [[0.0; DOF]; DOF];

#[inline(always)]
pub(crate) fn unit() -> Six {
    let mut unit = ZERO;
    for (k, column) in unit.iter_mut().enumerate() {
        column[k] = 1.0;
    }
    unit
}

#[inline(always)]
pub(crate) fn product(a: &Six, b: &Six) -> Six {
    let mut product = ZERO;
    for (sum, b) in product.iter_mut().zip(b) {
        for (a, b) in a.iter().zip(b) {
            for (sum, a) in sum.iter_mut().zip(a) {
                *sum += a * b;
            }
        }
    }
    product
}

#[inline(always)]
pub(crate) fn transposed(a: &Six) -> Six {
    let mut other = ZERO;
    for (k, column) in a.iter().enumerate() {
        for (other, a) in other.iter_mut().zip(column) {
            other[k] = *a;
        }
    }
    other
}

/// `a + b * share`.
#[inline(always)]
pub(crate) fn sum(a: &Six, b: &Six, share: f64) -> Six {
    let mut sum = *a;
    for (sum, b) in sum.iter_mut().zip(b) {
        for (sum, b) in sum.iter_mut().zip(b) {
            *sum += b * share;
        }
    }
    sum
}

/// Adds `a x`.
#[inline(always)]
pub(crate) fn add<const N: usize>(a: &Six, x: &Rows<N>, sums: &mut Rows<N>) {
    for (column, x) in a.iter().zip(x) {
        for (sum, a) in sums.iter_mut().zip(column) {
            for (sum, x) in sum.iter_mut().zip(x) {
                *sum += a * x;
            }
        }
    }
}

/// Adds `a^T x`.
#[inline(always)]
pub(crate) fn add_transposed<const N: usize>(a: &Six, x: &Rows<N>, sums: &mut Rows<N>) {
    for (column, sum) in a.iter().zip(sums) {
        for (a, x) in column.iter().zip(x) {
            for (sum, x) in sum.iter_mut().zip(x) {
                *sum += a * x;
            }
        }
    }
}

#[inline(always)]
pub(crate) fn minus<const N: usize>(mut x: Rows<N>) -> Rows<N> {
    x.iter_mut().flatten().for_each(|x| *x = -*x);
    x
}

/// A node's rows of columns that lie one after the other.
#[inline(always)]
pub(crate) fn rows<const N: usize>(x: &[f64], node: usize) -> Rows<N> {
    let height = x.len() / N;
    let mut rows = [[0.0; N]; DOF];
    for k in 0..N {
        let column = &x[k * height + DOF * node..][..DOF];
        for (row, x) in rows.iter_mut().zip(column) {
            row[k] = *x;
        }
    }
    rows
}

/// Puts a node's rows where [`rows`] finds them.
#[inline(always)]
pub(crate) fn put<const N: usize>(x: &mut [f64], node: usize, rows: &Rows<N>) {
    let height = x.len() / N;
    for k in 0..N {
        let column = &mut x[k * height + DOF * node..][..DOF];
        for (x, row) in column.iter_mut().zip(rows) {
            *x = row[k];
        }
    }
}
