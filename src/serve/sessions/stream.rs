//! What happens to a session, as server-sent events.

use std::convert::Infallible;

use axum::response::sse::Event as Sent;
use futures_util::{Stream, stream};
use serde_json::{Value, json};
use tokio::sync::{mpsc, watch};

use super::hub::Watching;
use crate::live::{Event, Subscription};
use crate::serve::streams::StreamPermit;

/// Events that wait for a slow reader; who is slower is left, and gets everything anew when it comes back.
const WAITING: usize = 256;

struct Following {
    events: mpsc::Receiver<(&'static str, String)>,
    ending: watch::Receiver<bool>,
    _subscription: Subscription,
    _watching: Watching,
    _permit: StreamPermit,
}

/// Everything that is known of a session's last revision, then everything new.
pub fn follow(
    name: &str,
    watching: Watching,
    permit: StreamPermit,
    ending: watch::Receiver<bool>,
) -> impl Stream<Item = Result<Sent, Infallible>> + use<> {
    let (sender, events) = mpsc::channel(WAITING);
    let (name, entry) = (name.to_owned(), std::sync::Arc::downgrade(watching.entry()));
    let listener = move |event: &Event| {
        let compared = entry.upgrade().and_then(|entry| entry.compared());
        sender.try_send((event.name(), body(&name, event, compared).to_string())).is_ok()
    };
    let subscription = watching.entry().session.subscribe(listener);
    let following =
        Following { events, ending, _subscription: subscription, _watching: watching, _permit: permit };
    stream::unfold(following, |mut following| async move {
        let next = tokio::select! {
            next = following.events.recv() => next,
            _ = following.ending.wait_for(|ending| *ending) => None,
        };
        let (name, data) = next?;
        Some((Ok(Sent::default().event(name).data(data)), following))
    })
}

/// An event with the addresses of what it speaks of.
fn body(session: &str, event: &Event, compared: Option<[u64; 2]>) -> Value {
    let mut body = json!(event);
    let revision = event.revision();
    let at = |what: &str| json!(format!("/v1/sessions/{session}/revisions/{revision}/{what}"));
    match event {
        Event::Walls(_) => body["url"] = at("walls"),
        Event::Done(_) => {
            body["url"] = at("preview");
            body["gcode"] = at("gcode");
        }
        _ => {}
    }
    let side = compared.and_then(|[a, b]| match revision {
        _ if revision == a => Some("a"),
        _ if revision == b => Some("b"),
        _ => None,
    });
    if let Some(side) = side {
        body["side"] = json!(side);
    }
    body
}
