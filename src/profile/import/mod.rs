//! Configurations of PrusaSlicer, SuperSlicer and Slic3r as profiles.
//!
//! [`table`] says key by key what is taken over and how. What is not is reported with the reason; nothing is guessed.

mod bed;
mod convert;
mod figures;
mod idle;
mod page;
mod row;
mod several;
mod swap;
mod table;
mod variables;

use std::collections::BTreeMap;
use std::path::Path;

use toml::Value;

use super::tools::{MOST_TOOLS, may_differ};
use crate::presets::{Config, Place};
pub use figures::{KeyFigures, import_figures};
pub use page::page as import_page;
use row::{Outcome, Row};
use table::{ROWS, SCRIPT};

/// A setting of ours that a configuration gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// Dotted.
    pub key: &'static str,
    /// As our profiles write it.
    pub value: Value,
    /// Where theirs is written.
    pub place: Place,
    /// Their key.
    pub from: &'static str,
    /// In what it differs.
    pub note: Option<String>,
}

/// A setting of theirs that has no counterpart.
#[derive(Clone, Debug, PartialEq)]
pub struct Left {
    /// Where it is written.
    pub place: Place,
    /// Their key.
    pub key: String,
    /// As written.
    pub value: String,
    /// Why there is none.
    pub reason: String,
}

/// A configuration, read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Import {
    /// In the order of the table.
    pub taken: Vec<Taken>,
    /// In the order of the file.
    pub left: Vec<Left>,
    /// Names and values for scripts, in the order of the names.
    pub variables: Vec<(String, Value)>,
    /// Of each extruder, where there are several, the settings that are not those of the first.
    pub tools: Vec<Vec<Taken>>,
    /// How many keys ask for nothing that would not be so without them.
    pub idle: usize,
}

impl Import {
    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, or holds no configuration.
    pub fn read(path: &Path) -> Result<Self, String> {
        Ok(Self::of(&Config::read(path)?))
    }

    /// What a configuration comes to.
    pub fn of(config: &Config) -> Self {
        let mut import = Self { variables: variables::all(config), ..Self::default() };
        // Of each of their keys whether it was of use in one row at least.
        let mut used: BTreeMap<&str, bool> = BTreeMap::new();
        let mut left: BTreeMap<&str, String> = BTreeMap::new();
        for row in ROWS {
            // An empty script is one: it stands for no other.
            let set = |key: &&'static str| {
                config.text(key).is_some() || (row.rule == SCRIPT && config.entries.contains_key(*key))
            };
            let Some(&from) = row.theirs.iter().find(|key| set(key)) else { continue };
            let outcome = match convert::row(row, config) {
                Outcome::Value(value) => checked(row, value, None),
                Outcome::Near(value, note) => checked(row, value, Some(note)),
                other => Err(other),
            };
            let is_taken = outcome.is_ok();
            match outcome {
                Ok((value, note)) => {
                    let place = config.entries[from].place.clone();
                    import.taken.push(Taken { key: row.ours, value, place, from, note });
                }
                Err(Outcome::Left(reason)) => {
                    left.entry(from).or_insert(reason);
                }
                Err(_) => {}
            }
            for &key in row.theirs.iter().filter(|key| set(key)) {
                *used.entry(key).or_default() |= is_taken;
            }
        }
        for (key, entry) in &config.entries {
            let reason = match used.get(key.as_str()) {
                Some(true) => continue,
                Some(false) => left.remove(key.as_str()),
                // Nobody asked for what is built in.
                None if entry.place.is_built_in() => None,
                None => unknown(key, config),
            };
            match reason {
                None => import.idle += 1,
                Some(reason) => {
                    let (key, value) = (key.clone(), entry.value.clone());
                    import.left.push(Left { place: entry.place.clone(), key, value, reason });
                }
            }
        }
        import.left.sort_by(|a, b| a.place.cmp(&b.place));
        if config.extruders() > 1 {
            let count = config.extruders().min(MOST_TOOLS);
            import.tools = (0..count).map(|extruder| import.of_tool(config, extruder)).collect();
        }
        import
    }

    /// The settings of an extruder that are not those of the first.
    fn of_tool(&self, config: &Config, extruder: usize) -> Vec<Taken> {
        let own = config.of_extruder(extruder);
        // Widths that are stated are the same for every nozzle; ours would be in proportion.
        let is_other_nozzle = own.number("nozzle_diameter") != config.number("nozzle_diameter");
        let differs = |row: &Row| {
            let &from = row.theirs.iter().find(|key| own.text(key).is_some())?;
            let (value, note) = match convert::row(row, &own) {
                Outcome::Value(value) => checked(row, value, None).ok()?,
                Outcome::Near(value, note) => checked(row, value, Some(note)).ok()?,
                _ => return None,
            };
            let first = self.taken.iter().find(|taken| taken.key == row.ours);
            let place = own.entries[from].place.clone();
            let is_same = first.map(|taken| &taken.value) == Some(&value);
            (!is_same || is_other_nozzle && row.ours.ends_with("width")).then_some(Taken {
                key: row.ours,
                value,
                place,
                from,
                note,
            })
        };
        ROWS.iter().filter(|row| may_differ(row.ours)).filter_map(differs).collect()
    }

    /// One line that says how much was not taken over, and which command lists it; `None`: nothing.
    pub fn summary(&self, command: &str) -> Option<String> {
        let near = self.taken.iter().filter(|taken| taken.note.is_some()).count();
        let parts = [(self.left.len(), "not taken over"), (near, "taken over with a difference")];
        let parts: Vec<String> =
            parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        let all = self.taken.len() + self.left.len();
        (!parts.is_empty()).then(|| format!("of {all} settings {}; `{command}` lists them", parts.join(", ")))
    }
}

