//! Settings of objects that differ from those of the plate.

use crate::profile::{SECTIONS, Settings};

/// Settings of objects that differ from those of the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectSettings {
    /// Name of the objects: a file, with or without folder or extension, or an object in a 3MF file.
    pub object: String,
    /// All settings; of use are those of [`ObjectSettings::SECTIONS`].
    pub settings: Settings,
}

impl ObjectSettings {
    /// Sections that may differ from object to object.
    pub const SECTIONS: [&str; 6] = ["walls", "shell", "infill", "ironing", "bridge", "tool_of"];

    /// Keys of other sections that may, too.
    const KEYS: [&str; 1] = ["tool_change.flush_into_infill"];

    /// Why a setting is the same for all objects of a plate; `None`: it is not. Unknown sections are found out later.
    pub fn refusal(key: &str) -> Option<String> {
        let section = key.split('.').next().unwrap_or_default();
        let reason = match section {
            _ if Self::KEYS.contains(&key) => return None,
            _ if key.starts_with("tool_of.support") => "supports are planned for the plate as a whole",
            _ if Self::SECTIONS.contains(&section) => return None,
            "layer" | "first_layer" => "all objects of a plate share their layers",
            "skirt" | "brim" | "raft" | "support" => {
                "adhesion and supports are planned for the plate as a whole"
            }
            "seam" | "order" | "speed" | "acceleration" | "retract" | "travel" | "cooling" => {
                "how the nozzle moves is decided for whole layers, not for objects"
            }
            _ if SECTIONS.iter().any(|known| known.name == section) => {
                "it belongs to the printer or to the plate as a whole"
            }
            _ => return None,
        };
        Some(format!("{reason}; objects may differ in {}", Self::SECTIONS.join(", ")))
    }
}
