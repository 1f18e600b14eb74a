//! Finished G-code, of any slicer, as text or binary.

use pathwright::job::{Project, ReorderJob};
use pathwright::{Error, Settings};
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::Result;
use crate::models::{Models, observer};
use crate::session::project;

/// G-code in another order.
#[wasm_bindgen]
pub struct Reordered {
    gcode: Vec<u8>,
    report: String,
}

#[wasm_bindgen]
impl Reordered {
    /// The file, as text; the one that was given where nothing is gained.
    pub fn gcode(&self) -> Vec<u8> {
        self.gcode.clone()
    }

    /// What is saved, as JSON.
    pub fn report(&self) -> String {
        self.report.clone()
    }
}

/// Shortens the travel in G-code for the printer of a project (JSON).
#[wasm_bindgen]
pub fn reorder(
    gcode: Vec<u8>,
    project: &str,
    keep_direction: bool,
    more_retractions: bool,
) -> Result<Reordered> {
    let job = ReorderJob { keep_direction, more_retractions, ..ReorderJob::default() };
    let settings = resolved(&self::project(project)?.by_length())?;
    let (reordered, report) = pathwright::reorder_as(&gcode, &job, &settings, &observer())?;
    Ok(Reordered { gcode: reordered.unwrap_or(gcode), report: json!(report).to_string() })
}

/// The faults of G-code for the printer of a project (JSON), beside the models that it should print; as JSON.
#[wasm_bindgen]
pub fn check(gcode: &[u8], project: &str, models: &Models) -> Result<String> {
    let settings = settings(project)?;
    let bodies = models.bodies(&settings)?;
    let report = match bodies.is_empty() {
        true => pathwright::check(gcode, &settings)?,
        false => pathwright::check_against(gcode, &bodies, &settings)?,
    };
    Ok(json!(report).to_string())
}

/// How long G-code takes on the printer of a project (JSON), as JSON.
#[wasm_bindgen]
pub fn time(gcode: &[u8], project: &str) -> Result<String> {
    Ok(json!(pathwright::time(gcode, &settings(project)?)?).to_string())
}

fn settings(text: &str) -> Result<Settings> {
    resolved(&project(text)?)
}

fn resolved(project: &Project) -> Result<Settings> {
    Ok(project.resolve(None).map_err(Error::from)?.settings)
}
