//! Projects: positions, roles and settings of models, and the command line that prints the same.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::mesh_shapes::{cuboid, stl};
use crate::support::print::{model, run, settings, standard};
use pathwright::job::{FitError, Job, JobError, JobModel, ModelFile, ModelFiles, Project};
use pathwright::pipeline::Pipeline;
use pathwright::{Observer, Settings};

/// A project as programs write it.
fn project(json: &str) -> Project {
    serde_json::from_str(json).expect("a project")
}

/// Bundled models by their files' names.
fn files(names: &[&str]) -> ModelFiles {
    let read = |name: &&str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name);
        let bytes = std::fs::read(path).expect("a model");
        ((*name).to_owned(), Arc::new(ModelFile::read(name, bytes, &Observer::none()).expect("a model")))
    };
    names.iter().map(read).collect()
}

fn text(job: &Job, settings: &Settings) -> Vec<u8> {
    run(job, settings).expect("a print").text
}

#[test]
fn positions_that_the_arrangement_would_choose_change_no_byte() {
    let settings = settings(&[], &["gcode.labels=true", "order.strategy=nearest"]);
    let arranged = Job::of([model("calibration_cube")]).with_copies(3);
    let (plate, _) = Pipeline.placed(&arranged, &settings, &Observer::none()).expect("room");
    let standing = plate
        .objects
        .iter()
        .map(|object| JobModel { at_mm: Some(object.at_mm), ..model("calibration_cube").into() });
    let standing = Job { models: standing.collect(), ..Job::default() };
    assert!(text(&standing, &settings) == text(&arranged, &settings));
}

#[test]
fn models_stand_where_they_are_put_and_what_does_not_fit_is_named() {
    let settings = standard(&["skirt.loops=0"]);
    let at = |name: &str, at_mm| JobModel { at_mm: Some(at_mm), ..model(name).into() };
    let job = Job { models: vec![at("calibration_cube", [40.0, 60.0, 0.0])], ..Job::default() };
    let print = run(&job, &settings).expect("a print");
    let points =
        || print.beads().into_iter().filter(|b| b.kind == "External perimeter").flat_map(|b| b.points);
    let (low, high) = points().fold(([f64::MAX; 2], [f64::MIN; 2]), |(low, high), p| {
        ([0, 1].map(|i| p[i].min(low[i])), [0, 1].map(|i| p[i].max(high[i])))
    });
    for i in [0, 1] {
        assert!(((low[i] + high[i]) / 2.0 - [40.0, 60.0][i]).abs() < 0.01, "{low:?} {high:?}");
    }
    let refused = |models: Vec<JobModel>, sets: &[&str]| {
        let job = Job { models, ..Job::default() };
        let error = run(&job, &standard(sets)).map(|print| print.summary).expect_err("it does not fit");
        assert!(matches!(error, JobError::DoesNotFit(FitError::Placement { .. })), "{error}");
        (error.object().map(str::to_owned), error.to_string())
    };
    let cube = |x| at("calibration_cube", [x, 60.0, 0.0]);
    let (object, said) = refused(vec![cube(60.0), cube(5.0)], &["skirt.loops=0"]);
    assert_eq!(object.as_deref(), Some("calibration_cube (2)"), "{said}");
    assert!(said.contains("5.00 mm beyond") && said.contains("move it"), "{said}");
    let (object, said) = refused(vec![cube(60.0), cube(90.0)], &["print.sequence=object"]);
    assert_eq!(object.as_deref(), Some("calibration_cube (2)"), "{said}");
    let (_, said) = refused(vec![cube(60.0), model("helical_gear").into()], &[]);
    assert!(said.contains("helical_gear: it has no position"), "{said}");
}

#[test]
fn one_model_stands_on_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, size| {
        let path = folder.path().join(name);
        std::fs::write(&path, stl(&cuboid([0.0; 3], size))).expect("written");
        path
    };
    let at = |path: PathBuf, z| JobModel { at_mm: Some([100.0, 100.0, z]), ..path.into() };
    let (base, post) = (file("base.stl", [30.0, 30.0, 2.0]), file("post.stl", [10.0, 10.0, 4.0]));
    let job = |z| Job { models: vec![at(base.clone(), 0.0), at(post.clone(), z)], ..Job::default() };
    let print = run(&job(2.0), &standard(&[])).expect("a print");
    assert!((print.summary.size_mm[2] - 6.0).abs() < 0.01);
    let error = run(&job(3.0), &standard(&[])).map(|print| print.summary).expect_err("in mid-air");
    assert_eq!((error.kind(), error.object()), ("check", Some("post")), "{error}");
}

