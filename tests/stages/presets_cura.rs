//! Presets of Cura: small ones, written here.

use std::fs;

use pathwright::presets::{Dialect, Kind, Library, Source};
use tempfile::TempDir;

use crate::presets::in_memory;

const FILES: &[(&str, &str)] = &[
    (
        "definitions/fdmprinter.def.json",
        r#"{"name": "Base", "version": 2, "metadata": {"visible": false}, "settings": {"machine": {"type": "category", "children": {
"machine_width": {"default_value": 100}, "machine_depth": {"default_value": 100}, "machine_height": {"default_value": 100},
"machine_shape": {"default_value": "rectangular"}, "machine_center_is_zero": {"default_value": false},
"machine_heated_bed": {"default_value": false}, "machine_nozzle_size": {"default_value": 0.4},
"machine_gcode_flavor": {"default_value": "RepRap (Marlin/Sprinter)"}, "machine_start_gcode": {"default_value": "G28"},
"machine_max_feedrate_x": {"default_value": 299792458000}, "machine_max_feedrate_y": {"default_value": 299792458000},
"material_diameter": {"default_value": 2.85}, "layer_height": {"default_value": 0.1},
"default_material_print_temperature": {"default_value": 210},
"material_print_temperature": {"default_value": 210, "value": "default_material_print_temperature"},
"default_material_bed_temperature": {"default_value": 60},
"material_bed_temperature": {"default_value": 60, "value": "default_material_bed_temperature + (5 if layer_height > 0.15 else 0)"},
"speed_print": {"default_value": 60, "children": {"speed_wall_0": {"default_value": 30, "value": "speed_print / 2"}}},
"line_width": {"default_value": 0.4, "value": "machine_nozzle_size"}, "strange": {"default_value": 1}}}}}"#,
    ),
    (
        "definitions/maker_base.def.json",
        r#"{"name": "Maker base", "inherits": "fdmprinter", "metadata": {"visible": false, "has_machine_quality": true,
"has_variants": true, "preferred_variant_name": "0.6mm", "preferred_quality_type": "standard", "preferred_material": "generic_pla",
"machine_extruder_trains": {"0": "maker_extruder"}}, "overrides": {"machine_heated_bed": {"default_value": true},
"speed_print": {"default_value": 80}, "strange": {"value": "[x for x in y]"}, "unheard_of": {"default_value": 7}}}"#,
    ),
    (
        "definitions/maker.def.json",
        r#"{"name": "Maker One", "inherits": "maker_base", "metadata": {"visible": true, "quality_definition": "maker_base"},
"overrides": {"machine_width": {"default_value": 220}, "machine_center_is_zero": {"default_value": true},
"machine_max_feedrate_x": {"value": 500},
"machine_start_gcode": {"default_value": "M104 S{material_print_temperature}\nG28"}}}"#,
    ),
    (
        "extruders/fdmextruder.def.json",
        r#"{"name": "Extruder", "settings": {"extruder_nr": {"default_value": 0}}}"#,
    ),
    (
        "extruders/maker_extruder.def.json",
        r#"{"name": "E", "inherits": "maker_extruder_base", "overrides": {"material_diameter": {"default_value": 1.75}}}"#,
    ),
    (
        "definitions/maker_extruder_base.def.json",
        r#"{"name": "E base", "inherits": "fdmextruder", "metadata": {"visible": false}, "overrides": {}}"#,
    ),
    (
        "variants/maker_0.6.inst.cfg",
        "[general]\nname = 0.6mm\ndefinition = maker\n[metadata]\ntype = variant\n[values]\nmachine_nozzle_size = 0.6\n",
    ),
    (
        "quality/maker/standard.inst.cfg",
        "[general]\nname = Standard\ndefinition = maker_base\n[metadata]\ntype = quality\nquality_type = standard\n\
         global_quality = True\n[values]\nlayer_height = 0.2\n",
    ),
    (
        "quality/maker/fine.inst.cfg",
        "[general]\nname = Fine\ndefinition = maker_base\n[metadata]\ntype = quality\nquality_type = fine\n[values]\n\
         layer_height = 0.1\n",
    ),
    (
        "quality/maker/pla.inst.cfg",
        "[general]\nname = Standard\ndefinition = maker_base\n[metadata]\ntype = quality\nquality_type = standard\n\
         material = generic_pla\nvariant = 0.6mm\n[values]\nspeed_print = =line_width * 100\n",
    ),
    (
        "materials/generic_pla_175.xml.fdm_material",
        "<fdmmaterial><metadata><name><brand>Generic</brand><material>PLA</material><color>Generic</color></name></metadata>\
         <properties><diameter>1.75</diameter><density>1.24</density></properties><settings>\
         <setting key=\"print temperature\">205</setting></settings></fdmmaterial>",
    ),
    (
        "materials/thick.xml.fdm_material",
        "<fdmmaterial><metadata><name><brand>Thick</brand><material>PLA</material></name></metadata>\
         <properties><diameter>2.85</diameter></properties></fdmmaterial>",
    ),
];

