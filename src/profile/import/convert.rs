//! The rules of the [table](super::table): from a value of theirs to one of ours.

use toml::Value;

use super::row::Outcome::{self, Idle, Left, Near};
use super::row::{How, Row};
use super::swap;
use crate::estimate::MachineSettings;
use crate::gcode::{Flavor, thumbnail_list};
use crate::options::Kind;
use crate::presets::{Config, Dialect};
use crate::profile::schema;
use crate::toolpath::Pattern;
use crate::units::{MmPerS, MmPerS2};

/// Width of automatic lines, as a share of the nozzle.
const AUTO_WIDTH: f64 = 1.125;

/// Share of the nozzle that automatic layers are high at most.
const AUTO_HEIGHT: f64 = 0.75;

/// Share of the travel speed at which wipes are made.
const WIPE_SPEED: f64 = 0.8;

/// Degrees.
const STRAIGHT_UP: f64 = 90.0;

/// Anchors that are not limited are this long.
const LONGEST_ANCHOR_MM: f64 = 100.0;

/// No limit, for lengths.
const ANY_MM: f64 = 10_000.0;

/// The value that a row gives.
pub(super) fn row(row: &Row, config: &Config) -> Outcome {
    match row.how {
        How::With(rule) => rule(config),
        How::OfNozzle if !swap::is_swapped(config) => Outcome::Idle,
        How::Same | How::OfNozzle => same(row, config).unwrap_or_else(|| Left("is not understood".into())),
    }
}

/// The first of their keys that is set, as it is.
fn same(row: &Row, config: &Config) -> Option<Outcome> {
    let key = row.theirs.iter().find(|key| config.text(key).is_some())?;
    let field = schema::field(row.ours)?;
    let value = match field.kind {
        // Factors may be written as percentages.
        Kind::Number if field.unit.is_empty() => return Some(known(config.number_of(key, Some(1.0)))),
        Kind::Number => Value::Float(config.number(key)?),
        Kind::Count => Value::Integer(config.number(key)? as i64),
        Kind::Share => return share(config, key),
        Kind::Flag => Value::Boolean(config.flag(key)?),
        Kind::Text => Value::String(config.text(key)?.split(';').next()?.trim_matches('"').to_owned()),
        _ => return None,
    };
    Some(Outcome::Value(value))
}

/// `20%`, `20` or `0.2`.
fn share(config: &Config, key: &str) -> Option<Outcome> {
    let share = config.number_of(key, Some(1.0))?;
    let is_percent = config.first(key)?.ends_with('%');
    Some(number(if is_percent || share <= 1.0 { share } else { share / 100.0 }))
}

fn number(value: f64) -> Outcome {
    Outcome::Value(Value::Float((value * 1e9).round() / 1e9))
}

fn numbers(values: &[f64]) -> Outcome {
    Outcome::Value(Value::Array(values.iter().map(|v| Value::Float(*v)).collect()))
}

fn word(text: &str) -> Outcome {
    Outcome::Value(Value::String(text.into()))
}

fn flag(on: bool) -> Outcome {
    Outcome::Value(Value::Boolean(on))
}

/// A number, or why there is none.
fn known(value: Option<f64>) -> Outcome {
    value.map_or_else(|| Left("is not understood, or relative to what is not given".into()), number)
}

/// No value of ours for this one of theirs.
fn no_such(config: &Config, key: &str) -> Outcome {
    Left(format!("there is no `{}` here", config.text(key).unwrap_or_default()))
}

/// A number; 0 and unknown ones leave ours as it is.
fn above_zero(value: Option<f64>) -> Outcome {
    match value {
        Some(value) if value > 0.0 => number(value),
        Some(_) => Idle,
        None => known(None),
    }
}

pub(super) fn flavor(config: &Config) -> Outcome {
    match config.text("gcode_flavor") {
        Some("marlin2") => word(Flavor::Marlin.name()),
        Some("marlin") => word(Flavor::MarlinLegacy.name()),
        Some("reprap") => {
            Near(Value::String(Flavor::MarlinLegacy.name().into()), "spoken as Marlin 1 does".into())
        }
        Some("klipper") => word(Flavor::Klipper.name()),
        Some("reprapfirmware") => word(Flavor::RepRapFirmware.name()),
        _ => no_such(config, "gcode_flavor"),
    }
}

/// A limit of each axis.
fn axes(config: &Config, limit: &str, usual: [f64; 4]) -> Outcome {
    let names = ["x", "y", "z", "e"];
    let stated = names.map(|axis| config.number(&format!("machine_max_{limit}_{axis}")));
    numbers(&[0, 1, 2, 3].map(|i| stated[i].unwrap_or(usual[i])))
}

