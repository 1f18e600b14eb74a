//! Who asks: every request but a few has a token, or the cookie that a login gives for one.

use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::http::header::{self, HeaderValue};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::ToSchema;

use super::description::Common;
use super::error::{ApiError, ErrorKind};
use super::extract::Json;
use super::shared::Shared;
use super::tokens::{COOKIE, now_s};

/// How long a login lasts, seconds.
const LOGIN_S: u64 = 30 * 24 * 3600;

/// Lets only those pass who have a token, and tells the handlers who it is: they take `Extension<Client>`.
pub async fn required(State(shared): State<Arc<Shared>>, mut request: Request, next: Next) -> Response {
    let Some(client) = shared.tokens.asker(request.headers()) else {
        let message = "a token is needed: send it as `Authorization: Bearer TOKEN`";
        return ApiError::new(StatusCode::UNAUTHORIZED, ErrorKind::Unauthorized, message).into_response();
    };
    request.extensions_mut().insert(client);
    next.run(request).await
}

/// The body of a login.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Login {
    /// As the token file has it.
    token: String,
}

/// Exchange a token for a cookie
///
/// For what a browser asks for by itself: downloads and pictures. The cookie is HttpOnly and of this site alone.
#[utoipa::path(
    post, path = "/v1/login", tag = "service", request_body = Login,
    responses((status = 204, description = "the cookie is set; where no token is needed, none"), Common),
    security(())
)]
pub async fn login(
    State(shared): State<Arc<Shared>>,
    Json(login): Json<Login>,
) -> Result<Response, ApiError> {
    if shared.tokens.is_empty() {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let client = shared.tokens.client(&login.token);
    let cookie = client.and_then(|client| shared.tokens.cookie(&client, now_s() + LOGIN_S));
    let Some(cookie) = cookie else {
        return Err(ApiError::new(
            StatusCode::UNAUTHORIZED,
            ErrorKind::Unauthorized,
            "this token is not known here",
        ));
    };
    let secure = if shared.tls { "; Secure" } else { "" };
    let cookie = format!("{COOKIE}={cookie}; Path=/; Max-Age={LOGIN_S}; HttpOnly; SameSite=Strict{secure}");
    let cookie = HeaderValue::from_str(&cookie).map_err(ApiError::internal)?;
    Ok((StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response())
}
