//! What tools are flushed into beside the prime tower.

use crate::support::mesh_shapes::cuboid;
use crate::support::print::{Print, run};
use crate::support::saved_project::{Saved, part, project};
use crate::support::strokes::{Line, lines};
use crate::tools::{pair, several};
use pathwright::job::Job;
use pathwright::profile::Settings;

const DENSE: [&str; 3] = ["infill.density=40%", "tool_change.flush_volume=60", "skirt.loops=0"];

fn is_infill(line: &&Line) -> bool {
    line.kind == "Internal infill"
}

#[test]
fn tools_are_flushed_into_the_infill_of_others_that_have_walls_there_already() {
    let (print, settings) = pair(&[&DENSE[..], &["tool_change.flush_into_infill=true"]].concat());
    let found = lines(&print, &settings);
    // The box on the left is the first tool's.
    let left = |line: &&Line| line.at[0] < -6.0;
    let of_other: Vec<&Line> =
        found.iter().filter(is_infill).filter(left).filter(|line| line.tool == 2).collect();
    assert!(of_other.len() > 10, "{}", of_other.len());
    for layer in of_other.iter().map(|line| line.layer) {
        let mut own = found.iter().filter(|line| line.layer == layer).filter(left);
        let first = own.next().expect("something");
        assert!(first.tool == 1 && first.kind.contains("erimeter"), "layer {layer}: {first:?}");
    }
    let walls = found.iter().filter(|line| line.kind.contains("erimeter")).filter(left);
    assert!(walls.into_iter().all(|line| line.tool == 1), "only what is hidden");
}

/// An object of two parts, each with a tool, that another slicer has saved with these keys.
fn saved(slicer: Saved, own: &[(&str, &str)], settings: &Settings) -> Print {
    let folder = tempfile::tempdir().expect("a folder");
    let left = part(cuboid([-15.0, -10.0, 0.0], [0.0, 10.0, 4.0]), "ModelPart", &[("extruder", "1")]);
    let right = part(cuboid([0.0, -10.0, 0.0], [15.0, 10.0, 4.0]), "ModelPart", &[("extruder", "2")]);
    run(&Job::of([project(&folder, slicer, own, &[left, right])]), settings).expect("a print")
}

#[test]
fn what_a_project_has_for_an_object_is_taken_over() {
    let settings = several(2, &DENSE);
    for (slicer, into_infill, into_objects) in [
        (Saved::Prusa, "wipe_into_infill", "wipe_into_objects"),
        (Saved::Orca, "flush_into_infill", "flush_into_objects"),
    ] {
        let flushed = |print: &Print| print.summary.tools.iter().map(|tool| tool.flushed_mm3).sum::<f64>();
        let plain = saved(slicer, &[], &settings);
        let infill = saved(slicer, &[(into_infill, "1")], &settings);
        assert!(flushed(&infill) < 0.9 * flushed(&plain), "{slicer:?}: {}", flushed(&infill));
        let whole = saved(slicer, &[(into_objects, "1")], &settings);
        assert_eq!(whole.summary.tool_changes, 0, "{slicer:?}: any tool may print it");
    }
}