pub(super) fn max_speed(config: &Config) -> Outcome {
    axes(config, "feedrate", MachineSettings::default().max_speed.map(|MmPerS(speed)| speed))
}

pub(super) fn max_acceleration(config: &Config) -> Outcome {
    axes(config, "acceleration", MachineSettings::default().max_acceleration.map(|MmPerS2(a)| a))
}

pub(super) fn jerk(config: &Config) -> Outcome {
    axes(config, "jerk", MachineSettings::default().jerk.map(|MmPerS(speed)| speed))
}

pub(super) fn density(config: &Config) -> Outcome {
    above_zero(config.number("filament_density"))
}

pub(super) fn cost(config: &Config) -> Outcome {
    above_zero(config.number("filament_cost"))
}

fn nozzle_mm(config: &Config) -> Option<f64> {
    config.number("nozzle_diameter")
}

fn height_mm(config: &Config) -> Option<f64> {
    config.number("layer_height")
}

fn first_height_mm(config: &Config) -> Option<f64> {
    config.number_of("first_layer_height", height_mm(config))
}

pub(super) fn first_height(config: &Config) -> Outcome {
    known(first_height_mm(config))
}

pub(super) fn min_height(config: &Config) -> Outcome {
    above_zero(config.number_of("min_layer_height", nozzle_mm(config)))
}

pub(super) fn max_height(config: &Config) -> Outcome {
    match config.number_of("max_layer_height", nozzle_mm(config)) {
        Some(0.0) => known(nozzle_mm(config).map(|nozzle_mm| AUTO_HEIGHT * nozzle_mm)),
        other => known(other),
    }
}

pub(super) fn elephant_foot(config: &Config) -> Outcome {
    let by_super = config.number("first_layer_size_compensation").map(|mm| 0.0 - mm);
    known(config.number("elefant_foot_compensation").or(by_super))
}

/// Width of a line; `None`: it depends on what is not given.
fn width_mm(config: &Config, key: &str) -> Option<f64> {
    let of = |key: &str| match config.text(key) {
        Some(_) => config.number_of(key, height_mm(config)),
        None => Some(0.0),
    };
    let own = of(key)?;
    let common = if own > 0.0 { own } else { of("extrusion_width")? };
    if common > 0.0 { Some(common) } else { nozzle_mm(config).map(|nozzle_mm| AUTO_WIDTH * nozzle_mm) }
}

pub(super) fn wall_width(config: &Config) -> Outcome {
    known(width_mm(config, "perimeter_extrusion_width"))
}

pub(super) fn external_width(config: &Config) -> Outcome {
    known(width_mm(config, "external_perimeter_extrusion_width"))
}

pub(super) fn solid_width(config: &Config) -> Outcome {
    known(width_mm(config, "solid_infill_extrusion_width"))
}

pub(super) fn top_width(config: &Config) -> Outcome {
    known(width_mm(config, "top_infill_extrusion_width"))
}

pub(super) fn infill_width(config: &Config) -> Outcome {
    known(width_mm(config, "infill_extrusion_width"))
}

pub(super) fn first_width(config: &Config) -> Outcome {
    let height_mm = first_height_mm(config);
    let width_mm = config.number_of("first_layer_extrusion_width", height_mm);
    match (width_mm, height_mm) {
        (Some(width), Some(height)) if width > 0.0 && width < height => {
            Near(Value::Float(height), "lines are as wide as their layer is high, at least".into())
        }
        _ => known(width_mm),
    }
}

pub(super) fn generator(config: &Config) -> Outcome {
    match config.text("perimeter_generator") {
        Some("classic") => word("classic"),
        Some("arachne") => word("variable"),
        _ => no_such(config, "perimeter_generator"),
    }
}

pub(super) fn wall_order(config: &Config) -> Outcome {
    let outer_first = config.flag("external_perimeters_first") == Some(true);
    word(if outer_first { "outer-first" } else { "inner-first" })
}

/// A length that is a share of the nozzle and holds with walls of variable width alone.
fn of_variable_walls(config: &Config, key: &str) -> Outcome {
    match config.text("perimeter_generator") {
        Some("classic") => Idle,
        _ => known(config.number_of(key, nozzle_mm(config))),
    }
}

pub(super) fn min_feature(config: &Config) -> Outcome {
    of_variable_walls(config, "min_feature_size")
}

pub(super) fn min_width(config: &Config) -> Outcome {
    of_variable_walls(config, "min_bead_width")
}

