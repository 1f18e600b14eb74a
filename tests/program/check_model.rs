//! A print beside its model: the model is found wherever it stands.

use std::fs;
use std::path::PathBuf;

use crate::support::found::{beside, kinds};
use crate::support::mesh_shapes::{Facets, cuboid, stl};
use crate::support::print::{Print, run, standard};
use assert_cmd::cargo::cargo_bin_cmd;
use pathwright::check::{CheckReport, Kind};
use pathwright::job::Job;
use pathwright::mesh::{Mesh, Transform};
use pathwright::plate::{Line, read_file};
use pathwright::profile::Settings;

/// An angle with arms of 30 and 15 mm, and a hole in it.
fn angle() -> Facets {
    [cuboid([0.0; 3], [30.0, 8.0, 4.0]), cuboid([0.0, 0.0, 0.0], [8.0, 15.0, 4.0])].concat()
}

fn block() -> Facets {
    cuboid([50.0, 0.0, 0.0], [62.0, 7.0, 6.0])
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn file(&self, name: &str, facets: &Facets) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, stl(facets)).expect("written");
        path
    }
}

fn bodies(files: &[PathBuf], transform: &Transform) -> Vec<(String, Mesh)> {
    let line = Line { width_mm: 0.16, height_mm: 0.2 };
    let of_file =
        |file: &PathBuf| read_file(file, transform, line, 1).expect("a model").layout.standing_bodies();
    files.iter().flat_map(of_file).collect()
}

/// How often each body was found.
fn places(report: &CheckReport) -> Vec<(&str, u32)> {
    let placed = &report.model.as_ref().expect("compared").placed;
    placed.iter().map(|placed| (placed.name.as_str(), placed.turned_deg)).collect()
}

#[test]
fn copies_of_a_model_are_all_found() {
    let (folder, settings) = (Folder::new(), standard(&[]));
    let models = vec![folder.file("angle.stl", &angle())];
    let print = run(&Job::of(models.clone()).with_copies(5), &settings).expect("a print");
    let report = beside(&print.text, &bodies(&models, &Transform::default()), &settings);
    assert_eq!((kinds(&report), places(&report)), (vec![], vec![("angle", 0); 5]));
    let model = report.model.expect("compared");
    assert_eq!((model.missing_islands, model.islands), (0, 5 * 20));
}

#[test]
fn models_are_found_one_by_one_wherever_they_were_arranged_and_however_they_were_turned() {
    let folder = Folder::new();
    let models = vec![folder.file("angle.stl", &angle()), folder.file("block.stl", &block())];
    for set in ["plate.turn=false", "plate.turn=true"] {
        let settings = standard(&[set, "bed.size=[60,45]"]);
        let job = Job::of(models.clone()).with_copies(2);
        let print = run(&job, &settings).expect("a print");
        let report = beside(&print.text, &bodies(&models, &Transform::default()), &settings);
        assert_eq!((kinds(&report), places(&report).len()), (vec![], 4), "{set}: {report}");
    }
    // The model itself turned after it was exported.
    let settings = standard(&[]);
    let print = run(&Job::of(models[..1].to_vec()), &settings).expect("a print");
    let turned = Transform { rotate_deg: [0.0, 0.0, 90.0], ..Transform::default() };
    let report = beside(&print.text, &bodies(&models[..1], &turned), &settings);
    assert_eq!((kinds(&report), places(&report)), (vec![], vec![("angle", 270)]));
}

#[test]
fn a_part_that_is_missing_among_several_is_an_error_that_names_it() {
    let (folder, settings) = (Folder::new(), standard(&[]));
    let models = vec![folder.file("angle.stl", &angle()), folder.file("block.stl", &block())];
    let print = run(&Job::of(models[..1].to_vec()), &settings).expect("a print");
    let report = beside(&print.text, &bodies(&models, &Transform::default()), &settings);
    assert_eq!((kinds(&report), places(&report)), (vec![Kind::NotPlaced], vec![("angle", 0)]));
    assert!(report.faults[0].first[0].detail.starts_with("block: "), "{report}");
    assert_eq!(report.model.expect("compared").missing_islands, 0);
}

#[test]
fn a_model_among_others_is_found_and_the_others_are_told() {
    let (folder, settings) = (Folder::new(), standard(&[]));
    let models = vec![folder.file("angle.stl", &angle()), folder.file("block.stl", &block())];
    let print = run(&Job::of(models.clone()).with_copies(3), &settings).expect("a print");
    let report = beside(&print.text, &bodies(&models[1..], &Transform::default()), &settings);
    assert_eq!(
        (kinds(&report)[0], places(&report)),
        (Kind::ExtraMaterial, vec![("block", 0); 3]),
        "{report}"
    );
    assert_eq!(report.model.expect("compared").missing_islands, 0);
}

