//! Scripts of vendors' presets, against what PrusaSlicer 2.9.2 makes of them for the same cube.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use pathwright::gcode::PrintFacts;
use pathwright::presets::{Config, Library, Source, built_in_value, script_value};
use pathwright::profile::expand;
use pathwright::{Mesh, Observer, Plate, Settings, Slicer};

use crate::{listed, shared};

/// What precedes the first bead, changes to the second and the middle layer up to their first bead, and the end.
type Blocks = [Vec<String>; 4];

/// Lines that the slicers write themselves, each in its own way: moves, temperatures, modes, labels, progress.
fn is_of_slicer(line: &str) -> bool {
    const BEGINNINGS: [&str; 20] = [
        "M73",
        "M486",
        "M204",
        "M106",
        "M107",
        "G21",
        "G90",
        "M82",
        "M83",
        "G92 E0",
        "G10",
        "G11",
        "; printing",
        "; stop printing",
        "; filament used",
        "; filament cost",
        "; total ",
        "; estimated",
        "; objects_info",
        "SET_PRINT_STATS_INFO",
    ];
    line.is_empty() || BEGINNINGS.iter().any(|beginning| line.starts_with(beginning))
}

/// Lines of slicers where a layer changes.
fn is_of_change(line: &str) -> bool {
    const BEGINNINGS: [&str; 9] =
        ["G1 ", ";LAYER", ";Z:", ";HEIGHT", ";WIDTH", ";WIPE", "M104 ", "M140 ", "SET_VELOCITY_LIMIT ACCEL"];
    BEGINNINGS.iter().any(|beginning| line.starts_with(beginning))
}

/// Stands in the references where lines are left out.
const LEFT_OUT: &str = "; [...]";

/// Whether a block is that of the reference, as far as that is there. We switch heaters off that a script leaves on.
fn agree(ours: &[String], theirs: &[String]) -> bool {
    if theirs.last().is_some_and(|line| line == LEFT_OUT) {
        return ours.starts_with(&theirs[..theirs.len() - 1]);
    }
    let off = |line: &String| ["M104 S0", "M140 S0"].contains(&line.as_str());
    ours.starts_with(theirs) && ours[theirs.len()..].iter().all(off)
}

/// The facts that our files end with.
fn is_fact(line: &str) -> bool {
    let keys = [
        "layer_height",
        "first_layer",
        "nozzle_d",
        "filament_",
        "printer_model",
        "temperature",
        "bed_temperature",
        "chamber_temperature",
        "single_extruder_multi_material",
    ];
    line.strip_prefix("; ").is_some_and(|rest| keys.iter().any(|key| rest.starts_with(key)))
}

/// What depends on how much filament a slicer takes is no longer seen.
fn masked(line: &str) -> String {
    let depends = line.starts_with("M74 W") || line.starts_with("M201 X3");
    if depends { line.chars().filter(|c| !c.is_ascii_digit()).collect() } else { line.to_owned() }
}

/// The blocks of a file; `middle`: the `;Z:` of the middle layer, else the third that is there.
fn blocks(text: &str, middle: Option<&str>) -> (Blocks, String) {
    let text = text.split("; prusaslicer_config = begin").next().unwrap_or_default();
    let mut lines: Vec<&str> = text.lines().map(str::trim).collect();
    // What we say of the height, where no script does.
    for i in (1..lines.len() - 1).rev() {
        if lines[i - 1].starts_with(";LAYER:") && lines[i] == ";BEFORE_LAYER_CHANGE" {
            lines.drain(i..i + 2);
        }
    }
    let custom = |line: &&str| *line == ";TYPE:Custom";
    let begin = lines.iter().position(custom).expect("a start");
    let end = lines.iter().rposition(custom).expect("an end");
    let changes: Vec<usize> = (0..lines.len()).filter(|&i| lines[i] == ";LAYER_CHANGE").collect();
    let at = |&&i: &&usize| middle.is_none_or(|z| lines[i + 1] == z);
    let middle = *changes.iter().skip(2).find(at).expect("the middle layer");
    let kept = |lines: &[&str], is_change: bool| -> Vec<String> {
        let is_bead = |line: &str| line.starts_with(";TYPE:") && line != ";TYPE:Custom";
        let until = lines.iter().position(|line| is_bead(line) || *line == LEFT_OUT).unwrap_or(lines.len());
        let script = lines[..until].iter().filter(|line| !is_of_slicer(line));
        let script = script.filter(|line| !(is_change && is_of_change(line))).map(|line| masked(line));
        // What the reference leaves out before the first bead cannot be compared.
        script
            .chain(lines.get(until).filter(|line| **line == LEFT_OUT).map(|line| (*line).to_owned()))
            .collect()
    };
    // Where the end is left out as well, the start is the last script.
    let ends = if end == begin { &[LEFT_OUT][..] } else { &lines[end..] };
    let ends = ends.iter().copied().filter(|line| !is_fact(line)).collect::<Vec<_>>();
    let blocks = [
        kept(&lines[begin..changes[0]], false),
        kept(&lines[changes[1]..], true),
        kept(&lines[middle..], true),
        kept(&ends, false),
    ];
    (blocks, lines[middle + 1].to_owned())
}

