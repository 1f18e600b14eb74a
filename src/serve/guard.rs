//! Keeps other pages out: the server is called by a name of its own, by its own page, and its answers are of use nowhere else.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::error::{ApiError, ErrorKind};
use super::shared::Shared;

/// What pages may do: nothing but what comes from here.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; worker-src 'self'; connect-src 'self'; \
    img-src 'self' data: blob:; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";

/// Headers of every answer that does not have its own.
const HEADERS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
];

/// Refuses requests by foreign names and from foreign pages, and sets the headers of the answers.
pub async fn guarded(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let refused = refusal(request.method(), request.uri(), request.headers(), &shared.hosts);
    let mut response = match refused {
        Some(refused) => refused.into_response(),
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

/// Why a request is not for this server.
fn refusal(method: &Method, uri: &Uri, headers: &HeaderMap, hosts: &[String]) -> Option<ApiError> {
    let Some(host) = host(uri, headers) else {
        return Some(ApiError::usage("one Host is needed"));
    };
    if !is_own(host, hosts) {
        let message = format!(
            "this server is not called `{host}`: call it by its address, or start it with --host {}",
            name(host)
        );
        return Some(forbidden(message));
    }
    if let Some(origin) = headers.get(header::ORIGIN) {
        let authority = origin.to_str().ok().and_then(|text| text.split_once("://")).map(|(_, rest)| rest);
        let is_same = authority.is_some_and(|authority| {
            authority.eq_ignore_ascii_case(host)
                || hosts.iter().any(|own| own.eq_ignore_ascii_case(name(authority)))
        });
        if !is_same {
            return Some(forbidden("this page is from elsewhere: only the server's own page may ask"));
        }
    }
    let said = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
    let is_foreign = matches!(said("sec-fetch-site"), Some("cross-site" | "same-site"));
    let is_link = method == Method::GET && uri.path() == "/" && said("sec-fetch-mode") == Some("navigate");
    (is_foreign && !is_link)
        .then(|| forbidden("this page is from elsewhere: only the server's own page may ask"))
}

fn forbidden(message: impl ToString) -> ApiError {
    ApiError::new(StatusCode::FORBIDDEN, ErrorKind::Unauthorized, message)
}

/// Name and port by which the server is called.
fn host<'a>(uri: &'a Uri, headers: &'a HeaderMap) -> Option<&'a str> {
    let mut all = headers.get_all(header::HOST).into_iter();
    let first = all.next().map(|host| host.to_str());
    if all.next().is_some() {
        return None;
    }
    uri.authority().map(|authority| authority.as_str()).or(first?.ok())
}

/// Without the port.
fn name(host: &str) -> &str {
    match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((address, _)) => address,
        None => host.split(':').next().unwrap_or_default(),
    }
}

/// An address is nobody else's name: what leads elsewhere today and here tomorrow (DNS rebinding) is a name.
fn is_own(host: &str, hosts: &[String]) -> bool {
    let name = name(host);
    name.parse::<IpAddr>().is_ok()
        || name.eq_ignore_ascii_case("localhost")
        || hosts.iter().any(|own| own.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(headers: &[(&'static str, &str)]) -> u16 {
        let hosts = ["slicer.example".to_owned()];
        let headers = headers
            .iter()
            .map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_str(value).unwrap()));
        let headers: HeaderMap = headers.collect();
        let refused = refusal(&Method::POST, &Uri::from_static("/v1/jobs"), &headers, &hosts);
        refused.map_or(200, |refused| refused.into_response().status().as_u16())
    }

    #[test]
    fn only_own_names_and_addresses_are_answered() {
        for own in
            ["127.0.0.1:8080", "localhost", "LOCALHOST:1", "[::1]:80", "10.0.0.7", "Slicer.Example:443"]
        {
            assert_eq!(status(&[("host", own)]), 200, "{own}");
        }
        for other in ["evil.example", "localhost.evil.example", "127.0.0.1.evil.example:8080", "", "[x]"] {
            assert_eq!(status(&[("host", other)]), 403, "{other}");
        }
        assert_eq!(status(&[]), 400);
    }

    #[test]
    fn only_the_own_page_may_ask() {
        let from = |origin| status(&[("host", "localhost:8080"), ("origin", origin)]);
        assert_eq!(from("http://localhost:8080"), 200);
        assert_eq!(from("https://slicer.example"), 200, "a proxy's name");
        for other in
            ["http://localhost:3000", "https://evil.example", "null", "http://localhost:8080.evil.example"]
        {
            assert_eq!(from(other), 403, "{other}");
        }
        let site = |site| status(&[("host", "localhost"), ("sec-fetch-site", site)]);
        assert_eq!(
            [site("same-origin"), site("none"), site("same-site"), site("cross-site")],
            [200, 200, 403, 403]
        );
    }
}
