//! What the start and end scripts add to a print.

use super::read::{Measure, measure_on, replay, resume, time_on};
use super::script::Scripts;
use super::settings::GcodeOptions;
use crate::estimate::Machine;
use crate::units::Seconds;

/// The sums of a script's moves, measured as on the finished file.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Lengths, counts and volume.
    pub measure: Measure,
    /// Time of its moves; heating and homing take none.
    pub time: Seconds,
    /// Position of the nozzle afterwards, millimetres; `None` where nothing has been extruded, as the path from here
    /// does not count then.
    pub end: Option<[f64; 3]>,
}

impl Scripts {
    /// The start script: heating, homing, priming.
    pub fn start_effect(&self, settings: &GcodeOptions) -> Effect {
        let text = [self.start.as_bytes(), self.filament_start.as_bytes()].concat();
        let mut steps = replay(&text);
        let measure = measure_on(&mut steps, settings.filament.diameter, None);
        let end = (measure.print_mm > 0.0).then(|| steps.position());
        Effect { measure, time: time_on(replay(&text), &settings.machine), end }
    }

    /// The end script, begun where the last bead ended.
    pub fn end_effect(&self, settings: &GcodeOptions, bead_end: [f64; 3]) -> Effect {
        let steps = || resume(self.end.as_bytes(), bead_end, settings.gcode.relative_e);
        let mut measured = steps();
        let measure = measure_on(&mut measured, settings.filament.diameter, Some(bead_end));
        Effect { measure, time: time_on(steps(), &settings.machine), end: Some(measured.position()) }
    }
}

/// How long the moves of a script take that is run at a change of tool.
pub(crate) fn script_time(script: &str, at_mm: [f64; 3], relative_e: bool, machine: &Machine) -> Seconds {
    // The change itself is counted where it is planned.
    let machine = Machine { change_s: 0.0, change_is_fixed: true, ..*machine };
    time_on(resume(script.as_bytes(), at_mm, relative_e), &machine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::PrintFacts;
    use crate::profile::Settings;

    fn effects(start: &str, end: &str) -> (Effect, Effect) {
        let facts = PrintFacts { layers: 1, max_mm: [9.0; 2], max_z_mm: 0.2, ..PrintFacts::default() };
        let mut settings = Settings::default();
        (settings.gcode.start, settings.gcode.end) = (start.into(), end.into());
        let scripts = Scripts::new(&settings, &facts).expect("no mistakes");
        (
            scripts.start_effect(&GcodeOptions::from(&settings)),
            scripts.end_effect(&GcodeOptions::from(&settings), [10.0, 10.0, 0.2]),
        )
    }

    #[test]
    fn a_prime_line_counts_and_the_travel_to_it_does_not() {
        let (start, _) = effects("G28\nM83\nG0 X10 Y5 Z0.2 F6000\nG1 X60 E5", "");
        assert_eq!((start.measure.print_mm, start.measure.travel_mm), (50.0, 0.0));
        assert_eq!(start.end, Some([60.0, 5.0, 0.2]));
        assert!(start.time.0 > 0.5 && start.measure.volume_mm3 > 10.0, "{start:?}");
    }

    #[test]
    fn a_script_that_extrudes_nothing_does_not_say_where_the_print_begins() {
        let (start, _) = effects("G28\nG0 X10 Y5 F6000", "");
        assert_eq!((start.end, start.measure.travel_mm), (None, 0.0));
    }

    #[test]
    fn parking_is_travel_from_the_last_bead_and_no_link() {
        let (_, end) = effects("", "G1 E-2 F2400\nG0 X10 Y110 F6000");
        assert_eq!((end.measure.travel_mm, end.measure.link_mm), (100.0, 0.0));
        assert_eq!((end.measure.travels, end.measure.retractions), (0, 1));
    }
}
