//! "Did you mean …?": nearest known names by edit distance.

use super::schema;

/// The distance (insertions, deletions, substitutions and swaps of neighbours cost 1), if it is at most `most`; texts whose lengths differ by more are not compared.
fn distance_within(most: usize, a: &str, b: &str) -> Option<usize> {
    let lengths_apart = a.chars().count().abs_diff(b.chars().count());
    (lengths_apart <= most).then(|| strsim::osa_distance(a, b)).filter(|away| *away <= most)
}

/// Largest edit distance of a suggested name, as a share of its length.
fn limit(written: &str) -> usize {
    (written.chars().count() / 3).max(1)
}

/// The known name nearest to what was written, if one is near.
pub(super) fn name<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .filter_map(|name| Some((distance_within(limit(written), written, name)?, name)))
        .min_by_key(|(away, _)| *away)
        .map(|(_, name)| name)
}

/// Up to three known keys nearest to a dotted key: nearly the same key, or the same name in another section.
pub(super) fn keys(written: &str) -> Vec<String> {
    let name = written.rsplit('.').next().unwrap_or(written);
    let most = limit(name);
    let mut near: Vec<(usize, String)> = schema::keys()
        .filter_map(|(key, field)| {
            let same_section = distance_within(most, written, &key);
            let other_section = distance_within(most - 1, name, field.name).map(|away| away + 1);
            Some((same_section.into_iter().chain(other_section).min()?, key))
        })
        .collect();
    near.sort_by_key(|(away, _)| *away);
    if let Some(&(best, _)) = near.first() {
        near.retain(|(away, _)| *away == best);
    }
    near.truncate(3);
    near.into_iter().map(|(_, key)| key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typing_error_finds_its_key() {
        assert_eq!(keys("walls.cuont"), ["walls.count"]);
        assert_eq!(keys("wall.count"), ["walls.count"]);
    }

    #[test]
    fn a_key_in_the_wrong_section_finds_the_right_one() {
        assert_eq!(keys("walls.density"), ["filament.density", "infill.density", "raft.density"]);
    }

    #[test]
    fn nothing_near_suggests_nothing() {
        assert_eq!(keys("walls.zzzzzzzz"), Vec::<String>::new());
        assert_eq!(name("frobnicate", ["pla", "petg"]), None);
    }
}
