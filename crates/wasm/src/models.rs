//! Models and what is wanted of them → a print, or a comparison.

use std::sync::Arc;

use ordering::{OrderStrategy, chosen};
use pathwright::estimate::Machine;
use pathwright::gcode::write_binary;
use pathwright::job::{Engine, Job, ModelFile, ModelFiles, Project, ProjectModel, Sources};
use pathwright::mesh::Mesh;
use pathwright::motion::LayerMoves;
use pathwright::order::compare;
use pathwright::pipeline::Pipeline;
use pathwright::profile::{Override, Resolved, binary_metadata};
use pathwright::{Beads, Error, Model, Observer, Settings, SlicedJob};
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::{Fault, Result};
use crate::session::project;
use crate::told::{clock, tell};

/// Model files, or one project file.
#[wasm_bindgen]
#[derive(Default)]
pub struct Models {
    files: Vec<(String, Vec<u8>)>,
}

/// A sliced plate.
#[wasm_bindgen]
pub struct Print {
    sliced: SlicedJob,
    resolved: Resolved,
}

#[wasm_bindgen]
impl Models {
    /// No model yet.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    pub fn add(&mut self, name: String, contents: Vec<u8>) {
        self.files.push((name, contents));
    }

    /// Slices a project (JSON) of these models. Tells `progress` and, if wanted, each `layer` as soon as it is finished.
    pub fn slice(&self, project: &str, layers: bool) -> Result<Print> {
        let (job, resolved) = self.job(self::project(project)?)?;
        let on_layer = |layer: &LayerMoves, machine: &Machine| {
            if layers {
                tell_layer(layer, &Beads::of(layer, machine));
            }
        };
        let mut sliced = SlicedJob::followed(&job, &resolved.settings, on_layer, &observer())?;
        sliced.summary.models = self.files.iter().map(|(name, _)| name.clone()).collect();
        Ok(Print { sliced, resolved })
    }

    /// Orders the layers by each strategy: a row each, as JSON.
    pub fn compare(&self, project: &str, strategies: Vec<String>) -> Result<String> {
        let (job, resolved) = self.job(self::project(project)?.by_length())?;
        let strategies = strategies.iter().map(|name| strategy(name)).collect::<Result<Vec<_>>>()?;
        let rows = Pipeline.compare(&job, &resolved.settings, &strategies, &observer())?;
        Ok(compare::to_json(&rows).to_string())
    }
}

impl Models {
    /// The bodies of all models, each standing on the bed.
    pub fn bodies(&self, settings: &Settings) -> Result<Vec<(String, Mesh)>> {
        let mut bodies = Vec::new();
        for (name, contents) in &self.files {
            bodies.extend(Model::from_bytes(name, contents)?.standing_bodies(settings)?);
        }
        Ok(bodies)
    }

    fn job(&self, mut wanted: Project) -> Result<(Job, Resolved)> {
        if let [(name, contents)] = &*self.files
            && let Some((plate, files)) = Project::read(name, contents, &Observer::none())?
        {
            return of_project(wanted, &plate, &files);
        }
        let mut files = ModelFiles::new();
        for (name, contents) in &self.files {
            let read = ModelFile::read(name, &**contents, &Observer::none())?;
            if files.insert(name.clone(), Arc::new(read)).is_some() {
                return Err(Fault::usage(format!(
                    "two models are called {name}; give each a name of its own"
                )));
            }
        }
        if wanted.models.is_empty() {
            let each = |(file, _): &(String, Vec<u8>)| ProjectModel {
                file: file.clone(),
                ..ProjectModel::default()
            };
            wanted.models = self.files.iter().map(each).collect();
        }
        let resolved = wanted.resolve(None).map_err(Error::from)?;
        Ok((wanted.job(&files, None)?, resolved))
    }
}

/// A project from its file, with what is wanted besides on top.
fn of_project(wanted: Project, plate: &Project, files: &ModelFiles) -> Result<(Job, Resolved)> {
    if !wanted.models.is_empty() || !wanted.profile.is_empty() {
        return Err(Fault::usage(
            "a project file says what is on the plate; leave out `models` and `profile`",
        ));
    }
    let settings = wanted.settings.into_iter();
    let sources = Sources {
        presets: None,
        profiles: wanted.profiles,
        overrides: settings.map(|(key, value)| Override { key, value, option: "settings" }).collect(),
    };
    let mut plate = plate.clone();
    plate.pauses.extend(wanted.pauses);
    plate.color_changes.extend(wanted.color_changes);
    plate.allow_floating |= wanted.allow_floating;
    plate.certify |= wanted.certify;
    Ok(sources.project(&plate, files, None)?)
}

/// Tells of a layer: height and roles, and in one array of 64-bit floats the points (three each), widths, speeds and times of all
/// vertices, then the first vertex of each path, and the number of all.
fn tell_layer(layer: &LayerMoves, beads: &Beads) {
    let roles: Vec<_> = beads.roles.iter().map(|role| role.type_name()).collect();
    let about = json!({
        "index": layer.index, "z_mm": layer.z_mm, "height_mm": layer.height_mm, "roles": roles,
        "vertices": beads.points_mm.len(),
    });
    let starts = beads.starts.iter().map(|&start| start as f64);
    let vertices = [&beads.widths_mm, &beads.speeds_mm_s, &beads.times_s].into_iter().flatten().copied();
    let numbers = beads.points_mm.iter().flatten().copied().chain(vertices).chain(starts);
    let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
    tell("layer", &about, Some(&bytes));
}

#[wasm_bindgen]
impl Print {
    /// The file: binary, or text, or as the settings say.
    pub fn gcode(&self, binary: Option<bool>) -> Vec<u8> {
        let settings = &self.resolved.settings;
        let gcode = &self.sliced.gcode;
        if !binary.unwrap_or(settings.gcode.binary) {
            return gcode.clone();
        }
        let mut packed = Vec::new();
        // Memory takes what is written.
        let _ = write_binary(gcode, &binary_metadata(settings), &mut packed);
        packed
    }

    /// Size, time, filament, travel, layers, as JSON.
    pub fn summary(&self) -> String {
        json!(self.sliced.summary).to_string()
    }

    /// What is allowed but unwise about the settings.
    pub fn warnings(&self) -> Vec<String> {
        self.resolved.warnings.iter().map(ToString::to_string).collect()
    }
}

/// A strategy by name.
pub fn strategy(name: &str) -> Result<OrderStrategy> {
    chosen(OrderStrategy::ALL, "strategy", name).map_err(Fault::usage)
}

/// Tells how far a run is.
pub fn observer() -> Observer<'static> {
    let told = |done: usize, of: usize| tell("progress", &json!({ "done": done, "of": of }), None);
    Observer::none().on_progress(told).timed_by(clock)
}