pub(super) fn gap_fill(config: &Config) -> Outcome {
    let wanted = ["gap_fill_enabled", "fill_gaps", "gap_fill"].iter().find_map(|key| config.flag(key));
    flag(wanted != Some(false) && config.number("gap_fill_speed") != Some(0.0))
}

pub(super) fn single_on_top(config: &Config) -> Outcome {
    match config.text("top_one_perimeter_type") {
        Some(same @ ("none" | "top" | "topmost")) => word(same),
        Some(_) => no_such(config, "top_one_perimeter_type"),
        None => word(if config.flag("only_one_perimeter_top") == Some(true) { "top" } else { "none" }),
    }
}

pub(super) fn min_top_width(config: &Config) -> Outcome {
    known(config.number_of("min_width_top_surface", width_mm(config, "perimeter_extrusion_width")))
}

pub(super) fn min_thickness(config: &Config) -> Outcome {
    let [top, bottom] =
        ["top_solid_min_thickness", "bottom_solid_min_thickness"].map(|key| config.number(key));
    match (top, bottom) {
        (Some(top), Some(bottom)) if top != bottom => {
            Near(Value::Float(top.max(bottom)), "for top and bottom alike".into())
        }
        _ => known(top.or(bottom)),
    }
}

pub(super) fn monotonic(config: &Config) -> Outcome {
    let keys = ["top_fill_pattern", "top_infill_pattern", "external_fill_pattern"];
    let key = keys.into_iter().find(|key| config.text(key).is_some());
    match key.and_then(|key| config.text(key)) {
        Some("monotonic" | "monotoniclines") => flag(true),
        Some("rectilinear") => flag(false),
        _ => no_such(config, key.unwrap_or_default()),
    }
}

pub(super) fn pattern(config: &Config) -> Outcome {
    let theirs = config.text("fill_pattern").unwrap_or_default();
    let ours = match theirs {
        "alignedrectilinear" => "aligned-rectilinear",
        "stars" => "tri-hexagon",
        "3dhoneycomb" => "3d-honeycomb",
        "hilbertcurve" => "hilbert",
        "adaptivecubic" => "adaptive-cubic",
        same => same,
    };
    if Pattern::NAMES.contains(&ours) { word(ours) } else { no_such(config, "fill_pattern") }
}

pub(super) fn overlap(config: &Config) -> Outcome {
    match config.first("infill_overlap") {
        Some(text) if text.ends_with('%') => known(config.number_of("infill_overlap", Some(1.0))),
        _ => {
            let width_mm = width_mm(config, "infill_extrusion_width");
            known(config.number("infill_overlap").zip(width_mm).map(|(overlap, width)| overlap / width))
        }
    }
}

pub(super) fn connect(config: &Config) -> Outcome {
    flag(config.number_of("infill_anchor_max", Some(1.0)) != Some(0.0))
}

pub(super) fn anchor(config: &Config) -> Outcome {
    let width_mm = width_mm(config, "infill_extrusion_width");
    let most_mm = config.number_of("infill_anchor_max", width_mm).unwrap_or(LONGEST_ANCHOR_MM);
    known(config.number_of("infill_anchor", width_mm).map(|mm| mm.min(most_mm).min(LONGEST_ANCHOR_MM)))
}

pub(super) fn sequence(config: &Config) -> Outcome {
    word(if config.flag("complete_objects") == Some(true) { "object" } else { "layer" })
}

pub(super) fn fuzzy_walls(config: &Config) -> Outcome {
    match config.text("fuzzy_skin") {
        Some("none") => word("none"),
        Some("external") => word("outer"),
        Some("all") => word("all"),
        _ => no_such(config, "fuzzy_skin"),
    }
}

pub(super) fn first_speed(config: &Config) -> Outcome {
    match config.first("first_layer_speed") {
        Some(text) if text.ends_with('%') => {
            let speed = config.number_of("first_layer_speed", config.number("perimeter_speed"));
            speed.map_or_else(
                || known(None),
                |speed| Near(Value::Float(speed), "of `perimeter_speed`, for all that is on it".into()),
            )
        }
        _ => known(config.number("first_layer_speed")),
    }
}

/// The acceleration of most moves: the first of these keys that is not 0, or else the machine's own for them; a
/// percentage is of the default one. Where limits are stated, no more than the machine's.
fn acceleration_of(config: &Config, own: &[&str], limit: &str) -> Outcome {
    let default = config.number("default_acceleration");
    let most = config.number(limit).filter(|most| *most > 0.0 && states_limits(config));
    for &key in own.iter().chain(&["default_acceleration", limit]) {
        match config.first(key).map(|_| config.number_of(key, default)) {
            Some(Some(acceleration)) if acceleration > 0.0 => {
                return number(most.map_or(acceleration, |most| most.min(acceleration)));
            }
            Some(None) => return known(None),
            _ => {}
        }
    }
    Idle
}

