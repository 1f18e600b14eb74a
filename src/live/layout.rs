//! Where models go: arranged, turned upright, and as well as can be where they do not fit.

use std::collections::BTreeMap;

use nalgebra::Rotation3;

use super::placed::Placed;
use crate::job::{Job, JobError, JobModel, ModelFiles, ModelRole, Project, ProjectModel};
use crate::observer::Observer;
use crate::parallel::Workers;
use crate::pipeline::{Pipeline, load};
use crate::plate::{self, Object, Plate};
use crate::profile::Settings;

/// The project with a position for every model that is printed, each copy as a model of its own. Files whose objects are
/// arranged one by one become a model for each object.
///
/// # Errors
/// Models that do not fit together.
pub(super) fn arranged(
    project: &Project,
    files: &ModelFiles,
    job: &Job,
    settings: &Settings,
    observer: &Observer<'_>,
) -> Result<Project, JobError> {
    let mut free = job.clone();
    free.models.iter_mut().for_each(|model| model.at_mm = None);
    let mut settings = settings.clone();
    settings.plate.arrange = true;
    let (plate, _) = Pipeline.placed(&free, &settings, observer)?;
    let mut groups: BTreeMap<(usize, usize), Vec<&Object>> = BTreeMap::new();
    for object in &plate.objects {
        groups.entry((object.model, object.copy)).or_default().push(object);
    }
    let parts: Vec<&ProjectModel> =
        project.models.iter().filter(|model| model.role == ModelRole::Part).collect();
    let others = project.models.iter().filter(|model| model.role != ModelRole::Part);
    let mut models = Vec::new();
    for ((model, _), objects) in groups {
        let Some(part) = parts.get(model) else { continue };
        let is_kept = part.object.is_some() || objects.len() < 2 || keeps_layout(&objects, part, files);
        let at = |objects: &[&Object], object: Option<usize>| {
            let mut placed = ProjectModel { copies: 1, object, ..(*part).clone() };
            placed.at_mm = Some(foot(&plate, objects));
            placed.rotate_deg[2] += 90.0 * f64::from(objects[0].quarters % 4);
            placed
        };
        if is_kept {
            models.push(at(&objects, part.object));
            continue;
        }
        let mut items: BTreeMap<usize, Vec<&Object>> = BTreeMap::new();
        objects.iter().for_each(|object| items.entry(object.item).or_default().push(object));
        models.extend(items.into_iter().map(|(item, objects)| at(&objects, Some(item))));
    }
    Ok(Project { models: models.into_iter().chain(others.cloned()).collect(), ..project.clone() })
}

