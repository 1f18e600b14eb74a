//! Presets of OrcaSlicer and its kin: small ones, written here.

use std::fs;
use std::path::Path;

use pathwright::Settings;
use pathwright::presets::{Config, Kind, Library, Source};
use pathwright::profile::SingleOnTop;
use tempfile::TempDir;

use crate::presets::in_memory;

const INDEX: &str = r#"{"name": "Maker", "version": "1", "machine_model_list": [{"name": "M1", "sub_path": "machine/M1.json"}],
"machine_list": [{"name": "common", "sub_path": "machine/common.json"}, {"name": "M1 0.4", "sub_path": "machine/M1 0.4.json"}],
"process_list": [{"name": "base", "sub_path": "process/base.json"}, {"name": "0.2 @M1", "sub_path": "process/02.json"},
 {"name": "Fits by condition", "sub_path": "process/when.json"}, {"name": "Elsewhere", "sub_path": "process/no.json"}],
"filament_list": [{"name": "PLA @M1", "sub_path": "filament/pla.json"}]}"#;

const FILES: &[(&str, &str)] = &[
    ("Maker.json", INDEX),
    ("Maker/machine/M1.json", r#"{"type": "machine_model", "name": "M1", "default_bed_type": "4"}"#),
    (
        "Maker/machine/common.json",
        r#"{"name": "common", "instantiation": "false", "gcode_flavor": "klipper", "printable_height": "250",
"machine_max_speed_x": ["500", "200"], "machine_start_gcode": "G28\nM104 S[nozzle_temperature_initial_layer]",
"z_hop": "0.4", "retraction_length": ["0.8"]}"#,
    ),
    (
        "Maker/machine/M1 0.4.json",
        r#"{"name": "M1 0.4", "inherits": "common", "instantiation": "true", "printer_model": "M1", "nozzle_diameter": ["0.4"],
"printable_area": ["0x0", "220x0", "220x210", "0x210"], "default_print_profile": "0.2 @M1", "printer_notes": "KIND_A",
"default_filament_profile": ["PLA @M1"], "thumbnails": ["64x64"]}"#,
    ),
    (
        "Maker/process/base.json",
        r#"{"name": "base", "instantiation": "false", "wall_loops": "3", "layer_height": "0.3", "line_width": "120%"}"#,
    ),
    (
        "Maker/process/02.json",
        r#"{"name": "0.2 @M1", "inherits": "base", "instantiation": "true", "layer_height": 0.2, "compatible_printers": ["M1 0.4"],
"sparse_infill_density": "15%", "sparse_infill_pattern": "tri-hexagon", "outer_wall_speed": "50%", "inner_wall_speed": "90",
"default_acceleration": "5000", "internal_solid_infill_acceleration": "50%", "brim_type": "auto_brim", "brim_width": "5",
"wall_infill_order": "outer wall/inner wall/infill", "seam_position": "back", "layer_heigth": "0.24", "print_flow_ratio": "0.95",
"precise_outer_wall": "1", "only_one_wall_top": "1", "wall_generator": "classic"}"#,
    ),
    (
        "Maker/process/when.json",
        r#"{"name": "Fits by condition", "inherits": "base", "instantiation": "true",
"compatible_printers_condition": "printer_notes=~/.*KIND_A.*/ and nozzle_diameter[0]==0.4"}"#,
    ),
    (
        "Maker/process/no.json",
        r#"{"name": "Elsewhere", "inherits": "base", "instantiation": "true", "compatible_printers_condition": "printer_notes=~/.*KIND_B.*/"}"#,
    ),
    (
        "Maker/filament/pla.json",
        r#"{"name": "PLA @M1", "inherits": "Shared PLA", "instantiation": "true", "compatible_printers": ["M1 0.4"],
"nozzle_temperature": ["215"], "filament_retraction_length": ["nil"], "filament_z_hop": ["0.6"]}"#,
    ),
    (
        "OrcaFilamentLibrary.json",
        r#"{"name": "OrcaFilamentLibrary", "filament_list": [{"name": "Shared PLA", "sub_path": "filament/pla.json"},
{"name": "PLA @System", "sub_path": "filament/system.json"}, {"name": "PETG @System", "sub_path": "filament/petg.json"}]}"#,
    ),
    (
        "OrcaFilamentLibrary/filament/pla.json",
        r#"{"name": "Shared PLA", "instantiation": "false", "filament_type": ["PLA"], "nozzle_temperature_initial_layer": ["220"],
"hot_plate_temp": ["61"], "textured_plate_temp": ["55"], "textured_plate_temp_initial_layer": ["57"], "filament_flow_ratio": ["1"],
"filament_start_gcode": ["; go"], "enable_pressure_advance": ["1"], "pressure_advance": ["0.04"], "overhang_fan_speed": ["90"],
"overhang_fan_threshold": ["50%"], "fan_min_speed": ["20"]}"#,
    ),
    (
        "OrcaFilamentLibrary/filament/system.json",
        r#"{"name": "PLA @System", "inherits": "Shared PLA", "instantiation": "true", "compatible_printers": []}"#,
    ),
    (
        "OrcaFilamentLibrary/filament/petg.json",
        r#"{"name": "PETG @System", "inherits": "Shared PLA", "instantiation": "true", "renamed_from": "Old PETG;Older PETG"}"#,
    ),
];

