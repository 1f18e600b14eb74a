//! The settings in force, as a page shows them.

use std::collections::BTreeMap;

use geometry::real;
use serde::Serialize;
use serde_json::Value;

use crate::job::{Project, ProjectModel};
use crate::plate::{BedSettings, BedShape};
use crate::presets::Chosen;
use crate::profile::{self, Problem, ProfileError, Settings, dump_json, preset_notes};

/// The settings in force.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resolved {
    /// The revision.
    pub revision: u64,
    /// Dotted keys and values, as they are typed.
    pub settings: BTreeMap<String, String>,
    /// Where each value was written.
    pub origins: BTreeMap<String, String>,
    /// Of the settings that the project overrides, what presets and profiles say.
    pub base: BTreeMap<String, String>,
    /// What must be mended before anything is sliced.
    pub problems: Vec<SettingProblem>,
    /// What is allowed but unwise.
    pub warnings: Vec<String>,
    /// The bed.
    pub bed: Bed,
    /// What of presets is not taken over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_taken_over: Option<String>,
}

/// A setting that must be mended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SettingProblem {
    /// Its key, if it is one setting's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// The model whose own setting it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<usize>,
    /// What is wrong and how to mend it.
    pub message: String,
}

/// The bed that everything stands on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bed {
    /// `rectangle` or `circle`.
    pub shape: &'static str,
    /// Width and depth, millimetres.
    pub size_mm: [f64; 2],
    /// The corner of least X and Y of the box around it, in the bed's coordinates.
    pub origin_mm: [f64; 2],
    /// Printable height.
    pub height_mm: f64,
    /// Corners one after the other.
    pub outline: Vec<[f64; 2]>,
}

/// Corners of a round bed.
const CORNERS: usize = 96;

impl Bed {
    fn of(bed: &BedSettings) -> Self {
        let (low, high, middle) = (bed.low_mm(), bed.high_mm(), bed.middle_mm());
        let (shape, outline) = match bed.shape {
            BedShape::Rectangular => ("rectangle", vec![low, [high[0], low[1]], high, [low[0], high[1]]]),
            BedShape::Round => {
                let radius_mm = bed.size[0].0 / 2.0;
                let corner = |i: usize| {
                    let (sin, cos) = real::sin_cos(std::f64::consts::TAU * i as f64 / CORNERS as f64);
                    [middle[0] + radius_mm * cos, middle[1] + radius_mm * sin]
                };
                ("circle", (0..CORNERS).map(corner).collect())
            }
        };
        let size_mm = [0, 1].map(|i| high[i] - low[i]);
        Self { shape, size_mm, origin_mm: low, height_mm: bed.height.0, outline }
    }
}

impl Resolved {
    /// Of a project; beside it the settings, with their sources, if all are sound.
    pub(super) fn of(
        revision: u64,
        project: &Project,
        chosen: Option<&Chosen>,
    ) -> (Self, Option<profile::Resolved>) {
        let plain = Project { settings: BTreeMap::new(), ..project.clone() };
        let under = plain.resolve_with(chosen, &[]);
        let all = project.resolve_with(chosen, &[]);
        let problems = all.as_ref().err().map(problems).unwrap_or_default();
        let shown = match (&all, &under) {
            (Ok(all), _) => all.clone(),
            // What is sound of it is shown nevertheless.
            (Err(error), _) => without(project, error)
                .resolve_with(chosen, &[])
                .or_else(|_| under.clone())
                .or_else(|_| profile::resolve(&[], &[]))
                .unwrap_or_else(|_| unreachable!("the defaults are sound")),
        };
        let base = under.map(|under| values(&under)).unwrap_or_default();
        let overridden = |(key, _): &(String, String)| project.settings.contains_key(key);
        let notes: Vec<Problem> = chosen.map(preset_notes).unwrap_or_default();
        let warnings = shown.warnings.iter().filter(|warning| !notes.contains(warning));
        let lines: Vec<String> = notes.iter().map(|note| note.message.clone()).collect();
        let resolved = Self {
            revision,
            settings: values(&shown),
            origins: shown.origins.iter().map(|(key, origin)| (key.clone(), origin.to_string())).collect(),
            base: base.into_iter().filter(overridden).collect(),
            problems,
            warnings: warnings.map(ToString::to_string).collect(),
            bed: Bed::of(&shown.settings.bed),
            not_taken_over: (!lines.is_empty()).then(|| lines.join("\n")),
        };
        (resolved, all.ok())
    }

    /// The same where the settings cannot even be looked for.
    pub(super) fn failed(revision: u64, error: &ProfileError) -> Self {
        let defaults = Settings::default();
        Self {
            revision,
            settings: BTreeMap::new(),
            origins: BTreeMap::new(),
            base: BTreeMap::new(),
            problems: problems(error),
            warnings: Vec::new(),
            bed: Bed::of(&defaults.bed),
            not_taken_over: None,
        }
    }

    /// Adds problems with the own settings of models.
    pub(super) fn add_of_models(&mut self, project: &Project, error: &ProfileError, chosen: Option<&Chosen>) {
        let own = |(number, model): (usize, &ProjectModel)| {
            let own = model.settings.keys().cloned().collect::<Vec<_>>();
            let merged = [&project.settings, &model.settings].into_iter().flatten();
            let settings = merged.map(|(key, value)| (key.clone(), value.clone())).collect();
            let alone = Project { settings, ..project.clone() }.resolve_with(chosen, &[]);
            let mut found = alone.err().map(|error| problems(&error)).unwrap_or_default();
            found.iter_mut().for_each(|problem| problem.model = Some(number));
            (own, number, found)
        };
        let mut of_models: Vec<SettingProblem> = Vec::new();
        for (keys, number, found) in project.models.iter().enumerate().map(own) {
            of_models.extend(found);
            // What no model may have of its own is sound otherwise.
            for problem in problems(error) {
                let is_own = problem.key.as_ref().is_some_and(|key| keys.contains(key));
                if is_own && !of_models.iter().any(|p| p.model == Some(number) && p.key == problem.key) {
                    of_models.push(SettingProblem { model: Some(number), ..problem });
                }
            }
        }
        self.problems.extend(if of_models.is_empty() { problems(error) } else { of_models });
    }
}

fn problems(error: &ProfileError) -> Vec<SettingProblem> {
    let problem = |problem: &Problem| SettingProblem {
        key: problem.setting.as_ref().map(|(key, _)| key.clone()),
        model: None,
        message: problem.message.clone(),
    };
    error.problems.iter().map(problem).collect()
}

/// The project without the settings that are wrong.
fn without(project: &Project, error: &ProfileError) -> Project {
    let mut sound = project.clone();
    for (key, _) in error.problems.iter().filter_map(|problem| problem.setting.as_ref()) {
        sound.settings.remove(key);
    }
    sound
}

/// Every value as it is typed after `--set`.
fn values(resolved: &profile::Resolved) -> BTreeMap<String, String> {
    let text = |value: &Value| match &value["value"] {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    };
    let all = dump_json(resolved);
    let all = all.as_object().into_iter().flatten();
    all.map(|(key, value)| (key.clone(), text(value))).collect()
}
