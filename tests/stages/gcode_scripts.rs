//! Start and end scripts in use.

use crate::support::gcode_fixture::{END, START, mixed, print};
use pathwright::gcode::{Action, measure, replay};
use pathwright::profile::{Flavor, Settings};
use pathwright::units::{Celsius, Mm};
use pathwright::{Mesh, Observer, Plate, Slicer};

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

#[test]
fn the_chamber_is_heated_before_the_start_script_where_that_leaves_it_out() {
    let mut settings = settings();
    (settings.gcode.start, settings.gcode.end) = ("G28".into(), "M84".into());
    (settings.temperature.chamber, settings.temperature.chamber_min) = (Celsius(45.0), Celsius(40.0));
    let text = print(&mixed(1), &settings, &[]);
    let heats = "M141 S45\nM140 S60\nM104 S210\nM190 S60\nM191 S40\nM109 S210\n;TYPE:Custom\nG28\n";
    assert!(text.contains(heats), "{text}");
    assert!(text.contains("M84\nM104 S0\nM140 S0\nM141 S0\n"), "{text}");
    (settings.gcode.start, settings.gcode.end) = ("M141 S30\nG28".into(), "M141 S0\nM84".into());
    let text = print(&mixed(1), &settings, &[]);
    assert!(!text.contains("M191") && text.matches("M141").count() == 2, "{text}");
    settings.temperature.chamber = Celsius(0.0);
    settings.temperature.chamber_min = Celsius(0.0);
    (settings.gcode.start, settings.gcode.end) = ("G28".into(), "M84".into());
    assert!(!print(&mixed(1), &settings, &[]).contains("M141"));
}

#[test]
fn filament_that_the_start_script_leaves_pulled_back_is_there_for_the_first_bead() {
    // What has moved into the nozzle before the first bead, and how often filament is pulled back until then.
    let before = |start: &str, length_mm: f64| {
        let mut settings = settings();
        settings.gcode.start = format!("M109 S210\nM83\n{start}");
        settings.retract.length = Mm(length_mm);
        let cube = concat!(env!("CARGO_MANIFEST_DIR"), "/models/calibration_cube.stl");
        let plate = Plate::new(&settings).add(Mesh::read(cube).expect("a cube")).expect("it fits");
        let sliced = Slicer::new(&settings).slice(&plate, &Observer::none()).expect("a print");
        let mut text = Vec::new();
        sliced.write_gcode(&mut text).expect("memory");
        let strokes = replay(&text).filter_map(|step| match step.action {
            Action::Stroke(stroke) => Some(stroke),
            _ => None,
        });
        let first: Vec<f64> =
            strokes.take_while(|s| !(s.extrudes() && s.xy_mm > 0.0)).map(|s| s.e_mm).collect();
        let pulls = first.iter().filter(|e_mm| **e_mm < -1e-9).count();
        ((first.iter().sum::<f64>() * 1e4).round() / 1e4, pulls)
    };
    assert_eq!(before("G1 E-0.8 F2400", 0.8), (-0.8, 2), "nobody can know");
    assert_eq!(before("G1 E-0.8 F2400\n{e_retracted[0] = 0.8}", 0.8), (0.0, 1));
    assert_eq!(before("G1 E-0.8 F2400\n{e_retracted[0] = 0.8}", 2.0), (0.0, 2), "the rest is pulled back");
    assert_eq!(before("G1 E-0.8 F2400\n{e_retracted[0] = 0.8}", 0.5), (0.0, 1));
}
