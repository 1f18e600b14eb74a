//! What is given to be sliced: models in files and on standard input, and projects.

use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args::ModelArgs;
use super::exit::{Exit, Failure, usage};
use crate::job::{ModelFiles, ModelSource, Project};
use crate::limits;
use crate::observer::Observer;

/// An argument that names a model or a project.
pub(super) struct Given {
    /// As messages call it.
    pub path: PathBuf,
    pub what: What,
    /// Whether it comes from standard input.
    pub is_stdin: bool,
}

pub(super) enum What {
    Model(ModelSource),
    Project(Box<Project>, ModelFiles),
}

/// What the arguments name, standard input read. Models in files are left to be read later.
pub(super) fn read(args: &ModelArgs) -> Result<Vec<Given>, Failure> {
    let is_stdin = |path: &&PathBuf| path.as_path() == Path::new("-");
    if args.files.iter().filter(is_stdin).count() > 1 {
        return Err(usage("- stands for standard input, which can be read once"));
    }
    args.files.iter().map(|path| if is_stdin(&path) { stdin(&args.stdin_name) } else { file(path) }).collect()
}

fn file(path: &Path) -> Result<Given, Failure> {
    let model = Given { path: path.to_owned(), what: What::Model(path.into()), is_stdin: false };
    if !Project::is_in_file(path) {
        return Ok(model);
    }
    // What cannot be read now cannot be read as a model, either, which tells why.
    let Ok(bytes) = std::fs::read(path) else { return Ok(model) };
    Ok(project(path, &bytes)?.unwrap_or(model))
}

fn stdin(name: &Path) -> Result<Given, Failure> {
    let failed = |message: String| Failure::new(Exit::Input, format!("standard input: {message}"));
    let mut bytes = Vec::new();
    let most = limits::MODEL_BYTES;
    io::stdin().lock().take(most + 1).read_to_end(&mut bytes).map_err(|error| failed(error.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(failed(format!("more than {} GB are no model", most >> 30)));
    }
    if let Some(project) = project(name, &bytes)? {
        return Ok(Given { is_stdin: true, ..project });
    }
    let source = ModelSource::Bytes { name: name.display().to_string(), bytes: Arc::from(bytes) };
    Ok(Given { path: name.to_owned(), what: What::Model(source), is_stdin: true })
}

fn project(path: &Path, bytes: &[u8]) -> Result<Option<Given>, Failure> {
    let read = Project::read(&path.display().to_string(), bytes, &Observer::none())?;
    Ok(read.map(|(project, files)| Given {
        path: path.to_owned(),
        what: What::Project(Box::new(project), files),
        is_stdin: false,
    }))
}
