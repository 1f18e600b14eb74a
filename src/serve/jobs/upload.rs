//! Requests with files: models go to the disk as they come, and are known by their hash.

use axum::extract::Multipart;
use axum::extract::multipart::{Field, MultipartError};
use serde::de::DeserializeOwned;
use serde_json::Value;
use sha2::{Digest, Sha256};
use tempfile::TempPath;
use tokio::io::AsyncWriteExt;

use super::files::Files;
use super::record::{ModelRef, Output};
use crate::job::{Project, hexadecimal};
use crate::serve::error::ApiError;
use crate::serve::refused::Refused;

/// Largest part that is no file, bytes.
const TEXT_BYTES: usize = 4 << 20;
/// Most files of a request.
const FILES: usize = 256;
/// Longest name of a file, characters.
const NAME: usize = 200;

/// What a request has brought.
#[derive(Debug, Default)]
pub struct Upload {
    /// Settings and placement; without it everything is as the default profile has it.
    pub project: Option<Project>,
    /// What is wanted beside G-code and summary.
    pub outputs: Vec<Output>,
    /// Files by the name of their part: `model`, `gcode`.
    pub files: Vec<Received>,
}

/// A file that has come.
#[derive(Debug)]
pub struct Received {
    /// Name of its part.
    pub part: &'static str,
    /// Its name and hash.
    pub model: ModelRef,
    /// Where it is; it goes when this is dropped.
    pub path: TempPath,
}

/// Reads a request whose files have one of these parts.
///
/// # Errors
/// A part that is not known, a project that makes no sense, a limit, a full disk.
pub async fn receive(mut form: Multipart, parts: &[&'static str], files: &Files) -> Result<Upload, ApiError> {
    let mut upload = Upload::default();
    while let Some(field) = form.next_field().await.map_err(|error| unread(&error))? {
        let name = field.name().unwrap_or_default().to_owned();
        match name.as_str() {
            "project" if upload.project.is_none() => upload.project = Some(json(&name, field).await?),
            "outputs" => upload.outputs.push(word(&name, field).await?),
            _ => {
                let Some(part) = parts.iter().find(|part| **part == name) else {
                    let known = ["project", "outputs"].iter().chain(parts).map(|part| format!("`{part}`"));
                    let known = known.collect::<Vec<_>>().join(", ");
                    return Err(ApiError::usage(format!(
                        "there is no part `{}`, or it comes only once; there are {known}",
                        name.escape_debug()
                    )));
                };
                if upload.files.len() >= FILES {
                    return Err(ApiError::too_large(format!("at most {FILES} files are taken at once")));
                }
                upload.files.push(file(part, field, files).await?);
            }
        }
    }
    Ok(upload)
}

/// A value written as JSON.
async fn json<T: DeserializeOwned>(name: &str, field: Field<'_>) -> Result<T, ApiError> {
    serde_json::from_slice(&text(name, field).await?)
        .map_err(|error| ApiError::usage(format!("`{name}`: {error}")))
}

/// One of a few words, as it is.
async fn word<T: DeserializeOwned>(name: &str, field: Field<'_>) -> Result<T, ApiError> {
    let word = Value::from(String::from_utf8_lossy(&text(name, field).await?));
    serde_json::from_value(word).map_err(|error| ApiError::usage(format!("`{name}`: {error}")))
}

async fn text(name: &str, mut field: Field<'_>) -> Result<Vec<u8>, ApiError> {
    let mut text = Vec::new();
    while let Some(chunk) = field.chunk().await.map_err(|error| unread(&error))? {
        if text.len() + chunk.len() > TEXT_BYTES {
            return Err(ApiError::too_large(format!("`{name}` is larger than {} MiB", TEXT_BYTES >> 20)));
        }
        text.extend_from_slice(&chunk);
    }
    Ok(text)
}

async fn file(part: &'static str, mut field: Field<'_>, files: &Files) -> Result<Received, ApiError> {
    let Some(name) = field.file_name().map(plain_name) else {
        return Err(ApiError::usage(format!(
            "`{part}` is a file and has a name, as `curl -F {part}=@part.stl` sends it"
        )));
    };
    let (file, path) = files.temporary()?.into_parts();
    let mut file = tokio::io::BufWriter::with_capacity(1 << 18, tokio::fs::File::from_std(file));
    let (mut hash, mut bytes) = (Sha256::new(), 0);
    while let Some(chunk) = field.chunk().await.map_err(|error| unread(&error))? {
        hash.update(&chunk);
        bytes += chunk.len() as u64;
        file.write_all(&chunk).await?;
    }
    file.flush().await?;
    Ok(Received { part, model: ModelRef { name, hash: hexadecimal(&hash.finalize()), bytes }, path })
}

/// A name without folders and whatever a terminal or a header would take for something else. It is never part of a path.
pub fn plain_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let plain: String = last.chars().filter(|c| !c.is_control()).take(NAME).collect();
    match plain.trim() {
        "" | "." | ".." => "model".to_owned(),
        plain => plain.to_owned(),
    }
}

fn unread(error: &MultipartError) -> ApiError {
    match Refused::behind(error) {
        Some(refused) => refused.into(),
        None if error.status() == axum::http::StatusCode::PAYLOAD_TOO_LARGE => {
            ApiError::too_large(error.body_text())
        }
        None => ApiError::usage(error.body_text()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_no_folders() {
        for (name, plain) in [
            ("part.stl", "part.stl"),
            ("../../etc/passwd", "passwd"),
            ("C:\\models\\a b.stl", "a b.stl"),
            ("..", "model"),
            ("a\r\nb\0.stl", "ab.stl"),
            ("", "model"),
        ] {
            assert_eq!(plain_name(name), plain);
        }
        assert_eq!(plain_name(&"x".repeat(9999)).len(), NAME);
    }
}