/// The middle of the box around objects, seen from above, and their lowest point.
fn foot(plate: &Plate, objects: &[&Object]) -> [f64; 3] {
    if let [only] = objects {
        return only.at_mm;
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for object in objects {
        let [from, to] = plate.meshes[object.mesh].bounds();
        for i in 0..3 {
            let half_mm = (to[i] - from[i]) / 2.0;
            let around = if i < 2 { [-half_mm, half_mm] } else { [0.0, 2.0 * half_mm] };
            low[i] = low[i].min(object.at_mm[i] + around[0]);
            high[i] = high[i].max(object.at_mm[i] + around[1]);
        }
    }
    [(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]]
}

/// Whether objects are as far from each other as their file has them.
fn keeps_layout(objects: &[&Object], part: &ProjectModel, files: &ModelFiles) -> bool {
    const SAME_MM: f64 = 0.01;
    let Some(file) = files.get(&part.file) else { return true };
    let mut alone = Project { models: vec![part.clone()], ..Project::default() };
    alone.models[0] =
        ProjectModel { at_mm: Some([0.0; 3]), copies: 1, settings: BTreeMap::new(), ..part.clone() };
    alone.models[0].rotate_deg[2] += 90.0 * f64::from(objects[0].quarters % 4);
    let known = ModelFiles::from([(part.file.clone(), file.clone())]);
    let placed = alone
        .job(&known, None)
        .and_then(|job| Pipeline.placed(&job, &Settings::default(), &Observer::none()));
    let Ok((plate, _)) = placed else { return false };
    let offset = |object: &Object, first: &Object| [0, 1, 2].map(|i| object.at_mm[i] - first.at_mm[i]);
    plate.objects.len() == objects.len()
        && objects.iter().all(|object| object.quarters == objects[0].quarters)
        && objects.iter().zip(&plate.objects).all(|(is, was)| {
            let (is, was) = (offset(is, objects[0]), offset(was, &plate.objects[0]));
            (0..3).all(|i| (is[i] - was[i]).abs() < SAME_MM)
        })
}

/// The project with one model turned to stand stably and need the least support.
pub(super) fn upright(mut project: Project, number: usize, files: &ModelFiles) -> Result<Project, JobError> {
    let alone =
        Project { models: project.models.get(number).cloned().into_iter().collect(), ..Project::default() };
    let alone = Project {
        models: alone
            .models
            .into_iter()
            .map(|model| ProjectModel { settings: BTreeMap::new(), ..model })
            .collect(),
        ..alone
    };
    let job = alone.job(files, None)?;
    let wanted = &job.models[0];
    let model = read(wanted, &Settings::default(), Workers { observer: &Observer::none() })?;
    let Some(turn) = model.layout.items().first().and_then(|item| plate::upright(&item.mesh)) else {
        return Ok(project);
    };
    let [x, y, z] = project.models[number].rotate_deg.map(f64::to_radians);
    let turn = Rotation3::from_matrix_unchecked(turn) * Rotation3::from_euler_angles(x, y, z);
    let (x, y, z) = turn.euler_angles();
    // A millionth of a degree is rounding.
    let rounded = |angle: f64| (angle.to_degrees() * 1e6).round() / 1e6 + 0.0;
    project.models[number].rotate_deg = [x, y, z].map(rounded);
    Ok(project)
}

fn read(wanted: &JobModel, settings: &Settings, workers: Workers<'_>) -> Result<plate::Model, JobError> {
    let objects = wanted.source.objects(workers)?;
    load::model(wanted, objects, false, settings)
}

/// Where models stand that cannot be printed as they are: where their positions say, or in rows from the front left, so
/// that those for which there is no room lie beyond the edge. `None`: not even that can be said.
pub(super) fn standing(
    revision: u64,
    job: &Job,
    settings: &Settings,
    models: &[(usize, usize)],
    observer: &Observer<'_>,
) -> Option<Placed> {
    let has_positions = job.models.iter().any(|model| model.at_mm.is_some());
    if has_positions {
        let (plate, faults) = Pipeline.placed(job, settings, observer).ok()?;
        return Some(Placed::of(revision, &plate, models, &faults, settings));
    }
    let mut rows = Rows::new(settings);
    let (mut standing, mut numbers) = (Vec::new(), Vec::new());
    for (model, &(number, _)) in job.models.iter().zip(models) {
        let silent = Observer::none();
        let size_mm = size_mm(&read(model, settings, Workers { observer: &silent }).ok()?);
        for copy in 0..model.copies as usize {
            standing.push(JobModel { at_mm: Some(rows.next(size_mm)), copies: 1, ..model.clone() });
            numbers.push((number, copy));
        }
    }
    let job = Job { models: standing, translate_mm: [0.0; 3], ..job.clone() };
    let (plate, faults) = Pipeline.placed(&job, settings, observer).ok()?;
    Some(Placed::of(revision, &plate, &numbers, &faults, settings))
}

/// Extents of a file's layout.
fn size_mm(model: &plate::Model) -> [f64; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for item in model.layout.items() {
        let [from, to] = item.mesh.bounds();
        for at in &item.positions {
            low = [0, 1].map(|i| low[i].min(from[i] + at[i]));
            high = [0, 1].map(|i| high[i].max(to[i] + at[i]));
        }
    }
    [0, 1].map(|i| high[i] - low[i])
}

/// Boxes side by side, row after row.
struct Rows {
    low_mm: [f64; 2],
    width_mm: f64,
    middle_mm: [f64; 2],
    spacing_mm: f64,
    at_mm: [f64; 2],
    depth_mm: f64,
    is_first: bool,
}

impl Rows {
    fn new(settings: &Settings) -> Self {
        let (bed, spacing_mm) = (&settings.bed, settings.plate.spacing.0);
        let low_mm = bed.low_mm().map(|mm| mm + spacing_mm);
        Self {
            low_mm,
            width_mm: bed.size[0].0 - 2.0 * spacing_mm,
            middle_mm: bed.middle_mm(),
            spacing_mm,
            at_mm: low_mm,
            depth_mm: 0.0,
            is_first: true,
        }
    }

    /// Where the next box stands; one that is wider than the bed in the middle of its row.
    fn next(&mut self, [width_mm, depth_mm]: [f64; 2]) -> [f64; 3] {
        let end_mm = self.low_mm[0] + self.width_mm;
        if !self.is_first && self.at_mm[0] + width_mm > end_mm {
            self.at_mm = [self.low_mm[0], self.at_mm[1] + self.depth_mm + self.spacing_mm];
            self.depth_mm = 0.0;
        }
        let is_wide = width_mm > self.width_mm;
        let x = if is_wide { self.middle_mm[0] } else { self.at_mm[0] + width_mm / 2.0 };
        let y = if self.is_first && is_wide { self.middle_mm[1] } else { self.at_mm[1] + depth_mm / 2.0 };
        self.at_mm[0] += width_mm + self.spacing_mm;
        self.depth_mm = self.depth_mm.max(depth_mm);
        self.is_first = false;
        [x, y, 0.0]
    }
}
