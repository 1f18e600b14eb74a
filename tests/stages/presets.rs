//! Presets of other slicers: found, fitted, resolved.

use std::fs;
use std::path::Path;

use pathwright::presets::{Chosen, Dialect, Files, Kind, Library, Source, is_preset_file};
use pathwright::profile::{Import, resolve_presets};
use proptest::prelude::*;
use tempfile::TempDir;

const VENDOR: &str = r#"
[vendor]
name = Acme

[printer_model:A1]
name = Acme One
variants = 0.4; 0.6

[printer:*common*]
bed_shape = 0x0,200x0,200x180,0x180
gcode_flavor = marlin2
retract_length = 0.80
printer_notes = FAST\nNO_TEMPLATES
default_print_profile = 0.2 mm
default_filament_profile = "PLA"

[printer:Acme 0.4]
inherits = *common*
printer_model = A1
nozzle_diameter = 0.4
renamed_from = "Acme"

[printer:Acme 0.6]
inherits = *common*
printer_model = A1
nozzle_diameter = 0.6

[printer:Acme five]
inherits = Acme 0.4
nozzle_diameter = 0.4,0.4,0.4,0.4,0.4
printer_model = A5
default_print_profile = gone

[printer:Acme resin]
printer_technology = SLA

[print:*common*]
layer_height = 0.20
perimeters = 3
compatible_printers_condition = printer_notes=~/.*FAST.*/ and nozzle_diameter[0]==0.4

[print:0.1 mm]
inherits = *common*
layer_height = 0.1

[print:0.2 mm]
inherits = *common*

[print:0.3 mm]
inherits = *common*
layer_height = 0.3
compatible_printers_condition =
compatible_printers = Acme 0.6;"Acme five"

[filament:*common*]
temperature = 210
filament_type = PLA
filament_retract_length = nil

[filament:PLA]
inherits = *common*
compatible_printers_condition = num_extruders < 9

[filament:PLA fine]
inherits = *common*
temperature = 215
compatible_prints_condition = layer_height < 0.15
"#;

/// A folder as slicers keep theirs.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    }
    folder
}

fn open(paths: &[&Path]) -> Library {
    let sources: Vec<Source> =
        paths.iter().map(|path| Source { path: path.to_path_buf(), dialect: None }).collect();
    Library::open(&sources)
}

/// The presets of a folder, read from memory.
pub fn in_memory(folder: &Path) -> Library {
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if is_preset_file(&path.to_string_lossy()) {
                let bytes = fs::read(&path).unwrap();
                files.push((path, bytes));
            }
        }
    }
    Library::open_in(&Files::given(files), &[Source { path: folder.to_owned(), dialect: None }])
}

fn acme() -> (TempDir, Library) {
    let folder = folder(&[("vendor/Acme.ini", VENDOR)]);
    let library = open(&[folder.path()]);
    assert_eq!(library.problems(), []);
    (folder, library)
}

fn choose(
    library: &Library,
    printer: &str,
    print: Option<&str>,
    filament: Option<&str>,
) -> Result<Chosen, String> {
    library.choose(printer, print, filament).map_err(|error| error.to_string())
}

fn raw<'a>(chosen: &'a Chosen, key: &str) -> &'a str {
    &chosen.config.raw[key].value
}

#[test]
fn presets_that_are_not_meant_to_be_chosen_are_not_listed() {
    let (_folder, library) = acme();
    let names = |kind| library.listed(kind).iter().map(|listed| listed.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(Kind::Printer), ["Acme 0.4", "Acme 0.6", "Acme five"]);
    assert_eq!(names(Kind::Filament), ["PLA", "PLA fine"]);
}

#[test]
fn files_in_memory_are_as_good_as_a_folder() {
    let (folder, library) = acme();
    let chosen = |library: &Library| choose(library, "Acme 0.4", None, None).unwrap();
    assert_eq!(chosen(&in_memory(folder.path())).config, chosen(&library).config);
}