/// A value that our key allows.
fn checked(row: &Row, value: Value, note: Option<String>) -> Result<(Value, Option<String>), Outcome> {
    match super::value::check(row.ours, &value) {
        Ok(()) => Ok((value, note)),
        Err(expected) => Err(Outcome::Left(format!("{}: {expected}", row.ours))),
    }
}

/// Why a key without a row is not taken over; `None`: as it stands it asks for nothing.
fn unknown(key: &str, config: &Config) -> Option<String> {
    let value = config.text(key)?;
    let is_idle = idle::of(key).any(|idle| idle.holds(value, config)) || config.is_as_built_in(key);
    (!is_idle).then(|| idle::reason(key).to_owned())
}

/// Where in the one file that is shown, or that it is built in.
fn line(place: &Place) -> String {
    if place.is_built_in() { place.to_string() } else { format!("line {}", place.line) }
}

/// The profile that a configuration amounts to, each key with where it comes from, and after it all that is left out.
pub(super) fn as_profile(name: &str, import: &Import) -> String {
    let mut out = format!("description = {}\n", Value::String(format!("From {name}")));
    for section in super::settings::SECTIONS {
        let dotted = format!("{}.", section.name);
        let own: Vec<&Taken> = import.taken.iter().filter(|taken| taken.key.starts_with(&dotted)).collect();
        if own.is_empty() {
            continue;
        }
        out += &format!("\n[{}]\n", section.name);
        for taken in own {
            let note = taken.note.as_ref().map(|note| format!(": {note}")).unwrap_or_default();
            let (key, value) = (&taken.key[dotted.len()..], super::value::toml_text(&taken.value));
            out += &match value.contains('\n') {
                true => format!("# {}, {}{note}\n{key} = {value}\n", line(&taken.place), taken.from),
                false => format!("{key} = {value} # {}, {}{note}\n", line(&taken.place), taken.from),
            };
        }
    }
    for tool in &import.tools {
        out += "\n[[tools]]\n";
        for taken in tool {
            let note = taken.note.as_ref().map(|note| format!(": {note}")).unwrap_or_default();
            let (place, value) = (line(&taken.place), super::value::toml_text(&taken.value));
            out += &format!("# {place}, {}{note}\n{} = {value}\n", taken.from, taken.key);
        }
    }
    if !import.variables.is_empty() {
        out += "\n[variables]\n";
    }
    for (name, value) in &import.variables {
        out += &format!("{name} = {}\n", super::value::toml_text(value));
    }
    if !import.left.is_empty() {
        out += "\n# Not taken over:\n";
    }
    for left in &import.left {
        let value: String = left.value.chars().take(60).collect();
        out += &format!("# {}: {} = {value}: {}\n", line(&left.place), left.key, left.reason);
    }
    if import.idle > 0 {
        out += &format!("\n# {} more ask for nothing, or for what is so anyway.\n", import.idle);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::schema;

    fn import(text: &str) -> Import {
        Import::of(&Config::parse(&text.lines().map(str::to_owned).collect::<Vec<_>>()).unwrap())
    }

    fn value(text: &str, key: &str) -> Option<Value> {
        import(text).taken.into_iter().find(|taken| taken.key == key).map(|taken| taken.value)
    }

    #[test]
    fn every_row_gives_a_key_that_there_is() {
        for row in ROWS {
            assert!(schema::field(row.ours).is_some(), "{}", row.ours);
            assert!(!row.theirs.is_empty(), "{}", row.ours);
        }
        let mut ours: Vec<&str> = ROWS.iter().map(|row| row.ours).collect();
        ours.sort_unstable();
        ours.dedup();
        assert_eq!(ours.len(), ROWS.len(), "each once");
    }

    #[test]
    fn relative_speeds_are_of_what_they_are_relative_to() {
        let speeds = "perimeter_speed = 60\nexternal_perimeter_speed = 50%\ninfill_speed = 80\n\
                      solid_infill_speed = 50%\ntop_solid_infill_speed = 50%\n";
        for (key, speed) in [("external_perimeter", 30.0), ("solid", 40.0), ("top", 20.0)] {
            assert_eq!(value(speeds, &format!("speed.{key}")), Some(Value::Float(speed)), "{key}");
        }
        assert_eq!(value("external_perimeter_speed = 50%\n", "speed.external_perimeter"), None);
    }

    #[test]
    fn accelerations_of_0_are_the_default_one_and_that_the_machines() {
        let machine = "machine_max_acceleration_extruding = 1500\ntravel_acceleration = 0\n";
        assert_eq!(value(machine, "acceleration.travel"), None, "what the machine has is not stated");
        assert_eq!(value(machine, "acceleration.default"), Some(Value::Float(1500.0)));
        let relative = "default_acceleration = 1000\nperimeter_acceleration = 50%\nbridge_flow_ratio = 95%\n";
        assert_eq!(value(relative, "acceleration.external_perimeter"), Some(Value::Float(500.0)));
        assert_eq!(value(relative, "bridge.flow"), Some(Value::Float(0.95)));
    }

    #[test]
    fn a_z_speed_of_0_is_the_machines_limit_and_automatic_speeds_are_the_greatest() {
        let z = "travel_speed_z = 0\ntravel_speed = 180\n";
        assert_eq!(value(z, "speed.z"), None);
        assert_eq!(value(&format!("{z}machine_max_feedrate_z = 12\n"), "speed.z"), Some(Value::Float(12.0)));
        let speeds = "infill_speed = 0\nmax_print_speed = 200\nfill_pattern = grid\n\
                      filament_infill_max_crossing_speed = 140\nfilament_infill_max_speed = 250\n";
        assert_eq!(value(speeds, "speed.infill"), Some(Value::Float(140.0)), "grid lines cross");
        assert_eq!(
            value("perimeter_speed = 0\nmax_print_speed = 200\n", "speed.perimeter"),
            Some(Value::Float(200.0))
        );
    }

    #[test]
    fn fans_follow_layer_times_and_overhangs_as_presets_say() {
        let fans = "cooling = 1\nfan_always_on = 0\nmin_fan_speed = 35\nmax_fan_speed = 100\n\
                    fan_below_layer_time = 60\nslowdown_below_layer_time = 5\nbridge_fan_speed = 80\n\
                    full_fan_speed_layer = 4\ndisable_fan_first_layers = 1\nenable_dynamic_fan_speeds = 1\n\
                    overhang_fan_speed_0 = 70\noverhang_fan_speed_1 = 60\noverhang_fan_speed_2 = 50\n\
                    overhang_fan_speed_3 = 40\n";
        let known = [
            ("fan", "0.0"),
            ("short_layer_fan", "[0.35, 1.0]"),
            ("short_layer_time", "60.0"),
            ("full_fan_layer", "3"),
            ("overhang_fan_steps", "[0.4, 0.5, 0.6, 0.8]"),
        ];
        for (key, wanted) in known {
            let found = value(fans, &format!("cooling.{key}")).map(|value| value.to_string());
            assert_eq!(found.as_deref(), Some(wanted), "{key}");
        }
    }

    #[test]
    fn filaments_override_the_retraction_of_printers_and_lifts_may_be_ramps() {
        let lifts = "retract_lift = 0.2\ntravel_ramping_lift = 1\ntravel_max_lift = 1.5\ntravel_slope = 1\n\
                     filament_travel_max_lift = 0.6\nfilament_travel_slope = nil\nretract_layer_change = 1\n\
                     filament_retract_layer_change = 0\nretract_before_wipe = 80%,80%\nfilament_retract_lift_below = nil\n\
                     retract_lift_below = 199\n";
        let known = [
            ("z_hop", "0.6"),
            ("z_hop_slope", "1.0"),
            ("z_hop_before_leaving", "false"),
            ("layer_change", "false"),
            ("before_wipe", "0.8"),
            ("z_hop_below", "199.0"),
        ];
        for (key, wanted) in known {
            let found = value(lifts, &format!("retract.{key}")).map(|value| value.to_string());
            assert_eq!(found.as_deref(), Some(wanted), "{key}");
        }
    }

    #[test]
    fn widths_fall_back_on_the_common_one() {
        let widths = "nozzle_diameter = 0.4\nlayer_height = 0.2\nextrusion_width = 0.5\n\
                      perimeter_extrusion_width = 0\ninfill_extrusion_width = 200%\n";
        assert_eq!(value(widths, "walls.width"), Some(Value::Float(0.5)));
        assert_eq!(value(widths, "infill.width"), Some(Value::Float(0.4)));
    }

    #[test]
    fn what_is_not_taken_over_is_told_and_what_is_off_is_not() {
        let import =
            import("layer_height = 0.2\ninfill_first = 1\nwipe_tower = 0\nfill_pattern = scribble\n");
        let left: Vec<(&str, usize)> = import.left.iter().map(|l| (l.key.as_str(), l.place.line)).collect();
        assert_eq!(left, [("infill_first", 2), ("fill_pattern", 4)]);
        assert_eq!(import.idle, 1);
        assert_eq!(import.left[0].reason, "walls are printed before infill");
        assert!(import.left[1].reason.contains("scribble"), "{}", import.left[1].reason);
    }

    #[test]
    fn keys_that_ask_for_nothing_have_no_row_and_no_reason_besides() {
        for (pattern, _) in idle::IDLE {
            assert!(
                ROWS.iter().all(|row| !row.theirs.contains(pattern) || row.ours == "printer.name"),
                "{pattern}"
            );
        }
        for row in ROWS {
            for key in row.theirs {
                assert!(!idle::REASONS.iter().any(|(pattern, _)| pattern == key), "{key}");
            }
        }
    }

    #[test]
    fn what_one_tool_has_no_use_for_is_idle_and_thin_walls_with_walls_of_variable_width() {
        let tools = import("wipe_tower = 1\nooze_prevention = 1\nwipe_tower_width = 60\n");
        assert_eq!((tools.left, tools.idle), (vec![], 3));
        let walls = |generator: &str| {
            let left = import(&format!("thin_walls = 0\nperimeter_generator = {generator}\n")).left;
            left.into_iter().map(|left| left.key).collect::<Vec<_>>()
        };
        assert_eq!(walls("arachne"), Vec::<String>::new());
        assert_eq!(walls("classic"), ["thin_walls"]);
    }

    #[test]
    fn each_extruder_is_a_tool_with_what_it_has_of_its_own() {
        let two = "nozzle_diameter = 0.4,0.6\ntemperature = 210,235\nfilament_colour = #FF0000;#00FF00\nretract_length = 1,1\n\
                   retract_length_toolchange = 8,12\nextruder_offset = 0x0,25x-1\ntoolchange_gcode = T[next_extruder]\n\
                   single_extruder_multi_material = 0\n";
        let import = import(two);
        let own: Vec<Vec<(&str, String)>> = import
            .tools
            .iter()
            .map(|tool| tool.iter().map(|taken| (taken.key, taken.value.to_string())).collect())
            .collect();
        assert_eq!(own[0], []);
        for (key, value) in [
            ("printer.nozzle_diameter", "0.6"),
            ("temperature.nozzle", "235.0"),
            ("filament.color", "\"#00FF00\""),
            ("retract.change_length", "12.0"),
            ("tool.offset", "[25.0, -1.0]"),
        ] {
            assert!(own[1].contains(&(key, value.to_owned())), "{key}: {own:?}");
        }
        assert!(own[1].iter().all(|(key, _)| *key != "retract.length"), "it is the same");
        assert_eq!(value(two, "tool_change.kind"), Some(Value::String("tool-changer".into())));
        let script = |nozzles: &str| {
            value(&format!("nozzle_diameter = {nozzles}\ntoolchange_gcode = P0\\nT1\n"), "tool_change.script")
        };
        assert_eq!(script("0.4,0.4"), Some(Value::String("P0\nT1\n".into())));
        assert_eq!(script("0.4"), None);
    }

    #[test]
    fn tools_that_a_change_parks_are_not_in_the_way_of_others() {
        let ahead = |script: &str| {
            let two = "nozzle_diameter = 0.4,0.4\nsingle_extruder_multi_material = 0\n";
            value(&format!("{two}toolchange_gcode = {script}\n"), "tool_change.ahead")
        };
        assert_eq!(ahead("P0\\nT[next_extruder]"), Some(Value::Float(0.0)));
        // As it is written for the Original Prusa XL.
        assert_eq!(ahead("{\\nif true then\\n      \"P0 S1 L2 D0\\n\";\\nendif\\n}T1 S1 L0 D0"), None);
    }

    #[test]
    fn widths_that_are_stated_are_those_of_every_nozzle_and_others_follow_each() {
        let widths = |text: &str| {
            let import = import(&format!("nozzle_diameter = 0.4,0.6\n{text}"));
            let width = |key: &str| {
                import.tools[1].iter().find(|taken| taken.key == key).map(|t| t.value.to_string())
            };
            [width("walls.width"), width("infill.width")]
        };
        assert_eq!(widths("perimeter_extrusion_width = 0.5\n"), [Some("0.5".into()), None]);
        assert_eq!(widths("extrusion_width = 0\nperimeter_extrusion_width = 0\n")[0], Some("0.675".into()));
    }

    #[test]
    fn flushes_of_a_single_nozzle_are_those_of_the_matrix_or_of_each_filament() {
        let volumes = |text: &str| {
            let head = "nozzle_diameter = 0.4,0.4\nsingle_extruder_multi_material = 1\n";
            value(&format!("{head}{text}"), "tool_change.flush_volumes").map(|value| value.to_string())
        };
        assert_eq!(volumes("wiping_volumes_matrix = 0,120,80,0\n"), Some("[0.0, 120.0, 80.0, 0.0]".into()));
        assert_eq!(
            volumes("wiping_volumes_extruders = 50,60,20,30\n"),
            Some("[0.0, 80.0, 80.0, 0.0]".into())
        );
        let purge = "wiping_volumes_matrix = 0,1,1,0\nwiping_volumes_use_custom_matrix = 0\nmultimaterial_purging = 100\n";
        let purge = format!("{purge}filament_purge_multiplier = 50%,200%\n");
        assert_eq!(volumes(&purge), Some("[0.0, 200.0, 50.0, 0.0]".into()));
        assert_eq!(volumes("temperature = 200,210\n"), None, "then it is by the colors");
    }

    #[test]
    fn values_out_of_our_range_are_left_out() {
        let import = import("perimeters = 1000\n");
        assert!(import.taken.is_empty() && import.left[0].reason.contains("0 to 100"), "{:?}", import.left);
    }
}
