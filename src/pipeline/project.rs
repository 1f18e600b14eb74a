//! Project files: the plate as every slicer sees it, with the project itself.

use crate::job::{InputError, Job, JobError, JobModel, ModelFile, ModelFiles, ModelSource, Project};
use crate::mesh::{Mesh, PackageItem, PackageObject, Transform, quarter_turned, write_package};
use crate::parallel::Workers;
use crate::plate::{Object, Plate};
use crate::profile::Settings;
use geometry::Point;

use super::load::{self, Loaded};

/// Where the unit vectors and the origin go, millimetres.
type Columns = [[f64; 3]; 4];

/// Objects of files, at their positions.
#[derive(Default)]
struct Build {
    /// Numbers of the model among those of the job, and of the object in its file.
    objects: Vec<(usize, usize)>,
    items: Vec<PackageItem>,
}

impl Build {
    /// Adds an object of a model, which may be there already.
    fn put(&mut self, job: &Job, (model, number): (usize, usize), columns: Columns) {
        let is_same = |&(other, of_other): &(usize, usize)| {
            of_other == number && job.models[other].source == job.models[model].source
        };
        let object = self.objects.iter().position(is_same).unwrap_or_else(|| {
            self.objects.push((model, number));
            self.objects.len() - 1
        });
        self.items.push(PackageItem { object, columns });
    }

    /// Objects where they stand on the bed.
    fn on_bed(&mut self, job: &Job, plate: &Plate) {
        for object in &plate.objects {
            let model = &job.models[object.model];
            let number = model.object.unwrap_or(object.item);
            let columns = columns(mesh_of(model, number), &model.transform, plate, object);
            self.put(job, (object.model, number), columns);
        }
    }

    /// Objects where their files have them.
    fn as_in_files(&mut self, job: &Job) {
        for (index, model) in job.models.iter().enumerate() {
            let objects = file_of(model).map_or(&[][..], ModelFile::objects);
            for (number, object) in objects.iter().enumerate() {
                if model.object.is_some_and(|wanted| wanted != number) {
                    continue;
                }
                for position in &object.positions {
                    let mut columns = linear(&model.transform, 0);
                    columns[3] = model.transform.of_point(*position);
                    self.put(job, (index, number), columns);
                }
            }
        }
    }
}

/// A project file. Models that do not fit the bed lie where their files put them.
pub(super) fn write(
    project: &Project,
    files: &ModelFiles,
    job: &Job,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<Vec<u8>, JobError> {
    let loaded = load::place(load::read(job, settings, workers)?, job, settings).ok();
    let mut build = Build::default();
    match &loaded {
        Some(Loaded { plate, .. }) => build.on_bed(job, plate),
        None => build.as_in_files(job),
    }
    let Build { objects: used, mut items } = build;
    let names: Vec<String> = used.iter().map(|&(model, number)| name(&job.models[model], number)).collect();
    let mut objects: Vec<PackageObject<'_>> = Vec::with_capacity(used.len());
    for (&(model, number), name) in used.iter().zip(&names) {
        let mesh = mesh_of(&job.models[model], number);
        objects.extend(mesh.map(|mesh| PackageObject { name, mesh, is_support: false }));
    }
    let modifiers = loaded.iter().flat_map(|loaded| &loaded.modifiers);
    for (plate, name) in modifiers.zip(["support enforcer", "support blocker"]) {
        let first = objects.len();
        objects.extend(plate.meshes.iter().map(|mesh| PackageObject { name, mesh, is_support: true }));
        items.extend(plate.objects.iter().map(|object| PackageItem {
            object: first + object.mesh,
            columns: moved(linear(&Transform::default(), 0), object.offset),
        }));
    }
    let text = serde_json::to_vec_pretty(project).map_err(|error| refused(&error))?;
    let is_used = |name: &String| project.models.iter().any(|model| model.file == *name);
    let own = files.iter().filter(|(name, _)| is_used(name)).map(|(_, file)| file);
    write_package(&objects, &items, &Project::parts(&text, own)).map_err(|error| refused(&error))
}

fn refused(error: &dyn std::error::Error) -> JobError {
    InputError::Project { file: None, problem: format!("it cannot be written: {error}") }.into()
}

fn file_of(model: &JobModel) -> Option<&ModelFile> {
    if let ModelSource::Read(file) = &model.source { Some(file) } else { None }
}

fn mesh_of(model: &JobModel, number: usize) -> Option<&Mesh> {
    Some(&file_of(model)?.objects().get(number)?.mesh)
}

/// What an object is called, or else its file.
fn name(model: &JobModel, number: usize) -> String {
    let own = file_of(model).and_then(|file| file.objects().get(number)?.name.clone());
    own.unwrap_or_else(|| model.path().file_stem().unwrap_or_default().to_string_lossy().into_owned())
}

/// Where the unit vectors go by a transform and quarter turns about Z.
fn linear(transform: &Transform, quarters: u32) -> Columns {
    let unit = |axis: usize| {
        let [x, y, z] = transform.of_point([0, 1, 2].map(|i| f64::from(u8::from(i == axis))));
        let [x, y] = quarter_turned([x, y], quarters);
        [x, y, z]
    };
    [unit(0), unit(1), unit(2), [0.0; 3]]
}

fn moved(mut columns: Columns, offset: Point) -> Columns {
    let [x, y] = offset.mm();
    columns[3] = [columns[3][0] + x, columns[3][1] + y, columns[3][2]];
    columns
}

/// Where an object is put: its first corner tells how far it is moved.
fn columns(mesh: Option<&Mesh>, transform: &Transform, plate: &Plate, object: &Object) -> Columns {
    let mut columns = linear(transform, object.quarters);
    let placed = plate.meshes.get(object.mesh).and_then(|mesh| mesh.vertices().first());
    if let (Some(is), Some(was)) = (placed, mesh.and_then(|mesh| mesh.vertices().first())) {
        let turned = |i: usize| (0..3).map(|axis| columns[axis][i] * was[axis]).sum::<f64>();
        columns[3] = [0, 1, 2].map(|i| is[i] - turned(i));
    }
    moved(columns, object.offset)
}