#[test]
fn what_fits_is_decided_by_lists_and_conditions() {
    let (_folder, library) = acme();
    let fine = choose(&library, "Acme 0.4", Some("0.1 mm"), None).unwrap();
    assert_eq!(fine.prints, ["0.1 mm", "0.2 mm"]);
    assert_eq!(fine.filaments, ["PLA", "PLA fine"]);
    let coarse = choose(&library, "Acme 0.6", None, None).unwrap();
    assert_eq!(coarse.prints, ["0.3 mm"]);
    assert_eq!(coarse.filaments, ["PLA"], "the other one is for thin layers");
}

#[test]
fn what_is_not_named_is_the_printers_choice_or_what_most_would_take() {
    let (_folder, library) = acme();
    let own = choose(&library, "Acme 0.4", None, None).unwrap();
    assert_eq!((own.print.name.as_str(), own.filament.name.as_str()), ("0.2 mm", "PLA"));
    assert_eq!(own.notes, Vec::<String>::new());
    let likest = choose(&library, "Acme five", None, None).unwrap();
    assert_eq!(likest.print.name, "0.2 mm", "layers half as high as the nozzle is wide");
    assert!(likest.notes[0].contains("`gone`, which the printer asks for"), "{:?}", likest.notes);
}

#[test]
fn the_filament_that_a_printer_asks_for_is_taken_where_none_of_its_vendor_says_that_it_fits() {
    let forgotten = VENDOR.replace("num_extruders < 9", "num_extruders == 9").replace("< 0.15", "< 0.01");
    let templates = "[vendor]\nname = Templates\n\n[filament:Any FLEX]\nfilament_type = FLEX\n";
    let folder = folder(&[("vendor/Acme.ini", forgotten.as_str()), ("vendor/Templates.ini", templates)]);
    let library = open(&[folder.path()]);
    let chosen = choose(&library, "Acme 0.4", None, None).unwrap();
    assert_eq!((chosen.filament.name.as_str(), chosen.filaments), ("PLA", vec!["Any FLEX".to_owned()]));
    assert!(chosen.notes[0].contains("`PLA`, which the printer asks for, does not say that it fits"));
}

#[test]
fn names_for_several_extruders_may_stand_between_the_same_quotes() {
    let folder = folder(&[("Acme.ini", VENDOR.replace("\"PLA\"", "\"PLA fine; PLA\"").as_str())]);
    let library = open(&[folder.path()]);
    assert_eq!(choose(&library, "Acme 0.4", Some("0.1 mm"), None).unwrap().filament.name, "PLA fine");
}

#[test]
fn scripts_may_name_the_presets() {
    let (_folder, library) = acme();
    let config = choose(&library, "Acme 0.4", None, None).unwrap().config;
    let variables = Import::of(&config).variables;
    let value =
        |name: &str| variables.iter().find(|(known, _)| known == name).map(|(_, value)| value.to_string());
    assert_eq!(value("print_preset").as_deref(), Some("\"0.2 mm\""));
    assert_eq!(value("filament_preset").as_deref(), Some("[\"PLA\"]"));
}

#[test]
fn a_choice_that_is_impossible_says_what_is_possible() {
    let (_folder, library) = acme();
    let unfit = choose(&library, "Acme 0.4", Some("0.3 mm"), None).unwrap_err();
    assert_eq!(unfit, "print preset `0.3 mm` is not for `Acme 0.4`; those that fit: `0.1 mm`, `0.2 mm`");
    let unknown = choose(&library, "Acmee 0.4", None, None).unwrap_err();
    assert!(unknown.contains("did you mean `Acme 0.4`"), "{unknown}");
    let other = choose(&library, "Acme 0.4", None, Some("wood")).unwrap_err();
    assert!(other.contains("there is no filament preset `wood`; those that fit: `PLA`"), "{other}");
}

#[test]
fn former_names_and_other_capitals_are_understood() {
    let (_folder, library) = acme();
    let former = choose(&library, "Acme", None, None).unwrap();
    assert_eq!(former.printer.name, "Acme 0.4");
    assert_eq!(former.notes, ["printer preset `Acme` is now called `Acme 0.4`"]);
    assert_eq!(choose(&library, "ACME FIVE", None, None).unwrap().printer.name, "Acme five");
}

