//! Bodies of requests: not larger than allowed, and not slower than any network.

use std::error::Error;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt;
use hyper::body::{Frame, SizeHint};
use tokio::time::{Instant, Sleep, sleep_until};

use super::error::ApiError;
use super::refused::{PACE_BYTES_PER_S, Refused};
use super::shared::Shared;

/// Refuses bodies that say that they are too large, and watches the others.
pub async fn guarded(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let (most, grace) = (shared.limits.upload_bytes, shared.limits.body_time);
    if request.body().size_hint().lower() > most {
        return ApiError::from(Refused::TooLarge { most }).into_response();
    }
    let guard = |inner: Body| Body::new(Guarded { inner, taken: 0, most, grace, timer: None });
    next.run(request.map(guard)).await
}

struct Guarded {
    inner: Body,
    taken: u64,
    most: u64,
    grace: Duration,
    /// Since it is read: when that began, and when it is late.
    timer: Option<(Instant, Pin<Box<Sleep>>)>,
}

impl HttpBody for Guarded {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let this = &mut *self;
        let grace = this.grace;
        let (begun, late) = this.timer.get_or_insert_with(|| {
            let now = Instant::now();
            (now, Box::pin(sleep_until(now + grace)))
        });
        match Pin::new(&mut this.inner).poll_frame(context) {
            Poll::Ready(Some(Ok(frame))) => {
                this.taken += frame.data_ref().map_or(0, |data| data.len() as u64);
                if this.taken > this.most {
                    return Poll::Ready(Some(Err(axum::Error::new(Refused::TooLarge { most: this.most }))));
                }
                let allowed = grace + Duration::from_secs(this.taken / PACE_BYTES_PER_S);
                late.as_mut().reset(*begun + allowed);
                Poll::Ready(Some(Ok(frame)))
            }
            Poll::Pending => {
                let is_late = late.as_mut().poll(context).is_ready();
                if is_late {
                    Poll::Ready(Some(Err(axum::Error::new(Refused::TooSlow))))
                } else {
                    Poll::Pending
                }
            }
            end => end,
        }
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

/// A body as one piece.
///
/// # Errors
/// It is too large or too slow, or the connection ends.
pub async fn whole(body: Body) -> Result<Bytes, ApiError> {
    match body.collect().await {
        Ok(collected) => Ok(collected.to_bytes()),
        Err(error) => Err(unread(&error)),
    }
}

/// The answer to a body that could not be read.
pub fn unread(error: &(dyn Error + 'static)) -> ApiError {
    match Refused::behind(error) {
        Some(refused) => refused.into(),
        None => ApiError::usage(format!("the request ended early: {error}")),
    }
}
