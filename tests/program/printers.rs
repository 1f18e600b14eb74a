//! Presets of other slicers on the command line.

use std::fs;
use std::path::PathBuf;

use assert_cmd::cargo::cargo_bin_cmd;
use tempfile::TempDir;

const BUNDLE: &str = "[vendor]\nname = Acme\n\
    [printer:Acme One]\nbed_shape = 0x0,200x0,200x180,0x180\nmax_print_height = 150\nnozzle_diameter = 0.4\n\
    gcode_flavor = marlin\nretract_length = 0.8\ndefault_filament_profile = \"PLA\"\n\
    start_gcode = G28\nend_gcode = M84\n\
    [printer:Acme Two]\nbed_shape = 0x0,300x0,300x300,0x300\nnozzle_diameter = 0.6\ngcode_flavor = klipper\n\
    [print:fine]\nlayer_height = 0.1\nperimeters = 3\ncompatible_printers = Acme One\n\
    [print:coarse]\nlayer_height = 0.4\ncompatible_printers = Acme Two\n\
    [filament:PLA]\ntemperature = 205\n[filament:ABS]\ntemperature = 240\n";

/// A machine without slicers, and a bundle on it.
struct Machine {
    home: TempDir,
    bundle: PathBuf,
}

impl Machine {
    fn new() -> Self {
        let home = tempfile::tempdir().unwrap();
        let bundle = home.path().join("Acme.ini");
        fs::write(&bundle, BUNDLE).unwrap();
        Self { home, bundle }
    }

    /// Standard output of a run that must end with this exit code, and standard error.
    fn run(&self, args: &[&str], variable: Option<&str>, code: i32) -> (String, String) {
        let mut command = cargo_bin_cmd!("pathwright");
        command.args(args).env("HOME", self.home.path()).env("APPDATA", self.home.path());
        command.env_remove("XDG_CONFIG_HOME").env_remove("XDG_DATA_HOME");
        match variable {
            Some(path) => command.env("PATHWRIGHT_PRESETS", path),
            None => command.env_remove("PATHWRIGHT_PRESETS"),
        };
        let done = command.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let (out, err) = (text(done.stdout), text(done.stderr));
        assert_eq!(done.status.code(), Some(code), "{args:?}\n{out}\n{err}");
        (out, err)
    }

    fn bundle(&self) -> &str {
        self.bundle.to_str().unwrap()
    }
}

#[test]
fn printers_are_listed_with_bed_nozzle_and_firmware() {
    let machine = Machine::new();
    let (out, _) = machine.run(&["printers", "acme", "--presets", machine.bundle()], None, 0);
    let lines: Vec<Vec<&str>> = out.lines().map(|line| line.split("  ").collect()).collect();
    let cells =
        |line: &[&str]| line.iter().map(|c| c.trim()).filter(|c| !c.is_empty()).collect::<Vec<_>>().join("|");
    assert_eq!(cells(&lines[1]), "Acme One|200 x 180 x 150|0.4|marlin|Acme.ini (PrusaSlicer)");
    assert_eq!(lines.len(), 3);
    let (out, _) = machine.run(&["printers", "TWO", "acme"], Some(machine.bundle()), 0);
    assert!(out.contains("Acme Two") && !out.contains("Acme One"), "{out}");
    let (json, _) = machine.run(&["printers", "acme", "--json", "--presets", machine.bundle()], None, 0);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&json[0]["nozzle_mm"], &json[1]["bed_mm"][0]), (&0.4.into(), &300.0.into()));
}

#[test]
fn a_printer_is_shown_with_the_origin_of_every_setting() {
    let machine = Machine::new();
    let show = ["printers", "show", "Acme One", "--presets", machine.bundle()];
    let (out, _) = machine.run(&show, None, 0);
    assert!(out.contains("Acme.ini:8 [printer:Acme One]"), "{out}");
    assert!(out.contains("length = 0.8 #"), "{out}");
    let (json, _) = machine.run(&[&show[..], &["--json", "--filament", "ABS"]].concat(), None, 0);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["print"]["name"], "fine");
    assert_eq!(json["config"]["temperature"], "240");
    assert_eq!(json["config"]["avoid_crossing_perimeters"], "0", "built in");
    assert_eq!(json["settings"]["temperature.nozzle"]["value"], 240.0);
    assert_eq!(json["prints"], serde_json::json!(["fine"]));
    assert_eq!(json["filaments"], serde_json::json!(["ABS", "PLA"]));
}

#[test]
fn slicing_takes_presets_below_profiles_and_options() {
    let machine = Machine::new();
    let output = machine.home.path().join("cube.gcode");
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/models/calibration_cube.stl");
    let slice = ["slice", model, "-o", output.to_str().unwrap(), "--printer", "Acme One"];
    let more = ["--profile", "petg", "--set", "layer.height=0.3", "--presets", machine.bundle()];
    machine.run(&[&slice[..], &more].concat(), None, 0);
    let gcode = fs::read_to_string(output).unwrap();
    assert!(gcode.contains("G28\n") && !gcode.contains("M104 S205"), "{}", &gcode[..2_000]);
    let dump = [
        "profiles",
        "dump",
        "--printer",
        "Acme One",
        "--presets",
        machine.bundle(),
        "--set",
        "walls.count=5",
    ];
    let (out, _) = machine.run(&dump, None, 0);
    assert!(out.contains("count = 5 # --set"), "{out}");
    assert!(out.contains("height = 0.1 # "), "{out}");
}

#[test]
fn what_is_not_there_is_said_with_what_is() {
    let machine = Machine::new();
    let presets = ["--presets", machine.bundle()];
    let (_, err) =
        machine.run(&[&["info", "a.stl", "--printer", "Acme Onne"][..], &presets].concat(), None, 4);
    assert!(err.contains("did you mean `Acme One`"), "{err}");
    let wrong = ["slice", "a.stl", "--printer", "Acme One", "--print", "coarse"];
    let (_, err) = machine.run(&[&wrong[..], &presets].concat(), None, 4);
    assert!(err.contains("is not for `Acme One`; those that fit: `fine`"), "{err}");
    let (_, err) = machine.run(&["printers", "--presets", "/no/such/file.ini"], None, 4);
    assert!(err.contains("/no/such/file.ini: is not there"), "{err}");
    machine.run(&["slice", "a.stl", "--print", "fine"], None, 2);
}

#[test]
fn a_bundle_is_no_profile_but_its_printers_are_counted() {
    let machine = Machine::new();
    let (out, err) = machine.run(&["profiles", "show", machine.bundle()], None, 4);
    assert!(out.is_empty() && err.len() < 600, "{out}{err}");
    assert!(err.contains("2 printer, 2 print and 2 filament presets"), "{err}");
    assert!(err.contains("--printer NAME"), "{err}");
}