#[test]
fn the_configuration_holds_for_all_extruders_and_is_taken_of_the_first() {
    let (_folder, library) = acme();
    let chosen = choose(&library, "Acme five", Some("0.2 mm"), None).unwrap();
    assert_eq!(raw(&chosen, "temperature"), "210,210,210,210,210");
    assert_eq!(raw(&chosen, "retract_length"), "0.8,0.8,0.8,0.8,0.8");
    assert_eq!(raw(&chosen, "filament_type"), "PLA;PLA;PLA;PLA;PLA");
    assert_eq!(raw(&chosen, "filament_settings_id"), "PLA;PLA;PLA;PLA;PLA");
    assert_eq!(chosen.config.number("temperature"), Some(210.0));
    assert_eq!(chosen.config.text("filament_type"), Some("PLA"));
    assert_eq!(chosen.config.text("filament_retract_length"), None);
}

#[test]
fn every_value_knows_its_preset_and_what_nobody_says_is_built_in() {
    let (_folder, library) = acme();
    let config = choose(&library, "Acme 0.4", None, None).unwrap().config;
    let place = |key: &str| config.entries[key].place.to_string();
    assert!(place("perimeters").ends_with("Acme.ini:39 [print:*common*]"), "{}", place("perimeters"));
    assert_eq!(
        (place("fill_density"), config.text("fill_density")),
        ("built into PrusaSlicer".into(), Some("20%"))
    );
    assert_eq!(config.dialect, Dialect::Prusa);
}

