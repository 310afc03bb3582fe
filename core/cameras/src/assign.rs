//! The cheapest way to give each row a column of its own.
//!
//! H. W. Kuhn's method with shortest augmenting paths (R. Jonker, A. Volgenant, Computing 38 (1987), 325-340): one row after the other, in time
//! rows² · columns.

/// For each row its column, so that the sum of their costs is least; a pair of infinite cost is none. `costs` is
/// row-major, `(rows, columns)`; finite costs must be less than 1e100 and no cost may be NaN.
///
/// As many rows are given a column as can be.
///
/// # Panics
/// When `costs` is no such matrix.
#[must_use]
#[track_caller]
pub fn assigned(costs: &[f64], columns: usize) -> Vec<Option<usize>> {
    assert!(costs.iter().all(|cost| !cost.is_nan()), "costs are numbers");
    if columns == 0 {
        return Vec::new();
    }
    assert!(costs.len().is_multiple_of(columns), "rows of {columns} costs");
    let rows = costs.len() / columns;
    // A column for each row to be alone in, dearer than all pairs together.
    let dearest =
        costs.iter().filter(|cost| cost.is_finite()).fold(1.0_f64, |most, cost| most.max(cost.abs()));
    let alone = 4.0 * dearest * (rows as f64 + 1.0);
    let cost = |row: usize, column: usize| match costs.get(row * columns + column) {
        Some(&cost) if column < columns && cost.is_finite() => cost,
        _ if column == columns + row => alone,
        _ => f64::INFINITY,
    };
    let n = columns + rows;
    let mut solver = Solver { row_price: vec![0.0; rows], column_price: vec![0.0; n], row_of: vec![None; n] };
    (0..rows).for_each(|row| solver.add(row, &cost));
    let mut found = vec![None; rows];
    for (column, row) in solver.row_of.iter().enumerate().take(columns) {
        if let Some(row) = row {
            found[*row] = Some(column);
        }
    }
    found
}

struct Solver {
    row_price: Vec<f64>,
    column_price: Vec<f64>,
    row_of: Vec<Option<usize>>,
}

impl Solver {
    /// Gives a row a column, and others theirs anew where that is cheaper.
    fn add(&mut self, row: usize, cost: &impl Fn(usize, usize) -> f64) {
        let n = self.row_of.len();
        let (mut way, mut before) = (vec![f64::INFINITY; n], vec![None; n]);
        let mut done = vec![false; n];
        let (mut here, mut column, mut length) = (row, None, 0.0);
        loop {
            let mut nearest = (f64::INFINITY, n);
            for next in 0..n {
                if done[next] {
                    continue;
                }
                let through = length + cost(here, next) - self.row_price[here] - self.column_price[next];
                if through < way[next] {
                    (way[next], before[next]) = (through, column);
                }
                if way[next] < nearest.0 {
                    nearest = (way[next], next);
                }
            }
            // A row can always be alone, so there is a next one.
            let (reached, next) = nearest;
            (length, column) = (reached, Some(next));
            done[next] = true;
            match self.row_of[next] {
                Some(taken) => here = taken,
                None => break,
            }
        }
        self.reprice(row, &way, &done, length);
        self.turn_over(row, &before, column);
    }

    fn reprice(&mut self, row: usize, way: &[f64], done: &[bool], length: f64) {
        self.row_price[row] += length;
        for (column, done) in done.iter().enumerate() {
            if *done {
                self.column_price[column] += way[column] - length;
                if let Some(row) = self.row_of[column] {
                    self.row_price[row] += length - way[column];
                }
            }
        }
    }

    fn turn_over(&mut self, row: usize, before: &[Option<usize>], end: Option<usize>) {
        let mut column = end;
        while let Some(here) = column {
            let previous = before[here];
            self.row_of[here] = previous.map_or(Some(row), |previous| self.row_of[previous]);
            column = previous;
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// Most rows with a column, and the least cost of these, by trying all.
    fn tried(costs: &[f64], columns: usize, row: usize, taken: u32) -> (usize, f64) {
        if row == costs.len() / columns {
            return (0, 0.0);
        }
        let mut best = tried(costs, columns, row + 1, taken);
        for column in (0..columns).filter(|column| taken & (1 << column) == 0) {
            let cost = costs[row * columns + column];
            if cost.is_finite() {
                let (n, rest) = tried(costs, columns, row + 1, taken | 1 << column);
                let (n, sum) = (n + 1, rest + cost);
                if n > best.0 || (n == best.0 && sum < best.1) {
                    best = (n, sum);
                }
            }
        }
        best
    }

    #[test]
    fn the_cheapest_of_all_ways_is_found() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        for trial in 0..400 {
            let (rows, columns) = (random.random_range(1..=5), random.random_range(1..=6));
            let gaps = f64::from(trial % 4) * 0.25;
            let draw = |random: &mut Pcg64Mcg| match random.random_range(0.0..1.0) < gaps {
                true => f64::INFINITY,
                false => random.random_range(-1.0..10.0),
            };
            let costs: Vec<f64> = (0..rows * columns).map(|_| draw(&mut random)).collect();
            let found = assigned(&costs, columns);
            let pairs = || found.iter().enumerate().filter_map(|(row, column)| Some((row, (*column)?)));
            let sum: f64 = pairs().map(|(row, column)| costs[row * columns + column]).sum();
            let (n, best) = tried(&costs, columns, 0, 0);
            assert_eq!(pairs().count(), n, "{costs:?}");
            assert!((sum - best).abs() < 1e-9, "{costs:?}: {sum} for {best}");
            let mut taken: Vec<usize> = pairs().map(|(_, column)| column).collect();
            taken.sort_unstable();
            taken.dedup();
            assert_eq!(taken.len(), n);
        }
        assert_eq!(assigned(&[], 3), Vec::<Option<usize>>::new());
    }
}
