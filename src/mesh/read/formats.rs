//! Every kind of model file.

use std::path::Path;

use super::format::{Contents, Format};
use super::obj::Obj;
use super::stl::Stl;
use super::threemf::ThreeMf;
use crate::mesh::error::MeshError;

/// Every kind, the one that takes what is left last.
const FORMATS: [&dyn Format; 3] = [&ThreeMf, &Obj, &Stl];

/// Reads a file of any kind.
///
/// # Errors
/// See [`MeshError`]; every object has facets.
pub(super) fn read(path: &Path, data: &[u8]) -> Result<Contents, MeshError> {
    if data.is_empty() {
        return Err(MeshError::EmptyFile { path: path.to_path_buf() });
    }
    let format = FORMATS.into_iter().find(|format| format.recognises(path, data));
    let contents = format.unwrap_or(&Stl).read(path, data)?;
    match contents.objects.iter().all(|object| object.facets > 0) && !contents.objects.is_empty() {
        true => Ok(contents),
        false => Err(MeshError::NoFacets { path: path.to_path_buf() }),
    }
}
