//! Presets of Cura: small ones, written here.

use std::fs;
use std::io::Write;
use std::path::Path;

use pathwright::presets::{Config, Dialect, Kind, Library, Source};
use tempfile::TempDir;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

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

const DUAL: &[(&str, &str)] = &[
    (
        "definitions/dual.def.json",
        r#"{"name": "Dual", "inherits": "maker_base", "metadata": {"visible": true, "quality_definition": "maker_base",
"machine_extruder_trains": {"0": "dual_left", "1": "dual_right"}}, "overrides": {"machine_extruder_count": {"default_value": 2},
"material_standby_temperature": {"default_value": 150}, "prime_tower_enable": {"default_value": true},
"prime_tower_size": {"default_value": 25}, "support_extruder_nr": {"default_value": 1}, "wall_extruder_nr": {"default_value": -1},
"machine_start_gcode": {"default_value": "M104 T1 S{material_print_temperature, 1}\nT{initial_extruder_nr}"}}}"#,
    ),
    (
        "extruders/dual_left.def.json",
        r#"{"name": "L", "inherits": "fdmextruder", "overrides": {"material_diameter": {"default_value": 1.75},
"machine_nozzle_offset_x": {"default_value": 0}, "machine_extruder_end_code": {"default_value": ""},
"machine_extruder_start_code": {"default_value": "G1 X5 ; left\nG1 X6"}}}"#,
    ),
    (
        "extruders/dual_right.def.json",
        r#"{"name": "R", "inherits": "fdmextruder", "overrides": {"extruder_nr": {"default_value": 1},
"material_diameter": {"default_value": 1.75}, "machine_nozzle_offset_x": {"default_value": 18},
"machine_extruder_start_code": {"default_value": "G1 X7 ; right"}, "machine_extruder_end_code": {"default_value": "G1 X8"},
"speed_print": {"default_value": 40}}}"#,
    ),
];

#[test]
fn a_machine_with_several_extruders_has_the_settings_of_each() {
    let (_folder, library) = presets(DUAL);
    let config = library.choose("Dual", None, None).unwrap().config;
    assert_eq!(config.extruders(), 2);
    let said = |extruder: usize, key: &str| config.of_extruder(extruder).text(key).map(str::to_owned);
    for (key, values) in [
        ("nozzle_diameter", ["0.4", "0.4"]),
        ("extruder_offset", ["0x0", "18x0"]),
        ("idle_temperature", ["150", "150"]),
        ("support_material_extruder", ["2", "2"]),
        ("perimeter_extruder", ["0", "0"]),
        ("wipe_tower", ["1", "1"]),
        ("wipe_tower_width", ["25", "25"]),
    ] {
        assert_eq!(
            [0, 1].map(|extruder| said(extruder, key)),
            values.map(|value| Some(value.into())),
            "{key}"
        );
    }
    assert_eq!(
        [0, 1].map(|extruder| config.of_extruder(extruder).script("start_filament_gcode")),
        ["G1 X5 ; left\nG1 X6\n", "G1 X7 ; right\n"]
    );
    assert_eq!(config.of_extruder(1).script("end_filament_gcode"), "G1 X8\n");
    assert_eq!(config.script("start_gcode"), "M104 T1 S{material_print_temperature[1]}\nT{initial_tool}\n");
    assert_eq!(
        (config.raw["extruder_nr"].value.as_str(), config.raw["speed_print"].value.as_str()),
        ("0,1", "80,40")
    );
}

