//! Requests to one host: encrypted where its address says so, with its key, never to another host.

use std::cell::RefCell;
use std::io::Read;
use std::sync::Arc;
use std::time::{Duration, Instant};

use http_auth::{PasswordClient, PasswordParams};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::Value;
use ureq::tls::{Certificate, PemItem, RootCerts, TlsConfig, parse_pem};
use ureq::{Agent, SendBody};

use super::entry::{HostEntry, Secret};
use super::error::{Cause, SendError, Step};
use super::form::Form;
use super::payload::{Counted, Payload};

/// More is no answer.
const ANSWER_BYTES: u64 = 16 << 20;
/// How much of an answer a message shows.
const SHOWN: usize = 200;
/// Storing and analysing an upload may take so many times as long as other answers.
const SLOW: u32 = 10;
/// The first pause before something is tried again, and the longest.
const PAUSES: [Duration; 2] = [Duration::from_millis(250), Duration::from_secs(4)];
/// What stays as it is within a part of a path, or a value.
const KEPT: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// How long a host is waited for.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// How long broken connections and failing answers are tried again.
    pub retry: Duration,
    /// How long a host may be silent.
    pub silence: Duration,
    /// Is told of what is tried again.
    pub told: fn(&SendError),
}

impl Default for Patience {
    fn default() -> Self {
        Self { retry: Duration::from_secs(30), silence: Duration::from_secs(30), told: |_| {} }
    }
}

impl Patience {
    /// Does something until it succeeds, fails for good, or the patience is over.
    pub(super) fn with<T>(&self, mut work: impl FnMut() -> Result<T, SendError>) -> Result<T, SendError> {
        let begun = Instant::now();
        let [mut pause, longest] = PAUSES;
        loop {
            match work() {
                Err(error) if error.is_transient && begun.elapsed() + pause <= self.retry => {
                    (self.told)(&error);
                    std::thread::sleep(pause);
                    pause = (pause * 2).min(longest);
                }
                done => return done,
            }
        }
    }
}

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
    base: String,
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

    fn exchange(&self, request: &mut Request<'_>) -> Result<Answer, SendError> {
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
        let mut response = match &mut request.body {
            Body::None => self.run(step, built, SendBody::none(), silence),
            Body::Json(value) => owned(built, "application/json", value.to_string()),
            Body::Text(text) => owned(built, "text/plain", (*text).to_owned()),
            Body::Stream(kind, length, reader) => {
                let built = built.header("Content-Type", kind.as_str()).header("Content-Length", *length);
                self.run(step, built, SendBody::from_reader(reader), silence * SLOW)
            }
        }?;
        let header = |name: &str| {
            let value = response.headers().get(name)?.to_str().ok()?;
            Some(value.to_owned())
        };
        let location = header("location");
        let status = response.status().as_u16();
        if status == 401 && self.login.is_some() {
            let challenge = header("www-authenticate");
            *self.challenge.borrow_mut() =
                challenge.and_then(|text| PasswordClient::builder().challenges(&text).build().ok());
        }
        let body = response.body_mut().with_config().limit(ANSWER_BYTES).read_to_vec();
        let body = body.map_err(|error| self.broken(step, error))?;
        Ok(Answer { status, location, body })
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

    /// What a connection that fails means.
    fn broken(&self, step: Step, error: ureq::Error) -> SendError {
        use std::io::ErrorKind as Io;
        use ureq::{Error, Timeout};
        let fail = |cause, message: String, advice: &str| self.error(step, cause, message, advice);
        let unreachable = |message: &str, advice: &str, is_unsent: bool| SendError {
            is_unsent,
            ..fail(Cause::Unreachable, format!("{message} ({})", self.base), advice).transient()
        };
        let power = match self.base.starts_with("https:") {
            true => "is it on, and in this network, and are address and port right, and is it not http://?",
            false => "is it on, and in this network, and are address and port right?",
        };
        // The standard library has no kind for it.
        let is_name = |error: &std::io::Error| error.to_string().contains("failed to lookup address");
        let unknown = || SendError {
            is_transient: false,
            ..unreachable("its name is not known", "is the address right?", true)
        };
        let rustls = match &error {
            Error::Rustls(error) => Some(error),
            Error::Io(error) => error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()),
            _ => None,
        };
        if let Some(rustls) = rustls {
            return self.untrusted(step, rustls);
        }
        match error {
            Error::HostNotFound => unknown(),
            Error::Io(error) if is_name(&error) => unknown(),
            Error::ConnectionFailed => unreachable("no connection", power, true),
            Error::Timeout(Timeout::Resolve | Timeout::Connect) => {
                unreachable("no connection in time", power, true)
            }
            Error::Timeout(_) => unreachable(
                &format!("no answer within {} s", self.patience.silence.as_secs_f32()),
                "is it busy? --timeout waits longer",
                false,
            ),
            Error::Io(error) => match error.kind() {
                Io::ConnectionRefused => unreachable("nothing listens there", power, true),
                Io::HostUnreachable | Io::NetworkUnreachable => {
                    unreachable("there is no route to it", power, true)
                }
                Io::TimedOut | Io::WouldBlock => {
                    unreachable("no answer in time", "is it busy? --timeout waits longer", false)
                }
                Io::Other => fail(Cause::File, error.to_string(), "try again when nothing else writes it"),
                _ => unreachable(&format!("the connection broke: {error}"), power, false),
            },
            Error::Protocol(error) => {
                let message = format!("its answer is no HTTP ({error})");
                fail(Cause::Answer, message, "are its address and port right?").transient()
            }
            Error::BodyExceedsLimit(_) | Error::LargeResponseHeader(..) => {
                fail(Cause::Answer, "its answer is far too long".into(), "are its address and kind right?")
            }
            error => unreachable(&error.to_string(), power, false),
        }
    }

    /// What is wrong with an encrypted connection.
    fn untrusted(&self, step: Step, error: &rustls::Error) -> SendError {
        use rustls::CertificateError as Wrong;
        let (message, advice) = match error {
            rustls::Error::InvalidCertificate(wrong) => match wrong {
                Wrong::Expired | Wrong::ExpiredContext { .. } => (
                    "its certificate has expired".to_owned(),
                    "renew it on the host, or set this machine's clock",
                ),
                Wrong::NotValidYet | Wrong::NotValidYetContext { .. } => {
                    ("its certificate is not valid yet".to_owned(), "are the clocks of both machines right?")
                }
                Wrong::UnknownIssuer => (
                    "its certificate is signed by nobody that is trusted here".to_owned(),
                    "--ca FILE, or `ca` in the file of hosts, trusts its own authority",
                ),
                Wrong::NotValidForName | Wrong::NotValidForNameContext { .. } => (
                    "its certificate is for another name".to_owned(),
                    "write the name in the certificate as `url`",
                ),
                wrong => (format!("its certificate is not trusted: {wrong:?}"), "look at it with a browser"),
            },
            error => (
                format!("no encrypted connection: {error}"),
                "is it http:// and not https://, or another port?",
            ),
        };
        self.error(step, Cause::Certificate, message, advice)
    }

    /// An answer in short: what it says of an error, or how it begins.
    fn said(&self, answer: &Answer) -> String {
        let text = match serde_json::from_slice::<Value>(&answer.body) {
            Ok(json) => told(&json).unwrap_or_else(|| json.to_string()),
            Err(_) => without_tags(&String::from_utf8_lossy(&answer.body)),
        };
        let words: Vec<&str> = text
            .split(|c: char| c.is_whitespace() || c.is_control())
            .filter(|word| !word.is_empty())
            .collect();
        let text: String = words.join(" ").chars().take(SHOWN).collect();
        self.without_secrets(if text.is_empty() { "nothing".into() } else { text })
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

/// A part of a path, or a value of a query.
pub(super) fn encoded(text: &str) -> String {
    utf8_percent_encode(text, KEPT).to_string()
}

/// Where hosts say what went wrong: `error`, `error.message`, `message`, `title`.
fn told(json: &Value) -> Option<String> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let error = &json["error"];
    text(error)
        .or_else(|| text(&error["message"]))
        .or_else(|| text(&json["message"]))
        .or_else(|| text(&json["title"]))
}

