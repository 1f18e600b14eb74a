//! Models that others made, from a folder beside the project.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::oracle::assert_sections_agree;
use crate::support::print::{run, settings, solid, standard};
use crate::{listed, present, shared};
use pathwright::job::Job;

/// Small ones, watertight, with walls of at least 1.2 mm.
const SMALL: [&str; 5] = [
    "open/xyz_calibration_cube.stl",
    "open/calibration_steps_5mm.stl",
    "open/cc0_overhang_bridging_cooling.stl",
    "open/voron_design_cube_v7.stl",
    "seed/testModel.stl",
];

fn models() -> impl Iterator<Item = PathBuf> {
    present(&SMALL.map(|name| ["models/", name].concat()).each_ref().map(String::as_str)).into_iter()
}

fn job(model: &Path) -> Job {
    Job { models: vec![model.into()], ..Job::default() }
}

pub fn full_prints_deposit_the_volume_of_the_mesh() {
    // Without bridges, whose bridge lines are thicker than a layer.
    let settings = standard(&["infill.density=100%", "skirt.loops=0", "bridge.enabled=false"]);
    let (mut pooled, mut wanted) = (0.0, 0.0);
    for model in models() {
        let volume = run(&job(&model), &settings).expect("a print").measure(&settings).volume_mm3;
        let solid = solid(&model, &settings).volume_mm3;
        assert!((volume / solid - 1.0).abs() < 0.03, "{}: {volume} of {solid} mm³", model.display());
        (pooled, wanted) = (pooled + volume, wanted + solid);
    }
    assert!((pooled / wanted - 1.0).abs() < 0.02, "pooled {pooled} of {wanted} mm³");
}

pub fn sparse_infill_fills_its_share() {
    let settings = standard(&[]);
    // The overhang test has narrow rooms, many of them without a line.
    for model in models().filter(|path| !path.ends_with(SMALL[2])) {
        let room = solid(&model, &settings).sparse_mm3(&settings);
        let print = run(&job(&model), &settings).expect("a print");
        let share = print.volume_of("Internal infill", &settings) / room;
        assert!((share - 0.20).abs() <= 0.01, "{}: {share:.4} of {room:.0} mm³", model.display());
    }
}

pub fn an_independent_reader_finds_no_fault_and_the_same_figures() {
    let script = shared("tools/gcode_yardstick.py");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.gcode");
    for profile in ["default", "standard-job", "prusa-i3", "corexy-klipper"] {
        let settings = settings(&[profile], &["order.strategy=nearest"]);
        for model in models().take(2) {
            let print = run(&job(&model), &settings).expect("a print");
            std::fs::write(&file, &print.text).expect("written");
            let bed =
                format!("{}x{}x{}", settings.bed.size[0].0, settings.bed.size[1].0, settings.bed.height.0);
            let done =
                Command::new("python3").arg(&script).args(["--json", "--bed", &bed]).arg(&file).output();
            let said = String::from_utf8(done.expect("runs").stdout).expect("UTF-8");
            let theirs: serde_json::Value = serde_json::from_str(&said).expect("JSON");
            assert_eq!(theirs["faults"], serde_json::json!({}), "{profile}: {said}");
            let total = &print.summary.total;
            for (key, ours) in [
                ("print", total.print_mm),
                ("travel", total.travel_mm),
                ("link", total.link_mm),
                ("volume_mm3", total.volume_mm3),
                ("travels", total.travels as f64),
                ("retractions", total.retractions as f64),
            ] {
                let theirs = theirs[key].as_f64().expect("a number");
                assert!((ours - theirs).abs() <= 2e-4 * theirs, "{profile}, {key}: {ours}, they {theirs}");
            }
        }
    }
}

/// All models with facets.
fn every_stl() -> Vec<PathBuf> {
    [listed("models/seed", "stl"), listed("models/open", "stl")].concat()
}

pub fn models_have_the_volume_that_is_known_of_them() {
    // Volumes from the list of the collection, computed by another program.
    let known = [("3DBenchy.stl", 15550.7), ("3DHackerTest.stl", 13984.9), ("spikey_top.stl", 38399.7)];
    for path in every_stl() {
        for (_, volume_mm3) in known.iter().filter(|(name, _)| path.ends_with(name)) {
            let (_, report) = pathwright::mesh::load(&path).unwrap();
            assert!((report.volume_mm3 / volume_mm3 - 1.0).abs() < 1e-4, "{}", path.display());
            assert!(report.watertight);
        }
    }
}

pub fn sections_agree_with_an_independent_cut() {
    every_stl().iter().for_each(|path| assert_sections_agree(path));
}
