//! Whether the server lives, and whether it takes jobs.

use std::sync::Arc;

use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use super::error::ApiError;
use super::extract::Json;
use super::router::Common;
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
