//! From values in the words of OrcaSlicer and its kin to a configuration.

use super::json::Written;
use super::keys::{ABOUT, KEYS, Key, Rule};
use super::rules;
use super::values::{Values, is_off};
use crate::presets::config::{Config, Dialect, Place};
use crate::presets::keys::key_type;
use crate::presets::value::{Scalar, Shape, Type, escaped, join_texts, written_alike};

/// The configuration that values amount to, what is built in included.
pub(super) fn config(values: &Values) -> Config {
    let mut config = Config { dialect: Dialect::Orca, ..Config::default() };
    for key in KEYS {
        let all = values.all(key.name);
        let kind = match key.kind {
            Type { scalar, shape: Shape::One } if all.len() > 1 => Type { scalar, shape: Shape::Each },
            kind => kind,
        };
        config.set_raw(key.name, &serialised(kind, &all), Some(kind));
        for (name, value, place) in said(key, &all, values) {
            config.set(name, &value, place);
        }
    }
    for (name, written, place) in values.written() {
        let is_known = KEYS.binary_search_by(|key| key.name.cmp(name)).is_ok() || ABOUT.contains(&name);
        if is_known {
            continue;
        }
        let (kind, value) = unknown(written);
        config.set_raw(name, &value, Some(kind));
        if !written.values.iter().all(|value| is_off(value)) {
            config.set(name, &value, place.clone());
        }
    }
    derived(&mut config, values);
    config
}

/// What a key says in PrusaSlicer's words.
fn said(key: &Key, all: &[String], values: &Values) -> Vec<(&'static str, String, Place)> {
    let own_place = values.place(key.name).cloned();
    let place = || own_place.clone().unwrap_or_else(|| Place::built_in(Dialect::Orca));
    let kept = |is_kept: bool| match (&own_place, is_kept && !all.iter().all(|value| is_off(value))) {
        (Some(place), true) => vec![(key.name, serialised(key.kind, all), place.clone())],
        _ => Vec::new(),
    };
    let is_as_built_in = || serialised(key.kind, all) == key.default;
    match key.rule {
        Rule::As(name) => vec![(name, for_prusa(name, key.kind, all), place())],
        Rule::Width(name) => {
            let width = rules::width(values, key.name);
            values.asked();
            width.map(|width| (name, width, place())).into_iter().collect()
        }
        Rule::Words(name, words) => {
            let theirs = all.first().map_or("", String::as_str);
            let word = words.iter().find(|(word, _)| *word == theirs).map_or(theirs, |(_, word)| *word);
            vec![(name, word.to_owned(), place())]
        }
        Rule::By(name, rule) => {
            values.asked();
            let Some(value) = rule(values) else { return Vec::new() };
            // Where the key itself is not written, that one is that made the rule say so.
            let place =
                own_place.or_else(|| values.asked()).unwrap_or_else(|| Place::built_in(Dialect::Orca));
            let mut said = Vec::new();
            match name {
                "enable_dynamic_fan_speeds" => {
                    const SHARES: [(&str, f64); 4] = [
                        ("overhang_fan_speed_0", 0.0),
                        ("overhang_fan_speed_1", 0.25),
                        ("overhang_fan_speed_2", 0.5),
                        ("overhang_fan_speed_3", 0.75),
                    ];
                    let fan = |(name, share)| (name, rules::overhang_fan(values, share), place.clone());
                    said.extend(SHARES.map(fan));
                }
                "ironing" if value == "1" => {
                    said.push(("ironing_type", values.text("ironing_type"), place.clone()))
                }
                _ => {}
            }
            said.push((name, for_prusa(name, key.kind, &[value]), place));
            said
        }
        Rule::Part | Rule::Idle => Vec::new(),
        Rule::Own => kept(!is_as_built_in()),
        Rule::On => kept(true),
        Rule::Under(switch) => kept(values.is_on(switch) && !is_as_built_in()),
    }
}

/// Values as PrusaSlicer would write them for its own key.
fn for_prusa(name: &str, kind: Type, all: &[String]) -> String {
    let target = key_type(name).unwrap_or(kind);
    serialised(if target.scalar == Scalar::Choice { kind } else { target }, all)
}

/// Values as PrusaSlicer writes values of that type.
fn serialised(kind: Type, all: &[String]) -> String {
    match (kind.shape, kind.scalar) {
        (Shape::One, Scalar::Text) => escaped(all.first().map_or("", String::as_str)),
        (_, Scalar::Text) => join_texts(all),
        (Shape::One, _) => written_alike(kind, all.first().map_or("", String::as_str)),
        _ => written_alike(kind, &all.join(",")),
    }
}

