//! Widths of lines, and other lengths that are shares of the nozzle.

use std::f64::consts::FRAC_PI_4;

use crate::presets::config::Config;

/// Widths of automatic lines, as shares of the nozzle: walls that are seen, and others.
const AUTOMATIC: [f64; 2] = [1.05, 1.125];

/// Lengths of the print that may be percentages of the nozzle.
const OF_NOZZLE: [&str; 5] = [
    "first_layer_height",
    "fuzzy_skin_thickness",
    "fuzzy_skin_point_dist",
    "support_material_contact_distance",
    "support_material_bottom_contact_distance",
];

/// Lines with a width and a spacing, and whether they are seen.
const LINES: [(&str, bool); 5] = [
    ("perimeter_", false),
    ("external_perimeter_", true),
    ("infill_", false),
    ("solid_infill_", false),
    ("top_infill_", true),
];

/// All in millimetres.
pub(super) fn translate(config: &mut Config) {
    let Some(nozzle_mm) = config.number("nozzle_diameter") else { return };
    for key in OF_NOZZLE {
        config.say(key, config.number_of(key, Some(nozzle_mm)), key);
    }
    let height_mm = config.number("layer_height").unwrap_or(0.0);
    let first_height_mm = config.number("first_layer_height").unwrap_or(height_mm);
    let common = stated(config, "", nozzle_mm, height_mm);
    for (line, is_seen) in LINES {
        let automatic_mm = AUTOMATIC[usize::from(!is_seen)] * nozzle_mm;
        let width_mm = stated(config, line, nozzle_mm, height_mm).or(common).unwrap_or(automatic_mm);
        say(config, line, width_mm);
    }
    let first_mm = stated(config, "first_layer_", nozzle_mm, first_height_mm).or(common);
    say(config, "first_layer_", first_mm.unwrap_or(AUTOMATIC[1] * nozzle_mm));
    say(config, "", common.unwrap_or(0.0));
    let support = "support_material_extrusion_width";
    config.say(support, config.number_of(support, Some(nozzle_mm)), support);
}

fn say(config: &mut Config, line: &str, width_mm: f64) {
    let (width, spacing) = (format!("{line}extrusion_width"), format!("{line}extrusion_spacing"));
    let said = [&width, &spacing].map(|key| config.place(key));
    // By what a preset says, if either does.
    let [by_width, by_spacing] = said.map(|place| place.is_some_and(|place| !place.is_built_in()));
    let from = if by_spacing && (!by_width || config.text(&width).is_none()) { &spacing } else { &width };
    config.say(&width, Some(width_mm), from);
    config.forget(&spacing);
}

/// The width of a line that is not automatic: its own, or what its spacing comes to. What a preset says is before what is built in.
///
/// Lines are rectangles with round ends, so those at a spacing overlap by these ends.
fn stated(config: &Config, line: &str, nozzle_mm: f64, height_mm: f64) -> Option<f64> {
    let value = |key: &str, is_built_in: bool, more_mm: f64| {
        let place = config.place(key)?;
        config.text(key).filter(|_| place.is_built_in() == is_built_in)?;
        let mm = config.number_of(key, Some(nozzle_mm))?;
        Some(if mm > 0.0 { mm + more_mm } else { 0.0 })
    };
    let (width, spacing) = (format!("{line}extrusion_width"), format!("{line}extrusion_spacing"));
    let ends_mm = height_mm * (1.0 - FRAC_PI_4);
    let said = value(&width, false, 0.0).or_else(|| value(&spacing, false, ends_mm));
    let built_in = || {
        let width = value(&width, true, 0.0).filter(|mm| *mm > 0.0);
        width.or_else(|| value(&spacing, true, ends_mm))
    };
    said.or_else(built_in).filter(|mm| *mm > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets::config::{Dialect, Place};

    #[test]
    fn a_spacing_is_a_width_less_the_overlap_of_round_ends() {
        let mut config = Config::default();
        let at = |line| Place::new("x.ini", line, "");
        for (key, value, place) in [
            ("nozzle_diameter", "0.4", at(1)),
            ("layer_height", "0.2", at(2)),
            ("perimeter_extrusion_spacing", "105%", at(3)),
            ("perimeter_extrusion_width", "", at(4)),
            ("infill_extrusion_width", "120%", at(5)),
            ("infill_extrusion_spacing", "100%", Place::built_in(Dialect::Super)),
            ("first_layer_height", "75%", at(6)),
            ("external_perimeter_extrusion_width", "0", at(7)),
        ] {
            config.set(key, value, place);
        }
        translate(&mut config);
        let mm = |key: &str| config.number(key).unwrap();
        assert!((mm("perimeter_extrusion_width") - (0.42 + 0.2 * (1.0 - FRAC_PI_4))).abs() < 1e-6);
        assert_eq!(config.entries["perimeter_extrusion_width"].place.line, 3);
        assert_eq!(mm("infill_extrusion_width"), 0.48, "what is built in is not asked where a preset speaks");
        assert_eq!(mm("first_layer_height"), 0.3);
        assert_eq!(mm("external_perimeter_extrusion_width"), 0.42, "automatic");
    }
}
