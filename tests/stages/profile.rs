//! Profiles as users write them: what is embedded, what is refused, and what the messages say.

use std::fs;

use pathwright::gcode::{PrintFacts, Scripts};
use pathwright::profile::{self, EMBEDDED, Override, Pattern, ProfileKind, Settings, SingleOnTop, resolve};

fn set(key: &str, value: &str) -> Override {
    Override { key: key.into(), value: value.into(), option: "--set" }
}

/// The lines of the error that these profiles and settings give.
fn problems(profiles: &[&str], sets: &[(&str, &str)]) -> Vec<String> {
    let profiles: Vec<String> = profiles.iter().map(ToString::to_string).collect();
    let sets: Vec<Override> = sets.iter().map(|(key, value)| set(key, value)).collect();
    let error = resolve(&profiles, &sets).expect_err("must be refused");
    error.to_string().lines().map(str::to_owned).collect()
}

fn settings(profiles: &[&str], sets: &[(&str, &str)]) -> Settings {
    let profiles: Vec<String> = profiles.iter().map(ToString::to_string).collect();
    let sets: Vec<Override> = sets.iter().map(|(key, value)| set(key, value)).collect();
    resolve(&profiles, &sets).unwrap_or_else(|error| panic!("{error}")).settings
}

/// A profile file in a folder of its own.
fn file(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// The dotted keys that a profile's own text sets.
fn keys_written(text: &str) -> Vec<String> {
    let table: toml::Table = text.parse().unwrap();
    let sections = table.iter().filter_map(|(section, value)| Some((section, value.as_table()?)));
    sections.flat_map(|(section, keys)| keys.keys().map(move |key| format!("{section}.{key}"))).collect()
}

#[test]
fn every_embedded_profile_resolves_without_a_warning() {
    for profile in EMBEDDED {
        let resolved =
            resolve(&[profile.name.into()], &[]).unwrap_or_else(|e| panic!("{}: {e}", profile.name));
        assert_eq!(resolved.warnings, [], "{}", profile.name);
    }
}

#[test]
fn every_printer_goes_with_every_material_and_quality() {
    let named = |kind| EMBEDDED.iter().filter(move |p| p.kind == kind).map(|p| p.name.to_owned());
    for printer in named(ProfileKind::Printer) {
        for material in named(ProfileKind::Material) {
            for quality in named(ProfileKind::Quality) {
                let chosen = [printer.clone(), material.clone(), quality];
                let resolved = resolve(&chosen, &[]).unwrap_or_else(|e| panic!("{chosen:?}: {e}"));
                assert_eq!(resolved.warnings, [], "{chosen:?}");
            }
        }
    }
}

#[test]
fn the_default_profile_is_the_default_of_the_settings() {
    assert_eq!(settings(&[], &[]), Settings::default());
}

#[test]
fn the_default_profile_sets_every_key() {
    let origins = resolve(&[], &[]).unwrap().origins;
    let missing: Vec<String> =
        profile::keys().map(|(key, _)| key).filter(|k| !origins.contains_key(k)).collect();
    assert_eq!(missing, Vec::<String>::new());
}

#[test]
fn a_printer_a_material_and_a_quality_never_set_the_same_key() {
    let keys = |name| keys_written(profile::embedded(name).unwrap().text);
    let (printer, material, quality) = (keys("reprap-250"), keys("pla"), keys("0.2mm"));
    assert_eq!(printer.len() + material.len() + quality.len(), profile::keys().count());
    assert!(material.iter().all(|key| !printer.contains(key) && !quality.contains(key)));
    assert!(quality.iter().all(|key| !printer.contains(key)));
}

#[test]
fn profiles_of_one_kind_replace_each_other_whole() {
    for (kind, base) in [
        (ProfileKind::Printer, "reprap-250"),
        (ProfileKind::Material, "pla"),
        (ProfileKind::Quality, "0.2mm"),
    ] {
        for profile in EMBEDDED.iter().filter(|p| p.kind == kind) {
            assert_eq!(settings(&[profile.name, base], &[]), Settings::default(), "{}", profile.name);
        }
    }
}

#[test]
fn the_standard_job_sets_every_key_itself() {
    let written = keys_written(profile::embedded("standard-job").unwrap().text);
    let missing: Vec<String> = profile::keys().map(|(key, _)| key).filter(|k| !written.contains(k)).collect();
    assert_eq!(missing, Vec::<String>::new(), "a new setting needs its neutral value in standard-job");
}

#[test]
fn the_fast_standard_job_differs_in_walls_travel_and_cost_alone() {
    let sets = [
        ("walls.generator", "variable"),
        ("shell.fit_angle", "true"),
        ("travel.avoid_crossing", "true"),
        ("travel.max_detour", "20"),
        ("travel.retract_inside", "50"),
        ("order.cost", "time"),
    ];
    assert_eq!(settings(&["standard-job-fast"], &[]), settings(&["standard-job"], &sets));
}

#[test]
fn the_standard_job_is_as_defined() {
    let s = settings(&["standard-job"], &[]);
    assert_eq!((s.layer.height.0, s.layer.first_height.0), (0.2, 0.2));
    let widths = [s.walls.width, s.walls.external_width, s.shell.width, s.shell.top_width, s.infill.width];
    assert!(widths.iter().chain([&s.first_layer.width]).all(|width| width.0 == 0.45));
    assert_eq!((s.printer.nozzle_diameter.0, s.filament.diameter.0), (0.4, 1.75));
    assert_eq!((s.walls.count, s.walls.order.name()), (2, "inner-first"));
    assert_eq!(s.walls.generator.name(), "classic");
    assert_eq!((s.shell.top_layers, s.shell.bottom_layers), (4, 4));
    assert_eq!((s.infill.pattern.name(), s.infill.density.0), ("rectilinear", 0.2));
    assert_eq!((s.temperature.nozzle.0, s.temperature.nozzle_first_layer.0), (210.0, 210.0));
    let v = &s.speed;
    let print = [
        v.external_perimeter,
        v.perimeter,
        v.infill,
        v.solid,
        v.top,
        v.bridge,
        v.gap_fill,
        v.support,
        v.skirt,
    ];
    assert!(print.iter().all(|speed| speed.0 == 50.0));
    assert_eq!((s.first_layer.speed.0, v.travel.0), (20.0, 150.0));
    let a = &s.acceleration;
    assert_eq!([a.default.0, a.external_perimeter.0, a.travel.0, s.first_layer.acceleration.0], [3000.0; 4]);
    assert_eq!(s.machine.square_corner_velocity.0, 5.0);
    assert_eq!((s.retract.length.0, s.retract.speed.0, s.retract.min_travel.0), (1.0, 40.0, 1.5));
    assert_eq!((s.retract.z_hop.0, s.retract.wipe.0, s.gcode.arcs), (0.0, 0.0, false));
    assert_eq!((s.seam.position.name(), s.skirt.loops, s.skirt.distance.0), ("free", 1, 3.0));
    assert_eq!(s.cooling.min_layer_time.0, 0.0);
    assert_eq!((s.bed.size.map(|length| length.0), s.bed.height.0), ([250.0; 2], 250.0));
}

#[test]
fn every_bad_setting_gets_its_own_line_with_place_key_value_and_mend() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "mine.toml", "[walls]\ncuont = 3\n[infill]\ndensity = \"150%\"\n");
    let lines = problems(&[&path], &[("layer.hieght", "0.2")]);
    assert_eq!(lines.len(), 3, "{lines:#?}");
    let of = |text: &str| lines.iter().find(|line| line.contains(text)).unwrap_or_else(|| panic!("{text}"));
    let unknown = of("walls.cuont = 3");
    assert!(unknown.starts_with(&path) && unknown.contains("`walls.count`"), "{unknown}");
    let range = of("infill.density = \"150%\"");
    assert!(range.starts_with(&path) && range.contains("from 0 to 1"), "{range}");
    let option = of("layer.hieght = 0.2");
    assert!(option.starts_with("--set") && option.contains("`layer.height`"), "{option}");
}

