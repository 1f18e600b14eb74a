//! The rules for configurations of several extruders; where there is one, they have nothing to say.

use toml::Value;

use super::row::Outcome::{self, Idle, Left};
use crate::gcode::ToolChangeKind;
use crate::presets::Config;
use crate::profile::tools::MOST_TOOLS;

pub(super) fn of_several(config: &Config, value: impl FnOnce() -> Option<Value>) -> Outcome {
    match config.extruders() {
        0 | 1 if !config.of_object => Idle,
        _ => value().map_or_else(|| Left("is not understood".into()), Outcome::Value),
    }
}

fn number(config: &Config, key: &str) -> Outcome {
    of_several(config, || config.number(key).map(Value::Float))
}

/// A percentage, whether or not it says so.
fn percent(config: &Config, key: &str) -> Outcome {
    of_several(config, || Some(Value::Float(config.number_of(key, Some(100.0))? / 100.0)))
}

/// A number that is looked for under two names.
fn either(config: &Config, keys: [&str; 2]) -> Outcome {
    of_several(config, || keys.iter().find_map(|key| config.number(key)).map(Value::Float))
}

pub(super) fn is_single(config: &Config) -> bool {
    config.flag("single_extruder_multi_material").unwrap_or(false)
}

pub(super) fn kind(config: &Config) -> Outcome {
    let kind = if is_single(config) { ToolChangeKind::SingleNozzle } else { ToolChangeKind::ToolChanger };
    of_several(config, || Some(Value::String(kind.name().into())))
}

/// Of several nozzles it is not known whether the others are out of the way, unless the script of a change parks them.
pub(super) fn ahead(config: &Config) -> Outcome {
    if is_single(config) || parks(config) { Idle } else { of_several(config, || Some(Value::Float(0.0))) }
}

/// Whether a change puts the tool in use back into its dock, as that of the Original Prusa XL does with `P0 S1`.
fn parks(config: &Config) -> bool {
    let script = config.script("toolchange_gcode");
    let mut lines = script.lines().map(|line| line.trim_start_matches([' ', '\t', '"']));
    lines.any(|line| line.starts_with("P0 S1"))
}

pub(super) fn script(config: &Config) -> Outcome {
    of_several(config, || Some(Value::String(config.script("toolchange_gcode"))))
}

/// Only a single nozzle has its filament taken out and another put in.
pub(super) fn time(config: &Config) -> Outcome {
    if !is_single(config) {
        return Idle;
    }
    let seconds = |key| config.number(key).unwrap_or(0.0);
    of_several(config, || Some(Value::Float(seconds("filament_load_time") + seconds("filament_unload_time"))))
}

/// Other printers have a purge that is the same for all.
pub(super) fn flush_volumes(config: &Config) -> Outcome {
    let count = config.extruders();
    if config.flag("wiping_volumes_use_custom_matrix") == Some(false) {
        return of_single(config, || purges(config, count));
    }
    let both = || from_and_to(config.list("wiping_volumes_extruders")?, count);
    match config.list("wiping_volumes_matrix").or_else(both) {
        _ if count < 2 || !is_single(config) => Idle,
        // Where a preset says nothing, projects do.
        Some(volumes) if volumes.iter().all(|mm3| *mm3 <= 0.0) => Idle,
        None if config.text("wiping_volumes_matrix").is_none_or(|text| text.trim().is_empty()) => Idle,
        Some(volumes) if count > MOST_TOOLS || volumes.len() != count * count => {
            Left(format!("{} volumes for {count} extruders", volumes.len()))
        }
        Some(volumes) => Outcome::Value(Value::Array(volumes.into_iter().map(Value::Float).collect())),
        None => Left("is not understood".into()),
    }
}

fn of_single(config: &Config, value: impl FnOnce() -> Option<Value>) -> Outcome {
    if is_single(config) { of_several(config, value) } else { Idle }
}

/// Every change flushes the same, but for a multiplier of the filament that is loaded.
fn purges(config: &Config, count: usize) -> Option<Value> {
    let purge_mm3 = config.number("multimaterial_purging").unwrap_or(140.0);
    let into = |to: usize| {
        let own = config.of_extruder(to).number_of("filament_purge_multiplier", Some(1.0));
        purge_mm3 * own.unwrap_or(1.0)
    };
    let volume = |(from, to): (usize, usize)| Value::Float(if from == to { 0.0 } else { into(to) });
    let pairs = (0..count).flat_map(|from| (0..count).map(move |to| (from, to)));
    (count <= MOST_TOOLS).then(|| Value::Array(pairs.map(volume).collect()))
}

