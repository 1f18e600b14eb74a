//! Sessions over HTTP.

use std::sync::Arc;
use std::time::Duration;

use axum::Extension;
use axum::body::Body;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::{HeaderName, StatusCode, header};
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::hub::Hub;
use super::results::octets;
use super::{results, stream};
use crate::job::Project;
use crate::live::DISPLAYED;
use crate::serve::body::whole;
use crate::serve::description::{Common, ServerSentEvent};
use crate::serve::error::{ApiError, ErrorBody};
use crate::serve::extract::{Json, Path, Query};
use crate::serve::shared::Shared;
use crate::serve::tokens::Client;

/// Time between two signs of life in a stream of events.
const ALIVE: Duration = Duration::from_secs(10);
/// Largest project: its profile is text.
const PROJECT_BYTES: usize = 16 << 20;

/// The routes.
pub fn router(shared: Arc<Shared>) -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(open))
        .routes(routes!(close))
        .routes(routes!(add_model))
        .routes(routes!(mesh))
        .routes(routes!(faces))
        .routes(routes!(set_project))
        .routes(routes!(events))
        .routes(routes!(results::walls))
        .routes(routes!(results::preview))
        .routes(routes!(results::gcode))
        .routes(routes!(results::summary))
        .routes(routes!(results::project_file))
        .routes(routes!(results::profile))
        .routes(routes!(arrange))
        .routes(routes!(orient))
        .routes(routes!(compare))
        .layer(DefaultBodyLimit::max(PROJECT_BYTES))
        .with_state(Hub::new(shared))
}

/// A session that was begun.
#[derive(Serialize, ToSchema)]
struct Opened {
    /// Its name.
    session: String,
    /// Version of the program.
    version: &'static str,
}

/// Begin a session
#[utoipa::path(
    post, path = "", tag = "sessions",
    responses((status = 201, description = "it is begun", body = Opened), Common)
)]
async fn open(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
) -> Result<Response, ApiError> {
    let session = hub.open(client)?;
    let version = env!("CARGO_PKG_VERSION");
    Ok((StatusCode::CREATED, Json(Opened { session, version })).into_response())
}

/// End a session
#[utoipa::path(
    delete, path = "/{session}", tag = "sessions", params(("session" = String, Path, description = "the session")),
    responses(
        (status = 204, description = "it is ended"),
        (status = 404, description = "there is no such session", body = ErrorBody),
        Common
    )
)]
async fn close(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(name): Path<String>,
) -> Result<StatusCode, ApiError> {
    hub.find(&name, &client)?;
    hub.close(&name);
    Ok(StatusCode::NO_CONTENT)
}

/// What a model file is called.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Named {
    /// Name of the file, without folders.
    #[param(min_length = 1, max_length = 255)]
    name: String,
}

/// Add a model or a project file
#[utoipa::path(
    post, path = "/{session}/models", tag = "sessions", params(("session" = String, Path, description = "the session"), Named),
    request_body(content = Vec<u8>, content_type = "application/octet-stream"),
    responses(
        (status = 201, description = "what it holds", body = Value),
        (status = 404, description = "there is no such session", body = ErrorBody),
        (status = 422, description = "it is no model", body = ErrorBody),
        Common
    )
)]
async fn add_model(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
    Query(Named { name }): Query<Named>,
    body: Body,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    if name.is_empty() || name.len() > 255 {
        return Err(ApiError::usage("name: 1 to 255 bytes are expected"));
    }
    let bytes = whole(body).await?;
    let added = hub.work(move || entry.session.add(&name, &bytes)).await?;
    Ok((StatusCode::CREATED, Json(added)).into_response())
}

/// Which object of a file.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Which {
    /// The object, counted from 0.
    #[serde(default)]
    #[param(minimum = 0, maximum = 1_000_000)]
    object: usize,
    /// Whether all triangles are wanted.
    full: Option<String>,
}

/// A model's mesh
///
/// `PWM1`, numbers of vertices and triangles (32 bits, little-endian), vertices (three 32-bit floats, the middle over the
/// origin, the lowest point at 0), triangles (three 32-bit numbers). Large ones are simplified, unless `full` is given.
#[utoipa::path(
    get, path = "/{session}/models/{file}/mesh", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("file" = String, Path, description = "the model"), Which),
    responses(
        (status = 200, description = "the mesh", body = Vec<u8>, content_type = "application/octet-stream"),
        (status = 404, description = "there is no such model", body = ErrorBody),
        Common
    )
)]
async fn mesh(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, file)): Path<(String, String)>,
    Query(which): Query<Which>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    let most = if which.full.is_some() { usize::MAX } else { DISPLAYED };
    let packed = hub.work(move || entry.session.mesh(&file, which.object, most)).await?;
    Ok(octets(packed).into_response())
}

