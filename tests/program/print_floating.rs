//! Nothing begins in mid-air without a word.

use std::fs;

use crate::support::mesh_shapes::{Facets, cuboid, stl};
use crate::support::print::{Print, print, run, standard};
use pathwright::job::{Job, JobError};
use pathwright::profile::Settings;

/// Slices facets as `part.stl`.
fn slice(facets: &Facets, settings: &Settings, allow_floating: bool) -> Result<Print, JobError> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.stl");
    fs::write(&file, stl(facets)).expect("written");
    run(&Job { models: vec![file.into()], allow_floating, ..Job::default() }, settings)
}

fn block(low_mm: f32, high_mm: f32) -> Facets {
    cuboid([0.0, 0.0, low_mm], [20.0, 20.0, high_mm])
}

/// The heights of beads of the model.
fn heights(print: &Print) -> Vec<f64> {
    let mut heights: Vec<f64> =
        print.beads().iter().filter(|bead| bead.kind != "Skirt/Brim").map(|bead| bead.z_mm).collect();
    heights.dedup();
    heights
}

#[test]
fn a_sliver_beneath_the_body_does_not_lift_it() {
    let sliver = cuboid([5.0, 5.0, -2.9], [5.02, 12.0, -2.0]);
    let print = slice(&[block(0.0, 4.0), sliver].concat(), &standard(&[]), false).expect("a print");
    assert_eq!((heights(&print)[0], print.summary.size_mm[2]), (0.2, 4.0));
}

#[test]
fn what_stands_on_a_blade_too_thin_to_be_printed_is_refused_with_height_and_cause() {
    // A body on a blade: the outline of its end, and that of the other end.
    let outline = [[10.0, 0.0], [10.05, 1.2], [20.0, 1.2], [20.0, 5.0], [0.0, 5.0], [0.0, 1.2], [9.95, 1.2]];
    let at = |[x, z]: [f32; 2], y: f32| [x, y, z];
    let model: Facets = (0..outline.len())
        .flat_map(|i| {
            let (p, q, middle) = (outline[i], outline[(i + 1) % outline.len()], [10.0, 1.5]);
            let ends =
                [[at(p, 0.0), at(q, 0.0), at(middle, 0.0)], [at(q, 20.0), at(p, 20.0), at(middle, 20.0)]];
            let side = [[at(q, 0.0), at(p, 0.0), at(p, 20.0)], [at(q, 0.0), at(p, 20.0), at(q, 20.0)]];
            ends.into_iter().chain(side)
        })
        .collect();
    let error = slice(&model, &standard(&[]), false).map(|_| ()).expect_err("in mid-air");
    assert!(matches!(error, JobError::Check(_)));
    let text = error.to_string();
    assert!(
        text.contains("part: the print begins in mid-air at Z 1.20: what it has beneath is too thin"),
        "{text}"
    );
    assert!(text.contains("support.enabled=true") && text.contains("--allow-floating"), "{text}");
    let print = slice(&model, &standard(&[]), true).expect("as it is");
    assert_eq!(heights(&print)[0], 1.4);
    assert!(print.summary.warnings[0].contains("begins in mid-air"), "{:?}", print.summary.warnings);
}

#[test]
fn an_empty_layer_between_printed_ones_is_refused_and_named() {
    let model = [block(0.0, 2.0), block(3.0, 5.0)].concat();
    let text = slice(&model, &standard(&[]), false).map(|_| ()).expect_err("a gap").to_string();
    assert!(
        text.contains("goes on in mid-air at Z 3.00: nothing of it is printed between Z 2.00 and Z 3.00"),
        "{text}"
    );
    slice(&model, &standard(&["support.enabled=true"]), false).expect("held by support");
}

#[test]
fn islands_in_mid_air_are_told_with_number_and_height() {
    // Two pins hang from an arm.
    let pin = |x: f32| cuboid([x, 8.0, 6.0], [x + 2.0, 10.0, 8.5]);
    let arm = cuboid([0.0, 5.0, 8.0], [40.0, 15.0, 10.0]);
    let model = [cuboid([0.0; 3], [20.0, 20.0, 9.0]), arm, pin(25.0), pin(35.0)].concat();
    let print = slice(&model, &standard(&[]), false).expect("a print");
    let told = print.summary.warnings.join("\n");
    assert!(told.contains("2 islands begin in mid-air (8.0 mm²), the lowest at Z 6.00"), "{told}");
    let held = slice(&model, &standard(&["support.enabled=true"]), false).expect("a print");
    assert!(!held.summary.warnings.iter().any(|w| w.contains("mid-air")), "{:?}", held.summary.warnings);
}

#[test]
fn what_needs_support_is_told_and_nothing_else_is() {
    // A table on one leg: a rim of 10 mm around hangs over.
    let table = [cuboid([10.0, 10.0, 0.0], [20.0, 20.0, 10.0]), cuboid([0.0, 0.0, 10.0], [30.0, 30.0, 12.0])];
    let print_of = |sets: &[&str]| slice(&table.concat(), &standard(sets), false).expect("a print");
    let overhangs = print_of(&[]).summary.overhangs.expect("looked for");
    assert_eq!((overhangs.count, overhangs.lowest_mm), (1, Some(10.0)));
    assert!((overhangs.area_mm2 / 800.0 - 1.0).abs() < 0.05, "{}", overhangs.area_mm2);
    let told = print_of(&[]).summary.warnings.join("\n");
    assert!(told.contains("1 overhang needs support") && told.contains("support.enabled=true"), "{told}");
    let held = print_of(&["support.enabled=true"]).summary;
    assert!(held.overhangs.is_none() && held.warnings.is_empty(), "{:?}", held.warnings);
    let cube = print("calibration_cube", &standard(&[])).summary;
    assert!(
        cube.warnings.is_empty() && cube.overhangs.expect("looked for").count == 0,
        "{:?}",
        cube.warnings
    );
}

#[test]
fn parts_too_thin_for_the_nozzle_are_told_with_layers_and_area() {
    // A film of 0.03 mm stands on a block, and a rib that can be printed.
    let film = cuboid([2.0, 2.0, 2.0], [2.03, 12.0, 4.0]);
    let rib = cuboid([8.0, 2.0, 2.0], [8.2, 12.0, 4.0]);
    let print =
        slice(&[block(0.0, 2.0), film, rib.clone()].concat(), &standard(&[]), false).expect("a print");
    let told = print.summary.warnings.join("\n");
    assert!(
        told.contains("parts of 10 layers are too thin to be printed (3.0 mm²), the lowest at Z 2.20"),
        "{told}"
    );
    let whole = slice(&[block(0.0, 2.0), rib].concat(), &standard(&[]), false).expect("a print");
    assert!(whole.summary.warnings.is_empty(), "{:?}", whole.summary.warnings);
}
