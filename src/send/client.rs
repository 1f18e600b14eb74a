//! Requests to one host: encrypted where its address says so, with its key, never to another host.

use std::cell::RefCell;
use std::io::{self, Read};
use std::time::Duration;

use http_auth::{PasswordClient, PasswordParams};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::Value;
use ureq::{Agent, SendBody};

use super::entry::{HostEntry, Secret};
use super::error::{Cause, SendError, Step};
use super::form::Form;
use super::patience::Patience;
use super::payload::{Counted, Payload};
use super::said::said;
use super::tls::tls;

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
    pub method: http::Method,
    pub path: String,
    pub headers: Vec<(&'static str, String)>,
    pub body: Body<'a>,
}

impl Request<'static> {
    pub fn get(step: Step, path: impl Into<String>) -> Self {
        Self { step, method: http::Method::GET, path: path.into(), headers: Vec::new(), body: Body::None }
    }
}

impl<'a> Request<'a> {
    pub fn post(step: Step, path: impl Into<String>, body: Body<'a>) -> Self {
        Self { step, method: http::Method::POST, path: path.into(), headers: Vec::new(), body }
    }
}

/// An answer, whatever its status.
pub(super) struct Answer {
    pub status: u16,
    pub location: Option<String>,
    pub body: Vec<u8>,
}

/// Requests to one host.
pub(super) struct Client {
    pub host: String,
    pub patience: Patience,
    agent: Agent,
    pub base: String,
    /// Sent with every request.
    headers: RefCell<Vec<(&'static str, Secret)>>,
    /// User and password, and the last challenge of the host.
    login: Option<(String, Secret)>,
    challenge: RefCell<Option<PasswordClient>>,
    /// What no message shows.
    secrets: Vec<Secret>,
}

impl Client {
    pub fn new(entry: &HostEntry, patience: Patience) -> Result<Self, SendError> {
        let wrong = |message: String, advice: &str| {
            SendError::new(&entry.name, Step::Configure, Cause::Settings, message, advice)
        };
        let mut config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .max_idle_connections(0)
            .user_agent(concat!("pathwright/", env!("CARGO_PKG_VERSION")))
            .timeout_resolve(Some(patience.silence))
            .timeout_connect(Some(patience.silence))
            .timeout_per_read(Some(patience.silence))
            .timeout_per_write(Some(patience.silence));
        if entry.url.starts_with("https:") {
            config = config.tls_config(tls(entry).map_err(|(message, advice)| wrong(message, advice))?);
        }
        Ok(Self {
            host: entry.name.clone(),
            patience,
            agent: config.build().new_agent(),
            base: entry.url.clone(),
            headers: RefCell::default(),
            login: None,
            challenge: RefCell::default(),
            secrets: Vec::new(),
        })
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

    /// Logs in with a password where the host asks for it.
    pub fn login(mut self, user: &str, password: Secret) -> Self {
        self.login = Some((user.to_owned(), password));
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
        payload: &Payload,
        told: &'a mut dyn FnMut(u64),
    ) -> Result<Counted<'a>, SendError> {
        payload.open(told).map_err(|error| {
            let message = format!("{}: {error}", payload.path.display());
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
            let mut response = self.respond(&mut Request::get(step, path))?;
            let status = response.status().as_u16();
            if !(200..300).contains(&status) {
                let body =
                    response.body_mut().with_config().limit(ANSWER_BYTES).read_to_vec().unwrap_or_default();
                return Err(self
                    .checked(step, Answer { status, location: None, body })
                    .err()
                    .unwrap_or_else(|| self.error(step, Cause::Answer, format!("it answers {status}"), "")));
            }
            read(&mut response.body_mut().as_reader()).map_err(|error| self.broken(step, error.into()))
        })
    }

    fn exchange(&self, request: &mut Request<'_>) -> Result<Answer, SendError> {
        let mut response = self.respond(request)?;
        let step = request.step;
        let location = header(&response, "location");
        let status = response.status().as_u16();
        if status == 401 && self.login.is_some() {
            let challenge = header(&response, "www-authenticate");
            *self.challenge.borrow_mut() =
                challenge.and_then(|text| PasswordClient::builder().challenges(&text).build().ok());
        }
        let body = response.body_mut().with_config().limit(ANSWER_BYTES).read_to_vec();
        let body = body.map_err(|error| self.broken(step, error))?;
        Ok(Answer { status, location, body })
    }

    fn respond(&self, request: &mut Request<'_>) -> Result<http::Response<ureq::Body>, SendError> {
        let step = request.step;
        let uri = format!("{}{}", self.base, request.path);
        let mut built = http::Request::builder().method(request.method.clone()).uri(&uri);
        for (name, value) in self.headers.borrow().iter() {
            built = built.header(*name, value.expose());
        }
        for (name, value) in &request.headers {
            built = built.header(*name, value);
        }
        if let Some(answer) = self.answer_to_challenge(request, &uri) {
            built = built.header("Authorization", answer);
        }
        let silence = self.patience.silence;
        let owned = |built: http::request::Builder, kind: &str, text: String| {
            let built = built.header("Content-Type", kind).header("Content-Length", text.len());
            self.run(step, built, SendBody::from_owned_reader(std::io::Cursor::new(text)), silence)
        };
        match &mut request.body {
            Body::None => self.run(step, built, SendBody::none(), silence),
            Body::Json(value) => owned(built, "application/json", value.to_string()),
            Body::Text(text) => owned(built, "text/plain", (*text).to_owned()),
            Body::Stream(kind, length, reader) => {
                let built = built.header("Content-Type", kind.as_str()).header("Content-Length", *length);
                self.run(step, built, SendBody::from_reader(reader), silence * SLOW)
            }
        }
    }

    fn run(
        &self,
        step: Step,
        built: http::request::Builder,
        body: SendBody<'_>,
        silence: Duration,
    ) -> Result<http::Response<ureq::Body>, SendError> {
        let built = built.body(body).map_err(|error| {
            self.error(step, Cause::Settings, format!("{}: {error}", self.base), "is the address right?")
        })?;
        let built = self.agent.configure_request(built).timeout_per_read(Some(silence)).build();
        self.agent.run(built).map_err(|error| self.broken(step, error))
    }

    fn answer_to_challenge(&self, request: &Request<'_>, uri: &str) -> Option<String> {
        let (user, password) = self.login.as_ref()?;
        let mut challenge = self.challenge.borrow_mut();
        let uri: http::Uri = uri.parse().ok()?;
        let asked = PasswordParams {
            username: user,
            password: password.expose(),
            uri: uri.path_and_query()?.as_str(),
            method: request.method.as_str(),
            body: None,
        };
        challenge.as_mut()?.respond(&asked).ok()
    }

    /// An answer in short, without secrets.
    fn said(&self, answer: &Answer) -> String {
        self.without_secrets(said(&answer.body))
    }

    fn without_secrets(&self, mut text: String) -> String {
        let headers = self.headers.borrow();
        let login = self.login.iter().map(|(_, password)| password);
        let secrets = headers.iter().map(|(_, secret)| secret).chain(login).chain(&self.secrets);
        for secret in secrets.filter(|secret| secret.expose().len() > 3) {
            text = text.replace(secret.expose(), "…");
        }
        text
    }
}

fn header(response: &http::Response<ureq::Body>, name: &str) -> Option<String> {
    response.headers().get(name)?.to_str().ok().map(str::to_owned)
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
