//! Presets of vendors, against what PrusaSlicer 2.9.2 makes of them.

use std::collections::BTreeMap;
use std::fs;
use std::time::Instant;

use pathwright::Settings;
use pathwright::check::Severity;
use pathwright::job::{Job, JobModel, ObjectSettings};
use pathwright::mesh::Transform;
use pathwright::presets::{Kind, Library, Source};

use crate::support::{found, print};
use crate::{listed, shared};

fn library(vendor: &str) -> Library {
    let path = shared(&format!("presets/vendor/{vendor}.ini"));
    let library = Library::open(&[Source { path, dialect: None }]);
    assert_eq!(library.problems(), []);
    library
}

/// The configuration in G-code, as it was resolved.
fn configuration(gcode: &str) -> BTreeMap<&str, &str> {
    let lines = gcode.lines().skip_while(|line| *line != "; prusaslicer_config = begin").skip(1);
    let lines = lines.take_while(|line| *line != "; prusaslicer_config = end");
    lines
        .filter_map(|line| line.strip_prefix("; ")?.split_once(" ="))
        .map(|(key, v)| (key, v.trim()))
        .collect()
}

/// What the files were made with and not what the presets say: text was asked for.
const ASKED_FOR: &[&str] = &["binary_gcode"];

pub fn resolved_configurations_are_those_of_the_slicer() {
    let index = fs::read_to_string(shared("presets/expected/INDEX.tsv")).expect("an index");
    let mut libraries: BTreeMap<&str, Library> = BTreeMap::new();
    let (mut compared, mut wrong) = (0, Vec::new());
    for row in index.lines().skip(1) {
        let row: Vec<&str> = row.split('\t').collect();
        let [vendor, printer, print, filament, _, file] = row[..] else { panic!("{row:?}") };
        let library = libraries.entry(vendor).or_insert_with(|| library(vendor));
        let chosen = library.choose(printer, Some(print), Some(filament)).unwrap_or_else(|e| panic!("{e}"));
        let gcode = fs::read_to_string(shared(&format!("presets/expected/{file}"))).expect("text");
        let theirs = configuration(&gcode);
        assert!(theirs.len() > 300, "{file}");
        for (key, value) in &theirs {
            compared += 1;
            let ours = chosen.config.raw.get(*key).map(|raw| raw.value.trim());
            if ours != Some(value) && !ASKED_FOR.contains(key) {
                wrong.push(format!("{printer}: {key} = {ours:?}, not {value:?}"));
            }
        }
        let more = chosen.config.raw.keys().filter(|key| !theirs.contains_key(key.as_str()));
        wrong.extend(more.map(|key| format!("{printer}: {key} is not theirs")));
    }
    println!("{compared} values compared");
    assert_eq!(wrong, Vec::<String>::new());
}

/// Every printer with several extruders prints one of two parts with each of two, and its file has no error.
pub fn printers_with_several_extruders_print_two_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let models = ["one", "other"].map(|name| {
        let path = folder.path().join(format!("{name}.stl"));
        fs::copy(print::model("calibration_cube"), &path).expect("a copy");
        JobModel {
            transform: Transform { scale: [0.5, 0.5, 0.1], ..Transform::default() },
            ..JobModel::from(path)
        }
    });
    let (mut printed, mut wrong) = (0, Vec::new());
    for file in listed("presets/vendor", "ini") {
        let library = library(&file.file_stem().expect("a name").to_string_lossy());
        for printer in library.listed(Kind::Printer) {
            let name = &printer.name;
            let chosen = library.choose(name, None, None).unwrap_or_else(|e| panic!("{e}"));
            if chosen.config.extruders() < 2 {
                continue;
            }
            printed += 1;
            let settings = Settings::of_presets(&chosen.config).unwrap_or_else(|e| panic!("{name}: {e}"));
            let script = chosen.config.script("toolchange_gcode");
            assert_eq!(settings.tool_change.script.trim(), script.trim(), "{name}");
            let second = settings.clone().set("tool_of.object", "2").expect("a tool");
            let objects = vec![ObjectSettings { object: "other".into(), settings: second }];
            let job = Job { models: models.to_vec(), objects, ..Job::default() };
            match print::run(&job, &settings) {
                Err(error) => wrong.push(format!("{name}: {error}")),
                Ok(print) => {
                    let report = found::report(&print.text, &settings);
                    let mut faults = report.faults;
                    // Scripts of vendors move beside the bed, and faster than their machines.
                    faults.retain(|fault| fault.severity == Severity::Error);
                    let used = print.summary.tools.iter().filter(|tool| tool.volume_mm3 > 0.0).count();
                    let changes = print.summary.tool_changes;
                    println!("{name}: {used} tools, {changes} changes, {} errors", faults.len());
                    if (used, faults.len()) != (2, 0) {
                        wrong.push(format!("{name}: {used} tools, {faults:?}"));
                    }
                }
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
    assert!(printed > 20, "{printed}");
}

pub fn every_preset_of_a_vendor_resolves() {
    for file in listed("presets/vendor", "ini") {
        let start = Instant::now();
        let library = library(&file.file_stem().expect("a name").to_string_lossy());
        let read = start.elapsed();
        let mut count = 0;
        for kind in [Kind::Printer, Kind::Print, Kind::Filament] {
            for preset in library.listed(kind) {
                library.preset(kind, &preset.name).unwrap_or_else(|error| panic!("{error}"));
                count += 1;
            }
        }
        println!("{}: {count} presets, read in {read:?}, all {:?}", file.display(), start.elapsed());
        assert!(count > 50);
    }
}

pub fn what_fits_a_printer_is_what_fits_it_in_the_slicer() {
    for file in listed("presets/compatible", "json") {
        let text = fs::read_to_string(&file).expect("text");
        let theirs: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let printer = theirs["printer"].as_str().expect("a name");
        let library = library(if printer.contains("Prusa") { "PrusaResearch" } else { "Anycubic" });
        let names = |list: &serde_json::Value| -> Vec<String> {
            list.as_array()
                .expect("a list")
                .iter()
                .map(|name| name.as_str().expect("text").to_owned())
                .collect()
        };
        let prints = theirs["prints"].as_object().expect("an object");
        for (print, list) in prints {
            let chosen = library.choose(printer, Some(print), None).unwrap_or_else(|e| panic!("{e}"));
            let all: Vec<&String> = prints.keys().collect();
            assert_eq!(chosen.prints.iter().collect::<Vec<_>>(), all, "{printer}");
            let list = list.as_u64().expect("a number") as usize;
            assert_eq!(chosen.filaments, names(&theirs["filament_lists"][list]), "{printer}, {print}");
        }
    }
}
