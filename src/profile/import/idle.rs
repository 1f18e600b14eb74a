//! Keys of others without a row: which ask for nothing, and why the rest is not taken over.

use crate::presets::Config;

/// When a key without a row asks for nothing.
pub(super) enum Idle {
    /// It has no effect on the print: names, notes, what hosts and other machines need.
    Always,
    /// It is of several tools, or of a filament changer: there is one of each.
    OneTool,
    /// At one of these values.
    At(&'static [&'static str]),
    /// While this other key is off.
    Without(&'static str),
    /// While another key has this value.
    While(&'static str, &'static str),
}

use Idle::{Always, At, OneTool, While, Without};

/// Keys without a row that need not be reported, and when: where one of their entries holds. `*` stands for any end.
pub(super) static IDLE: &[(&str, Idle)] = &[
    ("inherits*", Always),
    ("compatible_*", Always),
    ("renamed_from", Always),
    ("print_settings_id", Always),
    ("physical_printer_settings_id", Always),
    ("printer_settings_id", Always),
    ("default_print_profile", Always),
    ("default_filament_profile", Always),
    ("printer_technology", At(&["FFF"])),
    ("printer_vendor", Always),
    ("printer_variant", Always),
    ("notes", Always),
    ("filament_notes", Always),
    ("printer_notes", Always),
    ("filament_vendor", Always),
    ("extruder_colour", Always),
    ("filament_spool_weight", Always),
    ("filament_soluble", Always),
    ("filament_abrasive", Always),
    ("nozzle_high_flow", Always),
    // Hosts.
    ("host_type", Always),
    ("print_host", Always),
    ("printhost_*", Always),
    ("octoprint_*", Always),
    ("serial_*", Always),
    // How the slicer works and shows things.
    ("gcode_comments", Always),
    ("thumbnails_format", Always),
    ("remaining_times", Always),
    ("silent_mode", Always),
    // It is run where somebody marks a layer in the slicer's preview.
    ("template_custom_gcode", Always),
    ("variable_layer_height", Always),
    ("threads", Always),
    ("duplicate_distance", Always),
    ("gcode_substitutions", Always),
    ("arc_fitting_tolerance", Always),
    ("has_heatbed", Always),
    ("sequential_print_priority", Always),
    // SuperSlicer's.
    ("gcode_ascii", Always),
    ("gcode_filename_illegal_char", Always),
    ("gcode_precision_*", Always),
    ("max_gcode_per_second", Always),
    ("min_length", Always),
    ("model_precision", Always),
    ("remaining_times_type", Always),
    ("thumbnails_*", Always),
    ("time_*", Always),
    ("tool_name", Always),
    ("z_step", Always),
    ("complete_objects_*", Without("complete_objects")),
    ("parallel_objects_step", Without("complete_objects")),
    ("hole_to_polyhole_*", Without("hole_to_polyhole")),
    ("infill_dense_algo", Without("infill_dense")),
    ("milling_*", Without("milling_post_process")),
    ("overhang_reverse_threshold", Without("overhang_reverse")),
    ("overhangs_reverse_threshold", Without("overhang_reverse")),
    ("perimeter_loop_seam", Without("perimeter_loop")),
    ("thin_walls_*", Without("thin_walls")),
    ("wipe_advanced_*", Without("wipe_advanced")),
    ("wipe_*", Without("wipe")),
    // Several tools, or filaments for one of them.
    ("bed_temperature_extruder", OneTool),
    ("filament_load*", OneTool),
    ("filament_minimal_purge_on_wipe_tower", OneTool),
    ("filament_unload*", OneTool),
    ("interface_shells", OneTool),
    ("interlocking_*", OneTool),
    ("mmu_*", OneTool),
    ("ooze_prevention", OneTool),
    ("single_extruder_multi_material*", OneTool),
    ("standby_temperature_delta", OneTool),
    ("wipe_into_*", OneTool),
    ("wipe_tower*", OneTool),
    ("wiping_volumes_*", OneTool),
    // So anyway.
    ("clip_multipart_objects", At(&["1"])),
    ("ensure_vertical_shell_thickness", At(&["enabled", "partial", "1"])),
    ("extrusion_axis", At(&["E"])),
    ("ironing_type", At(&["top"])),
    ("ironing_type", Without("ironing")),
    ("slicing_mode", At(&["regular"])),
    ("support_material_interface_pattern", At(&["auto", "rectilinear"])),
    ("support_material_synchronize_layers", At(&["1"])),
    ("support_material_with_sheath", At(&["1"])),
    ("thin_walls", At(&["1"])),
    ("thin_walls", While("perimeter_generator", "arachne")),
    ("thin_perimeters", At(&["1"])),
    ("bottom_fill_pattern", At(&["rectilinear", "monotonic", "monotoniclines"])),
    ("bottom_infill_pattern", At(&["rectilinear", "monotonic"])),
    ("wall_distribution_count", At(&["1"])),
    ("wall_transition_angle", At(&["10"])),
    ("wall_transition_filter_deviation", At(&["25%"])),
    ("wall_transition_length", At(&["100%"])),
    ("wall_*", While("perimeter_generator", "classic")),
    // Off.
    ("automatic_extrusion_widths", At(&["0"])),
    ("automatic_infill_combination", At(&["0"])),
    ("automatic_infill_combination_max_layer_height", Without("automatic_infill_combination")),
    ("avoid_crossing_curled_overhangs", At(&["0"])),
    ("bridge_angle", At(&["0"])),
    ("brim_inside_holes", At(&["0"])),
    ("brim_connections_width", At(&["0"])),
    ("colorprint_heights", At(&["0"])),
    ("extra_perimeters", At(&["0"])),
    ("filament_shrinkage_compensation_*", At(&["0%", "0"])),
    ("first_layer_acceleration_over_raft", Without("raft_layers")),
    ("first_layer_acceleration_over_raft", At(&["0"])),
    ("first_layer_speed_over_raft", Without("raft_layers")),
    ("gcode_arcs", At(&["0"])),
    ("infill_first", At(&["0"])),
    ("infill_only_where_needed", At(&["0"])),
    ("interior_brim_width", At(&["0"])),
    ("match_horizontal_surfaces", At(&["0"])),
    ("max_volumetric_extrusion_*", At(&["0"])),
    ("over_bridge_speed", At(&["0"])),
    ("post_process", At(&["\"\""])),
    ("prefer_clockwise_movements", At(&["0"])),
    ("raft_*", Without("raft_layers")),
    ("regions_overlap", At(&["0"])),
    ("resolution", At(&["0"])),
    ("scarf_seam_length", Always),
    ("scarf_seam_*", Without("scarf_seam_placement")),
    ("staggered_inner_seams", At(&["0"])),
    ("support_material_*", Without("support_material")),
    ("support_material_bottom_contact_distance", At(&["0"])),
    ("support_material_bottom_interface_layers", At(&["-1"])),
    ("support_material_enforce_layers", At(&["0"])),
    ("support_material_interface_contact_loops", At(&["0"])),
    ("support_tree_*", Without("support_material")),
    ("top_fan_speed", At(&["0"])),
    ("use_set_and_wait_*", At(&["0"])),
    ("use_volumetric_e", At(&["0"])),
    ("vibration_limit", At(&["0"])),
    ("z_steps_per_mm", At(&["0"])),
];

