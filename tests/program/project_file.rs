//! Project files: the same bytes as the project, a plate that other slicers open, and limits of unpacking.

use std::io::{Cursor, Write};
use std::path::Path;

use crate::support::print::{model, run};
use crate::support::program::{output, succeed};
use pathwright::job::{ModelFiles, Project};
use pathwright::mesh;
use pathwright::pipeline::Pipeline;
use pathwright::{Observer, Settings};

fn read(name: &str) -> (String, Vec<u8>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name);
    (name.to_owned(), std::fs::read(path).expect("a model"))
}

fn files(names: &[&str]) -> ModelFiles {
    let file = |name: &&str| {
        let (name, bytes) = read(name);
        let file = pathwright::job::ModelFile::read(&name, bytes, &Observer::none()).expect("a model");
        (name, file.into())
    };
    names.iter().map(file).collect()
}

fn saved(project: &Project, files: &ModelFiles) -> (Vec<u8>, Vec<u8>) {
    let settings: Settings = project.resolve(None).expect("sound").settings;
    let job = project.job(files, None).expect("a job");
    let file = Pipeline.project_file(project, files, &job, &settings, &Observer::none()).expect("a file");
    (file, run(&job, &settings).expect("a print").text)
}

#[test]
fn a_project_file_is_sliced_to_the_bytes_of_the_project() {
    let project: Project = serde_json::from_str(
        r#"{"models": [
            {"file": "calibration_cube.stl", "at_mm": [60, 70, 0], "rotate_deg": [0, 0, 30], "scale": [-1, 1, 0.5]},
            {"file": "tilted_bracket.3mf", "at_mm": [150, 120, 0], "settings": {"infill.density": "35%"}}],
            "profiles": ["petg"], "profile": "[walls]\ncount = 3", "pauses": ["4"],
            "settings": {"order.strategy": "nearest", "gcode.labels": "true"}}"#,
    )
    .expect("a project");
    let files = files(&["calibration_cube.stl", "tilted_bracket.3mf"]);
    let (file, text) = saved(&project, &files);
    let (back, _) = Project::read("x.3mf", &file, &Observer::none()).expect("sound").expect("a project");
    assert_eq!(back, project);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plate.3mf");
    std::fs::write(&path, &file).expect("written");
    let made = folder.path().join("plate.gcode");
    succeed(&["slice", "--quiet", &path.display().to_string()]);
    assert!(std::fs::read(&made).expect("G-code beside the project") == text);
    // Options lie on top.
    let brim =
        output(&["slice", "--quiet", &path.display().to_string(), "--set", "walls.count=1", "-o", "-"]);
    assert!(brim.status.success() && brim.stdout != text);
    let refused = output(&["slice", &path.display().to_string(), "--scale", "2"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn other_programs_find_the_meshes_to_the_bit_where_they_stand() {
    let project: Project = serde_json::from_str(
        r#"{"models": [{"file": "helical_gear.stl", "at_mm": [60, 70, 1.5]},
            {"file": "helical_gear.stl", "at_mm": [120, 70, 0], "rotate_deg": [0, 0, 90]}],
            "allow_floating": true, "settings": {"order.strategy": "nearest"}}"#,
    )
    .expect("a project");
    let (file, _) = saved(&project, &files(&["helical_gear.stl"]));
    let (name, bytes) = read("helical_gear.stl");
    let own = mesh::objects_from_bytes(Path::new(&name), &bytes).expect("a model").remove(0);
    let found = mesh::objects_from_bytes(Path::new("plate.3mf"), &file).expect("a plain 3MF");
    assert_eq!(found.len(), 2);
    assert_eq!(found[0].mesh, own.mesh);
    let low = found[0].mesh.bounds()[0];
    let at = [0, 1, 2].map(|i| found[0].positions[0][i] + low[i]);
    let size = own.mesh.size();
    for (is, wanted) in at.iter().zip([60.0 - size[0] / 2.0, 70.0 - size[1] / 2.0, 1.5]) {
        assert!((is - wanted).abs() < 1e-4, "{at:?}");
    }
}

#[test]
fn the_command_line_saves_what_it_would_slice() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plate.3mf").display().to_string();
    let (cube, bracket) = (model("calibration_cube"), model("tilted_bracket"));
    let args = [
        "slice",
        "--quiet",
        &cube.display().to_string(),
        &bracket.display().to_string(),
        "--copies",
        "2",
        "--rotate",
        "0,0,20",
        "--order",
        "nearest",
        "--pause-at",
        "2.5mm",
        "--object",
        "tilted_bracket:infill.density=40%",
    ];
    let direct = output(&[&args[..], &["-o", "-"]].concat());
    assert!(direct.status.success());
    succeed(&[&args[..], &["--save-project", &path]].concat());
    let again = output(&["slice", "--quiet", &path, "-o", "-"]);
    assert!(again.status.success() && again.stdout == direct.stdout);
    let info = output(&["info", &path]);
    assert_eq!(String::from_utf8_lossy(&info.stdout).matches("fits        yes").count(), 2);
}

/// A package with some parts, packed.
fn package(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in parts {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a part");
        zip.write_all(bytes).expect("written");
    }
    zip.finish().expect("finished").into_inner()
}

#[test]
fn a_project_that_unpacks_to_too_much_is_refused() {
    const PART: &str = "Metadata/pathwright.json";
    let project = br#"{"models": [{"file": "a.stl"}]}"#;
    let huge = vec![0; 64 << 20];
    let refused = |parts: &[(&str, &[u8])]| {
        let read = Project::read("x.3mf", &package(parts), &Observer::none());
        read.map(drop).expect_err("refused").to_string()
    };
    let said = refused(&[(PART, &huge)]);
    assert!(said.contains("larger than any such part"), "{said}");
    let said = refused(&[(PART, project), ("Metadata/pathwright/a.stl", &huge)]);
    assert!(said.contains("far more than a model of its packed size"), "{said}");
    let said = refused(&[(PART, project)]);
    assert!(said.contains("the model a.stl is missing"), "{said}");
    let said = refused(&[(PART, b"{\"models\": 3}")]);
    assert!(said.contains("x.3mf: Metadata/pathwright.json"), "{said}");
    let none = Project::read("x.3mf", &package(&[("3D/3dmodel.model", b"")]), &Observer::none());
    assert!(none.expect("sound").is_none());
}
