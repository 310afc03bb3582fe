//! The methods that are compared, each from tracks to a hierarchy.

use honami_model::hierarchy::Dendrogram;
use honami_motion::likeness::{self, Flutter, Making};
use honami_motion::{
    Criterion, Likeness, MotionError, Positions, composite, denoised, grouped, linkage, ncut,
};

type Method = fn(&Positions) -> Result<Dendrogram, MotionError>;

/// What a row is called, and what it does.
pub(crate) const METHODS: [(&str, Method); 20] = [
    ("position", |tracks| thesis(tracks, 0.0)),
    ("distance of movement (`movement`)", |tracks| thesis(tracks, 1.0)),
    ("the same, denoised", |tracks| thesis(&denoised(tracks, 0, &mut |_| true)?.0, 1.0)),
    ("normalised cuts of abs(ρ), as in print", |tracks| cuts(tracks, 0.0, false)),
    ("the same, denoised", |tracks| cuts(tracks, 0.0, true)),
    ("normalised cuts of abs(ρ) and position, as in print", |tracks| cuts(tracks, 1.0, false)),
    ("the same, denoised", |tracks| cuts(tracks, 1.0, true)),
    ("`ncut`, as it comes", |tracks| clearest(tracks, false)),
    ("the same, denoised", |tracks| clearest(tracks, true)),
    ("abs(ρ) and Ward", |tracks| correlation(tracks, 0.0)),
    ("abs(ρ), position and Ward", |tracks| correlation(tracks, 1.0)),
    ("the same, denoised", |tracks| components(tracks, Likeness::Steps, 1.0, Flutter::Keep)),
    ("R1, flutter=keep", |tracks| components(tracks, Likeness::Loadings, 0.6, Flutter::Keep)),
    ("R1, flutter=down", |tracks| components(tracks, Likeness::Loadings, 0.6, Flutter::TakeDown)),
    ("R1 (`bod`, likeness=loadings smooth=0 hierarchy=ward)", |tracks| {
        components(tracks, Likeness::Loadings, 0.6, Flutter::Auto)
    }),
    ("G15 (likeness=turned)", |tracks| components(tracks, Likeness::Turned, 0.5, Flutter::Auto)),
    ("R1, smoothed", |tracks| smoothed(tracks, Likeness::Loadings, WARD, Flutter::Auto)),
    ("`bod`, hierarchy=ward", |tracks| smoothed(tracks, Likeness::Steps, WARD, Flutter::Auto)),
    ("`bod`, flutter=keep", |tracks| smoothed(tracks, Likeness::Steps, Making::Cuts, Flutter::Keep)),
    ("**`bod`, as it comes**", |tracks| smoothed(tracks, Likeness::Steps, Making::Cuts, Flutter::Auto)),
];
const WARD: Making = Making::Merges(Criterion::Ward);

fn thesis(tracks: &Positions, movement_weight: f64) -> Result<Dendrogram, MotionError> {
    let options = composite::Options { movement_weight, ..Default::default() };
    linkage(composite(tracks, &options, &mut |_| true)?.condensed, tracks.n_tracks(), Criterion::Ward)
}

/// Zeng's, of the whole graph and level by level, as in print.
fn cuts(tracks: &Positions, position_weight: f64, denoises: bool) -> Result<Dendrogram, MotionError> {
    let options = ncut::Options {
        position_weight,
        denoises,
        n_neighbours: tracks.n_tracks(),
        n_levels: 6,
        order: ncut::Order::Levels,
        ..Default::default()
    };
    Ok(ncut(tracks, &options, &mut |_| true)?.tree)
}

/// Of the nearest, what falls apart most clearly first.
fn clearest(tracks: &Positions, denoises: bool) -> Result<Dendrogram, MotionError> {
    let options = ncut::Options { denoises, ..Default::default() };
    Ok(ncut(tracks, &options, &mut |_| true)?.tree)
}

/// sqrt(1 - |rho|) of tracks as they are (errata Z1), and places, each by its spread over all N x N pairs.
fn correlation(tracks: &Positions, position_weight: f64) -> Result<Dendrogram, MotionError> {
    let (n, n_frames) = (tracks.n_tracks(), tracks.n_frames());
    let at = |track: usize, frame: usize| tracks.get(track, frame).unwrap_or_default().map(f64::from);
    let mut steps: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut places = Vec::new();
    for track in 0..n {
        let all: Vec<[f64; 2]> = (0..n_frames).map(|frame| at(track, frame)).collect();
        places.push([0, 1].map(|axis| all.iter().map(|at| at[axis]).sum::<f64>() / n_frames as f64));
        let mean = [0, 1].map(|axis| (all[n_frames - 1][axis] - all[0][axis]) / (n_frames - 1) as f64);
        let own: Vec<[f64; 2]> = all
            .windows(2)
            .map(|pair| [0, 1].map(|axis| pair[1][axis] - pair[0][axis] - mean[axis]))
            .collect();
        let length = own.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
        steps.push(own.iter().map(|v| v.map(|v| v / length)).collect());
    }
    let apart = |i: usize, j: usize| {
        let pairs = || steps[i].iter().zip(&steps[j]);
        let re: f64 = pairs().map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum();
        let im: f64 = pairs().map(|(a, b)| a[1] * b[0] - a[0] * b[1]).sum();
        (1.0 - re.hypot(im)).max(0.0).sqrt()
    };
    let far = |i: usize, j: usize| (places[i][0] - places[j][0]).hypot(places[i][1] - places[j][1]);
    let (apart, far) = (spread(n, apart), spread(n, far));
    let both = apart.iter().zip(&far).map(|(apart, far)| apart + position_weight * far);
    linkage(both.collect(), n, Criterion::Ward)
}

/// A distance of all pairs over its standard deviation.
fn spread(n: usize, distance: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let all: Vec<f64> =
        (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).map(|(i, j)| distance(i, j)).collect();
    let entries = (n * n) as f64;
    let mean = 2.0 * all.iter().sum::<f64>() / entries;
    let sd = (2.0 * all.iter().map(|d| d * d).sum::<f64>() / entries - mean * mean).sqrt();
    all.iter().map(|d| d / sd).collect()
}

/// Not smoothed, and merged by Ward's criterion.
fn components(
    tracks: &Positions,
    likeness: Likeness,
    position_weight: f64,
    flutter: Flutter,
) -> Result<Dendrogram, MotionError> {
    let most = if likeness == Likeness::Steps { usize::MAX } else { 30 };
    let (n_neighbours, making) = (0, WARD);
    let options = likeness::Options {
        likeness,
        n_neighbours,
        making,
        position_weight,
        most,
        flutter,
        ..Default::default()
    };
    Ok(grouped(tracks, &options, &mut |_| true)?.tree)
}

fn smoothed(
    tracks: &Positions,
    likeness: Likeness,
    making: Making,
    flutter: Flutter,
) -> Result<Dendrogram, MotionError> {
    let options = likeness::Options { likeness, making, flutter, ..Default::default() };
    Ok(grouped(tracks, &options, &mut |_| true)?.tree)
}
