//! Presets of other slicers' vendors.

use pathwright::gcode::{GcodeOptions, PrintFacts, Scripts, header};
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
        match resolve(std::slice::from_ref(&path), &[]) {
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
            Err(error) if error.to_string().lines().all(|line| line.contains(": gcode.")) => {}
            Err(error) => refused.push(format!("{path}: {error}")),
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

/// A command with its words, each a letter and a number.
fn command(line: &str) -> (String, Vec<(char, f64)>) {
    let code = line.split(';').next().unwrap_or_default();
    let mut words = code.split_whitespace();
    let name = words.next().unwrap_or_default().to_owned();
    let word = |word: &str| Some((word.chars().next()?, word.get(1..)?.parse().ok()?));
    (name, words.filter_map(word).collect())
}

/// Limits are stated as PrusaSlicer states them: the same commands in the same order with the same numbers.
pub fn limits_are_stated_as_their_slicer_states_them() {
    let mut compared = 0;
    for path in listed("presets/expected", "gcode") {
        let path = path.to_str().expect("UTF-8").to_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let wanted: Vec<_> = text.lines().filter(|line| line.contains(" ; sets ")).map(command).collect();
        let Ok(resolved) = resolve(std::slice::from_ref(&path), &[]) else { continue };
        let options = GcodeOptions::from(&resolved.settings);
        let written = header(&options, &PrintFacts::default(), &Scripts::default(), false).bytes;
        let written = String::from_utf8(written).expect("a text");
        let before_scripts = written.split(";TYPE:Custom").next().unwrap_or_default();
        let is_limit = |line: &&str| line.starts_with("M20") || line.starts_with("M566");
        let found: Vec<_> = before_scripts.lines().filter(is_limit).map(command).collect();
        assert_eq!(found, wanted, "{path}");
        compared += usize::from(!wanted.is_empty());
    }
    assert!(compared > 50, "{compared}");
}