/// Why what has neither a row nor an idle value is not taken over; the first that fits holds.
pub(super) static REASONS: &[(&str, &str)] = &[
    ("arc_fitting_*", "arcs leave the path by `gcode.arc_tolerance`"),
    ("automatic_extrusion_widths", "widths are as given"),
    ("automatic_infill_combination*", "`infill.combine_layers` counts layers"),
    ("avoid_crossing_curled_overhangs", "travels go round outer walls, not round what may have curled up"),
    ("bottom_*_pattern", "bottom layers are lines"),
    ("bridge_angle", "bridges lie across the shortest spans"),
    ("bridge_fill_pattern", "bridges are lines"),
    ("bridge_overlap*", "lines of bridges lie side by side"),
    ("curve_smoothing_*", "walls follow the model"),
    ("external_infill_margin", "shells reach as far as walls hold them"),
    ("fill_angle_*", "sparse lines keep their angle, or turn by the pattern"),
    ("fill_smooth_*", "`ironing` is for smooth top surfaces"),
    ("feature_gcode", "no script is run where features change"),
    ("filament_shrink", "a scale is given beside the model: `--scale`"),
    ("first_layer_size_compensation_layers", "the foot is made smaller on the first layer alone"),
    ("hole_size_compensation", "`layer.xy_compensation` holds for outlines and holes alike"),
    ("xy_inner_size_compensation", "`layer.xy_compensation` holds for outlines and holes alike"),
    ("hole_to_polyhole*", "holes are as round as the model"),
    ("infill_connection_*", "solid lines are connected where they end near each other"),
    ("infill_dense*", "infill is as dense under roofs as elsewhere"),
    ("no_perimeter_unsupported_algo", "walls over nothing are bridges"),
    (
        "over_bridge_flow_ratio",
        "it is for what lies right over bridges, which is printed like other solid infill",
    ),
    ("perimeter_loop*", "walls are loops of their own"),
    ("retract_lift_*", "the nozzle is lifted by `retract.z_hop`, wherever it is"),
    ("seam_*_cost", "seams lie in corners, and where travel is short"),
    ("seam_notch_*", "seams lie on the outline"),
    ("skirt_extrusion_width", "skirts have `first_layer.width`"),
    ("small_perimeter_*", "a wall is small by the length of its loop"),
    ("wipe_*", "wiping goes back along what was printed"),
    ("brim_*", "there is one brim around the part, or in its holes"),
    ("interior_brim_width", "the brim is as wide in holes as around the part"),
    ("clip_multipart_objects", "objects that overlap are one"),
    ("dynamic_overhang_speeds", "an early form of `overhang_speed_0` to `overhang_speed_3`"),
    ("ensure_vertical_shell_thickness", "shells close slopes always"),
    ("extra_perimeters*", "slopes are closed by solid infill, not by more walls"),
    ("filament_shrinkage_compensation_*", "a scale is given beside the model: `--scale`"),
    (
        "first_layer_*_over_raft",
        "`first_layer` holds for what lies on the bed; the first layer on a raft is printed like others",
    ),
    ("infill_first", "walls are printed before infill"),
    ("infill_only_where_needed", "`infill.pattern = \"lightning\"` is infill under roofs alone"),
    ("ironing_type", "top surfaces are ironed, and all of them"),
    ("label_printed_objects", "an early form of `gcode_label_objects`"),
    ("max_volumetric_extrusion_*", "the flow may change at once"),
    (
        "over_bridge_speed",
        "it is for solid infill right over bridges, which is as fast here as other solid infill",
    ),
    ("post_process", "no other programs are run"),
    ("prefer_clockwise_movements", "loops are drawn the way that travels are short"),
    ("raft_first_layer_density", "`raft.density` is that of all its lower layers"),
    ("raft_expansion", "a raft is as large in all its layers"),
    ("resolution", "models are simplified by `layer.resolution` alone, once cut"),
    ("scarf_seam_*", "a scarf is on all outermost walls, and begins with nothing"),
    ("slicing_mode", "parts of a section that overlap are one"),
    ("staggered_inner_seams", "seams of inner walls follow the same rule"),
    ("support_material_bottom_*", "gap and dense layers are the same over the part as under it"),
    ("support_material_closing_radius", "columns are joined where they touch"),
    ("support_material_enforce_layers", "an enforcer says it: `--support-enforcer`"),
    ("support_material_interface_contact_loops", "dense layers have no loops around"),
    ("support_material_interface_pattern", "dense layers are lines"),
    ("support_material_solid_first_layer", "the first layer of support is as dense as others"),
    ("support_material_synchronize_layers", "support has the part's layers"),
    ("support_material_with_sheath", "columns have an outline always"),
    ("support_tree_*", "branches have an angle, a tip and a taper, and no more"),
    ("thin_walls*", "what is too thin for two walls has one"),
    ("thin_perimeters*", "what is too thin for two walls has one"),
    ("*_fan_speed", "the fan follows layer times, bridges and overhangs"),
    ("use_volumetric_e", "E is in millimetres of filament"),
    ("wall_*", "walls of variable width change their number by a rule of ours"),
];

