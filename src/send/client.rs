//! Requests to one host, with its key, never to another host.

use std::cell::RefCell;
use std::io::{self, Cursor, Read};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::Value;

use super::entry::{HostEntry, Secret};
use super::error::{Cause, SendError, Step};
use super::form::Form;
use super::patience::Patience;
use super::payload::{Counted, Payload};
use super::said::said;
use super::transport::{Broken, Incoming, Outgoing, Transport};

/// More is no answer.
const ANSWER_BYTES: u64 = 16 << 20;
/// Storing and analysing an upload may take so many times as long as other answers.
const SLOW: u32 = 10;
/// What stays as it is within a part of a path, or a value.
const KEPT: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// What a request carries.
pub(super) enum Body<'a> {
    None,
    Json(&'a Value),
    Text(&'a str),
    /// Type, length and source.
    Stream(String, u64, &'a mut dyn Read),
}

/// A request; the path is encoded and may have a query.
pub(super) struct Request<'a> {
    pub step: Step,
    pub method: &'static str,
    pub path: String,
    pub headers: Vec<(&'static str, String)>,
    pub body: Body<'a>,
}

impl Request<'static> {
    pub fn get(step: Step, path: impl Into<String>) -> Self {
        Self { step, method: "GET", path: path.into(), headers: Vec::new(), body: Body::None }
    }
}

impl<'a> Request<'a> {
    pub fn post(step: Step, path: impl Into<String>, body: Body<'a>) -> Self {
        Self { step, method: "POST", path: path.into(), headers: Vec::new(), body }
    }
}

/// An answer, whatever its status.
pub(super) struct Answer {
    pub status: u16,
    pub location: Option<String>,
    pub body: Vec<u8>,
}

/// How a host is answered that asks for a password.
pub(super) trait Login: Send {
    /// Takes what it asks with; `None`: it does not say.
    fn challenged(&self, challenge: Option<&str>);

    /// What a request says to the last challenge.
    fn answer(&self, method: &str, url: &str) -> Option<String>;
}

/// Requests to one host.
pub(super) struct Client {
    pub host: String,
    pub patience: Patience,
    transport: Box<dyn Transport>,
    pub base: String,
    /// Sent with every request.
    headers: RefCell<Vec<(&'static str, Secret)>>,
    login: Option<Box<dyn Login>>,
    /// What no message shows.
    secrets: Vec<Secret>,
}

impl Client {
    pub fn new(entry: &HostEntry, patience: Patience, transport: Box<dyn Transport>) -> Self {
        Self {
            host: entry.name.clone(),
            patience,
            transport,
            base: entry.url.clone(),
            headers: RefCell::default(),
            login: None,
            secrets: Vec::new(),
        }
    }

    /// Sends a key in a header with every request, instead of one that is there.
    pub fn set_header(&self, name: &'static str, value: Secret) {
        let mut headers = self.headers.borrow_mut();
        headers.retain(|(known, _)| *known != name);
        headers.push((name, value));
    }

    /// Shows a secret in no message.
    pub fn hide(mut self, secret: &Secret) -> Self {
        self.secrets.push(secret.clone());
        self
    }

    /// Logs in where the host asks for it.
    #[cfg(feature = "send")]
    pub fn login(mut self, login: impl Login + 'static) -> Self {
        self.login = Some(Box::new(login));
        self
    }

    pub fn error(
        &self,
        step: Step,
        cause: Cause,
        message: impl Into<String>,
        advice: impl Into<String>,
    ) -> SendError {
        SendError::new(&self.host, step, cause, self.without_secrets(message.into()), advice)
    }

    /// Gets something, again and again within the patience.
    pub fn get(&self, step: Step, path: &str) -> Result<Answer, SendError> {
        self.patience.with(|| self.checked(step, self.once(Request::get(step, path))?))
    }

    /// The same, which may not be there.
    pub fn find(&self, step: Step, path: &str) -> Result<Option<Answer>, SendError> {
        self.patience.with(|| {
            let answer = self.once(Request::get(step, path))?;
            if answer.status == 404 { Ok(None) } else { self.checked(step, answer).map(Some) }
        })
    }

    /// Gets JSON.
    pub fn json(&self, step: Step, path: &str) -> Result<Value, SendError> {
        self.patience.with(|| {
            let answer = self.checked(step, self.once(Request::get(step, path))?)?;
            self.read(step, &answer)
        })
    }

    /// An answer as JSON; what is none may be cut off.
    pub fn read(&self, step: Step, answer: &Answer) -> Result<Value, SendError> {
        serde_json::from_slice(&answer.body).map_err(|_| {
            let message = format!("its answer is no JSON: {}", self.said(answer));
            self.error(step, Cause::Answer, message, "is its kind the one in the file of hosts?").transient()
        })
    }

    /// An answer that is a success, or why it is none.
    pub fn checked(&self, step: Step, answer: Answer) -> Result<Answer, SendError> {
        let status = answer.status;
        let fail = |cause, advice: &str| Err(self.refused(step, &answer, cause, advice));
        match status {
            200..=299 => Ok(answer),
            300..=399 => {
                let to = answer.location.as_deref().unwrap_or("another address");
                let message = format!("it answers {status} and sends us to {to}");
                Err(self.error(
                    step,
                    Cause::Redirected,
                    message,
                    "the key is sent to no other address; if that one is right, write it as `url`",
                ))
            }
            401 | 403 => fail(
                Cause::Key,
                "the key is missing, wrong or not allowed to do this; copy it from the host's settings",
            ),
            404 => fail(Cause::Answer, "are its address and kind right?"),
            409 => fail(Cause::NotReady, "wait until the printer is ready"),
            413 | 507 => fail(Cause::Space, "delete files there"),
            408 | 425 | 429 | 500..=599 => {
                fail(Cause::Answer, "look into the host's own log").map_err(SendError::transient)
            }
            _ => fail(Cause::Answer, "are its address and kind right?"),
        }
    }

    /// A failure with what the host answered.
    pub fn refused(&self, step: Step, answer: &Answer, cause: Cause, advice: impl Into<String>) -> SendError {
        self.error(step, cause, format!("it answers {}: {}", answer.status, self.said(answer)), advice)
    }

    /// Makes one request, and answers a challenge for a password.
    pub fn once(&self, mut request: Request<'_>) -> Result<Answer, SendError> {
        let mut answer = self.exchange(&mut request)?;
        if answer.status == 401 && self.login.is_some() && !matches!(request.body, Body::Stream(..)) {
            answer = self.exchange(&mut request)?;
        }
        Ok(answer)
    }

    /// Sends a form with a file. The answer is not looked at.
    pub fn post_form(
        &self,
        form: &Form,
        path: &str,
        payload: &Payload,
        told: &mut dyn FnMut(u64),
    ) -> Result<Answer, SendError> {
        let file = self.opened(payload, told)?;
        let mut body = form.around(file);
        let body = Body::Stream(form.content_type(), form.length(payload.bytes), &mut body);
        self.once(Request::post(Step::Upload, path, body))
    }

    /// The file that is sent, read from its beginning.
    pub fn opened<'a>(
        &self,
        payload: &'a Payload,
        told: &'a mut dyn FnMut(u64),
    ) -> Result<Counted<'a>, SendError> {
        payload.open(told).map_err(|error| {
            let message = format!("{payload}: {error}");
            self.error(Step::Upload, Cause::File, message, "")
        })
    }

    /// That there is such a file already, as the host says.
    pub fn exists(&self, answer: &Answer, file: &str) -> SendError {
        self.refused(
            Step::Upload,
            answer,
            Cause::Exists,
            format!("--replace overwrites {file}, --as NAME calls it otherwise"),
        )
    }

    /// Reads an answer that may be long.
    pub fn read_all<T>(
        &self,
        step: Step,
        path: &str,
        read: &dyn Fn(&mut dyn Read) -> io::Result<T>,
    ) -> Result<T, SendError> {
        self.patience.with(|| {
            let mut incoming = self.respond(&mut Request::get(step, path))?;
            if (200..300).contains(&incoming.status) {
                return read(&mut incoming.body)
                    .map_err(|error| self.broken(step, self.transport.broken(error)));
            }
            let answer = Answer { location: None, ..self.whole(step, incoming)? };
            let status = answer.status;
            let unexpected = || self.error(step, Cause::Answer, format!("it answers {status}"), "");
            Err(self.checked(step, answer).err().unwrap_or_else(unexpected))
        })
    }

    fn exchange(&self, request: &mut Request<'_>) -> Result<Answer, SendError> {
        let incoming = self.respond(request)?;
        if let (401, Some(login)) = (incoming.status, &self.login) {
            login.challenged(incoming.challenge.as_deref());
        }
        self.whole(request.step, incoming)
    }

    /// An answer, read to its end.
    fn whole(&self, step: Step, incoming: Incoming) -> Result<Answer, SendError> {
        let mut body = Vec::new();
        let read = incoming.body.take(ANSWER_BYTES + 1).read_to_end(&mut body);
        read.map_err(|error| self.broken(step, self.transport.broken(error)))?;
        if body.len() as u64 > ANSWER_BYTES {
            let advice = "are its address and kind right?";
            return Err(self.error(step, Cause::Answer, "its answer is far too long", advice));
        }
        Ok(Answer { status: incoming.status, location: incoming.location, body })
    }

    fn respond(&self, request: &mut Request<'_>) -> Result<Incoming, SendError> {
        let url = format!("{}{}", self.base, request.path);
        let keys = self.headers.borrow();
        let mut headers: Vec<(&'static str, String)> =
            keys.iter().map(|(name, value)| (*name, value.expose().to_owned())).collect();
        headers.extend(request.headers.iter().cloned());
        let answer = self.login.as_ref().and_then(|login| login.answer(request.method, &url));
        headers.extend(answer.map(|answer| ("Authorization", answer)));
        let silence = self.patience.silence;
        let mut text = Cursor::new(match &request.body {
            Body::Json(value) => value.to_string(),
            Body::Text(text) => (*text).to_owned(),
            Body::None | Body::Stream(..) => String::new(),
        });
        let length = text.get_ref().len() as u64;
        let (kind, body, silence): (_, Option<(u64, &mut dyn Read)>, _) = match &mut request.body {
            Body::None => (None, None, silence),
            Body::Json(_) => (Some("application/json"), Some((length, &mut text)), silence),
            Body::Text(_) => (Some("text/plain"), Some((length, &mut text)), silence),
            Body::Stream(kind, length, reader) => {
                (Some(&**kind), Some((*length, &mut **reader)), silence * SLOW)
            }
        };
        headers.extend(kind.map(|kind| ("Content-Type", kind.to_owned())));
        let outgoing = Outgoing { method: request.method, url: &url, headers: &headers, body, silence };
        self.transport.exchange(outgoing).map_err(|broken| self.broken(request.step, broken))
    }

    fn broken(&self, step: Step, broken: Broken) -> SendError {
        SendError {
            is_transient: broken.is_transient,
            is_unsent: broken.is_unsent,
            ..self.error(step, broken.cause, broken.message, broken.advice)
        }
    }

    /// An answer in short, without secrets.
    fn said(&self, answer: &Answer) -> String {
        self.without_secrets(said(&answer.body))
    }

    fn without_secrets(&self, mut text: String) -> String {
        let headers = self.headers.borrow();
        let secrets = headers.iter().map(|(_, secret)| secret).chain(&self.secrets);
        for secret in secrets.filter(|secret| secret.expose().len() > 3) {
            text = text.replace(secret.expose(), "…");
        }
        text
    }
}

/// A part of a path, or a value of a query.
pub(super) fn encoded(text: &str) -> String {
    utf8_percent_encode(text, KEPT).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_encoded_in_paths() {
        assert_eq!(encoded("a b+c/é.gcode"), "a%20b%2Bc%2F%C3%A9.gcode");
    }
}
