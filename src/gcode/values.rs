//! The values that scripts can refer to.

use super::number::text;
use super::settings::PrintFacts;
use crate::profile::{BedOrigin, Settings};

/// How far `{end_z}` lies above the print.
const END_LIFT_MM: f64 = 10.0;

/// Name and text of every placeholder.
///
/// | name | value |
/// |---|---|
/// | `nozzle_temp`, `bed_temp` | temperatures of the first layer, °C |
/// | `nozzle_temp_other`, `bed_temp_other` | temperatures of the other layers |
/// | `bed_size_x`, `bed_size_y`, `bed_height` | size of the printable volume, mm |
/// | `bed_min_x`, `bed_min_y`, `bed_max_x`, `bed_max_y` | its limits, mm |
/// | `print_min_x`, `print_min_y`, `print_max_x`, `print_max_y`, `print_max_z` | limits of the print, mm |
/// | `end_z` | 10 mm above the print, but inside the volume |
/// | `layer_height`, `first_layer_height`, `nozzle_diameter`, `filament_diameter` | mm |
/// | `retract_length` | filament pulled back, mm |
/// | `retract_f`, `travel_f`, `z_f` | feed rates of retraction, travel and lift, mm/min |
/// | `layer_count` | number of layers |
/// | `filament`, `printer` | material and printer name as the profile writes them |
#[derive(Clone, Debug, PartialEq)]
pub struct Values(Vec<(&'static str, String)>);

impl Values {
    /// The values of a print.
    pub fn new(settings: &Settings, facts: &PrintFacts) -> Self {
        let bed = &settings.bed;
        let size = [bed.size[0].0, bed.size[1].0];
        let min = match bed.origin {
            BedOrigin::Corner => [0.0, 0.0],
            BedOrigin::Center => [-0.5 * size[0], -0.5 * size[1]],
        };
        let temperature = &settings.temperature;
        let end_z_mm = (facts.max_z_mm + END_LIFT_MM).min(bed.height.0).max(facts.max_z_mm);
        let numbers = [
            ("nozzle_temp", temperature.nozzle_first_layer.0),
            ("nozzle_temp_other", temperature.nozzle.0),
            ("bed_temp", temperature.bed_first_layer.0),
            ("bed_temp_other", temperature.bed.0),
            ("bed_size_x", size[0]),
            ("bed_size_y", size[1]),
            ("bed_height", bed.height.0),
            ("bed_min_x", min[0]),
            ("bed_min_y", min[1]),
            ("bed_max_x", min[0] + size[0]),
            ("bed_max_y", min[1] + size[1]),
            ("print_min_x", facts.min_mm[0]),
            ("print_min_y", facts.min_mm[1]),
            ("print_max_x", facts.max_mm[0]),
            ("print_max_y", facts.max_mm[1]),
            ("print_max_z", facts.max_z_mm),
            ("end_z", end_z_mm),
            ("layer_height", settings.layer.height.0),
            ("first_layer_height", settings.layer.first_height.0),
            ("nozzle_diameter", settings.printer.nozzle_diameter.0),
            ("filament_diameter", settings.filament.diameter.0),
            ("retract_length", settings.retract.length.0),
            ("retract_f", settings.retract.speed.0 * 60.0),
            ("travel_f", settings.speed.travel.0 * 60.0),
            ("z_f", settings.speed.z.0 * 60.0),
            ("layer_count", facts.layers as f64),
        ];
        let texts = [
            ("filament", one_line(&settings.filament.material)),
            ("printer", one_line(&settings.printer.name)),
        ];
        Self(numbers.into_iter().map(|(name, value)| (name, text(value, 3))).chain(texts).collect())
    }

    /// The value of a placeholder.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| *known == name).map(|(_, value)| value.as_str())
    }

    /// Every placeholder there is.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|(name, _)| *name)
    }
}

/// Free text as it may stand in a command or comment: no line ends or other control characters, and no
/// semicolon, which would begin a comment.
pub(super) fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| match c {
            ';' => ',',
            c if c.is_control() => ' ',
            c => c,
        })
        .collect()
}
