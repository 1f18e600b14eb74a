//! What happens to a job, as server-sent events.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::response::sse::Event;
use futures_util::{Stream, stream};
use tokio::sync::watch;
use tokio::time::sleep;

use super::hub::Jobs;
use super::record::{JobView, State};
use crate::serve::error::ApiError;
use crate::serve::streams::StreamPermit;
use crate::serve::tokens::Client;

/// Shortest time between two events.
const PACE: Duration = Duration::from_millis(100);

struct Following {
    jobs: Arc<Jobs>,
    client: Client,
    id: String,
    last: Option<JobView>,
    ending: watch::Receiver<bool>,
    _permit: StreamPermit,
}

/// The job now, and whenever it is another; until it has ended.
///
/// # Errors
/// There is no such job, or too many streams are open.
pub fn follow(
    jobs: &Arc<Jobs>,
    client: Client,
    id: String,
) -> Result<impl Stream<Item = Result<Event, Infallible>> + use<>, ApiError> {
    jobs.index().view(&id, &client.0)?;
    let permit = jobs.shared.streams.open(&client, &jobs.shared.limits)?;
    let ending = jobs.shared.ending.clone();
    let following = Following { jobs: jobs.clone(), client, id, last: None, ending, _permit: permit };
    Ok(stream::unfold(following, |mut following| async move {
        let view = following.next().await?;
        let event = Event::default().event("job").json_data(&view).ok()?;
        following.last = Some(view);
        Some((Ok(event), following))
    }))
}

impl Following {
    async fn next(&mut self) -> Option<JobView> {
        let is_over = |view: &JobView| !matches!(view.state, State::Waiting | State::Running);
        if self.last.as_ref().is_some_and(is_over) {
            return None;
        }
        if self.last.is_some() {
            sleep(PACE).await;
        }
        loop {
            let (watch, view) = {
                let index = self.jobs.index();
                (index.watch(&self.id), index.view(&self.id, &self.client.0).ok()?)
            };
            if self.last.as_ref() != Some(&view) {
                return Some(view);
            }
            let mut watch = watch?;
            tokio::select! {
                // An error: the work has ended, which is seen when it is looked at again.
                _ = watch.changed() => {}
                _ = self.ending.wait_for(|ending| *ending) => return None,
            }
        }
    }
}