/// Whether a pattern fits a key.
fn fits(pattern: &str, key: &str) -> bool {
    match pattern.split_once('*') {
        Some((start, end)) => {
            key.len() >= start.len() + end.len() && key.starts_with(start) && key.ends_with(end)
        }
        None => key == pattern,
    }
}

/// The conditions under which a key asks for nothing.
pub(super) fn of(key: &str) -> impl Iterator<Item = &'static Idle> {
    IDLE.iter().filter(move |(pattern, _)| fits(pattern, key)).map(|(_, idle)| idle)
}

/// Why a key is not taken over.
pub(super) fn reason(key: &str) -> &'static str {
    let found = REASONS.iter().find(|(pattern, _)| fits(pattern, key));
    found.map_or("there is no such setting", |(_, reason)| reason)
}

/// Whether a value, or each of one for every extruder, is among these.
pub(super) fn is_among(value: &str, values: &[&str]) -> bool {
    value.split(',').all(|element| values.contains(&element.trim().trim_matches('"')))
}

impl Idle {
    /// Whether it holds of a value in a configuration.
    pub(super) fn holds(&self, value: &str, config: &Config) -> bool {
        const OFF: [&str; 5] = ["0", "none", "nowhere", "disabled", "false"];
        match self {
            Always | OneTool => true,
            At(values) => is_among(value, values),
            Without(other) => config.first(other).is_none_or(|text| OFF.contains(&text)),
            While(other, word) => config.first(other) == Some(word),
        }
    }
}
