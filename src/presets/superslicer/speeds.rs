//! Speeds and accelerations, each of which may be a percentage of another.

use super::written;
use crate::presets::config::Config;

/// Speeds and what their percentages are of, which comes before.
const SPEEDS: [(&str, &str); 15] = [
    ("default_speed", "machine_max_feedrate_x"),
    ("max_print_speed", "machine_max_feedrate_x"),
    ("perimeter_speed", "default_speed"),
    ("external_perimeter_speed", "perimeter_speed"),
    ("small_perimeter_speed", "perimeter_speed"),
    ("gap_fill_speed", "perimeter_speed"),
    ("solid_infill_speed", "default_speed"),
    ("infill_speed", "solid_infill_speed"),
    ("top_solid_infill_speed", "solid_infill_speed"),
    ("ironing_speed", "top_solid_infill_speed"),
    ("bridge_speed", "default_speed"),
    ("overhangs_speed", "bridge_speed"),
    ("support_material_speed", "default_speed"),
    ("support_material_interface_speed", "support_material_speed"),
    ("brim_speed", "support_material_speed"),
];

/// Accelerations and what their percentages are of, which they are where they are 0.
const ACCELERATIONS: [(&str, &str); 8] = [
    ("default_acceleration", "machine_max_acceleration_x"),
    ("perimeter_acceleration", "default_acceleration"),
    ("external_perimeter_acceleration", "perimeter_acceleration"),
    ("solid_infill_acceleration", "default_acceleration"),
    ("infill_acceleration", "solid_infill_acceleration"),
    ("top_solid_infill_acceleration", "solid_infill_acceleration"),
    ("bridge_acceleration", "default_acceleration"),
    ("travel_acceleration", "default_acceleration"),
];

/// All in mm/s and mm/s².
pub(super) fn translate(config: &mut Config) {
    for (key, of) in SPEEDS {
        config.say(key, config.number_of(key, config.number(of)), key);
    }
    // Automatic speeds stay 0.
    if let Some(most) = config.number("filament_max_speed").filter(|most| *most > 0.0) {
        for (key, _) in SPEEDS {
            config.say(key, config.number(key).map(|speed| speed.min(most)), key);
        }
        config.forget("filament_max_speed");
    }
    for (key, of) in ACCELERATIONS {
        let whole = config.number(of);
        let own = config.number_of(key, whole);
        let is_default = key == "default_acceleration";
        match own {
            Some(0.0) if !is_default => config.say(key, whole, of),
            own => config.say(key, own, key),
        }
    }
    // What is built in for travel is more than some machines can.
    let (travel, most) = (config.number("travel_acceleration"), config.number("machine_max_acceleration_x"));
    let is_built_in = config.place("travel_acceleration").is_some_and(|place| place.is_built_in());
    if let (true, Some(travel), Some(most)) = (is_built_in, travel, most) {
        config.say("travel_acceleration", Some(travel.min(most)), "travel_acceleration");
    }
    first_layer(config);
    overhangs(config);
    config.forget("default_speed");
}

/// There is a least speed of the first layer.
fn first_layer(config: &mut Config) {
    let Some(least) = config.number("first_layer_min_speed").filter(|least| *least > 0.0) else { return };
    let speed = config.number_of("first_layer_speed", config.number("perimeter_speed"));
    if speed.is_some_and(|speed| speed < least) {
        config.say("first_layer_speed", Some(least), "first_layer_min_speed");
    }
    config.forget("first_layer_min_speed");
}

/// Walls are slow where more of them than a share of the nozzle hangs over; PrusaSlicer has steps of a quarter.
fn overhangs(config: &mut Config) {
    let nozzle_mm = config.number("nozzle_diameter");
    let Some(place) = config.place("overhangs_width_speed") else { return };
    let from_mm = config.number_of("overhangs_width_speed", nozzle_mm);
    let width_mm = config.number("external_perimeter_extrusion_width");
    let (Some(from_mm), Some(width_mm), Some(speed)) = (from_mm, width_mm, config.number("overhangs_speed"))
    else {
        return;
    };
    let is_on = from_mm > 0.0 && speed > 0.0;
    config.say_at("enable_dynamic_overhang_speeds", if is_on { "1" } else { "0" }, place.clone());
    config.say_at("overhangs", if from_mm > 0.0 { "1" } else { "0" }, place.clone());
    for (step, held) in [0.0, 0.25, 0.5, 0.75].into_iter().enumerate() {
        let hangs = (1.0 - held) * width_mm >= from_mm;
        // 0 is the speed of outermost walls.
        let speed = if is_on && hangs { speed } else { 0.0 };
        config.say_at(&format!("overhang_speed_{step}"), &written(speed), place.clone());
    }
    for key in ["overhangs_width_speed", "overhangs_speed", "overhangs_width"] {
        config.forget(key);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::config::Place;

    fn translated(lines: &[(&str, &str)]) -> Config {
        let mut config = Config::default();
        for (key, value) in lines {
            config.set(key, value, Place::new("x.ini", 1, ""));
        }
        translate(&mut config);
        config
    }

    #[test]
    fn percentages_are_of_other_percentages() {
        let config = translated(&[
            ("default_speed", "50%"),
            ("machine_max_feedrate_x", "200,100"),
            ("solid_infill_speed", "30%"),
            ("infill_speed", "300%"),
            ("ironing_speed", "0"),
            ("filament_max_speed", "80"),
            ("default_acceleration", "1000"),
            ("solid_infill_acceleration", "0"),
            ("infill_acceleration", "50%"),
        ]);
        let number = |key: &str| config.number(key);
        assert_eq!(number("solid_infill_speed"), Some(30.0));
        assert_eq!(number("infill_speed"), Some(80.0), "90, but for the filament");
        assert_eq!(number("ironing_speed"), Some(0.0), "automatic");
        assert_eq!(number("solid_infill_acceleration"), Some(1000.0));
        assert_eq!(number("infill_acceleration"), Some(500.0));
    }

    #[test]
    fn walls_are_slow_from_the_share_of_the_nozzle_that_hangs_over() {
        let steps = |width: &str| {
            let config = translated(&[
                ("nozzle_diameter", "0.4"),
                ("external_perimeter_extrusion_width", "0.4"),
                ("bridge_speed", "40"),
                ("overhangs_speed", "50%"),
                ("overhangs_width_speed", width),
            ]);
            let step = |step| config.number(&format!("overhang_speed_{step}")).unwrap();
            ([0, 1, 2, 3].map(step), config.flag("enable_dynamic_overhang_speeds"))
        };
        assert_eq!(steps("55%"), ([20.0, 20.0, 0.0, 0.0], Some(true)));
        assert_eq!(steps("0"), ([0.0; 4], Some(false)));
    }
}
