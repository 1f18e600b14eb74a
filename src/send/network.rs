//! This machine's network: encrypted where an address says so.

use std::io;
use std::time::Duration;

use ureq::{Agent, SendBody};

use super::entry::HostEntry;
use super::error::Cause;
use super::tls::tls;
use super::transport::{Broken, Incoming, Outgoing, Transport};

/// Requests from this machine to one host.
pub(super) struct Network {
    agent: Agent,
    base: String,
    silence: Duration,
}

impl Network {
    /// To a host that may be silent for so long. What is wrong with its certificates, and what to do, where it is not.
    pub fn new(entry: &HostEntry, silence: Duration) -> Result<Self, (String, &'static str)> {
        let mut config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .max_idle_connections(0)
            .user_agent(concat!("pathwright/", env!("CARGO_PKG_VERSION")))
            .timeout_resolve(Some(silence))
            .timeout_connect(Some(silence))
            .timeout_per_read(Some(silence))
            .timeout_per_write(Some(silence));
        if entry.url.starts_with("https:") {
            config = config.tls_config(tls(entry)?);
        }
        Ok(Self { agent: config.build().new_agent(), base: entry.url.clone(), silence })
    }

    fn run(
        &self,
        built: http::request::Builder,
        body: SendBody<'_>,
        silence: Duration,
    ) -> Result<http::Response<ureq::Body>, Broken> {
        let built = built.body(body).map_err(|error| Broken {
            cause: Cause::Settings,
            message: format!("{}: {error}", self.base),
            advice: "is the address right?".into(),
            is_transient: false,
            is_unsent: true,
        })?;
        let built = self.agent.configure_request(built).timeout_per_read(Some(silence)).build();
        self.agent.run(built).map_err(|error| self.lost(error))
    }

    /// What a connection that fails means.
    fn lost(&self, error: ureq::Error) -> Broken {
        use std::io::ErrorKind as Io;
        use ureq::{Error, Timeout};
        let fail = |cause, message: String, advice: &str| Broken {
            cause,
            message,
            advice: advice.to_owned(),
            is_transient: false,
            is_unsent: false,
        };
        let unreachable = |message: &str, advice: &str, is_unsent: bool| Broken {
            is_unsent,
            is_transient: true,
            ..fail(Cause::Unreachable, format!("{message} ({})", self.base), advice)
        };
        let power = match self.base.starts_with("https:") {
            true => "is it on, and in this network, and are address and port right, and is it not http://?",
            false => "is it on, and in this network, and are address and port right?",
        };
        // The standard library has no kind for it.
        let is_name = |error: &std::io::Error| error.to_string().contains("failed to lookup address");
        let unknown = || Broken {
            is_transient: false,
            ..unreachable("its name is not known", "is the address right?", true)
        };
        let rustls = match &error {
            Error::Rustls(error) => Some(error),
            Error::Io(error) => error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()),
            _ => None,
        };
        if let Some(rustls) = rustls {
            return untrusted(rustls);
        }
        match error {
            Error::HostNotFound => unknown(),
            Error::Io(error) if is_name(&error) => unknown(),
            Error::ConnectionFailed => unreachable("no connection", power, true),
            Error::Timeout(Timeout::Resolve | Timeout::Connect) => {
                unreachable("no connection in time", power, true)
            }
            Error::Timeout(_) => unreachable(
                &format!("no answer within {} s", self.silence.as_secs_f32()),
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
                Broken {
                    is_transient: true,
                    ..fail(Cause::Answer, message, "are its address and port right?")
                }
            }
            Error::BodyExceedsLimit(_) | Error::LargeResponseHeader(..) => {
                fail(Cause::Answer, "its answer is far too long".into(), "are its address and kind right?")
            }
            error => unreachable(&error.to_string(), power, false),
        }
    }
}

impl Transport for Network {
    fn exchange(&self, request: Outgoing<'_>) -> Result<Incoming, Broken> {
        let mut built = http::Request::builder().method(request.method).uri(request.url);
        for (name, value) in request.headers {
            built = built.header(*name, value);
        }
        let response = match request.body {
            None => self.run(built, SendBody::none(), request.silence),
            Some((length, reader)) => {
                let mut reader = reader;
                let built = built.header("Content-Length", length);
                self.run(built, SendBody::from_reader(&mut reader), request.silence)
            }
        }?;
        let header = |name: &str| response.headers().get(name)?.to_str().ok().map(str::to_owned);
        Ok(Incoming {
            status: response.status().as_u16(),
            location: header("location"),
            challenge: header("www-authenticate"),
            body: Box::new(response.into_body().into_reader()),
        })
    }

    fn broken(&self, error: io::Error) -> Broken {
        self.lost(error.into())
    }
}

/// What is wrong with an encrypted connection.
fn untrusted(error: &rustls::Error) -> Broken {
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
        error => {
            (format!("no encrypted connection: {error}"), "is it http:// and not https://, or another port?")
        }
    };
    let advice = advice.to_owned();
    Broken { cause: Cause::Certificate, message, advice, is_transient: false, is_unsent: false }
}
