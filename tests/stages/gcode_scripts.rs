//! Start and end scripts in use.

use crate::support::gcode_fixture::{END, START, mixed, print};
use pathwright::gcode::{Action, measure, replay};
use pathwright::profile::{Flavor, Settings};
use pathwright::units::Mm;

fn settings() -> Settings {
    let mut settings = Settings::default();
    (settings.gcode.start, settings.gcode.end) = (START.into(), END.into());
    settings
}

#[test]
fn the_prime_line_is_drawn_hot_and_inside_the_bed() {
    let text = print(&mixed(2), &settings(), &[]);
    let primed = measure(text.as_bytes(), Mm(1.75));
    let custom = primed.by_type.iter().find(|t| t.name == "Custom").expect("a prime line");
    assert!((custom.print_mm - 200.0).abs() < 1e-6, "{custom:?}");
    assert!(text.find("M109 S210").expect("heats") < text.find("G1 X110 E10").expect("primes"));
}

#[test]
fn the_end_lifts_before_it_moves_away_and_then_switches_off() {
    let text = print(&mixed(2), &settings(), &[]);
    let end = &text[text.rfind(";TYPE:Custom").expect("an end")..];
    let order = ["G1 E-1", "G1 Z50", "G1 X0 Y250", "M104 S0", "M84"].map(|l| end.find(l).expect(l));
    assert!(order.is_sorted(), "{end}");
    let last_bead = replay(text.as_bytes())
        .filter_map(|s| match s.action {
            Action::Stroke(s) if s.xy_mm > 0.0 => Some(s),
            _ => None,
        })
        .last()
        .expect("moves");
    assert!((last_bead.from[2] - 50.0).abs() < 1e-9, "dragged at {}", last_bead.from[2]);
}

#[test]
fn a_klipper_macro_that_is_told_the_temperatures_heats_alone() {
    let mut settings = settings();
    settings.printer.flavor = Flavor::Klipper;
    settings.gcode.start = "START_PRINT BED_TEMP={bed_temp} EXTRUDER_TEMP={nozzle_temp}".into();
    settings.gcode.end = "END_PRINT".into();
    let text = print(&mixed(1), &settings, &[]);
    assert!(text.contains("START_PRINT BED_TEMP=60 EXTRUDER_TEMP=210\n"));
    assert!(!text.contains("M109") && !text.contains("M190"));
    assert!(text.contains("END_PRINT\n\n; estimated"), "the macro switches the heaters off");
}
