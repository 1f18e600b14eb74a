//! The reader against an independent one: a Python script, which also looks for
//! faults that a printer would stumble over.

use std::process::Command;

use crate::shared;
use crate::support::gcode_fixture::{END, START, bare, mixed, print};
use pathwright::gcode::measure;
use pathwright::motion::PauseAt;
use pathwright::profile::Flavor;
use pathwright::units::Mm;

pub fn an_independent_reader_finds_the_same_and_no_fault() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut files = Vec::new();
    for flavor in [Flavor::Marlin, Flavor::Klipper, Flavor::RepRapFirmware] {
        for variant in 0..8 {
            let mut settings = bare();
            settings.printer.flavor = flavor;
            settings.gcode.relative_e = variant & 1 == 0;
            settings.gcode.arcs = variant & 2 == 0;
            settings.retract.firmware = variant == 7;
            if variant & 4 == 0 {
                (settings.gcode.start, settings.gcode.end) = (START.into(), END.into());
                (settings.retract.wipe, settings.retract.z_hop) = (Mm(1.5), Mm(0.2));
            }
            let file = folder.path().join(format!("{}{variant}.gcode", flavor.name()));
            std::fs::write(&file, print(&mixed(3), &settings, &[PauseAt::Layer(1)])).expect("written");
            files.push(file);
        }
    }
    let foreign = ["slic3r-1.3.0_ctrlV_3D_test", "prusaslicer-2.9.2_ctrlV_3D_test"];
    let foreign = foreign.map(|name| shared(&format!("gcode/{name}.gcode")));
    files.extend(foreign.into_iter().filter(|file| file.exists()));
    let output = Command::new("python3")
        .arg(shared("tools/gcode_yardstick.py"))
        .arg("--json")
        .args(&files)
        .output()
        .expect("runs");
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.lines().count(), files.len(), "{}", String::from_utf8_lossy(&output.stderr));
    for (file, line) in files.iter().zip(text.lines()) {
        let theirs: serde_json::Value = serde_json::from_str(line).expect("JSON");
        assert_eq!(theirs["faults"], serde_json::json!({}), "{line}");
        let ours = measure(&std::fs::read(file).expect("read"), Mm(1.75));
        let number = |key: &str| theirs[key].as_f64().unwrap_or_else(|| panic!("{key} in {line}"));
        for (key, value) in [
            ("print", ours.print_mm),
            ("travel", ours.travel_mm),
            ("total", ours.total_mm()),
            ("link", ours.link_mm),
            ("volume_mm3", ours.volume_mm3),
        ] {
            assert!((number(key) - value).abs() < 0.02, "{key}: {value}, {line}");
        }
        for (key, value) in [
            ("travels", ours.travels),
            ("long_travels", ours.long_travels),
            ("retractions", ours.retractions),
            ("layers", ours.heights_um.len()),
        ] {
            assert_eq!(number(key), value as f64, "{key}, {line}");
        }
    }
}