/// Faces that a model can be laid on
#[utoipa::path(
    get, path = "/{session}/models/{file}/faces", tag = "sessions",
    params(("session" = String, Path, description = "the session"), ("file" = String, Path, description = "the model"), Which),
    responses(
        (status = 200, description = "flat sides of its convex hull, the largest first", body = Value),
        (status = 404, description = "there is no such model", body = ErrorBody),
        Common
    )
)]
async fn faces(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path((session, file)): Path<(String, String)>,
    Query(which): Query<Which>,
) -> Result<Json<Value>, ApiError> {
    let entry = hub.find(&session, &client)?;
    let faces = hub.work(move || entry.session.faces(&file, which.object)).await?;
    Ok(Json(json!({ "faces": faces })))
}

/// Slice a project
///
/// It takes the place of the project before, whose slicing ends. The events tell what comes of it.
#[utoipa::path(
    put, path = "/{session}/project", tag = "sessions", params(("session" = String, Path, description = "the session")),
    request_body = Project,
    responses(
        (status = 202, description = "the number of the revision", body = Value),
        (status = 404, description = "there is no such session", body = ErrorBody),
        (status = 415, description = "it is no JSON", body = ErrorBody),
        Common
    )
)]
async fn set_project(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
    Json(project): Json<Project>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    entry.compare(None);
    let revision = entry.session.set_project(project);
    Ok((StatusCode::ACCEPTED, Json(json!({ "revision": revision }))).into_response())
}

/// Follow a session
///
/// First everything that is known of the last revision, then everything new.
#[utoipa::path(
    get, path = "/{session}/events", tag = "sessions", params(("session" = String, Path, description = "the session")),
    responses(
        (status = 200, description = "resolved, placed, progress, walls, done, failed", body = ServerSentEvent, content_type = "text/event-stream"),
        (status = 404, description = "there is no such session", body = ErrorBody),
        Common
    )
)]
async fn events(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    let permit = hub.shared.streams.open(&client, &hub.shared.limits)?;
    let events = stream::follow(&session, entry.watching(), permit, hub.shared.ending.clone());
    let headers = [(header::CACHE_CONTROL, "no-store"), (HeaderName::from_static("x-accel-buffering"), "no")];
    Ok((headers, Sse::new(events).keep_alive(KeepAlive::new().interval(ALIVE))).into_response())
}

/// Arrange all models
#[utoipa::path(
    post, path = "/{session}/arrange", tag = "sessions", params(("session" = String, Path, description = "the session")),
    request_body = Project,
    responses(
        (status = 200, description = "the project with a position for every model", body = Project),
        (status = 404, description = "there is no such session", body = ErrorBody),
        (status = 415, description = "it is no JSON", body = ErrorBody),
        (status = 422, description = "they do not fit, or nothing can be made of the project", body = ErrorBody),
        Common
    )
)]
async fn arrange(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
    Json(project): Json<Project>,
) -> Result<Json<Project>, ApiError> {
    let entry = hub.find(&session, &client)?;
    Ok(Json(hub.work(move || entry.session.arrange(&project)).await?))
}

/// Which model of a project.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Numbered {
    /// The model, counted from 0.
    #[param(minimum = 0, maximum = 1_000_000)]
    model: usize,
}

/// Turn a model so that it needs the least support
#[utoipa::path(
    post, path = "/{session}/orient", tag = "sessions", params(("session" = String, Path, description = "the session"), Numbered),
    request_body = Project,
    responses(
        (status = 200, description = "the project with that model's rotation", body = Project),
        (status = 404, description = "there is no such session or model", body = ErrorBody),
        (status = 415, description = "it is no JSON", body = ErrorBody),
        (status = 422, description = "nothing can be made of the project", body = ErrorBody),
        Common
    )
)]
async fn orient(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
    Query(numbered): Query<Numbered>,
    Json(project): Json<Project>,
) -> Result<Json<Project>, ApiError> {
    let entry = hub.find(&session, &client)?;
    Ok(Json(hub.work(move || entry.session.orient(&project, numbered.model)).await?))
}

/// Two projects side by side.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
struct Compared {
    /// Sliced first.
    a: Project,
    /// Sliced then.
    b: Project,
}

/// Slice two projects, to be looked at side by side
#[utoipa::path(
    post, path = "/{session}/compare", tag = "sessions", params(("session" = String, Path, description = "the session")),
    request_body = Compared,
    responses(
        (status = 202, description = "the numbers of both revisions; their events have a `side`", body = Value),
        (status = 404, description = "there is no such session", body = ErrorBody),
        (status = 415, description = "it is no JSON", body = ErrorBody),
        Common
    )
)]
async fn compare(
    State(hub): State<Arc<Hub>>,
    Extension(client): Extension<Client>,
    Path(session): Path<String>,
    Json(Compared { a, b }): Json<Compared>,
) -> Result<Response, ApiError> {
    let entry = hub.find(&session, &client)?;
    let next = entry.session.latest() + 1;
    entry.compare(Some([next, next + 1]));
    let [a, b] = entry.session.compare([a, b]);
    entry.compare(Some([a, b]));
    Ok((StatusCode::ACCEPTED, Json(json!({ "a": a, "b": b }))).into_response())
}
