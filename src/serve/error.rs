//! What a request can be answered with when it fails: a status, and the same as JSON everywhere.

use axum::http::StatusCode;
use axum::http::header::{self, HeaderValue};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::job::JobError;
use crate::profile::ProfileError;

/// What kind of mistake it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorKind {
    /// The request makes no sense.
    Usage,
    /// A model or G-code cannot be read, or there is nothing to print.
    Input,
    /// Unknown profile, preset or key, value out of range, conflict, mistake in a script.
    Settings,
    /// The models do not fit the printer.
    DoesNotFit,
    /// A check of the result failed, or something would begin in mid-air.
    Check,
    /// A limit of this server is reached; the message names it.
    Limit,
    /// There is no such thing, or no longer.
    NotFound,
    /// No token or a wrong one, a wrong Host or Origin.
    Unauthorized,
    /// A print host cannot be reached, fails or refuses.
    Host,
    /// A mistake of this program, or its disk is full.
    Internal,
}

/// What went wrong, in words for people, and where.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Kind of mistake.
    pub kind: ErrorKind,
    /// What is wrong and how to mend it.
    pub message: String,
    /// The object that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<String>,
    /// The setting that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
}

/// The body of every answer that is no success.
#[derive(Debug, Serialize, Deserialize, ToSchema)]
pub struct ErrorBody {
    /// What went wrong.
    pub error: Problem,
}

/// A failed request.
#[derive(Debug)]
pub struct ApiError {
    status: StatusCode,
    problem: Problem,
    /// Seconds after which it is worth another try.
    retry_after_s: Option<u32>,
}

impl ApiError {
    /// A failure of a kind.
    pub fn new(status: StatusCode, kind: ErrorKind, message: impl ToString) -> Self {
        let problem = Problem { kind, message: message.to_string(), object: None, key: None };
        Self { status, problem, retry_after_s: None }
    }

    /// 400: the request makes no sense.
    pub fn usage(message: impl ToString) -> Self {
        Self::new(StatusCode::BAD_REQUEST, ErrorKind::Usage, message)
    }

    /// 404: there is no such thing.
    pub fn not_found(message: impl ToString) -> Self {
        Self::new(StatusCode::NOT_FOUND, ErrorKind::NotFound, message)
    }

    /// 410: it was there.
    pub fn gone(message: impl ToString) -> Self {
        Self::new(StatusCode::GONE, ErrorKind::NotFound, message)
    }

    /// 413: more than a limit allows.
    pub fn too_large(message: impl ToString) -> Self {
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, ErrorKind::Limit, message)
    }

    /// 429: too much of this client at once; it may try again.
    pub fn too_many(message: impl ToString) -> Self {
        Self::new(StatusCode::TOO_MANY_REQUESTS, ErrorKind::Limit, message).retry_after(5)
    }

    /// 503: too much of all clients at once; it may try again.
    pub fn busy(message: impl ToString) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, ErrorKind::Limit, message).retry_after(5)
    }

    /// 422: understood, but nothing can be made of it.
    pub fn unusable(kind: ErrorKind, message: impl ToString) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, kind, message)
    }

    /// 500: a mistake of this program or of its machine.
    pub fn internal(message: impl ToString) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, ErrorKind::Internal, message)
    }

    /// When it is worth another try.
    #[must_use]
    pub fn retry_after(mut self, seconds: u32) -> Self {
        self.retry_after_s = Some(seconds);
        self
    }

    /// What is told, without the status.
    pub fn into_problem(self) -> Problem {
        self.problem
    }

    /// What is told.
    #[cfg(test)]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = (self.status, axum::Json(ErrorBody { error: self.problem })).into_response();
        let headers = response.headers_mut();
        if self.status == StatusCode::UNAUTHORIZED {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        if let Some(seconds) = self.retry_after_s {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        response
    }
}

impl From<Problem> for ApiError {
    fn from(problem: Problem) -> Self {
        let status = match problem.kind {
            ErrorKind::Internal => StatusCode::INTERNAL_SERVER_ERROR,
            ErrorKind::NotFound => StatusCode::NOT_FOUND,
            ErrorKind::Unauthorized => StatusCode::UNAUTHORIZED,
            ErrorKind::Usage => StatusCode::BAD_REQUEST,
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        Self { status, problem, retry_after_s: None }
    }
}

impl From<&JobError> for Problem {
    fn from(error: &JobError) -> Self {
        let (kind, key) = match error {
            JobError::Mesh(_) | JobError::Input(_) => (ErrorKind::Input, None),
            JobError::Settings(error) => (ErrorKind::Settings, first_key(error)),
            JobError::Script { .. } => (ErrorKind::Settings, None),
            JobError::DoesNotFit(_) => (ErrorKind::DoesNotFit, None),
            JobError::Check(_) => (ErrorKind::Check, None),
            JobError::Output(_) => (ErrorKind::Internal, None),
            JobError::Cancelled => (ErrorKind::Usage, None),
        };
        Self { kind, message: error.to_string(), object: None, key }
    }
}

fn first_key(error: &ProfileError) -> Option<String> {
    error.problems.iter().find_map(|problem| problem.setting.as_ref().map(|(key, _)| key.clone()))
}

impl From<JobError> for ApiError {
    fn from(error: JobError) -> Self {
        Problem::from(&error).into()
    }
}

impl From<ProfileError> for ApiError {
    fn from(error: ProfileError) -> Self {
        JobError::from(error).into()
    }
}
