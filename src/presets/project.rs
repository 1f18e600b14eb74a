//! The configuration that slicers save in a project (3MF): machine, process and filaments in one.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use zip::ZipArchive;

use super::config::{Config, Dialect};
use super::{cura, orca};

/// No configuration is larger than this unpacked.
const LARGEST: u64 = 64 << 20;

/// How a slicer writes its configuration into a project.
enum Written {
    /// `; key = value`.
    Comments(Dialect),
    /// One JSON object, in OrcaSlicer's words.
    Json,
}

/// Where it is in the package.
const PARTS: [(&str, Written); 4] = [
    ("Metadata/project_settings.config", Written::Json),
    ("Metadata/Slic3r_PE.config", Written::Comments(Dialect::Prusa)),
    ("Metadata/SuperSlicer.config", Written::Comments(Dialect::Super)),
    ("Metadata/Slic3r.config", Written::Comments(Dialect::Prusa)),
];

/// A file of a package.
fn unpacked(package: &mut ZipArchive<BufReader<File>>, part: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let unpack = |error: String| format!("{part} in it cannot be unpacked ({error}); export it again");
    let content = package.by_name(part).map_err(|error| unpack(error.to_string()))?;
    content.take(LARGEST + 1).read_to_end(&mut bytes).map_err(|error| unpack(error.to_string()))?;
    if bytes.len() as u64 > LARGEST {
        return Err(unpack("it is larger than any configuration".into()));
    }
    Ok(bytes)
}

/// Whether a file of this name is a project.
pub(super) fn is_project(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("3mf"))
}

/// Reads the configuration in a project.
///
/// # Errors
/// It cannot be read, or holds none.
pub(super) fn read(path: &Path) -> Result<Config, String> {
    let file = File::open(path).map_err(|error| format!("cannot be read: {error}"))?;
    let mut package = ZipArchive::new(BufReader::new(file))
        .map_err(|error| format!("is damaged or ends early ({error}); copy or export it again"))?;
    let is_there = |(part, _): &&(&str, Written)| package.index_for_name(part).is_some();
    let Some((part, written)) = PARTS.iter().find(is_there) else {
        let names: Vec<String> = package
            .file_names()
            .flatten()
            .filter(|name| cura::is_project(name))
            .map(|name| name.into_owned())
            .collect();
        if names.is_empty() {
            return Err("settings of PrusaSlicer, OrcaSlicer, one of their kin or Cura were expected in the project; \
                        it holds none"
                .into());
        }
        let parts: Result<Vec<_>, String> =
            names.into_iter().map(|name| unpacked(&mut package, &name).map(|bytes| (name, bytes))).collect();
        return cura::project(parts?).map_err(|error| error.to_string());
    };
    let bytes = unpacked(&mut package, part)?;
    let name = format!("{} {part}", path.display());
    match written {
        Written::Json => orca::project(name, &bytes).map_err(|error| error.to_string()),
        Written::Comments(dialect) => {
            let text = String::from_utf8_lossy(&bytes);
            let uncommented = |line: &str| line.trim_start().trim_start_matches(';').to_owned();
            let lines: Vec<String> = text.lines().map(uncommented).collect();
            Config::of_lines(&name, &lines, *dialect)
        }
    }
}