/// What nobody has described is numbers if it looks like numbers, else text.
fn unknown(written: &Written) -> (Type, String) {
    let is_number =
        |value: &String| value == "nil" || value.trim().trim_end_matches('%').parse::<f64>().is_ok();
    let shape = if written.is_list { Shape::Each } else { Shape::One };
    let numbers = !written.values.is_empty() && written.values.iter().all(is_number);
    let kind = Type { scalar: if numbers { Scalar::RealOrPercent } else { Scalar::Text }, shape };
    (kind, serialised(kind, &written.values))
}

/// Names of scripts for what other keys say together.
fn derived(config: &mut Config, values: &Values) {
    let temperatures = Type { scalar: Scalar::Integer, shape: Shape::Each };
    let temperature = Type { scalar: Scalar::Integer, shape: Shape::One };
    let plate = rules::plate(values);
    let bed = values.all(plate);
    let first_bed = values.all(&format!("{plate}_initial_layer"));
    let copies = [
        ("temperature", "nozzle_temperature"),
        ("first_layer_temperature", "nozzle_temperature_initial_layer"),
        ("retract_length", "retraction_length"),
        ("first_layer_height", "initial_layer_print_height"),
        ("max_print_height", "printable_height"),
        // Bambu Studio's and QIDI Studio's scripts call it so.
        ("chamber_temperatures", "chamber_temperature"),
    ];
    for (name, of) in copies {
        if let Some(raw) = config.raw.get(of).cloned() {
            config.raw.insert(name.to_owned(), raw);
        }
    }
    config.set_raw("bed_temperature", &bed.join(","), Some(temperatures));
    config.set_raw("bed_temperature_initial_layer", &first_bed.join(","), Some(temperatures));
    config.set_raw("first_layer_bed_temperature", &first_bed.join(","), Some(temperatures));
    let first = first_bed.first().map_or("0", String::as_str);
    config.set_raw("bed_temperature_initial_layer_single", first, Some(temperature));
    let chamber = values.all("chamber_temperature");
    let hottest = chamber.iter().filter_map(|value| value.parse::<i64>().ok()).max().unwrap_or(0);
    config.set_raw("overall_chamber_temperature", &hottest.to_string(), Some(temperature));
    bambu(config, values);
    let word = Type { scalar: Scalar::Choice, shape: Shape::One };
    config.set_raw("curr_bed_type", rules::plate_name(plate), Some(word));
}

/// Names that Bambu Studio's scripts have for what its keys say of each filament, and of all.
fn bambu(config: &mut Config, values: &Values) {
    let filaments = values.all("filament_type").len().max(1);
    let number = |name: &str, index: usize| {
        let all = values.all(name);
        all.get(index).or(all.first()).and_then(|value| value.parse::<f64>().ok()).unwrap_or(0.0)
    };
    // Where nothing is said of flushing, it is done as hot and as fast as the filament allows.
    let or = |name: &str, other: &str, index: usize| match number(name, index) {
        0.0 => number(other, index),
        own => own,
    };
    let of_each = |value: &dyn Fn(usize) -> f64| {
        (0..filaments).map(|index| value(index).to_string()).collect::<Vec<_>>().join(",")
    };
    let list = |scalar| Some(Type { scalar, shape: Shape::Each });
    let one = |scalar| Some(Type { scalar, shape: Shape::One });
    let speeds = of_each(&|i| or("filament_flush_volumetric_speed", "filament_max_volumetric_speed", i));
    config.set_raw("flush_volumetric_speeds", &speeds, list(Scalar::Real));
    let temperatures = of_each(&|i| or("filament_flush_temp", "nozzle_temperature_range_high", i));
    config.set_raw("flush_temperatures", &temperatures, list(Scalar::Integer));
    let fans = of_each(&|i| (number("during_print_exhaust_fan_speed", i) / 100.0 * 255.0).trunc());
    config.set_raw("during_print_exhaust_fan_speed_num", &fans, list(Scalar::Integer));
    let softest =
        (0..filaments).map(|i| number("temperature_vitrification", i)).fold(f64::INFINITY, f64::min);
    config.set_raw("min_vitrification_temperature", &softest.to_string(), one(Scalar::Integer));
    let hardest_blown = (0..filaments).map(|i| number("additional_cooling_fan_speed", i)).fold(0.0, f64::max);
    config.set_raw("max_additional_fan", &hardest_blown.to_string(), one(Scalar::Real));
    let vendors = values.all("filament_vendor");
    let is_own = !vendors.is_empty() && vendors.iter().all(|vendor| vendor == "Bambu Lab");
    config.set_raw("is_all_bbl_filament", if is_own { "1" } else { "0" }, one(Scalar::Flag));
}
