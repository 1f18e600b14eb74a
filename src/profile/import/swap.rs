//! The rules for what a filament goes through at a change: cooling and ramming.

use toml::Value;

use super::row::Outcome::{self, Idle};
use super::several::{is_single, of_several};
use crate::presets::Config;

/// Whether several filaments are fed to a single nozzle.
pub(super) fn is_swapped(config: &Config) -> bool {
    config.extruders() > 1 && is_single(config)
}

pub(super) fn cooling_speed(config: &Config) -> Outcome {
    if !is_swapped(config) {
        return Idle;
    }
    let speed = |key| config.number(key).map(Value::Float);
    of_several(config, || {
        let ends = [speed("filament_cooling_initial_speed")?, speed("filament_cooling_final_speed")?];
        Some(Value::Array(ends.into()))
    })
}

/// The numbers before the bar: two percentages, of width and of distance, and the flows. What follows is the curve in
/// their dialog.
fn ramming_numbers(config: &Config) -> Option<Vec<f64>> {
    let text = config.text("filament_ramming_parameters")?.trim_matches('"');
    let numbers = text.split('|').next()?.split_whitespace();
    numbers.map(|number| number.parse().ok()).collect()
}

fn rams_one_flow(config: &Config) -> bool {
    config.flag("filament_multitool_ramming").unwrap_or(false)
}

pub(super) fn ramming(config: &Config) -> Outcome {
    of_several(config, || {
        let flows = match is_single(config) {
            true => ramming_numbers(config)?.into_iter().skip(2).collect(),
            false if rams_one_flow(config) => vec![config.number("filament_multitool_ramming_flow")?],
            false => Vec::new(),
        };
        Some(Value::Array(flows.into_iter().map(Value::Float).collect()))
    })
}

pub(super) fn ramming_step(config: &Config) -> Outcome {
    if is_single(config) || !rams_one_flow(config) {
        return Idle;
    }
    of_several(config, || {
        let volume_mm3 = config.number("filament_multitool_ramming_volume")?;
        Some(Value::Float(volume_mm3 / config.number("filament_multitool_ramming_flow")?))
    })
}

pub(super) fn ramming_width(config: &Config) -> Outcome {
    match is_single(config) {
        true => of_several(config, || Some(Value::Float(ramming_numbers(config)?.first()? / 100.0))),
        false if rams_one_flow(config) => of_several(config, || Some(Value::Float(2.0))),
        false => Idle,
    }
}

pub(super) fn ramming_spacing(config: &Config) -> Outcome {
    if !is_single(config) {
        return Idle;
    }
    of_several(config, || Some(Value::Float(ramming_numbers(config)?.get(1)? / 100.0)))
}

/// Whether the printer's notes ask for it, in either way that they do.
fn rams_extra(config: &Config) -> bool {
    let notes = config.text("printer_notes").unwrap_or_default().to_uppercase();
    notes.contains("RAMMING_EXTRA") || notes.contains("PRINTER_MODEL_MK4") && notes.contains("MMU")
}

pub(super) fn ramming_cooler(config: &Config) -> Outcome {
    if !rams_extra(config) {
        return Idle;
    }
    of_several(config, || Some(Value::Float(20.0)))
}

pub(super) fn high_current(config: &Config) -> Outcome {
    if !is_swapped(config) {
        return Idle;
    }
    of_several(config, || config.flag("high_current_on_filament_swap").map(Value::Boolean))
}

pub(super) fn sensor_off(config: &Config) -> Outcome {
    let notes = config.text("printer_notes").unwrap_or_default().to_uppercase();
    if !rams_extra(config) && !notes.contains("PRINTER_MODEL_XL") {
        return Idle;
    }
    of_several(config, || Some(Value::Boolean(true)))
}
