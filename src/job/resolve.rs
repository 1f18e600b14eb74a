//! What a project means: settings in force, and a job.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Job;
use super::error::{InputError, JobError};
use super::model::{JobModel, ModelFiles, ModelSource};
use super::objects::ObjectSettings;
use super::project::{COPIES, ModelRole, Project, ProjectModel};
use crate::mesh::Transform;
use crate::motion::PauseAt;
use crate::presets::{Chosen, Library};
use crate::profile::{
    Layer, Origin, Problem, ProfileError, Resolved, Settings, preset_notes, resolve_layers,
};

/// Nothing stands farther away, millimetres.
const FARTHEST_MM: f64 = 10_000.0;

/// The model files that a project names.
pub(crate) trait Files {
    /// Where a file is read from, and how many objects it has.
    fn find(&self, name: &str) -> Option<(ModelSource, usize)>;

    /// All names.
    fn names(&self) -> Vec<&str>;
}

impl Files for ModelFiles {
    fn find(&self, name: &str) -> Option<(ModelSource, usize)> {
        self.get(name).map(|file| (Arc::clone(file).into(), file.objects().len()))
    }

    fn names(&self) -> Vec<&str> {
        self.keys().map(String::as_str).collect()
    }
}

impl Project {
    /// The same, to be compared or to have its travel shortened: lengths are what counts there, unless its settings name a cost.
    #[must_use]
    pub fn by_length(mut self) -> Self {
        self.settings.entry("order.cost".into()).or_insert_with(|| "length".into());
        self
    }

    /// The settings in force: presets, profiles, the project's profile, its settings.
    ///
    /// # Errors
    /// Every problem of every source at once; presets that are asked for where there is no library, or that it does not hold.
    pub fn resolve(&self, library: Option<&Library>) -> Result<Resolved, ProfileError> {
        self.resolve_with(self.chosen(library)?.as_ref(), &[])
    }

    /// The presets that it names.
    ///
    /// # Errors
    /// As [`Project::resolve`].
    pub fn chosen(&self, library: Option<&Library>) -> Result<Option<Chosen>, ProfileError> {
        let wrong = |message: String| problem(None, message);
        let Some(printer) = &self.presets.printer else {
            let other = self.presets.print.as_ref().or(self.presets.filament.as_ref());
            return match other {
                None => Ok(None),
                Some(name) => Err(wrong(format!("preset `{name}` goes with a printer preset; name one"))),
            };
        };
        let Some(library) = library else {
            return Err(wrong(format!(
                "printer preset `{printer}` is asked for, but there are no presets here"
            )));
        };
        let (print, filament) = (self.presets.print.as_deref(), self.presets.filament.as_deref());
        library.choose(printer, print, filament).map(Some).map_err(|error| wrong(error.to_string()))
    }

