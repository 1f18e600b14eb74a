//! Project files: 3MF packages that hold a project and its models' files.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use std::sync::Arc;

use super::error::JobError;
use super::model::{ModelFile, ModelFiles};
use super::project::Project;
use crate::limits;
use crate::mesh::Parts;
use crate::observer::Observer;

/// The part that holds the project.
pub(crate) const PROJECT: &str = "Metadata/pathwright.json";
/// Where the models' files are.
const MODELS: &str = "Metadata/pathwright/";

impl Project {
    /// Whether a file is a project: a 3MF package that this program wrote.
    pub fn is_in(bytes: &[u8]) -> bool {
        let parts = Parts::open(Path::new(""), bytes);
        parts.is_some_and(|mut parts| !matches!(parts.bytes(PROJECT, 0), Ok(None)))
    }

    /// Whether a file is a project, without reading all of it.
    pub fn is_in_file(path: &Path) -> bool {
        // A pipe can be read once only, and may let whoever opens it wait.
        if !std::fs::metadata(path).is_ok_and(|found| found.is_file()) {
            return false;
        }
        let mut start = [0; 2];
        let Ok(mut file) = File::open(path) else { return false };
        if file.read_exact(&mut start).is_err() {
            return false;
        }
        let archive = (start == *b"PK").then(|| zip::ZipArchive::new(BufReader::new(file)).ok()).flatten();
        archive.is_some_and(|archive| archive.index_for_name(PROJECT).is_some())
    }

    /// Reads a project with its models; `name` is what messages call the file. `None`: it is no project.
    ///
    /// # Errors
    /// It is damaged, unpacks to too much, or a model in it cannot be read.
    pub fn read(
        name: &str,
        bytes: &[u8],
        observer: &Observer<'_>,
    ) -> Result<Option<(Self, ModelFiles)>, JobError> {
        let Some(mut parts) = Parts::open(Path::new(name), bytes) else { return Ok(None) };
        let Some(text) = parts.bytes(PROJECT, limits::PROJECT_BYTES)? else { return Ok(None) };
        let project: Self =
            serde_json::from_slice(&text).map_err(|error| parts.error(PROJECT, error.to_string()))?;
        let mut files = ModelFiles::new();
        let mut left = limits::MODEL_BYTES;
        for model in &project.models {
            if files.contains_key(&model.file) {
                continue;
            }
            let part = part_of(&model.file);
            let Some(contents) = parts.bytes(&part, left)? else {
                return Err(parts.error(&part, format!("the model {} is missing", model.file)).into());
            };
            left -= contents.len() as u64;
            let needed = (contents.len() as u64).saturating_mul(limits::BYTES_PER_BYTE);
            limits::check_memory(needed).map_err(|problem| parts.error(&part, problem))?;
            let file = ModelFile::read(&model.file, contents, observer)?;
            files.insert(model.file.clone(), Arc::new(file));
        }
        Ok(Some((project, files)))
    }

    /// The parts of a project file beside the model: the project, and its models' files.
    pub(crate) fn parts<'a>(
        text: &'a [u8],
        files: impl Iterator<Item = &'a Arc<ModelFile>>,
    ) -> Vec<(String, &'a [u8])> {
        let project = (PROJECT.to_owned(), text);
        std::iter::once(project).chain(files.map(|file| (part_of(file.name()), &file.bytes()[..]))).collect()
    }
}

/// The part of a model's file: its name, with what a part's name may not hold as `%2F`.
fn part_of(name: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    let encoded = name.bytes().map(|byte| match plain(byte) {
        true => char::from(byte).to_string(),
        false => format!("%{byte:02X}"),
    });
    MODELS.to_owned() + &encoded.collect::<String>()
}
