//! "Did you mean …?": nearest known names by edit distance.

/// The distance (insertions, deletions, substitutions and swaps of neighbours cost 1), if it is at most `most`; texts whose
/// lengths differ by more are not compared.
pub(crate) fn distance_within(most: usize, a: &str, b: &str) -> Option<usize> {
    let lengths_apart = a.chars().count().abs_diff(b.chars().count());
    (lengths_apart <= most).then(|| strsim::osa_distance(a, b)).filter(|away| *away <= most)
}

/// How far a name may be from what was written and still be suggested: a third of it.
pub(crate) fn limit(written: &str) -> usize {
    (written.chars().count() / 3).max(1)
}

/// The known name nearest to what was written, if one is near.
pub(crate) fn name<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .filter_map(|name| Some((distance_within(limit(written), written, name)?, name)))
        .min_by_key(|(away, _)| *away)
        .map(|(_, name)| name)
}

/// Up to `most` known names: those with all the words that were written, the shortest first, and then those near to it;
/// capitals do not count.
pub(crate) fn names<'a>(
    written: &str,
    known: impl IntoIterator<Item = &'a str>,
    most: usize,
) -> Vec<&'a str> {
    let written = written.to_lowercase();
    let mut near: Vec<(usize, usize, &str)> = known
        .into_iter()
        .filter_map(|name| {
            let lower = name.to_lowercase();
            if has_words(&lower, &written) {
                return Some((0, lower.len(), name));
            }
            distance_within(limit(&written), &written, &lower).map(|away| (1, away, name))
        })
        .collect();
    near.sort();
    near.dedup();
    near.into_iter().take(most).map(|(_, _, name)| name).collect()
}

/// Whether a text holds every one of some words; both in small letters.
pub(crate) fn has_words(text: &str, words: &str) -> bool {
    words.split_whitespace().all(|word| text.contains(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_near_suggests_nothing() {
        assert_eq!(name("frobnicate", ["pla", "petg"]), None);
        assert_eq!(names("frobnicate", ["pla", "petg"], 9), Vec::<&str>::new());
    }

    #[test]
    fn words_in_any_order_find_a_name_before_typing_errors_do() {
        let known = ["Ender-3 Pro (0.4 mm)", "Ender-3 (0.4 mm)", "Ender-4", "Mega"];
        assert_eq!(names("0.4 ENDER-3", known, 9), ["Ender-3 (0.4 mm)", "Ender-3 Pro (0.4 mm)"]);
        assert_eq!(names("ednre-4", known, 9), ["Ender-4"]);
    }
}
