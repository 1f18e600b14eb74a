//! SuperSlicer's presets, which say much in words and percentages of their own, in PrusaSlicer's words.

mod fans;
mod keys;
mod lines;
mod speeds;
mod variables;
mod words;

pub(super) use keys::{all as all_keys, find as find_key};

use super::config::{Config, Place};
use super::keys::key_type;

/// Whether no other slicer writes such a line.
pub(super) fn is_own_line(key: &str, value: &str) -> bool {
    const KEYS: [&str; 4] =
        ["first_layer_size_compensation", "extrusion_spacing", "overhangs_width_speed", NOZZLE_OFFSET];
    KEYS.contains(&key) || key == "start_gcode" && value.contains(NOZZLE_OFFSET)
}

const NOZZLE_OFFSET: &str = "extruder_temperature_offset";

/// Keys and values by the names of today, those that were older first: of a key under both names the newer one says it.
pub(super) fn called_today<'a, T>(
    said: impl Iterator<Item = (&'a str, &'a str, T)>,
) -> Vec<(&'a str, &'a str, T)> {
    let mut today: Vec<(bool, (&str, &str, T))> = said
        .map(|(key, value, more)| match renamed(key, value) {
            Some((name, other)) => (false, (name, other.unwrap_or(value), more)),
            None => (true, (key, value, more)),
        })
        .collect();
    today.sort_by_key(|(is_new, _)| *is_new);
    today.into_iter().map(|(_, said)| said).collect()
}

/// What an older key is called now, and its value, where that is another, too.
fn renamed(key: &str, value: &str) -> Option<(&'static str, Option<&'static str>)> {
    let is_on = value == "1";
    let either = |on: &'static str, off: &'static str| Some(if is_on { on } else { off });
    Some(match key {
        "overhangs" => ("overhangs_width_speed", either("50%", "0")),
        "thick_bridges" => ("bridge_type", either("nozzle", "flow")),
        "infill_not_connected" => ("infill_connection", either("notconnected", "connected")),
        "thin_perimeters" if is_on => ("thin_perimeters", Some("100%")),
        "seam_travel" if is_on => ("seam_travel_cost", Some("200%")),
        "retract_lift_not_last_layer" => ("retract_lift_top", either("\"Not on top\"", "\"All surfaces\"")),
        "support_material_contact_distance_top" => ("support_material_contact_distance", None),
        "support_material_contact_distance_bottom" => ("support_material_bottom_contact_distance", None),
        "brim_offset" => ("brim_separation", None),
        "gap_fill" => ("gap_fill_enabled", None),
        "label_printed_objects" => ("gcode_label_objects", None),
        "wipe_tower_brim" => ("wipe_tower_brim_width", None),
        _ => return None,
    })
}

/// Puts what a configuration says into PrusaSlicer's words. Its scripts see it as it was written.
pub(super) fn translate(config: &mut Config) {
    variables::add(config);
    lines::translate(config);
    speeds::translate(config);
    fans::translate(config);
    words::translate(config);
}

impl Config {
    /// Says a value anew, in place of what a key says; where it is not known, as it was.
    fn say(&mut self, key: &str, value: Option<f64>, from: &str) {
        if let (Some(value), Some(place)) = (value, self.place(from)) {
            self.say_at(key, &written(value), place);
        }
    }

    /// Says the number of each extruder anew, from its index and what it was. Whether there were any.
    fn say_each(&mut self, key: &str, value: impl Fn(usize, f64) -> f64) -> bool {
        let (Some(own), Some(place)) = (self.numbers_of_extruders(key), self.place(key)) else {
            return false;
        };
        let said: Vec<String> = own.into_iter().enumerate().map(|(i, own)| written(value(i, own))).collect();
        self.say_at(key, &said.join(","), place);
        true
    }

    /// The numbers of all extruders.
    fn numbers_of_extruders(&self, key: &str) -> Option<Vec<f64>> {
        let (_, written) = self.lists.get(key)?;
        written.split(',').map(|number| number.trim().parse().ok()).collect()
    }

    fn say_at(&mut self, key: &str, value: &str, place: Place) {
        self.set_known(key, value, key_type(key), place);
    }

    fn place(&self, key: &str) -> Option<Place> {
        self.entries.get(key).map(|entry| entry.place.clone())
    }

    /// Takes a key away whose words mean what another now says.
    fn forget(&mut self, key: &str) {
        self.entries.remove(key);
        self.lists.remove(key);
    }
}

/// A number to a millionth.
fn written(value: f64) -> String {
    ((value * 1e6).round() / 1e6 + 0.0).to_string()
}