#[test]
fn a_machine_that_uses_one_of_its_extruders_has_one() {
    let one = DUAL[0].1.replace(
        r#""machine_extruder_count": {"default_value": 2}"#,
        r#""machine_extruder_count": {"default_value": 1}"#,
    );
    let (_folder, library) = presets(&[(DUAL[0].0, &one), DUAL[1], DUAL[2]]);
    let config = library.choose("Dual", None, None).unwrap().config;
    assert_eq!(
        (config.extruders(), config.text("wipe_tower"), config.text("extruder_offset")),
        (1, None, None)
    );
    assert_eq!(config.script("start_gcode"), "M104 T1 S{material_print_temperature}\nT{initial_tool}\n");
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

/// What Cura keeps of a machine that its user has added, with a profile and values set since.
const ADDED: &[(&str, &str)] = &[
    (
        "machine_instances/My+Maker.global.cfg",
        "[general]\nversion = 5\nname = My Maker\nid = My Maker\n\n[metadata]\ntype = machine\n\n[containers]\n\
         0 = My Maker_user\n1 = maker_mine\n2 = empty_intent\n3 = standard\n4 = empty_material\n5 = empty_variant\n\
         6 = My Maker_settings\n7 = maker\n",
    ),
    (
        "extruders/maker_extruder+%232.extruder.cfg",
        "[general]\nversion = 5\nname = Extruder 1\nid = maker_extruder #2\n\n[metadata]\ntype = extruder_train\n\
         machine = My Maker\nposition = 0\n\n[containers]\n0 = maker_extruder #2_user\n1 = maker_extruder_#2_mine\n\
         2 = empty_intent\n3 = pla\n4 = my_plastic_maker_0.8mm\n5 = maker_0.8\n6 = empty_definition_changes\n\
         7 = maker_extruder\n",
    ),
    (
        "variants/maker_0.8.inst.cfg",
        "[general]\nname = 0.8mm\ndefinition = maker\n[metadata]\ntype = variant\n[values]\nmachine_nozzle_size = 0.8\n",
    ),
    (
        "definition_changes/My+Maker_settings.inst.cfg",
        "[general]\nname = My Maker_settings\ndefinition = maker\n[metadata]\ntype = definition_changes\n[values]\n\
         machine_start_gcode = G28\n\t; level\n\t\n\tG29\nmachine_width = 300.0\n",
    ),
    (
        "quality_changes/maker_mine.inst.cfg",
        "[general]\nname = Mine\ndefinition = maker_base\n[metadata]\ntype = quality_changes\nquality_type = standard\n\
         [values]\nlayer_height = 0.24\n",
    ),
    (
        "quality_changes/maker_extruder_%232_mine.inst.cfg",
        "[general]\nname = Mine\ndefinition = maker_base\n[metadata]\ntype = quality_changes\nquality_type = standard\n\
         position = 0\n[values]\nspeed_print = =line_width * 50\n",
    ),
    (
        "user/maker_extruder+%232_user.inst.cfg",
        "[general]\nname = maker_extruder #2_user\n[metadata]\ntype = user\n[values]\nspeed_wall_0 = 17\n",
    ),
    (
        "materials/my_plastic.xml.fdm_material",
        "<fdmmaterial><metadata><name><brand>My</brand><material>PLA</material></name></metadata>\
         <properties><diameter>1.75</diameter></properties><settings>\
         <setting key=\"print temperature\">199</setting></settings></fdmmaterial>",
    ),
];

#[test]
fn a_machine_that_a_user_has_added_prints_as_it_is_set() {
    let (folder, library) = presets(ADDED);
    let first = library.listed(Kind::Printer)[0];
    assert_eq!((first.name.as_str(), first.is_user), ("My Maker", true));
    let set = library.choose("My Maker", None, None).unwrap();
    assert_eq!((set.print.name.as_str(), set.filament.name.as_str()), ("as set in Cura", "My PLA"));
    assert_eq!(set.prints, ["as set in Cura", "Mine", "Fine", "Standard", "as defined"]);
    for (key, value) in [
        ("bed_shape", "-150x-50,150x-50,150x50,-150x50"),
        ("nozzle_diameter", "0.8"),
        ("layer_height", "0.24"),
        ("external_perimeter_speed", "17"),
        ("temperature", "199"),
        ("start_gcode", "G28\\n; level\\n\\nG29"),
    ] {
        assert_eq!(set.config.text(key), Some(value), "{key}");
    }
    assert_eq!(set.config.raw["speed_print"].value, "40", "of the extruder's profile, its own nozzle");
    assert_eq!(in_memory(folder.path()).choose("My Maker", None, None).unwrap().config, set.config);
}

#[test]
fn without_its_definition_an_added_machine_says_what_to_name() {
    let alone = tempfile::tempdir().unwrap();
    let path = alone.path().join(ADDED[0].0);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, ADDED[0].1).unwrap();
    let library = Library::open(&[Source { path: alone.path().to_owned(), dialect: None }]);
    let error = library.choose("My Maker", None, None).unwrap_err().to_string();
    assert!(error.contains("the definition `maker`") && error.contains("folder of resources"), "{error}");
}

#[test]
fn a_users_profile_is_on_top_of_the_quality_that_it_was_made_from() {
    let (_folder, library) = presets(ADDED);
    let speed = |print| {
        let chosen = library.choose("My Maker", Some(print), None).unwrap();
        ["layer_height", "external_perimeter_speed"].map(|key| chosen.config.number(key).unwrap())
    };
    assert_eq!(speed("Mine"), [0.24, 20.0], "what was not saved is not there");
    assert_eq!(speed("Fine"), [0.1, 40.0]);
    let vendors = library.choose("Maker One", Some("Mine"), None).unwrap();
    assert_eq!(vendors.config.number("nozzle_diameter"), Some(0.6));
    assert_eq!(vendors.config.number("layer_height"), Some(0.24));
}

