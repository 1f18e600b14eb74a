//! A run that is cancelled does nothing more, wherever it is.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use pathwright::job::{Engine, Job};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::{Error, Model, Observer, Plate, Print, Settings, Slicer};

const MODEL: &str = "models/calibration_cube.stl";

/// So many questions, evenly spread, is every run cancelled at.
const POINTS: usize = 12;

/// What a run comes to that is cancelled at its n-th question whether it shall go on, and how many questions it asks.
fn cancelled_at<T>(n: usize, run: impl FnOnce(&Observer<'_>) -> T) -> (T, usize) {
    let asked = AtomicUsize::new(0);
    let result = run(&Observer::none().cancelled_when(|| asked.fetch_add(1, Ordering::Relaxed) + 1 >= n));
    (result, asked.into_inner())
}

/// Cancels a run that one thread does at points from its first question to its last.
fn ends_at_once<T>(run: impl Fn(&Observer<'_>) -> Result<T, Error>) {
    let (done, all) = cancelled_at(usize::MAX, &run);
    assert!(done.is_ok() && all > 1, "{all} questions");
    for point in 0..POINTS.min(all) {
        let n = 1 + point * (all - 1) / (POINTS.min(all) - 1);
        let (result, asked) = cancelled_at(n, &run);
        assert!(matches!(result, Err(Error::Cancelled)), "{n} of {all}");
        assert_eq!(asked, n, "it goes on after question {n} of {all}");
    }
}

fn slice(settings: &Settings, threads: Option<usize>, observer: &Observer<'_>) -> Result<Print, Error> {
    let plate = Plate::new(settings).add(Model::read(MODEL)?)?;
    let slicer = Slicer::new(settings);
    threads.map_or(slicer.clone(), |threads| slicer.threads(threads)).slice(&plate, observer)
}

#[test]
fn slicing_ends_at_any_point() {
    let settings = Settings::default();
    ends_at_once(|observer| slice(&settings, None, observer));
}

#[test]
fn reading_ends_at_any_point() {
    ends_at_once(|observer| Model::read_watched(MODEL, observer));
}

#[test]
fn a_job_that_is_cancelled_before_its_model_is_read_writes_nothing() {
    let (settings, job) = (Settings::default(), Job { models: vec![MODEL.into()], ..Job::default() });
    let mut output = Output::memory();
    let (result, asked) = cancelled_at(2, |observer| Pipeline.slice(&job, &settings, &mut output, observer));
    assert!(matches!(result, Err(Error::Cancelled)) && asked == 2);
    assert!(output.into_bytes().is_empty());
}

#[test]
fn with_several_threads_no_layer_is_finished_after_the_flag() {
    let settings = Settings::default();
    let layers = slice(&settings, None, &Observer::none()).expect("a print").layers().len();
    for last in [0, 1, layers / 2, layers] {
        let (stop, reports) = (AtomicBool::new(false), AtomicUsize::new(0));
        let watch = |done: usize, _of: usize| {
            reports.fetch_add(1, Ordering::Relaxed);
            stop.store(done >= last, Ordering::Relaxed);
        };
        let observer = Observer::none().on_progress(watch).cancelled_by(&stop);
        assert!(matches!(slice(&settings, Some(4), &observer), Err(Error::Cancelled)), "after {last}");
        assert_eq!(reports.load(Ordering::Relaxed), last + 1, "after {last}");
    }
}
