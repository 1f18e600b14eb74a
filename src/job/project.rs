//! A project: what is on the plate and how it is printed, as the page, the service and project files hold it.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize};

/// What is on the plate and how it is printed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Project {
    /// Presets of another slicer, by name, below everything else.
    pub presets: PresetNames,
    /// Built-in profiles by name, the later ones on top.
    pub profiles: Vec<String>,
    /// A profile of the user's as TOML, on top of those.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub profile: String,
    /// Dotted keys and values as they are typed after `--set`, on top of all profiles.
    pub settings: BTreeMap<String, String>,
    /// Models, in the order in which they are placed.
    pub models: Vec<ProjectModel>,
    /// Layers (`12`) or heights (`12.4mm`) at which the print stops.
    pub pauses: Vec<String>,
    /// Layers or heights at which it stops for filament of another color.
    pub color_changes: Vec<String>,
    /// Print also what begins in mid-air.
    pub allow_floating: bool,
    /// Prove how near to the shortest possible the order is.
    pub certify: bool,
}

/// Presets by name; without a print or filament preset, the printer's default one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct PresetNames {
    /// Printer preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub printer: Option<String>,
    /// Print preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub print: Option<String>,
    /// Filament preset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filament: Option<String>,
}

/// A model of a project.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ProjectModel {
    /// Name of the file that it is from, without folders.
    pub file: String,
    /// The object of the file, counted from 0; `None`: all of them, in the file's layout.
    #[cfg_attr(feature = "serve", schema(maximum = 1_000_000))]
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "object")]
    pub object: Option<usize>,
    /// What the model is for.
    pub role: ModelRole,
    /// Factors along X, Y and Z; a negative one mirrors.
    #[cfg_attr(feature = "serve", schema(min_items = 3, max_items = 3))]
    pub scale: [f64; 3],
    /// Angles about X, Y and Z, in this order, degrees.
    #[cfg_attr(feature = "serve", schema(min_items = 3, max_items = 3))]
    pub rotate_deg: [f64; 3],
    /// Where the middle of its box, seen from above, and its lowest point are, in the bed's coordinates, millimetres; `None`:
    /// it is arranged. Either all models of a project have a position or none has.
    #[cfg_attr(feature = "serve", schema(min_items = 3, max_items = 3))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<[f64; 3]>,
    /// How many of it; 1 where it has a position.
    #[cfg_attr(feature = "serve", schema(minimum = 1, maximum = 1000))]
    #[serde(deserialize_with = "copies")]
    pub copies: u32,
    /// Settings of its own, as those of the project.
    pub settings: BTreeMap<String, String>,
}

impl Default for ProjectModel {
    fn default() -> Self {
        Self {
            file: String::new(),
            object: None,
            role: ModelRole::Part,
            scale: [1.0; 3],
            rotate_deg: [0.0; 3],
            at_mm: None,
            copies: 1,
            settings: BTreeMap::new(),
        }
    }
}

/// Most copies of a model.
pub(super) const COPIES: u32 = 1000;

/// Most objects of a file.
const OBJECTS: u32 = 1_000_000;

/// A whole number, which JSON may also write as `3.0`.
fn whole<E: serde::de::Error>(name: &str, number: f64, [least, most]: [u32; 2]) -> Result<u32, E> {
    let whole = number as u32;
    match f64::from(whole) == number && (least..=most).contains(&whole) {
        true => Ok(whole),
        false => Err(E::custom(format!("{name}: {number} is no whole number from {least} to {most}"))),
    }
}

fn object<'de, D: Deserializer<'de>>(given: D) -> Result<Option<usize>, D::Error> {
    let object = Option::<f64>::deserialize(given)?;
    object.map(|number| whole("object", number, [0, OBJECTS]).map(|number| number as usize)).transpose()
}

fn copies<'de, D: Deserializer<'de>>(given: D) -> Result<u32, D::Error> {
    whole("copies", f64::deserialize(given)?, [1, COPIES])
}

/// What a model of a project is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "serve", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ModelRole {
    /// It is printed.
    #[default]
    Part,
    /// Overhangs inside it are supported.
    SupportEnforcer,
    /// Nothing inside it is supported.
    SupportBlocker,
}