#[test]
fn a_wrong_word_lists_the_words_and_the_nearest() {
    let lines = problems(&[], &[("infill.pattern", "gyriod")]);
    assert_eq!(lines.len(), 1);
    assert!(Pattern::NAMES.iter().all(|name| lines[0].contains(name)), "{}", lines[0]);
    assert!(lines[0].ends_with("did you mean `gyroid`?"), "{}", lines[0]);
}

#[test]
fn wrong_types_are_refused() {
    for (key, value) in [
        ("walls.count", "2.5"),
        ("walls.count", "-1"),
        ("walls.gap_fill", "1"),
        ("infill.angles", "45"),
        ("infill.angles", "[0, 400]"),
        ("infill.angles", "[0, true]"),
        ("layer.height", "true"),
        ("layer.height", "nan"),
        ("layer.height", "0.2mm"),
        ("bed.size", "[200]"),
        ("bed.size", "200"),
        ("infill.density", "lots%"),
        ("printer.name", "\"two\\nlines\""),
    ] {
        assert_eq!(problems(&[], &[(key, value)]).len(), 1, "{key}={value}");
    }
}

#[test]
fn typed_values_need_no_quotes() {
    let s = settings(
        &[],
        &[
            ("infill.density", "35%"),
            ("walls.order", "outer-first"),
            ("printer.name", "300"),
            ("bed.size", "[200, 180.5]"),
            ("gcode.arcs", "true"),
        ],
    );
    assert_eq!(s.infill.density.0, 0.35);
    assert_eq!(s.walls.order.name(), "outer-first");
    assert_eq!(s.printer.name, "300");
    assert_eq!(s.bed.size.map(|length| length.0), [200.0, 180.5]);
    assert!(s.gcode.arcs);
}