#[test]
fn presets_become_settings_between_the_default_profile_and_the_others() {
    let (_folder, library) = acme();
    let config = choose(&library, "Acme 0.4", None, None).unwrap().config;
    let resolved = resolve_presets(&config, &["petg".into()], &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(resolved.settings.bed.size.map(|mm| mm.0), [200.0, 180.0]);
    assert_eq!(resolved.settings.retract.length.0, 0.8);
    assert_eq!(resolved.settings.filament.material, "PETG", "a profile wins over presets");
    assert!(resolved.origins["retract.length"].to_string().contains("[printer:*common*]"));
    let left = Import::of(&config).left;
    assert!(left.iter().all(|left| !left.place.is_built_in()), "{left:?}");
}

#[test]
fn a_users_preset_wins_over_a_vendors_and_is_of_its_vendor() {
    let mine = "# generated\ninherits = Acme 0.4\nretract_length = 2\n";
    let folder =
        folder(&[("vendor/Acme.ini", VENDOR), ("printer/Acme 0.4.ini", mine), ("printer/Mine.ini", mine)]);
    let library = open(&[folder.path()]);
    for name in ["Acme 0.4", "Mine"] {
        let chosen = choose(&library, name, None, None).unwrap();
        assert!(chosen.printer.is_user);
        assert_eq!(chosen.config.number("retract_length"), Some(2.0));
        assert_eq!(chosen.config.number("nozzle_diameter"), Some(0.4), "of its parent");
        assert_eq!(chosen.prints, ["0.1 mm", "0.2 mm"]);
        assert_eq!(chosen.notes.len(), usize::from(name == "Acme 0.4"), "{:?}", chosen.notes);
    }
}

#[test]
fn of_two_sources_the_first_is_taken_and_the_other_named() {
    let other = VENDOR.replace("retract_length = 0.80", "retract_length = 9");
    let (one, two) = (folder(&[("a.ini", VENDOR)]), folder(&[("b.ini", &other)]));
    let first = open(&[one.path(), two.path()]);
    let chosen = choose(&first, "Acme 0.4", None, None).unwrap();
    assert_eq!(chosen.config.number("retract_length"), Some(0.8));
    assert!(
        chosen.notes[0].contains("a.ini, not from ") && chosen.notes[0].ends_with("b.ini"),
        "{:?}",
        chosen.notes
    );
    let second = open(&[&two.path().join("b.ini"), one.path()]);
    assert_eq!(choose(&second, "Acme 0.4", None, None).unwrap().config.number("retract_length"), Some(9.0));
}

#[test]
fn presets_of_one_vendor_are_not_for_printers_of_another() {
    let rival = "[vendor]\nname = Rival\n[printer:R]\nnozzle_diameter = 0.4\n[print:R]\n[filament:R]\n";
    let templates = "[vendor]\nname = Templates\n[filament:Any]\ntemperature = 200\n";
    let folder = folder(&[("Acme.ini", VENDOR), ("Rival.ini", rival), ("Templates.ini", templates)]);
    let chosen = choose(&open(&[folder.path()]), "R", None, None).unwrap();
    assert_eq!(chosen.prints, ["R"]);
    assert_eq!(chosen.filaments, ["Any", "R"], "templates are for all");
}

#[test]
fn a_preset_of_superslicer_says_what_it_says_there_in_prusaslicers_words() {
    let text = "[vendor]\n[printer:S]\nnozzle_diameter = 0.4\nextruder_temperature_offset = 5\n\
                start_gcode = M104 S{first_layer_temperature[0]+extruder_temperature_offset[0]}\n\
                [print:S]\nfirst_layer_size_compensation = -0.1\nperimeters = 2\nperimeter_speed = 60\n\
                thick_bridges = 0\nmin_fan_speed = 20\n\
                [filament:S]\ntemperature = 200\nfirst_layer_temperature = 205\n";
    let folder = folder(&[("s.ini", text)]);
    let chosen = choose(&open(&[folder.path()]), "S", None, None).unwrap();
    let config = &chosen.config;
    assert_eq!(config.dialect, Dialect::Super);
    assert_eq!(config.number("temperature"), Some(205.0), "the hot end needs more");
    assert_eq!(raw(&chosen, "temperature"), "200", "its scripts add that themselves");
    assert_eq!(config.number("external_perimeter_speed"), Some(30.0), "half as fast where nobody says more");
    assert_eq!(config.number("fill_density"), None, "a percentage");
    assert_eq!(config.text("fill_density"), Some("18%"), "and built in there");
    assert_eq!(config.text("seam_position"), Some("cost"));
    assert_eq!(config.flag("thick_bridges"), Some(false), "by the key that it had before");
    let settings = resolve_presets(config, &[], &[]).unwrap().settings;
    assert_eq!(settings.layer.elephant_foot.0, 0.1);
    assert_eq!(settings.first_layer.width.0, 0.56, "140 % of the nozzle");
}

proptest! {
    #[test]
    fn no_bundle_makes_it_panic_or_hang(lines in prop::collection::vec(line(), 0..60)) {
        let folder = folder(&[("x.ini", &lines.join("\n"))]);
        let library = open(&[folder.path()]);
        for printer in library.listed(Kind::Printer) {
            if let Ok(chosen) = library.choose(&printer.name, None, None) {
                let _ = resolve_presets(&chosen.config, &[], &[]);
            }
        }
    }
}

/// Lines of bundles, few names, so that they refer to each other.
fn line() -> impl Strategy<Value = String> {
    let kind = prop_oneof![Just("printer"), Just("print"), Just("filament")];
    let name = prop_oneof![Just("a"), Just("b"), Just("*c*")];
    let value = prop_oneof![
        "[a-c](; ?[*a-c]{1,3}){0,2}",
        "[0-9.,%x;\"\\\\ -]{0,12}",
        Just("nozzle_diameter[0]==0.4 and printer_notes=~/.*(x/".to_owned()),
        "\\PC{0,12}",
    ];
    let key = prop_oneof![
        Just("inherits"),
        Just("nozzle_diameter"),
        Just("retract_length"),
        Just("bed_shape"),
        Just("filament_notes"),
        Just("start_gcode"),
        Just("renamed_from"),
        Just("compatible_printers"),
        Just("compatible_printers_condition"),
        Just("default_print_profile"),
    ];
    prop_oneof![
        1 => (kind, name).prop_map(|(kind, name)| format!("[{kind}:{name}]")),
        3 => (key, value).prop_map(|(key, value)| format!("{key} = {value}")),
    ]
}
