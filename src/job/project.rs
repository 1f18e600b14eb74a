//! A project: what is on the plate and how it is printed, as the page, the service and project files hold it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

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
    #[serde(skip_serializing_if = "Option::is_none")]
    pub object: Option<usize>,
    /// What the model is for.
    pub role: ModelRole,
    /// Factors along X, Y and Z; a negative one mirrors.
    pub scale: [f64; 3],
    /// Angles about X, Y and Z, in this order, degrees.
    pub rotate_deg: [f64; 3],
    /// Where the middle of its box, seen from above, and its lowest point are, in the bed's coordinates, millimetres; `None`:
    /// it is arranged. Either all models of a project have a position or none has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<[f64; 3]>,
    /// How many of it; 1 where it has a position.
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
