//! "Did you mean …?" for keys of settings.

use super::schema;
use crate::near::{distance_within, limit};

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
    }
}
