//! Everything there is, and what every request passes.

use std::any::Any;
use std::sync::Arc;

use axum::Router;
use axum::http::{Method, Uri, header};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use tower_http::catch_panic::CatchPanicLayer;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::description::Schemes;
use super::error::{ApiError, ErrorBody, ErrorKind, Problem};
use super::jobs::{self, Jobs};
use super::shared::Shared;
use super::{assets, auth, body, catalog, guard, monitoring, sessions, tools};

/// The description of the service: what is not said at the handlers.
#[derive(OpenApi)]
#[openapi(
    info(title = "Pathwright", description = "Slices models into G-code, and orders finished G-code."),
    components(schemas(ErrorBody, ErrorKind, Problem)),
    tags(
        (name = "service", description = "The server itself"),
        (name = "catalog", description = "What there is to choose from"),
        (name = "jobs", description = "Slicing, and its results"),
        (name = "tools", description = "Finished G-code"),
        (name = "sessions", description = "Plates of pages, sliced as they change")
    ),
    security(("token" = [])),
    modifiers(&Schemes)
)]
struct Description;

/// The documented interface with its description.
fn api(shared: &Arc<Shared>, jobs: &Arc<Jobs>) -> (Router, utoipa::openapi::OpenApi) {
    let open = OpenApiRouter::new()
        .routes(routes!(monitoring::healthz))
        .routes(routes!(monitoring::readyz))
        .routes(routes!(auth::login))
        .with_state(shared.clone());
    let closed = OpenApiRouter::with_openapi(Description::openapi())
        .merge(OpenApiRouter::new().routes(routes!(monitoring::metrics)).with_state(shared.clone()))
        .merge(catalog::router(shared.clone()))
        .merge(jobs::router(jobs.clone()))
        .merge(tools::router(jobs.clone()))
        .nest("/v1/sessions", sessions::router(shared.clone()));
    let (closed, mut openapi) = closed.split_for_parts();
    let (open, more) = open.split_for_parts();
    openapi.merge(more);
    let closed = closed.merge(assets::opened_router(shared.clone()));
    (open.merge(closed.route_layer(from_fn_with_state(shared.clone(), auth::required))), openapi)
}

/// Everything there is, with what every request passes.
pub(super) fn router(shared: &Arc<Shared>, jobs: &Arc<Jobs>) -> Router {
    let (routes, openapi) = api(shared, jobs);
    let text = openapi.to_json().unwrap_or_default();
    let description = move || async move { ([(header::CONTENT_TYPE, "application/json")], text) };
    routes
        .route("/v1/openapi.json", get(description))
        .merge(assets::router())
        .fallback(nowhere)
        .method_not_allowed_fallback(wrong_method)
        .layer(from_fn_with_state(shared.clone(), body::guarded))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(from_fn_with_state(shared.clone(), guard::guarded))
        .layer(from_fn_with_state(shared.clone(), monitoring::counted))
}

async fn nowhere(uri: Uri) -> ApiError {
    ApiError::not_found(format!("there is nothing at {}", uri.path()))
}

async fn wrong_method(method: Method, uri: Uri) -> ApiError {
    let status = axum::http::StatusCode::METHOD_NOT_ALLOWED;
    ApiError::new(status, ErrorKind::Usage, format!("{method} is not for {}", uri.path()))
}

/// A mistake of the program ends one request, not the server.
fn panicked(_what: Box<dyn Any + Send + 'static>) -> Response {
    ApiError::internal("a mistake of this program; the other requests go on").into_response()
}