fn packed(path: &Path, parts: &[(&str, &str)]) {
    let mut package = ZipWriter::new(fs::File::create(path).unwrap());
    for (name, text) in parts {
        package.start_file(*name, SimpleFileOptions::default()).unwrap();
        package.write_all(text.as_bytes()).unwrap();
    }
    package.finish().unwrap();
}

#[test]
fn an_exported_profile_is_a_print_preset() {
    let (folder, _) = presets(&[]);
    let profile = folder.path().join("Swift.curaprofile");
    let changes = |more: &str| {
        format!(
            "[general]\nname = Swift\ndefinition = maker_base\n[metadata]\ntype = quality_changes\nquality_type = fine\n{more}"
        )
    };
    packed(
        &profile,
        &[
            ("maker_swift", &changes("[values]\nlayer_height = 0.12\n")),
            ("maker_extruder_swift", &changes("position = 0\n[values]\nspeed_print = 120\n")),
            ("maker_extruder_1_swift", &changes("position = 1\n[values]\nspeed_print = 7\n")),
        ],
    );
    let elsewhere = tempfile::tempdir().unwrap();
    let moved = elsewhere.path().join("Swift.curaprofile");
    fs::rename(&profile, &moved).unwrap();
    let sources = [folder.path(), &moved].map(|path| Source { path: path.to_owned(), dialect: None });
    let chosen = Library::open(&sources).choose("Maker One", Some("Swift"), None).unwrap();
    assert_eq!(chosen.config.number("layer_height"), Some(0.12));
    assert_eq!(chosen.config.number("external_perimeter_speed"), Some(60.0));
    fs::write(&moved, "PK and no more").unwrap();
    let broken = Library::open(&sources).choose("Maker One", Some("Swift"), None).unwrap_err().to_string();
    assert!(broken.contains("Swift.curaprofile") && broken.contains("export it again"), "{broken}");
}

#[test]
fn a_project_of_cura_holds_the_machine_as_it_was_set() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("part.3mf");
    // Definitions are saved with all that they inherit, labels are names and values texts.
    let machine = r#"{"name": "Maker One", "version": 2, "metadata": {"visible": true}, "settings": {"machine": {"label": "machine",
"type": "category", "children": {
"machine_width": {"label": "machine_width", "default_value": "220", "children": {}},
"machine_depth": {"label": "machine_depth", "default_value": "210", "children": {}},
"machine_height": {"label": "machine_height", "default_value": "100", "children": {}},
"machine_heated_bed": {"label": "machine_heated_bed", "default_value": "True", "children": {}},
"machine_nozzle_size": {"label": "machine_nozzle_size", "default_value": "0.4", "children": {}},
"layer_height": {"label": "layer_height", "default_value": "0.1", "children": {}},
"default_material_print_temperature": {"label": "default_material_print_temperature", "default_value": "210", "children": {}},
"material_print_temperature": {"label": "material_print_temperature", "default_value": "210",
"value": "=default_material_print_temperature", "children": {}},
"line_width": {"label": "line_width", "default_value": "0.4", "value": "=machine_nozzle_size * 1.1", "children": {}},
"speed_print": {"label": "speed_print", "default_value": "60", "children": {"speed_wall_0": {"label": "speed_wall_0",
"default_value": "30", "value": "=speed_print / 2", "children": {}}}}}}}}"#;
    let extruder = r#"{"name": "E", "version": 2, "metadata": {}, "settings": {"extruder_nr": {"label": "extruder_nr",
"default_value": "0", "children": {}}}}"#;
    let saved = ADDED.iter().map(|(name, text)| {
        let name = name.rsplit('/').next().unwrap().replace('+', " ").replace("%23", "#");
        (format!("Cura/{name}"), *text)
    });
    let mut parts: Vec<(String, &str)> = saved.collect();
    parts.push(("Cura/maker.def.json".into(), machine));
    parts.push(("Cura/maker_extruder.def.json".into(), extruder));
    parts.push(("Cura/standard.inst.cfg".into(), FILES[7].1));
    let named: Vec<(&str, &str)> = parts.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    packed(&project, &named);
    let config = Config::read(&project).unwrap();
    for (key, value) in [
        ("bed_shape", "0x0,300x0,300x210,0x210"),
        ("nozzle_diameter", "0.8"),
        ("extrusion_width", "0.88"),
        ("layer_height", "0.24"),
        ("external_perimeter_speed", "17"),
        ("temperature", "199"),
    ] {
        assert_eq!(config.text(key), Some(value), "{key}");
    }
}
