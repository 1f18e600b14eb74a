//! The G-code in a package.

use std::io::{self, Cursor, ErrorKind, Read, Seek};

use zip::ZipArchive;

use crate::limits;

/// How packages, and all ZIPs with something in them, begin.
pub(in crate::gcode) const MAGIC: &[u8] = b"PK\x03\x04";
/// Where the G-code of plates is, and how the names of plates begin.
const PLATES: &str = "Metadata/plate_";
pub(super) const GCODE: &str = ".gcode";
/// How the names of their MD5 sums end.
#[cfg(feature = "cli")]
pub(super) const SUM: &str = ".gcode.md5";

/// The G-code in a package.
///
/// # Errors
/// As the system says; it is damaged, or holds the G-code of no plate or of several.
pub(in crate::gcode) fn open(from: impl Read + Seek) -> io::Result<Cursor<Vec<u8>>> {
    let mut package = ZipArchive::new(from).map_err(damaged)?;
    let plates: Vec<String> =
        package.file_names().flatten().filter(|name| is_plate(name)).map(|name| name.into_owned()).collect();
    let wrong = |message: String| io::Error::new(ErrorKind::InvalidData, message);
    match plates.as_slice() {
        [plate] => unpacked(&mut package, plate).map(Cursor::new),
        [] => Err(wrong("it is a package without G-code; export the sliced plate".into())),
        several => {
            let count = several.len();
            Err(wrong(format!("it is a package with the G-code of {count} plates; export one of them alone")))
        }
    }
}

/// Whether a part is the G-code of a plate.
pub(super) fn is_plate(name: &str) -> bool {
    let number = name.strip_prefix(PLATES).and_then(|rest| rest.strip_suffix(GCODE));
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// A part of a package.
///
/// # Errors
/// It is damaged, or larger than what is held in memory.
pub(super) fn unpacked(package: &mut ZipArchive<impl Read + Seek>, name: &str) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let part = package.by_name(name).map_err(damaged)?;
    part.take(limits::VIEW_BYTES + 1).read_to_end(&mut bytes).map_err(damaged)?;
    if bytes.len() as u64 > limits::VIEW_BYTES {
        let message = format!("{name} in it is larger than {} MB", limits::VIEW_BYTES >> 20);
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    Ok(bytes)
}

/// The error of a package that cannot be unpacked.
pub(super) fn damaged(error: impl std::fmt::Display) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, format!("it is damaged or ends early ({error}); export it again"))
}
