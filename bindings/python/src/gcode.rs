//! Finished G-code.

use std::sync::Arc;

use pathwright::job::{JobModel, ReorderJob};
use pathwright::mesh::Mesh;
use pathwright::plate::{self, Line};
use pathwright::{Error, Observer};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use super::error::raised;
use super::run::run;
use super::task::{Task, model_file};

/// The G-code in another order, if that is any gain, and the report as JSON.
#[pyfunction]
#[pyo3(signature = (gcode, task, keep_direction, more_retractions, progress=None))]
pub fn reorder<'py>(
    py: Python<'py>,
    gcode: PyBackedBytes,
    task: &Task,
    keep_direction: bool,
    more_retractions: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Option<Bound<'py, PyBytes>>, String)> {
    let resolved = Arc::clone(&task.resolved);
    let job =
        ReorderJob { keep_direction, more_retractions, threads: task.job.threads, ..ReorderJob::default() };
    let done = run(py, progress, move |observer| {
        pathwright::reorder_as(&gcode, &job, &resolved.settings, observer)
    })?;
    let (reordered, report) = raised(py, done)?;
    let json = serde_json::to_string(&report).unwrap_or_default();
    Ok((reordered.map(|gcode| PyBytes::new(py, &gcode)), json))
}

/// The faults of G-code, beside what the models of the task are, as JSON.
#[pyfunction]
pub fn check(py: Python<'_>, gcode: PyBackedBytes, task: &Task) -> PyResult<String> {
    let (job, resolved) = (Arc::clone(&task.job), Arc::clone(&task.resolved));
    let report = run(py, None, move |observer| {
        let mut all = Vec::new();
        for model in &job.models {
            all.extend(bodies(model, Line::thinnest(&resolved.settings), observer)?);
        }
        match all.is_empty() {
            true => pathwright::check(&gcode, &resolved.settings),
            false => pathwright::check_against(&gcode, &all, &resolved.settings),
        }
    })?;
    Ok(serde_json::to_string(&raised(py, report)?).unwrap_or_default())
}

fn bodies(model: &JobModel, line: Line, observer: &Observer<'_>) -> Result<Vec<(String, Mesh)>, Error> {
    let file = model_file(model, observer)?;
    let objects = file.objects().to_vec();
    let copies = model.copies as usize;
    let model = plate::Model::new(model.path(), objects, model.object, &model.transform, line, copies)?;
    Ok(model.layout.standing_bodies())
}

/// How long G-code takes, as JSON.
#[pyfunction]
pub fn time(py: Python<'_>, gcode: PyBackedBytes, task: &Task) -> PyResult<String> {
    let resolved = Arc::clone(&task.resolved);
    let time = run(py, None, move |_| pathwright::time(&gcode, &resolved.settings))?;
    Ok(serde_json::to_string(&raised(py, time)?).unwrap_or_default())
}
