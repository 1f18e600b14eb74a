//! Fans and temperatures.

use super::written;
use crate::presets::config::Config;

/// In PrusaSlicer's words.
pub(super) fn translate(config: &mut Config) {
    // Presets of older versions say it as PrusaSlicer's do.
    let is_old = config.entries.contains_key("min_fan_speed") || config.entries.contains_key("fan_always_on");
    if let (false, Some(place)) = (is_old, config.place("default_fan_speed")) {
        let usual = config.number("default_fan_speed").unwrap_or(0.0).max(0.0);
        config.say_at("fan_always_on", if usual > 0.0 { "1" } else { "0" }, place.clone());
        config.say_at("min_fan_speed", &written(usual), place.clone());
        config.say_at("cooling", "1", place);
    }
    config.forget("default_fan_speed");
    let usual = match config.flag("fan_always_on") {
        Some(true) => config.number("min_fan_speed").unwrap_or(0.0),
        _ => 0.0,
    };
    if config.number("bridge_fan_speed").is_some_and(|speed| speed < 0.0) {
        config.say("bridge_fan_speed", Some(usual), "bridge_fan_speed");
    }
    if let Some(place) = config.place("overhangs_fan_speed") {
        // 1 switches it off there, and -1 is the usual one.
        let own = config.number("overhangs_fan_speed").filter(|speed| *speed > 1.0);
        config.say_at("enable_dynamic_fan_speeds", if own.is_some() { "1" } else { "0" }, place.clone());
        for step in 0..4 {
            let speed = own.filter(|_| step == 0).unwrap_or(0.0);
            config.say_at(&format!("overhang_fan_speed_{step}"), &written(speed), place.clone());
        }
        config.forget("overhangs_fan_speed");
    }
    warmer(config);
}

/// Adds what each hot end needs more than its filament says.
fn warmer(config: &mut Config) {
    let Some(more) = config.numbers_of_extruders("extruder_temperature_offset") else { return };
    let of = |extruder: usize| more.get(extruder).or(more.first()).copied().unwrap_or(0.0);
    for key in ["temperature", "first_layer_temperature"] {
        config.say_each(key, |extruder, own| if own > 0.0 { own + of(extruder) } else { own });
    }
    config.forget("extruder_temperature_offset");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::config::Place;

    #[test]
    fn a_hot_end_that_needs_more_than_its_filament_says_gets_it() {
        let mut config = Config::default();
        for (key, value) in [
            ("temperature", "210,220"),
            ("extruder_temperature_offset", "0,5"),
            ("default_fan_speed", "30"),
            ("overhangs_fan_speed", "-1"),
            ("bridge_fan_speed", "-1"),
        ] {
            config.set_known(
                key,
                value,
                super::super::find_key(key).map(|key| key.kind),
                Place::new("x.ini", 1, ""),
            );
        }
        translate(&mut config);
        assert_eq!(config.lists["temperature"].1, "210,225");
        assert_eq!(config.flag("fan_always_on"), Some(true));
        assert_eq!(config.number("min_fan_speed"), Some(30.0));
        assert_eq!(config.number("bridge_fan_speed"), Some(30.0));
    }
}
