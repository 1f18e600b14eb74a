//! A print as Python has it.

use std::sync::{Arc, OnceLock};

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pathwright::SlicedJob;
use pathwright::gcode::write_binary;
use pathwright::profile::{Resolved, Settings, binary_metadata};
use pathwright::toolpath::Role;
use pathwright::view::{Scene, layer_png, layer_svg};
use pyo3::exceptions::{PyIndexError, PyOSError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use super::run::run;

/// First vertex of each path, roles, points, widths, speeds, times.
type Paths<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<u8>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// A sliced plate.
#[pyclass(frozen, module = "pathwright._pathwright")]
pub struct Print {
    /// The G-code.
    #[pyo3(get)]
    gcode: Py<PyBytes>,
    /// The summary as JSON.
    #[pyo3(get)]
    summary: String,
    /// Without its G-code.
    sliced: SlicedJob,
    resolved: Arc<Resolved>,
    scene: Arc<OnceLock<Scene>>,
}

impl Print {
    pub fn new(
        py: Python<'_>,
        mut sliced: SlicedJob,
        resolved: &Arc<Resolved>,
        models: &[String],
    ) -> PyResult<Self> {
        sliced.summary.models = models.to_vec();
        let gcode = PyBytes::new(py, &std::mem::take(&mut sliced.gcode)).unbind();
        Ok(Self {
            gcode,
            summary: serde_json::to_string(&sliced.summary).unwrap_or_default(),
            sliced,
            resolved: Arc::clone(resolved),
            scene: Arc::default(),
        })
    }

    fn settings(&self) -> &Settings {
        &self.resolved.settings
    }

    /// What the program's pictures show of a layer.
    fn drawn(
        &self,
        py: Python<'_>,
        layer: usize,
        draw: impl FnOnce(&Scene, &pathwright::view::Layer) -> Vec<u8> + Send + 'static,
    ) -> PyResult<Vec<u8>> {
        let gcode: PyBackedBytes = self.gcode.bind(py).clone().into();
        let (scene, resolved) = (Arc::clone(&self.scene), Arc::clone(&self.resolved));
        let drawn = run(py, None, move |_| {
            let scene = scene.get_or_init(|| Scene::read(&gcode, &resolved.settings));
            scene.layers.get(layer).map(|layer| draw(scene, layer))
        })?;
        drawn.ok_or_else(|| PyIndexError::new_err(format!("there is no layer {layer}")))
    }
}

#[pymethods]
impl Print {
    fn __len__(&self) -> usize {
        self.sliced.layers.len()
    }

    /// Height of a layer's nozzle over the bed, and of the layer, millimetres.
    fn heights(&self, layer: usize) -> (f64, f64) {
        let layer = &self.sliced.layers[layer];
        (layer.z_mm, layer.height_mm)
    }

    /// What a layer prints. The arrays are those that Rust made.
    fn paths<'py>(&self, py: Python<'py>, layer: usize) -> PyResult<Paths<'py>> {
        let beads = py.detach(|| self.sliced.beads(layer));
        let vertices = beads.points_mm.len();
        let starts = beads.starts.into_iter().map(|start| start as i64).collect();
        let roles = beads.roles.into_iter().map(|role| role as u8).collect();
        let points = PyArray1::from_vec(py, beads.points_mm.into_flattened());
        Ok((
            PyArray1::from_vec(py, starts),
            PyArray1::from_vec(py, roles),
            points.reshape([vertices, 3])?,
            PyArray1::from_vec(py, beads.widths_mm),
            PyArray1::from_vec(py, beads.speeds_mm_s),
            PyArray1::from_vec(py, beads.times_s),
        ))
    }

    /// The names of roles, by their numbers.
    #[staticmethod]
    fn roles() -> Vec<&'static str> {
        Role::ALL.iter().map(|role| role.type_name()).collect()
    }

    /// The print as binary G-code.
    fn binary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let gcode: PyBackedBytes = self.gcode.bind(py).clone().into();
        let metadata = binary_metadata(self.settings());
        let packed = run(py, None, move |_| {
            let mut packed = Vec::new();
            write_binary(&gcode, &metadata, &mut packed).map(|()| packed)
        })?;
        Ok(PyBytes::new(py, &packed.map_err(|error| PyOSError::new_err(error.to_string()))?))
    }

    /// A layer as SVG.
    fn svg(&self, py: Python<'_>, layer: usize) -> PyResult<String> {
        let drawn = self.drawn(py, layer, |scene, layer| layer_svg(scene, layer).into_bytes())?;
        Ok(String::from_utf8_lossy(&drawn).into_owned())
    }

    /// A layer as PNG, its longer side this many pixels long.
    fn png<'py>(&self, py: Python<'py>, layer: usize, side: u32) -> PyResult<Bound<'py, PyBytes>> {
        let drawn = self.drawn(py, layer, move |scene, layer| layer_png(scene, layer, side))?;
        Ok(PyBytes::new(py, &drawn))
    }
}
