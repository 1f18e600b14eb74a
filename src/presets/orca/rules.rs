//! The rules of the [keys](super::keys) that are not one value for another.

use super::values::{Values, written};

/// Widths with percentages resolved, as these are of the nozzle.
pub(super) fn width(values: &Values, name: &str) -> Option<String> {
    let nozzle = values.number("nozzle_diameter");
    values.number_of(name, nozzle).map(written)
}

pub(super) fn small_speed(values: &Values) -> Option<String> {
    values.number_of("small_perimeter_speed", values.number("outer_wall_speed")).map(written)
}

/// A percentage of the default acceleration, resolved.
pub(super) fn solid_acceleration(values: &Values) -> Option<String> {
    values.number_of("internal_solid_infill_acceleration", values.number("default_acceleration")).map(written)
}

pub(super) fn infill_acceleration(values: &Values) -> Option<String> {
    values.number_of("sparse_infill_acceleration", values.number("default_acceleration")).map(written)
}

pub(super) fn bridge_acceleration(values: &Values) -> Option<String> {
    values.number_of("bridge_acceleration", values.number("outer_wall_acceleration")).map(written)
}

/// The length of a scarf in steps.
pub(super) fn scarf_segment(values: &Values) -> Option<String> {
    let (length, steps) = (values.number("seam_slope_min_length")?, values.number("seam_slope_steps")?);
    (steps > 0.0).then(|| written(length / steps))
}

pub(super) fn ironing(values: &Values) -> Option<String> {
    Some(flag(values.is_on("ironing_type")))
}

/// `auto_brim` depends on the shape of the model: there is none then, and the type is left as it is, to be told.
pub(super) fn brim_width(values: &Values) -> Option<String> {
    match values.text("brim_type").as_str() {
        "auto_brim" | "brim_ears" | "painted" => Some("0".into()),
        _ => Some(values.text("brim_width")),
    }
}

/// What is built in is no wish.
pub(super) fn brim_type(values: &Values) -> Option<String> {
    values.place("brim_type").map(|_| values.text("brim_type"))
}

fn is_tree(values: &Values) -> bool {
    values.text("support_type").starts_with("tree")
}

pub(super) fn support_style(values: &Values) -> Option<String> {
    let style = values.text("support_style");
    Some(match (is_tree(values), style.as_str()) {
        (true, "default" | "organic") => "organic".into(),
        (true, _) => "tree".into(),
        (false, "snug") => style,
        (false, _) => "grid".into(),
    })
}

pub(super) fn support_auto(values: &Values) -> Option<String> {
    Some(flag(values.text("support_type").ends_with("(auto)")))
}

/// Trees of the organic kind have keys of their own.
fn of_tree(values: &Values, name: &str) -> Option<String> {
    let is_organic = matches!(values.text("support_style").as_str(), "default" | "organic");
    Some(values.text(&if is_organic { format!("{name}_organic") } else { name.to_owned() }))
}

pub(super) fn tree_angle(values: &Values) -> Option<String> {
    of_tree(values, "tree_support_branch_angle")
}

pub(super) fn tree_diameter(values: &Values) -> Option<String> {
    of_tree(values, "tree_support_branch_diameter")
}

/// Sizes in one text or in several, each with its format.
pub(super) fn thumbnails(values: &Values) -> Option<String> {
    let format = values.text("thumbnails_format");
    let all = values.all("thumbnails").join(",");
    let sizes = all.split([',', ';']).map(str::trim).filter(|size| !size.is_empty());
    let sizes = sizes.map(|size| match size.contains('/') {
        true => size.to_owned(),
        false => format!("{size}/{format}"),
    });
    Some(sizes.collect::<Vec<_>>().join(", "))
}

/// Objects that firmware can leave out, or comments alone.
pub(super) fn labels(values: &Values) -> Option<String> {
    let words = [("exclude_object", "firmware"), ("gcode_label_objects", "octoprint")];
    Some(words.iter().find(|(key, _)| values.is_on(key)).map_or("disabled", |(_, word)| word).into())
}

/// The filament's times the process's.
pub(super) fn flow(values: &Values) -> Option<String> {
    let process = values.number("print_flow_ratio")?;
    Some(written(values.number("filament_flow_ratio")? * process))
}