const EXTRUDING: &str = "machine_max_acceleration_extruding";

pub(super) fn acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &[], EXTRUDING)
}

pub(super) fn external_acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &["external_perimeter_acceleration", "perimeter_acceleration"], EXTRUDING)
}

pub(super) fn perimeter_acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &["perimeter_acceleration"], EXTRUDING)
}

pub(super) fn infill_acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &["infill_acceleration"], EXTRUDING)
}

pub(super) fn solid_acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &["solid_infill_acceleration", "infill_acceleration"], EXTRUDING)
}

pub(super) fn top_acceleration(config: &Config) -> Outcome {
    let keys = ["top_solid_infill_acceleration", "solid_infill_acceleration", "infill_acceleration"];
    acceleration_of(config, &keys, EXTRUDING)
}

/// 0 is that of what the bridge is part of, here as there.
pub(super) fn bridge_acceleration(config: &Config) -> Outcome {
    known(config.number_of("bridge_acceleration", config.number("default_acceleration")))
}

pub(super) fn first_acceleration(config: &Config) -> Outcome {
    known(config.number_of("first_layer_acceleration", config.number("default_acceleration")))
}

pub(super) fn travel_acceleration(config: &Config) -> Outcome {
    acceleration_of(config, &["travel_acceleration"], "machine_max_acceleration_travel")
}

/// From filament to the length of a bead on the first layer.
pub(super) fn skirt_length(config: &Config) -> Outcome {
    let Some(filament_mm) = config.number("min_skirt_length") else { return known(None) };
    if filament_mm == 0.0 {
        return number(0.0);
    }
    let bead = width_mm(config, "first_layer_extrusion_width").zip(first_height_mm(config));
    let filament_mm2 = config.number("filament_diameter").map(|d| std::f64::consts::FRAC_PI_4 * d * d);
    known(
        bead.zip(filament_mm2)
            .map(|((width, height), filament_area)| filament_mm * filament_area / (width * height)),
    )
}

pub(super) fn brim_width(config: &Config) -> Outcome {
    let none = config.text("brim_type") == Some("no_brim");
    known(if none { Some(0.0) } else { config.number("brim_width") })
}

pub(super) fn brim_sides(config: &Config) -> Outcome {
    match config.text("brim_type") {
        Some("outer_only") => word("outer"),
        Some("inner_only") => word("inner"),
        Some("outer_and_inner") => word("both"),
        Some("no_brim") => Idle,
        _ => no_such(config, "brim_type"),
    }
}

pub(super) fn support(config: &Config) -> Outcome {
    let wanted = config.flag("support_material") == Some(true);
    if wanted && config.flag("support_material_auto") == Some(false) {
        let note = "without `support_material_auto` only enforced support is wanted: `--support-enforcer`";
        return Near(Value::Boolean(false), note.into());
    }
    flag(wanted)
}

pub(super) fn support_style(config: &Config) -> Outcome {
    match config.text("support_material_style") {
        Some("grid") => word("grid"),
        Some("snug") => Near(Value::String("grid".into()), "there are no snug ones".into()),
        Some("tree" | "organic") => word("tree"),
        _ => no_such(config, "support_material_style"),
    }
}

pub(super) fn support_angle(config: &Config) -> Outcome {
    match config.first("support_material_threshold") {
        Some(text) if !text.ends_with('%') => match config.number("support_material_threshold") {
            Some(degrees) if degrees > 0.0 => number(90.0 - degrees),
            Some(_) => Idle,
            None => known(None),
        },
        _ => no_such(config, "support_material_threshold"),
    }
}

pub(super) fn max_bridge(config: &Config) -> Outcome {
    match config.flag("dont_support_bridges") {
        Some(false) => number(0.0),
        _ => Idle,
    }
}

pub(super) fn z_gap(config: &Config) -> Outcome {
    known(config.number_of("support_material_contact_distance", nozzle_mm(config)))
}

pub(super) fn xy_gap(config: &Config) -> Outcome {
    let whole = width_mm(config, "external_perimeter_extrusion_width");
    known(config.number_of("support_material_xy_spacing", whole))
}

pub(super) fn support_pattern(config: &Config) -> Outcome {
    match config.text("support_material_pattern") {
        Some("rectilinear") => word("rectilinear"),
        Some("rectilinear-grid") => word("grid"),
        _ => no_such(config, "support_material_pattern"),
    }
}

