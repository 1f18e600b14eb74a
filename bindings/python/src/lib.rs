//! Pathwright from Python: what needs Rust. The interface that people see is `python/pathwright`.

mod error;
mod gcode;
mod order;
mod print;
mod run;
mod schema;
mod task;

use pathwright::{limits, system};
use pyo3::prelude::*;

#[pymodule]
mod _pathwright {
    use super::*;

    #[pymodule_export]
    use super::gcode::{check, reorder, time};
    #[pymodule_export]
    use super::order::order;
    #[pymodule_export]
    use super::print::Print;
    #[pymodule_export]
    use super::schema::schema;
    #[pymodule_export]
    use super::task::{Task, task};

    /// The version.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        limits::watch_memory(system::memory::available_bytes);
        Ok(())
    }

    /// The most memory that this process may have, bytes.
    #[pyfunction]
    fn allow_memory(bytes: u64) {
        system::memory::allow(bytes);
    }
}