#[test]
fn the_later_source_wins_and_is_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path =
        file(&folder, "mine.toml", "inherits = \"petg\"\n[temperature]\nnozzle = 228\n[walls]\ncount = 5\n");
    let resolved = resolve(&["abs".into(), path.clone()], &[set("walls.count", "6")]).unwrap();
    let s = &resolved.settings;
    assert_eq!((s.filament.material.as_str(), s.temperature.nozzle.0, s.walls.count), ("PETG", 228.0, 6));
    let origin = |key: &str| resolved.origins[key].to_string();
    assert_eq!(origin("filament.material"), "profile petg");
    assert_eq!(origin("temperature.nozzle"), path);
    assert_eq!(origin("walls.count"), "--set");
    assert_eq!(origin("layer.height"), "profile 0.2mm");
}

#[test]
fn parents_are_found_beside_the_file_that_names_them() {
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "base.toml", "[walls]\ncount = 7\n");
    let path = file(&folder, "mine.toml", "inherits = [\"pla\", \"base.toml\"]\n");
    assert_eq!(settings(&[&path], &[]).walls.count, 7);
}

#[test]
fn a_circle_of_parents_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let a = file(&folder, "a.toml", "inherits = \"./b.toml\"\n");
    file(&folder, "b.toml", "inherits = \"./a.toml\"\n");
    let lines = problems(&[&a], &[]);
    assert_eq!(lines.len(), 1, "{lines:#?}");
    assert!(lines[0].contains("inherit in a circle") && lines[0].contains("b.toml"), "{}", lines[0]);
}

#[test]
fn a_profile_inherits_only_from_its_own_folder() {
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "base.toml", "[walls]\ncount = 7\n");
    fs::create_dir(folder.path().join("sub")).unwrap();
    let absolute = folder.path().join("base.toml").display().to_string();
    for parent in ["../base.toml", &absolute, "../sub/../base.toml"] {
        let mine = file(&folder, "sub/mine.toml", &format!("inherits = {parent:?}\n"));
        let lines = problems(&[&mine], &[]);
        assert!(lines.len() == 1 && lines[0].contains("not in this profile's folder"), "{lines:#?}");
    }
    let from_above = file(&folder, "top.toml", "inherits = \"sub/low.toml\"\n");
    file(&folder, "sub/low.toml", "[walls]\ncount = 8\n");
    assert_eq!(settings(&[&from_above], &[]).walls.count, 8);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&absolute, folder.path().join("sub/link.toml")).unwrap();
        let mine = file(&folder, "sub/mine.toml", "inherits = \"link.toml\"\n");
        assert!(problems(&[&mine], &[])[0].contains("not in this profile's folder"));
    }
}

