//! What the columns of a comparison say, in words.

use honami_workbench::compare::{Row, STATIC};

/// A line a column that is there, in the order of the tables.
pub(super) fn of(rows: &[Row]) -> String {
    let any = |has: fn(&Row) -> bool| rows.iter().any(has);
    let mut lines: Vec<(&str, &str)> = Vec::new();
    if any(|row| row.accuracy.is_some()) {
        lines.extend(OF_TRUTH);
    }
    lines.push(("kept", "share of points seen in every later frame: occluded is not kept"));
    if any(|row| row.back.is_some()) {
        lines.extend(OF_BACK);
    }
    if any(|row| row.left_out.is_some()) {
        lines.push(("keys", "median px off key-frames, each left out and found from the one before"));
    }
    if any(|row| row.time.is_some()) {
        lines.push(("ms, ms95", "time in the tracker a frame, one thread: mean; 95 % take no longer"));
    }
    if any(|row| row.peak_bytes.is_some()) {
        lines.push(("MB", "memory it took at most, 10^6 bytes"));
    }
    if any(|row| row.n_deaths > 0) {
        lines.push(("died", "times its process died; a frame it died in twice is lost"));
    }
    if any(|row| row.field.is_some()) {
        lines.extend(OF_FIELD);
    }
    lines.push((STATIC, "no tracker: every point stays where it was given"));
    lines.push(("–, lost", "not measured; of px: half of them or more were lost"));
    let width = lines.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    lines.iter().map(|(name, words)| format!("{name:width$}  {words}")).collect::<Vec<_>>().join("\n")
}

const OF_TRUTH: [(&str, &str); 9] = [
    ("<1 px..<16", "share of truly visible samples so near the truth; lost is a miss"),
    ("δavg", "the mean of these five"),
    ("median", "px, of the visible samples that are not lost; track: of whole tracks"),
    ("surv", "share of frames before the first error above 16 px, or loss"),
    ("ok", "share of tracks within 8 px in every visible frame"),
    ("vis", "share of samples rightly said to be seen, or not"),
    ("prec", "share within 8 px of the samples said to be seen"),
    ("rec", "share said to be seen and within 8 px of the truly visible samples"),
    ("lost", "share of the truly visible samples said not to be seen"),
];

const OF_BACK: [(&str, &str); 2] = [
    ("back", "median px from their start, tracked to the last frame and back"),
    ("home", "share of points that come back to within 1 px"),
];

const OF_FIELD: [(&str, &str); 2] = [
    ("dense", "mean px over all pixels; >1 px: share of them farther off"),
    ("known", "share of the pixels with a truth that the dense motion reaches"),
];