    /// The same on presets that were chosen already, with more on top.
    pub(crate) fn resolve_with(
        &self,
        chosen: Option<&Chosen>,
        more: &[Layer<'_>],
    ) -> Result<Resolved, ProfileError> {
        let mut resolved = resolve_layers(self.layers(chosen).chain(more.iter().copied()))?;
        resolved.warnings.splice(0..0, chosen.map(preset_notes).unwrap_or_default());
        Ok(resolved)
    }

    /// Where its settings are from.
    fn layers<'a>(&'a self, chosen: Option<&'a Chosen>) -> impl Iterator<Item = Layer<'a>> {
        let presets = chosen.map(|chosen| Layer::Presets(&chosen.config));
        let profiles = self.profiles.iter().map(|name| Layer::Embedded(name));
        let text = (!self.profile.trim().is_empty()).then_some(Layer::Text(&self.profile));
        let settings = self.settings.iter().map(|(key, value)| Layer::Setting(key, value));
        presets.into_iter().chain(profiles).chain(text).chain(settings)
    }

    /// The job, with models that have been read.
    ///
    /// # Errors
    /// A model whose file is not there, or that cannot be placed so; settings of a model that are wrong, or that no model may
    /// have of its own.
    pub fn job(&self, files: &ModelFiles, library: Option<&Library>) -> Result<Job, JobError> {
        self.job_of(files, library)
    }

    /// The same with any files.
    pub(super) fn job_of(&self, files: &impl Files, library: Option<&Library>) -> Result<Job, JobError> {
        let is_plain = self.models.iter().all(|model| model.settings.is_empty());
        let chosen = if is_plain { None } else { self.chosen(library)? };
        self.job_with(files, chosen.as_ref(), &[])
    }

    /// The same on presets that were chosen already, with more settings on top of the project's; those of its models win.
    pub(crate) fn job_with(
        &self,
        files: &impl Files,
        chosen: Option<&Chosen>,
        more: &[Layer<'_>],
    ) -> Result<Job, JobError> {
        let mut job = Job {
            pauses: stops(&self.pauses)?,
            color_changes: stops(&self.color_changes)?,
            allow_floating: self.allow_floating,
            certify: self.certify,
            ..Job::default()
        };
        let mut known = BTreeMap::new();
        for model in &self.models {
            let mut made = job_model(model, files)?;
            if !model.settings.is_empty() {
                let own = match known.get(&(&model.file, &model.settings)) {
                    Some(own) => Arc::clone(own),
                    None => self.settings_of(model, chosen, more)?,
                };
                known.insert((&model.file, &model.settings), Arc::clone(&own));
                made.settings = Some(own);
            }
            match model.role {
                ModelRole::Part => job.models.push(made),
                ModelRole::SupportEnforcer => job.support_enforcers.push(made),
                ModelRole::SupportBlocker => job.support_blockers.push(made),
            }
        }
        if job.models.is_empty() {
            return Err(wrong(None, "there is no model to print"));
        }
        let is_placed = |model: &&JobModel| model.at_mm.is_some();
        if let (Some(_), Some(other)) =
            (job.models.iter().find(is_placed), job.models.iter().find(|model| !is_placed(model)))
        {
            let file = other.path().display().to_string();
            return Err(wrong(
                Some(file),
                "it has no position, which others have; give all a position, or none",
            ));
        }
        Ok(job)
    }

    /// All settings of a model that has some of its own.
    fn settings_of(
        &self,
        model: &ProjectModel,
        chosen: Option<&Chosen>,
        more: &[Layer<'_>],
    ) -> Result<Arc<Settings>, JobError> {
        for (key, value) in &model.settings {
            if let Some(message) = ObjectSettings::refusal(key) {
                return Err(problem(Some((key.clone(), value.clone())), message).into());
            }
        }
        let own = model.settings.iter().map(|(key, value)| Layer::Setting(key, value));
        let layers = self.layers(chosen).chain(more.iter().copied()).chain(own);
        Ok(Arc::new(resolve_layers(layers)?.settings))
    }
}

fn job_model(model: &ProjectModel, files: &impl Files) -> Result<JobModel, JobError> {
    let refuse = |problem: &str| Err(wrong(Some(model.file.clone()), problem));
    let Some((source, objects)) = files.find(&model.file) else {
        let known = files.names().join(", ");
        let known = if known.is_empty() { "none".to_owned() } else { known };
        return refuse(&format!("there is no such file among the models; there are: {known}"));
    };
    if let Some(object) = model.object.filter(|&object| object >= objects) {
        return refuse(&format!(
            "there is no object {object} in the file, which has {objects}; they count from 0"
        ));
    }
    if model.scale.iter().any(|factor| !factor.is_finite() || *factor == 0.0) {
        return refuse("a scale has factors other than 0");
    }
    if model.rotate_deg.iter().any(|angle| !angle.is_finite()) {
        return refuse("a rotation has three angles in degrees");
    }
    if model.at_mm.is_some_and(|at| at.iter().any(|x| !x.is_finite() || x.abs() > FARTHEST_MM)) {
        return refuse("its position is farther away than 10 m");
    }
    if !(1..=COPIES).contains(&model.copies) {
        return refuse(&format!("copies: 1 to {COPIES} are possible"));
    }
    if model.at_mm.is_some() && model.copies > 1 {
        return refuse(
            "a model with a position stands there once; leave out its copies, or add it again elsewhere",
        );
    }
    if model.role != ModelRole::Part && (model.copies > 1 || !model.settings.is_empty()) {
        return refuse("a body for supports has no copies and no settings of its own");
    }
    Ok(JobModel {
        object: model.object,
        transform: Transform { scale: model.scale, rotate_deg: model.rotate_deg },
        at_mm: model.at_mm,
        copies: model.copies,
        ..JobModel::new(source)
    })
}

fn stops(written: &[String]) -> Result<Vec<PauseAt>, JobError> {
    let stop = |text: &String| text.parse::<PauseAt>().map_err(|error| wrong(None, &error.to_string()));
    written.iter().map(stop).collect()
}

fn wrong(file: Option<String>, problem: &str) -> JobError {
    InputError::Project { file, problem: problem.to_owned() }.into()
}

fn problem(setting: Option<(String, String)>, message: String) -> ProfileError {
    ProfileError { problems: vec![Problem { origin: Origin::Project, setting, message }] }
}
