//! Words and switches.

use crate::presets::config::Config;

/// Keys that PrusaSlicer, or the rest of its kin, has under another name.
const NAMES: [(&str, &str); 3] = [
    ("extra_perimeters_overhangs", "extra_perimeters_on_overhangs"),
    ("overhangs_reverse", "overhang_reverse"),
    ("fill_top_flow_ratio", "top_solid_infill_flow_ratio"),
];

/// Words that mean what another one does: key, theirs, PrusaSlicer's.
const WORDS: [(&str, &str, &str); 18] = [
    ("arc_fitting", "0", "disabled"),
    ("arc_fitting", "1", "emit_center"),
    ("gcode_label_objects", "0", "disabled"),
    ("gcode_label_objects", "1", "octoprint"),
    ("seam_position", "contiguous", "aligned"),
    ("fill_pattern", "scatteredrectilinear", "rectilinear"),
    ("fill_pattern", "rectiwithperimeter", "rectilinear"),
    ("fill_pattern", "rectilineargapfill", "rectilinear"),
    ("fill_pattern", "monotonicgapfill", "monotonic"),
    ("fill_pattern", "concentricgapfill", "concentric"),
    ("top_fill_pattern", "rectilineargapfill", "monotonic"),
    ("top_fill_pattern", "monotonicgapfill", "monotonic"),
    ("bottom_fill_pattern", "rectilineargapfill", "monotonic"),
    ("bottom_fill_pattern", "monotonicgapfill", "monotonic"),
    ("gcode_flavor", "sprinter", "reprap"),
    ("gcode_flavor", "repetier", "reprap"),
    ("gcode_flavor", "smoothie", "reprap"),
    ("gcode_flavor", "lerdge", "reprap"),
];

/// Longest connections of infill lines where their length is not limited, mm.
const LONGEST_MM: &str = "1000";

pub(super) fn translate(config: &mut Config) {
    for (theirs, name) in NAMES {
        if let (Some(place), Some(value)) = (config.place(theirs), config.text(theirs)) {
            let value = value.to_owned();
            config.say_at(name, &value, place);
            config.forget(theirs);
        }
    }
    for (key, theirs, word) in WORDS {
        if config.text(key) == Some(theirs) {
            say_word(config, key, word, key);
        }
    }
    if config.flag("start_gcode_manual") == Some(true) {
        say_word(config, "autoemit_temperature_commands", "0", "start_gcode_manual");
        config.forget("start_gcode_manual");
    }
    if let Some(kind) = config.text("bridge_type") {
        let is_thick = if kind == "nozzle" { "1" } else { "0" };
        say_word(config, "thick_bridges", is_thick, "bridge_type");
        config.forget("bridge_type");
    }
    connections(config);
    brim(config);
    support(config);
    flows(config);
    retraction(config);
}

fn say_word(config: &mut Config, key: &str, word: &str, from: &str) {
    if let Some(place) = config.place(from) {
        config.say_at(key, word, place);
    }
}

/// Where lines are connected, 0 is no limit of how far.
fn connections(config: &mut Config) {
    match config.text("infill_connection") {
        Some("notconnected") => {
            say_word(config, "infill_anchor_max", "0", "infill_connection");
            config.forget("infill_connection");
        }
        Some(_) if config.number("infill_anchor_max") == Some(0.0) => {
            say_word(config, "infill_anchor_max", LONGEST_MM, "infill_anchor_max");
            say_word(config, "infill_anchor", "0", "infill_anchor_max");
        }
        _ => {}
    }
}

/// A brim inside of holes has a width of its own there; here it is as wide as around.
fn brim(config: &mut Config) {
    let Some(place) = config.place("brim_width") else { return };
    let [outer, inner] = ["brim_width", "brim_width_interior"].map(|key| config.number(key).unwrap_or(0.0));
    let in_holes = inner > 0.0 || config.flag("brim_inside_holes") == Some(true) && outer > 0.0;
    let sides = match (outer > 0.0, in_holes) {
        (true, true) => "outer_and_inner",
        (false, true) => "inner_only",
        (true, false) => "outer_only",
        (false, false) => "no_brim",
    };
    config.say_at("brim_type", sides, place);
    if outer == 0.0 && inner > 0.0 {
        config.say("brim_width", Some(inner), "brim_width_interior");
    }
    if outer == 0.0 || inner == 0.0 || inner == outer {
        config.forget("brim_width_interior");
        config.forget("brim_inside_holes");
    }
}

/// Support that is dissolved touches the part.
fn support(config: &mut Config) {
    let (top, bottom) = ("support_material_contact_distance", "support_material_bottom_contact_distance");
    if config.text("support_material_contact_distance_type") == Some("none") {
        for key in [top, bottom] {
            say_word(config, key, "0", "support_material_contact_distance_type");
        }
    }
    config.forget("support_material_contact_distance_type");
    // PrusaSlicer's 0 is as much as above.
    if config.number(top) == config.number(bottom) {
        config.forget(bottom);
    }
}

/// What a print extrudes more is so for each filament.
fn flows(config: &mut Config) {
    let Some(all) = config.number_of("print_extrusion_multiplier", Some(1.0)) else { return };
    if config.say_each("extrusion_multiplier", |_, own| own * all) {
        config.forget("print_extrusion_multiplier");
    }
}

/// A print may have a retraction of its own; negative: it has not.
fn retraction(config: &mut Config) {
    for (of_print, key, filaments) in [
        ("print_retract_length", "retract_length", "filament_retract_length"),
        ("print_retract_lift", "retract_lift", "filament_retract_lift"),
    ] {
        if let Some(own) = config.number(of_print).filter(|own| *own >= 0.0) {
            config.say(key, Some(own), of_print);
            config.forget(filaments);
        }
        config.forget(of_print);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::config::Place;

    #[test]
    fn words_become_those_of_prusaslicer() {
        let mut config = Config::default();
        for (key, value) in [
            ("arc_fitting", "0"),
            ("gcode_flavor", "sprinter"),
            ("bridge_type", "flow"),
            ("infill_connection", "connected"),
            ("infill_anchor_max", "0"),
            ("brim_width", "4"),
            ("brim_inside_holes", "1"),
            ("support_material_contact_distance", "0.2"),
            ("support_material_contact_distance_type", "none"),
            ("extrusion_multiplier", "0.9,1"),
            ("print_extrusion_multiplier", "110%"),
            ("retract_length", "1"),
            ("print_retract_length", "0.5"),
        ] {
            config.set(key, value, Place::new("x.ini", 1, ""));
        }
        translate(&mut config);
        for (key, value) in [
            ("arc_fitting", "disabled"),
            ("gcode_flavor", "reprap"),
            ("thick_bridges", "0"),
            ("infill_anchor_max", LONGEST_MM),
            ("brim_type", "outer_and_inner"),
            ("support_material_contact_distance", "0"),
            ("retract_length", "0.5"),
        ] {
            assert_eq!(config.text(key), Some(value), "{key}");
        }
        assert_eq!(config.lists["extrusion_multiplier"].1, "0.99,1.1");
    }
}
