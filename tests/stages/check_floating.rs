//! What begins in mid-air is found in any slicer's file, without its model.

use std::fmt::Write;

use crate::support::found::report;
use pathwright::check::{CheckReport, Kind};
use pathwright::profile::Settings;

/// G-code of nobody's slicer, written bead by bead.
struct File {
    text: String,
    /// Whether it says what beads are for, and how high they are.
    tells: bool,
}

impl File {
    fn new(tells: bool) -> Self {
        let text = "M104 S210\nM109 S210\nG28\nG21\nG90\nM83\nG92 E0\n".into();
        Self { text, tells }
    }

    fn line(&mut self, line: &str) {
        let _ = writeln!(self.text, "{line}");
    }

    /// Begins a layer with its top at `z_mm`.
    fn layer(&mut self, z_mm: f64, height_mm: f64) -> &mut Self {
        if self.tells {
            let _ = writeln!(self.text, ";LAYER_CHANGE\n;Z:{z_mm:.2}\n;HEIGHT:{height_mm:.2}");
        }
        let _ = writeln!(self.text, "G1 Z{z_mm:.2} F600");
        self
    }

    /// A loop around a square.
    fn square(&mut self, role: &str, low: [f64; 2], side_mm: f64) -> &mut Self {
        let [x, y] = low;
        let corners = [[x, y], [x + side_mm, y], [x + side_mm, y + side_mm], [x, y + side_mm], [x, y]];
        self.path(role, &corners)
    }

    fn path(&mut self, role: &str, points: &[[f64; 2]]) -> &mut Self {
        if self.tells {
            let _ = writeln!(self.text, ";TYPE:{role}\n;WIDTH:0.45");
        }
        let [x, y] = points[0];
        let _ = writeln!(self.text, "G1 E-1 F2400\nG0 X{x:.3} Y{y:.3} F9000\nG1 E1 F2400\nG1 F1800");
        for pair in points.windows(2) {
            let length_mm = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            let _ =
                writeln!(self.text, "G1 X{:.3} Y{:.3} E{:.5}", pair[1][0], pair[1][1], 0.0334 * length_mm);
        }
        self
    }

    /// Layers of 0.2 mm with a square, from one height to another.
    fn block(&mut self, from_mm: f64, to_mm: f64) -> &mut Self {
        let layers = ((to_mm - from_mm) / 0.2).round() as usize;
        for i in 1..=layers {
            self.layer(from_mm + 0.2 * i as f64, 0.2).square("External perimeter", [100.0, 100.0], 20.0);
        }
        self
    }

    fn report(&mut self) -> CheckReport {
        for line in ["G0 Z40 F600", "M104 S0", "M84"] {
            self.line(line);
        }
        report(&self.text, &Settings::default())
    }
}

/// The faults in question, with their numbers and first details.
fn floating(report: &CheckReport) -> Vec<(Kind, usize, String)> {
    let of_kind = |kind| matches!(kind, Kind::StartsInAir | Kind::FloatingIsland);
    let faults = report.faults.iter().filter(|fault| of_kind(fault.kind));
    faults.map(|fault| (fault.kind, fault.count, fault.first[0].detail.clone())).collect()
}

#[test]
fn a_first_layer_without_the_part_is_an_error_that_names_the_height() {
    for tells in [true, false] {
        let mut file = File::new(tells);
        file.layer(0.2, 0.2).square("Skirt/Brim", [90.0, 90.0], 40.0);
        let report = file.block(2.8, 5.0).report();
        let found = floating(&report);
        assert!(matches!(found.as_slice(), [(Kind::StartsInAir, 1, _)]), "{tells}: {found:?}");
        assert!(found[0].2.contains("Z3.00") && found[0].2.contains("above Z0.20"), "{found:?}");
        assert!(report.errors > 0);
    }
}

#[test]
fn a_print_that_begins_above_the_bed_with_nothing_beneath_is_an_error() {
    let found = floating(&File::new(true).block(3.0, 5.0).report());
    assert!(matches!(found.as_slice(), [(Kind::StartsInAir, 1, _)]), "{found:?}");
}

#[test]
fn empty_layers_between_printed_ones_are_an_error() {
    for tells in [true, false] {
        let found = floating(&File::new(tells).block(0.0, 2.0).block(3.0, 4.0).report());
        assert!(matches!(found.as_slice(), [(Kind::StartsInAir, 1, _)]), "{tells}: {found:?}");
        assert!(found[0].2.contains("Z3.20") && found[0].2.contains("above Z2.00"), "{found:?}");
    }
    let one_empty = floating(&File::new(true).block(0.0, 2.0).block(2.2, 4.0).report());
    assert_eq!(one_empty.len(), 1, "a single empty layer, where heights are told");
}

#[test]
fn layers_of_other_heights_supports_and_rafts_are_no_fault() {
    for tells in [true, false] {
        let mut file = File::new(tells);
        let mut z_mm = 0.0;
        for height_mm in [0.3, 0.1, 0.1, 0.32, 0.2, 0.08, 0.28] {
            z_mm += height_mm;
            file.layer(z_mm, height_mm).square("External perimeter", [100.0, 100.0], 20.0);
        }
        assert_eq!(floating(&file.report()), [], "{tells}");
        let mut file = File::new(tells);
        for i in 1..=5 {
            file.layer(0.2 * f64::from(i), 0.2).square("Support material", [100.0, 100.0], 20.0);
        }
        file.block(1.2, 3.0);
        assert_eq!(floating(&file.report()), [], "{tells}: over a gap of one layer");
    }
}

#[test]
fn an_island_in_mid_air_is_a_warning_and_a_bridge_is_none() {
    let mut file = File::new(true);
    file.block(0.0, 2.0);
    for i in 1..=3 {
        let z_mm = 2.0 + 0.2 * f64::from(i);
        file.layer(z_mm, 0.2)
            .square("External perimeter", [100.0, 100.0], 20.0)
            // Over air, held at both ends.
            .path("Bridge infill", &[[100.0, 110.0], [120.0, 110.0]])
            .square("External perimeter", [130.0, 100.0], 3.0);
    }
    let report = file.report();
    let found = floating(&report);
    assert!(matches!(found.as_slice(), [(Kind::FloatingIsland, 1, _)]), "{found:?}");
    assert!(found[0].2.contains("X130.00 Y100.00 Z2.20") || found[0].2.contains("Z2.20"), "{found:?}");
    assert_eq!(report.errors, 0);
}

#[test]
fn a_layer_wholly_beside_the_one_beneath_has_islands_in_mid_air_and_a_gap_is_an_error() {
    for (bottom_mm, kind) in [(2.0, Kind::FloatingIsland), (3.0, Kind::StartsInAir)] {
        let mut file = File::new(true);
        file.block(0.0, 2.0).layer(bottom_mm + 0.2, 0.2).square("External perimeter", [130.0, 100.0], 3.0);
        let found = floating(&file.report());
        assert_eq!(found.iter().map(|(kind, ..)| *kind).collect::<Vec<_>>(), [kind], "{found:?}");
    }
}

#[test]
fn an_object_after_another_begins_on_the_bed_again() {
    let mut file = File::new(true);
    file.block(0.0, 4.0);
    for i in 1..=3 {
        file.layer(0.2 * f64::from(i), 0.2).square("External perimeter", [150.0, 100.0], 10.0);
    }
    assert_eq!(floating(&file.report()), []);
}