fn support_width_mm(config: &Config) -> Option<f64> {
    match config.number_of("support_material_extrusion_width", height_mm(config)) {
        Some(width_mm) if width_mm > 0.0 => Some(width_mm),
        _ => nozzle_mm(config),
    }
}

pub(super) fn support_width(config: &Config) -> Outcome {
    known(support_width_mm(config))
}

/// A density from the free distance between lines.
fn of_spacing(config: &Config, key: &str) -> Outcome {
    known(support_width_mm(config).zip(config.number(key)).map(|(width, free)| width / (width + free)))
}

pub(super) fn support_density(config: &Config) -> Outcome {
    of_spacing(config, "support_material_spacing")
}

pub(super) fn interface_density(config: &Config) -> Outcome {
    of_spacing(config, "support_material_interface_spacing")
}

pub(super) fn seam(config: &Config) -> Outcome {
    match config.text("seam_position") {
        Some("nearest" | "near" | "cost") => word("free"),
        Some("aligned") => word("aligned"),
        Some("rear") => word("rear"),
        Some("random" | "allrandom") => word("random"),
        _ => no_such(config, "seam_position"),
    }
}

pub(super) fn seam_gap(config: &Config) -> Outcome {
    let keys = ["filament_seam_gap_distance", "seam_gap_distance", "seam_gap"];
    let set = keys.into_iter().find(|key| config.text(key).is_some());
    known(set.and_then(|key| config.number_of(key, nozzle_mm(config))))
}

pub(super) fn scarf(config: &Config) -> Outcome {
    match config.text("scarf_seam_placement") {
        Some("nowhere") => number(0.0),
        Some("everywhere") => known(config.number("scarf_seam_length")),
        _ => no_such(config, "scarf_seam_placement"),
    }
}

/// What an automatic speed becomes.
const AUTOMATIC: &str = "automatic there: `max_print_speed`, as far as the hot end melts as much";

/// A speed in mm/s, relative to another where it is a percentage.
fn speed(config: &Config, key: &str, whole: Option<f64>) -> Outcome {
    if config.text(key).is_none() {
        return Idle;
    }
    match config.number_of(key, whole) {
        Some(0.0) => match config.number("max_print_speed") {
            Some(most) if most > 0.0 => Near(Value::Float(most), AUTOMATIC.into()),
            _ => Left("is automatic there".into()),
        },
        other => known(other),
    }
}

/// A speed that is 0 where it is that of something else, here as there.
fn own_speed(config: &Config, key: &str, whole: Option<f64>) -> Outcome {
    known(config.number_of(key, whole))
}

pub(super) fn perimeter_speed(config: &Config) -> Outcome {
    speed(config, "perimeter_speed", None)
}

/// What is as fast as other walls has no speed of its own.
pub(super) fn small_speed(config: &Config) -> Outcome {
    let perimeter = config.number("perimeter_speed");
    let own = config.number_of("small_perimeter_speed", perimeter);
    let is_like_others = own.is_some() && own == perimeter && own == external_mm_s(config);
    known(if is_like_others { Some(0.0) } else { own })
}

fn external_mm_s(config: &Config) -> Option<f64> {
    config.number_of("external_perimeter_speed", config.number("perimeter_speed"))
}

pub(super) fn external_speed(config: &Config) -> Outcome {
    speed(config, "external_perimeter_speed", config.number("perimeter_speed"))
}

/// Patterns whose lines cross each other have a limit of their own.
const CROSSING: &[&str] = &["grid", "triangles", "stars", "cubic", "adaptivecubic", "supportcubic"];

/// No faster than the filament allows.
pub(super) fn infill_speed(config: &Config) -> Outcome {
    let crosses = config.text("fill_pattern").is_some_and(|pattern| CROSSING.contains(&pattern));
    let key = if crosses { "filament_infill_max_crossing_speed" } else { "filament_infill_max_speed" };
    let most = config.number(key).filter(|most| *most > 0.0);
    match (speed(config, "infill_speed", None), most) {
        (Outcome::Value(Value::Float(speed)), Some(most)) => number(speed.min(most)),
        (Near(Value::Float(speed), note), Some(most)) => Near(Value::Float(speed.min(most)), note),
        (outcome, _) => outcome,
    }
}

fn solid_mm_s(config: &Config) -> Option<f64> {
    config.number_of("solid_infill_speed", config.number("infill_speed"))
}

pub(super) fn solid_speed(config: &Config) -> Outcome {
    speed(config, "solid_infill_speed", config.number("infill_speed"))
}

