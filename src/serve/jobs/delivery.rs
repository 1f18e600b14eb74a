//! Files as answers: whole or in part, with a tag by which a client knows what it has.

use std::io::SeekFrom;
use std::path::Path;

use axum::body::{Body, Bytes};
use axum::http::StatusCode;
use axum::http::header::{self, HeaderMap, HeaderValue};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use http_range_header::parse_range_header;
use tokio::fs::File;
use tokio::io::{AsyncReadExt, AsyncSeekExt};

use crate::serve::error::{ApiError, ErrorKind};
use crate::serve::names::disposition;

/// Bytes that are read at once.
const CHUNK: usize = 1 << 16;

/// What a file is sent as.
#[derive(Clone, Copy, Debug)]
pub struct Sent<'a> {
    /// Its type.
    pub content_type: &'static str,
    /// What it is saved as.
    pub name: &'a str,
    /// Hash of its contents, or of all that they depend on.
    pub tag: &'a str,
}

/// A file, or the part of it that is asked for.
///
/// # Errors
/// It cannot be read; the part lies outside of it.
pub async fn file(path: &Path, headers: &HeaderMap, sent: Sent<'_>) -> Result<Response, ApiError> {
    let tag = format!("\"{}\"", sent.tag);
    if has_tag(headers, &tag) {
        return Ok((StatusCode::NOT_MODIFIED, [(header::ETAG, tag)]).into_response());
    }
    let mut file = File::open(path).await?;
    let bytes = file.metadata().await?.len();
    let range = headers
        .get(header::RANGE)
        .filter(|_| headers.get(header::IF_RANGE).is_none_or(|same| same.as_bytes() == tag.as_bytes()));
    // What is no range is passed over, as the standard says; several are answered by the whole.
    let range = range.and_then(|range| parse_range_header(range.to_str().ok()?).ok());
    let part = match range.map(|range| range.validate(bytes)) {
        None => None,
        Some(Ok(parts)) if parts.len() == 1 => parts.into_iter().next(),
        Some(Ok(_)) => None,
        Some(Err(_)) => {
            let message = format!("the file has {bytes} bytes");
            let error = ApiError::new(StatusCode::RANGE_NOT_SATISFIABLE, ErrorKind::Usage, message);
            return Ok(([(header::CONTENT_RANGE, format!("bytes */{bytes}"))], error).into_response());
        }
    };
    let (status, first, length) = match &part {
        Some(part) => (StatusCode::PARTIAL_CONTENT, *part.start(), part.end() - part.start() + 1),
        None => (StatusCode::OK, 0, bytes),
    };
    file.seek(SeekFrom::Start(first)).await?;
    let mut response = (status, body(file, length)).into_response();
    let answer = response.headers_mut();
    answer.insert(header::CONTENT_LENGTH, HeaderValue::from(length));
    answer.insert(header::CONTENT_TYPE, HeaderValue::from_static(sent.content_type));
    answer.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    answer.insert(header::CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    let mut set = |name, value: String| {
        if let Ok(value) = HeaderValue::from_str(&value) {
            answer.insert(name, value);
        }
    };
    set(header::ETAG, tag);
    set(header::CONTENT_DISPOSITION, disposition(sent.name));
    if let Some(part) = part {
        set(header::CONTENT_RANGE, format!("bytes {}-{}/{bytes}", part.start(), part.end()));
    }
    Ok(response)
}

/// Whether the client has it already.
pub fn has_tag(headers: &HeaderMap, tag: &str) -> bool {
    let given = headers.get_all(header::IF_NONE_MATCH).into_iter().filter_map(|line| line.to_str().ok());
    let mut tags = given.flat_map(|line| line.split(',')).map(|given| given.trim().trim_start_matches("W/"));
    tags.any(|given| given == tag || given == "*")
}

/// The next bytes of a file.
fn body(file: File, length: u64) -> Body {
    Body::from_stream(stream::try_unfold((file, length), |(mut file, left)| async move {
        if left == 0 {
            return Ok(None);
        }
        let mut chunk = vec![0; CHUNK.min(usize::try_from(left).unwrap_or(CHUNK))];
        let read = file.read(&mut chunk).await?;
        if read == 0 {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof));
        }
        chunk.truncate(read);
        Ok(Some((Bytes::from(chunk), (file, left - read as u64))))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_found_among_several() {
        let headers = |text: &str| {
            HeaderMap::from_iter([(header::IF_NONE_MATCH, HeaderValue::from_str(text).unwrap())])
        };
        assert!(has_tag(&headers("\"x\", W/\"y\""), "\"y\"") && has_tag(&headers("*"), "\"y\""));
        assert!(!has_tag(&headers("\"x\""), "\"y\"") && !has_tag(&HeaderMap::new(), "\"y\""));
    }
}
