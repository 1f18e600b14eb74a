//! Parts of the bed where nothing may be printed.

use crate::support::found::{kinds, report};
use crate::support::print::{run, settings};
use crate::support::strokes::lines;
use crate::tools::boxes;
use pathwright::check::Kind;
use pathwright::job::{Job, JobError};
use pathwright::profile::Settings;

const BOX: (&str, [f64; 3], [f64; 3]) = ("box", [0.0; 3], [20.0, 20.0, 1.0]);

/// Nothing may be printed between 110 and 140 mm, in the middle of the bed.
fn with_middle_excluded() -> Settings {
    settings(&["standard-job"], &["bed.excluded=[140, 110, 110, 140]"])
}

#[test]
fn models_are_arranged_beside_it() {
    let settings = with_middle_excluded();
    let folder = tempfile::tempdir().unwrap();
    let mut job = boxes(&folder, &[BOX]);
    job.models.iter_mut().for_each(|model| model.at_mm = None);
    for copies in [1, 3] {
        let print = run(&job.clone().with_copies(copies), &settings).expect("a print");
        let inside = |at: [f64; 2]| at.iter().all(|mm| mm.abs() < 15.0);
        let found = lines(&print, &settings);
        assert!(found.iter().all(|line| line.kind == "Skirt/Brim" || !inside(line.at)), "{copies} models");
    }
}

#[test]
fn a_print_in_it_is_an_error_that_names_the_object() {
    let folder = tempfile::tempdir().unwrap();
    let job = boxes(&folder, &[BOX]);
    let error = run(&job, &with_middle_excluded()).err().expect("it stands in it");
    assert!(matches!(error, JobError::DoesNotFit(_)), "{error}");
    assert!(error.to_string().contains("box") && error.to_string().contains("bed.excluded"), "{error}");
}

#[test]
fn beads_in_it_are_found_in_files() {
    let folder = tempfile::tempdir().unwrap();
    let job: Job = boxes(&folder, &[BOX]);
    let print = run(&job, &settings(&["standard-job"], &[])).expect("a print");
    assert_eq!(kinds(&report(&print.text, &with_middle_excluded())), [Kind::OutsideBed]);
}