#[test]
fn profiles_neither_nest_nor_multiply_without_end() {
    let folder = tempfile::tempdir().unwrap();
    for level in 0..40 {
        let next = level + 1;
        let text = format!("inherits = [\"p{next}.toml\", \"p{next}.toml\"]\n");
        file(&folder, &format!("p{level}.toml"), &text);
    }
    file(&folder, "p40.toml", "");
    let first = folder.path().join("p0.toml").display().to_string();
    let lines = problems(&[&first], &[]);
    assert!(lines.len() == 1 && lines[0].contains("too many profiles"), "{lines:#?}");
    let large = file(&folder, "large.toml", &"# much\n".repeat(200_000));
    assert!(problems(&[&large], &[])[0].contains("larger than 1 MB"));
}

#[test]
fn of_many_problems_the_first_hundred_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let keys: String = (0..40_000).map(|i| format!("speeed{i} = 1\n")).collect();
    let lines = problems(&[&file(&folder, "many.toml", &format!("[motion]\n{keys}"))], &[]);
    assert_eq!(lines.len(), 101);
    assert!(lines[100].ends_with("only the first 100 problems are listed"), "{}", lines[100]);
    let endless = problems(&[], &[(&"walls_count".repeat(100_000), "3")]);
    assert!(endless[0].contains("unknown key; `pathwright profiles dump` lists"), "{:.200}", endless[0]);
    assert!(endless[0].len() < 200, "{:.200}", endless[0]);
}

#[test]
fn texts_cannot_bring_commands_of_their_own() {
    for key in ["printer.name", "filament.material"] {
        for value in ["PLA\nM112", "PLA\rM112", "a\u{85}b\u{0}"] {
            assert!(problems(&[], &[(key, value)])[0].contains("a text of one line"), "{key} {value:?}");
        }
    }
    let mut settings = Settings::default();
    settings.filament.material = "PLA\nM112 ; {z_f}".into();
    let script = profile::expand("; {filament}\nG28", &settings, &PrintFacts::default()).unwrap();
    assert_eq!(script.lines().count(), 2, "{script}");
}

#[test]
fn an_unknown_profile_lists_the_known_ones_and_the_nearest() {
    let lines = problems(&["ptg"], &[]);
    assert!(lines[0].contains("did you mean `petg`?") && lines[0].contains("corexy-klipper"), "{}", lines[0]);
}

#[test]
fn an_unreadable_file_and_bad_toml_are_reported_together() {
    let folder = tempfile::tempdir().unwrap();
    let bad = file(&folder, "bad.toml", "[walls]\ncount = = 3\n");
    let lines = problems(&["missing/none.toml", &bad], &[]);
    assert_eq!(lines.len(), 2, "{lines:#?}");
    assert!(lines[0].contains("cannot read profile `missing/none.toml`"), "{}", lines[0]);
    assert!(lines[1].starts_with(&format!("{bad}: is not valid TOML: line 2:")), "{}", lines[1]);
}

#[test]
fn settings_that_contradict_each_other_are_refused() {
    for sets in [
        &[("walls.width", "0.1")][..],
        &[("layer.first_height", "0.45")],
        &[("layer.z_offset", "-0.3")],
        &[("bed.shape", "round"), ("bed.size", "[200, 210]")],
        &[("retract.wipe", "1"), ("retract.firmware", "true")],
        &[("cooling.fan_off_layers", "9")],
        &[("temperature.nozzle_first_layer", "0")],
        &[("order.layer_distance", "5"), ("order.chain", "false")],
        &[("brim.width", "90"), ("skirt.distance", "50")],
        &[("gcode.start", "M104 S{nozle_temp}")],
    ] {
        let lines = problems(&[], sets);
        assert_eq!(lines.len(), 1, "{sets:?}: {lines:#?}");
    }
}

