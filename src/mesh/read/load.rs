//! Files → repaired meshes.

use std::fs;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::format::{Contents, FileModifier, FileObject};
use super::{formats, stl};
use crate::limits;
use crate::mesh::effect::SavedSettings;
use crate::mesh::error::MeshError;
use crate::mesh::materials::Materials;
use crate::mesh::paint::Paint;
use crate::mesh::report::MeshReport;
use crate::mesh::surface::{Mesh, Modifier};
use crate::mesh::weld::Soup;
use crate::mesh::{repair, units, weld};
use crate::observer::Observer;
use crate::parallel::Workers;

impl Mesh {
    /// Reads and repairs a file (STL, 3MF or OBJ) as one mesh; [`load`] also reports what was done.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        load(path.as_ref()).map(|(mesh, _)| mesh)
    }
}

/// One object of a model file.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// As the file calls it, if it does.
    pub name: Option<String>,
    /// The repaired mesh, in the file's own coordinates.
    pub mesh: Mesh,
    /// What was found and done. Notes on the file as a whole are with its first object.
    pub report: MeshReport,
    /// Where the file puts the mesh's origin: once, or several times, millimetres.
    pub positions: Vec<[f64; 3]>,
    /// The extruder that the file has for it, from 1.
    pub tool: Option<u32>,
    /// The same in parts that the file has different extruders for; empty: one prints all of it.
    pub parts: Vec<Model>,
    /// The settings that the file has for it.
    pub saved: SavedSettings,
    /// What it is made of; only several tools can print it so.
    pub materials: Materials,
}

impl Model {
    /// Its parts, or the whole where it has none, as several tools print them.
    pub(crate) fn by_tool(mut self) -> Vec<Self> {
        let Materials { tool, facets, .. } = std::mem::take(&mut self.materials);
        self.tool = self.tool.or(tool);
        if self.mesh.paint.tools.is_empty() {
            self.mesh.paint.tools = facets;
        }
        let mut parts = std::mem::take(&mut self.parts);
        let Some(first) = parts.first_mut() else { return vec![self] };
        for warning in self.report.warnings {
            if !first.report.warnings.contains(&warning) {
                first.report.warnings.push(warning);
            }
        }
        parts
    }
}

impl From<Mesh> for Model {
    fn from(mesh: Mesh) -> Self {
        let facets = mesh.triangles.len();
        let report = MeshReport::new(&mesh, "memory", facets, &repair::Repairs::default(), Vec::new());
        Self {
            name: None,
            mesh,
            report,
            positions: vec![[0.0; 3]],
            tool: None,
            parts: Vec::new(),
            saved: SavedSettings::default(),
            materials: Materials::default(),
        }
    }
}

/// Reads and repairs a mesh file (STL, 3MF or OBJ) as one mesh, with several objects at their positions in the file.
///
/// # Errors
/// See [`MeshError`]: the file cannot be read, is no model, ends early, or holds nothing that has a volume.
pub fn load(path: &Path) -> Result<(Mesh, MeshReport), MeshError> {
    from_bytes(path, &contents(path)?)
}

/// As [`load`], from the file's contents; `path` is what messages call it.
///
/// # Errors
/// As [`load`].
pub fn from_bytes(path: &Path, data: &[u8]) -> Result<(Mesh, MeshReport), MeshError> {
    let Contents { objects, format, notes } = formats::read(path, data)?.together(path)?;
    let mut objects = objects.into_iter();
    let Some(FileObject { soup, facets, paint, modifiers, .. }) = objects.next() else {
        return Err(MeshError::NoFacets { path: path.to_path_buf() });
    };
    let observer = Observer::none();
    let workers = Workers { observer: &observer };
    let (mesh, mut report) = repaired(path, soup, facets, format, notes, workers)?;
    let modifiers = bodies(path, modifiers, &mut report, workers)?;
    let mesh = mesh.painted(paint).modified(modifiers);
    // Whoever does not scale gets what can be sliced.
    match mesh.bounds().as_flattened().iter().any(|x| x.abs() > f64::from(weld::LIMIT_MM)) {
        true => Err(units::too_large(path, &mesh, [1.0; 3])),
        false => Ok((mesh, report)),
    }
}

/// Reads and repairs every object of a mesh file by itself: several only in a 3MF file. In whatever unit they are,
/// coordinates reach to 1e9.
///
/// # Errors
/// As [`load`].
pub fn load_objects(path: &Path) -> Result<Vec<Model>, MeshError> {
    load_watched(path, Workers { observer: &Observer::none() })
}

/// As [`load_objects`], unless the run is cancelled.
pub(crate) fn load_watched(path: &Path, workers: Workers<'_>) -> Result<Vec<Model>, MeshError> {
    workers.go_on();
    let contents = match large(path)? {
        Some(contents) => contents,
        None => formats::read(path, &contents(path)?)?,
    };
    workers.go_on();
    objects(path, contents, workers)
}

/// What a large file holds that need not be in memory as a whole.
fn large(path: &Path) -> Result<Option<Contents>, MeshError> {
    let length = fs::metadata(path).map_or(0, |file| file.len());
    if length < PARALLEL {
        return Ok(None);
    }
    check_size(path, length)?;
    Ok(stl::read_large(path, |beginning| formats::is_stl(path, beginning)))
}

/// As [`load_objects`], from the file's contents; `path` is what messages call it.
///
/// # Errors
/// As [`load`].
pub fn objects_from_bytes(path: &Path, data: &[u8]) -> Result<Vec<Model>, MeshError> {
    objects_watched(path, data, Workers { observer: &Observer::none() })
}

