//! What there is to choose from: every setting, and the built-in profiles.

use std::sync::OnceLock;

use serde::Serialize;
use serde_json::Value;

use super::objects::ObjectSettings;
use crate::options::{Field, Kind};
use crate::profile::{EMBEDDED, SECTIONS, Settings};

/// Every setting.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Schema {
    /// In the order of the documentation.
    pub groups: Vec<Group>,
}

/// Settings that belong together.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Group {
    /// The part of the keys before the dot.
    pub name: &'static str,
    /// The same for people.
    pub title: String,
    /// What they are about.
    pub help: String,
    /// The settings.
    pub settings: Vec<Setting>,
}

/// A setting.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Setting {
    /// Dotted key.
    pub key: String,
    /// Meaning.
    pub help: &'static str,
    /// What it takes.
    pub kind: SettingKind,
    /// Unit of its numbers.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Least value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Greatest value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Words that it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choices: Option<&'static [&'static str]>,
    /// How many numbers a list has; none: any number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// Value of the default profile.
    pub default: Value,
    /// Whether a model may have a value of its own.
    pub per_object: bool,
}

/// What a setting takes.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum SettingKind {
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// True or false.
    Boolean,
    /// One of a few words.
    Choice,
    /// Any text.
    Text,
    /// Numbers.
    List,
    /// A share: `0.15` or `15%`.
    Percent,
}

/// A built-in profile.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
pub struct Profile {
    /// By which it is chosen.
    pub name: &'static str,
    /// `printer`, `material`, `quality`, or `job` for all three.
    pub kind: &'static str,
    /// A line about it.
    pub help: String,
}

impl Schema {
    /// That of this version.
    pub fn known() -> &'static Self {
        static SCHEMA: OnceLock<Schema> = OnceLock::new();
        SCHEMA.get_or_init(|| {
            // By way of a table, as settings are written elsewhere: the code for that is large.
            let defaults = toml::Table::try_from(Settings::default()).ok();
            let defaults = serde_json::to_value(defaults).unwrap_or_default();
            let groups = SECTIONS.iter().map(|section| Group {
                name: section.name,
                title: title(section.name),
                help: section
                    .doc
                    .trim()
                    .trim_start_matches(&format!("`[{}]`:", section.name))
                    .trim()
                    .to_owned(),
                settings: section
                    .fields
                    .iter()
                    .map(|field| setting(section.name, field, &defaults))
                    .collect(),
            });
            Self { groups: groups.collect() }
        })
    }
}

impl Profile {
    /// Those of this version.
    pub fn built_in() -> Vec<Self> {
        let profiles = EMBEDDED.iter().map(|profile| Self {
            name: profile.name,
            kind: profile.kind.name(),
            help: profile.description().to_owned(),
        });
        profiles.collect()
    }
}

fn setting(section: &str, field: &Field, defaults: &Value) -> Setting {
    let (kind, choices, count) = match field.kind {
        Kind::Number => (SettingKind::Number, None, None),
        Kind::Count => (SettingKind::Integer, None, None),
        Kind::Share => (SettingKind::Percent, None, None),
        Kind::Flag => (SettingKind::Boolean, None, None),
        Kind::Text => (SettingKind::Text, None, None),
        Kind::Choice(words) => (SettingKind::Choice, Some(words), None),
        Kind::Numbers(count) => (SettingKind::List, None, Some(count)),
        Kind::List => (SettingKind::List, None, None),
    };
    Setting {
        key: format!("{section}.{}", field.name),
        help: field.doc.trim(),
        kind,
        unit: field.unit,
        min: field.range.map(|range| range.0),
        max: field.range.map(|range| range.1),
        choices,
        count,
        default: defaults[section][field.name].clone(),
        per_object: ObjectSettings::SECTIONS.contains(&section),
    }
}

/// `first_layer` as `First layer`.
fn title(name: &str) -> String {
    let mut letters = name.chars();
    let first = letters.next().map(|first| first.to_uppercase().collect::<String>()).unwrap_or_default();
    (first + letters.as_str()).replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_for_people() {
        assert_eq!(title("first_layer"), "First layer");
    }
}