#[test]
fn a_conflict_names_both_keys_and_where_each_was_written() {
    let lines = problems(&["0.3mm"], &[("infill.width", "0.25")]);
    assert_eq!(
        lines,
        ["--set: infill.width = 0.25: a line must be at least as wide as its layer is high; \
          with layer.height = 0.3 (profile 0.3mm)"]
    );
}

#[test]
fn high_layers_are_a_warning() {
    let resolved = resolve(&[], &[set("layer.height", "0.35")]).unwrap();
    assert_eq!(resolved.warnings.len(), 1);
    assert!(resolved.warnings[0].to_string().starts_with("--set: layer.height = 0.35: "));
}

#[test]
fn layers_that_cannot_be_ordered_together_are_a_warning() {
    let apart = set("order.layer_distance", "5");
    let resolved = resolve(&[], std::slice::from_ref(&apart)).unwrap();
    assert!(resolved.warnings[0].to_string().contains("one by one"), "{:?}", resolved.warnings);
    assert_eq!(resolve(&[], &[apart, set("order.strategy", "greedy")]).unwrap().warnings, []);
}

#[test]
fn a_dump_is_a_profile_that_means_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["default", "standard-job", "delta-round"] {
        let resolved = resolve(&[name.into()], &[]).unwrap();
        let path = file(&folder, "dump.toml", &profile::dump_toml(&resolved));
        assert_eq!(settings(&[&path], &[]), resolved.settings, "{name}");
    }
}

#[test]
fn a_dump_says_where_each_setting_came_from() {
    let resolved = resolve(&["petg".into()], &[set("walls.count", "2")]).unwrap();
    let dump = profile::dump_toml(&resolved);
    assert!(dump.contains("\ncount = 2 # --set\n"), "{dump}");
    assert!(dump.contains("\nmaterial = \"PETG\" # profile petg\n"), "{dump}");
    let json = profile::dump_json(&resolved);
    assert_eq!(json["walls.count"], serde_json::json!({ "value": 2, "origin": "--set" }));
    assert_eq!(json.as_object().unwrap().len(), profile::keys().count());
}

#[test]
fn every_number_has_a_range() {
    use pathwright::profile::Kind::{Choice, Flag, Text};
    let open: Vec<String> = profile::keys()
        .filter(|(_, field)| !matches!(field.kind, Choice(_) | Flag | Text) && field.range.is_none())
        .map(|(key, _)| key)
        .collect();
    assert_eq!(open, Vec::<String>::new());
}

#[test]
fn the_reference_page_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/settings.md");
    let page = fs::read_to_string(path).unwrap_or_default();
    assert!(page == profile::reference(), "run `cargo run -- profiles reference > docs/settings.md`");
}

#[test]
fn the_page_of_imports_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/import.md");
    let page = fs::read_to_string(path).unwrap_or_default();
    assert!(page == profile::import_page(), "run `cargo run -- profiles imports > docs/import.md`");
}

#[test]
fn another_slicers_configuration_is_a_profile_whose_lines_are_the_origins() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[print:fine]\nlayer_height = 0.1\nperimeters = 4\nperimeter_speed = 60\nexternal_perimeter_speed = 50%\n\
                [printer:mine]\nnozzle_diameter = 0.4\nbed_shape = 0x0,220x0,220x220,0x220\n\
                start_gcode = M104 S{first_layer_temperature[0]}\\nG28\nbetween_objects_gcode = M117\n\
                complete_objects = 1\ninfill_first = 1\n";
    let path = file(&folder, "config.ini", text);
    let resolved = resolve(std::slice::from_ref(&path), &[]).unwrap_or_else(|error| panic!("{error}"));
    let s = &resolved.settings;
    assert_eq!((s.layer.height.0, s.walls.count, s.bed.size[0].0), (0.1, 4, 220.0));
    assert_eq!(
        (s.speed.external_perimeter.0, s.gcode.start.as_str()),
        (30.0, "M104 S{first_layer_temperature[0]}\nG28\n")
    );
    assert_eq!(resolved.origins["layer.height"].to_string(), format!("{path}:2 [print:fine]"));
    assert_eq!(resolved.origins["speed.infill"].to_string(), "profile reprap-250", "not said");
    let note = resolved.warnings.iter().map(ToString::to_string).find(|w| w.contains("not taken over"));
    assert!(note.is_some_and(|note| note.contains(" 1 not taken over")), "{:?}", resolved.warnings);
    let shown = profile::text(&path).unwrap();
    assert!(shown.contains("# line 12: infill_first = 1: "), "{shown}");
    let mine = file(&folder, "mine.toml", &shown);
    assert_eq!(&settings(&[&mine], &[]), s, "what is shown means the same");
}

