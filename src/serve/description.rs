//! What the description of the service says of every request: the answers that any can have, and how a client is known.

use std::collections::BTreeMap;

use serde::Deserialize;
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::openapi::{Content, Ref, RefOr, ResponseBuilder, response};
use utoipa::{IntoResponses, Modify, ToSchema};

/// Tokens in the `Authorization` header.
pub struct Schemes;

impl Modify for Schemes {
    fn modify(&self, openapi: &mut utoipa::openapi::OpenApi) {
        let token = HttpBuilder::new().scheme(HttpAuthScheme::Bearer);
        let token =
            token.description(Some("a line of the token file; where there is none, nothing is needed"));
        let components = openapi.components.get_or_insert_default();
        components.add_security_scheme("token", SecurityScheme::Http(token.build()));
    }
}

/// Answers that any request can have.
pub struct Common;

impl IntoResponses for Common {
    fn responses() -> BTreeMap<String, RefOr<response::Response>> {
        let all = [
            ("400", "the request makes no sense"),
            ("401", "no token, or a wrong one"),
            ("403", "called by a foreign name, or from a foreign page"),
            ("408", "the request came too slowly"),
            ("413", "the request is larger than this server takes"),
            ("415", "the body is of another type"),
            ("429", "too much of this client at once"),
            ("500", "a mistake of the program, or of its machine"),
            ("503", "too much of all clients at once, or the server is ending"),
        ];
        let body = || Content::new(Some(Ref::from_schema_name("ErrorBody")));
        let response =
            |text: &str| ResponseBuilder::new().description(text).content("application/json", body()).build();
        all.into_iter().map(|(status, text)| (status.to_owned(), response(text).into())).collect()
    }
}

/// A server-sent event.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "described, not made")]
pub struct ServerSentEvent {
    /// What has happened.
    event: String,
    /// What is known of it, as JSON.
    data: String,
}
