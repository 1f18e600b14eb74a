//! Scripts of a print: whether they heat by themselves.

use super::flavor::dialect;
use super::options::{Flavor, GcodeSettings};

/// The scripts of a print, expanded, as far as they do not belong to a layer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scripts {
    pub(super) start: String,
    pub(super) filament_start: String,
    pub(super) end: String,
    pub(crate) pause: String,
    pub(crate) color_change: String,
    /// Filament that the start scripts say they leave pulled back, of each extruder, millimetres.
    pub(crate) retracted_mm: Vec<f64>,
    /// Which heaters the start script switches.
    pub(super) starts: Heaters,
    /// Which heaters the end script switches.
    pub(super) ends: Heaters,
}

/// Which heaters a script switches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Heaters {
    pub nozzle: bool,
    pub bed: bool,
    pub chamber: bool,
    /// A macro is taken to, whose name says so.
    pub by_name: bool,
}

impl Scripts {
    /// Scripts that are run before the last layer, expanded: start, filament, pause and color change; `options` has them
    /// as they are written.
    pub(crate) fn opening(
        [start, filament_start, pause, color_change]: [String; 4],
        options: &GcodeSettings,
        flavor: Flavor,
        retracted_mm: Vec<f64>,
    ) -> Self {
        let starts = heaters(&options.start, &start, flavor);
        Self { start, filament_start, pause, color_change, retracted_mm, starts, ..Self::default() }
    }

    /// Whether the start script heats by a macro that may not be given the temperatures.
    pub(crate) fn heat_by_name(&self) -> bool {
        self.starts.by_name
    }

    /// Adds the scripts of the end, expanded: of the filament and of the print.
    pub(crate) fn close(
        &mut self,
        [filament_end, end]: [String; 2],
        options: &GcodeSettings,
        flavor: Flavor,
    ) {
        self.ends = heaters(&options.end, &end, flavor);
        self.end = filament_end + &end;
    }
}

/// Whether a script states linear or pressure advance, in any dialect.
pub(crate) fn sets_pressure_advance(script: &str) -> bool {
    script
        .lines()
        .map(command)
        .any(|(_, name)| ["M900", "M572", "SET_PRESSURE_ADVANCE"].contains(&name.as_str()))
}

/// Finds out which heaters a script switches: by commands, once it is expanded, or by macros of Klipper, as it is written.
/// A macro is taken to switch both where its name says that it begins or ends a print, and those whose temperature
/// it is given.
fn heaters(written: &str, expanded: &str, flavor: Flavor) -> Heaters {
    let mut found = Heaters::default();
    for line in expanded.lines() {
        match command(line).1.as_str() {
            "M104" | "M109" | "M568" => found.nozzle = true,
            "M140" | "M190" => found.bed = true,
            "M141" | "M191" => found.chamber = true,
            _ => {}
        }
    }
    let macros = written.lines().map(command).filter(|(_, name)| is_macro(name));
    for (code, name) in macros.filter(|_| dialect(flavor).has_macros()) {
        let whole = ["START_PRINT", "PRINT_START", "END_PRINT", "PRINT_END"].contains(&name.as_str());
        let extended = name.starts_with("SET_HEATER_TEMPERATURE") || name == "TURN_OFF_HEATERS";
        let [nozzle, bed, chamber] = placeholders_of_temperatures(code);
        let all = name == "TURN_OFF_HEATERS";
        let of_chamber = extended && code.contains("chamber");
        let extended = extended && !of_chamber;
        found.by_name |= whole;
        found.nozzle |= whole || nozzle || (extended && !code.contains("heater_bed"));
        found.bed |= whole || bed || (extended && !code.contains("extruder"));
        found.chamber |= whole || chamber || of_chamber || all;
    }
    found
}

/// Whether a line of a script takes a tool.
pub(crate) fn takes_tool(script: &str, tool: usize) -> bool {
    let taken = format!("T{tool}");
    script.lines().any(|line| line.split([' ', ';']).next() == Some(taken.as_str()))
}

/// Whether a script turns the heater of a tool off, by its number.
pub(super) fn turns_off(script: &str, tool: usize) -> bool {
    let wanted = ["S0".to_owned(), format!("T{tool}")];
    script.lines().any(|line| {
        let mut words = line.split(';').next().unwrap_or_default().split_whitespace();
        words.next() == Some("M104") && {
            let words: Vec<&str> = words.collect();
            wanted.iter().all(|wanted| words.contains(&wanted.as_str()))
        }
    })
}

/// A line without its comment, and the command in it, in capitals.
fn command(line: &str) -> (&str, String) {
    let code = line.split(';').next().unwrap_or_default().trim();
    (code, code.split_whitespace().next().unwrap_or_default().to_ascii_uppercase())
}

/// Whether a line uses the temperature of the nozzle, of the bed, or of the chamber.
fn placeholders_of_temperatures(code: &str) -> [bool; 3] {
    let names = code.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let temperatures = names.filter(|name| name.contains("_temp") || *name == "temperature");
    temperatures.fold([false; 3], |[nozzle, bed, chamber], name| {
        let of_chamber = name.contains("chamber");
        let of_bed = name.contains("bed_") || name.contains("plate_temp");
        [nozzle || !(of_bed || of_chamber), bed || of_bed, chamber || of_chamber]
    })
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
        let facts = PrintFacts { layers: 3, max_mm: [30.0, 40.5], max_z_mm: 0.6, ..PrintFacts::default() };
        let mut settings = Settings::default();
        settings.gcode.start = "M109 S{nozzle_temp}\r\nG1 X{print_max_x} ; {{x}}".into();
        let scripts = Scripts::new(&settings, &facts).expect("no mistakes");
        assert_eq!(scripts.start, "M109 S210\nG1 X30 ; {x}\n");
        settings.gcode.end = "{nozle_temp}".into();
        let mistakes = Scripts::new(&settings, &facts).expect_err("a mistake");
        assert!(mistakes[0].starts_with("gcode.end: line 1, column 2: unknown name"), "{mistakes:?}");
    }

    #[test]
    fn a_script_that_heats_is_recognised() {
        let heats = |script, flavor| heaters(script, script, flavor);
        let both = Heaters { nozzle: true, bed: true, ..Heaters::default() };
        assert_eq!(heats("G28\n;M104 S200\n", Flavor::Marlin), Heaters::default());
        assert_eq!(heats("m104 S200\nM190 S60", Flavor::Marlin), both);
        let all = Heaters { chamber: true, ..both };
        assert_eq!(heats("START_PRINT BED={bed_temp}", Flavor::Klipper), Heaters { by_name: true, ..all });
        assert_eq!(
            heats("WARM T={nozzle_temp}", Flavor::Klipper),
            Heaters { nozzle: true, ..Heaters::default() }
        );
        assert_eq!(heats("START_PRINT", Flavor::Marlin), Heaters::default());
        assert_eq!(heats("TURN_OFF_HEATERS", Flavor::Klipper), all);
        assert!(!heats("SOAK TO={chamber_temperature[0]}", Flavor::Klipper).nozzle);
        assert_eq!(heats("M191 S40", Flavor::Marlin), Heaters { chamber: true, ..Heaters::default() });
    }
}