#[test]
fn walls_on_top_and_the_chamber_of_a_configuration_are_settings_here() {
    let folder = tempfile::tempdir().unwrap();
    let of = |text: &str| settings(&[&file(&folder, "config.ini", text)], &[]);
    for (theirs, ours) in
        [("none", SingleOnTop::None), ("top", SingleOnTop::Top), ("topmost", SingleOnTop::Topmost)]
    {
        let s = of(&format!("layer_height = 0.2\ntop_one_perimeter_type = {theirs}\n"));
        assert_eq!(s.walls.single_on_top, ours);
    }
    let s = of("layer_height = 0.2\nonly_one_perimeter_top = 1\nonly_one_perimeter_first_layer = 1\n\
                perimeter_extrusion_width = 0.5\nmin_width_top_surface = 200%\n\
                chamber_temperature = 45\nchamber_minimal_temperature = 40\n");
    assert_eq!((s.walls.single_on_top, s.walls.single_on_first_layer), (SingleOnTop::Top, true));
    let figures = [s.walls.min_top_width.0, s.temperature.chamber.0, s.temperature.chamber_min.0];
    assert_eq!(figures, [1.0, 45.0, 40.0]);
}

#[test]
fn a_script_with_an_unknown_name_is_refused_and_left_out_only_where_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let text = "layer_height = 0.2\nstart_gcode = G28\\nG1 Z{max_layr_z + 2}\nend_gcode = M84\\n\n";
    let path = file(&folder, "config.ini", text);
    let lines = problems(&[&path], &[]);
    let told = "line 2, column 6: unknown name `max_layr_z`; did you mean `max_layer_z`?";
    assert!(lines.len() == 1 && lines[0].contains("gcode.start") && lines[0].contains(told), "{lines:?}");
    let ignoring = settings(&[&path], &[("gcode.ignore_scripts", "true")]);
    assert_eq!((ignoring.gcode.start.lines().count(), ignoring.gcode.end.as_str()), (2, "M84\n"));
    let script = Scripts::new(&ignoring, &PrintFacts::default()).unwrap();
    assert_eq!(
        script,
        Scripts::new(&ignoring.set("gcode.start", "").unwrap(), &PrintFacts::default()).unwrap()
    );
}

#[test]
fn an_empty_script_of_a_configuration_stands_for_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "config.ini", "layer_height = 0.2\nstart_gcode = \n");
    assert_eq!(settings(&[&path], &[]).gcode.start, "");
}

#[test]
fn a_setting_that_is_given_later_is_what_scripts_of_a_preset_see() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "temperature = 215\nfirst_layer_temperature = 220\nprinter_notes = HAS_MMU\nstart_gcode = G28\n";
    let path = file(&folder, "config.ini", text);
    let seen = |sets: &[(&str, &str)]| {
        let s = settings(&[&path], sets);
        profile::expand(
            "{temperature[0]} {first_layer_temperature[0]} {printer_notes}",
            &s,
            &PrintFacts::default(),
        )
    };
    assert_eq!(seen(&[]).unwrap(), "215 220 HAS_MMU\n");
    assert_eq!(seen(&[("temperature.nozzle", "190")]).unwrap(), "190 220 HAS_MMU\n");
}

#[test]
fn what_is_no_configuration_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a.gcode", "G1 X1\n"), ("b.ini", "nothing\n"), ("c.ini", "")] {
        let path = file(&folder, name, text);
        assert!(problems(&[&path], &[])[0].starts_with(&path), "{name}");
    }
    assert!(problems(&["missing.ini"], &[])[0].contains("cannot be read"));
}

