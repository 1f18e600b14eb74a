//! What kinds of model files have in common.

use std::path::Path;

use crate::mesh::effect::{Effect, SavedSettings};
use crate::mesh::error::{Location, MeshError};
use crate::mesh::materials::Materials;
use crate::mesh::paint::Paint;
use crate::mesh::units;
use crate::mesh::weld::{Soup, Welder};

/// A kind of file.
pub(super) trait Format: Sync {
    /// Whether the file is of this kind, by its content, or its name where the content is ambiguous.
    fn recognises(&self, path: &Path, data: &[u8]) -> bool;

    /// Reads a file of this kind.
    ///
    /// # Errors
    /// See [`MeshError`].
    fn read(&self, path: &Path, data: &[u8]) -> Result<Contents, MeshError>;
}

/// The contents of a file.
pub(super) struct Contents {
    pub objects: Vec<FileObject>,
    pub format: &'static str,
    /// What had to be overlooked.
    pub notes: Vec<String>,
}

/// An object of a file, as often as the file wants it.
pub(super) struct FileObject {
    /// As the file calls it.
    pub name: Option<String>,
    pub soup: Soup,
    /// What is painted on it.
    pub paint: Paint,
    /// Facets in the file, before any was left out.
    pub facets: usize,
    /// Where the file puts the object's origin, once or several times, millimetres.
    pub positions: Vec<[f64; 3]>,
    /// The extruder that the file has for it, from 1.
    pub tool: Option<u32>,
    /// What different extruders print of it, where the file says so.
    pub parts: Vec<FileObject>,
    /// Bodies that change what is inside of them.
    pub modifiers: Vec<FileModifier>,
    /// The settings that the file has for it.
    pub saved: SavedSettings,
    /// What it is made of.
    pub materials: Materials,
}

/// A body of a file that changes what is inside of it.
#[derive(Clone)]
pub(super) struct FileModifier {
    pub name: Option<String>,
    pub soup: Soup,
    /// Facets in the file, before any was left out.
    pub facets: usize,
    pub effect: Effect,
}

impl FileModifier {
    /// The same elsewhere.
    fn moved(&self, by_mm: [f64; 3]) -> Self {
        let mut moved = self.clone();
        for vertex in &mut moved.soup.vertices {
            *vertex = [0, 1, 2].map(|i| (f64::from(vertex[i]) + by_mm[i]) as f32);
        }
        moved
    }
}

impl FileObject {
    /// An object without a name, paint and settings.
    pub fn plain(soup: Soup, facets: usize, positions: Vec<[f64; 3]>) -> Self {
        Self {
            name: None,
            soup,
            paint: Paint::default(),
            facets,
            positions,
            tool: None,
            parts: Vec::new(),
            modifiers: Vec::new(),
            saved: SavedSettings::default(),
            materials: Materials::default(),
        }
    }
}

impl Contents {
    /// A file that is one object, where it lies.
    pub fn single(soup: Soup, format: &'static str, facets: usize, notes: Vec<String>) -> Self {
        Self { objects: vec![FileObject::plain(soup, facets, vec![[0.0; 3]])], format, notes }
    }

    /// Everything as one object, each where the file puts it.
    ///
    /// # Errors
    /// A coordinate that is none.
    pub fn together(self, path: &Path) -> Result<Self, MeshError> {
        if let [FileObject { positions, .. }] = self.objects.as_slice()
            && *positions == [[0.0; 3]]
        {
            return Ok(self);
        }
        let count = |object: &FileObject| object.facets * object.positions.len();
        let facets = self.objects.iter().map(count).sum();
        let mut welder = Welder::with_capacity(facets);
        let mut number = 0;
        let mut paint = Paint::default();
        let mut modifiers = Vec::new();
        let objects = &self.objects;
        for FileObject { soup, positions, paint: own, modifiers: bodies, .. } in objects {
            for position in positions {
                modifiers.extend(bodies.iter().map(|body| body.moved(*position)));
                paint.add(own, |corner| [0, 1, 2].map(|i| corner[i] + position[i]));
                for triangle in &soup.triangles {
                    number += 1;
                    let moved = |v: u32| {
                        let vertex = soup.vertices[v as usize];
                        [0, 1, 2].map(|i| (f64::from(vertex[i]) + position[i]) as f32)
                    };
                    let all = || objects.iter().flat_map(|object| object.soup.vertices.iter().copied());
                    let bad = |value| bad_coordinate(path, Location::Facet(number), value, all());
                    welder.push(triangle.map(moved)).map_err(bad)?;
                }
            }
        }
        let mut all = Self::single(welder.finish(), self.format, facets, self.notes);
        for object in &mut all.objects {
            (object.paint, object.modifiers) = (std::mem::take(&mut paint), std::mem::take(&mut modifiers));
        }
        Ok(all)
    }
}

/// Whether a file's name ends so, in any case.
pub(super) fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(wanted))
}

/// Without byte order mark and leading blanks.
pub(super) fn trimmed(data: &[u8]) -> &[u8] {
    data.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(data).trim_ascii_start()
}

/// Whether the first kilobyte is free of control characters; binary facets are full of zeros.
pub(super) fn is_text(data: &[u8]) -> bool {
    data.iter().take(1024).all(|&b| b >= b' ' || b.is_ascii_whitespace())
}

/// The error of a coordinate that is none. `others` are the model's points.
pub(super) fn bad_coordinate(
    path: &Path,
    location: Location,
    value: f32,
    others: impl Iterator<Item = [f32; 3]>,
) -> MeshError {
    let rest = units::size_of(others).map(units::in_words);
    MeshError::Damaged { path: path.to_path_buf(), location, value, rest }
}
