//! The definition of a setting: type, unit, range and meaning, written beside the struct of the stage that reads it.
//!
//! [`section!`] makes a struct of options with its defaults and the table of its keys; [`choice!`] makes an option that is
//! one of a few words. `profile` joins the sections of all stages.

mod read;

pub(crate) use read::Reader;

use crate::units::{Celsius, Mm, Mm3, Mm3PerS, MmPerS, MmPerS2, Ratio, Seconds};

/// The kind of a key's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number with a unit.
    Number,
    /// A whole number, not negative.
    Count,
    /// A share: `0.15` or `"15%"`.
    Share,
    /// `true` or `false`.
    Flag,
    /// Any text.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A list of exactly this many numbers.
    Numbers(usize),
    /// A list of any number of numbers.
    List,
}

/// A Rust type that may stand in a section.
pub trait FieldType {
    /// What the key takes.
    const KIND: Kind;
    /// Unit of its numbers; empty: none.
    const UNIT: &'static str = "";
}

macro_rules! field_types {
    ($($ty:ty: $kind:expr, $unit:literal;)*) => {$(
        impl FieldType for $ty {
            const KIND: Kind = $kind;
            const UNIT: &'static str = $unit;
        }
    )*};
}

field_types! {
    Mm: Kind::Number, "mm";
    MmPerS: Kind::Number, "mm/s";
    MmPerS2: Kind::Number, "mm/s²";
    Mm3: Kind::Number, "mm³";
    Mm3PerS: Kind::Number, "mm³/s";
    Seconds: Kind::Number, "s";
    Celsius: Kind::Number, "°C";
    f64: Kind::Number, "";
    u32: Kind::Count, "";
    Ratio: Kind::Share, "";
    bool: Kind::Flag, "";
    String: Kind::Text, "";
}

impl FieldType for Vec<f64> {
    const KIND: Kind = Kind::List;
}

impl<T: FieldType, const N: usize> FieldType for [T; N] {
    const KIND: Kind = Kind::Numbers(N);
    const UNIT: &'static str = T::UNIT;
}

/// One key within its section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Name, without the section.
    pub name: &'static str,
    /// Meaning, as in the struct's documentation.
    pub doc: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Unit of its numbers; empty: none.
    pub unit: &'static str,
    /// Least and greatest value allowed, both included.
    pub range: Option<(f64, f64)>,
}

/// One `[section]` of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Name in brackets.
    pub name: &'static str,
    /// Meaning.
    pub doc: &'static str,
    /// Its keys.
    pub fields: &'static [Field],
}

/// The unit written beside a key, or else its type's.
pub const fn first_unit(own: &[&'static str], of_type: &'static str) -> &'static str {
    if own.is_empty() { of_type } else { own[0] }
}

/// The range written beside a key, if any.
pub const fn first_range(own: &[(f64, f64)]) -> Option<(f64, f64)> {
    if own.is_empty() { None } else { Some(own[0]) }
}

impl Field {
    /// The accepted values in words: `a number from 0.01 to 2 mm`.
    pub fn expected(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let span = match self.range {
            Some((low, high)) => format!(" from {low} to {high}"),
            None => String::new(),
        };
        match self.kind {
            Kind::Number => format!("a number{span}{unit}"),
            Kind::Count => format!("a whole number{span}"),
            Kind::Share => {
                let (low, high) = self.range.unwrap_or((0.0, 1.0));
                format!("a share{span}, or \"{}%\" to \"{}%\"", low * 100.0, high * 100.0)
            }
            Kind::Flag => "true or false".into(),
            Kind::Text => "a text in quotes".into(),
            Kind::Choice(names) => format!("one of {}", names.join(", ")),
            Kind::List => format!("a list of numbers{span}{unit}"),
            Kind::Numbers(count) => format!("a list of {count} numbers{span}{unit}"),
        }
    }
}

/// An option that is one of a few words: an enum whose variants stand beside their spelling.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$vdoc:meta])* $variant:ident = $text:literal,)* }) => {
        ordering::choice! {
            $(#[$doc])*
            #[derive(serde::Serialize, serde::Deserialize)]
            $name { $($(#[$vdoc])* #[serde(rename = $text)] $variant = $text,)* }
        }

        impl $crate::options::FieldType for $name {
            const KIND: $crate::options::Kind = $crate::options::Kind::Choice($name::NAMES);
        }
    };
}
pub(crate) use choice;

/// A section of the settings: the struct, its defaults, and what is known about each key.
/// After the default come the allowed range and, where the type does not give it, the unit.
macro_rules! section {
    ($(#[doc = $doc:literal])* $name:ident { $(
        $(#[doc = $fdoc:literal])* $field:ident: $ty:ty = $default:expr
            $(; $low:literal..=$high:literal $(, $unit:literal)?)?,
    )* }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(try_from = "toml::Table")]
        pub struct $name { $($(#[doc = $fdoc])* pub $field: $ty,)* }

        impl Default for $name {
            fn default() -> Self { Self { $($field: $default,)* } }
        }

        impl TryFrom<toml::Table> for $name {
            type Error = toml::de::Error;

            fn try_from(table: toml::Table) -> Result<Self, Self::Error> {
                let (mut reader, mut read) = ($crate::options::Reader::new(table), Self::default());
                $(reader.demand(stringify!($field), &mut read.$field);)*
                reader.end(read)
            }
        }

        impl $name {
            pub(crate) const DOC: &'static str = concat!($($doc),*);
            pub(crate) const FIELDS: &'static [$crate::options::Field] = &[$($crate::options::Field {
                name: stringify!($field),
                doc: concat!($($fdoc),*),
                kind: <$ty as $crate::options::FieldType>::KIND,
                unit: $crate::options::first_unit(&[$($($unit,)?)?], <$ty as $crate::options::FieldType>::UNIT),
                range: $crate::options::first_range(&[$(($low as f64, $high as f64))?]),
            },)*];
        }
    };
}
pub(crate) use section;
