//! For those who watch the server: whether it lives, whether it takes jobs, its figures.

use std::sync::Arc;
use std::time::Instant;

use axum::extract::{MatchedPath, Request, State};
use axum::http::header;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::description::Common;
use super::error::ApiError;
use super::extract::Json;
use super::shared::Shared;

/// A sign of life.
#[derive(Debug, Serialize, ToSchema)]
pub struct Health {
    /// `ok`.
    status: &'static str,
    /// Of the program.
    version: &'static str,
}

const OK: Health = Health { status: "ok", version: env!("CARGO_PKG_VERSION") };

/// Whether the server lives
#[utoipa::path(
    get, path = "/healthz", tag = "service", security(()),
    responses((status = 200, description = "it lives", body = Health), Common)
)]
pub async fn healthz() -> Json<Health> {
    Json(OK)
}

/// Whether the server takes jobs
///
/// Not while it ends.
#[utoipa::path(
    get, path = "/readyz", tag = "service", security(()),
    responses((status = 200, description = "it takes jobs", body = Health), Common)
)]
pub async fn readyz(State(shared): State<Arc<Shared>>) -> Result<Json<Health>, ApiError> {
    match *shared.ending.borrow() {
        true => Err(ApiError::busy("the server is ending")),
        false => Ok(Json(OK)),
    }
}

/// Counts requests and measures how long they take.
pub async fn counted(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let begun = Instant::now();
    let path = request.extensions().get::<MatchedPath>().map(|path| path.as_str().to_owned());
    // Methods that do not exist would make a label each.
    let known = ["GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS"];
    let method = known.into_iter().find(|known| *known == request.method().as_str());
    let response = next.run(request).await;
    shared.metrics.answered(method, path, response.status(), begun.elapsed());
    response
}

/// Figures for Prometheus
///
/// Requests, jobs, runs, streams, bytes, in the text format of OpenMetrics.
#[utoipa::path(
    get, path = "/metrics", tag = "service",
    responses(
        (status = 200, description = "the figures", content_type = "application/openmetrics-text", body = String),
        Common
    )
)]
pub async fn metrics(State(shared): State<Arc<Shared>>) -> Result<Response, ApiError> {
    let text = shared.metrics.text(shared.streams.count()).map_err(ApiError::internal)?;
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    Ok(([(header::CONTENT_TYPE, kind)], text).into_response())
}
