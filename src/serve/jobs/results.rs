//! What a job has made.

use std::sync::Arc;

use axum::Extension;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{self, HeaderMap, HeaderName};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

use super::delivery::{self, Sent};
use super::files::{GCODE, SUMMARY};
use super::hub::Jobs;
use super::record::{Job, Kept};
use super::render::{LAYER_SIDE, Picture, THUMBNAIL_SIDE};
use crate::serve::description::Common;
use crate::serve::error::{ApiError, ErrorBody};
use crate::serve::extract::{Path, Query};
use crate::serve::tokens::Client;

/// Answers that any result can have.
#[derive(utoipa::IntoResponses)]
#[allow(dead_code, reason = "described, not made")]
pub(super) enum NoResult {
    /// There is no such job, or no such layer.
    #[response(status = 404)]
    NotFound(ErrorBody),
    /// The job is not done yet.
    #[response(status = 409)]
    NotYet(ErrorBody),
    /// The job was cancelled, or its result had to make room for others.
    #[response(status = 410)]
    Gone(ErrorBody),
    /// The job failed; this is why.
    #[response(status = 422)]
    Failed(ErrorBody),
}

/// What a page made of a client's models may do: show itself.
const PAGE_POLICY: &str = "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline' blob:; \
    style-src 'unsafe-inline'; img-src data: blob:; worker-src blob:; frame-ancestors 'none'";
/// And a picture: nothing.
const PICTURE_POLICY: &str = "sandbox; default-src 'none'; style-src 'unsafe-inline'";

/// The G-code
///
/// Takes `Range` and `If-None-Match`; the `ETag` is the key of the job.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/gcode", tag = "jobs", operation_id = "job_gcode",
    params(("id" = String, Path, description = "the job")),
    responses(
        (status = 200, description = "the file", content_type = "text/x-gcode", body = String),
        (status = 200, description = "binary G-code, where the settings want that", content_type = "application/octet-stream", body = [u8]),
        (status = 206, description = "the part that was asked for", content_type = "text/x-gcode", body = String),
        (status = 304, description = "the client has it"),
        (status = 416, description = "the part lies outside of the file", body = ErrorBody),
        NoResult, Common
    )
)]
pub(super) async fn gcode(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let (job, kept) = jobs.index().result(&id, &client.0)?;
    let name = kept.file_name.as_ref().unwrap_or(&job.name);
    let content_type = if kept.binary { "application/octet-stream" } else { "text/x-gcode" };
    let sent = Sent { content_type, name, tag: &job.key };
    delivery::file(&jobs.files.result(&job.key).join(GCODE), &headers, sent).await
}

/// The summary
///
/// Time, filament, cost, travel, warnings, layers: as `pathwright slice --json` prints it.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/summary", tag = "jobs", operation_id = "job_summary",
    params(("id" = String, Path, description = "the job")),
    responses((status = 200, description = "the summary", body = Object), NoResult, Common)
)]
pub(super) async fn summary(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    let (job, _) = jobs.index().result(&id, &client.0)?;
    let text = tokio::fs::read(jobs.files.result(&job.key).join(SUMMARY)).await?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

/// Size of a picture.
#[derive(Clone, Copy, Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct Size {
    /// Pixels on the longer side.
    #[param(minimum = 1, maximum = 2000)]
    size: Option<u32>,
}

impl Size {
    fn or(self, default: u32) -> Result<u32, ApiError> {
        let size = self.size.unwrap_or(default);
        if (1..=2000).contains(&size) {
            Ok(size)
        } else {
            Err(ApiError::usage("size: 1 to 2000 pixels are possible"))
        }
    }
}

/// A picture of the whole print
#[utoipa::path(
    get, path = "/v1/jobs/{id}/thumbnail.png", tag = "jobs",
    params(("id" = String, Path, description = "the job"), Size),
    responses((status = 200, description = "the picture", content_type = "image/png", body = [u8]), NoResult, Common)
)]
pub(super) async fn thumbnail(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
    Query(size): Query<Size>,
) -> Result<Response, ApiError> {
    let picture = Picture::Thumbnail(size.or(THUMBNAIL_SIDE)?);
    drawn(&jobs, &client, &id, picture, "image/png", PICTURE_POLICY).await
}

/// A page that shows the print
///
/// One file that needs no network, for any browser.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/preview.html", tag = "jobs", operation_id = "job_preview",
    params(("id" = String, Path, description = "the job")),
    responses((status = 200, description = "the page", content_type = "text/html", body = String), NoResult, Common)
)]
pub(super) async fn preview(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    drawn(&jobs, &client, &id, Picture::Preview, "text/html; charset=utf-8", PAGE_POLICY).await
}

/// A picture of a layer
///
/// As PNG, or as SVG to scale.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/layers/{file}", tag = "jobs",
    params(
        ("id" = String, Path, description = "the job"),
        ("file" = String, Path, description = "number of the layer, counted from 1, and `.png` or `.svg`", pattern = r"^[0-9]{1,6}\.(png|svg)$"),
        Size
    ),
    responses(
        (status = 200, description = "the picture", content_type = "image/png", body = [u8]),
        (status = 200, description = "the picture", content_type = "image/svg+xml", body = String),
        NoResult, Common
    )
)]
pub(super) async fn layer(
    State(jobs): State<Arc<Jobs>>,
    Extension(client): Extension<Client>,
    Path((id, file)): Path<(String, String)>,
    Query(size): Query<Size>,
) -> Result<Response, ApiError> {
    let (number, ending) = file.split_once('.').unwrap_or((&file, ""));
    let number = number.parse::<usize>().ok();
    let (picture, content_type) = match (number, ending) {
        (Some(number), "png") => (Picture::LayerPng(number, size.or(LAYER_SIDE)?), "image/png"),
        (Some(number), "svg") => (Picture::LayerSvg(number), "image/svg+xml"),
        _ => return Err(ApiError::not_found("a layer is asked for as 12.png or 12.svg")),
    };
    drawn(&jobs, &client, &id, picture, content_type, PICTURE_POLICY).await
}

async fn drawn(
    jobs: &Arc<Jobs>,
    client: &Client,
    id: &str,
    picture: Picture,
    content_type: &'static str,
    policy: &'static str,
) -> Result<Response, ApiError> {
    let (Job { key, name, .. }, Kept { gcode_bytes, .. }) = jobs.index().result(id, &client.0)?;
    let contents = jobs.blocking(move |jobs| jobs.picture((&key, gcode_bytes), &name, picture)).await?;
    let headers: [(HeaderName, &str); 3] = [
        (header::CONTENT_TYPE, content_type),
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::CACHE_CONTROL, "private, max-age=3600"),
    ];
    Ok((StatusCode::OK, headers, contents).into_response())
}
