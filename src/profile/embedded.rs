//! The profiles that are compiled in, as written and as parsed.

use toml::{Table, Value};

/// The kind of an embedded profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileKind {
    /// A machine: bed, limits, dialect, scripts, retraction.
    Printer,
    /// A filament: temperatures, density, cooling.
    Material,
    /// Layer heights, widths, speeds, infill.
    Quality,
    /// All three.
    Job,
}

impl ProfileKind {
    /// As `profiles list` prints it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Printer => "printer",
            Self::Material => "material",
            Self::Quality => "quality",
            Self::Job => "job",
        }
    }
}

/// A profile that is compiled in.
#[derive(Clone, Copy, Debug)]
pub struct EmbeddedProfile {
    /// By which it is chosen.
    pub name: &'static str,
    /// What it is about.
    pub kind: ProfileKind,
    /// TOML as written.
    pub text: &'static str,
}

impl EmbeddedProfile {
    /// Its own one-line description.
    pub fn description(&self) -> &'static str {
        match self.values().iter().find(|(key, _)| *key == "description") {
            Some((_, Written::Text(text))) => text,
            _ => "",
        }
    }

    /// What its text says.
    pub(super) fn table(&self) -> Table {
        table(self.values())
    }

    fn values(&self) -> &'static [(&'static str, Written)] {
        TABLES.iter().find(|(name, _)| *name == self.name).map_or(&[], |(_, values)| values)
    }
}

/// A value as the build parsed it.
enum Written {
    Text(&'static str),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    List(&'static [Written]),
    Table(&'static [(&'static str, Written)]),
}

impl Written {
    fn value(&self) -> Value {
        match *self {
            Self::Text(text) => text.into(),
            Self::Integer(number) => number.into(),
            Self::Float(number) => number.into(),
            Self::Boolean(truth) => truth.into(),
            Self::List(list) => Value::Array(list.iter().map(Self::value).collect()),
            Self::Table(entries) => Value::Table(table(entries)),
        }
    }
}

fn table(entries: &[(&str, Written)]) -> Table {
    entries.iter().map(|(key, written)| ((*key).to_owned(), written.value())).collect()
}

// `TABLES`: the values of each profile, by name.
include!(concat!(env!("OUT_DIR"), "/profiles.rs"));

/// Name of the profile that lies below all others.
pub const DEFAULT: &str = "default";

macro_rules! embedded {
    ($($kind:ident: $($name:literal)*;)*) => {
        /// Every embedded profile, by kind.
        pub static EMBEDDED: &[EmbeddedProfile] = &[$($(EmbeddedProfile {
            name: $name,
            kind: ProfileKind::$kind,
            text: include_str!(concat!("../../profiles/", $name, ".toml")),
        },)*)*];
    };
}

embedded! {
    Job: "default" "standard-job" "standard-job-fast" "speed";
    Printer: "reprap-250" "ender-3" "prusa-i3" "corexy-klipper" "delta-round";
    Material: "pla" "petg" "abs" "tpu";
    Quality: "0.1mm" "0.2mm" "0.3mm";
}

/// The embedded profile of that name.
pub fn find(name: &str) -> Option<&'static EmbeddedProfile> {
    EMBEDDED.iter().find(|profile| profile.name == name)
}

/// A script of the generic printer; it is written once, in its profile.
pub(super) fn default_script(key: &str) -> String {
    let written = find("reprap-250").map(EmbeddedProfile::table);
    let script = written.as_ref().and_then(|table| table.get("gcode")?.get(key)?.as_str());
    script.unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_those_of_the_text() {
        for profile in EMBEDDED {
            assert_eq!(profile.table(), profile.text.parse::<Table>().unwrap(), "{}", profile.name);
        }
    }
}