pub(super) fn top_speed(config: &Config) -> Outcome {
    speed(config, "top_solid_infill_speed", solid_mm_s(config))
}

pub(super) fn ironing_speed(config: &Config) -> Outcome {
    speed(config, "ironing_speed", solid_mm_s(config))
}

pub(super) fn bridge_speed(config: &Config) -> Outcome {
    speed(config, "bridge_speed", None)
}

pub(super) fn gap_fill_speed(config: &Config) -> Outcome {
    match config.number("gap_fill_speed") {
        Some(0.0) => Idle,
        _ => speed(config, "gap_fill_speed", config.number("perimeter_speed")),
    }
}

pub(super) fn support_speed(config: &Config) -> Outcome {
    speed(config, "support_material_speed", None)
}

pub(super) fn interface_speed(config: &Config) -> Outcome {
    own_speed(config, "support_material_interface_speed", config.number("support_material_speed"))
}

pub(super) fn first_infill_speed(config: &Config) -> Outcome {
    own_speed(config, "first_layer_infill_speed", config.number("solid_infill_speed"))
}

/// The speeds of walls with this much of their width held: 0, 1, 2 and 3 quarters; 0 is that of outermost walls.
fn overhang_mm_s(config: &Config) -> Option<[f64; 4]> {
    let external = external_mm_s(config)?;
    let keys = ["overhang_speed_0", "overhang_speed_1", "overhang_speed_2", "overhang_speed_3"];
    let speeds = keys.map(|key| config.number_of(key, Some(external)));
    let [Some(a), Some(b), Some(c), Some(d)] = speeds else { return None };
    Some([a, b, c, d].map(|speed| if speed > 0.0 { speed } else { external }))
}

fn has_overhang_speeds(config: &Config) -> bool {
    config.flag("enable_dynamic_overhang_speeds") == Some(true)
}

pub(super) fn overhang_speed(config: &Config) -> Outcome {
    if !has_overhang_speeds(config) {
        let external = external_mm_s(config);
        let walls = external.into_iter().chain(config.number("perimeter_speed")).reduce(f64::max);
        return walls.map_or_else(|| known(None), |speed| numbers(&[speed; 3]));
    }
    overhang_mm_s(config).map_or_else(|| known(None), |[_, one, two, three]| numbers(&[three, two, one]))
}

pub(super) fn over_air(config: &Config) -> Outcome {
    if has_overhang_speeds(config) {
        return known(overhang_mm_s(config).map(|speeds| speeds[0]));
    }
    if config.flag("overhangs") == Some(false) {
        return known(
            external_mm_s(config).into_iter().chain(config.number("perimeter_speed")).reduce(f64::max),
        );
    }
    number(0.0)
}

/// What the filament and the print allow.
pub(super) fn max_flow(config: &Config) -> Outcome {
    let keys = ["filament_max_volumetric_speed", "max_volumetric_speed"];
    let flows = keys.map(|key| config.number(key));
    if flows.iter().all(Option::is_none) {
        return known(None);
    }
    number(flows.into_iter().flatten().filter(|flow| *flow > 0.0).reduce(f64::min).unwrap_or(0.0))
}

/// 0 is the travel speed there, which the machine's own limit of Z cuts.
pub(super) fn z_speed(config: &Config) -> Outcome {
    match config.number("travel_speed_z") {
        Some(0.0) => {
            let limit = config.number("machine_max_feedrate_z").filter(|limit| *limit > 0.0);
            let travel = config.number("travel_speed").filter(|speed| *speed > 0.0);
            limit.map_or(Idle, |limit| number(travel.map_or(limit, |travel| travel.min(limit))))
        }
        other => above_zero(other),
    }
}

/// A key of the filament, or else the printer's.
fn overridden(config: &Config, key: &str) -> Option<f64> {
    config.number(&format!("filament_{key}")).or_else(|| config.number(key))
}

pub(super) fn unretract_speed(config: &Config) -> Outcome {
    let own = overridden(config, "deretract_speed").filter(|speed| *speed > 0.0);
    known(own.or_else(|| overridden(config, "retract_speed")))
}

/// A switch of the filament, or else the printer's.
fn overridden_flag(config: &Config, key: &str) -> bool {
    let flag = config.flag(&format!("filament_{key}")).or_else(|| config.flag(key));
    flag == Some(true)
}

fn lift_mm(config: &Config) -> Option<f64> {
    let ramps = overridden_flag(config, "travel_ramping_lift");
    overridden(config, if ramps { "travel_max_lift" } else { "retract_lift" })
}

