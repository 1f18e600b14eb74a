//! Jobs over HTTP.

use std::sync::Arc;

use axum::Extension;
use axum::extract::{DefaultBodyLimit, Multipart, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::accept::accept;
use super::hub::Jobs;
use super::record::{JobView, Output, State as JobState};
use super::upload::receive;
use super::{events, results};
use crate::job::Project;
use crate::serve::description::{Common, ServerSentEvent};
use crate::serve::error::{ApiError, ErrorBody};
use crate::serve::extract::{Form, Json, Path, Query};
use crate::serve::tokens::{Client, now_s};

/// Longest Idempotency-Key.
const NAME: usize = 255;
/// Time between two signs of life in a stream of events.
const ALIVE: std::time::Duration = std::time::Duration::from_secs(10);

/// The routes.
pub fn router(jobs: Arc<Jobs>) -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(submit, list))
        .routes(routes!(show, delete))
        .routes(routes!(follow))
        .routes(routes!(cancel))
        .routes(routes!(results::gcode))
        .routes(routes!(results::summary))
        .routes(routes!(results::thumbnail))
        .routes(routes!(results::preview))
        .routes(routes!(results::layer))
        // Sizes are watched for all requests.
        .layer(DefaultBodyLimit::disable())
        .with_state(jobs)
}

/// The parts of a request for a job.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "described, not made")]
struct JobForm {
    /// Presets, profiles, settings and placement; without models in it every file is one, and all are arranged.
    #[schema(value_type = Project, required = false)]
    project: Option<Project>,
    /// What to make with the job, each as a part of its own; everything else is made when it is asked for.
    #[schema(value_type = Vec<Output>, required = false)]
    outputs: Vec<Output>,
    /// Files of models: STL, 3MF or OBJ.
    #[schema(value_type = Vec<String>, format = Binary, min_items = 1)]
    model: Vec<String>,
}

/// Slice models
///
/// When this is answered the job will be done, even if the server dies before. Jobs with the same models and settings have
/// the same result, which is made once.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "jobs",
    params(("Idempotency-Key" = Option<String>, Header, description = "a request that is repeated with it is one job", min_length = 1, max_length = 255)),
    request_body(content = JobForm, content_type = "multipart/form-data"),
    responses(
        (status = 202, description = "it is accepted", body = JobView, headers(("Location" = String, description = "where its state is"))),
        (status = 422, description = "nothing can be made of the project", body = ErrorBody),
        Common
    )
)]
async fn submit(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    headers: HeaderMap,
    Form(form): Form<Multipart>,
) -> Result<Response, ApiError> {
    let name = headers.get("idempotency-key").map(|name| name.to_str().map(str::trim).unwrap_or_default());
    if name.is_some_and(|name| name.is_empty() || name.len() > NAME) {
        return Err(ApiError::usage(format!("an Idempotency-Key has 1 to {NAME} printable characters")));
    }
    let name = name.map(str::to_owned);
    // Who has no room now need not send it.
    jobs.index().admit(&client.0, 0, &jobs.shared.limits)?;
    let _turn = jobs.uploads.clone().acquire_owned().await.map_err(ApiError::internal)?;
    let upload = receive(form, &["model"], &jobs.files).await?;
    let view = jobs.blocking(move |jobs| accept(jobs, &client, name, upload)).await?;
    let location = format!("/v1/jobs/{}", view.id);
    Ok((StatusCode::ACCEPTED, [("location", location)], Json(view)).into_response())
}

/// What to list.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Listed {
    /// Only jobs that do this.
    state: Option<JobState>,
    /// Most jobs to list; without it 100.
    #[param(minimum = 1, maximum = 1000)]
    limit: Option<usize>,
}

/// Your jobs, the latest first
#[utoipa::path(
    get, path = "/v1/jobs", tag = "jobs", params(Listed),
    responses((status = 200, description = "the jobs", body = [JobView]), Common)
)]
async fn list(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Query(listed): Query<Listed>,
) -> Result<Json<Vec<JobView>>, ApiError> {
    let most = listed.limit.unwrap_or(100);
    if !(1..=1000).contains(&most) {
        return Err(ApiError::usage("limit: 1 to 1000 are possible"));
    }
    Ok(Json(jobs.index().list(&client.0, listed.state, most)))
}

/// The state of a job
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "the job")),
    responses(
        (status = 200, description = "the job", body = JobView),
        (status = 404, description = "there is no such job", body = ErrorBody),
        Common
    )
)]
async fn show(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, ApiError> {
    jobs.index().view(&id, &client.0).map(Json)
}

/// What happens to a job
///
/// Server-sent events `job` with the job as data: at once, and whenever it is another, at most ten a second. The stream ends
/// with the job.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "jobs",
    params(("id" = String, Path, description = "the job")),
    responses(
        (status = 200, description = "the events", content_type = "text/event-stream", body = ServerSentEvent),
        (status = 404, description = "there is no such job", body = ErrorBody),
        Common
    )
)]
async fn follow(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    let events = events::follow(&jobs, client, id)?;
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(ALIVE)).into_response())
}

/// Cancel a job
///
/// One that has ended stays as it is. Others that wait for the same result get it.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "jobs",
    params(("id" = String, Path, description = "the job")),
    responses(
        (status = 200, description = "the job as it is now", body = JobView),
        (status = 404, description = "there is no such job", body = ErrorBody),
        Common
    )
)]
async fn cancel(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, ApiError> {
    let cancel = move |jobs: &Jobs| {
        cancelled(jobs, &client, &id)?;
        jobs.index().view(&id, &client.0)
    };
    jobs.blocking(cancel).await.map(Json)
}

fn cancelled(jobs: &Jobs, client: &Client, id: &str) -> Result<(), ApiError> {
    let over = jobs.change(|index, changes| index.cancel(id, &client.0, now_s(), changes))?;
    if let Some(work) = over {
        jobs.release(&work);
    }
    Ok(())
}

/// Delete a job
///
/// It is cancelled before, if it has not ended. Its result goes with it, unless another job has the same.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "the job")),
    responses(
        (status = 204, description = "it is deleted"),
        (status = 404, description = "there is no such job", body = ErrorBody),
        Common
    )
)]
async fn delete(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    let delete = move |jobs: &Jobs| {
        cancelled(jobs, &client, &id)?;
        let gone = jobs.change(|index, changes| index.delete(&id, &client.0, changes))?;
        if let Some(key) = gone {
            jobs.files.remove_result(&key);
        }
        Ok(StatusCode::NO_CONTENT)
    };
    jobs.blocking(delete).await
}