/// The key of a plate's temperature: names and numbers of plates are those of the slicers.
pub(super) fn plate(values: &Values) -> &'static str {
    let current = values.place("curr_bed_type").map(|_| values.text("curr_bed_type"));
    let name = current.unwrap_or_else(|| values.text("default_bed_type")).to_ascii_lowercase();
    match name.trim() {
        "1" | "cool plate" | "pc plate" => "cool_plate_temp",
        "2" | "engineering plate" => "eng_plate_temp",
        "4" | "textured pei plate" => "textured_plate_temp",
        "5" | "textured cool plate" => "textured_cool_plate_temp",
        "6" | "supertack plate" | "bambu cool plate supertack" => "supertack_plate_temp",
        // Creality Print's alone: nothing is built in.
        "epoxy resin plate" if values.place("epoxy_resin_plate_temp").is_some() => "epoxy_resin_plate_temp",
        "customized plate" if values.place("customized_plate_temp").is_some() => "customized_plate_temp",
        _ => "hot_plate_temp",
    }
}

pub(super) fn bed_temperature(values: &Values) -> Option<String> {
    Some(values.all(plate(values)).join(","))
}

pub(super) fn first_bed_temperature(values: &Values) -> Option<String> {
    Some(values.all(&format!("{}_initial_layer", plate(values))).join(","))
}

/// 0 where it is off.
pub(super) fn pressure_advance(values: &Values) -> Option<String> {
    let is_on = values.is_on("enable_pressure_advance");
    Some(if is_on { values.text("pressure_advance") } else { "0".into() })
}

/// The speed of a wall that hangs over; 0 is that of the outer wall.
fn overhang(values: &Values, key: &str) -> Option<String> {
    let speed = values.text(key);
    Some(if speed.trim_end_matches('%').parse() == Ok(0.0) { values.text("outer_wall_speed") } else { speed })
}

pub(super) fn overhang_1_4(values: &Values) -> Option<String> {
    overhang(values, "overhang_1_4_speed")
}

pub(super) fn overhang_2_4(values: &Values) -> Option<String> {
    overhang(values, "overhang_2_4_speed")
}

pub(super) fn overhang_3_4(values: &Values) -> Option<String> {
    overhang(values, "overhang_3_4_speed")
}

pub(super) fn overhang_4_4(values: &Values) -> Option<String> {
    overhang(values, "overhang_4_4_speed")
}

/// No layer is slowed down where that is off.
pub(super) fn layer_time(values: &Values) -> Option<String> {
    let is_on = values.is_on("slow_down_for_layer_cooling");
    Some(if is_on { values.text("slow_down_layer_time") } else { "0".into() })
}

fn overhangs_are_cooled(values: &Values) -> bool {
    values.is_on("enable_overhang_bridge_fan")
}

/// Share of a line that hangs free from which on overhangs are cooled.
fn threshold(values: &Values) -> f64 {
    values.number_of("overhang_fan_threshold", Some(1.0)).unwrap_or(1.0)
}

/// Bridges alone are cooled from 95 % on.
const BRIDGES: f64 = 0.95;

pub(super) fn dynamic_fan(values: &Values) -> Option<String> {
    Some(flag(overhangs_are_cooled(values) && threshold(values) < BRIDGES))
}

pub(super) fn bridge_fan(values: &Values) -> Option<String> {
    overhangs_are_cooled(values).then(|| values.text("overhang_fan_speed"))
}

/// The fan where so much of a line rests on what is beneath.
pub(super) fn overhang_fan(values: &Values, share_on_something: f64) -> String {
    let is_beyond = 1.0 - share_on_something >= threshold(values);
    values.text(if is_beyond { "overhang_fan_speed" } else { "fan_min_speed" })
}

/// Where inner walls do not come first, it has no effect.
pub(super) fn precise_wall(values: &Values) -> Option<String> {
    let inner_first = values.text("wall_sequence") == "inner wall/outer wall";
    Some(flag(values.is_on("precise_outer_wall") && inner_first))
}

pub(super) fn min_top_width(values: &Values) -> Option<String> {
    values.is_on("only_one_wall_top").then(|| values.text("min_width_top_surface"))
}

/// Heated and waited for where the filament asks for it and the printer can.
pub(super) fn chamber_temperature(values: &Values) -> Option<String> {
    let is_on = values.is_on("activate_chamber_temp_control") && values.is_on("support_chamber_temp_control");
    Some(if is_on { values.text("chamber_temperature") } else { "0".into() })
}

fn flag(on: bool) -> String {
    if on { "1".into() } else { "0".into() }
}

/// A plate by the key of its temperature, in the slicers' own words.
pub(super) fn plate_name(key: &str) -> &'static str {
    match key {
        "cool_plate_temp" => "Cool Plate",
        "eng_plate_temp" => "Engineering Plate",
        "textured_plate_temp" => "Textured PEI Plate",
        "textured_cool_plate_temp" => "Textured Cool Plate",
        "supertack_plate_temp" => "Supertack Plate",
        "epoxy_resin_plate_temp" => "Epoxy Resin Plate",
        "customized_plate_temp" => "Customized Plate",
        _ => "High Temp Plate",
    }
}