#[test]
fn a_blocker_with_a_position_stands_by_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("box.stl");
    std::fs::write(&path, stl(&cuboid([0.0; 3], [200.0, 200.0, 100.0]))).expect("written");
    let settings = standard(&["support.enabled=true"]);
    let support = |at_mm| {
        let blocker = JobModel { at_mm, ..path.clone().into() };
        let job = Job { support_blockers: vec![blocker], ..Job::of([model("overhang_and_bridge")]) };
        run(&job, &settings).expect("a print").volume_of("Support material", &settings)
    };
    assert_eq!(support(Some([125.0, 125.0, 0.0])), 0.0);
    assert!(support(Some([-200.0, 125.0, 0.0])) > 100.0, "beside the model");
}

#[test]
fn what_is_wrong_with_a_project_is_said() {
    let files = files(&["calibration_cube.stl"]);
    let said = |json: &str| project(json).job(&files, None).map(drop).expect_err("refused").to_string();
    for (json, wanted) in [
        (
            r#"{"models": [{"file": "x.stl"}]}"#,
            "x.stl: there is no such file among the models; there are: cal",
        ),
        (
            r#"{"models": [{"file": "calibration_cube.stl", "object": 3}]}"#,
            "no object 3 in the file, which has 1",
        ),
        (r#"{"models": [{"file": "calibration_cube.stl", "scale": [1, 0, 1]}]}"#, "factors other than 0"),
        (
            r#"{"models": [{"file": "calibration_cube.stl", "settings": {"layer.height": "0.1"}}]}"#,
            "all objects of a plate share their layers",
        ),
        (r#"{"models": [], "pauses": []}"#, "no model to print"),
        (r#"{"models": [{"file": "calibration_cube.stl"}], "pauses": ["x"]}"#, "`x` is neither"),
    ] {
        assert!(said(json).contains(wanted), "{json}: {}", said(json));
    }
    let unresolved = |json: &str| project(json).resolve(None).map(drop).expect_err("refused").to_string();
    for (json, wanted) in [
        (r#"{"profiles": ["/etc/passwd"]}"#, "no profile `/etc/passwd`"),
        (r#"{"profiles": ["models/../profiles/petg.toml"]}"#, "no profile"),
        (r#"{"profile": "inherits = \"profiles/petg.toml\""}"#, "no profile `profiles/petg.toml`"),
        (r#"{"presets": {"printer": "X"}}"#, "no presets here"),
        (r#"{"settings": {"walls.cnt": "3"}}"#, "walls.cnt"),
    ] {
        assert!(unresolved(json).contains(wanted), "{json}: {}", unresolved(json));
    }
    let resolved =
        project(r#"{"profile": "inherits = \"petg\"\n[walls]\ncount = 4"}"#).resolve(None).expect("sound");
    assert_eq!((resolved.settings.filament.material.as_str(), resolved.settings.walls.count), ("PETG", 4));
}

/// Runs a shell's command in a folder that holds the bundled models; the G-code.
fn command_bytes(command: &str) -> Vec<u8> {
    let words = command.strip_prefix("pathwright ").expect("the program");
    let program = env!("CARGO_BIN_EXE_pathwright");
    let output = std::process::Command::new("sh")
        .args(["-c", &format!("'{program}' {words} -o - --quiet")])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("models"))
        .env_remove("SOURCE_DATE_EPOCH")
        .output()
        .expect("a shell");
    assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

#[cfg(unix)]
#[test]
fn the_command_of_a_project_gives_the_same_bytes() {
    let files = files(&["calibration_cube.stl", "tilted_bracket.3mf", "overhang_and_bridge.stl"]);
    for json in [
        r#"{"models": [{"file": "calibration_cube.stl", "object": 0, "copies": 2}],
            "settings": {"gcode.labels": "true", "infill.density": "12%"}, "profiles": ["standard-job", "petg"]}"#,
        r#"{"models": [{"file": "calibration_cube.stl", "scale": [1.1, 0.7, 1.3], "rotate_deg": [0, 0, 33.3],
            "settings": {"walls.count": "4"}},
            {"file": "tilted_bracket.3mf", "scale": [1.1, 0.7, 1.3], "rotate_deg": [0, 0, 33.3]}],
            "settings": {"order.strategy": "nearest", "gcode.file_name": "it's {input_filename_base}"}}"#,
        r#"{"models": [{"file": "overhang_and_bridge.stl"},
            {"file": "calibration_cube.stl", "role": "support_blocker"}], "color_changes": ["1.3mm"],
            "pauses": ["5"], "allow_floating": true,
            "settings": {"support.enabled": "true", "order.strategy": "nearest"}}"#,
    ] {
        let project = project(json);
        let settings = project.resolve(None).expect("sound").settings;
        let own = text(&project.job(&files, None).expect("a job"), &settings);
        let command = project.command(&files).expect("a command");
        assert!(command_bytes(&command) == own, "{command}");
    }
    let placed = r#"{"models": [{"file": "calibration_cube.stl", "at_mm": [50, 50, 0]}]}"#;
    assert_eq!(project(placed).command(&files), None);
}