fn presets(others: &[(&str, &str)]) -> (TempDir, Library) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in FILES.iter().chain(others) {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let library = Library::open(&[Source { path: folder.path().to_owned(), dialect: None }]);
    (folder, library)
}

#[test]
fn a_machine_has_its_nozzle_qualities_and_materials() {
    let (_folder, library) = presets(&[]);
    let printers: Vec<&str> =
        library.listed(Kind::Printer).into_iter().map(|listed| listed.name.as_str()).collect();
    assert_eq!(printers, ["Maker One"]);
    let chosen = library.choose("Maker One", None, None).unwrap();
    assert_eq!((chosen.print.name.as_str(), chosen.filament.name.as_str()), ("Standard", "Generic PLA"));
    assert_eq!(chosen.filaments, ["Generic PLA"], "the other is of another diameter");
    assert_eq!(chosen.config.dialect, Dialect::Cura);
    let fine = library.choose("Maker One", Some("Fine"), None).unwrap();
    assert_eq!(fine.config.number("layer_height"), Some(0.1));
}

#[test]
fn files_in_memory_are_as_good_as_a_folder() {
    let (folder, library) = presets(&[]);
    let [here, given] = [library, in_memory(folder.path())]
        .map(|library| library.choose("Maker One", Some("Fine"), None).unwrap());
    assert_eq!(given.config, here.config);
}

#[test]
fn formulas_are_worked_out_with_all_that_is_chosen() {
    let (_folder, library) = presets(&[]);
    let config = library.choose("Maker One", None, None).unwrap().config;
    for (key, value) in [
        ("bed_shape", "-110x-50,110x-50,110x50,-110x50"),
        ("nozzle_diameter", "0.6"),
        ("extrusion_width", "0.6"),
        ("external_perimeter_speed", "30"),
        ("temperature", "205"),
        ("bed_temperature", "65"),
        ("filament_diameter", "1.75"),
        ("machine_max_feedrate_x", "500"),
        ("gcode_flavor", "marlin"),
        ("start_gcode", "M104 S{material_print_temperature}\\nG28"),
        ("filament_type", "PLA"),
        ("unheard_of", "7"),
    ] {
        assert_eq!(config.entries.get(key).map(|entry| entry.value.as_str()), Some(value), "{key}");
    }
    assert!(!config.entries.contains_key("machine_max_feedrate_y"), "no limit is none");
    assert_eq!(config.raw["material_print_temperature"].value, "205");
    assert_eq!(config.raw["machine_center_is_zero"].value, "True");
}

#[test]
fn a_formula_that_is_not_understood_is_told_by_name() {
    let (_folder, library) = presets(&[]);
    let config = library.choose("Maker One", None, None).unwrap().config;
    let entry = &config.entries["strange"];
    assert!(entry.value.starts_with("= [x for x in y] ("), "{}", entry.value);
    assert!(entry.place.to_string().contains("maker_base.def.json:4"), "{}", entry.place);
    assert!(!config.raw.contains_key("strange"), "scripts must not take a value that does not hold");
}

#[test]
fn a_missing_parent_and_a_circle_are_told() {
    let gone = (
        "definitions/maker.def.json",
        r#"{"name": "Gone", "inherits": "nowhere", "metadata": {"visible": true}}"#,
    );
    let error = presets(&[gone]).1.choose("Gone", None, None).unwrap_err().to_string();
    assert!(error.contains("maker.def.json:1 [Gone]: inherits from `nowhere`"), "{error}");
    let circle = ("definitions/maker_base.def.json", r#"{"name": "B", "inherits": "maker"}"#);
    let error = presets(&[circle]).1.choose("Maker One", None, None).unwrap_err().to_string();
    assert!(error.contains("inherits from itself"), "{error}");
}
