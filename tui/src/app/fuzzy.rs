//! Matching of a few typed letters against names: letters in order, best where words begin.

/// How well `typed` matches `text`, higher is better; `None` when its letters do not all appear in order.
///
/// Case does not count; spaces in `typed` are skipped. Everything matches nothing typed, with 0.
#[must_use]
pub(super) fn score(typed: &str, text: &str) -> Option<i32> {
    let lower = |s: &str| s.chars().flat_map(char::to_lowercase).collect::<Vec<char>>();
    let text = lower(text);
    let wanted: Vec<char> = lower(typed).into_iter().filter(|c| !c.is_whitespace()).collect();
    let (mut total, mut from) = (0, 0);
    for (k, c) in wanted.iter().enumerate() {
        let starts_word = |i: usize| i == 0 || !text[i - 1].is_alphanumeric();
        let here = (from..text.len()).filter(|&i| text[i] == *c && follows(&wanted[k + 1..], &text[i + 1..]));
        let (gain, at) = here
            .map(|i| {
                let gain = if k > 0 && i == from { 8 } else { 0 } + if starts_word(i) { 6 } else { 0 };
                (gain - i32::try_from((i - from).min(5)).unwrap_or(5), i)
            })
            .max_by_key(|&(gain, i)| (gain, std::cmp::Reverse(i)))?;
        total += 10 + gain;
        from = at + 1;
    }
    Some(total)
}

/// Whether the wanted letters appear in order.
fn follows(wanted: &[char], text: &[char]) -> bool {
    let mut text = text.iter();
    wanted.iter().all(|c| text.any(|t| t == c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_matches_score_higher() {
        let best = |typed: &str, texts: &[&'static str]| {
            texts.iter().copied().filter(|t| score(typed, t).is_some()).max_by_key(|t| score(typed, t))
        };
        for (typed, texts, expect) in [
            ("pb", &["play", "play-backwards", "palette b"][..], Some("play-backwards")),
            ("und", &["undo", "fine-up and down"], Some("undo")),
            ("go f", &["go-end", "go-frame"], Some("go-frame")),
            ("ab", &["xab a"], Some("xab a")),
            ("XYZ", &["undo"], None),
        ] {
            assert_eq!(best(typed, texts), expect, "{typed}");
        }
        assert_eq!(score("", "anything"), Some(0));
    }
}
