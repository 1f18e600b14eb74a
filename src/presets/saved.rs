//! What slicers save with single objects of a project.

use super::config::{Config, Dialect, Place};
use super::orca;
use crate::mesh::{SavedSettings, Words};

/// The settings saved with an object as a configuration; what is built in has a [place](Place::is_built_in) that says so.
pub(crate) fn of_saved(saved: &SavedSettings) -> Config {
    let place = Place::new("", 0, "object");
    match saved.words {
        Words::Orca => Config { of_object: true, ..orca::of_object(&saved.entries, &place) },
        Words::Prusa => {
            let mut config = Config { dialect: Dialect::Prusa, of_object: true, ..Config::default() };
            saved.entries.iter().for_each(|(key, value)| config.set(key, value, place.clone()));
            config
        }
    }
}
