//! The configurations of a machine's extruders, as one.

use crate::presets::config::{Config, Raw};
use crate::presets::value::{Scalar, Shape, Type, join_texts, texts, unescaped};

/// The configuration of which the extruders have these. What is the same for all extruders is the first one's.
pub(super) fn joined(all: Vec<Config>) -> Config {
    let mut config = all.first().cloned().unwrap_or_default();
    if all.len() < 2 {
        return config;
    }
    for (key, entry) in config.entries.clone() {
        let Some((Some(kind), _)) = config.lists.get(&key).cloned() else { continue };
        if kind.shape == Shape::Each {
            let own = all.iter().map(|one| one.entries.get(&key).unwrap_or(&entry).value.as_str());
            let value = match kind.scalar {
                Scalar::Text => {
                    let own: Vec<_> =
                        own.map(|own| texts(own).into_iter().next().unwrap_or_default()).collect();
                    join_texts(&own)
                }
                _ => own.collect::<Vec<_>>().join(","),
            };
            config.set_known(&key, &value, Some(kind), entry.place);
        }
    }
    for (name, raw) in config.raw.clone() {
        let own: Vec<&Raw> = all.iter().map(|one| one.raw.get(&name).unwrap_or(&raw)).collect();
        let scalars = || own.iter().map(|one| one.kind.map_or(Scalar::Text, |kind| kind.scalar));
        let scalar = match scalars().all(|scalar| scalar == Scalar::Integer) {
            true => Scalar::Integer,
            false if scalars().all(|scalar| matches!(scalar, Scalar::Integer | Scalar::Real)) => Scalar::Real,
            false => Scalar::Text,
        };
        // Lists of lists there are none.
        if own.iter().all(|one| one.kind.is_none_or(|kind| kind.shape == Shape::One)) {
            let value = match scalar {
                Scalar::Text => join_texts(&own.iter().map(|one| unescaped(&one.value)).collect::<Vec<_>>()),
                _ => own.iter().map(|one| one.value.as_str()).collect::<Vec<_>>().join(","),
            };
            config.set_raw(&name, &value, Some(Type { scalar, shape: Shape::Each }));
        }
    }
    config
}