pub(super) fn z_hop(config: &Config) -> Outcome {
    known(lift_mm(config))
}

pub(super) fn z_hop_inside(config: &Config) -> Outcome {
    flag(lift_mm(config).is_some_and(|lift| lift > 0.0))
}

pub(super) fn z_hop_slope(config: &Config) -> Outcome {
    if !overridden_flag(config, "travel_ramping_lift") {
        return number(STRAIGHT_UP);
    }
    match overridden(config, "travel_slope") {
        Some(degrees) if degrees > 0.0 && degrees < STRAIGHT_UP => number(degrees.max(1.0)),
        Some(_) => number(STRAIGHT_UP),
        None => known(None),
    }
}

pub(super) fn z_hop_before_leaving(config: &Config) -> Outcome {
    match overridden_flag(config, "travel_ramping_lift") {
        true => flag(overridden_flag(config, "travel_lift_before_obstacle")),
        false => Idle,
    }
}

pub(super) fn layer_change(config: &Config) -> Outcome {
    flag(overridden_flag(config, "retract_layer_change"))
}

/// What is pulled back before a wipe, as a share.
fn share_before_wipe(config: &Config) -> f64 {
    let share = |key: &str| config.number_of(key, Some(1.0));
    let own = share("filament_retract_before_wipe").or_else(|| share("retract_before_wipe"));
    own.unwrap_or(0.0).clamp(0.0, 1.0)
}

pub(super) fn before_wipe(config: &Config) -> Outcome {
    number(share_before_wipe(config))
}

pub(super) fn wipe(config: &Config) -> Outcome {
    if !overridden_flag(config, "wipe") {
        return number(0.0);
    }
    let (length, speed) = (overridden(config, "retract_length"), overridden(config, "retract_speed"));
    let travel = config.number("travel_speed");
    let left = 1.0 - share_before_wipe(config);
    known(
        length
            .zip(speed)
            .zip(travel)
            .map(|((length, speed), travel)| WIPE_SPEED * travel * left * length / speed),
    )
}

pub(super) fn max_detour(config: &Config) -> Outcome {
    if config.flag("avoid_crossing_perimeters") != Some(true) {
        return Idle;
    }
    match config.number("avoid_crossing_perimeters_max_detour") {
        Some(0.0) => number(ANY_MM),
        Some(mm) => number(mm),
        None => Left("is relative to each travel".into()),
    }
}

pub(super) fn retract_inside(config: &Config) -> Outcome {
    let only_crossing = config.flag("only_retract_when_crossing_perimeters") == Some(true);
    number(if only_crossing { ANY_MM } else { 0.0 })
}

pub(super) fn min_layer_time(config: &Config) -> Outcome {
    match config.flag("cooling") {
        Some(false) => number(0.0),
        _ => known(config.number("slowdown_below_layer_time")),
    }
}

fn percent(config: &Config, key: &str) -> Option<f64> {
    config.number(key).map(|percent| percent / 100.0)
}

pub(super) fn fan(config: &Config) -> Outcome {
    match config.flag("fan_always_on") {
        Some(true) => known(percent(config, "min_fan_speed")),
        _ => number(0.0),
    }
}

pub(super) fn short_layer_time(config: &Config) -> Outcome {
    match config.flag("cooling") {
        Some(false) => number(0.0),
        _ => known(config.number("fan_below_layer_time")),
    }
}

pub(super) fn short_layer_fan(config: &Config) -> Outcome {
    let [least, most] = ["min_fan_speed", "max_fan_speed"].map(|key| percent(config, key));
    let (Some(least), Some(most)) = (least, most) else { return known(None) };
    let is_even = config.flag("fan_always_on") == Some(true) && least == most;
    if config.flag("cooling") == Some(false) || is_even {
        return numbers(&[0.0, 0.0]);
    }
    numbers(&[least, most])
}

/// Where the fan rises, it is off on the first layer.
fn fan_off(config: &Config) -> Option<f64> {
    let off = config.number("disable_fan_first_layers")?;
    let rises = config.number("full_fan_speed_layer").is_some_and(|layer| layer > 0.0);
    Some(if off <= 0.0 && rises { 1.0 } else { off })
}

pub(super) fn fan_off_layers(config: &Config) -> Outcome {
    let off = fan_off(config);
    off.map_or_else(|| known(None), |layers| Outcome::Value(Value::Integer(layers as i64)))
}

/// Theirs counts from 1.
pub(super) fn full_fan_layer(config: &Config) -> Outcome {
    let full = config.number("full_fan_speed_layer").map(|layer| (layer - 1.0).max(0.0));
    let last = full.into_iter().chain(fan_off(config)).reduce(f64::max);
    last.map_or_else(|| known(None), |layer| Outcome::Value(Value::Integer(layer as i64)))
}

