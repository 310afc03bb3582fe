//! Numbers of rows as they stand in the tables.

use serde_json::Value;

/// What is not there.
pub(super) const NONE: &str = "–";

/// The number at a path of keys and indices, such as `back/median_px`, in the tracker's own row of an answer.
pub(super) fn number(answer: &Value, path: &str) -> Option<f64> {
    answer["trackers"][0].pointer(&format!("/{path}"))?.as_f64()
}

/// A share without the nought before the point.
pub(super) fn share(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), |v| bare(&format!("{v:.3}")))
}

/// A length; finer where it is small.
pub(super) fn px(value: Option<f64>) -> String {
    let digits = |v: f64| match v.abs() {
        v if v < 0.1 => 4,
        v if v < 1.0 => 3,
        v if v < 10.0 => 2,
        _ => 1,
    };
    value.map_or_else(|| NONE.to_owned(), |v| bare(&format!("{v:.*}", digits(v))))
}

/// A length of which `null` says that most were lost.
pub(super) fn px_or_lost(answer: &Value, path: &str) -> String {
    match answer["trackers"][0].pointer(&format!("/{path}")) {
        Some(Value::Null) => "lost".to_owned(),
        _ => px(number(answer, path)),
    }
}

fn bare(text: &str) -> String {
    text.replacen("0.", ".", usize::from(text.trim_start_matches('-').starts_with("0.")))
}

/// The mean of what is there.
pub(super) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The mean, and half of what lies between the smallest and the largest.
pub(super) fn with_spread(values: &[f64]) -> String {
    let Some(mean) = mean(values) else { return NONE.to_owned() };
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match values.len() {
        1 => share(Some(mean)),
        _ => format!("{} ± {}", share(Some(mean)), share(Some((high - low) / 2.0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_they_stand_in_the_tables() {
        for (value, as_share, as_px) in [
            (0.8254, ".825", ".825"),
            (1.0, "1.000", "1.00"),
            (-0.012, "-.012", "-.0120"),
            (10.04, "10.040", "10.0"),
        ] {
            assert_eq!((share(Some(value)).as_str(), px(Some(value)).as_str()), (as_share, as_px));
        }
        assert_eq!(with_spread(&[0.8, 0.9, 0.82]), ".840 ± .050");
        assert_eq!(with_spread(&[]), NONE);
        let answer = serde_json::json!({ "trackers": [{ "kept": 0.5, "back": { "median_px": null } }] });
        assert_eq!(number(&answer, "kept"), Some(0.5));
        assert_eq!(px_or_lost(&answer, "back/median_px"), "lost");
    }
}
