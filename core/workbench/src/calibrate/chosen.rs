//! Which views of a board are fitted: of a video a few tell what all do.

use honami_cameras::Pixel;

/// Views of a board that are fitted, unless other many are asked for: more add little, and what pairs of them cost grows with
/// their square.
pub(super) const MOST_VIEWS: usize = 40;

/// Where a board's four outer corners are in a picture, parts of its width; none where it is not seen.
pub(super) type Stand = Option<[Pixel; 4]>;

/// Numbers of views, rising and so many at most, that differ most in where the board stands, by what each of the cameras saw. The first
/// is the first that most cameras saw; each other one is farthest from all before it. Views that nobody saw are never chosen.
pub(super) fn chosen(views: &[Vec<Stand>], n_most: usize) -> Vec<usize> {
    let n_seen = |view: usize| views[view].iter().flatten().count();
    let seen: Vec<usize> = (0..views.len()).filter(|&view| n_seen(view) > 0).collect();
    if seen.len() <= n_most {
        return seen;
    }
    let first = seen.iter().copied().rev().max_by_key(|&view| n_seen(view));
    let mut next = first;
    let (mut found, mut far) = (Vec::with_capacity(n_most), vec![f64::INFINITY; seen.len()]);
    while let Some(view) = next.filter(|_| found.len() < n_most) {
        found.push(view);
        for (far, &other) in far.iter_mut().zip(&seen) {
            *far = far.min(apart(&views[view], &views[other]));
        }
        // Of equals the first.
        let rest = seen.iter().zip(&far).rev().filter(|(other, _)| !found.contains(other));
        next = rest.max_by(|a, b| a.1.total_cmp(b.1)).map(|(&other, _)| other);
    }
    found.sort_unstable();
    found
}

/// How much the board stands otherwise in another view: root mean square distance of its outer corners over all cameras, parts of a
/// picture's width; a whole width for each camera that saw one of both alone.
fn apart(one: &[Stand], other: &[Stand]) -> f64 {
    let squares = one.iter().zip(other).map(|both| match both {
        (Some(a), Some(b)) => a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()).sum::<f64>() / 4.0,
        (None, None) => 0.0,
        _ => 1.0,
    });
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A board of a fifth of the width, there.
    fn at(x: f64, y: f64) -> Stand {
        Some([[0.0, 0.0], [0.2, 0.0], [0.0, 0.15], [0.2, 0.15]].map(|[u, v]| Pixel::new(x + u, y + v)))
    }

    #[test]
    fn a_board_that_rests_is_seen_once_and_where_it_goes_all_along() {
        // It rests for long, leans, goes to a corner, and rests again.
        let mut leaning = at(0.4, 0.3);
        leaning.as_mut().unwrap()[1].y += 0.1;
        let rest = |n: usize| vec![vec![at(0.4, 0.3)]; n];
        let views = [rest(50), vec![vec![leaning], vec![None], vec![at(0.0, 0.0)]], rest(50)].concat();
        assert_eq!(chosen(&views, 3), [0, 50, 52]);
        // What all show is kept, and what nobody saw is not.
        assert_eq!(chosen(&views[48..53], 4), [0, 1, 2, 4]);
        assert!(chosen(&views[51..52], 4).is_empty());
        // On a way along a line so many evenly: a quarter of it, then halves.
        let way: Vec<Vec<Stand>> = (0..=80).map(|k| vec![at(f64::from(k) / 100.0, 0.0)]).collect();
        assert_eq!(chosen(&way, 5), [0, 20, 40, 60, 80]);
        assert!(chosen(&way, 0).is_empty());
    }

    #[test]
    fn of_two_cameras_both_are_heard_and_those_first_that_saw_it_together() {
        let alone = |side: usize, k: usize| {
            let stand = at(k as f64 / 100.0, 0.1);
            if side == 0 { vec![stand, None] } else { vec![None, stand] }
        };
        let mut views: Vec<_> = (0..30).map(|k| alone(k % 2, k)).collect();
        views.push(vec![at(0.3, 0.3), at(0.1, 0.3)]);
        let found = chosen(&views, 3);
        assert!(found.contains(&30), "{found:?}");
        assert!(
            found.iter().any(|view| view % 2 == 1) && found.iter().any(|view| *view < 30 && view % 2 == 0)
        );
    }
}
