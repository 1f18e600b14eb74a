//! Errors of the library as exceptions of the package.

use pathwright::Error;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The exception for an error: its class by kind, with file, place, object and setting.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let class = match error.kind() {
        "input" => "InputError",
        "settings" => "SettingsError",
        "does_not_fit" => "DoesNotFitError",
        "output" => "OutputError",
        "check" => "CheckError",
        "cancelled" => "CancelledError",
        _ => "Error",
    };
    let make = || {
        let details = PyDict::new(py);
        details.set_item("file", error.file())?;
        details.set_item("place", error.place())?;
        details.set_item("object", error.object())?;
        details.set_item("key", error.key())?;
        py.import("pathwright._errors")?.getattr(class)?.call((error.to_string(),), Some(&details))
    };
    make().map_or_else(|error| error, PyErr::from_value)
}

/// The value, or the exception.
pub fn raised<T>(py: Python<'_>, result: Result<T, Error>) -> PyResult<T> {
    result.map_err(|error| exception(py, &error))
}