/// As [`objects_from_bytes`], unless the run is cancelled.
pub(crate) fn objects_watched(
    path: &Path,
    data: &[u8],
    workers: Workers<'_>,
) -> Result<Vec<Model>, MeshError> {
    objects(path, formats::read(path, data)?, workers)
}

/// The models of a file.
fn objects(path: &Path, contents: Contents, workers: Workers<'_>) -> Result<Vec<Model>, MeshError> {
    let Contents { objects, format, mut notes } = contents;
    let mut model = |object: FileObject| {
        let FileObject { name, soup, paint, facets, positions, tool, parts, modifiers, saved, materials } =
            object;
        let (mesh, report) = repaired(path, soup, facets, format, std::mem::take(&mut notes), workers)?;
        let mesh = mesh.painted(paint);
        Ok((
            Model { name, mesh, report, positions, tool, parts: Vec::new(), saved, materials },
            parts,
            modifiers,
        ))
    };
    let mut models = Vec::with_capacity(objects.len());
    for object in objects {
        let (mut whole, parts, modifiers) = model(object)?;
        let modifiers = bodies(path, modifiers, &mut whole.report, workers)?;
        for part in parts {
            let (mut part, ..) = model(part)?;
            part.mesh = part.mesh.modified(modifiers.clone());
            whole.parts.push(Model { saved: whole.saved.clone(), ..part });
        }
        whole.mesh = whole.mesh.modified(modifiers);
        models.push(whole);
    }
    Ok(models)
}

/// Bodies that change what is inside of them, repaired. Those that enclose nothing are left out, with a warning.
fn bodies(
    path: &Path,
    found: Vec<FileModifier>,
    report: &mut MeshReport,
    workers: Workers<'_>,
) -> Result<Vec<Modifier>, MeshError> {
    let mut modifiers = Vec::with_capacity(found.len());
    for FileModifier { name, soup, facets, effect } in found {
        match repaired(path, soup, facets, "", Vec::new(), workers) {
            Ok((mesh, _)) => modifiers.push(Modifier { name, mesh, effect }),
            Err(MeshError::NoVolume { .. } | MeshError::NoFacets { .. }) => {
                let called = name.as_deref().unwrap_or("without a name");
                report.warnings.push(format!("a modifier {called} encloses no volume, and was left out"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(modifiers)
}

/// Bytes from which reading by two threads pays.
const PARALLEL: u64 = 1 << 20;

/// Whether a file of so many bytes is read.
fn check_size(path: &Path, bytes: u64) -> Result<(), MeshError> {
    let too_large = |problem| MeshError::TooLarge { path: path.to_path_buf(), problem };
    if bytes > limits::MODEL_BYTES {
        return Err(too_large(format!("the file has more than {} GB", limits::MODEL_BYTES >> 30)));
    }
    limits::check_memory(bytes.saturating_mul(limits::BYTES_PER_BYTE)).map_err(too_large)
}

fn contents(path: &Path) -> Result<Vec<u8>, MeshError> {
    let failed = |source| MeshError::Read { path: path.to_path_buf(), source };
    let mut file = fs::File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    check_size(path, length)?;
    if length >= PARALLEL
        && let Some(data) = halves(&file, path, length)
    {
        return Ok(data);
    }
    let mut data = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // A pipe has no length and cannot be rewound.
    let _ = file.rewind();
    file.take(limits::MODEL_BYTES + 1).read_to_end(&mut data).map_err(failed)?;
    check_size(path, data.len() as u64)?;
    Ok(data)
}

/// The bytes of a file of this length, read by two threads; `None` where it cannot be done.
fn halves(mut file: &fs::File, path: &Path, length: u64) -> Option<Vec<u8>> {
    let mut data = vec![0; usize::try_from(length).ok()?];
    let middle = data.len() / 2;
    let (first, second) = data.split_at_mut(middle);
    let read_second = || {
        let mut file = fs::File::open(path)?;
        file.seek(SeekFrom::Start(middle as u64))?;
        file.read_exact(second)
    };
    let (first, second) = crate::parallel::join(|| file.read_exact(first), read_second);
    first.and(second).ok().map(|()| data)
}

/// The outside is known of a mesh with fewer clashing edges for each facet than one in this many.
const FEW_CLASHES: usize = 10;

fn repaired(
    path: &Path,
    soup: Soup,
    facets: usize,
    format: &'static str,
    notes: Vec<String>,
    workers: Workers<'_>,
) -> Result<(Mesh, MeshReport), MeshError> {
    if facets > limits::FACETS {
        let problem = format!("{facets} facets; at most {} are read", limits::FACETS);
        return Err(MeshError::TooLarge { path: path.to_path_buf(), problem });
    }
    let size = units::size_of(soup.vertices.iter().copied()).unwrap_or_default();
    let repair::Repaired { vertices, triangles, twins, repairs } = repair::repair(soup, workers);
    // A seam in a surface with one side does not take its outside from the rest.
    let oriented = repairs.clashing * FEW_CLASHES <= triangles.len();
    let mut vertices_mm = Vec::with_capacity(vertices.len());
    for [x, y, z] in vertices {
        vertices_mm.push([f64::from(x), f64::from(y), f64::from(z)]);
    }
    let mesh = Mesh {
        vertices: vertices_mm,
        triangles: triangles.into(),
        twins: twins.into(),
        oriented,
        paint: Paint::default(),
        modifiers: Vec::new(),
    };
    let report = MeshReport::new(&mesh, format, facets, &repairs, notes);
    // A solid is at least as thick on average as the grid is fine.
    if report.volume_mm3.abs() <= 1e-5 * report.area_mm2 {
        return Err(MeshError::NoVolume { path: path.to_path_buf(), size, facets });
    }
    Ok((mesh, report))
}
