//! A file's models, scaled and turned, at their positions relative to each other.

use std::path::Path;

use super::layout::{Item, Layout};
use super::slivers::Line;
use crate::mesh::{MeshError, MeshReport, Model as Object, Transform, UnitHint, load_objects, units};

/// The objects of a file, not placed yet.
#[derive(Clone, Debug)]
pub struct Model {
    /// Its models.
    pub layout: Layout,
    /// Of each model what was found and done, before it was transformed.
    pub reports: Vec<MeshReport>,
    /// The first model's box, transformed.
    pub first_box: [[f64; 3]; 2],
    /// The unit that the size points to, with the file's name.
    pub hint: Option<String>,
    /// The same for programs, without the file's name.
    pub unit: Option<UnitHint>,
    /// The names of the file: without folder and extension, without folder, and whole.
    pub names: [String; 3],
}

/// Reads and repairs a file's models, and transforms them. `line` is the thinnest that is printed, `copies` how many of
/// the file are wanted.
///
/// # Errors
/// As [`load_objects`]; a transform that leaves nothing, a model longer than 10 m.
pub fn read_file(path: &Path, transform: &Transform, line: Line, copies: usize) -> Result<Model, MeshError> {
    Model::new(path, load_objects(path)?, None, transform, line, copies)
}

impl Model {
    /// The objects of a file, transformed, or one of them alone, counted from 0; see [`read_file`].
    ///
    /// # Errors
    /// A transform that leaves nothing, a model longer than 10 m, an object that the file does not have.
    pub fn new(
        path: &Path,
        read: Vec<Object>,
        object: Option<usize>,
        transform: &Transform,
        line: Line,
        copies: usize,
    ) -> Result<Self, MeshError> {
        let several = read.len() > 1;
        if let Some(object) = object.filter(|&object| object >= read.len()) {
            return Err(MeshError::NoObject { path: path.to_path_buf(), object, objects: read.len() });
        }
        let (mut items, mut reports) = (Vec::with_capacity(read.len()), Vec::with_capacity(read.len()));
        let mut first_box = None;
        let (mut low, mut high, mut volume_mm3) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0);
        for (number, Object { name: own, mesh, mut report, positions, tool, saved, .. }) in (1..).zip(read) {
            if object.is_some_and(|wanted| wanted + 1 != number) {
                continue;
            }
            let unnamed = if several { format!("{} {number}", name_of(path)) } else { name_of(path) };
            let (mesh, was_at) = units::moved_near_origin(path, mesh, transform)?;
            report.warnings.extend(units::precision_warning(was_at));
            let failed = |source| MeshError::Transform { path: path.to_path_buf(), source };
            let mesh = transform.apply(mesh).map_err(failed)?;
            let plus = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
            let positions: Vec<[f64; 3]> =
                positions.iter().map(|position| transform.of_point(plus(*position, was_at))).collect();
            let bounds = mesh.bounds();
            first_box.get_or_insert_with(|| bounds.map(|corner| plus(corner, transform.of_point(was_at))));
            for &position in &positions {
                let [min, max] = bounds.map(|corner| plus(corner, position));
                low = [0, 1, 2].map(|i| low[i].min(min[i]));
                high = [0, 1, 2].map(|i| high[i].max(max[i]));
            }
            let grown = transform.scale.iter().product::<f64>().abs() * positions.len() as f64;
            volume_mm3 += grown * report.volume_mm3.abs();
            // An object alone is called as its file is.
            let item = Item {
                tool,
                saved,
                ..Item::new(own.filter(|_| several).unwrap_or(unnamed), mesh, positions)
            };
            items.push(if report.shells > 1 { item.without_slivers(line) } else { item });
            reports.push(report);
        }
        let size_mm = [0, 1, 2].map(|i| high[i] - low[i]);
        let unit = UnitHint::of(size_mm, volume_mm3);
        Ok(Self {
            layout: Layout::new(name_of(path), items, copies),
            reports,
            first_box: first_box.unwrap_or_default(),
            hint: unit
                .as_ref()
                .map(|hint| format!("{}: {}", path.display(), hint.told(size_mm, transform.scale))),
            unit,
            names: [
                name_of(path),
                path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                path.display().to_string(),
            ],
        })
    }
}

/// What a file is called: its name without folder and ending.
pub fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