/// The text of a page.
fn without_tags(page: &str) -> String {
    let mut in_tag = false;
    let keep = |c: char| match c {
        '<' => {
            in_tag = true;
            None
        }
        '>' if in_tag => {
            in_tag = false;
            Some(' ')
        }
        c => (!in_tag).then_some(c),
    };
    page.chars().filter_map(keep).collect()
}

/// The system's authorities, and the user's own.
fn tls(entry: &HostEntry) -> Result<TlsConfig, (String, &'static str)> {
    let system = rustls_native_certs::load_native_certs().certs;
    let mut roots: Vec<Certificate<'static>> =
        system.iter().map(|certificate| Certificate::from_der(certificate).to_owned()).collect();
    if let Some(path) = &entry.ca {
        let failed = |error: &dyn std::fmt::Display| {
            (format!("{}: {error}", path.display()), "a file with certificates as PEM is expected")
        };
        let pem = std::fs::read(path).map_err(|error| failed(&error))?;
        let before = roots.len();
        for item in parse_pem(&pem) {
            if let PemItem::Certificate(certificate) = item.map_err(|error| failed(&error))? {
                roots.push(certificate);
            }
        }
        if roots.len() == before {
            return Err(failed(&"there is no certificate in it"));
        }
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    Ok(TlsConfig::builder()
        .root_certs(RootCerts::from(roots))
        .unversioned_rustls_crypto_provider(provider)
        .build())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_and_json_are_told_in_short() {
        assert_eq!(without_tags("<h1>502 Bad</h1>\n<p>Gateway"), " 502 Bad \n Gateway");
        for json in [r#"{"error":"no"}"#, r#"{"error":{"code":400,"message":"no"}}"#, r#"{"title":"no"}"#] {
            assert_eq!(told(&serde_json::from_str(json).unwrap()), Some("no".into()), "{json}");
        }
    }

    #[test]
    fn names_are_encoded_in_paths() {
        assert_eq!(encoded("a b+c/é.gcode"), "a%20b%2Bc%2F%C3%A9.gcode");
    }
}
