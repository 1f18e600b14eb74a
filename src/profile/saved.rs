//! Settings that other slicers have saved with objects, or with parts of them.

use toml::Table;

use super::import::Import;
use super::settings::Settings;
use crate::mesh::SavedSettings;
use crate::presets;

impl Settings {
    /// The same with what another slicer has saved, as far as a key `may` be taken over, and their keys that are not.
    pub(crate) fn with_saved(
        &self,
        saved: &SavedSettings,
        may: impl Fn(&str) -> Result<(), Refused>,
    ) -> (Self, Vec<String>) {
        if saved.entries.is_empty() {
            return (self.clone(), Vec::new());
        }
        let import = Import::of(&presets::of_saved(saved));
        let mut left: Vec<String> = Vec::new();
        let mut settings = self.clone();
        for taken in import.taken.into_iter().filter(|taken| !taken.place.is_built_in()) {
            let changed = match may(taken.key) {
                Ok(()) => settings.with(taken.key, taken.value),
                Err(Refused::Silently) => continue,
                Err(Refused::Told) => None,
            };
            match changed {
                Some(changed) => settings = changed,
                None => left.push(taken.from.to_owned()),
            }
        }
        let own = import.left.into_iter().filter(|left| !left.place.is_built_in());
        left.extend(own.map(|left| left.key));
        left.sort_unstable();
        left.dedup();
        (settings, left)
    }
}

impl Settings {
    /// Whether a key has the same value in others.
    pub(crate) fn agrees(&self, other: &Self, key: &str) -> bool {
        let value = |settings: &Self| {
            let table = Table::try_from(settings).ok()?;
            let (section, name) = key.split_once('.')?;
            table.get(section)?.get(name).cloned()
        };
        value(self) == value(other)
    }
}

/// How a setting is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    /// The user has said otherwise.
    Silently,
    /// The user should know.
    Told,
}
