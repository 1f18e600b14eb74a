//! What the program says to bad models, settings and outputs: exit code, one message, no file.

use std::fs;
use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;

/// A box with these corners as ASCII STL.
fn block(low: [f64; 3], high: [f64; 3]) -> String {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { high[axis] } else { low[axis] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facets = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).map(|facet| {
        let vertices = facet.map(|i| corner(i).map(|v| v.to_string()).join(" "));
        format!("facet normal 0 0 0\nouter loop\nvertex {}\nendloop\nendfacet\n", vertices.join("\nvertex "))
    });
    format!("solid block\n{}endsolid block\n", facets.collect::<String>())
}

/// Slices a file of these contents with more arguments; the program must end with this exit code, say one line that
/// begins with `error: ` and leave the folder as it was. Returns the line.
fn refused(contents: &[u8], arguments: &[&str], code: i32) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.stl");
    fs::write(&file, contents).expect("written");
    let done = cargo_bin_cmd!("pathwright").arg("slice").arg(&file).args(arguments).output().expect("runs");
    let said = String::from_utf8(done.stderr).expect("UTF-8");
    assert_eq!(done.status.code(), Some(code), "{said}");
    assert!(said.starts_with("error: ") && said.lines().count() == 1 && done.stdout.is_empty(), "{said}");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1, "something is left: {said}");
    said
}

fn bundled(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)).expect("a model")
}

#[test]
fn bad_models_are_refused_with_their_file_and_the_mend() {
    let cube = bundled("calibration_cube.stl");
    let flat = block([0.0; 3], [10.0, 10.0, 0.0]);
    let not_finite = block([0.0; 3], [10.0; 3]).replacen("10 0 0", "10 nan 0", 1);
    for contents in [
        &b"just a letter to a friend"[..],
        &cube[..700],
        b"",
        b"solid nothing\nendsolid nothing\n",
        flat.as_bytes(),
        not_finite.as_bytes(),
    ] {
        let said = refused(contents, &[], 3);
        assert!(said.contains("part.stl: "), "{said}");
    }
}

#[test]
fn a_model_lower_than_half_a_layer_holds_nothing_to_print() {
    let said = refused(block([0.0; 3], [10.0, 10.0, 0.05]).as_bytes(), &[], 3);
    assert!(said.contains("layer.height") || said.contains("layer.first_height"), "{said}");
}

#[test]
fn a_model_larger_than_the_bed_is_refused_with_its_size_and_the_factor() {
    let said = refused(block([0.0; 3], [300.0, 10.0, 10.0]).as_bytes(), &[], 5);
    for fact in ["part", "300.00 × 10.00 × 10.00 mm", "250 × 250", "--scale-to-fit"] {
        assert!(said.contains(fact), "{fact} in {said}");
    }
    refused(block([0.0; 3], [10.0, 10.0, 300.0]).as_bytes(), &[], 5);
    refused(&bundled("calibration_cube.stl"), &["--copies", "500"], 5);
    refused(&bundled("calibration_cube.stl"), &["--translate", "200,0,0"], 5);
    refused(&bundled("calibration_cube.stl"), &["--translate", "0,0,3"], 5);
}

#[test]
fn contradicting_settings_are_refused_with_both_keys() {
    let cube = bundled("calibration_cube.stl");
    let said = refused(&cube, &["--set", "layer.height=0.41"], 4);
    assert!(said.contains("layer.height") && said.contains("nozzle_diameter"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_output_error() {
    let said = refused(&bundled("calibration_cube.stl"), &["-o", "/dev/full"], 6);
    assert!(said.contains("/dev/full"), "{said}");
}

#[test]
fn an_output_below_a_file_is_an_output_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("written");
    let output = file.join("part.gcode");
    refused(&bundled("calibration_cube.stl"), &["-o", output.to_str().expect("UTF-8")], 6);
}

#[test]
fn each_model_of_many_gets_the_file_it_would_get_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["calibration_cube", "tilted_bracket"] {
        fs::write(folder.path().join(format!("{name}.stl")), bundled(&format!("{name}.stl")))
            .expect("written");
    }
    let slice = |arguments: &[&str]| {
        let mut command = cargo_bin_cmd!("pathwright");
        let done = command
            .current_dir(folder.path())
            .args(["slice", "--json", "--order", "nearest"])
            .args(arguments);
        let done = done.output().expect("runs");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stdout).expect("UTF-8")
    };
    let said = slice(&["calibration_cube.stl", "tilted_bracket.stl", "--each"]);
    assert_eq!(said.lines().count(), 2, "one line of JSON for each");
    slice(&["tilted_bracket.stl", "-o", "alone.gcode"]);
    let bytes = |name: &str| fs::read(folder.path().join(name)).expect("a file");
    assert!(bytes("tilted_bracket.gcode") == bytes("alone.gcode"));
    assert!(folder.path().join("calibration_cube.gcode").exists());
}

