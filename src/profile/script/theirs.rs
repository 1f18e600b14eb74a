//! Our settings under the names that scripts for PrusaSlicer and OrcaSlicer have for them.

use macros::Value;

use crate::gcode::Flavor;
use crate::plate::Sequence;
use crate::profile::settings::Settings;

/// Names that mean one setting.
struct Row {
    /// PrusaSlicer's name, then OrcaSlicer's.
    names: &'static [&'static str],
    /// Our key.
    key: &'static str,
    value: fn(&Settings) -> Value,
}

const fn row(names: &'static [&'static str], key: &'static str, value: fn(&Settings) -> Value) -> Row {
    Row { names, key, value }
}

/// A number for each extruder, of which we use one.
fn each(value: f64) -> Value {
    Value::List(vec![Value::Real(value)])
}

/// A whole number for each extruder.
fn each_whole(value: f64) -> Value {
    Value::List(vec![Value::Integer(value.round() as i64)])
}

fn percent(share: f64) -> Value {
    Value::Percent((share * 1e6).round() / 1e4)
}

fn axes(values: [f64; 4], axis: usize) -> Value {
    each(values[axis])
}

const ROWS: &[Row] = &[
    row(&["temperature", "nozzle_temperature"], "temperature.nozzle", |s| each_whole(s.temperature.nozzle.0)),
    row(
        &["first_layer_temperature", "nozzle_temperature_initial_layer"],
        "temperature.nozzle_first_layer",
        |s| each_whole(s.temperature.nozzle_first_layer.0),
    ),
    row(&["bed_temperature"], "temperature.bed", |s| each_whole(s.temperature.bed.0)),
    row(
        &["first_layer_bed_temperature", "bed_temperature_initial_layer"],
        "temperature.bed_first_layer",
        |s| each_whole(s.temperature.bed_first_layer.0),
    ),
    row(&["bed_temperature_initial_layer_single"], "temperature.bed_first_layer", |s| {
        Value::Integer(s.temperature.bed_first_layer.0.round() as i64)
    }),
    row(&["layer_height"], "layer.height", |s| Value::Real(s.layer.height.0)),
    row(&["first_layer_height", "initial_layer_print_height"], "layer.first_height", |s| {
        Value::Real(s.layer.first_height.0)
    }),
    row(&["z_offset"], "layer.z_offset", |s| Value::Real(s.layer.z_offset.0)),
    row(&["nozzle_diameter"], "printer.nozzle_diameter", |s| each(s.printer.nozzle_diameter.0)),
    row(&["filament_type"], "filament.material", |s| {
        Value::List(vec![Value::Text(s.filament.material.clone())])
    }),
    row(&["filament_diameter"], "filament.diameter", |s| each(s.filament.diameter.0)),
    row(&["filament_density"], "filament.density", |s| each(s.filament.density)),
    row(&["filament_cost"], "filament.cost", |s| each(s.filament.cost)),
    row(&["extrusion_multiplier", "filament_flow_ratio"], "filament.flow", |s| each(s.filament.flow)),
    row(&["filament_max_volumetric_speed"], "filament.max_flow", |s| each(s.filament.max_flow.0)),
    row(&["max_print_height", "printable_height"], "bed.height", |s| Value::Real(s.bed.height.0)),
    row(&["retract_length", "retraction_length"], "retract.length", |s| each(s.retract.length.0)),
    row(&["retract_speed", "retraction_speed"], "retract.speed", |s| each(s.retract.speed.0)),
    row(&["deretract_speed", "deretraction_speed"], "retract.unretract_speed", |s| {
        each(s.retract.unretract_speed.0)
    }),
    row(&["retract_lift", "z_hop"], "retract.z_hop", |s| each(s.retract.z_hop.0)),
    row(&["retract_before_travel", "retraction_minimum_travel"], "retract.min_travel", |s| {
        each(s.retract.min_travel.0)
    }),
    row(&["use_firmware_retraction"], "retract.firmware", |s| Value::Flag(s.retract.firmware)),
    row(&["use_relative_e_distances"], "gcode.relative_e", |s| Value::Flag(s.gcode.relative_e)),
    row(&["travel_speed"], "speed.travel", |s| Value::Real(s.speed.travel.0)),
    row(&["travel_speed_z"], "speed.z", |s| Value::Real(s.speed.z.0)),
    row(&["perimeter_speed", "inner_wall_speed"], "speed.perimeter", |s| Value::Real(s.speed.perimeter.0)),
    row(&["external_perimeter_speed", "outer_wall_speed"], "speed.external_perimeter", |s| {
        Value::Real(s.speed.external_perimeter.0)
    }),
    row(&["infill_speed", "sparse_infill_speed"], "speed.infill", |s| Value::Real(s.speed.infill.0)),
    row(&["solid_infill_speed", "internal_solid_infill_speed"], "speed.solid", |s| {
        Value::Real(s.speed.solid.0)
    }),
    row(&["top_solid_infill_speed", "top_surface_speed"], "speed.top", |s| Value::Real(s.speed.top.0)),
    row(&["bridge_speed"], "speed.bridge", |s| Value::Real(s.speed.bridge.0)),
    row(&["first_layer_speed", "initial_layer_speed"], "first_layer.speed", |s| {
        Value::Real(s.first_layer.speed.0)
    }),
    row(&["default_acceleration"], "acceleration.default", |s| Value::Real(s.acceleration.default.0)),
    row(&["perimeters", "wall_loops"], "walls.count", |s| Value::Integer(i64::from(s.walls.count))),
    row(&["fill_density", "sparse_infill_density"], "infill.density", |s| percent(s.infill.density.0)),
    row(&["spiral_vase", "spiral_mode"], "spiral.enabled", |s| Value::Flag(s.spiral.enabled)),
    row(&["support_material", "enable_support"], "support.enabled", |s| Value::Flag(s.support.enabled)),
    row(&["raft_layers"], "raft.layers", |s| Value::Integer(i64::from(s.raft.layers))),
    row(&["brim_width"], "brim.width", |s| Value::Real(s.brim.width.0)),
    row(&["skirts", "skirt_loops"], "skirt.loops", |s| Value::Integer(i64::from(s.skirt.loops))),
    row(&["complete_objects"], "print.sequence", |s| Value::Flag(s.print.sequence == Sequence::Object)),
    row(&["gcode_flavor"], "printer.flavor", |s| {
        let name = match s.printer.flavor {
            Flavor::Marlin => "marlin2",
            Flavor::MarlinLegacy => "marlin",
            Flavor::Klipper => "klipper",
            Flavor::RepRapFirmware => "reprapfirmware",
        };
        Value::Text(name.into())
    }),
    row(&["printer_model", "printer_settings_id", "printer_preset"], "printer.name", |s| {
        Value::Text(s.printer.name.clone())
    }),
    row(&["machine_max_feedrate_x", "machine_max_speed_x"], "machine.max_speed", |s| {
        axes(s.machine.max_speed.map(|v| v.0), 0)
    }),
    row(&["machine_max_feedrate_y", "machine_max_speed_y"], "machine.max_speed", |s| {
        axes(s.machine.max_speed.map(|v| v.0), 1)
    }),
    row(&["machine_max_feedrate_z", "machine_max_speed_z"], "machine.max_speed", |s| {
        axes(s.machine.max_speed.map(|v| v.0), 2)
    }),
    row(&["machine_max_feedrate_e", "machine_max_speed_e"], "machine.max_speed", |s| {
        axes(s.machine.max_speed.map(|v| v.0), 3)
    }),
    row(&["machine_max_acceleration_x"], "machine.max_acceleration", |s| {
        axes(s.machine.max_acceleration.map(|v| v.0), 0)
    }),
    row(&["machine_max_acceleration_y"], "machine.max_acceleration", |s| {
        axes(s.machine.max_acceleration.map(|v| v.0), 1)
    }),
    row(&["machine_max_acceleration_z"], "machine.max_acceleration", |s| {
        axes(s.machine.max_acceleration.map(|v| v.0), 2)
    }),
    row(&["machine_max_acceleration_e"], "machine.max_acceleration", |s| {
        axes(s.machine.max_acceleration.map(|v| v.0), 3)
    }),
];

