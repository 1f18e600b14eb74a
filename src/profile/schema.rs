//! Every key of every section.

use super::settings::SECTIONS;
use crate::options::Field;

/// Every key as `section.name`, in the order of the documentation.
pub fn keys() -> impl Iterator<Item = (String, &'static Field)> {
    SECTIONS.iter().flat_map(|section| {
        section.fields.iter().map(|field| (format!("{}.{}", section.name, field.name), field))
    })
}

/// What is known about a dotted key.
pub fn field(key: &str) -> Option<&'static Field> {
    let (section, name) = key.split_once('.')?;
    SECTIONS.iter().find(|s| s.name == section)?.fields.iter().find(|f| f.name == name)
}
