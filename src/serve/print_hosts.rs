//! Print hosts for the page: which there are, what they do, and prints for them. These routes are no part of the documented
//! interface, and there only where the program was given a file of hosts, as `pathwright app` is.

use std::convert::Infallible;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::StatusCode;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use futures_util::{StreamExt, stream};
use serde::Serialize;
use serde_json::json;
use tokio::sync::mpsc;

use super::error::{ApiError, ErrorBody, ErrorKind};
use super::extract::{Json, Path, Query};
use super::shared::Shared;
use crate::send::{
    self, About, Cause, HostEntry, HostState, Hosts, Patience, Payload, SendError, Sent, Wanted,
};

/// A page that asks for a state will ask again.
fn asking() -> Patience {
    Patience { retry: Duration::ZERO, silence: Duration::from_secs(5), ..Patience::default() }
}

/// The routes.
pub fn router(shared: Arc<Shared>) -> Router {
    Router::new()
        .route("/v1/hosts", get(list))
        .route("/v1/hosts/{name}", get(state))
        .route("/v1/hosts/{name}/prints", post(print))
        // Sizes are watched for all requests.
        .layer(DefaultBodyLimit::disable())
        .with_state(shared)
}

/// A host as the page lists it.
#[derive(Serialize)]
struct Listed {
    name: String,
    kind: &'static str,
    url: String,
}

async fn list(State(shared): State<Arc<Shared>>) -> Result<Json<Vec<Listed>>, ApiError> {
    let Some(file) = shared.print_hosts.clone() else { return Ok(Json(Vec::new())) };
    let hosts = blocking(move || read(file)).await?;
    let listed = |entry: HostEntry| Listed { name: entry.name, kind: entry.kind.name(), url: entry.url };
    Ok(Json(hosts.entries.into_iter().map(listed).collect()))
}

/// What a host says.
#[derive(Serialize)]
struct Told {
    about: About,
    state: HostState,
}

async fn state(State(shared): State<Arc<Shared>>, Path(name): Path<String>) -> Result<Json<Told>, ApiError> {
    let told = blocking(move || {
        let host = send::connect(&entry(&shared, &name)?, asking())?;
        Ok(Told { about: host.about()?, state: host.state()? })
    });
    Ok(Json(told.await?))
}

/// How far it is.
enum Step {
    /// So many percent are sent.
    Sending(u64),
    Done(Sent),
}

/// Sends a file, starts it where that is wanted, and tells what happens: `sent` with the percentage, then `done` or `failed`.
/// What fails before anything is sent is an ordinary answer.
async fn print(
    State(shared): State<Arc<Shared>>,
    Path(name): Path<String>,
    Query(wanted): Query<Wanted>,
    gcode: Bytes,
) -> Result<Response, ApiError> {
    let (tell, mut told) = mpsc::unbounded_channel();
    tokio::task::spawn_blocking(move || {
        // The print goes on where the page is gone.
        let end = deliver(&shared, &name, &wanted, &gcode, &mut |percent| {
            let _ = tell.send(Ok(Step::Sending(percent)));
        });
        let _ = tell.send(end.map(Step::Done));
    });
    let first = told.recv().await.unwrap_or_else(|| Err(ApiError::internal("a mistake of this program")))?;
    let later = stream::unfold(told, |mut told| async { told.recv().await.map(|step| (step, told)) });
    let steps = stream::once(async { Ok(first) }).chain(later);
    Ok(Sse::new(steps.map(event)).keep_alive(KeepAlive::new()).into_response())
}

fn event(step: Result<Step, ApiError>) -> Result<Event, Infallible> {
    let (name, data) = match step {
        Ok(Step::Sending(percent)) => ("sent", json!({ "percent": percent })),
        Ok(Step::Done(sent)) => ("done", json!(sent)),
        Err(error) => ("failed", json!(ErrorBody { error: error.into_problem() })),
    };
    Ok(Event::default().event(name).data(data.to_string()))
}

fn deliver(
    shared: &Shared,
    name: &str,
    wanted: &Wanted,
    gcode: &[u8],
    told: &mut dyn FnMut(u64),
) -> Result<Sent, ApiError> {
    let entry = entry(shared, name)?;
    let mut file = tempfile::Builder::new().suffix(suffix(&wanted.file)).tempfile()?;
    file.write_all(gcode)?;
    file.flush()?;
    let host = send::connect(&entry, Patience::default())?;
    Ok(send::print(host.as_ref(), &entry, &Payload::of(file.path())?, wanted, told)?)
}

/// Text and binary are told apart by the ending.
fn suffix(name: &str) -> &'static str {
    if name.ends_with(".bgcode") { ".bgcode" } else { ".gcode" }
}

fn read(file: PathBuf) -> Result<Hosts, ApiError> {
    Hosts::read(&file).map_err(|error| ApiError::unusable(ErrorKind::Settings, error))
}

fn entry(shared: &Shared, name: &str) -> Result<HostEntry, ApiError> {
    let none = || ApiError::not_found(format!("there is no host `{name}`"));
    let hosts = read(shared.print_hosts.clone().ok_or_else(none)?)?;
    hosts.find(name).cloned().map_err(ApiError::not_found)
}

/// Does what waits for others, on a thread that may wait.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, ApiError> + Send + 'static,
) -> Result<T, ApiError> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|_| Err(ApiError::internal("a mistake of this program")))
}

impl From<SendError> for ApiError {
    fn from(error: SendError) -> Self {
        let (status, kind) = match error.cause {
            Cause::Settings => (StatusCode::UNPROCESSABLE_ENTITY, ErrorKind::Settings),
            Cause::File => (StatusCode::INTERNAL_SERVER_ERROR, ErrorKind::Internal),
            Cause::Mismatch => (StatusCode::UNPROCESSABLE_ENTITY, ErrorKind::Check),
            Cause::Key | Cause::Exists | Cause::Space | Cause::NotReady | Cause::Ended => {
                (StatusCode::CONFLICT, ErrorKind::Host)
            }
            _ => (StatusCode::BAD_GATEWAY, ErrorKind::Host),
        };
        Self::new(status, kind, error)
    }
}
