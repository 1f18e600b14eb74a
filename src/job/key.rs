//! The key under which the result of a job may be kept: what its bytes depend on, and nothing else.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::Path;

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::Job;
use super::error::{InputError, JobError};
use super::model::{JobModel, ModelSource, digest, hexadecimal};
use super::project::Project;
use super::resolve::Files;
use crate::motion::PauseAt;
use crate::presets::Library;
use crate::profile::Settings;

impl Job {
    /// A hash (SHA-256, hexadecimal) of all that the G-code and the summary depend on: contents and names of the models,
    /// settings, what is done with them, and the version of the program. Folders and threads do not count. `binary`: whether
    /// binary G-code is written.
    ///
    /// # Errors
    /// A model that cannot be read.
    pub fn key(&self, settings: &Settings, binary: bool) -> Result<String, JobError> {
        self.key_by(settings, binary, |model| match &model.source {
            ModelSource::Path(path) => of_file(path),
            ModelSource::Bytes { bytes, .. } => Ok(digest(bytes)),
            ModelSource::Read(file) => Ok(file.digest().to_owned()),
        })
    }

    /// The same with hashes of the models that are known already.
    fn key_by(
        &self,
        settings: &Settings,
        binary: bool,
        hash: impl Fn(&JobModel) -> Result<String, JobError>,
    ) -> Result<String, JobError> {
        let told = |model: &JobModel| Ok::<_, JobError>(told(model, &hash(model)?));
        let models = |models: &[JobModel]| models.iter().map(told).collect::<Result<Vec<_>, _>>();
        let objects = self.objects.iter().map(|own| json!([name_of(Path::new(&own.object)), own.settings]));
        let stops = |stops: &[PauseAt]| stops.iter().map(|stop| stop_of(*stop)).collect::<Vec<_>>();
        let all = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "binary": binary,
            "settings": settings,
            "models": models(&self.models)?,
            "support_enforcers": models(&self.support_enforcers)?,
            "support_blockers": models(&self.support_blockers)?,
            "translate_mm": self.translate_mm,
            "scale_to_fit": self.scale_to_fit,
            "objects": objects.collect::<Vec<_>>(),
            "pauses": stops(&self.pauses),
            "color_changes": stops(&self.color_changes),
            "dated": self.dated,
            "allow_floating": self.allow_floating,
            "certify": self.certify,
        });
        Ok(digest(all.to_string().as_bytes()))
    }
}

impl Project {
    /// The key of its job before its models are read, from the hashes (SHA-256, hexadecimal) of their files by name.
    ///
    /// # Errors
    /// What [`Project::job`] refuses, but for objects that a file does not have.
    pub fn key(
        &self,
        settings: &Settings,
        hashes: &BTreeMap<String, String>,
        library: Option<&Library>,
    ) -> Result<String, JobError> {
        let job = self.job_of(&Unread(hashes), library)?;
        job.key_by(settings, settings.gcode.binary, |model| {
            Ok(hashes.get(&model.path().display().to_string()).cloned().unwrap_or_default())
        })
    }
}

/// Files that are not read, by name.
struct Unread<'a>(&'a BTreeMap<String, String>);

impl Files for Unread<'_> {
    fn find(&self, name: &str) -> Option<(ModelSource, usize)> {
        self.0.contains_key(name).then(|| (ModelSource::from(name), usize::MAX))
    }

    fn names(&self) -> Vec<&str> {
        self.0.keys().map(String::as_str).collect()
    }
}

fn told(model: &JobModel, hash: &str) -> Value {
    json!({
        "name": name_of(model.path()),
        "hash": hash,
        "object": model.object,
        "scale": model.transform.scale,
        "rotate_deg": model.transform.rotate_deg,
        "at_mm": model.at_mm,
        "copies": model.copies,
        "settings": model.settings.as_deref(),
    })
}

/// Without the folder.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn stop_of(stop: PauseAt) -> Value {
    match stop {
        PauseAt::Layer(layer) => json!({ "layer": layer }),
        PauseAt::Height(height_mm) => json!({ "height_mm": height_mm }),
    }
}

/// Of a file that may be larger than memory.
fn of_file(path: &Path) -> Result<String, JobError> {
    let failed = |source| InputError::Read { file: path.display().to_string(), source };
    let mut file = File::open(path).map_err(failed)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 18];
    loop {
        match io::Read::read(&mut file, &mut buffer).map_err(failed)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            read => hash.update(&buffer[..read]),
        }
    }
}
