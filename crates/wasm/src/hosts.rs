//! Print hosts: the library talks to them, a function of the worker makes the requests, one after the other.

use std::cell::RefCell;
use std::io::{self, Cursor};
use std::time::Duration;

use js_sys::{Function, JSON, Reflect, Uint8Array};
use pathwright::send::{
    Broken, Cause, HostEntry, HostKind, Incoming, KeySource, Outgoing, Patience, Payload, PrintHost, Secret,
    SendError, Transport, Wanted, connect_by, print,
};
use serde::Deserialize;
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsCast, JsValue};

use crate::error::{Fault, Result};
use crate::told::clock;

thread_local! {
    /// What makes a request, and what waits.
    static WAYS: RefCell<Option<[Function; 2]>> = const { RefCell::new(None) };
}

/// Makes requests by `exchange(method, url, headers, body, milliseconds)`, which gives `{ status, body }` or `{ broken }`, and waits
/// by `pause(milliseconds)`; neither returns before it is done.
#[wasm_bindgen]
pub fn network(exchange: Function, pause: Function) {
    WAYS.set(Some([exchange, pause]));
}

/// A host as the page knows it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Host {
    name: String,
    kind: String,
    url: String,
    #[serde(default)]
    key: String,
    /// Where the page is from, which the host must allow.
    origin: String,
}

impl Host {
    fn of(text: &str) -> Result<Self> {
        serde_json::from_str(text).map_err(|error| Fault::usage(format!("the host: {error}")))
    }

    fn entry(&self) -> Result<HostEntry> {
        let kind = HostKind::from_name(&self.kind);
        let kind =
            kind.ok_or_else(|| Fault::settings(format!("there is no kind of host `{}`", self.kind)))?;
        let mut entry = HostEntry::new(&self.name, kind, &self.url).map_err(Fault::settings)?;
        if !self.key.trim().is_empty() {
            entry.key = KeySource::Given(Secret::new(&self.key));
        }
        Ok(entry)
    }

    /// What a request that never comes back may mean.
    fn advice(&self, kind: HostKind) -> String {
        let Self { origin, url, .. } = self;
        if origin.starts_with("https:") && !url.starts_with("https:") {
            let advice = "a page with https:// may ask no address with http://: open the page by http:// in your network, or give the host \
                          a certificate";
            return advice.to_owned();
        }
        let allow = match kind {
            HostKind::Moonraker => format!(
                "moonraker.conf needs, in [authorization], `cors_domains:` with the line `{origin}`, and a restart"
            ),
            HostKind::OctoPrint => {
                "OctoPrint needs Settings › API › Allow Cross Origin Resource Sharing (CORS), and a restart"
                    .to_owned()
            }
            HostKind::Duet => format!("config.g needs M586 C\"{origin}\""),
            HostKind::PrusaLink => {
                "PrusaLink allows no page but its own: `pathwright app` sends to it".to_owned()
            }
        };
        format!(
            "either it cannot be reached: is it on, and are address and port right? Or it does not allow this page: {allow}"
        )
    }

    fn connected(&self, patience: Patience) -> Result<(HostEntry, Box<dyn PrintHost>)> {
        let entry = self.entry()?;
        let way = Way { advice: self.advice(entry.kind) };
        let host = connect_by(&entry, patience, Box::new(way)).map_err(fault)?;
        Ok((entry, host))
    }
}

/// The address of a host, with its scheme.
#[wasm_bindgen]
pub fn host_address(host: &str) -> Result<String> {
    Ok(Host::of(host)?.entry()?.url)
}

/// What a host (JSON) says it is, and does, as JSON.
#[wasm_bindgen]
pub fn host_state(host: &str) -> Result<String> {
    let (_, host) = Host::of(host)?.connected(patience(0, 5))?;
    let (about, state) = (host.about().map_err(fault)?, host.state().map_err(fault)?);
    Ok(json!({ "about": about, "state": state }).to_string())
}

/// Sends a print to a host (JSON) as it is wanted (JSON), and gives what has been done, as JSON.
#[wasm_bindgen]
pub fn host_print(host: &str, wanted: &str, gcode: Vec<u8>) -> Result<String> {
    let wanted: Wanted =
        serde_json::from_str(wanted).map_err(|error| Fault::usage(format!("the print: {error}")))?;
    let described = Host::of(host)?;
    // What cannot be reached at all is not tried again and again.
    described.connected(patience(0, 5))?.1.about().map_err(fault)?;
    let (entry, host) = described.connected(patience(30, 30))?;
    let payload = Payload::of_bytes(gcode).map_err(Fault::usage)?;
    Ok(json!(print(host.as_ref(), &entry, &payload, &wanted, &mut |_| {}).map_err(fault)?).to_string())
}

fn patience(retry_s: u64, silence_s: u64) -> Patience {
    Patience {
        retry: Duration::from_secs(retry_s),
        silence: Duration::from_secs(silence_s),
        told: |_| {},
        clock,
        pause: |time| {
            let pause = WAYS.with_borrow(|ways| ways.as_ref().map(|[_, pause]| pause.clone()));
            let waits = pause.map(|pause| pause.call1(&JsValue::NULL, &millis(time)));
            debug_assert!(matches!(waits, Some(Ok(_))), "the worker gives a way to wait");
        },
    }
}

fn millis(time: Duration) -> JsValue {
    JsValue::from_f64(time.as_secs_f64() * 1e3)
}

fn fault(error: SendError) -> Fault {
    let kind = match error.cause {
        Cause::Settings => "settings",
        Cause::Mismatch => "check",
        _ => "host",
    };
    Fault::of(kind, error)
}

/// Requests by the worker's function.
struct Way {
    advice: String,
}

impl Way {
    fn lost(&self, cause: Cause, message: &str) -> Broken {
        let advice = self.advice.clone();
        Broken { cause, message: message.to_owned(), advice, is_transient: true, is_unsent: false }
    }
}

impl Transport for Way {
    fn exchange(&self, request: Outgoing<'_>) -> std::result::Result<Incoming, Broken> {
        let exchange = WAYS.with_borrow(|ways| ways.as_ref().map(|[exchange, _]| exchange.clone()));
        let unanswered = || self.lost(Cause::Unreachable, "nothing comes back");
        let exchange = exchange.ok_or_else(unanswered)?;
        let mut bytes = Vec::new();
        let body = match request.body {
            None => JsValue::UNDEFINED,
            Some((_, reader)) => {
                reader.read_to_end(&mut bytes).map_err(|error| self.lost(Cause::File, &error.to_string()))?;
                Uint8Array::from(&*bytes).into()
            }
        };
        let headers: Value =
            request.headers.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        let headers = JSON::parse(&headers.to_string()).map_err(|_| unanswered())?;
        let arguments = [request.method.into(), request.url.into(), headers, body, millis(request.silence)];
        let answer = exchange.apply(&JsValue::NULL, &arguments.iter().collect()).map_err(|_| unanswered())?;
        let told = |name: &str| Reflect::get(&answer, &name.into()).unwrap_or(JsValue::UNDEFINED);
        if let Some(message) = told("broken").as_string() {
            return Err(self.lost(Cause::Unreachable, &message));
        }
        let status = told("status").as_f64().ok_or_else(unanswered)? as u16;
        let body = told("body").dyn_into::<Uint8Array>().map_err(|_| unanswered())?.to_vec();
        Ok(Incoming { status, location: None, challenge: None, body: Box::new(Cursor::new(body)) })
    }

    fn broken(&self, error: io::Error) -> Broken {
        self.lost(Cause::Unreachable, &format!("the connection broke: {error}"))
    }
}
