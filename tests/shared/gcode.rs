//! Files of other slicers, checked and reordered.

use pathwright::gcode::measure;
use pathwright::profile::Settings;
use pathwright::units::Mm;

use crate::listed;
use crate::support::found::report;
use crate::support::program::reorder;

pub fn other_slicers_files_have_no_errors() {
    for file in listed("gcode", "gcode") {
        let report = report(std::fs::read(&file).expect("readable"), &Settings::default());
        assert_eq!(report.errors, 0, "{}: {report}", file.display());
    }
}

pub fn files_of_other_slicers_print_the_same_afterwards() {
    let mut files = listed("gcode", "gcode");
    files.retain(|file| file.metadata().is_ok_and(|m| m.len() < 2_500_000));
    for file in files {
        let text = std::fs::read(file).expect("read");
        let (code, result, said) = reorder(&text, &["--order", "nearest"]);
        assert_eq!(code, 0, "{said}");
        let [before, after] = [&text, &result.expect("a result")].map(|t| measure(t, Mm(1.75)));
        assert!((before.print_mm - after.print_mm).abs() < 1e-3, "{said}");
        assert!(after.travel_mm <= before.travel_mm && after.retractions <= before.retractions, "{said}");
    }
}
