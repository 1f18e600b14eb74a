//! What came of a session's revisions, over HTTP.

use std::sync::Arc;

use axum::Extension;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderName, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};

use super::hub::{Entry, Hub};
use crate::job::Project;
use crate::live::Results;
use crate::profile::dump_toml;
use crate::serve::description::Common;
use crate::serve::error::{ApiError, ErrorBody};
use crate::serve::extract::{Json, Path};
use crate::serve::names::disposition;
use crate::serve::tokens::Client;

/// What came of a revision, if it is kept.
fn results(hub: &Hub, client: &Client, session: &str, revision: u64) -> Result<Results, ApiError> {
    let entry = hub.find(session, client)?;
    match entry.session.results(revision) {
        Some(results) => Ok(results),
        None if revision > entry.session.latest() => Err(ApiError::not_found("there is no such revision")),
        None => Err(gone()),
    }
}

fn gone() -> ApiError {
    ApiError::gone("this revision is no longer kept, or has no result")
}

pub fn octets(bytes: impl Into<Bytes>) -> impl IntoResponse {
    let headers =
        [(header::CONTENT_TYPE, "application/octet-stream"), (header::CACHE_CONTROL, "private, no-store")];
    (headers, bytes.into())
}

fn shared_octets(bytes: Option<Arc<[u8]>>) -> Result<Response, ApiError> {
    Ok(octets(Bytes::from_owner(bytes.ok_or_else(gone)?)).into_response())
}

/// The walls of a revision
///
/// `PWP1`, length of the head (32 bits, little-endian), head (JSON), strokes as the page reads them; without speeds.
#[utoipa::path(
    get, path = "/{session}/revisions/{revision}/walls", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("revision" = u64, Path, description = "the revision")),
    responses(
        (status = 200, description = "packed strokes", body = Vec<u8>, content_type = "application/octet-stream"),
        (status = 404, description = "there is no such session or revision", body = ErrorBody),
        (status = 410, description = "it is no longer kept", body = ErrorBody),
        Common
    )
)]
pub async fn walls(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, revision)): Path<(String, u64)>,
) -> Result<Response, ApiError> {
    shared_octets(results(&hub, &client, &session, revision)?.walls)
}

/// The print of a revision
///
/// As the walls, with everything that the G-code draws.
#[utoipa::path(
    get, path = "/{session}/revisions/{revision}/preview", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("revision" = u64, Path, description = "the revision")),
    responses(
        (status = 200, description = "packed strokes", body = Vec<u8>, content_type = "application/octet-stream"),
        (status = 404, description = "there is no such session or revision", body = ErrorBody),
        (status = 410, description = "it is no longer kept", body = ErrorBody),
        Common
    )
)]
pub async fn preview(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, revision)): Path<(String, u64)>,
) -> Result<Response, ApiError> {
    shared_octets(results(&hub, &client, &session, revision)?.preview)
}

/// The G-code of a revision
#[utoipa::path(
    get, path = "/{session}/revisions/{revision}/gcode", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("revision" = u64, Path, description = "the revision")),
    responses(
        (status = 200, description = "the file", body = Vec<u8>, content_type = "application/octet-stream"),
        (status = 404, description = "there is no such session or revision", body = ErrorBody),
        (status = 410, description = "it is no longer kept", body = ErrorBody),
        Common
    )
)]
pub async fn gcode(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, revision)): Path<(String, u64)>,
) -> Result<Response, ApiError> {
    let results = results(&hub, &client, &session, revision)?;
    let name = results.name.clone();
    let file = hub.work(move || Ok(results.file())).await?;
    Ok(([saved_as(&name)], shared_octets(file)?).into_response())
}

/// The summary of a revision
#[utoipa::path(
    get, path = "/{session}/revisions/{revision}/summary", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("revision" = u64, Path, description = "the revision")),
    responses(
        (status = 200, description = "time, filament, travel, of all layers", body = Value),
        (status = 404, description = "there is no such session or revision", body = ErrorBody),
        (status = 410, description = "it is no longer kept", body = ErrorBody),
        Common
    )
)]
pub async fn summary(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, revision)): Path<(String, u64)>,
) -> Result<Json<Value>, ApiError> {
    let summary = results(&hub, &client, &session, revision)?.summary.ok_or_else(gone)?;
    Ok(Json(json!(*summary)))
}

/// The header by which a browser saves a file under a name.
fn saved_as(name: &str) -> (HeaderName, String) {
    (header::CONTENT_DISPOSITION, disposition(name))
}

/// The project as a file
#[utoipa::path(
    get, path = "/{session}/project.3mf", tag = "sessions", params(("session" = String, Path, description = "the session")),
    responses(
        (status = 200, description = "models, placement and settings, for this and other slicers", body = Vec<u8>, content_type = "model/3mf"),
        (status = 404, description = "there is no such session, or no project yet", body = ErrorBody),
        (status = 422, description = "nothing can be made of the project", body = ErrorBody),
        Common
    )
)]
pub async fn project_file(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    let project = project(&entry)?;
    let file = hub.work(move || entry.session.project_file(&project)).await?;
    let headers = [(header::CONTENT_TYPE, "model/3mf".to_owned()), saved_as("project.3mf")];
    Ok((headers, file).into_response())
}

/// The settings in force as a profile
#[utoipa::path(
    get, path = "/{session}/profile.toml", tag = "sessions", params(("session" = String, Path, description = "the session")),
    responses(
        (status = 200, description = "every setting, and where it comes from", body = String, content_type = "application/toml"),
        (status = 404, description = "there is no such session, or no project yet", body = ErrorBody),
        (status = 422, description = "the settings are wrong", body = ErrorBody),
        Common
    )
)]
pub async fn profile(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    let project = project(&entry)?;
    let text = hub.work(move || Ok(dump_toml(&entry.session.settings(&project)?))).await?;
    let headers = [(header::CONTENT_TYPE, "application/toml".to_owned()), saved_as("profile.toml")];
    Ok((headers, text).into_response())
}

fn project(entry: &Entry) -> Result<Arc<Project>, ApiError> {
    entry.session.project().ok_or_else(|| ApiError::not_found("the session has no project yet"))
}