#[test]
fn a_grid_of_single_beads_is_found_by_its_beads() {
    let (folder, settings) = (Folder::new(), Settings::default());
    let bars = (0..5_u8).flat_map(|i| {
        let at = 5.0 * f32::from(i);
        [cuboid([at, 0.0, 0.0], [at + 0.45, 20.45, 0.6]), cuboid([0.0, at, 0.0], [20.45, at + 0.45, 0.6])]
            .concat()
    });
    let models = vec![folder.file("grid.stl", &bars.collect())];
    let print = run(&Job::of(models.clone()), &settings).expect("a print");
    let report = beside(&print.text, &bodies(&models, &Transform::default()), &settings);
    assert_eq!((kinds(&report), places(&report)), (vec![], vec![("grid", 0)]), "{report}");
    // Another model is not there.
    let other = vec![folder.file("block.stl", &block())];
    let report = beside(&print.text, &bodies(&other, &Transform::default()), &settings);
    assert_eq!(kinds(&report), vec![Kind::NotPlaced], "{report}");
}

#[test]
fn a_sheet_that_only_the_middle_of_a_layer_has_is_not_outside_of_the_model() {
    let (folder, settings) = (Folder::new(), Settings::default());
    let hollow = |low: f32, high: f32| {
        let facets = cuboid([4.0, 4.0, low], [12.0, 12.0, high]);
        facets.into_iter().map(|[a, b, c]| [a, c, b]).collect::<Facets>()
    };
    // Cut at 5.1 mm, between 5 and 5.2 mm.
    let facets = [cuboid([0.0; 3], [16.0, 16.0, 8.0]), hollow(3.0, 5.08), hollow(5.12, 7.0)].concat();
    let models = vec![folder.file("hollow.stl", &facets)];
    let print = run(&Job::of(models.clone()), &settings).expect("a print");
    let report = beside(&print.text, &bodies(&models, &Transform::default()), &settings);
    assert_eq!(kinds(&report), vec![], "{report}");
    assert!(String::from_utf8_lossy(&print.text).contains(";TYPE:Bridge infill"));
    assert_eq!(report.model.expect("compared").extra_mm, 0.0);
}

#[test]
fn a_print_in_mid_air_is_found_and_compared() {
    let (folder, settings) = (Folder::new(), standard(&[]));
    let post = cuboid([50.0, 0.0, 0.0], [60.0, 10.0, 12.0]);
    let mut raised = angle();
    raised.iter_mut().flatten().for_each(|p| p[2] += 3.0);
    let both = vec![folder.file("both.stl", &[raised, post].concat())];
    let job = Job { allow_floating: true, ..Job::of(both.clone()) };
    let print = run(&job, &settings).expect("a print");
    let report = beside(&print.text, &bodies(&both, &Transform::default()), &settings);
    assert!(
        kinds(&report).contains(&Kind::FloatingIsland) && kinds(&report).contains(&Kind::OverAir),
        "{report}"
    );
    assert_eq!(report.model.expect("compared").missing_islands, 0);
    // All of it: nothing but the skirt is beneath.
    let text = String::from_utf8(
        run(&Job { models: vec![folder.file("angle.stl", &angle()).into()], ..Job::default() }, &settings)
            .expect("a print")
            .text,
    );
    let lifted: Vec<String> = text.expect("UTF-8").lines().map(lifted).collect();
    let print = Print { text: lifted.join("\n").into_bytes(), summary: print.summary };
    let model = bodies(&[folder.file("angle.stl", &angle())], &Transform::default());
    let report = beside(&print.text, &model, &settings);
    assert!(kinds(&report).contains(&Kind::StartsInAir), "{report}");
    let model = report.model.expect("compared");
    assert_eq!((model.missing_islands, model.extra_mm), (0, 0.0));
    assert!((model.placed_at_mm.expect("found")[2] - 3.0).abs() < 1e-6);
}

/// A line of a print with its Z 3 mm higher.
fn lifted(line: &str) -> String {
    let word = |word: &str| match word.strip_prefix('Z').and_then(|z| z.parse::<f64>().ok()) {
        Some(z) => format!("Z{:.3}", z + 3.0),
        None => word.to_owned(),
    };
    match line.strip_prefix(";Z:").and_then(|z| z.parse::<f64>().ok()) {
        Some(z) => format!(";Z:{:.2}", z + 3.0),
        None => line.split(' ').map(word).collect::<Vec<_>>().join(" "),
    }
}

#[test]
fn a_model_that_is_not_in_the_print_ends_with_an_error_and_its_exit_code() {
    let (folder, settings) = (Folder::new(), standard(&[]));
    let models = vec![folder.file("angle.stl", &angle())];
    let print = run(&Job::of(models), &settings).expect("a print");
    let file = folder.0.path().join("print.gcode");
    fs::write(&file, &print.text).expect("written");
    let other = folder.file("other.stl", &cuboid([0.0; 3], [80.0, 70.0, 4.0]));
    let done = cargo_bin_cmd!("pathwright").arg("check").arg(&file).arg("--model").arg(&other).output();
    let done = done.expect("runs");
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(7), "{said}");
    assert!(said.contains("not-placed") && said.contains("other: its walls are nowhere"), "{said}");
}
