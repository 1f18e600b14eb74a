//! Start, end and pause scripts: their placeholders, and whether they heat by themselves.

use super::flavor::dialect;
use super::settings::PrintFacts;
use super::values::Values;
use crate::profile::{Flavor, Settings};

/// A mistake in a script.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScriptError {
    /// A name in braces that means nothing.
    #[error("{script}, line {line}: unknown placeholder `{{{name}}}`; known are {known}")]
    Unknown {
        /// Setting that holds the script.
        script: &'static str,
        /// Line, from 1.
        line: usize,
        /// What stands between the braces.
        name: String,
        /// Every name there is.
        known: String,
    },
    /// An opening brace without its closing one.
    #[error("{script}, line {line}: `{{` is not closed on its line; write `{{{{` for a plain brace")]
    Unclosed {
        /// Setting that holds the script.
        script: &'static str,
        /// Line, from 1.
        line: usize,
    },
}

/// Fills in `{name}` in every line; `{{` and `}}` are plain braces. Line ends become `\n`, one at the end of
/// each line.
///
/// # Errors
/// Every mistake in the script.
pub fn expand(script: &'static str, text: &str, values: &Values) -> Result<String, Vec<ScriptError>> {
    let mut out = String::with_capacity(text.len() + 64);
    let mut errors = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let mut rest = line.trim_end();
        while let Some(brace) = rest.find(['{', '}']) {
            let (before, from) = rest.split_at(brace);
            out.push_str(before);
            if let Some(after) = from.strip_prefix("{{") {
                out.push('{');
                rest = after;
            } else if let Some(after) = from.strip_prefix('}') {
                out.push('}');
                rest = after.strip_prefix('}').unwrap_or(after);
            } else if let Some(end) = from.find('}') {
                let name = from[1..end].trim();
                match values.get(name) {
                    Some(value) => out.push_str(value),
                    None => errors.push(ScriptError::Unknown {
                        script,
                        line: at + 1,
                        name: name.to_owned(),
                        known: values.names().collect::<Vec<_>>().join(", "),
                    }),
                }
                rest = &from[end + 1..];
            } else {
                errors.push(ScriptError::Unclosed { script, line: at + 1 });
                rest = "";
            }
        }
        out.push_str(rest);
        out.push('\n');
    }
    if errors.is_empty() { Ok(out) } else { Err(errors) }
}

/// The scripts of a print, filled in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scripts {
    pub(super) start: String,
    pub(super) end: String,
    pub(super) pause: String,
    /// Which heaters the start script sees to.
    pub(super) starts: Heaters,
    /// Which heaters the end script sees to.
    pub(super) ends: Heaters,
}

/// Which heaters a script switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Heaters {
    pub nozzle: bool,
    pub bed: bool,
}

impl Scripts {
    /// Fills in the scripts of the settings. Do it before slicing: mistakes show early.
    ///
    /// # Errors
    /// Every mistake in all three scripts.
    pub fn new(settings: &Settings, facts: &PrintFacts) -> Result<Self, Vec<ScriptError>> {
        let values = Values::new(settings, facts);
        let gcode = &settings.gcode;
        let mut errors = Vec::new();
        let mut filled = |name, text| {
            expand(name, text, &values).unwrap_or_else(|mistakes| {
                errors.extend(mistakes);
                String::new()
            })
        };
        let scripts = Self {
            start: filled("gcode.start", &gcode.start),
            end: filled("gcode.end", &gcode.end),
            pause: filled("gcode.pause", &gcode.pause),
            starts: heaters(&gcode.start, settings.printer.flavor),
            ends: heaters(&gcode.end, settings.printer.flavor),
        };
        if errors.is_empty() { Ok(scripts) } else { Err(errors) }
    }
}

/// Finds out which heaters a script (placeholders not yet filled in) switches. A Klipper macro is taken to see
/// to both where its name says that it begins or ends a print, and to those whose temperature it is given.
fn heaters(script: &str, flavor: Flavor) -> Heaters {
    let mut found = Heaters::default();
    for line in script.lines() {
        let code = line.split(';').next().unwrap_or_default().trim();
        let command = code.split_whitespace().next().unwrap_or_default().to_ascii_uppercase();
        match command.as_str() {
            "M104" | "M109" | "M568" => found.nozzle = true,
            "M140" | "M190" => found.bed = true,
            name if dialect(flavor).has_macros() && is_macro(name) => {
                let whole = ["START_PRINT", "PRINT_START", "END_PRINT", "PRINT_END"].contains(&name);
                let extended = name.starts_with("SET_HEATER_TEMPERATURE") || name == "TURN_OFF_HEATERS";
                found.nozzle |=
                    whole || code.contains("{nozzle_temp") || (extended && !code.contains("heater_bed"));
                found.bed |= whole || code.contains("{bed_temp") || (extended && !code.contains("extruder"));
            }
            _ => {}
        }
    }
    found
}

/// Whether a command is a name rather than a letter with a number.
fn is_macro(command: &str) -> bool {
    let mut bytes = command.bytes();
    bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.next().is_some_and(|b| !b.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values() -> Values {
        let facts =
            PrintFacts { layers: 3, min_mm: [10.0, 20.0], max_mm: [30.0, 40.5], max_z_mm: 0.6, dated: 0 };
        let mut settings = Settings::default();
        settings.printer.name = "evil\nM112;\rG28".into();
        Values::new(&settings, &facts)
    }

    #[test]
    fn placeholders_are_filled_in_and_doubled_braces_are_plain() {
        let text = expand("gcode.start", "M109 S{nozzle_temp}\r\nG1 X{ print_max_x } ; {{x}}", &values());
        assert_eq!(text.as_deref(), Ok("M109 S210\nG1 X30 ; {x}\n"));
    }

    #[test]
    fn every_mistake_is_reported_with_its_line() {
        let errors = expand("gcode.end", "{nozle_temp}\nG28\nG1 X{bed_size_x", &values()).unwrap_err();
        assert_eq!(errors.len(), 2);
        let first = errors[0].to_string();
        assert!(first.starts_with("gcode.end, line 1: unknown placeholder `{nozle_temp}`"), "{first}");
        assert!(first.contains("nozzle_temp, nozzle_temp_other"), "{first}");
        assert_eq!(errors[1], ScriptError::Unclosed { script: "gcode.end", line: 3 });
    }

    #[test]
    fn values_cannot_start_a_line_or_a_comment() {
        let text = expand("gcode.start", "M117 {printer}", &values()).expect("known");
        assert_eq!(text, "M117 evil M112, G28\n");
    }

    #[test]
    fn a_script_that_heats_is_recognised() {
        let heats = |script, flavor| heaters(script, flavor);
        let both = Heaters { nozzle: true, bed: true };
        assert_eq!(heats("G28\n;M104 S200\n", Flavor::Marlin), Heaters::default());
        assert_eq!(heats("m104 S200\nM190 S60", Flavor::Marlin), both);
        assert_eq!(heats("START_PRINT BED={bed_temp}", Flavor::Klipper), both);
        assert_eq!(heats("WARM T={nozzle_temp}", Flavor::Klipper), Heaters { nozzle: true, bed: false });
        assert_eq!(heats("START_PRINT", Flavor::Marlin), Heaters::default());
        assert_eq!(heats("TURN_OFF_HEATERS", Flavor::Klipper), both);
    }
}
