//! A package with other G-code in it.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Write};
use std::path::Path;

use md5::{Digest, Md5};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::read::{GCODE, SUM, damaged, is_plate, unpacked};

/// What is in a package beside the G-code: names, and contents.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parts {
    /// The name of the G-code.
    plate: String,
    others: Vec<(String, Vec<u8>)>,
}

impl Parts {
    /// Those of a package.
    ///
    /// # Errors
    /// As the system says; it is damaged.
    pub(crate) fn of(package: &Path) -> io::Result<Self> {
        let mut package = ZipArchive::new(BufReader::new(File::open(package)?)).map_err(damaged)?;
        let names: Vec<String> = package.file_names().flatten().map(|name| name.into_owned()).collect();
        let mut parts = Self::default();
        for name in names {
            if is_plate(&name) {
                parts.plate = name;
            } else if !name.ends_with('/') && !name.ends_with(SUM) {
                let bytes = unpacked(&mut package, &name)?;
                parts.others.push((name, bytes));
            }
        }
        Ok(parts)
    }
}

/// Writes a package: these parts, the text, and its sum.
///
/// # Errors
/// Those of reading the text and of writing.
pub(crate) fn write(parts: &Parts, mut text: impl BufRead, to: &mut impl Write) -> io::Result<()> {
    // Printers are not known to read ZIPs that were written in one go.
    let mut package = ZipWriter::new(Cursor::new(Vec::new()));
    // Without a date: the same input gives the same bytes.
    let options = SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
    for (name, bytes) in &parts.others {
        package.start_file(name.as_str(), options)?;
        package.write_all(bytes)?;
    }
    package.start_file(parts.plate.as_str(), options)?;
    let mut sum = Md5::new();
    loop {
        let bytes = text.fill_buf()?;
        if bytes.is_empty() {
            break;
        }
        sum.update(bytes);
        package.write_all(bytes)?;
        let read = bytes.len();
        text.consume(read);
    }
    let sum: String = sum.finalize().iter().map(|byte| format!("{byte:02X}")).collect();
    let name = parts.plate.trim_end_matches(GCODE);
    package.start_file(format!("{name}{SUM}"), options)?;
    package.write_all(sum.as_bytes())?;
    to.write_all(package.finish()?.get_ref())
}
