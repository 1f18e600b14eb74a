//! Lower bounds as the program tells them.

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

fn told(args: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("out.gcode");
    let model = "models/calibration_cube.stl";
    let mut command = cargo_bin_cmd!("pathwright");
    command.args(args).args([model, "--json"]);
    if args[0] == "slice" {
        command.arg("--output").arg(output);
    }
    serde_json::from_slice(&command.assert().success().get_output().stdout).expect("JSON")
}

#[test]
fn where_times_are_minimised_no_order_takes_less_than_their_bound() {
    let summary = told(&["slice", "--certify"]);
    let number = |key: &str| summary[key].as_f64().unwrap_or(f64::NAN);
    let (link_s, bound_s) = (number("link_s"), number("bound_s"));
    assert!(0.6 * link_s < bound_s && bound_s <= link_s && bound_s < number("total_s"), "{bound_s} {link_s}");
    assert!((number("gap_s") - (link_s / bound_s - 1.0)).abs() < 1e-9, "{summary}");

    let rows = told(&["compare", "--cost", "time", "--order", "as-sliced,nearest,greedy,optimized"]);
    let rows = rows["strategies"].as_array().expect("rows");
    assert_eq!(rows.len(), 4);
    for row in rows {
        let [found, bound] = ["travel_s", "bound_s"].map(|key| row[key].as_f64().unwrap_or(f64::NAN));
        assert!(bound > 0.0 && bound <= found, "{} takes {found}, bound {bound}", row["strategy"]);
    }
}

#[test]
fn where_lengths_are_minimised_there_is_no_bound_of_times() {
    let summary = told(&["slice", "--certify", "--cost", "length"]);
    assert!(summary["bound_mm"].is_number() && summary.get("bound_s").is_none(), "{summary}");
}