/// The files, with others in their place or besides.
fn presets(others: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in FILES.iter().chain(others) {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn library(path: &Path) -> Library {
    Library::open(&[Source { path: path.to_owned(), dialect: None }])
}

fn chosen(others: &[(&str, &str)], printer: &str) -> Result<Config, String> {
    let folder = presets(others);
    library(folder.path())
        .choose(printer, None, None)
        .map(|chosen| chosen.config)
        .map_err(|error| error.to_string())
}

fn names(library: &Library, kind: Kind) -> Vec<&str> {
    library.listed(kind).into_iter().map(|listed| listed.name.as_str()).collect()
}

#[test]
fn what_is_for_others_to_inherit_from_cannot_be_chosen() {
    let folder = presets(&[]);
    let library = library(folder.path());
    assert_eq!(names(&library, Kind::Printer), ["M1 0.4"]);
    assert_eq!(names(&library, Kind::Filament), ["PLA @M1", "PLA @System", "PETG @System"]);
    assert!(library.problems().is_empty(), "{:?}", library.problems());
}

#[test]
fn files_in_memory_are_as_good_as_a_folder() {
    let folder = presets(&[]);
    let [here, given] = [library(folder.path()), in_memory(folder.path())]
        .map(|library| library.choose("M1 0.4", None, None).unwrap());
    assert_eq!((given.config, given.filaments), (here.config, here.filaments));
}

#[test]
fn a_printer_has_its_process_and_filament_and_all_that_fit() {
    let folder = presets(&[]);
    let chosen = library(folder.path()).choose("M1 0.4", None, None).unwrap();
    assert_eq!((chosen.print.name.as_str(), chosen.filament.name.as_str()), ("0.2 @M1", "PLA @M1"));
    assert_eq!(chosen.prints, ["0.2 @M1", "Fits by condition"]);
    assert_eq!(chosen.filaments, ["PLA @M1", "PETG @System"], "the vendor's stands for the shared one");
    let again = library(folder.path()).choose("M1 0.4", Some("Fits by condition"), Some("Old PETG")).unwrap();
    assert_eq!(again.filament.name, "PETG @System");
    let error = library(folder.path()).choose("M1 0.4", Some("Elsewhere"), None).unwrap_err().to_string();
    assert!(error.contains("is not for `M1 0.4`"), "{error}");
}

#[test]
fn values_are_said_in_the_words_of_prusaslicer() {
    let config = chosen(&[], "M1 0.4").unwrap();
    for (key, value) in [
        ("bed_shape", "0x0,220x0,220x210,0x210"),
        ("max_print_height", "250"),
        ("machine_max_feedrate_x", "500,200"),
        ("start_gcode", "G28\\nM104 S[nozzle_temperature_initial_layer]"),
        ("retract_lift", "0.4"),
        ("layer_height", "0.2"),
        ("perimeters", "3"),
        ("fill_density", "15%"),
        ("fill_pattern", "stars"),
        ("extrusion_width", "0.48"),
        ("perimeter_speed", "90"),
        ("external_perimeter_speed", "60"),
        ("solid_infill_acceleration", "2500"),
        ("external_perimeters_first", "1"),
        ("seam_position", "rear"),
        ("brim_width", "0"),
        ("brim_type", "auto_brim"),
        ("top_one_perimeter_type", "top"),
        ("perimeter_generator", "classic"),
        ("temperature", "215"),
        ("first_layer_temperature", "220"),
        ("bed_temperature", "55"),
        ("first_layer_bed_temperature", "57"),
        ("extrusion_multiplier", "0.95"),
        ("filament_retract_length", "nil"),
        ("filament_retract_lift", "0.6"),
        ("start_filament_gcode", "\"; go\""),
        ("pressure_advance", "0.04"),
        ("overhang_speed_3", "60"),
        ("enable_dynamic_fan_speeds", "1"),
        ("overhang_fan_speed_1", "90"),
        ("overhang_fan_speed_3", "20"),
        ("bridge_fan_speed", "90"),
        ("thumbnails", "64x64/PNG"),
        ("gcode_label_objects", "octoprint"),
        ("top_one_perimeter_type", "top"),
        ("min_width_top_surface", "300%"),
        ("precise_outer_wall", "0"),
        ("chamber_minimal_temperature", "0"),
    ] {
        assert_eq!(config.entries.get(key).map(|entry| entry.value.as_str()), Some(value), "{key}");
    }
}

#[test]
fn what_prusaslicer_has_no_word_for_keeps_its_name_and_place() {
    let config = chosen(&[], "M1 0.4").unwrap();
    let place =
        |key: &str| config.entries.get(key).map(|entry| (entry.place.line, entry.place.preset.to_string()));
    assert_eq!(place("precise_outer_wall"), Some((5, "0.2 @M1".into())));
    assert_eq!(place("layer_heigth"), Some((4, "0.2 @M1".into())), "a slip of whoever wrote it");
    assert_eq!(place("layer_height"), Some((1, "0.2 @M1".into())));
    assert_eq!(place("perimeters"), Some((1, "base".into())));
    assert!(config.entries["travel_speed"].place.is_built_in());
}

#[test]
fn scripts_find_the_slicers_own_names() {
    let config = chosen(&[], "M1 0.4").unwrap();
    for (name, value) in [
        ("nozzle_temperature_initial_layer", "220"),
        ("bed_temperature_initial_layer_single", "57"),
        ("curr_bed_type", "Textured PEI Plate"),
        ("outer_wall_speed", "60"),
        ("sparse_infill_density", "15%"),
        ("printer_preset", "M1 0.4"),
        ("travel_speed", "120"),
    ] {
        assert_eq!(config.raw.get(name).map(|raw| raw.value.as_str()), Some(value), "{name}");
    }
}

#[test]
fn presets_of_a_user_come_first_and_stand_on_the_vendors() {
    let own = [
        (
            "user/1/machine/Mine.json",
            r#"{"name": "Mine", "from": "User", "inherits": "M1 0.4", "printable_height": "111"}"#,
        ),
        (
            "user/1/process/Fine.json",
            r#"{"name": "Fine", "from": "User", "inherits": "0.2 @M1", "layer_height": "0.1"}"#,
        ),
    ];
    let folder = presets(&own);
    let library = library(folder.path());
    assert_eq!(names(&library, Kind::Printer), ["Mine", "M1 0.4"]);
    let chosen = library.choose("Mine", Some("Fine"), None).unwrap();
    assert!(chosen.printer.is_user);
    assert_eq!(chosen.config.number("max_print_height"), Some(111.0));
    assert_eq!(chosen.config.number("layer_height"), Some(0.1));
    assert_eq!(chosen.config.number("perimeters"), Some(3.0));
}

#[test]
fn a_printer_that_asks_for_no_filament_gets_its_models_and_none_that_does_not_resolve() {
    let index = INDEX.replace(
        "\"filament_list\": [",
        "\"filament_list\": [{\"name\": \"ABS\", \"sub_path\": \"filament/abs.json\"},
{\"name\": \"ASA\", \"sub_path\": \"filament/asa.json\"}, ",
    );
    let machine = r#"{"name": "M1 0.4", "inherits": "common", "instantiation": "true", "printer_model": "M1", "nozzle_diameter": ["0.4"]}"#;
    let abs = r#"{"name": "ABS", "inherits": "Shared PLA", "instantiation": "true", "filament_type": ["ABS"], "compatible_printers": ["M1 0.4"]}"#;
    let asa =
        r#"{"name": "ASA", "inherits": "gone", "instantiation": "true", "compatible_printers": ["M1 0.4"]}"#;
    let files = [
        ("Maker.json", index.as_str()),
        ("Maker/machine/M1 0.4.json", machine),
        ("Maker/filament/abs.json", abs),
        ("Maker/filament/asa.json", asa),
    ];
    let taken = |model: &str| {
        let model = ("Maker/machine/M1.json", model);
        let folder = presets(&files.into_iter().chain([model]).collect::<Vec<_>>());
        let chosen = library(folder.path()).choose("M1 0.4", None, None).unwrap_or_else(|e| panic!("{e}"));
        assert!(!chosen.filaments.contains(&"ASA".to_owned()), "{:?}", chosen.filaments);
        chosen.filament.name
    };
    assert_eq!(taken(r#"{"type": "machine_model", "name": "M1", "default_materials": "ASA;ABS"}"#), "ABS");
    assert_eq!(taken(r#"{"type": "machine_model", "name": "M1"}"#), "PLA @M1", "the likest");
}

#[test]
fn a_missing_parent_a_circle_and_damage_are_told_with_their_place() {
    let machine = "Maker/machine/M1 0.4.json";
    let gone =
        chosen(&[(machine, "{\"name\": \"M1 0.4\",\n\"inherits\": \"nowhere\"}")], "M1 0.4").unwrap_err();
    assert!(gone.contains("M1 0.4.json:2 [M1 0.4]: inherits from `nowhere`, which is not there"), "{gone}");
    let circle = [
        (machine, "{\"name\": \"M1 0.4\", \"inherits\": \"common\"}"),
        ("Maker/machine/common.json", "{\"name\": \"common\", \"inherits\": \"M1 0.4\"}"),
    ];
    let circle = chosen(&circle, "M1 0.4").unwrap_err();
    assert!(circle.contains("M1 0.4 → common → M1 0.4"), "{circle}");
    let damaged = chosen(&[(machine, "{\"name\": \"M1 0.4\"\n\"inherits\": 1}")], "M1 0.4").unwrap_err();
    assert!(damaged.contains("M1 0.4.json:2: column 1: expected `,` or `}`"), "{damaged}");
    let folder = presets(&[("Maker.json", "{\"machine_list\": [{\"name\": \"x\"}]}")]);
    let problems = library(folder.path());
    assert!(
        problems.problems()[0].to_string().contains("`machine_list` holds what has no"),
        "{:?}",
        problems.problems()
    );
}

#[test]
fn a_project_holds_its_settings() {
    use std::io::Write;
    let folder = tempfile::tempdir().unwrap();
    let project = |name: &str, part: &str, text: &str| {
        let path = folder.path().join(name);
        let mut zip = zip::ZipWriter::new(fs::File::create(&path).unwrap());
        zip.start_file(part, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
        zip.finish().unwrap();
        Config::read(&path)
    };
    let orca = r#"{"layer_height": "0.28", "curr_bed_type": "Cool Plate", "cool_plate_temp": ["35", "40"], "wall_loops": "4"}"#;
    let orca = project("a.3mf", "Metadata/project_settings.config", orca).unwrap();
    assert_eq!((orca.number("layer_height"), orca.number("perimeters")), (Some(0.28), Some(4.0)));
    assert_eq!(orca.text("bed_temperature"), Some("35"));
    let prusa =
        project("b.3mf", "Metadata/Slic3r_PE.config", "; layer_height = 0.15\n; perimeters = 5\n").unwrap();
    assert_eq!((prusa.number("layer_height"), prusa.number("perimeters")), (Some(0.15), Some(5.0)));
    let none = project("c.3mf", "3D/3dmodel.model", "").unwrap_err();
    assert!(none.contains("it holds none"), "{none}");
}

#[test]
fn walls_on_top_and_the_chamber_are_settings_here() {
    let others = [
        (
            "Maker/process/02.json",
            r#"{"name": "0.2 @M1", "inherits": "base", "instantiation": "true", "compatible_printers": ["M1 0.4"], "layer_height": "0.2",
"only_one_wall_top": "1", "only_one_wall_first_layer": "1", "min_width_top_surface": "200%", "inner_wall_line_width": "0.5",
"wall_sequence": "inner wall/outer wall"}"#,
        ),
        (
            "Maker/filament/pla.json",
            r#"{"name": "PLA @M1", "inherits": "Shared PLA", "instantiation": "true", "compatible_printers": ["M1 0.4"],
"chamber_temperature": ["45"], "activate_chamber_temp_control": ["1"]}"#,
        ),
    ];
    let s = Settings::of_presets(&chosen(&others, "M1 0.4").unwrap()).unwrap();
    assert_eq!(s.walls.single_on_top, SingleOnTop::Top);
    assert!(s.walls.single_on_first_layer && s.walls.precise);
    assert_eq!(
        (s.walls.min_top_width.0, s.temperature.chamber.0, s.temperature.chamber_min.0),
        (1.0, 45.0, 45.0)
    );
}

#[test]
fn scripts_of_bambu_studio_are_told_what_its_keys_say_of_filaments() {
    let filament = (
        "Maker/filament/pla.json",
        r#"{"name": "PLA @M1", "inherits": "Shared PLA", "instantiation": "true", "compatible_printers": ["M1 0.4"],
"filament_flush_temp": ["230"], "filament_flush_volumetric_speed": ["0"], "filament_max_volumetric_speed": ["21"],
"during_print_exhaust_fan_speed": ["70"], "filament_vendor": ["Bambu Lab"], "temperature_vitrification": ["45"]}"#,
    );
    let config = chosen(&[filament], "M1 0.4").unwrap();
    for (name, value) in [
        ("flush_temperatures", "230"),
        ("flush_volumetric_speeds", "21"),
        ("during_print_exhaust_fan_speed_num", "178"),
        ("min_vitrification_temperature", "45"),
        ("is_all_bbl_filament", "1"),
    ] {
        assert_eq!(config.raw[name].value, value, "{name}");
    }
}
