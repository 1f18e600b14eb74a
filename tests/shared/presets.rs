//! Presets of other slicers' vendors.

use pathwright::profile::{import_figures, resolve};

use crate::listed;

/// Of the keys that the vendors' presets set, at most a tenth has neither a counterpart nor no meaning here, and each of
/// those is told with a reason.
pub fn most_keys_of_presets_are_taken_over() {
    let figures = import_figures(&listed("presets/vendor", "ini")).expect("bundles");
    let all = figures.taken.len() + figures.meaningless.len() + figures.missing.len();
    assert!(all > 300 && 10 * figures.missing.len() <= all, "{figures}");
    let vague: Vec<&String> = figures
        .missing
        .iter()
        .filter(|(_, why)| why == "there is no such setting")
        .map(|(key, _)| key)
        .collect();
    assert!(vague.is_empty(), "{vague:?}");
}

/// The whole configurations of nearly a hundred printers resolve, each with its bed and the limits that it states.
pub fn configurations_of_printers_resolve() {
    let mut refused = Vec::new();
    for path in listed("presets/expected", "gcode") {
        let path = path.to_str().expect("UTF-8").to_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let value = |key: &str| text.lines().find_map(|line| line.strip_prefix(&format!("; {key} = ")));
        // Scripts are checked elsewhere.
        match resolve(&[path.clone()], &[]) {
            Ok(resolved) => {
                let bed = &resolved.settings.bed;
                let low = value("bed_shape").and_then(|shape| shape.split(',').next()?.split_once('x'));
                let low = low.map(|(x, y)| [x, y].map(|v| v.parse::<f64>().expect("a number")));
                let is_there = bed.shape.name() == "round" || low == Some(bed.low_mm());
                assert!(is_there, "{path}: {:?}", bed.low_mm());
                let dialect = value("gcode_flavor").is_some_and(|flavor| flavor.starts_with("marlin"));
                let states = value("machine_limits_usage") == Some("emit_to_gcode") && dialect;
                assert_eq!(resolved.settings.gcode.limits, states, "{path}");
            }
            Err(error) => refused.push(format!("{path}: {error}")),
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}