#[test]
fn a_size_that_points_to_another_unit_is_named_with_the_option_that_mends_it() {
    let cube = |side: f64| block([0.0; 3], [side; 3]);
    let metres = refused(cube(0.05).as_bytes(), &[], 3);
    assert!(
        metres.contains("0.0500 × 0.0500 × 0.0500 mm") && metres.contains("metres, use --unit m"),
        "{metres}"
    );
    let microns = refused(cube(20_000.0).as_bytes(), &[], 3);
    assert!(microns.contains("20000.00 mm") && microns.contains("micrometres, use --unit um"), "{microns}");
    let small_microns = refused(cube(5_000.0).as_bytes(), &[], 5);
    assert!(small_microns.contains("micrometres, use --unit um"), "{small_microns}");
    // The advice works, and says nothing more.
    let folder = tempfile::tempdir().expect("a folder");
    let sliced = |name: &str, contents: String, scale: &str| {
        let file = folder.path().join(name);
        fs::write(&file, contents).expect("written");
        let done = cargo_bin_cmd!("pathwright").arg("slice").arg(&file).args(["--scale", scale]).output();
        let done = done.expect("runs");
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8(done.stderr).expect("UTF-8")
    };
    assert_eq!(sliced("metres.stl", cube(0.02), "1000"), "");
    assert_eq!(sliced("microns.stl", cube(20_000.0), "0.001"), "");
    let far = block([30_000.0, 0.0, 0.0], [30_020.0, 20.0, 10.0]);
    assert_eq!(sliced("far.stl", far, "1"), "", "far from the origin");
    let inches = sliced("inches.stl", block([0.0; 3], [3.6, 2.0, 1.0]), "1");
    assert!(inches.contains("3.60 × 2.00 × 1.00 mm; if it was made in inches, use --unit inch"), "{inches}");
    let twice = sliced("twice.stl", block([0.0; 3], [1.8, 1.0, 0.5]), "2");
    assert!(twice.contains("use --scale 50.8"), "{twice}");
}

#[test]
fn every_repair_is_told_in_the_summary_in_json_and_at_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("box.stl");
    // A facet twice, one turned over, one that is missing.
    let text = block([0.0; 3], [20.0, 20.0, 10.0]);
    let facets: Vec<&str> = text.split_inclusive("endfacet\n").collect();
    let turned = facets[4].replacen("vertex", "corner", 1);
    let (head, first) = turned.split_once("corner").expect("a first corner");
    let (first, rest) = first.split_once("\nvertex").expect("a second one");
    let (second, rest) = rest.split_once("\nvertex").expect("a third one");
    let turned = format!("{head}vertex{second}\nvertex{first}\nvertex{rest}");
    let damaged = [&facets[..4], &[&turned], &facets[5..9], &[facets[1]], &facets[10..]].concat().concat();
    fs::write(&file, damaged).expect("written");
    let run = |arguments: &[&str]| {
        let done =
            cargo_bin_cmd!("pathwright").arg("slice").arg(&file).args(arguments).output().expect("runs");
        assert_eq!(done.status.code(), Some(0));
        [done.stdout, done.stderr].map(|text| String::from_utf8(text).expect("UTF-8"))
    };
    let repairs = ["1 duplicate facet dropped", "1 facet turned to face outwards", "1 hole filled"];
    let [summary, said] = run(&[]);
    for repair in repairs {
        assert!(summary.contains(&format!("repaired  box: {repair}")), "{summary}");
        assert!(said.contains(&format!("warning: box: {repair}")), "{said}");
    }
    let json: serde_json::Value = serde_json::from_str(&run(&["--json"])[0]).expect("JSON");
    let kinds: Vec<&str> = json["repairs"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|repair| repair["kind"].as_str())
        .collect();
    assert_eq!(kinds, ["duplicates-dropped", "flipped", "holes-filled"]);
    assert!(json["warnings"].as_array().expect("a list").len() >= 3);
}
