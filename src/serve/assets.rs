//! The page, its parts, and the models that it opens at its start.

use std::sync::Arc;

use axum::Router;
use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use serde::Serialize;

use super::error::ApiError;
use super::extract::Json;
use super::page;
use super::shared::Shared;

/// Routes that need no token: there is nothing secret in the page.
pub fn router() -> Router {
    Router::new().route("/", get(index)).route("/assets/{*path}", get(asset))
}

/// Routes for the page alone: they are no part of the documented interface.
pub fn opened_router(shared: Arc<Shared>) -> Router {
    let routes = Router::new().route("/v1/opened", get(opened)).route("/v1/opened/{index}", get(opened_file));
    routes.with_state(shared)
}

async fn index() -> Html<String> {
    Html(page::index())
}

async fn asset(Path(path): Path<String>) -> Result<Response, ApiError> {
    let asset = page::asset(&path).ok_or_else(|| ApiError::not_found("there is no such part of the page"))?;
    let headers = [
        (header::CONTENT_TYPE, asset.content_type),
        (header::CACHE_CONTROL, "public, max-age=31536000, immutable"),
    ];
    Ok((headers, asset.bytes.into_owned()).into_response())
}

#[derive(Serialize)]
struct Opened {
    name: String,
    bytes: usize,
}

/// The models of `pathwright app part.stl …`.
async fn opened(State(shared): State<Arc<Shared>>) -> Json<Vec<Opened>> {
    let files = shared.opened.iter().map(|(name, data)| Opened { name: name.clone(), bytes: data.len() });
    Json(files.collect())
}

/// One of them.
async fn opened_file(
    State(shared): State<Arc<Shared>>,
    Path(index): Path<usize>,
) -> Result<Response, ApiError> {
    let file = shared.opened.get(index).ok_or_else(|| ApiError::not_found("there is no such model"))?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], file.1.clone()).into_response())
}
