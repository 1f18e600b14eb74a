//! How G-code is held: as text, binary or in a package.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use bgcode::MAGIC;

use super::package;

/// Endings of files with G-code as text.
const ENDINGS: [&str; 6] = ["gcode", "gco", "gc", "g", "nc", "ngc"];
/// Endings of files with binary G-code.
const BINARY_ENDINGS: [&str; 2] = ["bgcode", "bgc"];
/// The ending of packages with G-code.
const PACKAGE_ENDING: &str = ".gcode.3mf";

/// How a file holds G-code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// As text.
    #[default]
    Text,
    /// As binary G-code.
    Binary,
    /// In a package, as Bambu Studio writes it.
    Package,
}

impl Form {
    /// The form that a file's name tells; text where it tells none.
    pub fn of_name(path: &Path) -> Self {
        let name = path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase());
        match () {
            () if has_ending(path, &BINARY_ENDINGS) => Self::Binary,
            () if name.is_some_and(|name| name.ends_with(PACKAGE_ENDING)) => Self::Package,
            () => Self::Text,
        }
    }

    /// The form of what is in a file; text where it cannot be looked into, as a pipe cannot.
    pub(crate) fn of_file(path: &Path) -> Self {
        let is_file = std::fs::metadata(path).is_ok_and(|found| found.is_file());
        match is_file.then(|| File::open(path).and_then(begin)) {
            Some(Ok(bytes)) => Self::of_bytes(&bytes),
            _ => Self::Text,
        }
    }

    /// The form of what begins with these bytes, as many as [`begin`] reads.
    pub(crate) fn of_bytes(bytes: &[u8]) -> Self {
        match () {
            () if bytes.starts_with(&MAGIC) => Self::Binary,
            () if bytes.starts_with(package::MAGIC) => Self::Package,
            () => Self::Text,
        }
    }
}

/// As many bytes as tell the form of what follows.
///
/// # Errors
/// As the system says.
pub(super) fn begin(stream: impl Read) -> io::Result<Vec<u8>> {
    let mut begin = Vec::new();
    stream.take(MAGIC.len().max(package::MAGIC.len()) as u64).read_to_end(&mut begin)?;
    Ok(begin)
}

/// Whether a file has G-code: by its name, or because it begins as binary G-code does.
pub fn is_gcode(path: &Path) -> bool {
    has_ending(path, &ENDINGS)
        || Form::of_name(path) != Form::Text
        // Many other files begin as packages do.
        || Form::of_file(path) == Form::Binary
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|found| endings.iter().any(|ending| found.eq_ignore_ascii_case(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_text_from_binary() {
        let of_name = |name| Form::of_name(Path::new(name));
        assert_eq!(
            ["a.BGCODE", "a.gcode", "a.Gcode.3mf", "a.3mf"].map(of_name),
            [Form::Binary, Form::Text, Form::Package, Form::Text]
        );
        let is_gcode = |name| is_gcode(Path::new(name));
        assert_eq!(
            ["no/a.bgcode", "no/a.g", "no/a.gcode.3mf", "no/a.3mf", "no/a.stl"].map(is_gcode),
            [true, true, true, false, false]
        );
    }
}