/// Script text before the first bead, at two layer changes and at the end is that of the presets' slicer, line by line.
pub fn scripts_are_expanded_as_by_their_slicer() {
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl");
    // The name is that of the slicer's file.
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("cube.stl");
    fs::copy(cube, &model).expect("a copy");
    let index = fs::read_to_string(shared("presets/expected/INDEX.tsv")).expect("an index");
    let mut libraries: BTreeMap<&str, Library> = BTreeMap::new();
    let mut wrong = Vec::new();
    for row in index.lines().skip(1) {
        let row: Vec<&str> = row.split('\t').collect();
        let [vendor, printer, print, filament, _, file] = row[..] else { panic!("{row:?}") };
        let library = libraries.entry(vendor).or_insert_with(|| {
            let path = shared(&format!("presets/vendor/{vendor}.ini"));
            Library::open(&[Source { path, dialect: None }])
        });
        let chosen = library.choose(printer, Some(print), Some(filament)).unwrap_or_else(|e| panic!("{e}"));
        let settings = Settings::of_presets(&chosen.config).unwrap_or_else(|e| panic!("{printer}: {e}"));
        let mesh = Mesh::read(&model).expect("a cube");
        let plate = Plate::new(&settings).add(mesh).unwrap_or_else(|e| panic!("{printer}: {e}"));
        let sliced = Slicer::new(&settings).slice(&plate, &Observer::none());
        let sliced = sliced.unwrap_or_else(|e| panic!("{printer}: {e}"));
        let mut gcode = Vec::new();
        sliced.write_gcode(&mut gcode).expect("memory");
        let reference = fs::read_to_string(shared(&format!("presets/expected/{file}"))).expect("text");
        let (theirs, middle) = blocks(&reference, None);
        let (ours, _) = blocks(&String::from_utf8_lossy(&gcode), Some(&middle));
        for (which, (ours, theirs)) in
            ["start", "second layer", "middle layer", "end"].iter().zip(ours.iter().zip(&theirs))
        {
            if !agree(ours, theirs) {
                let first = ours.iter().zip(theirs).find(|(a, b)| a != b);
                wrong.push(format!(
                    "{printer}, {which}: {first:?}; {} and {} lines",
                    ours.len(),
                    theirs.len()
                ));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
}

/// Where the presets of a filament changer leave it to the slicer, the file takes a filament out as far as it is parked, and feeds
/// the next one.
pub fn filaments_are_taken_out_and_put_in_at_changes() {
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/calibration_cube.stl");
    let index = fs::read_to_string(shared("presets/expected/INDEX.tsv")).expect("an index");
    let mut changers = 0;
    for row in index.lines().skip(1) {
        let row: Vec<&str> = row.split('\t').collect();
        let [vendor, printer, print, filament, _, _] = row[..] else { panic!("{row:?}") };
        if !printer.contains("MMU") {
            continue;
        }
        changers += 1;
        let path = shared(&format!("presets/vendor/{vendor}.ini"));
        let library = Library::open(&[Source { path, dialect: None }]);
        let chosen = library.choose(printer, Some(print), Some(filament)).unwrap_or_else(|e| panic!("{e}"));
        let settings = Settings::of_presets(&chosen.config).unwrap_or_else(|e| panic!("{printer}: {e}"));
        let settings = settings.set("tool_of.heights", "1-2:2").expect("a belt");
        // Priming before the first layer changes tools, too.
        let settings = settings.set("prime_tower.at_start", "false").expect("no priming");
        let plate = Plate::new(&settings).add(Mesh::read(&cube).expect("a cube")).expect("room");
        let sliced = Slicer::new(&settings).slice(&plate, &Observer::none()).expect("a print");
        let mut gcode = Vec::new();
        sliced.write_gcode(&mut gcode).expect("memory");
        let text = String::from_utf8_lossy(&gcode);
        let body = text.split_once(";LAYER_CHANGE").expect("layers").1;
        let parts: Vec<&str> = body.split("\nT").collect();
        assert_eq!(parts.len(), 3, "{printer}: two changes");
        // What is fed in place, up to the next bead or since the last one.
        let fed_mm = |lines: &mut dyn Iterator<Item = &str>| -> f64 {
            let beads =
                |line: &&str| !(line.starts_with("G1 X") || line.starts_with("G1 Y")) || !line.contains(" E");
            let e = |line: &str| line.strip_prefix("G1 E")?.split_whitespace().next()?.parse::<f64>().ok();
            lines.take_while(beads).filter_map(e).sum()
        };
        for pair in parts.windows(2) {
            let parking_mm = settings.swap.parking.0;
            let out_mm = fed_mm(&mut pair[0].lines().rev());
            assert!((out_mm + parking_mm).abs() < 1e-3, "{printer}: {out_mm} of {parking_mm}");
            let in_mm = fed_mm(&mut pair[1].lines());
            let way_mm = parking_mm + settings.swap.extra_load.0;
            assert!((in_mm - way_mm).abs() < 1e-3, "{printer}: {in_mm} of {way_mm}");
        }
    }
    assert!(changers > 5, "{changers}");
}

/// What a configuration leaves out is to its scripts what the slicer takes by default.
pub fn scripts_of_configurations_that_leave_defaults_out_expand_alike() {
    let mut left_out = 0;
    for file in listed("presets/expected", "gcode") {
        let whole = Config::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let mut without = whole.clone();
        let extruders = whole.extruders();
        without.raw.retain(|key, raw| built_in_value(key, extruders) != Some(script_value(raw)));
        left_out += whole.raw.len() - without.raw.len();
        let [whole, without] = [whole, without].map(|config| {
            let settings =
                Settings::of_presets(&config).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            let facts = PrintFacts { max_mm: [50.0; 2], layers: 9, ..PrintFacts::default() };
            expand(&settings.gcode.start, &settings, &facts)
        });
        assert_eq!(without, whole, "{}", file.display());
    }
    assert!(left_out > 10_000, "{left_out}");
}
