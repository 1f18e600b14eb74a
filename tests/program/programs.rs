//! What programs around the command line rely on: standard input, limits, keys, failures as JSON, units.

use std::collections::BTreeSet;
use std::path::Path;

use crate::support::print::model;
use crate::support::program::{output, output_with_input};

fn cube() -> String {
    model("calibration_cube").display().to_string()
}

#[test]
fn a_model_on_standard_input_is_sliced_as_its_file_is() {
    let bytes = std::fs::read(cube()).expect("a model");
    let args = ["slice", "--quiet", "--order", "nearest", "-o", "-"];
    let file = output(&[&args[..], &[&cube()]].concat());
    let stdin =
        output_with_input(&[&args[..], &["-", "--stdin-name", "calibration_cube.stl"]].concat(), &bytes);
    assert!(file.status.success() && stdin.stdout == file.stdout);
    // Without a name, too, and to standard output.
    let bare = output_with_input(&["slice", "--quiet", "--order", "nearest", "-"], &bytes);
    assert!(bare.status.success() && bare.stdout.len() > 10_000);
    let junk = output_with_input(&["slice", "-"], b"no model");
    assert_eq!(junk.status.code(), Some(3));
}

#[test]
fn a_run_ends_after_its_time_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let to = folder.path().join("x.gcode").display().to_string();
    let ended = output(&["slice", "--json", "--timeout", "0.01", &cube(), "-o", &to]);
    assert_eq!(ended.status.code(), Some(8), "{}", String::from_utf8_lossy(&ended.stderr));
    let told: serde_json::Value = serde_json::from_slice(&ended.stdout).expect("JSON");
    assert_eq!((&told["error"]["kind"], &told["error"]["exit"]), (&"timeout".into(), &8.into()));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    let enough = output(&["slice", "--quiet", "--timeout", "600", "--max-memory", "8G", &cube(), "-o", &to]);
    assert!(enough.status.success() && Path::new(&to).exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_needs_more_memory_than_it_may_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let to = folder.path().join("x.gcode").display().to_string();
    let args = ["slice", "--max-memory", "4M", &cube(), "-o", &to];
    let ended = output(&args);
    let said = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(9), "{said}");
    assert!(said.contains("memory"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn failures_are_lines_of_json_that_name_the_object() {
    let folder = tempfile::tempdir().expect("a folder");
    let to = folder.path().join("x.gcode").display().to_string();
    let told = |args: &[&str]| {
        let run = output(&[&["slice", "--json", &cube(), "-o", &to], args].concat());
        let told: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
        (run.status.code(), told["error"].clone())
    };
    let (code, error) = told(&["--scale", "20"]);
    assert_eq!(
        (code, &error["kind"], &error["object"]),
        (Some(5), &"does_not_fit".into(), &"calibration_cube".into())
    );
    assert_eq!(error["file"], cube().as_str());
    let (code, error) = told(&["--set", "walls.count=x"]);
    assert_eq!((code, &error["kind"], &error["key"]), (Some(4), &"settings".into(), &"walls.count".into()));
}

fn key(args: &[&str]) -> String {
    let run = output(&[&["key"], args].concat());
    assert!(run.status.success(), "{args:?}: {}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).expect("text").trim().to_owned()
}

#[test]
fn a_key_changes_with_whatever_changes_the_bytes_and_with_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("calibration_cube.stl");
    std::fs::copy(cube(), &copy).expect("copied");
    let copy = copy.display().to_string();
    let own = key(&[&cube()]);
    assert_eq!((own.len(), &key(&[&copy])), (64, &own));
    assert_eq!(key(&[&cube(), "--threads", "1", "--quiet", "-o", "/tmp/elsewhere.gcode"]), own);
    assert_eq!(key(&[&cube(), "--set", "walls.count=2"]), key(&[&cube(), "--set", "walls.count=2"]));
    let bracket = model("tilted_bracket").display().to_string();
    let others: [&[&str]; 16] = [
        &["--set", "layer.height=0.15"],
        &["--set", "walls.count=5"],
        &["--set", "infill.density=21%"],
        &["--set", "gcode.start=G28"],
        &["--set", "seam.position=rear"],
        &["--profile", "petg"],
        &["--scale", "1.01"],
        &["--rotate", "0,0,1"],
        &["--translate", "1,0,0"],
        &["--copies", "2"],
        &["--pause-at", "3"],
        &["--color-change-at", "3"],
        &["--object", "calibration_cube:walls.count=5"],
        &["--support-blocker", &bracket],
        &["-o", "x.bgcode"],
        &[&bracket],
    ];
    let mut keys: BTreeSet<String> = others.iter().map(|more| key(&[&[&*cube()], *more].concat())).collect();
    keys.insert(own);
    assert_eq!(keys.len(), others.len() + 1);
}

#[test]
fn a_unit_is_a_factor() {
    let print = |args: &[&str]| {
        let run = output(&[&["slice", "--quiet", "--order", "nearest", &cube(), "-o", "-"], args].concat());
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        run.stdout
    };
    assert!(print(&["--unit", "inch", "--scale", "0.1"]) == print(&["--scale", "2.54"]));
    assert!(print(&["--unit", "mm"]) == print(&[]));
}
