//! Where the settings of a run are from.

use std::sync::Arc;

use super::Job;
use super::error::JobError;
use super::model::ModelFiles;
use super::objects::ObjectSettings;
use super::project::Project;
use crate::presets::{Chosen, Library};
use crate::profile::{
    Assignments, Layer, Origin, Override, Problem, ProfileError, Resolved, Settings, dump_toml, embedded,
    preset_notes,
};

/// Where the settings of a run are from: presets, profiles on top of them, single settings on top of these.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// Presets of another slicer.
    pub presets: Option<Chosen>,
    /// Names of embedded profiles, and files.
    pub profiles: Vec<String>,
    /// Single settings.
    pub overrides: Vec<Override>,
}

impl Sources {
    /// The settings in force, with more on top.
    ///
    /// # Errors
    /// Every problem of every source at once.
    pub fn resolve(&self, more: &[Override]) -> Result<Resolved, ProfileError> {
        self.resolved(self.read(more))
    }

    /// What is written in them, and more on top: the first half of [`Sources::resolve`].
    pub(crate) fn read(&self, more: &[Override]) -> Assignments {
        Assignments::read(self.layers().into_iter().chain(more.iter().map(Layer::Override)))
    }

    /// What that comes to: the other half.
    pub(crate) fn resolved(&self, read: Assignments) -> Result<Resolved, ProfileError> {
        let mut resolved = read.resolved()?;
        resolved.warnings.splice(0..0, self.presets.as_ref().map(preset_notes).unwrap_or_default());
        Ok(resolved)
    }

    /// The settings of an object that has some of its own: these on top of all others.
    ///
    /// # Errors
    /// As [`Sources::resolve`]; a setting that no object may have of its own.
    pub fn of_object(&self, own: &[Override]) -> Result<Arc<Settings>, ProfileError> {
        let refused = own.iter().filter_map(|Override { key, value, option }| {
            let message = ObjectSettings::refusal(key)?;
            let origin = Origin::Option(option);
            Some(Problem { origin, setting: Some((key.clone(), value.clone())), message })
        });
        let problems: Vec<Problem> = refused.collect();
        if problems.is_empty() {
            Ok(Arc::new(self.resolve(own)?.settings))
        } else {
            Err(ProfileError { problems })
        }
    }

    /// What a project comes to, with these sources on top of its own. `library`: where its presets are looked for.
    ///
    /// # Errors
    /// As [`Project::resolve`] and [`Project::job`].
    pub fn project(
        &self,
        project: &Project,
        files: &ModelFiles,
        library: Option<&Library>,
    ) -> Result<(Job, Resolved), JobError> {
        let chosen = project.chosen(library)?;
        let more = self.layers();
        let resolved = project.resolve_with(chosen.as_ref(), &more)?;
        Ok((project.job_with(files, chosen.as_ref(), &more)?, resolved))
    }

    /// The profile, as a project holds it, that gives the settings in force: names of profiles and values, or where files and
    /// presets are on this machine alone, every setting.
    pub fn as_project(&self, resolved: &Resolved) -> Project {
        let is_embedded = |profile: &String| embedded(profile).is_some();
        match self.presets.is_none() && self.profiles.iter().all(is_embedded) {
            true => Project {
                profiles: self.profiles.clone(),
                settings: self.overrides.iter().map(|o| (o.key.clone(), o.value.clone())).collect(),
                ..Project::default()
            },
            false => Project { profile: dump_toml(resolved), ..Project::default() },
        }
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        let presets = self.presets.iter().map(|chosen| Layer::Presets(&chosen.config));
        let profiles = self.profiles.iter().map(|profile| Layer::Profile(profile));
        presets.chain(profiles).chain(self.overrides.iter().map(Layer::Override)).collect()
    }
}
