//! A plate that is always sliced, for the page.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pathwright::job::Project;
use pathwright::live::{self, DISPLAYED, Event, Options, Results, Subscription};
use pathwright::profile::dump_toml;
use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::error::{Fault, Result};
use crate::presets::Presets;
use crate::told::{clock, tell};

/// Most bytes of models, and of what is kept between slicings: the module has at most 4 GiB.
const MODELS_BYTES: usize = 1 << 30;
const KEPT_BYTES: usize = 256 << 20;

type Work = Box<dyn FnOnce() + Send>;

/// Work that waits for [`Session::step`].
#[derive(Clone, Default)]
struct Waiting(Arc<Mutex<VecDeque<Work>>>);

impl Waiting {
    fn list(&self) -> MutexGuard<'_, VecDeque<Work>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn next(&self) -> Option<Work> {
        self.list().pop_front()
    }
}

/// A plate that is always sliced; whatever happens to it is told.
#[wasm_bindgen]
pub struct Session {
    session: live::Session,
    waiting: Waiting,
    _subscription: Subscription,
}

#[wasm_bindgen]
impl Session {
    /// An empty plate.
    #[wasm_bindgen(constructor)]
    #[allow(clippy::new_without_default, reason = "JavaScript calls it")]
    pub fn new() -> Self {
        let waiting = Waiting::default();
        let begun = waiting.clone();
        let session = live::Session::new(Options {
            spawn: Arc::new(move |work| begun.list().push_back(work)),
            clock,
            library: None,
            models_bytes: MODELS_BYTES,
            kept_bytes: KEPT_BYTES,
        });
        let subscription = session.subscribe(|event| {
            let walls = if let Event::Walls(walls) = event { Some(&*walls.packed) } else { None };
            tell(event.name(), &json!(event), walls);
            true
        });
        Self { session, waiting, _subscription: subscription }
    }

    /// Takes presets that projects may name from now on.
    pub fn set_presets(&self, presets: &Presets) {
        self.session.set_library(presets.library());
    }

    /// Slices the next revision that is wanted; whether there was one.
    pub fn step(&self) -> bool {
        self.waiting.next().map(|work| work()).is_some()
    }

    /// Adds a model or a project; what it holds, as JSON.
    pub fn add(&self, name: &str, contents: &[u8]) -> Result<String> {
        Ok(json!(self.session.add(name, contents)?).to_string())
    }

    /// The triangles of an object, packed.
    pub fn mesh(&self, file: &str, object: usize) -> Result<Vec<u8>> {
        Ok(self.session.mesh(file, object, DISPLAYED)?)
    }

    /// The faces that an object can lie on, as JSON.
    pub fn faces(&self, file: &str, object: usize) -> Result<String> {
        Ok(json!(self.session.faces(file, object)?).to_string())
    }

    /// Wants this project (JSON) sliced and no other. The number of the revision.
    pub fn set_project(&self, project: &str) -> Result<f64> {
        Ok(self.session.set_project(self::project(project)?) as f64)
    }

    /// Wants two projects sliced. The numbers of the revisions.
    pub fn compare(&self, a: &str, b: &str) -> Result<Vec<f64>> {
        Ok(self.session.compare([project(a)?, project(b)?]).map(|revision| revision as f64).to_vec())
    }

    /// The project with positions for all models.
    pub fn arrange(&self, project: &str) -> Result<String> {
        Ok(json!(self.session.arrange(&self::project(project)?)?).to_string())
    }

    /// The project with a model turned to need the least support.
    pub fn orient(&self, project: &str, model: usize) -> Result<String> {
        Ok(json!(self.session.orient(&self::project(project)?, model)?).to_string())
    }

    /// The packed preview of a revision; none if that is no longer kept.
    pub fn preview(&self, revision: f64) -> Option<Vec<u8>> {
        Some(self.results(revision)?.preview?.to_vec())
    }

    /// The G-code of a revision, text or binary as its settings say; none if that is no longer kept.
    pub fn gcode(&self, revision: f64) -> Option<Vec<u8>> {
        Some(self.results(revision)?.file()?.to_vec())
    }

    /// A project as a file (3MF).
    pub fn project_file(&self, project: &str) -> Result<Vec<u8>> {
        Ok(self.session.project_file(&self::project(project)?)?)
    }

    /// The settings of a project in force, as a profile (TOML).
    pub fn profile(&self, project: &str) -> Result<String> {
        Ok(dump_toml(&self.session.settings(&self::project(project)?)?))
    }
}

impl Session {
    fn results(&self, revision: f64) -> Option<Results> {
        self.session.results(revision as u64)
    }
}

/// A project from its JSON.
pub fn project(text: &str) -> Result<Project> {
    serde_json::from_str(text).map_err(|error| Fault::usage(format!("the project: {error}")))
}