/// What each filament takes to be flushed out and to be flushed in, as volumes from each to each.
fn from_and_to(all: Vec<f64>, count: usize) -> Option<Vec<f64>> {
    let volume = |(from, to): (usize, usize)| if from == to { 0.0 } else { all[2 * from] + all[2 * to + 1] };
    let pairs = (0..count).flat_map(|from| (0..count).map(move |to| (from, to)));
    (all.len() >= 2 * count).then(|| pairs.map(volume).collect())
}

pub(super) fn flush_multiplier(config: &Config) -> Outcome {
    of_single(config, || config.number("flush_multiplier").map(Value::Float))
}

fn flag(config: &Config, key: &str) -> Outcome {
    of_several(config, || config.flag(key).map(Value::Boolean))
}

pub(super) fn flush_into_infill(config: &Config) -> Outcome {
    let key =
        if config.flag("flush_into_infill").is_some() { "flush_into_infill" } else { "wipe_into_infill" };
    flag(config, key)
}

/// Who wants that for all objects has none whose color would matter.
pub(super) fn flush_into_objects(config: &Config) -> Outcome {
    let keys = ["wipe_into_objects", "flush_into_objects"];
    match keys.iter().find_map(|key| config.flag(key)) {
        Some(on) if config.of_object => Outcome::Value(Value::Boolean(on)),
        Some(true) if config.extruders() > 1 => {
            Left("objects are chosen for that with --object NAME:flush=true".into())
        }
        _ => Idle,
    }
}

pub(super) fn ooze_shield(config: &Config) -> Outcome {
    config.flag("ooze_shield").map_or(Idle, |on| Outcome::Value(Value::Boolean(on)))
}

pub(super) fn ooze_shield_distance(config: &Config) -> Outcome {
    config.number("ooze_shield_distance").map_or(Idle, |mm| Outcome::Value(Value::Float(mm)))
}

pub(super) fn flush_into_support(config: &Config) -> Outcome {
    flag(config, "flush_into_support")
}

pub(super) fn offset(config: &Config) -> Outcome {
    of_several(config, || {
        let offset = *config.points("extruder_offset")?.first()?;
        Some(Value::Array(offset.map(Value::Float).to_vec()))
    })
}

pub(super) fn idle_temperature(config: &Config) -> Outcome {
    match config.flag("ooze_prevention") {
        Some(true) => number(config, "idle_temperature"),
        _ => Idle,
    }
}

pub(super) fn change_length(config: &Config) -> Outcome {
    either(config, ["filament_retract_length_toolchange", "retract_length_toolchange"])
}

pub(super) fn change_extra(config: &Config) -> Outcome {
    either(config, ["filament_retract_restart_extra_toolchange", "retract_restart_extra_toolchange"])
}

/// The tool of a role; the first, which all have unless another is asked for, leaves it to the object.
fn role(config: &Config, key: &str) -> Outcome {
    of_several(config, || {
        let tool = config.number(key)? as i64;
        Some(Value::Integer(if tool < 2 { 0 } else { tool }))
    })
}

pub(super) fn walls(config: &Config) -> Outcome {
    role(config, "perimeter_extruder")
}

pub(super) fn infill(config: &Config) -> Outcome {
    role(config, "infill_extruder")
}

pub(super) fn solid_infill(config: &Config) -> Outcome {
    role(config, "solid_infill_extruder")
}

pub(super) fn support(config: &Config) -> Outcome {
    of_several(config, || Some(Value::Integer(config.number("support_material_extruder")? as i64)))
}

pub(super) fn support_interface(config: &Config) -> Outcome {
    of_several(config, || Some(Value::Integer(config.number("support_material_interface_extruder")? as i64)))
}

pub(super) fn tower(config: &Config) -> Outcome {
    of_several(config, || config.flag("wipe_tower").map(Value::Boolean))
}

pub(super) fn primed(config: &Config) -> Outcome {
    flag(config, "single_extruder_multi_material_priming")
}

pub(super) fn tower_width(config: &Config) -> Outcome {
    number(config, "wipe_tower_width")
}

pub(super) fn tower_line_distance(config: &Config) -> Outcome {
    number(config, "wipe_tower_bridging")
}

pub(super) fn tower_flush_width(config: &Config) -> Outcome {
    percent(config, "wipe_tower_extra_flow")
}

pub(super) fn tower_flush_spacing(config: &Config) -> Outcome {
    percent(config, "wipe_tower_extra_spacing")
}

pub(super) fn tower_brim(config: &Config) -> Outcome {
    // Below 0: as wide as is found to be right.
    match config.number("wipe_tower_brim_width") {
        Some(width) if width < 0.0 => Idle,
        _ => number(config, "wipe_tower_brim_width"),
    }
}
