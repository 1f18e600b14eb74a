//! Every kind of model file.

use std::path::Path;

use super::format::{Contents, Format, is_text};
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
    let text = from_utf16(data);
    let data = text.as_deref().unwrap_or(data);
    let format = FORMATS.into_iter().find(|format| format.recognises(path, data));
    let contents = format.unwrap_or(&Stl).read(path, data)?;
    match contents.objects.iter().all(|object| object.facets > 0) && !contents.objects.is_empty() {
        true => Ok(contents),
        false => Err(MeshError::NoFacets { path: path.to_path_buf() }),
    }
}

/// Whether a file that begins so is of no other kind than STL.
pub(super) fn is_stl(path: &Path, beginning: &[u8]) -> bool {
    let [others @ .., _] = FORMATS;
    from_utf16(beginning).is_none() && !others.iter().any(|format| format.recognises(path, beginning))
}

/// Text in 16-bit units, which begins with a byte order mark, as UTF-8.
fn from_utf16(data: &[u8]) -> Option<Vec<u8>> {
    let (mark, units) = data.split_at_checked(2)?;
    let read = match mark {
        b"\xFE\xFF" => u16::from_be_bytes,
        b"\xFF\xFE" => u16::from_le_bytes,
        _ => return None,
    };
    let (units, []) = units.as_chunks::<2>() else { return None };
    let letters = char::decode_utf16(units.iter().map(|unit| read(*unit)));
    let text: String = letters.map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    is_text(text.as_bytes()).then(|| text.into_bytes())
}
