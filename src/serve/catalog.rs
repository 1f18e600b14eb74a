//! What there is to choose from: settings, profiles, printers.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::body::whole;
use super::description::Common;
use super::error::{ApiError, ErrorKind};
use super::extract::{Json, Path, Query};
use super::shared::Shared;
use crate::job::catalog::{Profile, Schema};
use crate::presets::{Kind, PresetError, Printer, PrinterPresets};
use crate::profile;

/// The routes.
pub fn router(shared: Arc<Shared>) -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(schema))
        .routes(routes!(profiles))
        .routes(routes!(convert))
        .routes(routes!(printers))
        .routes(routes!(printer))
        .with_state(shared)
}

/// All settings
///
/// Keys with their meaning, range, unit and default, made from the same table as the reference.
#[utoipa::path(
    get, path = "/v1/schema", tag = "catalog",
    responses((status = 200, description = "all settings", body = Schema), Common)
)]
async fn schema() -> Json<&'static Schema> {
    Json(Schema::known())
}

/// Built-in profiles
#[utoipa::path(
    get, path = "/v1/profiles", tag = "catalog",
    responses((status = 200, description = "the built-in profiles", body = [Profile]), Common)
)]
async fn profiles() -> Json<Vec<Profile>> {
    Json(Profile::built_in())
}

/// What a configuration is called.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Named {
    /// Name of its file.
    name: String,
}

/// Another slicer's configuration as a profile
///
/// What `pathwright profiles show` prints of an `.ini` file: a profile (TOML) with where each value comes from, and what is
/// not taken over.
#[utoipa::path(
    post, path = "/v1/profiles/convert", tag = "catalog", params(Named),
    request_body(content = String, content_type = "text/plain"),
    responses(
        (status = 200, description = "the profile", body = String, content_type = "application/toml"),
        (status = 422, description = "it is no configuration", body = super::error::ErrorBody),
        Common
    )
)]
async fn convert(Query(named): Query<Named>, body: Body) -> Result<Response, ApiError> {
    let text = String::from_utf8_lossy(&whole(body).await?).into_owned();
    let profile = aside(move || profile::converted(&named.name, &text)).await?;
    let profile = profile.map_err(|problem| ApiError::unusable(ErrorKind::Settings, problem))?;
    Ok(([(header::CONTENT_TYPE, "application/toml")], profile).into_response())
}

/// What to list.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Words {
    /// Words that a printer's name, file or slicer has, in any order.
    #[serde(default)]
    q: String,
    /// Most printers to list; without it 200.
    #[param(minimum = 1)]
    limit: Option<usize>,
}

/// Printers of other slicers' presets
#[utoipa::path(
    get, path = "/v1/printers", tag = "catalog", params(Words),
    responses((status = 200, description = "the printers that have the words", body = [Printer]), Common)
)]
async fn printers(
    State(shared): State<Arc<Shared>>,
    Query(words): Query<Words>,
) -> Result<Json<Vec<Printer>>, ApiError> {
    let most = words.limit.unwrap_or(200);
    if most == 0 {
        return Err(ApiError::usage("limit: 1 or more are possible"));
    }
    let list = move || shared.printers.find(&shared.presets, &words.q, most).into_iter().cloned().collect();
    Ok(Json(aside(list).await?))
}

/// The choice to show.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
struct Choice {
    /// Print preset whose filaments are wanted; without it, the printer's own choice.
    print: Option<String>,
}

/// A printer with the presets that fit it
#[utoipa::path(
    get, path = "/v1/printers/{name}", tag = "catalog",
    params(("name" = String, Path, description = "as `/v1/printers` lists it"), Choice),
    responses(
        (status = 200, description = "the presets that fit", body = PrinterPresets),
        (status = 404, description = "there is no such printer", body = super::error::ErrorBody),
        (status = 422, description = "its presets do not resolve", body = super::error::ErrorBody),
        Common
    )
)]
async fn printer(
    State(shared): State<Arc<Shared>>,
    Path(name): Path<String>,
    Query(choice): Query<Choice>,
) -> Result<Json<PrinterPresets>, ApiError> {
    let find = move || {
        let library = &shared.presets;
        library.preset(Kind::Printer, &name).map_err(ApiError::not_found)?;
        let unusable = |error: PresetError| ApiError::unusable(ErrorKind::Settings, error);
        PrinterPresets::of(library, &name, choice.print.as_deref()).map_err(unusable)
    };
    aside(find).await?.map(Json)
}

/// Does something that takes a while, not on the threads that answer.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, ApiError> {
    tokio::task::spawn_blocking(work).await.map_err(ApiError::internal)
}
