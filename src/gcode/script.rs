//! Start, end and pause scripts: their placeholders, and whether they heat by themselves.

use super::flavor::dialect;
use super::options::{Flavor, GcodeSettings};

/// The scripts of a print, filled in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scripts {
    pub(super) start: String,
    pub(super) end: String,
    pub(crate) pause: String,
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
    /// Start, end and pause scripts, filled in; `options` has them as they are written.
    pub(crate) fn filled_in(
        [start, end, pause]: [String; 3],
        options: &GcodeSettings,
        flavor: Flavor,
    ) -> Self {
        let (starts, ends) = (heaters(&options.start, flavor), heaters(&options.end, flavor));
        Self { start, end, pause, starts, ends }
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
    use crate::gcode::PrintFacts;
    use crate::profile::Settings;

    #[test]
    fn scripts_are_filled_in_and_their_line_ends_made_alike() {
        let facts =
            PrintFacts { layers: 3, min_mm: [10.0, 20.0], max_mm: [30.0, 40.5], max_z_mm: 0.6, dated: 0 };
        let mut settings = Settings::default();
        settings.gcode.start = "M109 S{nozzle_temp}\r\nG1 X{print_max_x} ; {{x}}".into();
        let scripts = Scripts::new(&settings, &facts).expect("no mistakes");
        assert_eq!(scripts.start, "M109 S210\nG1 X30 ; {x}\n");
        settings.gcode.end = "{nozle_temp}".into();
        let mistakes = Scripts::new(&settings, &facts).expect_err("a mistake");
        assert!(mistakes[0].starts_with("gcode.end: line 1: unknown placeholder"), "{mistakes:?}");
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
