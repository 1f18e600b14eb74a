//! What Cura's settings say in PrusaSlicer's words: the one place that says so.

use super::formula::Value;
use super::script;
use super::stack::Stack;
use crate::presets::value::escaped;

use Rule::{By, Flag, Script, Share, Words};
use geometry::real;

/// How a setting is said in PrusaSlicer's words.
pub(super) enum Rule {
    /// A number as it is.
    Same,
    /// On or off.
    Flag,
    /// Percent, with the sign.
    Share,
    /// A script.
    Script,
    /// By other words: theirs, PrusaSlicer's; those that are not listed are the same.
    Words(&'static [(&'static str, &'static str)]),
    /// By a rule of its own; `None`: there is nothing to say.
    By(fn(&Stack) -> Option<String>),
}

use Rule::Same;

/// Their setting, PrusaSlicer's key, and how it is said.
pub(super) static TABLE: &[(&str, &str, Rule)] = &[
    ("ooze_shield_enabled", "ooze_shield", Flag),
    ("ooze_shield_dist", "ooze_shield_distance", Same),
    ("machine_name", "printer_model", By(|s| Some(escaped(&s.text("machine_name"))))),
    ("machine_width", "bed_shape", By(bed)),
    ("machine_height", "max_print_height", Same),
    ("machine_nozzle_size", "nozzle_diameter", Same),
    ("machine_gcode_flavor", "gcode_flavor", Words(FLAVORS)),
    ("machine_start_gcode", "start_gcode", Script),
    ("machine_end_gcode", "end_gcode", Script),
    ("machine_extruder_start_code", "start_filament_gcode", Script),
    ("machine_extruder_end_code", "end_filament_gcode", Script),
    ("machine_max_feedrate_x", "machine_max_feedrate_x", By(|s| limit(s, "machine_max_feedrate_x"))),
    ("machine_max_feedrate_y", "machine_max_feedrate_y", By(|s| limit(s, "machine_max_feedrate_y"))),
    ("machine_max_feedrate_z", "machine_max_feedrate_z", By(|s| limit(s, "machine_max_feedrate_z"))),
    ("machine_max_feedrate_e", "machine_max_feedrate_e", By(|s| limit(s, "machine_max_feedrate_e"))),
    ("machine_max_acceleration_x", "machine_max_acceleration_x", Same),
    ("machine_max_acceleration_y", "machine_max_acceleration_y", Same),
    ("machine_max_acceleration_z", "machine_max_acceleration_z", Same),
    ("machine_max_acceleration_e", "machine_max_acceleration_e", Same),
    ("machine_acceleration", "machine_max_acceleration_extruding", Same),
    ("machine_max_jerk_xy", "machine_max_jerk_x", Same),
    ("machine_max_jerk_xy", "machine_max_jerk_y", Same),
    ("machine_max_jerk_z", "machine_max_jerk_z", Same),
    ("machine_max_jerk_e", "machine_max_jerk_e", Same),
    ("machine_firmware_retract", "use_firmware_retraction", Flag),
    ("relative_extrusion", "use_relative_e_distances", Flag),
    ("gantry_height", "extruder_clearance_height", By(|s| limit(s, "gantry_height"))),
    ("machine_nozzle_offset_x", "extruder_offset", By(nozzle_offset)),
    (
        "machine_extruders_share_nozzle",
        "single_extruder_multi_material",
        By(|s| of_several(s).map(|s| word(s, "machine_extruders_share_nozzle", "1", "0"))),
    ),
    ("extruder_nr", "ooze_prevention", By(|s| standby(s).map(|_| "1".into()))),
    ("material_standby_temperature", "idle_temperature", By(|s| standby(s).map(written))),
    (
        "switch_extruder_retraction_amount",
        "retract_length_toolchange",
        By(|s| number_of_several(s, "switch_extruder_retraction_amount")),
    ),
    (
        "switch_extruder_extra_prime_amount",
        "retract_restart_extra_toolchange",
        By(|s| number_of_several(s, "switch_extruder_extra_prime_amount")),
    ),
    ("wall_extruder_nr", "perimeter_extruder", By(|s| extruder(s, "wall_extruder_nr"))),
    ("infill_extruder_nr", "infill_extruder", By(|s| extruder(s, "infill_extruder_nr"))),
    ("top_bottom_extruder_nr", "solid_infill_extruder", By(|s| extruder(s, "top_bottom_extruder_nr"))),
    ("support_extruder_nr", "support_material_extruder", By(|s| extruder(s, "support_extruder_nr"))),
    (
        "support_interface_extruder_nr",
        "support_material_interface_extruder",
        By(|s| extruder(s, "support_interface_extruder_nr")),
    ),
    (
        "prime_tower_enable",
        "wipe_tower",
        By(|s| of_several(s).map(|s| word(s, "prime_tower_enable", "1", "0"))),
    ),
    ("prime_tower_size", "wipe_tower_width", By(|s| number_of_several(s, "prime_tower_size"))),
    ("material_diameter", "filament_diameter", Same),
    (
        "material_flow",
        "extrusion_multiplier",
        By(|s| s.number("material_flow").map(|flow| written(flow / 100.0))),
    ),
    ("wall_0_material_flow", "outer_wall_flow_ratio", By(|s| flow_ratio(s, "wall_0_material_flow"))),
    ("wall_x_material_flow", "inner_wall_flow_ratio", By(|s| flow_ratio(s, "wall_x_material_flow"))),
    ("infill_material_flow", "sparse_infill_flow_ratio", By(|s| flow_ratio(s, "infill_material_flow"))),
    ("skin_material_flow", "internal_solid_infill_flow_ratio", By(|s| flow_ratio(s, "skin_material_flow"))),
    ("roofing_material_flow", "top_solid_infill_flow_ratio", By(top_flow_ratio)),
    ("support_material_flow", "support_flow_ratio", By(|s| flow_ratio(s, "support_material_flow"))),
    (
        "support_interface_material_flow",
        "support_interface_flow_ratio",
        By(|s| flow_ratio(s, "support_interface_material_flow")),
    ),
    ("material_print_temperature", "temperature", Same),
    ("material_print_temperature_layer_0", "first_layer_temperature", By(first_temperature)),
    ("material_bed_temperature", "bed_temperature", By(|s| bed_temperature(s, "material_bed_temperature"))),
    (
        "material_bed_temperature_layer_0",
        "first_layer_bed_temperature",
        By(|s| bed_temperature(s, "material_bed_temperature_layer_0")),
    ),
    ("layer_height", "layer_height", Same),
    ("layer_height_0", "first_layer_height", Same),
    ("line_width", "extrusion_width", Same),
    ("wall_line_width_0", "external_perimeter_extrusion_width", Same),
    ("wall_line_width_x", "perimeter_extrusion_width", Same),
    ("skin_line_width", "solid_infill_extrusion_width", Same),
    ("skin_line_width", "top_infill_extrusion_width", Same),
    ("infill_line_width", "infill_extrusion_width", Same),
    ("support_line_width", "support_material_extrusion_width", Same),
    ("initial_layer_line_width_factor", "first_layer_extrusion_width", By(first_width)),
    ("wall_line_count", "perimeters", Same),
    ("top_layers", "top_solid_layers", Same),
    ("bottom_layers", "bottom_solid_layers", Same),
    ("infill_sparse_density", "fill_density", Share),
    ("infill_pattern", "fill_pattern", Words(PATTERNS)),
    ("infill_overlap", "infill_overlap", Share),
    ("top_bottom_pattern", "top_fill_pattern", By(top_pattern)),
    ("inset_direction", "external_perimeters_first", Words(&[("outside_in", "1"), ("inside_out", "0")])),
    ("outer_inset_first", "external_perimeters_first", Flag),
    ("xy_offset", "xy_size_compensation", Same),
    (
        "z_seam_type",
        "seam_position",
        Words(&[("back", "rear"), ("shortest", "nearest"), ("sharpest_corner", "aligned")]),
    ),
    ("magic_spiralize", "spiral_vase", Flag),
    ("ironing_enabled", "ironing", Flag),
    (
        "magic_fuzzy_skin_enabled",
        "fuzzy_skin",
        By(|s| Some(word(s, "magic_fuzzy_skin_enabled", "external", "none"))),
    ),
    ("print_sequence", "complete_objects", Words(&[("one_at_a_time", "1"), ("all_at_once", "0")])),
    ("speed_wall_0", "external_perimeter_speed", Same),
    ("speed_wall_x", "perimeter_speed", Same),
    ("speed_infill", "infill_speed", Same),
    ("speed_topbottom", "solid_infill_speed", Same),
    ("speed_topbottom", "top_solid_infill_speed", Same),
    ("speed_support", "support_material_speed", Same),
    ("speed_travel", "travel_speed", Same),
    ("speed_z_hop", "travel_speed_z", Same),
    ("speed_ironing", "ironing_speed", Same),
    ("speed_print_layer_0", "first_layer_speed", Same),
    ("acceleration_print", "default_acceleration", By(|s| acceleration(s, "acceleration_print"))),
    (
        "acceleration_wall_0",
        "external_perimeter_acceleration",
        By(|s| acceleration(s, "acceleration_wall_0")),
    ),
    ("acceleration_wall_x", "perimeter_acceleration", By(|s| acceleration(s, "acceleration_wall_x"))),
    ("acceleration_infill", "infill_acceleration", By(|s| acceleration(s, "acceleration_infill"))),
    (
        "acceleration_topbottom",
        "solid_infill_acceleration",
        By(|s| acceleration(s, "acceleration_topbottom")),
    ),
    ("acceleration_travel", "travel_acceleration", By(|s| acceleration(s, "acceleration_travel"))),
    ("acceleration_layer_0", "first_layer_acceleration", By(|s| acceleration(s, "acceleration_layer_0"))),
    ("retraction_amount", "retract_length", By(|s| when(s, "retraction_enable", "retraction_amount"))),
    ("retraction_retract_speed", "retract_speed", Same),
    ("retraction_prime_speed", "deretract_speed", Same),
    ("retraction_min_travel", "retract_before_travel", Same),
    ("retraction_hop", "retract_lift", By(|s| when(s, "retraction_hop_enabled", "retraction_hop"))),
    ("retract_at_layer_change", "retract_layer_change", Flag),
    ("cool_fan_enabled", "fan_always_on", Flag),
    ("cool_fan_speed_min", "min_fan_speed", By(|s| when(s, "cool_fan_enabled", "cool_fan_speed_min"))),
    ("cool_fan_speed_max", "max_fan_speed", By(|s| when(s, "cool_fan_enabled", "cool_fan_speed_max"))),
    ("cool_min_layer_time", "slowdown_below_layer_time", Same),
    ("cool_min_layer_time_fan_speed_max", "fan_below_layer_time", Same),
    ("cool_min_speed", "min_print_speed", Same),
    ("cool_fan_speed_0", "disable_fan_first_layers", By(fan_off_layers)),
    ("cool_fan_full_layer", "full_fan_speed_layer", Same),
    ("bridge_fan_speed", "bridge_fan_speed", By(|s| when(s, "bridge_settings_enabled", "bridge_fan_speed"))),
    ("skirt_line_count", "skirts", By(|s| adhesion(s, "skirt", "skirt_line_count"))),
    ("skirt_gap", "skirt_distance", Same),
    ("skirt_brim_minimal_length", "min_skirt_length", By(|_| Some("0".into()))),
    ("brim_width", "brim_width", By(|s| adhesion(s, "brim", "brim_width"))),
    ("brim_gap", "brim_separation", Same),
    ("raft_surface_layers", "raft_layers", By(raft_layers)),
    ("support_enable", "support_material", Flag),
    ("support_structure", "support_material_style", Words(&[("normal", "grid"), ("tree", "organic")])),
    ("support_type", "support_material_buildplate_only", Words(&[("buildplate", "1"), ("everywhere", "0")])),
    (
        "support_angle",
        "support_material_threshold",
        By(|s| s.number("support_angle").map(|angle| written(90.0 - angle))),
    ),
    ("support_top_distance", "support_material_contact_distance", Same),
    ("support_xy_distance", "support_material_xy_spacing", Same),
];

static FLAVORS: &[(&str, &str)] = &[
    ("RepRap (Marlin/Sprinter)", "marlin"),
    ("Marlin", "marlin"),
    ("RepRap (RepRap)", "reprapfirmware"),
    ("Repetier", "repetier"),
    ("Griffin", "griffin"),
];

static PATTERNS: &[(&str, &str)] = &[
    ("lines", "rectilinear"),
    ("zigzag", "rectilinear"),
    ("trihexagon", "stars"),
    ("cubicsubdiv", "adaptivecubic"),
];

fn written(number: f64) -> String {
    Value::Number(number).written()
}

fn word(stack: &Stack, key: &str, on: &str, off: &str) -> String {
    (if stack.is_on(key) { on } else { off }).to_owned()
}

/// What stands for no limit there.
const ENDLESS: f64 = 1e6;

fn limit(stack: &Stack, key: &str) -> Option<String> {
    stack.number(key).filter(|limit| *limit < ENDLESS).map(written)
}

/// The settings, where the machine has several extruders.
fn of_several(stack: &Stack) -> Option<&Stack> {
    (stack.extruders > 1).then_some(stack)
}

fn number_of_several(stack: &Stack, key: &str) -> Option<String> {
    of_several(stack)?.number(key).map(written)
}

/// An extruder for a role, which they count from 0, and -1 is whichever the object has.
fn extruder(stack: &Stack, key: &str) -> Option<String> {
    of_several(stack)?.number(key).map(|number| written((number + 1.0).max(0.0)))
}

/// What a nozzle of its own cools down to while others print, °C.
fn standby(stack: &Stack) -> Option<f64> {
    let own = of_several(stack).filter(|stack| !stack.is_on("machine_extruders_share_nozzle"))?;
    own.number("material_standby_temperature").filter(|celsius| *celsius > 0.0)
}

fn nozzle_offset(stack: &Stack) -> Option<String> {
    let is_applied = of_several(stack)?.value("machine_use_extruder_offset_to_offset_coords");
    let is_applied = is_applied.map_or(true, |value| value.holds());
    let mm = |key| if is_applied { stack.number(key).unwrap_or(0.0) } else { 0.0 };
    Some(format!("{}x{}", written(mm("machine_nozzle_offset_x")), written(mm("machine_nozzle_offset_y"))))
}

/// How many points the outline of a round bed is made of.
const POINTS: u32 = 72;

fn bed(stack: &Stack) -> Option<String> {
    let (width, depth) = (stack.number("machine_width")?, stack.number("machine_depth")?);
    let is_centered = stack.is_on("machine_center_is_zero");
    let corner = if is_centered { [-width / 2.0, -depth / 2.0] } else { [0.0, 0.0] };
    let at = |x: f64, y: f64| format!("{}x{}", written(corner[0] + x), written(corner[1] + y));
    let points: Vec<String> = if stack.text("machine_shape") == "elliptic" {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(POINTS);
        let point =
            |i| at(width / 2.0 * (1.0 + real::cos(angle(i))), depth / 2.0 * (1.0 + real::sin(angle(i))));
        (0..POINTS).map(point).collect()
    } else {
        vec![at(0.0, 0.0), at(width, 0.0), at(width, depth), at(0.0, depth)]
    };
    Some(points.join(","))
}

fn bed_temperature(stack: &Stack, key: &str) -> Option<String> {
    when(stack, "machine_heated_bed", key)
}

/// A flow as a share of that of the material.
fn flow_ratio(stack: &Stack, key: &str) -> Option<String> {
    let (flow, of_material) = (stack.number(key)?, stack.number("material_flow")?);
    (of_material > 0.0).then(|| written(flow / of_material))
}

/// The uppermost layers may have a flow of their own.
fn top_flow_ratio(stack: &Stack) -> Option<String> {
    let has_own = stack.number("roofing_layer_count").is_some_and(|count| count > 0.0);
    flow_ratio(stack, if has_own { "roofing_material_flow" } else { "skin_material_flow" })
}

/// A number, or 0 while a switch is off.
fn when(stack: &Stack, switch: &str, key: &str) -> Option<String> {
    if stack.is_on(switch) { stack.number(key).map(written) } else { Some("0".into()) }
}

fn adhesion(stack: &Stack, kind: &str, key: &str) -> Option<String> {
    if stack.text("adhesion_type") == kind { stack.number(key).map(written) } else { Some("0".into()) }
}

/// A raft has a layer at its bottom, some in the middle, some at its top.
fn raft_layers(stack: &Stack) -> Option<String> {
    let middle = stack.number("raft_interface_layers").unwrap_or(1.0);
    let top = stack.number("raft_surface_layers")?;
    Some(if stack.text("adhesion_type") == "raft" { written(1.0 + middle + top) } else { "0".into() })
}

fn acceleration(stack: &Stack, key: &str) -> Option<String> {
    when(stack, "acceleration_enabled", key)
}

/// 0: as on other layers.
fn first_temperature(stack: &Stack) -> Option<String> {
    let own = stack.number("material_print_temperature_layer_0").filter(|own| *own > 0.0);
    own.or_else(|| stack.number("material_print_temperature")).map(written)
}

fn first_width(stack: &Stack) -> Option<String> {
    let factor = stack.number("initial_layer_line_width_factor")?;
    stack.number("line_width").map(|width| written(width * factor / 100.0))
}

fn top_pattern(stack: &Stack) -> Option<String> {
    let is_monotonic = stack.is_on("skin_monotonic");
    Some(match stack.text("top_bottom_pattern").as_str() {
        "lines" | "zigzag" if is_monotonic => "monotonic".into(),
        "lines" | "zigzag" => "rectilinear".into(),
        other => other.into(),
    })
}

fn fan_off_layers(stack: &Stack) -> Option<String> {
    let is_off = stack.number("cool_fan_speed_0")? == 0.0;
    Some(if is_off { "1".into() } else { "0".into() })
}

/// Names of scripts that are no settings: of the extruder that begins, and of the one in use.
pub(super) const OF_EXTRUDERS: [&str; 2] = ["initial_extruder_nr", "extruder_nr"];

/// What a row of the table says.
pub(super) fn said(rule: &Rule, key: &str, stack: &Stack) -> Option<String> {
    Some(match rule {
        Same => written(stack.number(key)?),
        Flag => word(stack, key, "1", "0"),
        Share => written(stack.number(key)?) + "%",
        Script => {
            let is_known = |name: &str| stack.place(name).is_some() || OF_EXTRUDERS.contains(&name);
            escaped(&script::translated(&stack.text(key), stack.extruders > 1, is_known))
        }
        Words(words) => {
            let theirs = stack.text(key);
            words.iter().find(|(word, _)| *word == theirs).map_or(theirs, |(_, word)| (*word).to_owned())
        }
        By(rule) => rule(stack)?,
    })
}

/// Settings that others among these say already, or that do not concern the print.
pub(super) static IDLE: &[&str] = &[
    "acceleration_enabled",
    "adhesion_type",
    "bridge_settings_enabled",
    "build_volume_temperature",
    "cool_fan_speed",
    "default_material_bed_temperature",
    "default_material_print_temperature",
    "extruder_nr",
    "optimize_wall_printing_order",
    "support_z_distance",
    "material_standby_temperature",
    "extruders_enabled_count",
    "infill_line_distance",
    "initial_layer_line_width_factor",
    "machine_center_is_zero",
    "machine_depth",
    "machine_extruder_count",
    "machine_extruders_share_heater",
    "machine_nozzle_offset_y",
    "machine_heated_bed",
    "machine_heated_build_volume",
    "machine_shape",
    "machine_show_variants",
    "machine_use_extruder_offset_to_offset_coords",
    "material_adhesion_tendency",
    "material_brand",
    "material_guid",
    "material_name",
    "material_surface_energy",
    "material_type",
    "retraction_enable",
    "retraction_hop_enabled",
    "retraction_speed",
    "skin_monotonic",
    "speed_layer_0",
    "speed_print",
    "speed_wall",
    "top_bottom_thickness",
    "top_thickness",
    "bottom_thickness",
    "wall_line_width",
    "wall_thickness",
];