/// The value of a setting by another slicer's name. Where there are several tools, lists have a value for each.
pub(super) fn value(name: &str, settings: &Settings, tools: &[Settings]) -> Option<Value> {
    let row = ROWS.iter().find(|row| row.names.contains(&name))?;
    let value = (row.value)(settings);
    if !matches!(value, Value::List(_)) || tools.is_empty() {
        return Some(value);
    }
    let first = |own: &Settings| match (row.value)(own) {
        Value::List(values) => values.into_iter().next(),
        value => Some(value),
    };
    Some(Value::List(tools.iter().filter_map(first).collect()))
}

/// Each name, and the key of ours that it stands for.
pub(in crate::profile) fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
    ROWS.iter().flat_map(|row| row.names.iter().map(|name| (*name, row.key)))
}

/// Names whose percentages are of another name's value.
const WHOLES: &[(&str, &str)] = &[
    ("external_perimeter_speed", "perimeter_speed"),
    ("small_perimeter_speed", "perimeter_speed"),
    ("solid_infill_speed", "infill_speed"),
    ("top_solid_infill_speed", "solid_infill_speed"),
    ("support_material_interface_speed", "support_material_speed"),
    ("first_layer_height", "layer_height"),
    ("extrusion_width", "layer_height"),
    ("external_perimeter_extrusion_width", "layer_height"),
    ("perimeter_extrusion_width", "layer_height"),
    ("infill_extrusion_width", "layer_height"),
    ("solid_infill_extrusion_width", "layer_height"),
    ("top_infill_extrusion_width", "layer_height"),
    ("support_material_extrusion_width", "layer_height"),
    ("first_layer_extrusion_width", "first_layer_height"),
];

/// The name whose value is 100 % of a name's.
pub(super) fn whole(name: &str) -> Option<&'static str> {
    WHOLES.iter().find(|(of, _)| *of == name).map(|(_, whole)| *whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::schema;

    #[test]
    fn every_name_stands_for_a_key_and_is_there_once() {
        let mut all: Vec<&str> = names().map(|(name, _)| name).collect();
        for (name, key) in names() {
            assert!(schema::field(key).is_some(), "{name}: {key}");
            assert!(value(name, &Settings::default(), &[]).is_some(), "{name}");
        }
        all.sort_unstable();
        let count = all.len();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