/// Every command that a script of an embedded profile may hold; Klipper's are words.
const COMMANDS: &[&str] = &[
    "G0",
    "G1",
    "G21",
    "G28",
    "G80",
    "G90",
    "G92",
    "M83",
    "M84",
    "M104",
    "M107",
    "M109",
    "M140",
    "M190",
    "M420",
    "BED_MESH_CALIBRATE",
];

/// Words of a line such as `G1 X3 E2`: command and arguments by letter.
fn words(line: &str) -> (&str, impl Fn(char) -> Option<f64> + '_) {
    let code = line.split(';').next().unwrap_or_default();
    let command = code.split_whitespace().next().unwrap_or_default();
    (command, move |letter| {
        code.split_whitespace().skip(1).find_map(|w| w.strip_prefix(letter)?.parse().ok())
    })
}

fn print() -> PrintFacts {
    PrintFacts { max_mm: [60.0; 2], max_z_mm: 40.0, layers: 200, ..PrintFacts::default() }
}

#[test]
fn start_scripts_heat_before_they_extrude_and_prime_inside_the_bed() {
    for profile in EMBEDDED {
        let s = settings(&[profile.name], &[]);
        let script = profile::expand(&s.gcode.start, &s, &print()).unwrap();
        let ([mut x, mut y], mut hot, mut homed, mut fed) = ([0.0, 0.0], false, false, 0.0);
        for line in script.lines() {
            let (command, word) = words(line);
            assert!(COMMANDS.contains(&command), "{}: {line}", profile.name);
            hot |= command == "M109" && word('S').is_some_and(|t| t >= 150.0);
            homed |= command == "G28";
            if !matches!(command, "G0" | "G1") {
                continue;
            }
            assert!(homed, "{}: moves before homing: {line}", profile.name);
            let before = [x, y];
            (x, y) = (word('X').unwrap_or(x), word('Y').unwrap_or(y));
            if let Some(e) = word('E') {
                assert!(hot && e > 0.0 && before != [x, y], "{}: {line}", profile.name);
                fed += e;
            }
            if word('X').is_some() {
                assert!(on_the_bed(&s, x, y), "{}: {line}", profile.name);
            }
        }
        assert!(
            fed > 3.0 || profile.name.starts_with("standard-job"),
            "{}: primes only {fed} mm",
            profile.name
        );
    }
}

#[test]
fn end_scripts_retract_lift_leave_and_switch_off() {
    for profile in EMBEDDED.iter().filter(|p| !p.name.starts_with("standard-job")) {
        let s = settings(&[profile.name], &[]);
        let script = profile::expand(&s.gcode.end, &s, &print()).unwrap();
        let place = |text: &str| script.find(text).unwrap_or_else(|| panic!("{}: no {text}", profile.name));
        let leaves = script.find("G28").unwrap_or_else(|| place("G0 X"));
        assert!(place("G1 E-") < place("G0 Z") && place("G0 Z") < leaves, "{script}");
        for off in ["M104 S0", "M140 S0", "M107", "M84"] {
            assert!(place(off) > leaves, "{script}");
        }
        for line in script.lines() {
            let (command, word) = words(line);
            assert!(COMMANDS.contains(&command), "{}: {line}", profile.name);
            assert!(word('Z').is_none_or(|z| z > print().max_z_mm && z <= s.bed.height.0), "{line}");
            if let (Some(x), Some(y)) = (word('X'), word('Y')) {
                assert!(on_the_bed(&s, x, y), "{}: {line}", profile.name);
            }
        }
    }
}

fn on_the_bed(s: &Settings, x: f64, y: f64) -> bool {
    let [width, depth] = s.bed.size.map(|length| length.0);
    let (x, y) = match s.bed.origin.name() {
        "center" => (x, y),
        _ => (x - width / 2.0, y - depth / 2.0),
    };
    match s.bed.shape.name() {
        "round" => x.hypot(y) < width / 2.0,
        _ => x.abs() < width / 2.0 && y.abs() < depth / 2.0,
    }
}