pub(super) fn bridge_fan(config: &Config) -> Outcome {
    known(percent(config, "bridge_fan_speed"))
}

pub(super) fn overhang_fan(_config: &Config) -> Outcome {
    number(0.0)
}

/// Walls over nothing are bridges there.
pub(super) fn overhang_fan_steps(config: &Config) -> Outcome {
    let is_on = config.flag("enable_dynamic_fan_speeds") == Some(true);
    let step = |key: &str| percent(config, key).filter(|_| is_on).unwrap_or(0.0);
    let [air, three_quarters, half, quarter] =
        ["overhang_fan_speed_0", "overhang_fan_speed_1", "overhang_fan_speed_2", "overhang_fan_speed_3"]
            .map(step);
    let bridge = percent(config, "bridge_fan_speed").filter(|_| config.flag("overhangs") != Some(false));
    let bridge = bridge.unwrap_or(0.0);
    numbers(&[quarter, half, three_quarters, air.max(bridge)])
}

pub(super) fn arcs(config: &Config) -> Outcome {
    flag(config.text("arc_fitting") != Some("disabled"))
}

pub(super) fn thumbnails(config: &Config) -> Outcome {
    let text = config.text("thumbnails").unwrap_or_default();
    let format = config.text("thumbnails_format").unwrap_or("PNG");
    let all = text.split(',').map(|one| {
        let (size, format) = one.trim().split_once('/').unwrap_or((one.trim(), format));
        // SuperSlicer has another name for it.
        match format {
            "PNG" => size.to_owned(),
            "BIQU" => format!("{size}/BTT_TFT"),
            format => format!("{size}/{format}"),
        }
    });
    let all = all.collect::<Vec<_>>().join(",");
    match thumbnail_list(&all) {
        Ok(_) => word(&all),
        Err(reason) => Left(reason),
    }
}

pub(super) fn labels(config: &Config) -> Outcome {
    match config.text("gcode_label_objects") {
        Some("firmware" | "1") => flag(true),
        _ => flag(false),
    }
}

pub(super) fn label_comments(config: &Config) -> Outcome {
    flag(config.text("gcode_label_objects") == Some("octoprint"))
}

/// Whether limits are written to G-code, which not every dialect has commands for there.
fn states_limits(config: &Config) -> bool {
    config.text("machine_limits_usage") == Some("emit_to_gcode")
        && matches!(config.text("gcode_flavor"), Some("marlin" | "marlin2" | "reprapfirmware"))
}

pub(super) fn limits(config: &Config) -> Outcome {
    match config.text("machine_limits_usage") {
        Some("ignore") => Near(Value::Boolean(false), "the time estimate uses them here".into()),
        Some("emit_to_gcode" | "time_estimate_only") => flag(states_limits(config)),
        _ => no_such(config, "machine_limits_usage"),
    }
}

pub(super) fn min_speed(config: &Config) -> Outcome {
    let least = ["machine_min_extruding_rate", "machine_min_travel_rate"].map(|key| config.number(key));
    numbers(&least.map(|speed| speed.unwrap_or(0.0)))
}

/// A script, as it is written.
fn script_of(config: &Config, key: &str) -> Outcome {
    word(&config.script(key))
}

pub(super) fn start(config: &Config) -> Outcome {
    script_of(config, "start_gcode")
}

pub(super) fn filament_start(config: &Config) -> Outcome {
    script_of(config, "start_filament_gcode")
}

pub(super) fn before_layer(config: &Config) -> Outcome {
    script_of(config, "before_layer_gcode")
}

pub(super) fn after_layer(config: &Config) -> Outcome {
    script_of(config, "layer_gcode")
}

/// OrcaSlicer runs the scripts of layer changes on the first layer as well.
pub(super) fn first_layer_scripts(config: &Config) -> Outcome {
    flag(config.dialect == Dialect::Orca)
}

pub(super) fn between_objects(config: &Config) -> Outcome {
    script_of(config, "between_objects_gcode")
}

pub(super) fn filament_end(config: &Config) -> Outcome {
    script_of(config, "end_filament_gcode")
}

pub(super) fn end(config: &Config) -> Outcome {
    script_of(config, "end_gcode")
}

pub(super) fn pause(config: &Config) -> Outcome {
    script_of(config, "pause_print_gcode")
}

pub(super) fn color_change(config: &Config) -> Outcome {
    script_of(config, "color_change_gcode")
}
